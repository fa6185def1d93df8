"""What the page says in sentences: what is proved and by which theorem, and what is not claimed."""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from certreg._loading import late
from certreg.certificate.bounds import sin2_half_angle_between
from certreg.exact.decimals import at_least, at_most
from certreg.exact.dyadic import degrees_above, half_angle_bound, rational_root_above
from certreg.problem.motion import SCALE, TRANSLATION, Scale
from certreg.registration.headlines import proved_degrees
from certreg.registration.result import Method, Registration
from certreg.report.equilibria import count_words, inside_out_words, scaled_count_words
from certreg.report.fields import scale_interval
from certreg.report.lines import bounds_nothing, margin_words
from certreg.report.parts import listed, sprung
from certreg.report.pose_words import gap_words
from certreg.report.robustness import robustness_words
from certreg.report.scale import BIAS, printed_interval, rests_of
from certreg.report.scene_words import lie_words
from certreg.report.sentences import Sentence, begun, sentence
from certreg.report.springs import few_words, how_words, relaxation_words, soft_words
from certreg.results import Absent, ComponentKind, Guarantee

if TYPE_CHECKING:
    from certreg.certificate.isotropic import Claims, IsotropicBody
    from certreg.registration.agreement import Agreement
    from certreg.registration.quartic import QuarticSolution
    from certreg.report import simulation
    from certreg.report.rest_sections import Listed
else:
    # of which few results have a free scale
    simulation = late("certreg.report.simulation")


NOT_CLAIMED = (
    "that the correspondences are right: a wrong pair is registered as faithfully as a right one;",
    "that the noise is Gaussian, or the bodies rigid;",
    "that the optimum is close to the truth: only how well any pose can fit these numbers;",
    "where the points come from, nor what the certificate says under `about`: names and labels.",
)
NAMES = {
    ComponentKind.POINT: "one pose",
    ComponentKind.CIRCLE: "a circle of poses",
    ComponentKind.PROJECTIVE_PLANE: "a projective plane of poses",
    ComponentKind.ROTATION_GROUP: "every rotation",
}
RESTS_ON = {
    Method.SQUARES: ("quartic_relaxation", "growth_form"),
    Method.CONES: ("bernstein_cones", "spring_caps", "growth_form"),
    Method.ENERGY: (),
}
ELIMINATED = ((TRANSLATION, "translation_gap"), (SCALE, "scale_elimination"))  # by which theorems
ELIMINATED_BY_SPRINGS = ((TRANSLATION, "spring_translation"),)
SHIFTED = ((TRANSLATION, ", with whatever translation"),)
DIVIDED = {Scale.SYMMETRIC: " divided by the scale"}  # what is minimised
RIGHT_SPRINGS = (
    "that the springs are right: normals, directions and covariances are taken as they are "
    "given, and so are those that an iterative method froze at the rotation of its last step;"
)
ALONE = "whether one rotation alone is optimal: that is not decided;"
MANY = "general springs have up to forty equilibria, or infinitely many, stable ones among them"
NOWHERE = f"where else the springs balance: {MANY}, and this page lists none;"
NOT_ALL = f"that no equilibria are missing in the list above: {MANY};"
LIST_ALONE = "The list was made for this page, and the certificate below does not hold it"
LIST_CERTIFIED = "certreg equilibria --out writes one that does."
COUNTED = ("breathing_equilibria", "descartes")
SAME_SIZE = "The symmetric scale is the same whatever the rotation, also at these poses."
ROUNDED = "Poses, scales, energies and RMSE are rounded to doubles from at least 57 digits."
ROUNDED_ALONE = "The pose and its energy are rounded to doubles from far more digits."
OF_SPECTRUM = (
    "Poses, energies and RMSE are rounded to doubles from at least 57 digits. The "
    "eigenvalues in the chart are computed in double precision; the signs of their real "
    "parts are exact."
)
SAME_ROTATION = 0.1  # degrees: methods that find it end nearer; a run stops a little before


def sentences(registration: Registration, body: Any, found: Listed | None = None) -> list[Sentence]:
    """What the page says is known; the checker has accepted what the certificate claims.

    found: the equilibria of general springs that the page lists.
    """
    own, springs = listed(registration), sprung(registration)
    known = [*_optimality(registration)]
    known += [] if own is None else [*uniqueness_sentences(own), *_scale(own), *_rests(own, body)]
    if springs is not None:
        known += [*_uniqueness(springs), *_growth(springs), *_list(found)]
    known += robustness_sentences(registration)
    if springs is not None:
        words = f"The semidefinite relaxation: {relaxation_words(springs)}."
        known += [_computed(ROUNDED_ALONE), _computed(words)]
    return known if own is None else [*known, *_numbers(own)]


def not_claimed(
    registration: Registration, found: Listed | None = None, untested: str = ""
) -> tuple[str, ...]:
    """What the page does not say; untested: which tests of the fit are not made."""
    *before, last = NOT_CLAIMED
    own = [f"that all rows belong: {untested};"] if untested else []
    if (bias := BIAS.get(registration.problem.scale)) is not None:
        own.append(f"that noise leaves the scale alone: {bias};")
    if registration.problem.springs is not None:
        own += _not_claimed_of_springs(registration, found)
    return (*before, *own, last)


def _not_claimed_of_springs(registration: Registration, found: Listed | None) -> list[str]:
    own = [RIGHT_SPRINGS]
    if registration.solution.unique_rotation is None:
        own.append(ALONE)
    if found is None or found.table is None:
        own.append(NOWHERE)
    elif not found.complete:
        own.append(NOT_ALL)
    return own


def _computed(words: str, *theorems: str) -> Sentence:
    return Sentence(words=words, guarantee=Guarantee.NUMERICAL, theorems=theorems)


def _proved(words: str, *theorems: str) -> Sentence:
    return Sentence(words=words, guarantee=Guarantee.EXACT, theorems=theorems)


def robustness_sentences(registration: Registration) -> Iterator[Sentence]:
    """How far the points may be off, if it is proved."""
    if registration.robustness is None:
        return
    words = sentence(robustness_words(registration))
    if registration.problem.springs is not None:
        yield _proved(words, "growth_radius")
        return
    yield _proved(
        words, "eigenvector_radius", *["scale_radius"] * (registration.problem.scale in BIAS)
    )


def weak_words(registration: Registration) -> str:
    """What a certificate proves that proves less than could be proved."""
    bounds, degrees = registration.bounds, proved_degrees(registration)
    gap = "an unknown amount" if bounds is None else at_most(bounds.greatest_gap)
    angle = (
        "of its angle to the best one they say nothing (the checker's words below may prove more)"
    )
    if degrees is not None:
        angle = f"its rotation is within {degrees} degrees of the best one"
    return (
        "Of the pose given below with all digits its claims prove this: its objective exceeds the "
        f"minimum by at most {gap}, and {angle}. The certificate that certreg certify writes "
        "for these points proves more."
    )


def _optimality(registration: Registration) -> Iterator[Sentence]:
    bounds, problem = registration.bounds, registration.problem
    if bounds is None:
        return
    motion, end = problem.motion, ""
    what = f"the sum of weighted squared distances{DIVIDED.get(problem.scale, '')}"
    theorems = ["optimality_certificate", *motion.entries(ELIMINATED)]
    springs = sprung(registration)
    if springs is not None and springs.method is not None:
        what, end = "the energy of the springs", f" It is proved by {how_words(springs)}."
        theorems = [*RESTS_ON[springs.method], *motion.entries(ELIMINATED_BY_SPRINGS)]
    words = f"{gap_words(motion, what, bounds.greatest_gap)}{end}"
    yield _proved(words, *theorems)


def uniqueness_sentences(registration: Registration) -> Iterator[Sentence]:
    """Whether one rotation is the best, and how far at most the given one is from it."""
    if registration.bounds is None:
        return
    degrees = proved_degrees(registration)
    if degrees is not None:
        yield _proved(
            (
                "The best rotation is unique, and that of the quaternion given below is within "
                f"{degrees} degrees of it."
            ),
            "optimality_certificate",
            "classification",
        )
        return
    if registration.equilibria.classification.unique:
        yield _proved(
            (
                "The best rotation is unique. How far it is from that of the quaternion given "
                "below is not claimed."
            ),
            "classification",
        )
        return
    kind = NAMES[registration.equilibria.components[0].kind]
    yield _proved(
        f"The best rotation is not unique: the optima are {kind}, all exactly as good.",
        "classification",
    )


def _uniqueness(registration: Registration[QuarticSolution]) -> Iterator[Sentence]:
    solution, degrees = registration.solution, proved_degrees(registration)
    free = solution.freedom
    if words := free.turn_words():
        yield _proved(sentence(words))
    if words := free.shift_words():
        theorems = ("spring_translation",)
        yield _proved(sentence(words), *theorems)
    if solution.unique_rotation:
        far = "" if degrees is None else f" It is within {degrees} degrees of the one given below."
        words = f"One rotation alone is optimal.{far}"
        yield _proved(words, "growth_form")
    elif solution.unique_rotation is False and not free.turn_words():
        words = "Two rotations at least are optimal, exactly as good as one another."
        yield _proved(words)
    elif solution.unique_rotation is None:
        if degrees is not None:
            words = f"Every optimal rotation is within {degrees} degrees of the one given below."
            yield _proved(words, "growth_form")
        if soft := soft_words(registration):
            yield _computed(sentence(soft))
        if few := few_words(registration):
            yield _proved(sentence(few))


def _growth(registration: Registration[QuarticSolution]) -> Iterator[Sentence]:
    certificate = registration.certificate
    if certificate is None or not certificate.body.growth:
        return
    mu, delta = certificate.body.growth, certificate.body.gap
    shifted = "".join(registration.problem.motion.entries(SHIFTED))
    yield _proved(
        (
            "A rotation that is turned by an angle a from the certified one costs at least "
            f"{at_least(mu)} sin²(a/2) - {at_most(delta)} more{shifted}."
        ),
        "growth_form",
    )


def _list(found: Listed | None) -> Iterator[Sentence]:
    if found is not None and found.complete:
        forty = "forty_lines" in found.theorems  # of others no certificate is made
        end = f": {LIST_CERTIFIED}" if forty else "."
        yield Sentence(
            words=f"{found.words} {LIST_ALONE}{end}",
            guarantee=found.guarantee,
            theorems=found.theorems,
        )


def _scale(registration: Registration) -> Iterator[Sentence]:
    if isinstance(bounds := scale_interval(registration), Absent):
        return
    low, high = printed_interval(bounds)
    words = (
        f"The scale of every optimum is at least {low} and at most {high}; the certificate has "
        "both in more digits."
    )
    yield _proved(words, "optimality_certificate", "scale_elimination")


def _rests(registration: Registration, body: Any) -> Iterator[Sentence]:
    """Where the body can rest, and whether its motion keeps its size above 0."""
    found = rests_of(registration)
    if found is None:
        yield from motion_sentences(registration, body)
        return
    if found.breathing is None:
        yield rest_sentence(registration)
        yield _proved(SAME_SIZE, "scale_elimination")
        return
    indices = ", ".join(str(each.component.morse_index) for each in found.components)
    index = "index" if len(found.components) == 1 else "indices"
    which = f", of {index} {indices}" if found.components else ""
    words = (
        "Poses at which a body can rest whose size is free: "
        f"{scaled_count_words(found)}{which}. The list is complete."
    )
    yield Sentence(words=words, guarantee=found.guarantee, theorems=COUNTED)
    words = inside_out_words(found.breathing)
    yield _proved(words, *COUNTED)
    trajectory = registration.solution.trajectory
    if not isinstance(trajectory, Absent) and trajectory.never_collapses:
        words = sentence(simulation.KEEPS.removeprefix("Proved: "))
        yield _proved(begun(words), "breathing_confined")


def motion_sentences(registration: Registration, body: IsotropicBody) -> Iterator[Sentence]:
    """Where a rigid body can rest, where it moves to, and what the relaxation proves."""
    yield rest_sentence(registration)
    yield from _stability(registration, body.claims)
    yield from _basin(registration, body)
    yield from _dual(registration, body.claims)


def rest_sentence(registration: Registration) -> Sentence:
    """Which equilibria a rigid body has."""
    equilibria = registration.equilibria
    counted = count_words(equilibria).split(": ", 1)[1][:-1]
    every = equilibria.components[0].kind is ComponentKind.ROTATION_GROUP
    begun = f"There {'is' if counted.startswith('one ') else 'are'} {counted}"
    begun = counted.capitalize() if every else begun
    named = ", ".join(f"{NAMES[c.kind]} of index {c.morse_index}" for c in equilibria.components)
    return Sentence(
        words=f"{begun}: {named}. The list is complete.",
        guarantee=equilibria.guarantee,
        theorems=("eigenvectors", "classification"),
    )


def _stability(registration: Registration, claims: Claims) -> Iterator[Sentence]:
    equilibria = registration.equilibria
    unstable = equilibria.classification.unstable
    if unstable is None:
        yield Sentence(
            words=(
                f"The source points {lie_words(registration)}, so the dynamics of the body is not "
                "defined. "
                "The energy falls in as many directions as the index says."
            ),
            guarantee=equilibria.guarantee,
            theorems=("classification",),
        )
    elif len(unstable) > 1 and claims.unstable is not None:
        counts = ", ".join(map(str, unstable))
        yield Sentence(
            words=(
                f"In this order they have {counts} growing modes: whatever is not optimal is "
                "unstable: there are pushes, however small, after which a body leaves it."
            ),
            guarantee=equilibria.guarantee,
            theorems=("unstable_count", "instability"),
        )


def _basin(registration: Registration, body: IsotropicBody) -> Iterator[Sentence]:
    """What is proved of the state in the certificate, and whether a simulation ended there.

    Any state in the basin passes the checker: only one that is where the simulation computed beside
    it ended, number by number, is said to be that.
    """
    state = body.basin
    if not body.claims.basin or state is None:
        return
    off = half_angle_bound(sin2_half_angle_between(body.quaternion, state.quaternion))
    spin = rational_root_above(sum((w * w for w in state.spin), start=Fraction(0)))
    yield _proved(
        (
            "From the state in the certificate, within "
            f"{at_most(degrees_above(off), 2)}° of its pose and turning by at most "
            f"{at_most(spin, 2)} radians per unit of time, the exact motion can end nowhere but at "
            "the optimum, whatever the damping."
        ),
        "certified_basin",
    )
    if not isinstance(registration.solution.trajectory, Absent):
        verb = "is" if registration.solution.ended_in(state) else "is not"
        yield _computed(f"That {verb} the state in which {_simulation_name(registration)} ended.")


def _simulation_name(registration: Registration) -> str:
    """The simulation beside a certificate, as it was run."""
    trajectory = registration.solution.trajectory
    if isinstance(trajectory, Absent):
        return "the simulation"
    damping = registration.problem.damping
    return f"the simulation for this page ({trajectory.integrator.value}, damping {damping:.6g})"


def _dual(registration: Registration, claims: Claims) -> Iterator[Sentence]:
    gap = claims.sdp_gap
    if gap is not None:
        worth = ""
        if bounds_nothing(registration, gap.value):
            worth = " It bounds nothing: the range of energies may be smaller."
        yield _proved(
            (
                "The dual of the semidefinite relaxation, rounded outwards, bounds the gap "
                f"of the certified rotation independently: at most {at_most(gap.value)}.{worth}"
            ),
            "dual_bound",
        )


def _numbers(registration: Registration) -> Iterator[Sentence]:
    moves_otherwise = registration.problem.motion.options
    yield _computed(ROUNDED) if moves_otherwise else _computed(OF_SPECTRUM, "spectrum")
    yield methods_sentence(registration, registration.solution.agreement)
    if registration.problem.scale not in BIAS:
        words = f"The ambiguity margin is {margin_words(registration.equilibria)}."
        yield _computed(words, "classification")


def methods_sentence(registration: Registration, methods: Agreement) -> Sentence:
    """Which methods lead to the rotation that is printed, and which do not."""
    angles = {
        "the closed form": methods.closed_form,
        "the semidefinite relaxation": methods.relaxation,
        _simulation_name(registration): methods.simulation,
    }
    ran = {name: math.degrees(angle) for name, angle in angles.items() if angle is not None}
    apart = [name for name, angle in ran.items() if not angle <= SAME_ROTATION]
    near = [f"{name} to {at_most(angle, 1)}°" for name, angle in ran.items() if name not in apart]
    unique = registration.equilibria.classification.unique
    end = "the same rotation" if unique else "an optimum, not always the same"
    words = [f"Independent roads lead to {end}: {', '.join(near)}."] if near else []
    words += [
        f"{name[0].upper()}{name[1:]} does not: it ended {ran[name]:.3g}° from "
        f"{'it' if unique else 'all of them'}. "
        "No proof rests on it."
        for name in apart
    ]
    return _computed(" ".join(words))
