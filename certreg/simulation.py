"""Simulated registration: the damped body released from rest until it is certain where it ends.

Explicit Euler with projection, as in [Yang2020]. A small |s'| alone proves nothing: near a saddle
it is small, too. So a run ends only when |s'| is small *and* the state is in the certified basin
(documented at `Basin`), from which the exact flow can end nowhere but at the optimum. A stop at a
saddle is noticed from the curvature, kicked along the direction of escape, and continued.
"""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from certreg.dynamics import (
    SPRING_OVER_MASS,
    Body,
    Floats,
    body,
    euler_step,
    start_at_rest,
)
from certreg.equilibria.spectral import unit_double
from certreg.errors import DegenerateProblemError
from certreg.settings import SimulationSettings
from certreg.so3 import quaternion_from_matrix, rotation_matrix

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.equilibria.spectral import Spectrum


class SimulationStatus(enum.Enum):
    """How a simulation ended; the value is the message shown to the user."""

    CONVERGED = "The body came to rest at the optimum, inside the certified basin."
    AT_REST = (
        "The body came to rest at one of the optima; where the optimum is not unique, no more."
    )
    OUT_OF_STEPS = (
        "The body was still moving when the steps ran out. The certificate does not depend on it; "
        "problems with an ambiguity margin below a few thousandths can be that slow."
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Basin:
    """The certified basin of the optimum, as the simulation sees it (floating point proposes).

    E = omega^T J omega / 2 - 2 q^T K q never rises along the exact flow, and at every spurious
    equilibrium E >= -2 l2. So a state with l1 - q^T K q + omega^T J omega / 4 < l1 - l2 has less
    energy than all of them, and by LaSalle's theorem ends at the optimum. The left side is a sum of
    squares, (l1 - lk) (q . q_k)^2, and so has no cancellation.

    quaternions: (4, 4), orthonormal rows, by descending eigenvalue.
    deficits: (4,), l1 - lk over the spread (sum w |x - mean|^2 + sum w |y - mean|^2).
    """

    quaternions: NDArray[np.float64]
    deficits: NDArray[np.float64]

    @property
    def barrier(self) -> float:
        """l1 - l2, over the spread."""
        return float(self.deficits[1])

    def height(self, q: NDArray[np.float64], rotational: float) -> float:
        """l1 - q^T K q + rotational / 2, rotational being omega^T J omega / 2; over the spread."""
        return float(self.deficits @ (self.quaternions @ q) ** 2) + rotational / 2.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trajectory:
    """A simulated registration; logged at evenly spaced steps, the last one included.

    times (L,), in the time unit of the springs; states (L, 18) with lengths over
    2^length_exponent; potential and kinetic (L,), V_p / M and V_k / M over 4^length_exponent.
    quaternion: (4,), angular_velocity: (3,), of the last state: what the basin proof is about.
    escapes: how many times the body was kicked off a saddle.
    """

    status: SimulationStatus
    step: float
    steps: int
    escapes: int
    times: NDArray[np.float64]
    states: NDArray[np.float64]
    potential: NDArray[np.float64]
    kinetic: NDArray[np.float64]
    length_exponent: int
    quaternion: NDArray[np.float64]
    angular_velocity: NDArray[np.float64]
    speed: float  # |s'| at the end

    @property
    def converged(self) -> bool:
        """Whether the body came to rest where it had to."""
        return self.status in {SimulationStatus.CONVERGED, SimulationStatus.AT_REST}


@dataclass(slots=True)
class _Log:
    """Samples at evenly spaced steps; when it is full, every second goes, the stride doubles."""

    capacity: int
    stride: int = 1
    samples: list[tuple[int, Floats]] = field(default_factory=list[tuple[int, Floats]])

    def add(self, step: int, state: Floats) -> None:
        if step % self.stride:
            return
        if len(self.samples) >= self.capacity:
            self.samples = self.samples[::2]
            self.stride *= 2
            if step % self.stride:
                return
        self.samples.append((step, state))


def simulate(
    found: Spectrum,
    damping: float,
    *,
    start: Floats | None = None,
    settings: SimulationSettings | None = None,
) -> Trajectory:
    """The trajectory of the body of a problem, by default released at rest where it was given.

    start: 18 numbers (see `certreg.dynamics`), lengths over 2^length_exponent of the body.
    Raises DegenerateProblemError where the dynamics is undefined or too stiff for explicit Euler.
    """
    settings = settings or SimulationSettings()
    if not found.classification.inertia_definite:
        message = "the source points are collinear: the rotational dynamics is not defined"
        raise DegenerateProblemError(message)
    moving = body(found.moments, damping)
    basin = certified_basin(found)
    step = _stable_step(moving, basin, settings)
    state = start or start_at_rest(found.moments, moving.length_exponent)
    log = _Log(settings.log_capacity)
    status, escapes, kick = SimulationStatus.OUT_OF_STEPS, 0, settings.first_kick
    steps = 0
    while True:
        log.add(steps, state)
        derivative = moving.derivative(state)
        if math.hypot(*derivative) < settings.speed_tolerance:
            ended = _rest(moving, basin, state, settings)
            if ended is not None:
                status = ended
                break
            escape = _kicked(moving, state, kick)
            if escape is not None:
                state, escapes = escape, escapes + 1
                kick = min(kick * settings.kick_growth, settings.largest_kick)
                derivative = moving.derivative(state)
        if steps == settings.max_steps:
            break
        state = euler_step(state, derivative, step)
        steps += 1
    return _trajectory(moving, log, state, _Ending(status, step, steps, escapes))


def certified_basin(found: Spectrum) -> Basin:
    """The basin that belongs to a spectrum."""
    values = found.basis.values
    unit = found.unit / found.moments.spread
    deficits = [float((values[0] - value) * unit) for value in values]
    for k in range(found.classification.pattern[0]):
        deficits[k] = 0.0
    return Basin(
        quaternions=np.array([unit_double(v) for v in found.basis.vectors]),
        deficits=np.array(deficits),
    )


@dataclass(frozen=True, slots=True)
class _Ending:
    status: SimulationStatus
    step: float
    steps: int
    escapes: int


def _stable_step(moving: Body, basin: Basin, settings: SimulationSettings) -> float:
    """The paper's step, or the largest that explicit Euler can take here.

    The stiffest mode s^2 + mu s + g has g <= (l1 - l4) / least eigenvalue of J; Euler follows an
    oscillation only if h < mu / g, a decay only if h < 2 / mu.
    """
    least = float(np.linalg.eigvalsh(np.array(moving.inertia).reshape(3, 3))[0])
    stiffness = max(SPRING_OVER_MASS, float(basin.deficits[3]) * moving.spread / max(least, 5e-324))
    limit = settings.stability_share * min(1.0 / moving.damping, moving.damping / stiffness)
    if not limit > settings.least_step:
        message = (
            "the two clouds differ so much in size, or the damping is so extreme, that explicit "
            "Euler would need too small a step: bring both clouds to one unit of length"
        )
        raise DegenerateProblemError(message)
    return min(settings.step, limit)


def _rest(
    moving: Body, basin: Basin, state: Floats, settings: SimulationSettings
) -> SimulationStatus | None:
    """How the run ends if the state, which hardly moves, is where it may end; else None."""
    q = quaternion_from_matrix(np.array(state[3:12]).reshape(3, 3))
    height = basin.height(q, moving.rotational(state) / moving.spread)
    if basin.barrier > 0.0:
        inside = height < settings.basin_share * basin.barrier
        return SimulationStatus.CONVERGED if inside else None
    lowest = height < settings.rest_height * basin.deficits[3] or basin.deficits[3] == 0.0
    return SimulationStatus.AT_REST if lowest else None


def _kicked(moving: Body, state: Floats, angle: float) -> Floats | None:
    """The state turned downhill along the direction of lowest curvature; None in a valley.

    At an equilibrium that direction is the witness of instability.
    """
    R = np.array(state[3:12]).reshape(3, 3)
    A = R.T @ np.array(moving.cross_covariance).reshape(3, 3)
    curvatures, directions = np.linalg.eigh(2.0 * np.trace(A) * np.eye(3) - A - A.T)
    if curvatures[0] >= 0.0:
        return None
    torque = np.array([A[2, 1] - A[1, 2], A[0, 2] - A[2, 0], A[1, 0] - A[0, 1]])
    axis = directions[:, 0] if directions[:, 0] @ torque >= 0.0 else -directions[:, 0]
    q = (math.cos(angle / 2), *(math.sin(angle / 2) * axis).tolist())
    turned = R @ np.array(rotation_matrix(q))
    return (*state[:3], *turned.ravel().tolist(), *state[12:])


def _trajectory(moving: Body, log: _Log, last: Floats, ending: _Ending) -> Trajectory:
    samples = log.samples if log.samples[-1][1] is last else [*log.samples, (ending.steps, last)]
    states = [state for _, state in samples]
    return Trajectory(
        status=ending.status,
        step=ending.step,
        steps=ending.steps,
        escapes=ending.escapes,
        times=ending.step * np.array([step for step, _ in samples]),
        states=np.array(states),
        potential=np.array([moving.potential(state) for state in states]),
        kinetic=np.array([moving.kinetic(state) for state in states]),
        length_exponent=moving.length_exponent,
        quaternion=quaternion_from_matrix(np.array(last[3:12]).reshape(3, 3)),
        angular_velocity=np.array(last[15:]),
        speed=math.hypot(*moving.derivative(last)),
    )
