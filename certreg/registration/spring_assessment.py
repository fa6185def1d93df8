"""Judging a pose on general springs: the assessment, with its words."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from certreg.exact.decimals import at_most
from certreg.exact.dyadic import double_above, nearest_double, nearest_root
from certreg.geometry.pose_matrix import why_no_rotation
from certreg.registration.assessed import Assessment
from certreg.registration.assessment_words import note_on
from certreg.registration.findings import GOOD, rules_out
from certreg.registration.headlines import (
    NEAR_AS_OTHERS,
    NEAR_UNDECIDED,
    NO_EQUILIBRIUM,
    NO_ROTATION,
    OF_DATA,
    OPTIMAL_AS_OTHERS,
    OPTIMAL_UNDECIDED,
    POSE_BOUNDED,
    RULED_OUT,
    SPURIOUS,
    degrees_words,
    headline_of_data,
    interval_words,
    loose_words,
    share_words,
)
from certreg.registration.quartic import UNDECIDED
from certreg.registration.scaled_poses import NOT_SCALED
from certreg.registration.spring_findings import (
    spring_findings,
    spring_sigma_distance,
    spring_verdict_of,
)
from certreg.registration.weak_shifts import weak_shift_words
from certreg.results import OUT_OF_RANGE, Absent, PoseVerdict, present

if TYPE_CHECKING:
    from certreg.geometry.given import GivenPose
    from certreg.registration.findings import AssessmentSettings, SigmaDistance
    from certreg.registration.headlines import Headline
    from certreg.registration.quartic import QuarticSolution
    from certreg.registration.result import Registration
    from certreg.registration.spring_findings import SpringFindings


NUMBERS = (
    *("objective", "rmse", "gap_lower", "gap_upper", "gap_share", "rounding_cost", "angle_upper"),
    *("gap_parts", "shift_upper", "angle_to_optimum", "nearest_index", "nearest_angle"),
    "sigma_distance",
)
NOT_UNIQUE = Absent("other poses are as good: no angle to 'the' optimum exists")
NOT_MET = Absent("no equilibrium was met at the pose, and those of general springs are not listed")
NO_ANGLE = (
    "Not called near-optimal: whether one rotation alone is optimal is not decided, and no angle "
    "to an optimum is proved: where little is at stake, a pose far from every optimum costs as "
    "little."
)
NO_SLIPS = Absent(
    "no slip (a mirror image, swapped columns, the inverse pose) is tried for general springs"
)


def judged_on_springs(
    registration: Registration[QuarticSolution], given: GivenPose, settings: AssessmentSettings
) -> Assessment:
    """As `judged`, of general springs."""
    fault = why_no_rotation(given.turn, settings.rotation_tolerance)
    if fault is not None:
        return _no_rotation(registration, fault)
    facts = spring_findings(registration, given, settings)
    verdict = spring_verdict_of(facts, settings)
    distance = spring_sigma_distance(facts, given)
    chosen, headline = _headline(facts, verdict, distance)
    nearest = _nearest(facts, verdict)
    numbers: dict[str, Any] = {
        "objective": _or_beyond(nearest_double(facts.energy)),
        "rmse": _or_beyond(nearest_root(facts.energy / facts.energies.total_weight)),
        "gap_lower": facts.bounds.gap_lower,
        "gap_upper": facts.bounds.gap_upper,
        "gap_share": facts.bounds.stated("share_upper"),
        "gap_parts": NOT_SCALED,
        "rounding_cost": double_above(facts.rounding_cost),
        "angle_upper": facts.bounds.stated("angle_upper"),
        "shift_upper": facts.bounds.stated("shift_upper"),
        "angle_to_optimum": _why_no_angle(registration) if facts.away is None else facts.away,
        "nearest_index": nearest[0],
        "nearest_angle": nearest[1],
        "sigma_distance": distance,
        "slip": NO_SLIPS,
    }
    return _assessment(
        registration,
        {
            "verdict": verdict,
            "headline": headline,
            "green": chosen.good,
            "energies": facts.energies,
            "words": _words(facts, verdict) + note_on(registration.problem, given),
        },
        numbers,
    )


def _no_rotation(registration: Registration[QuarticSolution], fault: str) -> Assessment:
    said = {
        "verdict": PoseVerdict.NOT_A_ROTATION,
        "headline": NO_ROTATION.said(fault=fault),
        "words": fault,
    }
    numbers = {**dict.fromkeys(NUMBERS, Absent(fault)), "slip": NO_SLIPS}
    return _assessment(registration, said, numbers)


def _assessment(
    registration: Registration[QuarticSolution], said: dict[str, Any], numbers: dict[str, Any]
) -> Assessment:
    """With the optimum beside the pose that is judged."""
    solution = registration.solution
    weight = Fraction(solution.sums.stiffness)
    beside = {
        "optimum_objective": _or_beyond(nearest_double(solution.least)),
        "optimum_rmse": _or_beyond(nearest_root(solution.least / weight)),
    }
    told: dict[str, Any] = {**numbers, **beside}
    return Assessment(
        **said,
        **_present(told),
        optimum=registration.pose,
        fit=registration.fit,
        absent={name: value for name, value in told.items() if isinstance(value, Absent)},
    )


def _present(told: dict[str, Any]) -> dict[str, Any]:
    return {name: present(value) for name, value in told.items()}


def _headline(
    facts: SpringFindings, verdict: PoseVerdict, distance: SigmaDistance | Absent
) -> tuple[Headline, str]:
    registration, bounds = facts.registration, facts.bounds
    if verdict is PoseVerdict.SPURIOUS_EQUILIBRIUM and facts.critical is not None:
        stable = not facts.critical.index
        name = "a stable equilibrium" if stable else f"an index-{facts.critical.index} equilibrium"
        end = ", at which a local method stops, and not the optimum" if stable else ""
        near = f"{math.degrees(facts.critical.angle):.2g}"
        return SPURIOUS, SPURIOUS.said(near=near, shift="", name=name, end=end)
    if verdict not in (*GOOD, PoseVerdict.BOUNDED):
        return NO_EQUILIBRIUM, NO_EQUILIBRIUM.said(interval=interval_words(bounds))
    chosen = _gap_headline(facts, verdict, distance)
    said = chosen.said(
        degrees=degrees_words(bounds) or "180",
        gap=at_most(bounds.greatest_gap),
        share=share_words(bounds),
        warning=next((one.text for one in registration.fit.warnings), ""),
        loose=loose_words(registration),
        weak=weak_shift_words(registration.solution.weak_shifts),
        sigmas="" if isinstance(distance, Absent) else f"{distance.value:.3g}",
    )
    return chosen, said


def _gap_headline(
    facts: SpringFindings, verdict: PoseVerdict, distance: SigmaDistance | Absent
) -> Headline:
    registration, optimal = facts.registration, verdict is PoseVerdict.OPTIMAL
    if verdict is PoseVerdict.BOUNDED:
        return POSE_BOUNDED
    if registration.unique is None:
        return OPTIMAL_UNDECIDED if optimal else NEAR_UNDECIDED
    if not registration.unique:
        return OPTIMAL_AS_OTHERS if optimal else NEAR_AS_OTHERS
    of_data = OF_DATA[headline_of_data(registration)]
    if not isinstance(distance, Absent) and rules_out(registration, distance):
        of_data = RULED_OUT
    return of_data[0 if optimal else 1]


def _words(facts: SpringFindings, verdict: PoseVerdict) -> str:
    """What else is to be said of it, in a sentence or two."""
    away = "" if facts.away is None else f"{math.degrees(facts.away):.4g} degrees from the optimum"
    gap, cost = at_most(facts.bounds.greatest_gap), at_most(facts.rounding_cost)
    if verdict is PoseVerdict.OPTIMAL:
        return (
            f"Its objective is at most {gap} above the minimum: rounding the numbers of the "
            f"optimal pose to doubles can cost about {cost}{_of_proof(facts)}."
        )
    if verdict is PoseVerdict.NEAR_OPTIMAL:
        its = f"It is {away}. " if away else ""
        return f"{its}Rounding the numbers of the optimal pose to doubles costs about {cost}."
    if verdict is PoseVerdict.BOUNDED:
        return f"{NO_ANGLE} Rounding the numbers of the optimal pose to doubles costs about {cost}."
    where = f" The rotation is {away}." if away else ""
    if verdict is PoseVerdict.SPURIOUS_EQUILIBRIUM and facts.critical is not None:
        index = facts.critical.index
        many = f"{index} direction{'s' * (index > 1)}"
        how = (
            f"but the energy falls in {many}" if index else "and every small turn raises the energy"
        )
        return f"Forces and torques balance there, {how}.{where}"
    return f"The pose is not optimal.{where}"


def _of_proof(facts: SpringFindings) -> str:
    """What the proof itself leaves open, where that is more than the rounding of the pose."""
    own = facts.proof_gap
    return f", and the proof itself leaves {at_most(own)}" if own > facts.rounding_cost else ""


def _nearest(facts: SpringFindings, verdict: PoseVerdict) -> tuple[Any, Any]:
    """Index and angle of the equilibrium that the pose is at; why there is none, twice."""
    if verdict in GOOD and facts.away is not None:
        return 0, facts.away
    if verdict is PoseVerdict.SPURIOUS_EQUILIBRIUM and facts.critical is not None:
        return facts.critical.index, facts.critical.angle
    return NOT_MET, NOT_MET


def _why_no_angle(registration: Registration[QuarticSolution]) -> Absent:
    return UNDECIDED if registration.solution.unique_rotation is None else NOT_UNIQUE


def _or_beyond(value: float | None) -> float | Absent:
    return OUT_OF_RANGE if value is None else value
