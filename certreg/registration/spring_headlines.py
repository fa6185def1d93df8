"""The first line of an answer about general springs: what it says, and what it rests on."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from certreg.exact import at_most
from certreg.registration.headlines import (
    BOUNDED,
    BOUNDED_WITHOUT_ANGLE,
    CERTIFIED,
    HARDLY_DETERMINED,
    LIMITED,
    NOT_CERTIFIED,
    OF_DATA,
    POOR_FIT,
    WITHIN_LIMITS,
    Headline,
    degrees_words,
    each,
    is_loose,
    loose_words,
    share_words,
)
from certreg.registration.weak_shifts import weak_shift_words
from certreg.results import Limits, Optimality

if TYPE_CHECKING:
    from certreg.registration.quartic import QuarticSolution
    from certreg.registration.result import Registration

_GAP = ("optimality.growth", "optimality.gap_bound", "optimality.gap_share")
_ANGLE = "optimality.angle_bound_rad"
_UNIQUE = (*_GAP, _ANGLE, "optimality.unique")
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
    rests_on=(*_GAP, "springs.free_translations", "springs.symmetry_dimension"),
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
    rests_on=_GAP,
    code=4,
)
UNDECIDED_NEAR = replace(
    UNDECIDED,
    words="within {gap} of the minimum ({share}), within {degrees} degrees of every optimum; "
    "whether there are several is not decided.",
    rests_on=(*_GAP, _ANGLE),
)
TIE = "another pose is exactly as good"

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
OPTIMAL_HARDLY_RESISTED, NEAR_HARDLY_RESISTED = each(
    "A SHIFT IS HARDLY RESISTED", "{weak}", "springs.weak_translations"
)
SPRING_OF_DATA = {  # as `OF_DATA`
    **OF_DATA,
    HARDLY_RESISTED: (OPTIMAL_HARDLY_RESISTED, NEAR_HARDLY_RESISTED),
}

SPRING_HEADLINES = (
    *(FREE_SHIFT, HARDLY_RESISTED, OTHERS_AS_GOOD, WITHIN_LIMITS_FREE),
    *(BOUNDED_FREE, UNDECIDED, UNDECIDED_NEAR),
    *(OPTIMAL_HARDLY_RESISTED, NEAR_HARDLY_RESISTED),
    *(OPTIMAL_AS_OTHERS, OPTIMAL_UNDECIDED, NEAR_AS_OTHERS, NEAR_UNDECIDED),
    POSE_BOUNDED,
)


def spring_headline_of(registration: Registration[QuarticSolution]) -> Headline:
    """Which headline a registration of general springs has."""
    status, turned = registration.status, registration.solution.unique_rotation
    if status is Optimality.NOT_CERTIFIED:
        return NOT_CERTIFIED
    if status is Optimality.BOUNDED:
        return _bounded(registration)
    usual = _meets_usual(registration)
    if registration.unique:
        return headline_of_spring_data(registration) if usual else WITHIN_LIMITS
    if not usual:
        return WITHIN_LIMITS_FREE
    return FREE_SHIFT if turned else OTHERS_AS_GOOD


def _meets_usual(registration: Registration[QuarticSolution]) -> bool:
    """Whether what is proved is within the usual limits, whatever others were asked for."""
    turned = registration.solution.unique_rotation is True
    return registration.bounds is not None and registration.bounds.meet(Limits(), unique=turned)


def headline_of_spring_data(registration: Registration[QuarticSolution]) -> Headline:
    """Of a certified and unique optimum: what its data make of the first line."""
    if registration.solution.weak_shifts:
        return HARDLY_RESISTED
    if is_loose(registration):
        return HARDLY_DETERMINED
    return POOR_FIT if registration.fit.warnings else CERTIFIED


def _bounded(registration: Registration[QuarticSolution]) -> Headline:
    degrees = spring_degrees(registration)
    if registration.unique is None:
        return UNDECIDED if degrees is None else UNDECIDED_NEAR
    if not registration.unique:
        return BOUNDED_FREE
    return BOUNDED_WITHOUT_ANGLE if degrees is None else BOUNDED


def spring_headline_words(registration: Registration[QuarticSolution]) -> str:
    """The first line, with its numbers."""
    bounds = registration.bounds
    numbers = dict.fromkeys(("gap", "share"), "")
    if bounds is not None:
        numbers = {"gap": at_most(bounds.greatest_gap), "share": share_words(bounds)}
    return spring_headline_of(registration).said(
        **numbers,
        degrees=spring_degrees(registration) or "180",
        free=free_words(registration),
        warning=next((one.text for one in registration.fit.warnings), ""),
        loose=loose_words(registration),
        weak=weak_shift_words(registration.solution.weak_shifts),
    )


def free_words(registration: Registration[QuarticSolution]) -> str:
    """Why others are as good; where nothing is free, two poses tie."""
    free = registration.solution.freedom
    if registration.solution.unique_rotation:
        return free.shift_words()
    return free.words() or TIE


def spring_degrees(registration: Registration[QuarticSolution]) -> str | None:
    """The proved bound on the angle to every optimum; None where nothing is said."""
    return None if registration.bounds is None else degrees_words(registration.bounds)


def is_green_spring(registration: Registration[QuarticSolution]) -> bool:
    """Whether its headline is good, and within the usual limits, whatever others were asked for."""
    return _meets_usual(registration) and spring_headline_of(registration).good
