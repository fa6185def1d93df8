"""A simulated registration: how it ended, and what else can be asked of it."""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import cached_property
from certreg.dynamics.states import with_matrices
from certreg.native.layout import Records, plain
from certreg.results import Absent, Brief, Explained

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.dynamics.body import AnyBody, Status
    from certreg.native.loops import Integrator
    from certreg.problem.problem import RegistrationProblem

RATE_START = 1e-3  # of the energy at the start: transients are over
RATE_END = 1e-13  # of the spread: rounding
LEAST_SAMPLES = 4  # to fit a line through

OF_THE_OPTIMUM = ("predicted_rate", "decay_rate", "energy_left")
NO_SCALES = Absent("the scale is 1")
TOO_FEW_SAMPLES = Absent("too few logged samples lie between the start and rest")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Course(Brief):
    """What the loops wrote of a run.

    samples: (L,) records of time, state and energies. last: (1,), the last state; time: of it.
    notes: what else is to be known: a step that was not taken as given, perturbations that did the
    work of the springs, and, where the steps ran out, what makes them too few.
    """

    samples: Records
    last: Records
    time: float
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True, eq=False)
class Trajectory(Explained):
    """A simulated registration; logged at evenly spaced steps, the last one included.

    How it ended is known at once; its states, energies and rates are computed when they are first
    asked for. Why there is no rate, and no scales, is stated, and not in `absent`.

    Attributes
    ----------
    integrator, status
        Which, and how it ended.
    step, steps, escapes
        The largest; how many; how often the body was perturbed off a saddle.
    moving
        The body, with what is certified of its optimum.
    course
        What all else is made of.
    absent
        Why an attribute is None, by its name.
    """

    integrator: Integrator
    status: Status
    step: float
    steps: int
    escapes: int
    moving: AnyBody
    course: Course

    def __repr__(self) -> str:
        how = f"{self.steps} steps of {self.integrator.value}"
        return f"<Trajectory: {self.status.name} after {how}>"

    @property
    def at_rest(self) -> bool:
        """Whether the body came to rest, wherever that is."""
        return self.status.at_rest

    @property
    def converged(self) -> bool:
        """Whether the body came to rest where it had to."""
        return self.at_rest

    @property
    def notes(self) -> tuple[str, ...]:
        """What else is to be known."""
        return self.course.notes

    @property
    def length_exponent(self) -> int:
        """The unit of length of the states is 2^length_exponent."""
        return self.moving.length_exponent

    @property
    def time(self) -> float:
        """At the end, in the time unit of the springs."""
        return self.course.time

    @property
    def last(self) -> Records:
        """The last state, ()."""
        return self.course.last[0]

    @cached_property
    def samples(self) -> Records:
        """What is logged, (L,) records of time, state and energies, the end included."""
        samples, last = self.course.samples, self.course.last
        if samples["time"][-1] == self.time and (plain(samples["state"][-1:]) == plain(last)).all():
            return samples
        end = np.empty(1, dtype=samples.dtype)
        end["time"], end["state"] = self.time, last
        end["energies"] = self.moving.energies(self.last)
        return np.append(samples, end)

    @property
    def times(self) -> NDArray[np.float64]:
        """(L,), in the time unit of the springs."""
        return self.samples["time"]

    @cached_property
    def states(self) -> NDArray[np.float64]:
        """(L, 18): c, R row by row, v, omega, with lengths over 2^length_exponent."""
        return plain(with_matrices(self.samples["state"]))

    @property
    def scales(self) -> NDArray[np.float64] | None:
        """(L,), target over source, where the scale is a state; None where it is 1."""
        return self.moving.scales(self.samples["state"])

    @property
    def potential(self) -> NDArray[np.float64]:
        """(L,), V_p / M over 4^length_exponent."""
        return self.samples["energies"]["potential"]

    @property
    def kinetic(self) -> NDArray[np.float64]:
        """(L,), V_k / M over 4^length_exponent."""
        return self.moving.kinetic(self.samples["energies"])

    @cached_property
    def quaternion(self) -> NDArray[np.float64]:
        """(4,), of the last state: what the basin proof is about."""
        return self.moving.quaternion(self.last)

    @property
    def angular_velocity(self) -> NDArray[np.float64]:
        """(3,), of the last state: what the basin proof is about."""
        return self.last["omega"]

    @cached_property
    def speed(self) -> float:
        """|s'| at the end, the residual of the equilibrium equations."""
        return self.moving.speed(self.last)

    @property
    def energy_left(self) -> float | None:
        """The share, at the end, of the energy above the optimum that the body began with.

        Near 0 where it came to the optimum; a body that is slow because of its damping, or not yet
        under way, has much of it left. 0 where it began with no more than rounding; None where
        nothing is certified of the optimum.
        """
        least = self.moving.least_energy
        if least is None:
            return None
        above = self.potential + self.kinetic - least
        if not above[0] > RATE_END * self.moving.spread:
            return 0.0
        return max(0.0, float(above[-1] / above[0]))

    @cached_property
    def predicted_rate(self) -> float | None:
        """Of the slowest mode at the optimum, by the linearised dynamics; None if not unique."""
        return self.moving.slowest_rate

    @cached_property
    def decay_rate(self) -> float | None:
        """As measured in the logged energies; None where the optimum is not unique.

        Or where too few samples lie between a thousandth of the energy at the start and rounding.
        """
        least = self.moving.least_energy
        if least is None or self.predicted_rate is None:
            return None
        above = self.potential + self.kinetic - least
        return _decay_rate(self.times, above, self.moving.spread)

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
        if name == "scales" and self.scales is None:
            return NO_SCALES
        if name in OF_THE_OPTIMUM and getattr(self, name) is None:
            return self.moving.NO_RATE if self.predicted_rate is None else TOO_FEW_SAMPLES
        return Explained.stated(self, name)


def _decay_rate(
    times: NDArray[np.float64], above: NDArray[np.float64], spread: float
) -> float | None:
    """Half the slope of the logarithm of the energy above the optimum's: amplitudes decay so."""
    tail = (above < RATE_START * above[0]) & (above > RATE_END * spread)
    if np.count_nonzero(tail) < LEAST_SAMPLES:
        return None
    slope = np.polyfit(times[tail], np.log(above[tail]), 1)[0]
    return -0.5 * float(slope)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Record:
    """A trajectory as it is kept: poses and energies, no points.

    times (L,); states (L, 18), potential and kinetic (L,) as in `certreg.Trajectory`.
    digest: of the problem, 64 hexadecimal digits. damping: mu, which no certificate holds.
    scales: (L,), target over source, of a body whose scale is free; None of others.
    """

    times: NDArray[np.float64]
    states: NDArray[np.float64]
    potential: NDArray[np.float64]
    kinetic: NDArray[np.float64]
    length_exponent: int
    damping: float
    digest: str
    scales: NDArray[np.float64] | None = None

    @classmethod
    def of(cls, problem: RegistrationProblem, trajectory: Trajectory) -> Record:
        """What is kept of a trajectory of a problem."""
        return cls(
            times=trajectory.times,
            states=trajectory.states,
            potential=trajectory.potential,
            kinetic=trajectory.kinetic,
            length_exponent=trajectory.length_exponent,
            damping=problem.damping,
            digest=problem.digest(),
            scales=trajectory.scales,
        )

    def to_bytes(self) -> bytes:
        """The file's content, a .npz of these; the digest as its 32 bytes."""
        buffer = io.BytesIO()
        scales: dict[str, Any] = {} if self.scales is None else {"scales": self.scales}
        np.savez_compressed(
            buffer,
            times=self.times,
            states=self.states,
            potential=self.potential,
            kinetic=self.kinetic,
            length_exponent=np.array(self.length_exponent),
            damping=np.array(self.damping),
            digest=np.frombuffer(bytes.fromhex(self.digest), dtype=np.uint8),
            **scales,
        )
        return buffer.getvalue()
