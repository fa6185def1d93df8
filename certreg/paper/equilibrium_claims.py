"""Evidence on the paper's claims about equilibria, energies and forces.

A claim that is true must be seen to hold in every run; one that is false as stated, or true under a
condition only, must be seen to fail on its counterexample, on which the shipped code is run: the
audit's own proof of it is in fractions and shares nothing with that.
`verdicts` has the table of all claims; they stand in two modules by what they are about.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.geometry.so3 import quaternion_from_matrix, rotation_matrix
from certreg.paper.equilibria import angle, signs, unstable_counts
from certreg.paper.evidence import (
    SAME_ANGLE,
    SAME_SUM,
    Clouds,
    Evidence,
    listed,
    rough,
    share,
    tally,
)
from certreg.paper.observations import STATES
from certreg.paper.particles import Particles, at_rest
from certreg.problem.problem import RegistrationProblem
from certreg.registration.enumeration import equilibria

if TYPE_CHECKING:
    from certreg.paper.observations import Observations

FAR = 1e6  # how far out in the space of matrices V is looked at


def objective(observed: Observations, _: Clouds) -> Evidence:
    """Row 1: V_p beside the objective."""
    worst = max(each.objective for each in observed.comparisons)
    return Evidence(
        words=f"relative difference at {_states(observed)} random states: at most {rough(worst)}",
        agrees=worst <= SAME_SUM,
    )


def equations(observed: Observations, _: Clouds) -> Evidence:
    """Row 2: the derived rates beside the printed sums."""
    worst = max(each.rate for each in observed.comparisons)
    return Evidence(
        words=f"the generated code and the printed sums over points, at {_states(observed)} random "
        f"states: relative difference at most {rough(worst)}",
        agrees=worst <= SAME_SUM,
    )


def energy_rate(observed: Observations, clouds: Clouds) -> Evidence:
    """Row 3: dV/dt on the rotations, and at a shear."""
    worst = max(each.dissipation for each in observed.comparisons)
    sheared = np.array([[1.0, 1, 0], [0, 1, 0], [0, 0, 1]])
    particles = Particles.of(clouds[0])
    state = np.concatenate([np.zeros(3), sheared.ravel(), np.zeros(5), [-0.1]])
    rises, claimed = particles.energy_rate(state), particles.dissipation(state)
    return Evidence(
        words=f"on rotations, {_states(observed)} random states: relative difference at most "
        f"{rough(worst)}; at the shear {rises:+.2f} instead of {claimed:+.2f}",
        agrees=worst <= SAME_SUM and claimed < 0.0 < rises,
    )


def unbounded(observed: Observations, clouds: Clouds) -> Evidence:
    """Row 4a: V of a flat cloud, far out in the space of matrices."""
    del observed
    flat = Particles.of(clouds[0])
    near, far = (flat.potential(at_rest(_stretched(size))) for size in (0.0, FAR))
    return Evidence(
        words=f"V at R = I is {near:.3g}, and at R = I + {rough(FAR)} e₁e₃ᵀ it is {far:.3g}",
        agrees=near == far,
    )


def balance(observed: Observations, _: Clouds) -> Evidence:
    """Row 5: what the paper's equation leaves at the equilibria."""
    poses = [pose for run in observed.equilibria for pose in run.poses]
    worst = max(pose.balance for pose in poses)
    return Evidence(
        words=f"at the {len(poses):,} equilibria, eliminated exactly from the torque, the sum over "
        f"the points leaves at most {rough(worst)} of its terms",
        agrees=worst <= SAME_SUM,
    )


def unique_optimum(observed: Observations, clouds: Clouds) -> Evidence:
    """Row 6a: where the optimum is unique."""
    runs = sum(run.unique for run in observed.equilibria)
    shape = equilibria(clouds[0]).classification
    words = (
        f"unique in {share(runs, observed.equilibria)} runs, decided exactly; "
        "on the tetrahedron and "
    )
    return Evidence(
        words=words + f"its mirror image {'not ' * (not shape.unique)}unique",
        agrees=runs == len(observed.equilibria) and shape.inertia_definite and not shape.unique,
    )


def optimum_at_rest(observed: Observations, _: Clouds) -> Evidence:
    """Row 6b: the closed form among the equilibria."""
    worst = max(run.poses[0].angle for run in observed.equilibria)
    near = sum(run.poses[0].angle <= SAME_ANGLE for run in observed.equilibria)
    evidence = tally(near, observed.equilibria, "runs have Horn's rotation among the equilibria")
    return Evidence(words=f"{evidence.words}, to {rough(worst)}°", agrees=evidence.agrees)


def no_contradiction(observed: Observations, clouds: Clouds) -> Evidence:
    """Row 6c: two optima with the same energy."""
    del observed
    particles = Particles.of(clouds[0])
    turns = [np.array(rotation_matrix(q)) for q in ((0.0, 1, 0, 0), (0.0, 0, 1, 0))]
    a, b = (particles.potential(at_rest(R)) for R in turns)
    apart = angle(*map(quaternion_from_matrix, turns))
    least = equilibria(clouds[0]).components[0].energy
    return Evidence(
        words=f"two optima {apart:.0f}° apart, V = {a:.6g} and {b:.6g}; the least is {least:.6g}",
        agrees=a == b == least and apart > 0.0,
    )


def three_spurious(observed: Observations, clouds: Clouds) -> Evidence:
    """Row 7: the numbers of spurious equilibria."""
    three = sum(run.count == 4 for run in observed.equilibria)
    others = [equilibria(cloud).classification.spurious for cloud in clouds]
    return Evidence(
        words=f"three in {share(three, observed.equilibria)} runs; {listed(others)} on the three "
        "counterexamples",
        agrees=three == len(observed.equilibria) and others == [1, 2, 0],
    )


def four_equilibria(observed: Observations, _: Clouds) -> Evidence:
    """Row 8a: the number of equilibria of random clouds."""
    four = sum(run.count == 4 for run in observed.equilibria)
    return tally(four, observed.equilibria, "runs have exactly four equilibria")


def half_turns(observed: Observations, _: Clouds) -> Evidence:
    """Row 8b: the angles, without cancellation and by the paper's formula."""
    spurious = [pose for run in observed.equilibria for pose in run.poses[1:]]
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


def symmetric_clouds(observed: Observations, clouds: Clouds) -> Evidence:
    """Row 9a: symmetric clouds with finitely many."""
    del observed
    counts = [equilibria(cloud).classification.spurious for cloud in clouds]
    return Evidence(
        words=f"spurious equilibria of the three symmetric pairs: {listed(counts)}",
        agrees=counts == [3, 3, 2],
    )


def polygons(observed: Observations, _: Clouds) -> Evidence:
    """Row 9b: the triangle and the square, at every angle."""
    exact = all(each == 0 for sums in observed.balance_sums for each in sums)
    left = max(float(np.abs(turn.torques.sum(axis=1)).max()) for turn in observed.turns)
    indices = sorted({int(count) for turn in observed.turns for count in turn.unstable})
    return Evidence(
        words=f"force, torque and energy as polynomials in the angle: {'' if exact else 'not '}"
        f"constant, so balance at every θ; in doubles the torque is below {rough(left)}, with "
        f"{listed(indices)} unstable eigenvalue at each of {len(observed.turns[0].angles)} angles",
        agrees=exact and left <= SAME_SUM and indices == [1],
    )


def infinite_without_symmetry(observed: Observations, clouds: Clouds) -> Evidence:
    """Row 9c: infinitely many without symmetry."""
    del observed
    count = equilibria(clouds[0]).classification.spurious
    return Evidence(
        words=f"spurious equilibria of the two turned tetrahedra: {listed([count])}",
        agrees=count is None,
    )


def spurious_unstable(observed: Observations, _: Clouds) -> Evidence:
    """Row 10: spurious equilibria with an unstable eigenvalue."""
    spurious = [pose for run in observed.equilibria for pose in run.poses[1:]]
    unstable = sum(signs(pose.intrinsic).right > 0 for pose in spurious)
    return tally(
        unstable, spurious, "spurious equilibria have an eigenvalue in the right half-plane"
    )


def pattern(observed: Observations, _: Clouds) -> Evidence:
    """Row 11: unstable eigenvalues, counted."""
    both = sum(unstable_counts(run) == ((0, 1, 2, 3),) * 2 for run in observed.equilibria)
    words = "runs count 0, 1, 2, 3, of the 12 intrinsic eigenvalues and of the paper's 18"
    return tally(both, observed.equilibria, words)


def six_zeros(observed: Observations, _: Clouds) -> Evidence:
    """Row 12: zeros among the 18 eigenvalues."""
    poses = [pose for run in observed.equilibria for pose in run.poses]
    six = sum(signs(pose.ambient).zero == 6 for pose in poses)
    best = [signs(run.poses[0].ambient) for run in observed.equilibria]
    left = sum(each.left == 12 and each.zero == 6 for each in best)
    return Evidence(
        words=f"six of the 18 are zero at {share(six, poses)} equilibria; at the optimum 12 are in "
        f"the left half-plane and 6 are zero in {share(left, best)} runs",
        agrees=six == len(poses) and left == len(best),
    )


def jacobian_informs(observed: Observations, _: Clouds) -> Evidence:
    """Row 15e: of the paper's 18 eigenvalues, whether one is to the right."""
    told = [
        [signs(pose.ambient).right > 0 for pose in run.poses] == [False, True, True, True]
        for run in observed.equilibria
    ]
    words = "runs: an eigenvalue of the 18 has a positive real part at the spurious ones alone"
    return tally(sum(told), observed.equilibria, words)


def definite_inertia(observed: Observations, _: Clouds) -> Evidence:
    """Row 14: the least eigenvalue of J."""
    definite = sum(run.least_inertia > 0.0 for run in observed.equilibria)
    least = min(run.least_inertia for run in observed.equilibria)
    line = [[0.0, 0, 0], [1, 2, 3], [2, 4, 6]]
    collinear = equilibria(RegistrationProblem(line, line)).classification.inertia_definite
    return Evidence(
        words=f"J ≻ 0 in {share(definite, observed.equilibria)} runs, least over largest "
        f"eigenvalue at least {least:.2f}; three points on a line: "
        f"{'' if collinear else 'not '}definite",
        agrees=definite == len(observed.equilibria) and not collinear,
    )


def _stretched(size: float) -> Any:
    return np.eye(3) + size * np.outer([1.0, 0, 0], [0, 0, 1.0])


def _states(observed: Observations) -> int:
    return STATES * len(observed.comparisons)
