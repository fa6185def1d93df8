"""What is known of a pose that was judged: as a person reads it, and as a JSON document."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from certreg.exact.decimals import at_most
from certreg.exact.dyadic import degrees_above, rational_root_above
from certreg.registration.findings import FIT_WARNED, JudgedEnergies, SigmaDistance
from certreg.registration.headlines import degrees_words, interval_words
from certreg.registration.loose_turns import TooLarge
from certreg.report.encoding import Document, encoded
from certreg.report.fields import finite, fit_fields
from certreg.report.lines import exact_number, unit_words
from certreg.report.remedies import ADVICE
from certreg.report.scale import scale_of
from certreg.report.uncertainty import known
from certreg.results import OUT_OF_RANGE, Absent, PoseVerdict, mapped

if TYPE_CHECKING:
    from certreg.registration.assessed import Assessment
    from certreg.registration.gap_parts import GapParts


ASSESSMENT_SCHEMA = "certreg-assessment/1"
TURN = 3  # degrees of freedom of a rotation alone


def assessment_summary(assessment: Assessment) -> str:
    """The result of `assess`, readable."""
    lines = [assessment.headline]
    if assessment.verdict is not PoseVerdict.NOT_A_ROTATION:
        lines.append(assessment.words)
    explained = assessment.hint or assessment.unexplained
    if explained is not None:
        lines.append(explained)
    if assessment.energies is not None:
        lines += ["", *_judged_lines(assessment, assessment.energies)]
    warned = assessment.fit.warnings
    told = [one.text for one in warned if one.text not in assessment.headline]
    lines += (f"  warning            {words}" for words in told)
    lines += (f"{ADVICE}{one.remedy}." for one in warned)
    return "\n".join(lines)


def _judged_lines(assessment: Assessment, energies: JudgedEnergies) -> list[str]:
    """Numbers of a pose that is a rotation, beside those of the optimum."""
    optimum, cost = assessment.optimum, at_most(energies.rounding_cost)
    proved = degrees_words(energies.bounds)
    within = "" if proved is None else f", within {proved} (proved)"
    rmse, of_optimum = (
        OUT_OF_RANGE.reason if square is None else exact_number(rational_root_above(square))
        for square in (energies.mean_square, energies.least_square)
    )
    angle = known(
        assessment.stated("angle_to_optimum"),
        lambda angle: f"{math.degrees(angle):.4g} degrees{within}",
    )
    return [
        f"  RMSE               {rmse}  ({energies.of_what}, {unit_words(assessment.fit)})",
        f"  of the optimum     {of_optimum}",
        f"  objective          {exact_number(energies.objective)}",
        f"  of the optimum     {exact_number(energies.optimum)}",
        f"  above the minimum  {interval_words(energies.bounds)} (proved)",
        f"  angle to optimum   {angle}",
        f"  centre to optimum  {known(assessment.stated('shift_upper'), within_words)}",
        *_sigma_lines(assessment.stated("sigma_distance")),
        f"  rounding can cost  {cost}  (of the optimal pose, to doubles)",
        f"  the optimum: wxyz  {' '.join(map(repr, optimum.quaternion_wxyz.tolist()))}",
        f"    its translation  {' '.join(map(repr, optimum.translation.tolist()))}",
    ]


def within_words(shift: float) -> str:
    """How far the source's centre is at most from where the optimum puts it."""
    return f"within {at_most(shift)} (proved)"


def _sigma_lines(distance: SigmaDistance | Absent) -> list[str]:
    """The distance by the covariance, where it is known: plainly, and that it is no proof."""
    if isinstance(distance, Absent):
        told = isinstance(distance, TooLarge) or distance == FIT_WARNED
        return [f"  sigma distance     not known: {distance.reason}"] if told else []
    jointly = "rotation and translation jointly" if distance.dof > TURN else "of the rotation"
    p = f"{distance.p:.2g}" if distance.p else "below 1e-300"
    return [
        f"  sigma distance     {distance.value:.4g} standard deviations, {jointly}",
        "                     (to first order; if all pairs are right and the errors independent,",
        "                     Gaussian and of this sigma, the true pose is as far with probability",
        f"                     {p})",
    ]


def assessment_document(assessment: Assessment) -> Document:
    """An assessment as `certreg-assessment/1`."""
    stated = assessment.stated
    return encoded(
        {
            "schema": ASSESSMENT_SCHEMA,
            "objective": stated("objective"),
            "rmse": stated("rmse"),
            "gap_lower": stated("gap_lower"),
            "gap_upper": finite(stated("gap_upper")),
            "gap_share": finite(stated("gap_share")),
            "gap_parts": mapped(stated("gap_parts"), _gap_parts),
            "rounding_cost": finite(stated("rounding_cost")),
            "angle_upper_deg": mapped(stated("angle_upper"), degrees_above),
            "shift_upper": finite(stated("shift_upper")),
            "angle_to_optimum_deg": mapped(stated("angle_to_optimum"), math.degrees),
            "nearest": mapped(
                stated("nearest_index"),
                lambda index: {
                    "morse_index": index,
                    "angle_deg": mapped(stated("nearest_angle"), math.degrees),
                },
            ),
            "sigma_distance": mapped(
                stated("sigma_distance"),
                lambda distance: {"value": distance.value, "dof": distance.dof, "p": distance.p},
            ),
            "verdict": assessment.verdict.value,
            "headline": assessment.headline,
            "words": assessment.words,
            "hint": stated("slip") if assessment.slip is None else assessment.hint,
            "slip": mapped(
                stated("slip"),
                lambda slip: {
                    "code": slip.code.value,
                    "verdict": slip.verdict.value,
                    "words": slip.words,
                },
            ),
            "optimum": {
                "rotation": assessment.optimum.rotation,
                "translation": assessment.optimum.translation,
                "quaternion_wxyz": assessment.optimum.quaternion_wxyz,
                "scale": scale_of(assessment.optimum),
                "objective": stated("optimum_objective"),
                "rmse": stated("optimum_rmse"),
            },
            "fit": fit_fields(assessment.fit),
        }
    )


def _gap_parts(parts: GapParts) -> Document:
    rotation, scale, translation = map(finite, parts.doubles)
    return {"scale": scale, "rotation": rotation, "translation": translation}
