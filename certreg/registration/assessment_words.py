"""What is said of a pose that was judged: the first line, and what else there is to say."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import TYPE_CHECKING

from certreg.exact.decimals import at_most
from certreg.exact.dyadic import nearest_root
from certreg.geometry.pose_matrix import UNNOTED_DEFECT, rotation_defect
from certreg.registration.ambiguity import DISTINGUISHABLE, ambiguous_words, narrow_words
from certreg.registration.findings import GOOD, rules_out
from certreg.registration.headlines import (
    NEAR_OPTIMAL_NOT_UNIQUE,
    NO_EQUILIBRIUM,
    OF_DATA,
    OPTIMAL_NOT_UNIQUE,
    RULED_OUT,
    SPURIOUS,
    degrees_words,
    headline_of_data,
    interval_words,
    loose_words,
    share_words,
)
from certreg.registration.rounding import rounding_remedy
from certreg.results import Absent, ComponentKind, Limits, PoseVerdict

if TYPE_CHECKING:
    from certreg.geometry.given import GivenPose
    from certreg.problem.problem import RegistrationProblem
    from certreg.registration.findings import Findings, SigmaDistance
    from certreg.registration.headlines import Headline


UNNOTED_SHIFT = Fraction(1, 10**9)  # of the clouds' size
ROTATION_ALONE = " Only a rotation was given: it was judged with the best translation for it."


def headline_of_pose(
    facts: Findings, verdict: PoseVerdict, distance: SigmaDistance | Absent
) -> tuple[Headline, str]:
    """Which headline a pose has; and its words, with what is proved and what speaks against it."""
    registration, bounds = facts.registration, facts.bounds
    if verdict is PoseVerdict.SPURIOUS_EQUILIBRIUM:
        return SPURIOUS, _spurious_headline(facts)
    if verdict not in GOOD:
        return NO_EQUILIBRIUM, NO_EQUILIBRIUM.said(interval=interval_words(bounds))
    chosen, degrees = _good_headline(facts, verdict, distance), degrees_words(bounds)
    tie = ambiguous_words(registration.equilibria)
    said = chosen.said(
        degrees=degrees or "180",
        gap=at_most(bounds.greatest_gap),
        share=share_words(bounds),
        warning=next((one.text for one in registration.fit.warnings), ""),
        loose=loose_words(registration),
        tie=tie[0].lower() + tie.partition(":")[0][1:] if tie else "",
        sigmas="" if isinstance(distance, Absent) else f"{distance.value:.3g}",
    )
    return chosen, said


def _good_headline(
    facts: Findings, verdict: PoseVerdict, distance: SigmaDistance | Absent
) -> Headline:
    optimal = verdict is PoseVerdict.OPTIMAL
    if not facts.unique:
        return OPTIMAL_NOT_UNIQUE if optimal else NEAR_OPTIMAL_NOT_UNIQUE
    of_data = OF_DATA[headline_of_data(facts.registration)]
    if not isinstance(distance, Absent) and rules_out(facts.registration, distance):
        of_data = RULED_OUT
    return of_data[0 if optimal else 1]


def _spurious_headline(facts: Findings) -> str:
    components = facts.registration.equilibria.components
    component = components[facts.nearest]
    name = f"the index-{component.morse_index} equilibrium"
    if component.kind is not ComponentKind.POINT:
        kind = component.kind.value.replace("-", " ")
        name = f"a {kind} of index-{component.morse_index} equilibria"
    last = facts.nearest == len(components) - 1
    single = component.kind is ComponentKind.POINT
    worst = "the worst rotation there is" if single else "the worst rotations there are"
    end = f": {worst}" if last else ""
    near = f"{math.degrees(facts.angles[facts.nearest]):.2g}"
    apart = _apart(facts)
    shift = "" if apart is None else f", and {apart:.2g} between the centroids,"
    return SPURIOUS.said(near=near, shift=shift, name=name, end=end)


def words_of_pose(facts: Findings, verdict: PoseVerdict) -> str:
    """What else is to be said of it, in a sentence or two."""
    equilibria = facts.registration.equilibria
    away = math.degrees(facts.away)
    if verdict in GOOD:
        return _good_words(facts, verdict)
    if verdict is PoseVerdict.SPURIOUS_EQUILIBRIUM:
        return _spurious_words(facts)
    nearest = equilibria.components[facts.nearest]
    words = "This is no equilibrium: a small move lowers the energy. "
    if facts.nearest > 0:
        degrees = math.degrees(facts.angles[facts.nearest])
        words += f"The nearest one has index {nearest.morse_index}, {degrees:.4g} degrees away; "
    else:
        words += f"The nearest one is {'the' if facts.unique else 'an'} optimum; "
    words = f"{words}{_the_optimum(facts)} is {away:.4g} degrees away{_shift_words(facts)}."
    if facts.bounds.greatest_gap <= facts.rounding_cost:
        matters = Fraction(Limits().max_gap) * facts.energy_range
        remedy = rounding_remedy(facts.registration.solution.moments, matters)
        words += f" The rounding of its numbers to doubles can cost that much: {remedy}."
    return f"{words}{_doubt_words(facts)}"


def _the_optimum(facts: Findings) -> str:
    return "the global optimum" if facts.unique else "the nearest optimum"


def _good_words(facts: Findings, verdict: PoseVerdict) -> str:
    """What the gap is beside the rounding of the pose, and whether others are as good."""
    gap, cost = at_most(facts.bounds.greatest_gap), at_most(facts.rounding_cost)
    if verdict is PoseVerdict.OPTIMAL:
        words = (
            f"Its objective is at most {gap} above the minimum: rounding the numbers of the "
            f"optimal pose to doubles can cost up to {cost}."
        )
    else:
        away = math.degrees(facts.away)
        nearest = "the optimum" if facts.unique else "the nearest optimum"
        words = (
            f"It is {away:.4g} degrees from {nearest}{_shift_words(facts)}. Rounding the numbers "
            f"of the optimal pose to doubles costs at most {cost}."
        )
    ambiguity = facts.registration.equilibria.classification.ambiguity
    if ambiguity is not None:
        words += f" The optimum is not the only one: {ambiguity.value}."
    elif (tie := ambiguous_words(facts.registration.equilibria)) is not None:
        words += f" {tie}"
    elif (narrow := narrow_words(facts.registration.equilibria)) is not None:
        words += f" {narrow[0].upper()}{narrow[1:]}."
    return words


def _spurious_words(facts: Findings) -> str:
    component = facts.registration.equilibria.components[facts.nearest]
    many = f"{component.morse_index} direction{'s' * (component.morse_index > 1)}"
    how = f"it is unstable in {many}"
    if component.unstable_eigenvalues is None:
        how = f"the energy falls in {many}"
    return (
        f"Forces and torques balance there, but {how}, and the pose is "
        f"{math.degrees(facts.away):.6g} degrees from {_the_optimum(facts)}.{_doubt_words(facts)}"
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
    """The distance of the centroids; None where it is rounding."""
    moments = facts.registration.solution.moments
    if facts.translation_energy <= UNNOTED_SHIFT**2 * facts.energy_range:
        return None
    return nearest_root(facts.translation_energy / moments.total_weight)


def note_on(problem: RegistrationProblem, given: GivenPose) -> str:
    """What was judged, where that is not just the pose as it was given."""
    if not problem.motion.translations:
        return ""
    note = "" if given.translation is not None else ROTATION_ALONE
    defect = rotation_defect(given.turn) if given.is_matrix else 0.0
    if defect > UNNOTED_DEFECT:
        note += (
            f" (The matrix is off a rotation by {defect:.1e} and was judged as the nearest one "
            "about the source's centroid.)"
        )
    return note
