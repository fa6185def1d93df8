"""What the page says in sentences: what is proved and by which theorem, and what is to be seen."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from certreg.certificate.bounds import sin2_half_angle_between
from certreg.exact.decimals import at_most
from certreg.exact.dyadic import degrees_above, half_angle_bound, rational_root_above
from certreg.problem.moments import trace
from certreg.problem.motion import Scale
from certreg.registration.headlines import proved_degrees
from certreg.report.lines import bounds_nothing, count_words, margin_words, number
from certreg.report.pose_words import gap_words
from certreg.report.robustness import robustness_words
from certreg.results import Absent, ComponentKind, Guarantee

if TYPE_CHECKING:
    from collections.abc import Iterator

    from certreg.certificate.isotropic import Claims, IsotropicBody
    from certreg.equilibrium.equilibrium_set import Component, EquilibriumSet
    from certreg.registration.agreement import Agreement
    from certreg.registration.result import Registration


THEOREMS = {  # claims of `certreg derive`, by the titles of their pages
    "optimality_certificate": "The optimality certificate",
    "pair_lengths": "Two pairs within their bounds have nearly the same length",
    "few_neighbours": "Many pairs within their bounds are many neighbours",
    "few_colours": "Neighbours with few colours",
    "weighted_refutation": "Weights that refute pairs together",
    "scaled_lengths": "Lengths, where the scale is free",
    "scaled_refutation": "Weights that refute pairs at every scale",
    "chord_bound": "A truncated square is above its chord",
    "truncated_box": "A box of rotations without a better truncated cost",
    "truncated_survey": "Boxes of quaternions and truncated squares",
    "angle_of_consensus": "The rotation of every motion within the bounds",
    "translation_gap": "What a translation costs",
    "classification": "The eight kinds of equilibrium set",
    "eigenvectors": "Equilibria are eigenvectors",
    "unstable_count": "As many growing modes as the index",
    "instability": "Every spurious equilibrium is unstable",
    "certified_basin": "The certified basin",
    "dual_bound": "A multiplier that is proved is a bound",
    "spectrum": "The spectrum of Davenport's matrix",
    "eigenvector_radius": "How far the points may move before the eigenvector has turned",
    "scale_radius": "Between which numbers the scale stays",
    "scale_elimination": "The best scale, and what it costs",
    "breathing_equilibria": "Where the body that breathes rests",
    "descartes": "How many eigenvalues are positive",
    "breathing_confined": "A body with little energy does not collapse",
    "spring_translation": "What a translation costs with matrices of springs",
    "quartic_relaxation": "A quartic, and its sums of squares",
    "bernstein_cones": "Cones and Bernstein coefficients",
    "spring_caps": "Caps: curvature at a centre",
    "growth_form": "The growth form",
    "growth_radius": "How far the points may move",
    "forty_lines": "At most forty critical lines",
}
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
PLURALS = {
    ComponentKind.CIRCLE: "a circle of them",
    ComponentKind.PROJECTIVE_PLANE: "a projective plane of them",
    ComponentKind.ROTATION_GROUP: "every rotation",
}
NUMERALS = {1: "one axis", 2: "either of two axes", 3: "any of three axes"}
LARGE_FACTOR = 1.05  # below, a factor says nothing that the two numbers do not
LARGEST_FACTOR = 1e6  # above, the number means nothing to a reader
SAME_ROTATION = 0.1  # degrees: methods that find it end nearer; a run stops a little before


@dataclass(frozen=True, slots=True, kw_only=True)
class Sentence:
    """What is known, how it is known, and the names of the theorems that it rests on."""

    words: str
    guarantee: Guarantee
    theorems: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class MethodAngles:
    """How far independent methods ended from the pose, in degrees; None for those not run."""

    closed_form: float
    relaxation: float | None
    simulation: float | None

    @classmethod
    def of(cls, agreement: Agreement) -> MethodAngles:
        """From the angles in radians."""
        others = (agreement.relaxation, agreement.simulation)
        relaxation, simulation = (None if a is None else math.degrees(a) for a in others)
        return cls(
            closed_form=math.degrees(agreement.closed_form),
            relaxation=relaxation,
            simulation=simulation,
        )


def sentences(
    registration: Registration, body: IsotropicBody, angles: MethodAngles
) -> list[Sentence]:
    """What the page says is known; the checker has accepted what the certificate claims."""
    return [
        *optimality_sentence(registration),
        *uniqueness_sentences(registration),
        *motion_sentences(registration, body),
        *robustness_sentences(registration, "eigenvector_radius"),
        *_numbers(registration, angles),
    ]


def begun(words: str) -> str:
    """Words as the beginning of a sentence."""
    return words[:1].upper() + words[1:]


def sentence(words: str) -> str:
    """Words as a sentence that ends by itself."""
    ended = words.removesuffix(":").removesuffix(".")
    whole = begun(ended if ended.endswith("?") else f"{ended}.")
    return whole.replace(" %", "\u00a0%")  # on one line


def robustness_sentences(registration: Registration, *theorems: str) -> Iterator[Sentence]:
    """How far the points may be off, if it is proved."""
    if registration.robustness is not None:
        words = sentence(robustness_words(registration))
        yield Sentence(words=words, guarantee=Guarantee.EXACT, theorems=theorems)


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


def optimality_sentence(registration: Registration) -> Iterator[Sentence]:
    """Over which motions the pose is proved to be the best, and to within what."""
    bounds, problem = registration.bounds, registration.problem
    if bounds is None:
        return
    motion = problem.motion
    divided = " divided by the scale" if problem.scale is Scale.SYMMETRIC else ""
    what = f"the sum of weighted squared distances{divided}"
    theorems = ["optimality_certificate", *["translation_gap"] * (motion.translations > 0)]
    theorems += ["scale_elimination"] * motion.scaled
    yield Sentence(
        words=gap_words(motion, what, bounds.greatest_gap),
        guarantee=Guarantee.EXACT,
        theorems=tuple(theorems),
    )


def uniqueness_sentences(registration: Registration) -> Iterator[Sentence]:
    """Whether one rotation is the best, and how far at most the given one is from it."""
    if registration.bounds is None:
        return
    degrees = proved_degrees(registration)
    if degrees is not None:
        yield Sentence(
            words=(
                "The best rotation is unique, and that of the quaternion given below is within "
                f"{degrees} degrees of it."
            ),
            guarantee=Guarantee.EXACT,
            theorems=("optimality_certificate", "classification"),
        )
        return
    if registration.equilibria.classification.unique:
        yield Sentence(
            words=(
                "The best rotation is unique. How far it is from that of the quaternion given "
                "below is not claimed."
            ),
            guarantee=Guarantee.EXACT,
            theorems=("classification",),
        )
        return
    kind = NAMES[registration.equilibria.components[0].kind]
    yield Sentence(
        words=f"The best rotation is not unique: the optima are {kind}, all exactly as good.",
        guarantee=Guarantee.EXACT,
        theorems=("classification",),
    )


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
    listed = ", ".join(f"{NAMES[c.kind]} of index {c.morse_index}" for c in equilibria.components)
    return Sentence(
        words=f"{begun}: {listed}. The list is complete.",
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
    yield Sentence(
        words=(
            "From the state in the certificate, within "
            f"{at_most(degrees_above(off), 2)}° of its pose and turning by at most "
            f"{at_most(spin, 2)} radians per unit of time, the exact motion can end nowhere but at "
            "the optimum, whatever the damping."
        ),
        guarantee=Guarantee.EXACT,
        theorems=("certified_basin",),
    )
    if not isinstance(registration.solution.trajectory, Absent):
        verb = "is" if registration.solution.ended_in(state) else "is not"
        yield Sentence(
            words=f"That {verb} the state in which {_simulation_name(registration)} ended.",
            guarantee=Guarantee.NUMERICAL,
        )


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
        yield Sentence(
            words=(
                "The dual of the semidefinite relaxation, rounded outwards, bounds the gap "
                f"of the certified rotation independently: at most {at_most(gap.value)}.{worth}"
            ),
            guarantee=Guarantee.EXACT,
            theorems=("dual_bound",),
        )


def _numbers(registration: Registration, angles: MethodAngles) -> Iterator[Sentence]:
    yield Sentence(
        words=(
            "Poses, energies and RMSE are rounded to doubles from at least 57 digits. The "
            "eigenvalues in the chart are computed in double precision; the signs of their real "
            "parts are exact."
        ),
        guarantee=Guarantee.NUMERICAL,
        theorems=("spectrum",),
    )
    yield methods_sentence(registration, angles)
    yield Sentence(
        words=f"The ambiguity margin is {margin_words(registration.equilibria)}.",
        guarantee=Guarantee.NUMERICAL,
        theorems=("classification",),
    )


def methods_sentence(registration: Registration, methods: MethodAngles) -> Sentence:
    """Which methods lead to the rotation that is printed, and which do not."""
    angles = {
        "the closed form": methods.closed_form,
        "the semidefinite relaxation": methods.relaxation,
        _simulation_name(registration): methods.simulation,
    }
    ran = {name: angle for name, angle in angles.items() if angle is not None}
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
    return Sentence(words=" ".join(words), guarantee=Guarantee.NUMERICAL)


def lie_words(registration: Registration) -> str:
    """How source points lie for which no dynamics is defined."""
    one = not trace(registration.solution.moments.source_scatter)
    if registration.problem.rotation_only:
        return "are all at the origin" if one else "are on one line through the origin"
    return "coincide" if one else "are on one line"


def trap_words(equilibria: EquilibriumSet, rmse: float | None = None) -> str | None:
    """How much worse the worst stationary pose fits, and that bodies leave it.

    None if all are optimal. rmse: that of the pose as printed, where the page tells it; else of the
    exact optimum.
    """
    worst, last = equilibria.components[-1], len(equilibria.components) - 1
    if worst.optimal or None in {worst.rmse, equilibria.components[0].rmse}:
        return None
    optimum = equilibria.components[0].rmse if rmse is None else rmse
    factor, best = factor_words(equilibria, last), number(optimum)
    fit = f"with an RMSE of {number(worst.rmse)} instead of {best}"
    if number(worst.rmse) == best:
        fit = f"though its RMSE is {best}, as the optimum's is, in these digits"
    unstable = worst.unstable_eigenvalues is not None
    single = worst.kind is ComponentKind.POINT
    return (
        f"{'The worst rotation' if single else 'One of the worst rotations'}, "
        f"{math.degrees(worst.angle_to_optimum):.4g}° off, balances the "
        f"springs, too. It is not the best, {fit}{f' ({factor})' if factor else ''}"
        f"{', and unstable: a push, however small, can end it' if unstable else ''}."
    )


def component_name(equilibria: EquilibriumSet, index: int) -> str:
    """A short name for a button."""
    component = equilibria.components[index]
    single = component.kind is ComponentKind.POINT
    if component.optimal:
        return "Optimum" if single else f"Optima: {PLURALS[component.kind]}"
    name = "Worst rotation" if index == len(equilibria.components) - 1 else "Saddle"
    return name if single else f"{name}s: {PLURALS[component.kind]}"


def factor_words(equilibria: EquilibriumSet, index: int) -> str:
    """How many times as far apart the pairs are as at the optimum; empty where that says little."""
    best, here = equilibria.components[0].rmse, equilibria.components[index].rmse
    if not best or not here or not LARGE_FACTOR < here / best < LARGEST_FACTOR:
        return ""
    return f"{here / best:.3g} times the optimum's"


def component_words(equilibria: EquilibriumSet, index: int) -> str:
    """What is to be seen at a component, and why a body stays there or leaves."""
    component = equilibria.components[index]
    if component.optimal:
        return _optimal_words(component)
    factor = factor_words(equilibria, index)
    fit = f"RMSE {number(component.rmse)}{f', {factor}' if factor else ''}"
    last = index == len(equilibria.components) - 1
    single = component.kind is ComponentKind.POINT
    worst = "It is the worst rotation there is" if single else "No rotation is worse than these"
    worst = f" {worst}." if last else ""
    axes = NUMERALS[component.morse_index]
    return (
        f"All forces and torques balance here, but the fit is not the best: {fit}.{worst} Turning "
        f"about {axes} lowers the energy, {_growth_words(component)}"
    )


def _growth_words(component: Component) -> str:
    count = component.unstable_eigenvalues
    if count is None:
        return "so it is no minimum."
    which = "its mode" if count == 1 else "their modes"
    modes = "1 of the 12 eigenvalues has" if count == 1 else f"{count} of the 12 eigenvalues have"
    return (
        f"and so {modes} a positive real part: along {which} a push grows, however small, "
        "and the body leaves."
    )


def _optimal_words(component: Component) -> str:
    if component.kind is not ComponentKind.POINT:
        return "No pose is better than these, and all of them are exactly as good: move along them."
    stable = "" if component.unstable_eigenvalues is None else ", and the body comes back"
    return f"No pose fits better. Turned a little about any axis, the energy rises{stable}."
