"""The paper's simulation: explicit Euler, R projected, stopped where the rates are small.

The same loop that `certreg simulate` runs, in the paper's raw units of length, with its fixed step
and without what certreg adds: no certified basin, no escape from a saddle. So a run may stop where
it should not, as the paper's may.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.dynamics.integrators import SimulationSettings
from certreg.dynamics.rigid import rigid_body
from certreg.dynamics.states import start_at_rest
from certreg.native.engine import current_engine
from certreg.native.layout import BASIN, MATRIX_STATE, named, plain
from certreg.native.loops import Batch, Ending, Integrator, Log
from certreg.problem.moments import exact_moments

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.problem.problem import RegistrationProblem

STEP = 0.01  # [Yang2020]
STOP = 1e-4  # [Yang2020]: norm of the 18 rates of change, lengths in the user's unit
MAX_STEPS = 100_000  # a thousand are usual; a run of so many has not converged
RAW_UNIT = 0  # the exponent of the unit of length: |s'| mixes lengths and angles, as in the paper
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
