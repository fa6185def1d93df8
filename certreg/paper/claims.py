"""The paper's claims as they are measured: in words, and whether that agrees with the audit.

A claim that is true must be seen to hold in every run; one that is false as stated, or true under a
condition only, must be seen to fail on its counterexample, on which the shipped code is run: the
audit's own proof of it is in fractions and shares nothing with that.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from certreg.dynamics.states import state_at_rest
from certreg.geometry.so3 import quaternion_from_matrix, rotation_matrix
from certreg.paper.experiments import (
    STEP,
    EquilibriumRun,
    StationaryPose,
    angle,
    descend,
    signs,
    unstable_counts,
)
from certreg.paper.observations import STATES, Observations
from certreg.paper.particles import SAME_SUM, Particles, parts
from certreg.problem.problem import RegistrationProblem
from certreg.registration.enumeration import equilibria

SAME_ANGLE = 1e-9  # degrees, of two eigenvectors of a 4x4 matrix: their rounding
NEAR = 1.0  # degrees: a simulation stops near its end, not at it; saddles are at 180

Clouds = list[RegistrationProblem]
FAR = 1e6  # how far out in the space of matrices V is looked at
SPIRAL_STEPS, SPIRAL_DAMPING = 1000, 0.005
SPIRAL_RATIO = 20003 / 20000  # of a step, exactly, by the audit's row 15b
HALF_TURN = 179.0  # degrees: near enough to tell from the optimum
FINER = 1000.0  # millimetres in a metre
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True, slots=True, kw_only=True)
class Evidence:
    """What was measured, in words, and whether it agrees with the finding on the claim."""

    words: str
    agrees: bool


def tally(good: Sequence[bool], words: str) -> Evidence:
    """How many are good, which agrees if all are."""
    return Evidence(words=f"{share(good)} {words}", agrees=all(good))


def share(good: Sequence[bool]) -> str:
    """How many of how many."""
    return f"{sum(good):,} of {len(good):,}"


def each(
    of: Callable[[Observations], Iterable[Any]], good: Callable[[Any], bool], words: str
) -> Callable[[Observations, Clouds], Evidence]:
    """The measurement of a claim about every run or pose: of how many it holds."""
    return lambda observed, _: tally(list(map(good, of(observed))), words)


def listed(counts: Sequence[int | None]) -> str:
    """Numbers of equilibria in a row of words."""
    words = ["infinitely many" if count is None else str(count) for count in counts]
    return " and ".join(filter(None, [", ".join(words[:-1]), words[-1]]))


def rough(value: float) -> str:
    """A positive number rounded up to one digit, as powers of ten are printed."""
    if value == 0.0 or not math.isfinite(value):
        return f"{value:g}"
    exponent = math.floor(math.log10(value))
    digit = math.ceil(value / 10.0**exponent * (1.0 - 1e-12))  # 1e-12: the quotient is rounded
    digit, exponent = (1, exponent + 1) if digit == 10 else (digit, exponent)
    return f"{digit}·10{str(exponent).translate(SUPERSCRIPTS)}"


def objective(observed: Observations, _: Clouds) -> Evidence:
    """Row 1: V_p beside the objective."""
    worst = max(one.objective for one in observed.comparisons)
    return Evidence(
        words=f"relative difference at {_states(observed)} random states: at most {rough(worst)}",
        agrees=worst <= SAME_SUM,
    )


def equations(observed: Observations, _: Clouds) -> Evidence:
    """Row 2: the derived rates beside the printed sums."""
    worst = max(one.rate for one in observed.comparisons)
    return Evidence(
        words=f"the generated code and the printed sums over points, at {_states(observed)} random "
        f"states: relative difference at most {rough(worst)}",
        agrees=worst <= SAME_SUM,
    )


def energy_rate(observed: Observations, clouds: Clouds) -> Evidence:
    """Row 3: dV/dt on the rotations, and at a shear."""
    worst = max(one.dissipation for one in observed.comparisons)
    sheared = np.array([[1.0, 1, 0], [0, 1, 0], [0, 0, 1]])
    particles = Particles.of(clouds[0])
    state = np.concatenate([np.zeros(3), sheared.ravel(), np.zeros(5), [-0.1]])
    rises, claimed = particles.energy_rate(state), particles.dissipation(state)
    return Evidence(
        words=f"on rotations, {_states(observed)} random states: relative difference at most "
        f"{rough(worst)}; at the shear {rises:+.2f} instead of {claimed:+.2f}",
        agrees=worst <= SAME_SUM and claimed < 0.0 < rises,
    )


def unbounded(_: Observations, clouds: Clouds) -> Evidence:
    """Row 4a: V of a flat cloud, far out in the space of matrices."""
    flat = Particles.of(clouds[0])
    near, far = (flat.potential(state_at_rest(_stretched(size))) for size in (0.0, FAR))
    return Evidence(
        words=f"V at R = I is {near:.3g}, and at R = I + {rough(FAR)} e₁e₃ᵀ it is {far:.3g}",
        agrees=near == far,
    )


def balance(observed: Observations, _: Clouds) -> Evidence:
    """Row 5: what the paper's equation leaves at the equilibria."""
    poses = _poses(observed)
    worst = max(pose.balance for pose in poses)
    return Evidence(
        words=f"at the {len(poses):,} equilibria, eliminated exactly from the torque, the sum over "
        f"the points leaves at most {rough(worst)} of its terms",
        agrees=worst <= SAME_SUM,
    )


def unique_optimum(observed: Observations, clouds: Clouds) -> Evidence:
    """Row 6a: where the optimum is unique."""
    unique = [run.unique for run in observed.equilibria]
    shape = equilibria(clouds[0]).classification
    return Evidence(
        words=f"unique in {share(unique)} runs, decided exactly; on the tetrahedron and its mirror "
        f"image {'not ' * (not shape.unique)}unique",
        agrees=all(unique) and shape.inertia_definite and not shape.unique,
    )


def optimum_at_rest(observed: Observations, _: Clouds) -> Evidence:
    """Row 6b: the closed form among the equilibria."""
    angles = [run.poses[0].angle for run in observed.equilibria]
    words = f"runs have Horn's rotation among the equilibria, to {rough(max(angles))}°"
    return tally([angle <= SAME_ANGLE for angle in angles], words)


def no_contradiction(_: Observations, clouds: Clouds) -> Evidence:
    """Row 6c: two optima with the same energy."""
    particles = Particles.of(clouds[0])
    turns = [np.array(rotation_matrix(q)) for q in ((0.0, 1, 0, 0), (0.0, 0, 1, 0))]
    a, b = (particles.potential(state_at_rest(R)) for R in turns)
    apart = angle(*map(quaternion_from_matrix, turns))
    least = equilibria(clouds[0]).components[0].energy
    return Evidence(
        words=f"two optima {apart:.0f}° apart, V = {a:.6g} and {b:.6g}; the least is {least:.6g}",
        agrees=a == b == least and apart > 0.0,
    )


def three_spurious(observed: Observations, clouds: Clouds) -> Evidence:
    """Row 7: the numbers of spurious equilibria."""
    three = [run.count == 4 for run in observed.equilibria]
    others = [equilibria(cloud).classification.spurious for cloud in clouds]
    return Evidence(
        words=f"three in {share(three)} runs; {listed(others)} on the three counterexamples",
        agrees=all(three) and others == [1, 2, 0],
    )


def half_turns(observed: Observations, _: Clouds) -> Evidence:
    """Row 8b: the angles, without cancellation and by the paper's formula."""
    spurious = _spurious(observed)
    errors = [error for run in observed.equilibria for error in run.pair_errors]
    worst = max(errors + [pose.half_turn_error for pose in spurious])
    rounded = max(abs(180.0 - pose.arccos_angle) for pose in spurious)
    at_best = max(run.poses[0].arccos_angle for run in observed.equilibria)
    return Evidence(
        words=f"{len(errors):,} pairs, and {len(spurious):,} times to the closed form: 180° to "
        f"{rough(worst)}°. The paper's arccos formula rounds: off by up to {rough(rounded)}°, "
        f"and by {rough(at_best)}° at the optimum",
        agrees=worst <= SAME_ANGLE,
    )


def symmetric_clouds(_: Observations, clouds: Clouds) -> Evidence:
    """Row 9a: symmetric clouds with finitely many."""
    counts = [equilibria(cloud).classification.spurious for cloud in clouds]
    return Evidence(
        words=f"spurious equilibria of the three symmetric pairs: {listed(counts)}",
        agrees=counts == [3, 3, 2],
    )


def polygons(observed: Observations, _: Clouds) -> Evidence:
    """Row 9b: the triangle and the square, at every angle."""
    exact = all(entry == 0 for sums in observed.balance_sums for entry in sums)
    left = max(float(np.abs(turn.torques.sum(axis=1)).max()) for turn in observed.turns)
    indices = sorted({int(count) for turn in observed.turns for count in turn.unstable})
    return Evidence(
        words=f"force, torque and energy as polynomials in the angle: {'' if exact else 'not '}"
        f"constant, so balance at every θ; in doubles the torque is below {rough(left)}, with "
        f"{listed(indices)} unstable eigenvalue at each of {len(observed.turns[0].angles)} angles",
        agrees=exact and left <= SAME_SUM and indices == [1],
    )


def infinite_without_symmetry(_: Observations, clouds: Clouds) -> Evidence:
    """Row 9c: infinitely many without symmetry."""
    count = equilibria(clouds[0]).classification.spurious
    return Evidence(
        words=f"spurious equilibria of the two turned tetrahedra: {listed([count])}",
        agrees=count is None,
    )


def six_zeros(observed: Observations, _: Clouds) -> Evidence:
    """Row 12: zeros among the 18 eigenvalues."""
    six = [signs(pose.ambient).zero == 6 for pose in _poses(observed)]
    best = [signs(run.poses[0].ambient) for run in observed.equilibria]
    left = [one.left == 12 and one.zero == 6 for one in best]
    return Evidence(
        words=f"six of the 18 are zero at {share(six)} equilibria; at the optimum 12 are in "
        f"the left half-plane and 6 are zero in {share(left)} runs",
        agrees=all(six) and all(left),
    )


def definite_inertia(observed: Observations, _: Clouds) -> Evidence:
    """Row 14: the least eigenvalue of J."""
    definite = [run.least_inertia > 0.0 for run in observed.equilibria]
    least = min(run.least_inertia for run in observed.equilibria)
    line = [[0.0, 0, 0], [1, 2, 3], [2, 4, 6]]
    collinear = equilibria(RegistrationProblem(line, line)).classification.inertia_definite
    return Evidence(
        words=f"J ≻ 0 in {share(definite)} runs, least over largest "
        f"eigenvalue at least {least:.2f}; three points on a line: "
        f"{'' if collinear else 'not '}definite",
        agrees=all(definite) and not collinear,
    )


def _stretched(size: float) -> Any:
    return np.eye(3) + size * np.outer([1.0, 0, 0], [0, 0, 1.0])


def _states(observed: Observations) -> int:
    return STATES * len(observed.comparisons)


def falling_energy(observed: Observations, _: Clouds) -> Evidence:
    """Row 13a: V along an integrator that keeps the law, and its rate."""
    falling = [run.midpoint_rise <= SAME_SUM for run in observed.simulations]
    worst = max(one.dissipation for one in observed.comparisons)
    return Evidence(
        words=f"{share(falling)} runs of the implicit midpoint rule: V falls in every step; dV/dt "
        f"is as told to {rough(worst)}",
        agrees=all(falling) and worst <= SAME_SUM,
    )


def rising_energy(observed: Observations, _: Clouds) -> Evidence:
    """Row 13b: V in the steps of explicit Euler."""
    rising = [run.first_rise > 0.0 for run in observed.simulations]
    steps = [run.rises for run in observed.simulations]
    wrong = max(abs(run.first_rise - run.predicted_rise) for run in observed.simulations)
    least, most = (f(run.first_rise for run in observed.simulations) for f in (min, max))
    return Evidence(
        words=f"V rises in the first step of {share(rising)} runs, by "
        f"{least * 1e6:.3g} to {most * 1e6:.3g} millionths, as told to {rough(wrong)}; in "
        f"{min(steps)} to {max(steps)} steps of each run",
        agrees=all(rising) and wrong <= SAME_SUM,
    )


def always_optimal(observed: Observations, clouds: Clouds) -> Evidence:
    """Row 15a: where simulations end that come to rest, and one that starts at a saddle."""
    ends = likely_optimal(observed, clouds)
    steps = np.median([run.steps for run in observed.simulations])
    stuck = descend(clouds[0])
    off = _off(stuck.rotation, clouds[0])
    return Evidence(
        words=f"{ends.words}, after {steps:.0f} steps in the median; started at the saddle the "
        f"body stays, {off:.0f}° off, after {stuck.steps} steps",
        agrees=ends.agrees and stuck.steps == 0 and off > HALF_TURN,
    )


def out_of_the_plane(_: Observations, clouds: Clouds) -> Evidence:
    """Row 9d: the square, flipped and turned out of the plane, released at rest."""
    run = descend(clouds[0])
    off, energy = _off(run.rotation, clouds[0]), run.potential
    return Evidence(
        words=f"flipped over and turned 1.1° out of the plane, the square comes back: at rest "
        f"after "
        f"{run.steps} steps, {off:.0f}° from the optimum, V from {energy[0]:.4f} to "
        f"{energy[-1]:.4f}",
        agrees=run.stopped and off > HALF_TURN and bool(energy[-1] < energy[0]),
    )


def any_damping(observed: Observations, clouds: Clouds) -> Evidence:
    """Row 15b: explicit Euler at two dampings."""
    cloud = clouds[0].damped(SPIRAL_DAMPING)
    run = descend(cloud, max_steps=SPIRAL_STEPS)
    c, _, v, _ = parts(run.state)
    size = v @ v + SPIRAL_DAMPING * (c @ v) + 2.0 * (c @ c)
    ratio = (float(size) / 2.0) ** (1.0 / SPIRAL_STEPS)
    stopped = [run.stopped for run in observed.simulations]
    return Evidence(
        words=f"μ = {observed.setup.damping:g}: {share(stopped)} runs come "
        f"to rest; μ = {SPIRAL_DAMPING}: the motion of the centre grows by the factor {ratio:.6f} "
        "a step",
        agrees=math.isclose(ratio, SPIRAL_RATIO, rel_tol=SAME_SUM)
        and (all(stopped) or not _small_step(observed)),
    )


def stopping_rule(_: Observations, clouds: Clouds) -> Evidence:
    """Row 15c: where the rule stops, and in which unit."""
    run = descend(clouds[0])
    off, energy = _off(run.rotation, clouds[0]), float(run.potential[-1])
    source, damping = clouds[0].source, clouds[0].damping
    aside = source + np.array([1.0, 0.0, 0.0])
    moved = RegistrationProblem(source, aside, damping=damping)
    finer = RegistrationProblem(source * FINER, aside * FINER, damping=damping)
    steps, longer = (descend(problem).steps for problem in (moved, finer))
    return Evidence(
        words=f"stopped after {run.steps} steps, {off:.3f}° from the optimum, V = {energy:.1f} "
        f"where 0 is possible; the octahedron moved by 1 takes {steps} steps in one unit of "
        f"length, and {longer} in a unit a thousand times smaller",
        agrees=run.steps == 0 and off > HALF_TURN and longer != steps,
    )


def _small_step(observed: Observations) -> bool:
    """Whether explicit Euler is stable for the centre: h < mu / 2 and h mu < 2."""
    return 2.0 * STEP < observed.setup.damping < 2.0 / STEP


def _off(R: Any, problem: RegistrationProblem) -> float:
    """The angle in degrees from a rotation to the optimum of a problem."""
    best = equilibria(problem).components[0].quaternion_wxyz
    return angle(quaternion_from_matrix(R), best)


def _runs(observed: Observations) -> tuple[EquilibriumRun, ...]:
    return observed.equilibria


def _poses(observed: Observations) -> list[StationaryPose]:
    return [pose for run in observed.equilibria for pose in run.poses]


def _spurious(observed: Observations) -> list[StationaryPose]:
    return [pose for run in observed.equilibria for pose in run.poses[1:]]


likely_optimal = each(
    lambda observed: [run for run in observed.simulations if run.stopped],
    lambda run: run.distance <= NEAR,
    "simulations that come to rest do so at the optimum",
)
MEASURED: dict[str, Callable[[Observations, Clouds], Evidence]] = {
    "1": objective,
    "2": equations,
    "3": energy_rate,
    "4a": unbounded,
    "4b": each(
        lambda observed: observed.simulations,
        lambda run: run.midpoint_at_rest,
        "runs of the implicit midpoint rule came to rest",
    ),
    "5": balance,
    "6a": unique_optimum,
    "6b": optimum_at_rest,
    "6c": no_contradiction,
    "7": three_spurious,
    "8a": each(_runs, lambda run: run.count == 4, "runs have exactly four equilibria"),
    "8b": half_turns,
    "9a": symmetric_clouds,
    "9b": polygons,
    "9c": infinite_without_symmetry,
    "9d": out_of_the_plane,
    "10": each(
        _spurious,
        lambda pose: signs(pose.intrinsic).right > 0,
        "spurious equilibria have an eigenvalue in the right half-plane",
    ),
    "11": each(
        _runs,
        lambda run: unstable_counts(run) == ((0, 1, 2, 3),) * 2,
        "runs count 0, 1, 2, 3, of the 12 intrinsic eigenvalues and of the paper's 18",
    ),
    "12": six_zeros,
    "13a": falling_energy,
    "13b": rising_energy,
    "14": definite_inertia,
    "15a": always_optimal,
    "15b": any_damping,
    "15c": stopping_rule,
    "15d": likely_optimal,
    "15e": each(
        _runs,
        lambda run: [k > 0 for k in unstable_counts(run)[1]] == [False, True, True, True],
        "runs: an eigenvalue of the 18 has a positive real part at the spurious ones alone",
    ),
}
