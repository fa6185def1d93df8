"""The moving body: what the dynamics knows of a problem, and its functions.

A point of the source has a mass and a damping mu times that; a spring pulls it to its target. Only
sums over the points enter, as a record of numbers per unit of mass, lengths over a power of two;
time has its own unit. R takes body to world coordinates, omega is in the body frame. There are
three bodies. On springs 2 w of one weight per pair, masses w [Yang2020]:

    c' = v,    R' = R [omega],    v' = -2 c - mu v,
    J omega' = 2 vee(R^T C - C^T R) - mu J omega - omega x J omega,

c the source's centre of mass minus the target's. On springs that are matrices W, masses tr(W) / 3:

    v' = f - mu v,    J omega' = tau - mu J omega - omega x J omega,

f and tau the force and the torque of the springs, c from `SprungBody.origin`. And one that
breathes: a point stands at s R x + c, and the size s is a state:

    s J omega' = 2 vee(R^T C - C^T R) - s omega x J omega - (mu s + 2 p) J omega,    s' = p,
    Sxx p' = s omega^T J omega - 2 s Sxx + 2 tr(R^T C) - mu Sxx p.

Nothing is evaluated here: the functions are generated from the derivations
(certreg/native/generated) and run compiled; those of the first body also in Python.
"""

from __future__ import annotations

import enum
import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from certreg.dynamics.integrators import SimulationSettings, own_steps
from certreg.equilibrium.equilibrium_set import unit_entries
from certreg.errors import DegenerateProblemError
from certreg.native.engine import compiled_engine, current_engine
from certreg.native.layout import BASIN, Records, RecordType, named, record_of, symmetric
from certreg.native.loops import Ending, Engine, Integrator, Kind
from certreg.problem.support import Cell, Verb, require_supported
from certreg.results import Absent, Brief

if TYPE_CHECKING:
    from fractions import Fraction

    from numpy.typing import NDArray

    from certreg.objective.isotropic import Isotropic


SMALLEST_INERTIA = 1e-14  # of the clouds' spread: below, rounding is larger than J itself
CLEARLY_THICK = 1e-10  # far above that and all rounding
SMALLEST_BARRIER = 1e-280  # of l1 - l2: shares of it, times squares of small angles, are doubles
TIE = 1e-13  # of l1 - l4: doubles do not tell such eigenvalues apart


class Status(enum.Enum):
    """How a simulation ended."""

    @property
    def at_rest(self) -> bool:
        """Whether the body came to rest."""
        return self.name in {"CONVERGED", "AT_REST"}

    @classmethod
    def by_ending(cls) -> dict[int, Self]:
        """Those of a body, by how the loops say that its run ended."""
        return {Ending[name]: status for name, status in cls.__members__.items()}


class SimulationStatus(Status):
    """Of a body on springs of one weight per pair."""

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


class SpringStatus(Status):
    """Of a body on general springs."""

    AT_REST = (
        "The body is at rest: slower than the tolerance, in a valley of the energy. Which one it "
        "is does not follow from that."
    )
    OUT_OF_STEPS = "The steps ran out before the body was at rest."


class BreathingStatus(Status):
    """Of a body with a free scale."""

    AT_REST = (
        "The body is at rest: slower than the tolerance, where the energy falls in no direction."
    )
    COLLAPSED = (
        "The scale falls to 0, where the inertia vanishes and the motion is not defined: stopped "
        "before it. Begin with less energy, nearer to the target in size and rotation."
    )
    OUT_OF_STEPS = "The steps ran out before the body was at rest."


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AnyBody(Brief, ABC):
    """What the dynamics knows of a problem: per unit of mass, lengths over 2^length_exponent.

    record: () of numbers, as certreg/native/generated lists them. basin: what is certified of the
    optimum, if anything is.
    """

    KIND: ClassVar[Kind]
    ENERGIES: ClassVar[RecordType]
    SAMPLE: ClassVar[RecordType | None] = None  # as the integrator has it
    STATUS: ClassVar[Mapping[int, Status]]  # by `Ending`
    INTEGRATOR: ClassVar[Integrator] = Integrator.MIDPOINT  # where the user names none
    NO_RATE: ClassVar[Absent]  # why there is no rate of decay, where there is none

    record: Records
    length_exponent: int
    basin: Basin | None = None

    @property
    @abstractmethod
    def mass(self) -> Fraction:
        """M, exact, in the user's unit."""

    @property
    def inertia(self) -> NDArray[np.float64]:
        """J / M, (3, 3)."""
        return symmetric(self.record["inertia"])

    @property
    def damping(self) -> float:
        """The damping mu."""
        return float(self.record["damping"])

    @property
    @abstractmethod
    def start(self) -> Records:
        """The state () at rest where the source was given."""

    def sample(self, integrator: Integrator) -> RecordType:
        """The record of a logged state: time, state, energies."""
        return self.SAMPLE or integrator.sample

    def stated(self, start: Records | None, integrator: Integrator) -> Records:
        """A start (1,) as an integrator keeps it, copied; None: where the source was given."""
        del integrator
        return (self.start if start is None else start)[np.newaxis].copy()

    @abstractmethod
    def steps(
        self, integrator: Integrator, starts: Records, settings: SimulationSettings
    ) -> Records:
        """The step (1,), a record `integrator.step`: the body's own, or the user's where stable."""

    @property
    def basins(self) -> Records:
        """(1,), what the loops take of the basin, where there is one."""
        return np.zeros(1, BASIN) if self.basin is None else self.basin.record[np.newaxis]

    @property
    def spread(self) -> float:
        """The energy over M of both clouds about their means, uncorrelated."""
        return float(self.record["spread"])

    @property
    def least_energy(self) -> float | None:
        """V_p / M at the optimum; None where nothing is certified of it."""
        return None

    @property
    def slowest_rate(self) -> float | None:
        """Of decay, by the linearised dynamics; None where no one optimum is certified."""
        return None

    def energies(self, state: NDArray[Any]) -> Records:
        """The energies () over M at a state, by name; potential, V_p; others as in `kinetic`."""
        return named(self._evaluated("energies", state)[0], self.ENERGIES)

    def kinetic(self, energies: Records) -> NDArray[np.float64]:
        """V_k / M of records of energies."""
        return energies["translation"] + energies["rotation"]

    def speed(self, state: Records) -> float:
        """|s'|, the norm of the rates of change at a state, nine of them those of R."""
        return math.sqrt(self.squared_speed(state))

    def squared_speed(self, state: Records) -> float:
        """|s'|^2."""
        return float(self._evaluated("squared_speed", state)[0][0])

    def quaternion(self, state: Records) -> NDArray[np.float64]:
        """(4,), of a state."""
        return state["q"]

    def scales(self, states: Records) -> NDArray[np.float64] | None:
        """The scales of states, target over source; None of a body whose scale is 1."""
        del states

    def _evaluated(self, name: str, state: NDArray[Any]) -> tuple[NDArray[np.float64], ...]:
        full = f"{self.KIND.value}{name}"
        return self._engine().evaluate(full, self._taken(state), self.record)

    def _engine(self) -> Engine:
        return current_engine()

    def _taken(self, state: NDArray[Any]) -> NDArray[Any]:
        """A state as the generated functions take it."""
        return state


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ValleyBody(AnyBody):
    """A body of whose optimum nothing is certified: it rests in the valley that it comes to."""

    CELL: ClassVar[Cell]  # of the table of what is supported

    @abstractmethod
    def stiffest(self, start: Records) -> float:
        """The largest curvature of the energy beside the inertia, a proposal."""

    def steps(
        self, integrator: Integrator, starts: Records, settings: SimulationSettings
    ) -> Records:
        """The step (1,). Raises as `steps_of`."""
        return steps_of(integrator, (self,), starts, settings)

    def _engine(self) -> Engine:
        return compiled_engine()


def steps_of(
    integrator: Integrator,
    bodies: Sequence[ValleyBody],
    starts: Records,
    settings: SimulationSettings,
) -> Records:
    """The steps (count,), records `integrator.step`: the bodies' own, or the user's where stable.

    Raises InvalidProblemError for an integrator that does not move such bodies, MissingLibraryError
    where nothing is compiled.
    """
    for cell in {body.CELL for body in bodies}:
        require_supported(cell, Verb(integrator.value))
    compiled_engine()
    stiffest = [body.stiffest(start) for body, start in zip(bodies, starts, strict=True)]
    damping = np.array([body.damping for body in bodies])
    return own_steps(integrator, np.array(stiffest), damping, settings.step)


def exponent_of(dividend: int, divisor: int, places: int) -> int:
    """Of a power of two next to dividend / divisor 2^places: of the reduced fraction's lengths."""
    dividend, divisor = dividend << max(places, 0), divisor << max(-places, 0)
    common = math.gcd(dividend, divisor)
    return (dividend // common).bit_length() - (divisor // common).bit_length()


def require_rank(found: int) -> None:
    """Raises DegenerateProblemError where the source, of a scatter of this rank, is collinear."""
    if found < 2:
        raise DegenerateProblemError(
            "the source points are collinear: the rotational dynamics is not defined", rank=found
        )


def require_thick(inertia: list[float]) -> None:
    """Raises DegenerateProblemError unless the least eigenvalue is above SMALLEST_INERTIA."""
    if clearly_thick(inertia):
        return
    thinnest = float(np.linalg.eigvalsh(_full(inertia))[0])
    if not thinnest > SMALLEST_INERTIA:
        raise DegenerateProblemError(
            "the source is so nearly collinear, or so small beside the target, that its inertia is "
            "singular in double precision: the dynamics cannot be simulated",
            value=thinnest,
            limit=SMALLEST_INERTIA,
        )


def clearly_thick(inertia: list[float]) -> bool:
    """Whether the least eigenvalue is large at a glance; False says nothing.

    It is at least 4 det / trace^2, as the sum of the two others is below the trace, and the
    determinant is wrong by less than 1e-14 trace^3.
    """
    a, b, c, d, e, f = inertia
    determinant = a * (d * f - e * e) - b * (b * f - c * e) + c * (b * e - c * d)
    whole = a + d + f
    return 4.0 * determinant > CLEARLY_THICK * whole * whole * max(1.0, whole)


def _full(upper: list[float]) -> NDArray[np.float64]:
    a, b, c, d, e, f = upper
    return np.array([[a, b, c], [b, d, e], [c, e, f]])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Basin(Brief):
    """The certified basin of the optimum, per unit of mass, lengths over the body's unit.

    E = omega^T J omega / 2 - 2 q^T K q never rises along the exact flow, and at every spurious
    equilibrium E >= -2 l2. So a state with l1 - q^T K q + omega^T J omega / 4 < l1 - l2 has less
    energy than all of them, and by LaSalle's theorem ends at the optimum. The left side is a sum of
    squares, (l1 - lk) (q . q_k)^2, and so has no cancellation. Over l1 - l2 it bounds sin^2 of half
    the angle to the optimum, now and ever after. Proof: derivations, certified_basin.

    record: () of BASIN, what the trajectory loops take: the q_k as orthonormal rows, by descending
    eigenvalue, and their gaps l1 - lk over the mass, exact zeros on the optima.
    """

    record: Records

    @property
    def optimum(self) -> NDArray[np.float64]:
        """The unit quaternion (w, x, y, z) of an optimum, (4,)."""
        return self.record["quaternions"][0]

    @property
    def gaps(self) -> NDArray[np.float64]:
        """l1 - lk over the mass, (4,)."""
        return self.record["gaps"]

    @property
    def barrier(self) -> float:
        """The alignment l1 - l2 that separates the optimum from the rest: half of that in E."""
        return float(self.gaps[1])


def certified_basin(objective: Isotropic, length_exponent: int) -> Basin:
    """The basin that belongs to an objective, in the body's unit of length.

    Raises DegenerateProblemError where doubles do not tell the optima from the other poses.
    """
    optima, gaps = objective.classification.pattern[0], basin_gaps(objective, length_exponent)
    vectors = [entry for v in objective.eigenvectors for entry in unit_entries(v)]
    numbers = [*vectors, *[0.0] * optima, *gaps]
    return Basin(record=record_of(numbers, BASIN))


def basin_gaps(objective: Isotropic, length_exponent: int) -> list[float]:
    """l1 - lk over the mass, of the eigenvectors below the optima; raises as `certified_basin`."""
    moments, spaces = objective.moments, objective.eigenspaces
    optima = objective.classification.pattern[0]
    # One of a drop in units of the body: `eigenvalue_unit` / (total weight 4^length_exponent).
    exponents = moments.source_exponent + moments.target_exponent - 2 * length_exponent
    places = objective.shift - spaces.bits + exponents
    up, over = max(places, 0), moments.mass**2 << max(-places, 0)
    gaps = [(drop << up) / over for drop in objective.eigenvalue_drops[optima:]]
    if min(gaps, default=1.0) < SMALLEST_BARRIER:
        raise DegenerateProblemError(
            "not every pose is optimal, but by less than double precision can tell: the clouds "
            "differ so much in size, or are so nearly uncorrelated, that springs hardly turn the "
            "body; bring both clouds to one unit of length",
            value=min(gaps),
            limit=SMALLEST_BARRIER,
        )
    return gaps


def basins_of(
    vectors: NDArray[np.float64], values: NDArray[np.float64], unit: NDArray[np.float64]
) -> Records:
    """The basins (count,) of Davenport matrices: `values` times `unit` (count, 1), descending.

    vectors: (count, 4, 4), unit, row by row; values: (count, 4). Raises DegenerateProblemError
    where doubles do not tell the optima from the other poses.
    """
    differences = values[:, :1] - values
    differences[differences < TIE * differences[:, -1:]] = 0.0
    basins = np.empty(len(values), dtype=BASIN)
    basins["quaternions"], basins["gaps"] = vectors, differences * unit
    lost = ((differences > 0.0) & (basins["gaps"] < SMALLEST_BARRIER)).any(axis=1)
    if lost.any():
        instance = int(np.argmax(lost))
        where = f"the clouds of instance {instance}"
        raise DegenerateProblemError(
            f"{where} differ too much in size for double precision: bring both to one unit",
            instance=instance,
            limit=SMALLEST_BARRIER,
        )
    return basins
