"""What the trajectory loops take and give back: bodies to be integrated, and when a run ends.

The numbers that no caller changes stand here with their reasons; both engines get them from here.
"""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, Never, Protocol

import numpy as np

from certreg.errors import InvalidProblemError
from certreg.native.layout import (
    BASIN,
    BODY,
    BREATHING_STATE,
    MATRIX_SAMPLE,
    MATRIX_STATE,
    QUATERNION_SAMPLE,
    QUATERNION_STATE,
    SPLITTING_STEP,
    SPRING_BODY,
    STEP,
    Records,
    RecordType,
    width,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray


BASIN_SHARE = 0.4  # of the barrier: below the 1/2 that the certificate's mu proves
STALLED_TORQUE = 0.05  # of the curvature: above, a body is off the saddle, only slow
PERTURBATION_GROWTH = 10.0  # slow saddles need larger ones
LARGEST_PERTURBATION = 1.0  # radians
NEWTON_TOLERANCE = 1e-12  # radians of a midpoint step's turn; then on while it falls
NEWTON_STEPS = 20  # before a midpoint step is halved; five are usual
LARGEST_TURN = 2.0  # radians of a midpoint step: beyond, it is halved
HALVINGS = 60  # of a midpoint step: from h = 1 down to rounding


class Integrator(enum.StrEnum):
    """How the equations of motion are stepped; the value is the word used in commands."""

    EULER = "euler"  # explicit, R projected to the nearest rotation [Yang2020]
    MIDPOINT = "midpoint"  # implicit midpoint in quaternions: the energy never rises
    SPLITTING = "splitting"  # kick with exact damping, drift: a few large steps

    @classmethod
    def _missing_(cls, value: object) -> Never:
        known = ", ".join(repr(one.value) for one in cls)
        raise InvalidProblemError(
            f"integrator is {value!r}: give {known}", array="integrator", value=value
        )

    @property
    def state(self) -> RecordType:
        """The record of a state: c, R or q, v, omega."""
        return MATRIX_STATE if self is Integrator.EULER else QUATERNION_STATE

    @property
    def step(self) -> RecordType:
        """The record of a step: h, and for splitting exp(-mu h), (1 - exp(-mu h)) / mu."""
        return SPLITTING_STEP if self is Integrator.SPLITTING else STEP

    @property
    def sample(self) -> RecordType:
        """The record of a logged state: time, state, energies."""
        return MATRIX_SAMPLE if self is Integrator.EULER else QUATERNION_SAMPLE


class Ending(enum.IntEnum):
    """How a run ended, as in native/loops.h."""

    OUT_OF_STEPS = 0
    CONVERGED = 1
    AT_REST = 2
    PERTURBED = 3  # never an ending: what a look at a slow state can also say
    COLLAPSED = 4  # where the scale is a state: it falls to 0; said by no loop in C


class Kind(enum.StrEnum):
    """Which generated functions move a body; the value is what their names begin with."""

    RIGID = "certreg_"
    SPRINGS = "certreg_spring_"
    BREATHING = "certreg_breathing_"


@dataclass(frozen=True, slots=True, kw_only=True)
class Rules:
    """When a run ends, and how it leaves a saddle.

    speed_tolerance: of the norm of the 18 rates of change. rest_share: height above the optimum,
    over the barrier, below which a body may stop. first_perturbation: radians, off a saddle.
    threads: for many bodies.
    """

    speed_tolerance: float
    rest_share: float
    first_perturbation: float
    max_steps: int
    threads: int = 1


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Batch:
    """`count` bodies under one integrator; `states`, and all below it, are written by the loops.

    bodies, basins, steps, states: (count,) records BODY, BASIN, `integrator.step` and
    `integrator.state` of `certreg.native.layout`; states are the start, then the end. taken,
    status, escapes: (count,) integers; times: (count,).
    """

    integrator: Integrator
    bodies: Records
    basins: Records
    steps: Records
    states: Records
    taken: NDArray[np.int64]
    status: NDArray[np.int32]
    escapes: NDArray[np.int64]
    times: NDArray[np.float64]

    @property
    def kind(self) -> Kind:
        """Of its bodies: their records, and those of their states, have sizes of their own."""
        if self.bodies.itemsize == SPRING_BODY.itemsize:
            return Kind.SPRINGS
        breathing = self.states.itemsize == BREATHING_STATE.itemsize
        return Kind.BREATHING if breathing else Kind.RIGID

    @classmethod
    def of(
        cls,
        integrator: Integrator,
        *,
        bodies: Records,
        steps: Records,
        states: Records,
        basins: Records | None = None,
    ) -> Batch:
        """A batch from records of the right types, copied; raises ValueError for others.

        basins: None of bodies on general springs, which have none.
        """
        count = len(bodies)
        given = {
            "bodies": (bodies, SPRING_BODY if basins is None else BODY),
            "basins": (np.empty(count, dtype=BASIN) if basins is None else basins, BASIN),
            "steps": (steps, integrator.step),
            "states": (states, integrator.state),
        }
        return cls(
            integrator=integrator,
            taken=np.zeros(count, dtype=np.int64),
            status=np.zeros(count, dtype=np.int32),
            escapes=np.zeros(count, dtype=np.int64),
            times=np.zeros(count),
            **_copied(count, given),
        )

    @classmethod
    def single(
        cls,
        integrator: Integrator,
        *,
        bodies: Records,
        basins: Records,
        steps: Records,
        start: Records,
    ) -> Batch:
        """A batch of one, not copied: records (1,)."""
        return cls(
            integrator=integrator,
            bodies=bodies,
            basins=basins,
            steps=steps,
            states=start,
            taken=np.zeros(1, dtype=np.int64),
            status=np.zeros(1, dtype=np.int32),
            escapes=np.zeros(1, dtype=np.int64),
            times=np.zeros(1),
        )

    def part(self, which: slice | NDArray[np.bool_]) -> Batch:
        """Some of the bodies; by a slice what the loops write there is written here, too."""
        arrays = {name: getattr(self, name)[which] for name in _ARRAYS}
        return Batch(integrator=self.integrator, **arrays)

    def put(self, which: NDArray[np.bool_], others: Batch) -> None:
        """Put others in the place of some of the bodies."""
        for name in _ARRAYS:
            getattr(self, name)[which] = getattr(others, name)


def _copied(count: int, given: Mapping[str, tuple[Records, RecordType]]) -> dict[str, Records]:
    """Copies of records by name, each beside its type; raises ValueError for others."""
    for name, (records, expected) in given.items():
        if records.shape != (count,) or records.dtype != expected:
            raise ValueError(f"{name} are {records.shape} of {records.dtype}: expected {expected}")
    return {name: records.copy() for name, (records, _) in given.items()}


_ARRAYS = tuple(field.name for field in fields(Batch) if field.name != "integrator")


@dataclass(slots=True)
class Log:
    """Samples of one trajectory: when it is full, every second goes and the stride doubles.

    rows: (capacity, k), the doubles of records `sample` of time, state and energies; `count` of
    them are filled.
    """

    rows: NDArray[np.float64]
    sample: RecordType
    count: int = 0
    stride: int = 1

    @classmethod
    def of_capacity(cls, capacity: int, sample: RecordType) -> Log:
        """An empty log of records of this type."""
        return cls(np.empty((capacity, width(sample))), sample)

    def clear(self) -> None:
        """Forget all samples."""
        self.count, self.stride = 0, 1

    @property
    def samples(self) -> Records:
        """A copy of the filled rows."""
        return np.frombuffer(bytearray(self.rows[: self.count]), self.sample)


class Engine(Protocol):
    """What evaluates the generated functions and runs the loops."""

    @property
    def words(self) -> str:
        """What it is, for `certreg info`."""
        ...

    def evaluate(self, name: str, *arguments: NDArray[Any]) -> tuple[NDArray[np.float64], ...]:
        """The results of one generated function (certreg/native/generated/dynamics.h), flat.

        arguments: records, or their doubles.
        """
        ...

    def run(self, batch: Batch, rules: Rules, log: Log | None = None) -> None:
        """Integrate every body of a batch to its end; a log is for a single body."""
        ...
