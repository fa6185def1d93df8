"""The lines of results: what summaries, pages and cards say alike."""

from __future__ import annotations

import math
from decimal import MAX_EMAX, MIN_EMIN, Context, Decimal
from fractions import Fraction
from typing import TYPE_CHECKING

from certreg.certificate.bounds import PoseBounds, flat_energy
from certreg.exact.decimals import as_given, at_most
from certreg.exact.dyadic import nearest_double
from certreg.registration.ambiguity import ambiguous_words, narrow_words
from certreg.registration.headlines import (
    HARDLY_DETERMINED,
    headline_words,
    proved_degrees,
    share_words,
)
from certreg.registration.misfits import FitCode
from certreg.registration.pipeline import NOT_ASKED
from certreg.registration.rounding import rounding_remedy
from certreg.registration.squares import BY_NAME
from certreg.report.parts import listed, sprung
from certreg.report.robustness import robustness_words
from certreg.report.scale import BIAS
from certreg.report.springs import how_words, open_words, relaxation_words
from certreg.report.thinning import kicked_words, unspent_words
from certreg.report.uncertainty import uncertainty_rows
from certreg.results import Absent, Limits, Optimality

if TYPE_CHECKING:
    from certreg.dynamics.trajectory import Trajectory
    from certreg.equilibrium.equilibrium_set import EquilibriumSet
    from certreg.registration.fit import Fit
    from certreg.registration.result import Registration


UNMET = "Not called certified: that asks for a proof that it is"
MEANS = "Certified means here"
OF_SPREAD = " of the target's spread (R squared, with the best scale)"
DISTINGUISHABLE = 25.0  # twice the log-likelihood ratio of five standard deviations
ROUNDING_SHARE = 1e6  # a gap above a millionth of the minimum is worth a word
UNNOTED_COST = 1e-24  # of the spread: a shift of 1e-12, finer than any data
LEAST_NORMAL = 2.0**-1022  # smaller doubles have fewer digits
OF_PRINTED = "; at rounding, of the pose as printed"  # below, of the exact optimum
RMSE_WORDS = "along the springs, unit of the clouds"
COMPARABLE_STEP = 0.1  # h times the decay rate: a scheme's own differs by half of that


def untested_lines(fit: Fit) -> list[str]:
    """Which tests of a fit there are not, in a line, if any are missing."""
    return [] if fit.untested is None else [f"                    {fit.untested}"]


def uncertainty_lines(registration: Registration) -> list[str]:
    """The rows of `uncertainty_rows`, in ASCII."""
    plain = ([part.replace("±", "+/-") for part in row] for row in uncertainty_rows(registration))
    return [f"  {name:<17} {words}" for name, words in plain]


def verdict_words(registration: Registration) -> list[str]:
    """What is proved of the pose: a headline, then what else must be said before any number."""
    status, own, springs = registration.status, listed(registration), sprung(registration)
    headline = headline_words(registration)
    if status is Optimality.NOT_CERTIFIED:
        return [headline]
    lines = [headline]
    if own is not None:
        lines += _tie_words(own)
    if springs is not None:
        lines += open_words(springs, headline)
    if status is Optimality.BOUNDED or registration.limits != Limits():
        lines.append(_limit_words(registration))
    return lines


def _tie_words(registration: Registration) -> list[str]:
    """That other poses are as good, or next to."""
    ambiguity = registration.equilibria.classification.ambiguity
    if ambiguity is not None:
        return [
            f"{ambiguity.value}.",
            "The pose below is one of them that turns the source least, to within 0.002 degrees.",
        ]
    tie = ambiguous_words(registration.equilibria)
    return [] if tie is None else [tie]


def _limit_words(registration: Registration) -> str:
    """What is called certified, where that is asked for or not reached."""
    limits, bounds = registration.limits, registration.bounds
    within = f"within {as_given(limits.max_gap)} of {_range_words(registration)}"
    if registration.unique is None:
        if bounds is not None and bounds.meet(limits, unique=False):
            return f"Not called certified, though {within}: whether one pose is optimal is open."
        return f"{UNMET} {within}, and of whether one pose is optimal."
    angle = ""
    if registration.solution.unique_rotation:
        angle = f" and {as_given(limits.max_angle)} radians of the optimum"
    lead = UNMET if registration.status is Optimality.BOUNDED else MEANS
    return f"{lead} {within}{angle}."


def _range_words(registration: Registration) -> str:
    """What a gap is held against."""
    own, bounds = listed(registration), registration.bounds
    if own is None or bounds is None or bounds.least_range_squared:
        return "the range of energies"
    spread = own.solution.moments.spread
    return "the clouds' own spread" if spread else "their distance from the origin, squared"


def status_lines(registration: Registration) -> list[str]:
    """What is proved of the pose, in lines."""
    lines, bounds = verdict_words(registration), registration.bounds
    if registration.status is Optimality.NOT_CERTIFIED or bounds is None:
        return lines
    return lines + proved_lines(registration, bounds)


def proved_lines(registration: Registration, bounds: PoseBounds) -> list[str]:
    """How far the pose is from optimal, proved; of springs what proves it, too."""
    gap = f"{at_most(bounds.greatest_gap)}, {share_words(bounds)}"
    lines = [f"  proved gap        objective - minimum <= {gap}, at the pose below"]
    degrees = proved_degrees(registration)
    if degrees is not None:
        which = "the optimum" if registration.solution.unique_rotation else "every optimum"
        lines.append(f"  proved angle      rotation (wxyz) within {degrees} degrees of {which}")
    if how := how_words(registration):
        if registration.robustness is not None:
            lines.append(f"  robustness        {robustness_words(registration)}")
        lines.append(f"  proved by         {how}")
    return lines


def rmse_words(registration: Registration) -> str:
    """What the RMSE is of, and in which unit."""
    fit, own = registration.fit, listed(registration)
    if own is None:
        return RMSE_WORDS
    if registration.problem.scale in BIAS:
        return "weighted, unit of the target"
    exact = number(own.equilibria.components[0].rmse)
    differs = fit.rounded and number(registration.rmse) != exact
    return f"weighted, {unit_words(fit)}{OF_PRINTED if differs else ''}"


def bounds_nothing(registration: Registration, gap: Fraction) -> bool:
    """Whether a proved gap is not below the range of energies, as far as that is known."""
    return registration.bounds is not None and registration.bounds.covers_range(gap)


def method_lines(registration: Registration) -> list[str]:
    """What the independent methods say, one line each."""
    own, springs = listed(registration), sprung(registration)
    relaxed = [] if springs is None else [f"  relaxation (SDP)  {relaxation_words(springs)}"]
    return relaxed if own is None else relaxed + _method_lines(own)


def _method_lines(registration: Registration) -> list[str]:
    solution, lines = registration.solution, list[str]()
    unique = registration.equilibria.classification.unique
    relaxation, trajectory, agreement = solution.relaxation, solution.trajectory, solution.agreement
    if not isinstance(relaxation, Absent) and agreement.relaxation is not None:
        gap = None if solution.certificate is None else solution.certificate.body.claims.sdp_gap
        bound = "" if gap is None else f", which alone proves a gap of at most {at_most(gap.value)}"
        if gap is not None and bounds_nothing(registration, gap.value):
            bound += ", which bounds nothing"
        away = away_words(agreement.relaxation, unique=unique)
        lines.append(f"  relaxation (SDP)  rank {relaxation.rank}, {away}{bound}")
    if not isinstance(trajectory, Absent) and agreement.simulation is not None:
        away = away_words(agreement.simulation, unique=unique)
        lines += _motion_lines(registration, trajectory, away)
    left_out = {
        "relaxation (SDP)": solution.relaxation,
        "simulation": solution.trajectory,
    }
    lines += [
        f"  {name:16}  left out: {part.reason}"
        for name, part in left_out.items()
        if isinstance(part, Absent) and part not in {NOT_ASKED, BY_NAME}
    ]
    return lines


def _motion_lines(registration: Registration, trajectory: Trajectory, away: str) -> list[str]:
    """How a simulation ended, and if it did not come to rest, why."""
    certificate, where = registration.solution.certificate, ""
    if trajectory.scales is not None:
        where = f", at the scale {trajectory.scales[-1]:.6g}"
    elif certificate is not None and certificate.body.claims.basin:
        where = ", proved in the basin of the optimum"
    if (left := unspent_words(trajectory)) is not None:
        away = f"then {left}; its rotation {away}"
    steps = f"{trajectory.steps} step{'s' * (trajectory.steps != 1)}"
    lines = [f"  simulation        {steps}{kicked_words(trajectory.escapes)}, {away}{where}"]
    if not trajectory.converged:
        words = " ".join((trajectory.status.value, *trajectory.notes))
        lines.append(f"                    NOT CONVERGED: {words}")
    return lines


def explained_words(fit: Fit) -> str:
    """How much of the target a fit explains."""
    if fit.explained is None:
        return f"unknown: {fit.stated('explained').reason}"
    return f"{percent_words(fit.explained)}{OF_SPREAD}"


def percent_words(share: float) -> str:
    """A share in per cent, with the digits in which it differs from all of it."""
    percent = 100.0 * share
    digits = max(0, min(9, 2 - math.floor(math.log10(max(100.0 - percent, 1e-9)))))
    told = f"{percent:.{digits}f}"
    if float(told) >= 100.0:
        told = "over 99.9999999"  # nothing is rounded up to all of it
    return f"{told} %"


def away_words(angle: float, *, unique: bool = True) -> str:
    """How far a rotation is from the optimum."""
    degrees = math.degrees(angle)
    digits = 3 if degrees >= 1.0 else 1  # a small one is rounding, or where a run was stopped
    return f"{degrees:.{digits}g} degrees from the {'' if unique else 'nearest '}optimum"


def margin_words(equilibria: EquilibriumSet) -> str:
    """How far the optimum is from being ambiguous, in words."""
    margin = equilibria.margin
    if equilibria.doubt is not None:
        return "not known: the list of equilibria is not proved complete"
    if not equilibria.classification.unique:
        return "0: the optimum is not unique"
    percent = f"{100 * margin.relative:.3g} % of the range of energies"
    if equilibria.pairs_in_doubt:
        return f"{percent}: unique, but the poor fit may have turned the answer over"
    if equilibria.nearly_ambiguous:
        return f"{percent}: unique, but a small change of the data may turn the answer over"
    return f"{percent}: unique"


def warnings(registration: Registration, headline: str) -> list[str]:
    """What is true of the data and should not be overlooked, and is not in the headline."""
    own, springs = listed(registration), registration.problem.springs
    notes = [] if springs is None else list(springs.notes)
    if own is not None and (narrow := narrow_words(own.equilibria)) is not None:
        notes.append(narrow)
    notes += [one.text for one in registration.fit.warnings if one.text not in headline]
    return notes if own is None else notes + _numeric_warnings(own, headline)


def _numeric_warnings(registration: Registration, headline: str) -> list[str]:
    """That the noise may reach the next equilibrium, and that rounding costs something."""
    equilibria, bounds = registration.equilibria, registration.bounds
    notes: list[str] = []
    gap, minimum = equilibria.margin.eigenvalue_gap, equilibria.components[0].energy
    unique = equilibria.classification.unique
    noisy = unique and registration.problem.noise_given and gap is not None
    noisy = noisy and not headline.startswith(HARDLY_DETERMINED.stamp)
    if noisy and 2.0 * (gap or 0.0) < DISTINGUISHABLE:
        notes.append(
            "at the given noise, five standard deviations do not rule out the next equilibrium"
        )
    costs = 0.0 if bounds is None else ROUNDING_SHARE * bounds.gap_lower
    unnoted = Fraction(UNNOTED_COST) * flat_energy(registration.solution.moments)
    noted = bounds is not None and bounds.greatest_gap > unnoted
    if noted and minimum is not None and costs > max(minimum, gap or 0.0):
        matters = max(unnoted, Fraction(max(minimum, gap or 0.0)) / Fraction(ROUNDING_SHARE))
        remedy = rounding_remedy(registration.solution.moments, matters)
        notes.append(
            "the rounding of the translation to doubles costs more than a millionth of the fit: "
            f"{remedy}"
        )
    return notes


def step_words(step: float) -> str:
    """How long the steps of a run are; of a step that the user gave, as it was given."""
    return f"each at most {at_most(Fraction(repr(step)), 6)} long"


def unit_words(fit: Fit, *, scaled: bool = False) -> str:
    """Whose unit a length has: where the clouds' may differ, the one that the pose leads to."""
    return f"unit of the {'target' if scaled or FitCode.SCALE in fit.codes else 'clouds'}"


def number(value: float | None) -> str:
    """A length or an energy, in few digits."""
    if value is None:
        return "(beyond doubles)"
    plain = 1e-4 <= abs(value) < 1e7 or value == 0
    return f"{value:.6f}" if plain else f"{value:.9e}"


def exact_number(value: Fraction) -> str:
    """An energy or a length of any size, in as many digits as `number`."""
    nearest = nearest_double(value)
    if nearest is not None and (nearest == 0.0 or nearest >= LEAST_NORMAL):
        return number(nearest)
    context = Context(prec=10, Emax=MAX_EMAX, Emin=MIN_EMIN)
    return f"{context.divide(Decimal(value.numerator), Decimal(value.denominator)):.9e}"


def _rate(value: float | None) -> str:
    return "unknown" if value is None else f"{value:.4g}"


def rate_words(trajectory: Trajectory) -> str:
    """The measured rate beside the exact flow's, where the steps are small enough to tell."""
    measured, predicted = _rate(trajectory.decay_rate), _rate(trajectory.predicted_rate)
    advance = trajectory.step * (trajectory.predicted_rate or 0.0)
    if trajectory.decay_rate is not None and advance > COMPARABLE_STEP:
        return f"{measured}  (too few steps to compare with the predicted {predicted})"
    return f"{measured}  (predicted {predicted})"
