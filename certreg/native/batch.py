"""Instances to be integrated, as plain arrays: what the loops take and give back."""

from __future__ import annotations

import enum
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.native.clouds import ManyClouds, RestPoses
    from certreg.settings import SimulationSettings

BODY, BASIN = 23, 20  # doubles of a body (generated/dynamics.h) and of a basin (native/loops.h)
ENERGIES = ("translation", "rotation", "potential", "alignment")  # per unit of mass


class Integrator(enum.Enum):
    """How the equations of motion are stepped; the value is the word used in commands."""

    EULER = "euler"  # explicit, R projected to the nearest rotation [Yang2020]
    MIDPOINT = "midpoint"  # implicit midpoint in quaternions: the energy never rises
    SPLITTING = "splitting"  # kick with exact damping, drift: a few large steps

    @property
    def state_size(self) -> int:
        """Doubles of a state: c, R or q, v, omega."""
        return 18 if self is Integrator.EULER else 13

    @property
    def step_size(self) -> int:
        """Doubles that describe a step: h, and for splitting exp(-mu h), (1 - exp(-mu h)) / mu."""
        return 3 if self is Integrator.SPLITTING else 1


class Ending(enum.IntEnum):
    """How an instance ended, as in native/loops.h."""

    OUT_OF_STEPS = 0
    CONVERGED = 1
    AT_REST = 2
    KICKED = 3  # never an ending: what a look at a slow state can also say


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Batch:
    """`count` instances of one integrator; `states`, and all below it, are written by the loops.

    bodies (count, 23); basins (count, 20): four orthonormal quaternions by descending eigenvalue
    and their deficits l1 - lk over the mass; steps (count, 1 or 3). states (count, 18 or 13): the
    start, then the end; taken, status, escapes (count,) integers; times (count,).
    """

    integrator: Integrator
    bodies: NDArray[np.float64]
    basins: NDArray[np.float64]
    steps: NDArray[np.float64]
    states: NDArray[np.float64]
    taken: NDArray[np.int64]
    status: NDArray[np.int32]
    escapes: NDArray[np.int32]
    times: NDArray[np.float64]

    @classmethod
    def of(
        cls,
        integrator: Integrator,
        *,
        bodies: NDArray[np.float64],
        basins: NDArray[np.float64],
        steps: NDArray[np.float64],
        states: NDArray[np.float64],
    ) -> Batch:
        """A batch from arrays of the right shapes, copied; raises ValueError for others."""
        count = len(bodies)
        shapes = {
            "bodies": (bodies, (count, BODY)),
            "basins": (basins, (count, BASIN)),
            "steps": (steps, (count, integrator.step_size)),
            "states": (states, (count, integrator.state_size)),
        }
        for name, (array, shape) in shapes.items():
            if array.shape != shape:
                raise ValueError(f"{name} has shape {array.shape}: expected {shape}")
        arrays = {
            name: np.array(array, dtype=float, order="C") for name, (array, _) in shapes.items()
        }
        return cls(
            integrator=integrator,
            taken=np.zeros(count, dtype=np.int64),
            status=np.zeros(count, dtype=np.int32),
            escapes=np.zeros(count, dtype=np.int32),
            times=np.zeros(count),
            **arrays,
        )

    def part(self, chosen: slice) -> Batch:
        """Some of the instances; what the loops write there, they write here."""
        return Batch(
            integrator=self.integrator, **{name: self._array(name)[chosen] for name in _ARRAYS}
        )

    def chosen(self, which: NDArray[np.bool_]) -> Batch:
        """A copy of some of the instances."""
        return Batch(
            integrator=self.integrator, **{name: self._array(name)[which] for name in _ARRAYS}
        )

    def put(self, which: NDArray[np.bool_], others: Batch) -> None:
        """Put others in the place of some of the instances."""
        for name in _ARRAYS:
            self._array(name)[which] = others._array(name)

    def _of_some(self, which: Any) -> Batch:
        arrays = {name: self._array(name)[which] for name in _ARRAYS}
        return Batch(integrator=self.integrator, **arrays)

    def _array(self, name: str) -> Any:
        return getattr(self, name)


_ARRAYS = tuple(field.name for field in fields(Batch))[1:]  # all but the integrator


@dataclass(slots=True)
class Log:
    """Samples of one trajectory: when it is full, every second goes and the stride doubles.

    rows (capacity, 1 + state + 4): time, state, energies; `count` of them are filled.
    """

    rows: NDArray[np.float64]
    count: int = 0
    stride: int = 1

    @classmethod
    def of_capacity(cls, capacity: int, integrator: Integrator) -> Log:
        """An empty log."""
        return cls(rows=np.empty((capacity, 1 + integrator.state_size + len(ENERGIES))))

    def clear(self) -> None:
        """Forget all samples."""
        self.count, self.stride = 0, 1

    @property
    def samples(self) -> NDArray[np.float64]:
        """The filled rows."""
        return self.rows[: self.count]


class Engine(Protocol):
    """What evaluates the generated functions and runs the loops."""

    @property
    def words(self) -> str:
        """What it is, for `certreg info`."""
        ...

    def evaluate(
        self, name: str, *arguments: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], ...]:
        """The results of one generated function (certreg/native/generated/dynamics.h), flat."""
        ...

    def run(self, batch: Batch, settings: SimulationSettings, log: Log | None = None) -> None:
        """Integrate every instance of a batch to its end; a log is for a single instance."""
        ...

    def rest_poses(self, clouds: ManyClouds) -> RestPoses:
        """What doubles say of the rest poses of many problems."""
        ...
