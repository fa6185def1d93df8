"""A simulated registration: how it ended, and what else can be asked of it."""

from __future__ import annotations

import enum
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import cached_property
from certreg.dynamics.body import state_at_rest
from certreg.geometry import quaternion_from_matrix, rotation_matrices, rotation_matrix
from certreg.native import MATRIX_STATE, Integrator, plain
from certreg.results import Absent, Brief, Explained

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.dynamics.basin import Basin
    from certreg.dynamics.body import Body
    from certreg.native import Records

RATE_START = 1e-3  # of the energy at the start: transients are over
RATE_END = 1e-13  # of the spread: rounding
LEAST_SAMPLES = 4  # to fit a line through

RATES = ("predicted_rate", "decay_rate")
NO_RATE = Absent("the optimum is not unique: no rate belongs to it")
TOO_FEW_SAMPLES = Absent("too few logged samples lie between the start and rest")


class SimulationStatus(enum.Enum):
    """How a simulation ended; the value is the message shown to the user."""

    CONVERGED = (
        "The body is at rest (slower than the tolerance), its rotation with too little energy to "
        "leave the optimum."
    )
    AT_REST = (
        "The body is at rest (slower than the tolerance); where no optimum is unique, no more is "
        "asked."
    )
    OUT_OF_STEPS = (
        "The steps ran out before the body was at rest at the optimum. The certificate does not "
        "depend on it."
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Course(Brief):
    """What the loops wrote of a run.

    samples: (L,) records `integrator.sample`. last: (1,), the last state, a record
    `integrator.state`; time: of it.
    """

    samples: Records
    last: Records
    time: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Logged:
    """The samples and the last state: times (L,), states (L,) with matrices, energies (L,)."""

    times: NDArray[np.float64]
    states: Records
    potential: NDArray[np.float64]
    kinetic: NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, eq=False)
class Trajectory(Explained):
    """A simulated registration; logged at evenly spaced steps, the last one included.

    How it ended is known at once; its states, energies and rates are computed when they are first
    asked for. Why there is no rate is stated, and not in `absent`.

    Attributes
    ----------
    integrator, status
        Which, and how it ended.
    step, steps, escapes
        The largest; how many; how often the body was perturbed off a saddle.
    notes
        What else is to be known: a step that was not taken as given, perturbations that did the
        work of the springs, and, where the steps ran out, what makes them too few.
    moving, basin
        The body, and what is certified of it.
    course
        What all else is made of.
    absent
        Why an attribute is None, by its name.
    """

    integrator: Integrator
    status: SimulationStatus
    step: float
    steps: int
    escapes: int
    notes: tuple[str, ...]
    moving: Body
    basin: Basin
    course: Course

    def __repr__(self) -> str:
        how = f"{self.steps} steps of {self.integrator.value}"
        return f"<Trajectory: {self.status.name} after {how}>"

    @property
    def energy_left(self) -> float:
        """The share, at the end, of the energy above the optimum that the body began with.

        Near 0 where it came to the optimum; a body that is slow because of its damping, or not yet
        under way, has much of it left. 0 where it began with no more than rounding.
        """
        above = self.potential + self.kinetic
        above = above - self.moving.energies(_at_rest(self.basin.optimum)).potential
        if not above[0] > RATE_END * self.moving.spread:
            return 0.0
        return max(0.0, float(above[-1] / above[0]))

    @property
    def converged(self) -> bool:
        """Whether the body came to rest where it had to."""
        return self.status in {SimulationStatus.CONVERGED, SimulationStatus.AT_REST}

    @property
    def length_exponent(self) -> int:
        """The unit of length of the states is 2^length_exponent."""
        return self.moving.length_exponent

    @property
    def times(self) -> NDArray[np.float64]:
        """(L,), in the time unit of the springs."""
        return self._logged.times

    @cached_property
    def states(self) -> NDArray[np.float64]:
        """(L, 18), with lengths over 2^length_exponent; see `certreg.dynamics.body`."""
        return plain(self._logged.states)

    @property
    def potential(self) -> NDArray[np.float64]:
        """(L,), V_p / M over 4^length_exponent."""
        return self._logged.potential

    @property
    def kinetic(self) -> NDArray[np.float64]:
        """(L,), V_k / M over 4^length_exponent."""
        return self._logged.kinetic

    @cached_property
    def quaternion(self) -> NDArray[np.float64]:
        """(4,), of the last state: what the basin proof is about."""
        return quaternion_from_matrix(self._last["R"][0])

    @property
    def angular_velocity(self) -> NDArray[np.float64]:
        """(3,), of the last state: what the basin proof is about."""
        return self.course.last["omega"][0]

    @cached_property
    def speed(self) -> float:
        """|s'| at the end, the residual of the equilibrium equations."""
        return float(np.linalg.norm(self.moving.rate(plain(self._last)[0])))

    @cached_property
    def _last(self) -> Records:
        """The last state, (1,), with a rotation matrix."""
        return with_matrices(self.course.last, self.integrator)

    @cached_property
    def _logged(self) -> _Logged:
        return _logged(self.course, self._last, self.moving, self.integrator)

    @cached_property
    def predicted_rate(self) -> float | None:
        """Of the slowest mode at the optimum, by the linearised dynamics; None if not unique."""
        return _predicted_rate(self.moving, self.basin) if self._unique else None

    @cached_property
    def decay_rate(self) -> float | None:
        """As measured in the logged energies; None where the optimum is not unique.

        Or where too few samples lie between a thousandth of the energy at the start and rounding.
        """
        if not self._unique:
            return None
        energy = self.potential + self.kinetic
        return _decay_rate(self.times, energy, self.moving, self.basin)

    @property
    def _unique(self) -> bool:
        return self.basin.barrier > 0.0

    def stated(self, name: str) -> Any:
        """The attribute of that name, or the Absent that stands for it.

        Parameters
        ----------
        name
            Of an attribute that may be None.

        Returns
        -------
        Any
            Its value; where that is None, the reason.
        """
        if name in RATES and getattr(self, name) is None:
            return TOO_FEW_SAMPLES if self._unique else NO_RATE
        return Explained.stated(self, name)


def with_matrices(states: Records, integrator: Integrator) -> Records:
    """States (L,) with rotation matrices."""
    if integrator is Integrator.EULER:
        return states
    turned = np.empty(len(states), dtype=MATRIX_STATE)
    turned["R"] = rotation_matrices(states["q"])
    for part in ("c", "v", "omega"):
        turned[part] = states[part]
    return turned


def _logged(course: Course, last: Records, moving: Body, integrator: Integrator) -> _Logged:
    """All that is logged of a run, its end included; last: as in `course`, with a matrix."""
    samples = course.samples
    times, states = samples["time"], with_matrices(samples["state"], integrator)
    energies = samples["energies"]
    kinetic, potential = energies["translation"] + energies["rotation"], energies["potential"]
    if times[-1] != course.time or (plain(states)[-1] != plain(last)[0]).any():
        end = moving.energies(plain(last)[0])
        times, states = np.append(times, course.time), np.append(states, last)
        kinetic, potential = np.append(kinetic, end.kinetic), np.append(potential, end.potential)
    return _Logged(times=times, states=states, potential=potential, kinetic=kinetic)


def _predicted_rate(moving: Body, basin: Basin) -> float:
    """The decay rate of the slowest mode of the linearised dynamics at the optimum."""
    optimum = _at_rest(basin.optimum)
    return -float(np.linalg.eigvals(moving.intrinsic_jacobian(optimum)).real.max())


def _decay_rate(
    times: NDArray[np.float64], energy: NDArray[np.float64], moving: Body, basin: Basin
) -> float | None:
    """Half the slope of the logarithm of the energy above the optimum's: amplitudes decay so."""
    above = energy - moving.energies(_at_rest(basin.optimum)).potential
    tail = (above < RATE_START * above[0]) & (above > RATE_END * moving.spread)
    if np.count_nonzero(tail) < LEAST_SAMPLES:
        return None
    slope = np.polyfit(times[tail], np.log(above[tail]), 1)[0]
    return -0.5 * float(slope)


def _at_rest(q: NDArray[np.float64]) -> NDArray[np.float64]:
    """The state (18,) at rest with the rotation of a unit quaternion, the centroids together."""
    return state_at_rest(np.array(rotation_matrix(q.tolist())))
