"""What is said of a pose that was judged: the first line, and what else there is to say."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from certreg.exact.decimals import at_most
from certreg.exact.dyadic import nearest_root
from certreg.geometry.pose_matrix import UNNOTED_DEFECT, rotation_defect
from certreg.objective.structure import Structure
from certreg.registration.ambiguity import DISTINGUISHABLE, ambiguous_words, narrow_words
from certreg.registration.findings import GOOD, Findings, SigmaDistance, rules_out
from certreg.registration.gap_parts import is_scaled
from certreg.registration.headlines import (
    NEAR_AS_OTHERS,
    NEAR_OPTIMAL_NOT_UNIQUE,
    NEAR_UNDECIDED,
    NO_EQUILIBRIUM,
    OF_DATA,
    OPTIMAL_AS_OTHERS,
    OPTIMAL_NOT_UNIQUE,
    OPTIMAL_UNDECIDED,
    POSE_BOUNDED,
    RULED_OUT,
    SPURIOUS,
    Headline,
    degrees_words,
    headline_of_data,
    interval_words,
    loose_words,
    share_words,
)
from certreg.registration.rounding import rounding_remedy
from certreg.registration.weakly_constrained import weak_shift_words
from certreg.results import Absent, ComponentKind, Limits, PoseVerdict

if TYPE_CHECKING:
    from certreg.geometry.given import GivenPose
    from certreg.registration.landscape import Rest


UNNOTED_SHIFT = Fraction(1, 10**9)  # of the clouds' size
ROTATION_ALONE = " Only a rotation was given: it was judged with the best {} for it."
RIGID = " It has no scale of its own and was judged with scale 1."
NO_ANGLE = (
    "Not called near-optimal: whether one rotation alone is optimal is not decided, and no angle "
    "to an optimum is proved: where little is at stake, a pose far from every optimum costs as "
    "little."
)
GOOD_HEADLINES: Mapping[
    tuple[bool | None, bool], tuple[Headline, Headline]
] = {  # by whether one pose is optimal and equilibria are listed: optimal, or near
    (False, True): (OPTIMAL_NOT_UNIQUE, NEAR_OPTIMAL_NOT_UNIQUE),
    (False, False): (OPTIMAL_AS_OTHERS, NEAR_AS_OTHERS),
    (None, False): (OPTIMAL_UNDECIDED, NEAR_UNDECIDED),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class KindWords:
    """What is said otherwise of a kind of objective: what an RMSE is of, what rounding costs."""

    of_what: str
    can_cost: str
    costs: str


WORDS = {  # a bound; and a figure to second order
    Structure.LINEAR: KindWords(of_what="weighted", can_cost="up to", costs="at most"),
    Structure.QUARTIC: KindWords(of_what="along the springs", can_cost="about", costs="about"),
}


def headline_of_pose(
    facts: Findings, verdict: PoseVerdict, distance: SigmaDistance | Absent
) -> tuple[Headline, str]:
    """Which headline a pose has; and its words, with what is proved and what speaks against it."""
    registration, bounds = facts.registration, facts.bounds
    if verdict is PoseVerdict.SPURIOUS_EQUILIBRIUM and facts.place.rest is not None:
        return SPURIOUS, _spurious_headline(facts, facts.place.rest)
    if verdict is PoseVerdict.NOT_AN_EQUILIBRIUM:
        return NO_EQUILIBRIUM, NO_EQUILIBRIUM.said(interval=interval_words(bounds))
    chosen, tie = _good_headline(facts, verdict, distance), _tie_words(facts)
    said = chosen.said(
        degrees=degrees_words(bounds) or "180",
        gap=at_most(bounds.greatest_gap),
        share=share_words(bounds),
        warning=next((one.text for one in registration.fit.warnings), ""),
        loose=loose_words(registration),
        weak=weak_shift_words(registration.solution.weak_shifts),
        tie=tie[:1].lower() + tie.partition(":")[0][1:],
        sigmas="" if isinstance(distance, Absent) else f"{distance.value:.3g}",
    )
    return chosen, said


def _tie_words(facts: Findings) -> str:
    """That another equilibrium is nearly as good; empty where none is, or none are listed."""
    listed = facts.registration.equilibria
    return "" if listed is None else ambiguous_words(listed) or ""


def _good_headline(
    facts: Findings, verdict: PoseVerdict, distance: SigmaDistance | Absent
) -> Headline:
    if verdict is PoseVerdict.BOUNDED:
        return POSE_BOUNDED
    registration = facts.registration
    pair = RULED_OUT
    if not registration.unique:
        pair = GOOD_HEADLINES[registration.unique, registration.equilibria is not None]
    elif isinstance(distance, Absent) or not rules_out(registration, distance):
        pair = OF_DATA[headline_of_data(registration)]
    return pair[verdict is PoseVerdict.NEAR_OPTIMAL]


def _spurious_headline(facts: Findings, rest: Rest) -> str:
    apart = _apart(facts)
    shift = "" if apart is None else f", and {apart:.2g} between the centroids,"
    name, end = _listed_name(facts, rest.number) if rest.number else _name(rest)
    return SPURIOUS.said(near=f"{math.degrees(rest.angle):.2g}", shift=shift, name=name, end=end)


def _name(rest: Rest) -> tuple[str, str]:
    """What an equilibrium is called, and what else there is to say of it."""
    if rest.index:
        return f"an index-{rest.index} equilibrium", ""
    return "a stable equilibrium", ", at which a local method stops, and not the optimum"


def _listed_name(facts: Findings, number: int) -> tuple[str, str]:
    """The same of one that is listed."""
    components = facts.registration.equilibria.components
    component = components[number]
    name, worst = f"the index-{component.morse_index} equilibrium", "the worst rotation there is"
    if component.kind is not ComponentKind.POINT:
        kind = component.kind.value.replace("-", " ")
        name = f"a {kind} of index-{component.morse_index} equilibria"
        worst = "the worst rotations there are"
    return name, f": {worst}" if number == len(components) - 1 else ""


def words_of_pose(facts: Findings, verdict: PoseVerdict, given: GivenPose) -> str:
    """What else is to be said of it, in a sentence or two, and of what was given."""
    if verdict in GOOD:
        words = _good_words(facts, verdict)
    elif verdict is PoseVerdict.BOUNDED:
        words = f"{NO_ANGLE} {_rounding_words(facts)}"
    elif verdict is PoseVerdict.SPURIOUS_EQUILIBRIUM and facts.place.rest is not None:
        words = _spurious_words(facts, facts.place.rest)
    else:
        words = _bad_words(facts)
    if facts.parts is not None and verdict is not PoseVerdict.OPTIMAL:
        words += facts.parts.words
    return words + _note_on(facts, given)


def _bad_words(facts: Findings) -> str:
    """Of a pose that is at no equilibrium, as far as is known: how far it is from the optimum."""
    away = None if facts.away is None else math.degrees(facts.away)
    if facts.place.rest is None or facts.place.rest.number is None:
        where = "" if away is None else f" The rotation is {away:.4g} degrees from the optimum."
        return f"The pose is not optimal.{where}"
    words = "This is no equilibrium: a small move lowers the energy. "
    if facts.place.rest.number:
        degrees = math.degrees(facts.place.rest.angle)
        words += f"The nearest one has index {facts.place.rest.index}, {degrees:.4g} degrees away; "
    else:
        words += f"The nearest one is {'the' if facts.unique else 'an'} optimum; "
    words = f"{words}{_the_optimum(facts)} is {away:.4g} degrees away{_shift_words(facts)}."
    if facts.bounds.greatest_gap <= facts.rounding_cost:
        matters = Fraction(Limits().max_gap) * facts.place.energy_range
        remedy = rounding_remedy(facts.registration.solution.moments, matters)
        words += f" The rounding of its numbers to doubles can cost that much: {remedy}."
    return f"{words}{_doubt_words(facts)}"


def _the_optimum(facts: Findings) -> str:
    return "the global optimum" if facts.unique else "the nearest optimum"


def _rounding_words(facts: Findings) -> str:
    costs = WORDS[facts.registration.structure].costs
    cost = at_most(facts.rounding_cost)
    return f"Rounding the numbers of the optimal pose to doubles costs {costs} {cost}."


def _good_words(facts: Findings, verdict: PoseVerdict) -> str:
    """What the gap is beside the rounding of the pose, and whether others are as good."""
    gap, cost = at_most(facts.bounds.greatest_gap), at_most(facts.rounding_cost)
    if verdict is PoseVerdict.OPTIMAL:
        can, own = WORDS[facts.registration.structure].can_cost, facts.proof_gap
        leaves = (
            f", and the proof itself leaves {at_most(own)}" if own > facts.rounding_cost else ""
        )
        words = (
            f"Its objective is at most {gap} above the minimum: rounding the numbers of the "
            f"optimal pose to doubles can cost {can} {cost}{leaves}."
        )
    else:
        words = _rounding_words(facts)
        if facts.away is not None:
            away, nearest = math.degrees(facts.away), "" if facts.unique else "nearest "
            words = (
                f"It is {away:.4g} degrees from the {nearest}optimum{_shift_words(facts)}. {words}"
            )
    listed = facts.registration.equilibria
    if listed is None:
        return words
    if listed.classification.ambiguity is not None:
        return f"{words} The optimum is not the only one: {listed.classification.ambiguity.value}."
    doubt = ambiguous_words(listed) or narrow_words(listed)
    return words if doubt is None else f"{words} {doubt[0].upper()}{doubt[1:].removesuffix('.')}."


def _spurious_words(facts: Findings, rest: Rest) -> str:
    many = f"{rest.index} direction{'s' * (rest.index > 1)}"
    how = (
        f"but the energy falls in {many}"
        if rest.index
        else "and every small turn raises the energy"
    )
    away = None if facts.away is None else math.degrees(facts.away)
    if rest.number is None:
        where = "" if away is None else f" The rotation is {away:.4g} degrees from the optimum."
        return f"Forces and torques balance there, {how}.{where}"
    component = facts.registration.equilibria.components[rest.number]
    if component.unstable_eigenvalues is not None:
        how = f"but it is unstable in {many}"
    return (
        f"Forces and torques balance there, {how}, and the pose is "
        f"{away:.6g} degrees from {_the_optimum(facts)}.{_doubt_words(facts)}"
    )


def _doubt_words(facts: Findings) -> str:
    """What speaks for a pose that is judged badly: that the data hardly tell it from the optimum.

    With sigma the objective is twice the negative log-likelihood: 25 more are five deviations.
    """
    registration, words = facts.registration, ""
    if registration.equilibria.nearly_ambiguous:
        words = " The optimum itself is nearly ambiguous: its rotation is not to be relied on."
    elif loose := loose_words(registration):
        words = f" The optimum's rotation is hardly determined: {loose}."
    given = registration.problem.noise_given and not registration.fit.warnings
    if given and facts.bounds.greatest_gap < DISTINGUISHABLE:
        words += " At the sigma given five standard deviations do not rule this pose out."
    return words


def _shift_words(facts: Findings) -> str:
    """How far the centroids are apart, where that is more than rounding."""
    apart = _apart(facts)
    return "" if apart is None else f" and the centroids {apart:.6g} apart"


def _apart(facts: Findings) -> float | None:
    """The distance of the centroids; None where it is rounding, or springs differ by direction."""
    small = facts.place.translation_energy <= UNNOTED_SHIFT**2 * facts.place.energy_range
    if small or facts.registration.equilibria is None:
        return None
    return nearest_root(
        facts.place.translation_energy / facts.registration.solution.moments.total_weight
    )


def _note_on(facts: Findings, given: GivenPose) -> str:
    """What was judged, where that is not just the pose as it was given."""
    scaled, moves = facts.parts is not None, facts.registration.problem.motion.translations > 0
    if scaled and given.scale is not None:
        return "" if is_scaled(given) else RIGID
    names = " and ".join([*["scale"] * scaled, *["translation"] * moves])
    note = ROTATION_ALONE.format(names) if names and given.translation is None else ""
    defect = rotation_defect(given.turn) if given.is_matrix and moves and not scaled else 0.0
    if defect > UNNOTED_DEFECT:
        note += (
            f" (The matrix is off a rotation by {defect:.1e} and was judged as the nearest one "
            "about the source's centroid.)"
        )
    return note
