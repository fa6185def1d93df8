"""The first line of every answer, in one place: what it says, and what it rests on.

A headline is no stronger than the numbers in it, each rounded so that it stays a bound.
`docs/reference/headlines.md` lists all of them; a test holds that page to this list.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from certreg.exact.decimals import at_least, at_most
from certreg.exact.dyadic import degrees_above
from certreg.registration.loose_turns import LOOSE_SIGMA, axis_words
from certreg.registration.misfits import FitCode
from certreg.registration.weakly_constrained import weak_shift_words
from certreg.results import Absent, Limits, Optimality

if TYPE_CHECKING:
    from certreg.certificate.bounds import PoseBounds
    from certreg.registration.fit import Fit
    from certreg.registration.result import Registration


SMALL_SCALE = 0.1  # off one: what the pose leaves without it is a hundredth of the cloud's spread
GOOD_EXPLAINED = 0.99  # with the scale; so the pose alone explains about 0.98


@dataclass(frozen=True, slots=True, kw_only=True)
class Headline:
    """The first line of an answer: a stamp, and words with places for proved numbers.

    rests_on: claims of `certreg derive`, and figures of the JSON. code: that the command ends
    with. good: stamped green on a page.
    """

    stamp: str
    words: str
    rests_on: tuple[str, ...]
    code: int
    good: bool = False

    def said(self, **numbers: str) -> str:
        """The line, with its numbers."""
        said = f"{self.stamp}: {self.words.format(**numbers)}"
        return said[:-1] if said.endswith("?.") else said


_GAP = (
    *("optimality_certificate", "translation_gap", "energy_range"),
    *("optimality.gap_bound", "optimality.gap_share"),
)
_ANGLE = "optimality.angle_bound_rad"
CERTIFIED = Headline(
    stamp="CERTIFIED",
    words="the global optimum, and unique, to within the proved bounds.",
    rests_on=(*_GAP, _ANGLE, "classification"),
    code=0,
    good=True,
)
NOT_UNIQUE = Headline(
    stamp="CERTIFIED, BUT NOT UNIQUE",
    words="no pose is better by more than the proved gap, and infinitely many are as good:",
    rests_on=(*_GAP, "classification"),
    code=3,
)
NEARLY_AMBIGUOUS = Headline(
    stamp="CERTIFIED, BUT NEARLY AMBIGUOUS",
    words="the global optimum of exactly these numbers, to within the proved bounds.",
    rests_on=(*_GAP, _ANGLE, "classification", "margin.nearly_ambiguous"),
    code=0,
)
HARDLY_DETERMINED = Headline(
    stamp="CERTIFIED, BUT THE ROTATION IS HARDLY DETERMINED",
    words="the global optimum of exactly these numbers, to within the proved bounds; {loose}.",
    rests_on=(*_GAP, _ANGLE, "classification", "margin.hardly_determined", "pose.uncertainty"),
    code=0,
)
POOR_FIT = Headline(
    stamp="CERTIFIED OPTIMUM, BUT THE FIT IS POOR",
    words="{warning}.",
    rests_on=(*_GAP, _ANGLE, "classification", "fit.warnings"),
    code=0,
)
SCALE_FITS = Headline(
    stamp="CERTIFIED OPTIMUM, BUT A SCALE FITS BETTER",
    words="{warning}.",
    rests_on=(*_GAP, _ANGLE, "classification", "fit.best_scale", "fit.warnings"),
    code=0,
)
BOUNDED = Headline(
    stamp="BOUNDED",
    words="within {gap} of the minimum ({share}), within {degrees} degrees of the one optimum.",
    rests_on=(*_GAP, _ANGLE, "classification"),
    code=4,
)
WITHIN_LIMITS = replace(BOUNDED, stamp="CERTIFIED WITHIN THE LIMITS GIVEN", code=0)
BOUNDED_WITHOUT_ANGLE = Headline(
    stamp="BOUNDED",
    words="within {gap} of the minimum ({share}); no angle to the one optimum is claimed.",
    rests_on=(*_GAP, "classification"),
    code=4,
)
BOUNDED_NOT_UNIQUE = Headline(
    stamp="BOUNDED",
    words="within {gap} of the minimum ({share}), and infinitely many poses are optimal:",
    rests_on=(*_GAP, "classification"),
    code=4,
)
BOUNDED_FLAT = Headline(
    stamp="BOUNDED",
    words="within {gap} of the minimum; every rotation fits equally, the translation does not:",
    rests_on=(
        "optimality_certificate",
        "translation_gap",
        "optimality.gap_bound",
        "classification",
    ),
    code=4,
)
LIMITED = f"{WITHIN_LIMITS.stamp}, BUT NOT UNIQUE"
WITHIN_LIMITS_NOT_UNIQUE = replace(BOUNDED_NOT_UNIQUE, stamp=LIMITED, code=3)
WITHIN_LIMITS_FLAT = replace(BOUNDED_FLAT, stamp=LIMITED, code=3)
NOT_CERTIFIED = Headline(
    stamp="NOT CERTIFIED",
    words="the pose is computed, but its optimality was not proved.",
    rests_on=("optimality.status",),
    code=4,
)

_GROWTH = ("optimality.growth", "optimality.gap_bound", "optimality.gap_share")
_UNIQUE = (*_GROWTH, _ANGLE, "optimality.unique")
FREE_SHIFT = Headline(
    stamp="CERTIFIED, BUT A SHIFT IS FREE",
    words="the best rotation, and unique, to within the proved bounds; {free}.",
    rests_on=(*_UNIQUE, "springs.free_translations"),
    code=3,
)
HARDLY_RESISTED = Headline(
    stamp="CERTIFIED, BUT A SHIFT IS HARDLY RESISTED",
    words="the global optimum of exactly these numbers, to within the proved bounds; {weak}.",
    rests_on=(*_UNIQUE, "springs.weak_translations"),
    code=0,
)
OTHERS_AS_GOOD = Headline(
    stamp="CERTIFIED, BUT NOT UNIQUE",
    words="no pose is better by more than the proved gap, and others are as good: {free}.",
    rests_on=(*_GROWTH, "springs.free_translations", "springs.symmetry_dimension"),
    code=3,
)
WITHIN_LIMITS_FREE = replace(
    OTHERS_AS_GOOD,
    stamp=LIMITED,
    words="within {gap} of the minimum ({share}), and others are as good: {free}.",
)
BOUNDED_FREE = replace(WITHIN_LIMITS_FREE, stamp="BOUNDED", code=4)
UNDECIDED = Headline(
    stamp="BOUNDED",
    words="within {gap} of the minimum ({share}); whether one pose is optimal is not decided.",
    rests_on=_GROWTH,
    code=4,
)
UNDECIDED_NEAR = replace(
    UNDECIDED,
    words="within {gap} of the minimum ({share}), within {degrees} degrees of every optimum; "
    "whether there are several is not decided.",
    rests_on=(*_GROWTH, _ANGLE),
)

WEAK = Headline(
    stamp="PROVED IN PART",
    words="the certificate in this file proves less than can be proved.",
    rests_on=("optimality_certificate", "translation_gap"),
    code=0,
)

_PROVED = ("optimality_certificate", "translation_gap", "gap_upper")
OPTIMAL = Headline(
    stamp="OPTIMAL TO ROUNDING",
    words="within {degrees} degrees (proved).",
    rests_on=(*_PROVED, "rounding_cost", "angle_upper_deg"),
    code=0,
    good=True,
)
OPTIMAL_NOT_UNIQUE = Headline(
    stamp="OPTIMAL TO ROUNDING",
    words="at most {gap} above the minimum (proved), as infinitely many poses are.",
    rests_on=(*_PROVED, "rounding_cost", "classification"),
    code=0,
)
NEAR_OPTIMAL = Headline(
    stamp="NEAR-OPTIMAL",
    words="within {degrees} degrees, at most {gap} ({share}) above the minimum (proved).",
    rests_on=(*_PROVED, "energy_range", "gap_share", "angle_upper_deg"),
    code=0,
)
NEAR_OPTIMAL_NOT_UNIQUE = Headline(
    stamp="NEAR-OPTIMAL",
    words="at most {gap} ({share}) above the minimum (proved); infinitely many poses have it.",
    rests_on=(*_PROVED, "energy_range", "gap_share", "classification"),
    code=0,
)


_POSE = ("optimality.growth", "gap_upper", "rounding_cost")
OPTIMAL_AS_OTHERS = Headline(
    stamp="OPTIMAL TO ROUNDING",
    words="at most {gap} above the minimum (proved), which several poses attain.",
    rests_on=(*_POSE, "optimum"),
    code=0,
)
OPTIMAL_UNDECIDED = replace(
    OPTIMAL_AS_OTHERS,
    words="at most {gap} above the minimum (proved); whether several poses attain that is not "
    "decided.",
)
NEAR_AS_OTHERS = replace(
    OPTIMAL_AS_OTHERS,
    stamp="NEAR-OPTIMAL",
    words="at most {gap} ({share}) above the minimum (proved), which several poses attain.",
    rests_on=(*_POSE, "gap_share"),
)
NEAR_UNDECIDED = replace(
    NEAR_AS_OTHERS,
    words="within {degrees} degrees of every optimum, at most {gap} ({share}) above the minimum "
    "(proved); whether there are several is not decided.",
    rests_on=(*_POSE, "gap_share", "angle_upper_deg"),
)
POSE_BOUNDED = replace(
    NEAR_AS_OTHERS,
    stamp="BOUNDED",
    words="at most {gap} ({share}) above the minimum (proved); whether an optimum is near is not "
    "decided.",
    code=4,
)


def _but(pose: Headline, reason: str, words: str, *rests_on: str) -> Headline:
    """The headline of a pose, and what is to be said against it."""
    return replace(
        pose,
        stamp=f"{pose.stamp}, BUT {reason}",
        words=f"{pose.words[:-1]}; {words}.",
        rests_on=(*pose.rests_on, *rests_on),
        good=False,
    )


def each(reason: str, words: str, *rests_on: str) -> tuple[Headline, Headline]:
    """Of a pose that is optimal, and of one that is near-optimal, what is to be said against it."""
    return _but(OPTIMAL, reason, words, *rests_on), _but(NEAR_OPTIMAL, reason, words, *rests_on)


RULED_OUT = each(
    "THE NOISE RULES IT OUT", "{sigmas} standard deviations from the optimum", "sigma_distance"
)
OF_DATA = {  # of the certified optimum: of a pose that is optimal, and of one that is near-optimal
    CERTIFIED: (OPTIMAL, NEAR_OPTIMAL),
    NEARLY_AMBIGUOUS: each("NEARLY AMBIGUOUS", "{tie}"),
    HARDLY_DETERMINED: each("THE ROTATION IS HARDLY DETERMINED", "{loose}"),
    POOR_FIT: each("THE FIT IS POOR", "{warning}", "fit.warnings"),
    SCALE_FITS: each("A SCALE FITS BETTER", "{warning}", "fit.warnings", "fit.best_scale"),
    HARDLY_RESISTED: each("A SHIFT IS HARDLY RESISTED", "{weak}", "springs.weak_translations"),
}
SPURIOUS = Headline(
    stamp="SPURIOUS-EQUILIBRIUM",
    words="{near} degrees{shift} from {name}{end}.",
    rests_on=("eigenvectors", "unstable_count", "nearest.angle_deg", "nearest.morse_index"),
    code=1,
)
NO_EQUILIBRIUM = Headline(
    stamp="NOT-AN-EQUILIBRIUM",
    words="{interval} above the minimum (proved).",
    rests_on=(*_PROVED, "gap_lower"),
    code=1,
)
NO_ROTATION = Headline(
    stamp="NOT-A-ROTATION",
    words="{fault}",
    rests_on=("quaternions", "verdict"),
    code=1,
)

_OF_WEIGHTS = [*(OF_DATA[one] for one in OF_DATA if one is not HARDLY_RESISTED), RULED_OUT]
HEADLINES = (
    *(CERTIFIED, NEARLY_AMBIGUOUS, HARDLY_DETERMINED, POOR_FIT, SCALE_FITS, NOT_UNIQUE),
    *(WITHIN_LIMITS, WITHIN_LIMITS_NOT_UNIQUE, WITHIN_LIMITS_FLAT),
    *(BOUNDED, BOUNDED_WITHOUT_ANGLE, BOUNDED_NOT_UNIQUE, BOUNDED_FLAT, NOT_CERTIFIED, WEAK),
    *(pair[0] for pair in _OF_WEIGHTS),
    OPTIMAL_NOT_UNIQUE,
    *(pair[1] for pair in _OF_WEIGHTS),
    *(NEAR_OPTIMAL_NOT_UNIQUE, SPURIOUS, NO_EQUILIBRIUM, NO_ROTATION),
    *(FREE_SHIFT, HARDLY_RESISTED, OTHERS_AS_GOOD, WITHIN_LIMITS_FREE),
    *(BOUNDED_FREE, UNDECIDED, UNDECIDED_NEAR, *OF_DATA[HARDLY_RESISTED]),
    *(OPTIMAL_AS_OTHERS, OPTIMAL_UNDECIDED, NEAR_AS_OTHERS, NEAR_UNDECIDED, POSE_BOUNDED),
)


def headline_of(registration: Registration) -> Headline:
    """Which headline a registration has."""
    status = registration.status
    if status is Optimality.NOT_CERTIFIED:
        return NOT_CERTIFIED
    if status is Optimality.BOUNDED:
        return _bounded(registration)
    usual = _meets_usual(registration)
    if registration.unique:
        return headline_of_data(registration) if usual else WITHIN_LIMITS
    if registration.equilibria is None:  # what is free is known, and not how many are optimal
        as_good = FREE_SHIFT if registration.solution.unique_rotation else OTHERS_AS_GOOD
        return as_good if usual else WITHIN_LIMITS_FREE
    if usual:
        return NOT_UNIQUE
    return WITHIN_LIMITS_FLAT if _is_flat(registration) else WITHIN_LIMITS_NOT_UNIQUE


def _meets_usual(registration: Registration) -> bool:
    """Whether what is proved is within the usual limits, whatever others were asked for."""
    turned = registration.solution.unique_rotation is True
    return registration.bounds is not None and registration.bounds.meet(Limits(), unique=turned)


def _is_flat(registration: Registration) -> bool:
    """Whether every rotation fits equally."""
    return registration.bounds is not None and not registration.bounds.least_range_squared


def headline_of_data(registration: Registration) -> Headline:
    """Of a certified and unique optimum: what its data make of the first line."""
    if registration.equilibria is not None and registration.equilibria.nearly_ambiguous:
        return NEARLY_AMBIGUOUS
    if registration.solution.weak_shifts:
        return HARDLY_RESISTED
    return HARDLY_DETERMINED if is_loose(registration) else _headline_of_fit(registration.fit)


def is_green(registration: Registration) -> bool:
    """Whether its headline is good, and within the usual limits, whatever others were asked for."""
    return _meets_usual(registration) and headline_of(registration).good


def is_loose(registration: Registration) -> bool:
    """Whether the noise, given or that of a good fit, leaves a turn about some axis open."""
    covariance, fit = registration.covariance, registration.fit
    if covariance is None or (covariance.estimated and (fit.warnings or fit.rounded)):
        return False
    return covariance.loosest_sigma > LOOSE_SIGMA


def loose_words(registration: Registration) -> str:
    """That the noise leaves a turn open, and about which axis; empty where it does not."""
    covariance = registration.covariance
    if covariance is None or not is_loose(registration):
        return ""
    whose = "noise as large as the residuals" if covariance.estimated else "the sigma given"
    return (
        f"five standard deviations of {whose} rule out no turn about the source's axis "
        f"{axis_words(covariance.loosest_axis)}"
    )


def _headline_of_fit(fit: Fit) -> Headline:
    """What the fit of an optimum far from a tie makes of the first line."""
    if not fit.warnings:
        return CERTIFIED
    off = abs((fit.best_scale or 0.0) - 1.0)
    alone = fit.codes == (FitCode.SCALE,)
    good = off <= SMALL_SCALE and (fit.explained or 0.0) >= GOOD_EXPLAINED
    return SCALE_FITS if alone and good else POOR_FIT


def _bounded(registration: Registration) -> Headline:
    listed, degrees = registration.equilibria is not None, proved_degrees(registration)
    if listed and _is_flat(registration):
        return BOUNDED_FLAT
    if registration.unique is None:
        return UNDECIDED if degrees is None else UNDECIDED_NEAR
    if not registration.unique:
        return BOUNDED_NOT_UNIQUE if listed else BOUNDED_FREE
    return BOUNDED_WITHOUT_ANGLE if degrees is None else BOUNDED


def headline_words(registration: Registration) -> str:
    """The first line of a registration, with its proved numbers."""
    bounds = registration.bounds
    gap, share = ("", "") if bounds is None else (at_most(bounds.greatest_gap), share_words(bounds))
    return headline_of(registration).said(
        gap=gap,
        share=share,
        degrees=proved_degrees(registration) or "180",
        free=_free_words(registration),
        warning=next((one.text for one in registration.fit.warnings), ""),
        loose=loose_words(registration),
        weak=weak_shift_words(registration.solution.weak_shifts),
    )


def _free_words(registration: Registration) -> str:
    """Why others are as good; where nothing is free, two poses tie."""
    free = registration.solution.freedom
    if isinstance(free, Absent):
        return ""
    if registration.solution.unique_rotation:
        return free.shift_words()
    return free.words() or "another pose is exactly as good"


def proved_degrees(registration: Registration) -> str | None:
    """The proved bound on the angle to every optimum; None where nothing is said."""
    return None if registration.bounds is None else degrees_words(registration.bounds)


def degrees_words(bounds: PoseBounds) -> str | None:
    """The proved bound on the angle, in degrees; None where it says nothing."""
    angle = bounds.angle_upper
    if angle is None or angle >= math.pi:
        return None
    return at_most(degrees_above(angle))


def share_words(bounds: PoseBounds) -> str:
    """The proved gap beside the range of energies over all rotations."""
    if not bounds.least_range_squared:
        return "every rotation fits equally"
    share = bounds.share_upper or 0.0
    if math.isinf(share):
        return "more than doubles hold times the range of energies"
    return f"{at_most(share)} {'of' if share < 1.0 else 'times'} the range of energies"


def interval_words(bounds: PoseBounds) -> str:
    """Proved bounds on the gap, rounded outwards: all of nine digits where they are that near."""
    if not bounds.least_gap:
        return f"at most {at_most(bounds.greatest_gap)}"
    return f"between {at_least(bounds.least_gap, 9)} and {at_most(bounds.greatest_gap, 9)}"
