"""The paper's experiments on one random instance: all its equilibria, and the simulation.

The paper solves the torque quadratics in Matlab; here they are eliminated exactly (the Groebner
method), which knows nothing of eigenvectors. Eigenvalues are those of the Jacobians, computed in
double precision and counted; nothing is taken from the theorems that they are held against.

The simulation is explicit Euler, R projected, stopped where the rates are small: the same loop that
`certreg simulate` runs, in the paper's raw units of length, with its fixed step and without what
certreg adds: no certified basin, no escape from a saddle. So a run may stop where it should not, as
the paper's may. What is measured of the energy is measured at every step; the rise that theory
tells for the first step is computed from the paper's equations, as sums over the particles.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from certreg.dynamics.integrators import SimulationSettings
from certreg.dynamics.rigid import RigidBody, rigid_body
from certreg.dynamics.simulation import simulate
from certreg.dynamics.states import start_at_rest, state_at_rest
from certreg.equilibrium.equilibrium_set import rotation_double, unit_double
from certreg.equilibrium.methods import FINDERS
from certreg.geometry.so3 import quaternion_from_matrix, rotation_matrix
from certreg.native.engine import current_engine
from certreg.native.layout import BASIN, MATRIX_STATE, named, plain
from certreg.native.loops import Batch, Ending, Integrator, Log
from certreg.objective.isotropic import Isotropic
from certreg.paper.particles import RAW_UNIT, SAME_SUM, Particles, parts
from certreg.problem.moments import exact_moments
from certreg.registration.closed_form import horn

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.problem.problem import RegistrationProblem


ZERO_EIGENVALUE = 1e-9  # of the largest: a computed zero is below, a true one far above
STEP = 0.01  # [Yang2020]
STOP = 1e-4  # [Yang2020]: norm of the 18 rates of change, lengths in the user's unit
MAX_STEPS = 100_000  # a thousand are usual; a run of so many has not converged
# Gaps of zero: no pose is better than another, so that the loop, which would else look for the
# basin, stops wherever the body is slow. That is the paper's rule.
NO_BASIN = np.zeros((), dtype=BASIN)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Signs:
    """How many eigenvalues lie right of the imaginary axis, at zero, and left of it."""

    right: int
    zero: int
    left: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StationaryPose:
    """One equilibrium. Angles in degrees, to the closed-form optimum.

    quaternion: (4,); rotation: (3, 3). balance: what the paper's equation leaves, relative.
    intrinsic: (12,) and ambient: (18,), complex: eigenvalues of the Jacobians in the 12 dimensions
    of the motion and in the 18 numbers of the paper. angle: from the quaternions, half_turn_error:
    180 less that, without cancellation. arccos_angle: by the paper's formula.
    """

    quaternion: NDArray[np.float64]
    rotation: NDArray[np.float64]
    balance: float
    intrinsic: NDArray[np.complex128]
    ambient: NDArray[np.complex128]
    angle: float
    half_turn_error: float
    arccos_angle: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EquilibriumRun:
    """All equilibria of one instance, the lowest energy first; None for infinitely many.

    unique: whether the optimum is, decided exactly. pair_errors: for every two equilibria 180 less
    their angle, degrees. least_inertia: the least eigenvalue of J over the largest.
    """

    count: int | None
    unique: bool
    poses: tuple[StationaryPose, ...]
    pair_errors: tuple[float, ...]
    least_inertia: float


def equilibrium_run(problem: RegistrationProblem) -> EquilibriumRun:
    """The experiment on one instance.

    Where the equilibria form a continuum, `poses` has one member of each component.
    Raises DegenerateProblemError where the source is collinear.
    """
    moments = exact_moments(problem)
    moving = rigid_body(moments, problem.damping, length_exponent=RAW_UNIT)
    particles = Particles.of(problem)
    objective = Isotropic(moments)
    critical = FINDERS[objective.structure]["groebner"].method(objective)
    shape = objective.classified(critical.pattern)
    best = horn(moving.cross_covariance)
    poses = tuple(
        _stationary_pose(part.quaternion, moving, particles, best) for part in critical.components
    )
    inertia = np.linalg.eigvalsh(moving.inertia)
    return EquilibriumRun(
        count=len(poses) if shape.finite else None,
        unique=shape.unique,
        poses=poses,
        pair_errors=tuple(
            half_turn_error(a.quaternion, b.quaternion) for a, b in combinations(poses, 2)
        ),
        least_inertia=float(inertia[0] / inertia[-1]),
    )


def sides(eigenvalues: NDArray[np.complex128]) -> NDArray[np.int64]:
    """1 for each eigenvalue right of the imaginary axis, -1 left, 0 for what rounding made of 0."""
    zero = np.abs(eigenvalues) <= ZERO_EIGENVALUE * np.abs(eigenvalues).max()
    return np.where(zero, 0, np.sign(eigenvalues.real)).astype(np.int64)


def signs(eigenvalues: NDArray[np.complex128]) -> Signs:
    """The eigenvalues counted by their real parts."""
    each = sides(eigenvalues).tolist()
    return Signs(right=each.count(1), zero=each.count(0), left=each.count(-1))


def unstable_counts(run: EquilibriumRun) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """How many eigenvalues of each equilibrium are unstable: of the 12, and of the 18."""
    intrinsic = tuple(signs(pose.intrinsic).right for pose in run.poses)
    return intrinsic, tuple(signs(pose.ambient).right for pose in run.poses)


def angle(p: NDArray[np.float64], q: NDArray[np.float64]) -> float:
    """The angle in degrees between R(p) and R(q) of unit quaternions, accurate at 0 and at 180."""
    return math.degrees(2.0 * math.atan2(_across(p, q), abs(float(p @ q))))


def half_turn_error(p: NDArray[np.float64], q: NDArray[np.float64]) -> float:
    """180 less the angle in degrees between R(p) and R(q), to full precision near zero."""
    return math.degrees(2.0 * math.atan2(abs(float(p @ q)), _across(p, q)))


def arccos_angle(R: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """The paper's |arccos((tr(R^T R') - 1) / 2)| in degrees.

    Rounding can put the argument outside [-1, 1], where Matlab's arccos, as this one, is complex;
    the absolute value hides that. Near 0 and 180 degrees only half of the digits are right.
    """
    argument = (np.trace(R.T @ other) - 1.0) / 2.0
    return math.degrees(abs(np.arccos(complex(argument))))


def _across(p: NDArray[np.float64], q: NDArray[np.float64]) -> float:
    """The norm of the part of q that is orthogonal to p."""
    return float(np.linalg.norm(np.outer(p, q) - np.outer(q, p)) / math.sqrt(2.0))


def _stationary_pose(
    integers: tuple[int, int, int, int],
    moving: RigidBody,
    particles: Particles,
    best: NDArray[np.float64],
) -> StationaryPose:
    quaternion, rotation = unit_double(integers), rotation_double(integers)
    state = state_at_rest(rotation)
    return StationaryPose(
        quaternion=quaternion,
        rotation=rotation,
        balance=particles.balance(rotation),
        intrinsic=np.linalg.eigvals(moving.intrinsic_jacobian(state)).astype(np.complex128),
        ambient=np.linalg.eigvals(moving.ambient_jacobian(state)).astype(np.complex128),
        angle=angle(quaternion, best),
        half_turn_error=half_turn_error(quaternion, best),
        arccos_angle=arccos_angle(rotation, np.array(rotation_matrix(best.tolist()))),
    )


NO_BASIN["quaternions"] = np.eye(4)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Descent:
    """One simulation; energies in the paper's units, after each of the steps, the start first.

    times, potential, kinetic: (steps + 1,). state: (18,), the last, in the paper's order.
    stopped: whether the rates became small. diverged: whether they went beyond the doubles; else
    the steps ran out.
    """

    times: NDArray[np.float64]
    potential: NDArray[np.float64]
    kinetic: NDArray[np.float64]
    state: NDArray[np.float64]
    stopped: bool
    diverged: bool

    @property
    def steps(self) -> int:
        """How many steps were made."""
        return len(self.times) - 1

    @property
    def rotation(self) -> NDArray[np.float64]:
        """The last R, (3, 3)."""
        return named(self.state, MATRIX_STATE)["R"]

    @property
    def energy(self) -> NDArray[np.float64]:
        """V = V_p + V_k, (steps + 1,)."""
        return self.potential + self.kinetic


def descend(
    problem: RegistrationProblem, *, stop: float = STOP, max_steps: int = MAX_STEPS
) -> Descent:
    """The paper's simulation of a problem, from rest at R = I.

    Raises DegenerateProblemError for a collinear source.
    """
    moments = exact_moments(problem)
    moving = rigid_body(moments, problem.damping, length_exponent=RAW_UNIT)
    batch = Batch.of(
        Integrator.EULER,
        bodies=moving.record[np.newaxis],
        basins=NO_BASIN[np.newaxis],
        steps=np.array([STEP]).view(Integrator.EULER.step),
        states=named(start_at_rest(moments, RAW_UNIT), MATRIX_STATE)[np.newaxis],
    )
    log = Log.of_capacity(max_steps + 1, Integrator.EULER.sample)
    loop = SimulationSettings(speed_tolerance=stop, max_steps=max_steps)
    current_engine().run(batch, loop.rules, log)
    stopped = Ending(int(batch.status[0])) is not Ending.OUT_OF_STEPS
    per_mass = log.samples["energies"]
    mass = float(moments.total_weight)
    return Descent(
        times=log.samples["time"].copy(),
        potential=mass * per_mass["potential"],
        kinetic=mass * (per_mass["translation"] + per_mass["rotation"]),
        state=plain(batch.states)[0],
        stopped=stopped,
        diverged=not stopped and int(batch.taken[0]) < max_steps,
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SimulationRun(Descent):
    """That of one instance, and what else is known of it.

    Angles are in degrees, energies over the energy at the start.
    closed_form_error, error: of Horn's rotation and of the simulated one, to the true rotation;
    distance: between the two. least: V_p at the optimum, not over the
    start's. first_rise: of V in the first step of explicit Euler; predicted_rise: the same by
    h^2/2 (M |a|^2 + alpha^T J alpha). rises: how many steps raise V by more than rounding;
    potential_rises: V_p. midpoint_at_rest, midpoint_rise: of the implicit midpoint rule, whether it
    came to rest and the largest rise of V in a step. Errors are not a number where the steps went
    beyond the doubles.
    """

    closed_form_error: float
    error: float
    distance: float
    least: float
    first_rise: float
    predicted_rise: float
    rises: int
    potential_rises: int
    midpoint_at_rest: bool
    midpoint_rise: float


def simulation_run(
    problem: RegistrationProblem, true_rotation: NDArray[np.float64]
) -> SimulationRun:
    """The experiment on one instance. Raises DegenerateProblemError for a collinear source."""
    moments = exact_moments(problem)
    moving = rigid_body(moments, problem.damping, length_exponent=RAW_UNIT)
    descent = descend(problem)
    particles = Particles.of(problem)
    best, truth = horn(moving.cross_covariance), quaternion_from_matrix(true_rotation)
    end = np.full(4, np.nan)
    if not descent.diverged:
        end = quaternion_from_matrix(descent.rotation)
    energy, least = descent.energy, SAME_SUM
    midpoint = simulate(Isotropic(moments), problem.damping, Integrator.MIDPOINT)
    falling = midpoint.potential + midpoint.kinetic
    return SimulationRun(
        **{field.name: getattr(descent, field.name) for field in fields(Descent)},
        closed_form_error=angle(best, truth),
        error=angle(end, truth),
        distance=angle(end, best),
        least=particles.potential(state_at_rest(np.array(rotation_matrix(best.tolist())))),
        first_rise=float((energy[1] - energy[0]) / energy[0]) if descent.steps else 0.0,
        predicted_rise=_predicted_rise(particles, STEP) / float(energy[0]),
        rises=_rises(energy, least * energy[0]),
        potential_rises=_rises(descent.potential, least * energy[0]),
        midpoint_at_rest=midpoint.speed < STOP,
        midpoint_rise=float(np.diff(falling).max(initial=-np.inf) / falling[0]),
    )


def _rises(energies: NDArray[np.float64], least: float) -> int:
    """How many steps raise an energy by more than `least`."""
    return int((energies[1:] > energies[:-1] + least).sum())


def _predicted_rise(particles: Particles, step: float) -> float:
    """h^2/2 (M |a|^2 + alpha^T J alpha) at the paper's start."""
    rate = particles.rate(particles.start)
    _, _, a, alpha = parts(rate)
    return step**2 / 2.0 * float(particles.mass * a @ a + alpha @ particles.inertia @ alpha)
