"""The paper's simulation: explicit Euler, R projected, stopped where the rates are small.

The same loop that `certreg simulate` runs, in the paper's raw units of length, with its fixed step
and without what certreg adds: no certified basin, no escape from a saddle. So a run may stop where
it should not, as the paper's may. In the paper's second experiment random instances are solved by
it. What is measured of the energy is measured at every step; the rise that theory tells for the
first step is computed from the paper's equations, as sums over the particles.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.dynamics.integrators import SimulationSettings
from certreg.dynamics.rigid import rigid_body
from certreg.dynamics.simulation import simulate
from certreg.dynamics.states import start_at_rest
from certreg.geometry.so3 import quaternion_from_matrix, rotation_matrix
from certreg.native.engine import current_engine
from certreg.native.layout import BASIN, MATRIX_STATE, named, plain
from certreg.native.loops import Batch, Ending, Integrator, Log
from certreg.objective.isotropic import Isotropic
from certreg.paper.equilibria import angle
from certreg.paper.particles import RAW_UNIT, SAME_SUM, Particles, at_rest, parts
from certreg.problem.moments import exact_moments
from certreg.registration.closed_form import horn

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.problem.problem import RegistrationProblem


STEP = 0.01  # [Yang2020]
STOP = 1e-4  # [Yang2020]: norm of the 18 rates of change, lengths in the user's unit
MAX_STEPS = 100_000  # a thousand are usual; a run of so many has not converged
# Gaps of zero: no pose is better than another, so that the loop, which would else look for the
# basin, stops wherever the body is slow. That is the paper's rule.
NO_BASIN = np.zeros((), dtype=BASIN)
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
class SimulationRun:
    """One instance. Angles in degrees; energies over the energy at the start.

    closed_form_error, error: of Horn's rotation and of the simulated one, to the true rotation;
    distance: between the two. stopped: by the paper's rule. least: V_p at the optimum, not over the
    start's. first_rise: of V in the first step of explicit Euler; predicted_rise: the same by
    h^2/2 (M |a|^2 + alpha^T J alpha). rises: how many steps raise V by more than rounding;
    potential_rises: V_p. midpoint_at_rest, midpoint_rise: of the implicit midpoint rule, whether it
    came to rest and the largest rise of V in a step. Errors are not a number where the steps went
    beyond the doubles.
    """

    descent: Descent
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

    @property
    def steps(self) -> int:
        """How many steps the simulation took."""
        return self.descent.steps

    @property
    def diverged(self) -> bool:
        """Whether the steps went beyond the doubles."""
        return self.descent.diverged

    @property
    def stopped(self) -> bool:
        """Whether the paper's rule stopped it before the steps ran out."""
        return self.descent.stopped


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
        descent=descent,
        closed_form_error=angle(best, truth),
        error=angle(end, truth),
        distance=angle(end, best),
        least=particles.potential(at_rest(np.array(rotation_matrix(best.tolist())))),
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
