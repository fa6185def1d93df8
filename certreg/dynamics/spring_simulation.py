"""The body on general springs, simulated: midpoint or splitting, one body or many.

Stable equilibria that are not the optimum exist here, so that a body at rest is not yet at the
optimum: a run ends when the body is slow, in a valley of the energy, and the springs would take it
no further than `rest_angle`. At a saddle it is perturbed along the direction of escape. Where no
spring resists a shift the body coasts along it until damping has stopped it.
"""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from certreg._loading import cached_property
from certreg.dynamics.integrators import (
    MIDPOINT_MOST,
    MIDPOINT_SHARE,
    SPLITTING_SHARE,
    SimulationSettings,
    integrate,
)
from certreg.dynamics.spring_body import MovingSprings, moving_springs, state_of
from certreg.dynamics.trajectory import with_matrices
from certreg.equilibrium import TRANSLATION_STIFFNESS
from certreg.errors import DegenerateProblemError
from certreg.exact import rank
from certreg.native import (
    SPRING_ENERGIES,
    SPRING_SAMPLE,
    Batch,
    Ending,
    Integrator,
    Log,
    named,
    plain,
)
from certreg.problem import Cell, Verb, require_supported
from certreg.results import Brief

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from certreg.native import Records
    from certreg.objective import Springs

LOG_CAPACITY = 2048  # samples of a trajectory that are kept
# Rotations over which the stiffest mode is looked for: those of the cube.
CUBE = np.array(
    [
        *np.eye(4).tolist(),
        *(np.array(signs) / 2.0 for signs in product((1.0,), *[(1.0, -1.0)] * 3)),
        *(
            [math.sqrt(0.5) * (k == i) + s * math.sqrt(0.5) * (k == j) for k in range(4)]
            for i, j in ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))
            for s in (1.0, -1.0)
        ),
    ]
)


class SpringStatus(enum.Enum):
    """How a simulation on general springs ended; the value is the message shown to the user."""

    AT_REST = (
        "The body is at rest: slower than the tolerance, in a valley of the energy. Which one it "
        "is does not follow from that."
    )
    OUT_OF_STEPS = "The steps ran out before the body was at rest."


@dataclass(frozen=True, kw_only=True, eq=False)
class SpringTrajectory(Brief):
    """A simulation on general springs; logged at evenly spaced steps.

    samples: (L,) records SPRING_SAMPLE; last: the last state, () of QUATERNION_STATE, at `time`;
    lengths over 2^length_exponent of `moving`, c from its origin. step: the largest; escapes: how
    often the body was perturbed off a saddle.
    """

    integrator: Integrator
    status: SpringStatus
    step: float
    steps: int
    escapes: int
    time: float
    moving: MovingSprings
    samples: Records
    last: Records

    def __repr__(self) -> str:
        how = f"{self.steps} steps of {self.integrator.value}"
        return f"<SpringTrajectory: {self.status.name} after {how}>"

    @property
    def at_rest(self) -> bool:
        """Whether the body came to rest, wherever that is."""
        return self.status is SpringStatus.AT_REST

    @property
    def quaternion(self) -> NDArray[np.float64]:
        """(4,), of the last state."""
        return self.last["q"]

    @cached_property
    def speed(self) -> float:
        """|s'| at the end, the residual of the equilibrium equations."""
        return math.sqrt(self.moving.squared_speed(self.last))

    @property
    def length_exponent(self) -> int:
        """The unit of length of the states is 2^length_exponent."""
        return self.moving.length_exponent

    @cached_property
    def logged(self) -> Records:
        """The samples, (L,) records SPRING_SAMPLE, the last state included."""
        if len(self.samples) and self.samples["time"][-1] == self.time:
            return self.samples
        end = np.zeros(1, dtype=SPRING_SAMPLE)
        end["time"], end["state"] = self.time, self.last
        end["energies"] = named(self.moving.energies(self.last), SPRING_ENERGIES)
        return np.append(self.samples, end)

    @property
    def times(self) -> NDArray[np.float64]:
        """(L,), in the time unit of the springs."""
        return self.logged["time"]

    @cached_property
    def states(self) -> NDArray[np.float64]:
        """(L, 18), c, R row by row, v, omega, lengths over 2^length_exponent."""
        return plain(with_matrices(self.logged["state"], self.integrator))

    @property
    def potential(self) -> NDArray[np.float64]:
        """(L,), V_p / M over 4^length_exponent."""
        return self.logged["energies"]["potential"]

    @property
    def kinetic(self) -> NDArray[np.float64]:
        """(L,), V_k / M over 4^length_exponent."""
        energies = self.logged["energies"]
        return energies["translation"] + energies["rotation"]


def simulate_springs(
    objective: Springs,
    damping: float,
    integrator: Integrator = Integrator.MIDPOINT,
    *,
    start: Records | None = None,
    settings: SimulationSettings | None = None,
) -> SpringTrajectory:
    """The trajectory of the body on general springs, released at rest where it was given.

    start: another state, () of QUATERNION_STATE, see `MovingSprings`. Raises
    DegenerateProblemError where the dynamics is undefined; ValueError for explicit Euler.
    """
    settings = settings or SimulationSettings()
    moving = moving_of(objective, damping)
    state = moving.start if start is None else start
    bodies, starts = moving.record[np.newaxis], state[np.newaxis]
    batch = Batch.of(
        integrator,
        bodies=bodies,
        steps=spring_steps(integrator, (moving,), starts, settings),
        states=starts,
    )
    log = Log.of_capacity(LOG_CAPACITY, SPRING_SAMPLE)
    integrate(batch, settings, log)
    ended = batch.status[0] == Ending.AT_REST
    return SpringTrajectory(
        integrator=integrator,
        status=SpringStatus.AT_REST if ended else SpringStatus.OUT_OF_STEPS,
        step=float(batch.steps["h"][0]),
        steps=int(batch.taken[0]),
        escapes=int(batch.escapes[0]),
        time=float(batch.times[0]),
        moving=moving,
        samples=log.samples,
        last=batch.states[0],
    )


def moving_of(objective: Springs, damping: float) -> MovingSprings:
    """The body of an objective. Raises DegenerateProblemError where the dynamics is undefined."""
    if rank(objective.mass_scatter) < 2:
        message = "the source points are collinear: the rotational dynamics is not defined"
        raise DegenerateProblemError(message, rank=rank(objective.mass_scatter))
    return moving_springs(objective.moments, damping)


def spring_steps(
    integrator: Integrator,
    bodies: Sequence[MovingSprings],
    starts: Records,
    settings: SimulationSettings,
) -> Records:
    """The steps (count,), records `integrator.step`: its own, or the user's where stable.

    Raises InvalidProblemError for explicit Euler, which is not there for general springs.
    """
    require_supported(Cell(springs=True), Verb(integrator.value))
    fastest = np.array([stiffest(body, state) for body, state in zip(bodies, starts, strict=True)])
    period = np.sqrt(TRANSLATION_STIFFNESS / fastest)  # 1 on isotropic springs without noise
    steps = np.empty(len(bodies), dtype=integrator.step)
    if integrator is Integrator.MIDPOINT:
        own = MIDPOINT_SHARE * period
        given = np.minimum(settings.step or np.inf, MIDPOINT_MOST * own)
        steps["h"] = given if settings.step else own
        return steps
    h = np.minimum(settings.step or np.inf, SPLITTING_SHARE * period)
    mu = np.array([body.damping for body in bodies])
    steps["h"], steps["decay"], steps["impulse"] = h, np.exp(-mu * h), -np.expm1(-mu * h) / mu
    return steps


def stiffest(moving: MovingSprings, start: Records) -> float:
    """The largest curvature of the energy beside the inertia, over some rotations: a proposal."""
    hessians = [moving.curvature(state_of(q))[0] for q in (*CUBE, start["q"])]
    whitening = np.eye(6)
    whitening[3:, 3:] = np.linalg.inv(np.linalg.cholesky(moving.inertia))
    values = np.linalg.eigvalsh(whitening @ np.array(hessians) @ whitening.T)
    return max(float(values.max()), TRANSLATION_STIFFNESS)
