"""The compiled library, called without conversions; the interpreter's lock is free meanwhile."""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.native.kernels import MissingLibraryError, chosen_library
from certreg.native.layout import plain
from certreg.native.loops import (
    BASIN_SHARE,
    HALVINGS,
    LARGEST_PERTURBATION,
    LARGEST_TURN,
    NEWTON_STEPS,
    NEWTON_TOLERANCE,
    PERTURBATION_GROWTH,
    STALLED_TORQUE,
    Batch,
    Integrator,
    Kind,
    Log,
    Rules,
)
from certreg.native.runs import run_in_python
from certreg.native.signatures import Signature, generated, opened
from certreg.native.stationary import ManyClouds, StationaryPoses

if TYPE_CHECKING:
    from numpy.typing import NDArray


WRONG_PAIRS, MANY = "the search for wrong pairs", "solving or moving many problems at once"
SCRATCH = 56  # doubles per point: CERTREG_SCRATCH of native/stationary.h
PORTION = 512  # bodies that one call takes: Ctrl-C is answered within milliseconds
_POINTER = ctypes.c_void_p
_address, _first = ctypes.addressof, ctypes.c_char.from_buffer
_Ratios = ctypes.c_double * 3


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ProvedOptima:
    """What is proved of each problem; where it is not, and `proved` is False, nothing stands.

    quaternions: (count, 4) integers (w, x, y, z), of the rotation that is optimal.
    mu, delta, sine: (count, 2), mantissas of 32 bits and exponents, as in a certificate; sine is of
        sin^2 of half the angle to the optimum. K has four eigenvalues there.
    poses: (count, 4, 4), that rotation and its best translation in doubles.
    """

    quaternions: NDArray[np.int64]
    mu: NDArray[np.int64]
    delta: NDArray[np.int64]
    sine: NDArray[np.int64]
    poses: NDArray[np.float64]
    proved: NDArray[np.bool_]

    @classmethod
    def none(cls, count: int) -> ProvedOptima:
        """Nothing is proved yet of so many problems."""
        return cls(
            quaternions=np.zeros((count, 4), dtype=np.int64),
            mu=np.zeros((count, 2), dtype=np.int64),
            delta=np.zeros((count, 2), dtype=np.int64),
            sine=np.zeros((count, 2), dtype=np.int64),
            poses=np.zeros((count, 4, 4)),
            proved=np.zeros(count, dtype=np.bool_),
        )


class _Settings(ctypes.Structure):
    _fields_ = (
        ("squared_tolerance", ctypes.c_double),
        ("basin_share", ctypes.c_double),
        ("rest_share", ctypes.c_double),
        ("stalled_torque", ctypes.c_double),
        ("first_perturbation", ctypes.c_double),
        ("perturbation_growth", ctypes.c_double),
        ("largest_perturbation", ctypes.c_double),
        ("newton_tolerance", ctypes.c_double),
        ("largest_turn", ctypes.c_double),
        ("newton_steps", ctypes.c_int64),
        ("halvings", ctypes.c_int64),
        ("max_steps", ctypes.c_int64),
    )


class _Log(ctypes.Structure):
    _fields_ = (
        ("rows", _POINTER),
        ("capacity", ctypes.c_int64),
        ("count", ctypes.c_int64),
        ("stride", ctypes.c_int64),
    )


class _Batch(ctypes.Structure):
    """The first parts are addresses, or for one body bytes: then no address is asked for."""

    _fields_ = (
        ("count", ctypes.c_int64),
        *((name, ctypes.c_char_p) for name in ("bodies", "basins", "steps")),
        *((name, _POINTER) for name in ("states", "taken", "status", "escapes", "times")),
        ("log", ctypes.POINTER(_Log)),
    )


class _Clouds(ctypes.Structure):
    _fields_ = (
        ("count", ctypes.c_int64),
        ("points", ctypes.c_int64),
        *((name, _POINTER) for name in ("sources", "targets", "weights")),
        *((f"{name}_step", ctypes.c_int64) for name in ("source", "target", "weight")),
        ("scratch", _POINTER),
        *((field.name, _POINTER) for field in fields(StationaryPoses)),
    )


class _Pairs(ctypes.Structure):
    _fields_ = (
        ("count", ctypes.c_int64),
        *((name, _POINTER) for name in ("source", "target", "weights", "sizes", "starts")),
        *((field.name, _POINTER) for field in fields(ProvedOptima)),
    )


@dataclass(frozen=True, slots=True)
class Library:
    """The generated functions and the loops, compiled."""

    handle: Any
    words: str  # what it is, for `certreg info`
    shapes: dict[str, Signature]

    def evaluate(self, name: str, *arguments: NDArray[Any]) -> tuple[NDArray[np.float64], ...]:
        """The results of one generated function, flat. Raises ValueError for other sizes."""
        shape = self.shapes[name]
        given = checked(name, shape, arguments)
        results = tuple(np.empty(size) for size in shape.results)
        pointers = [_POINTER(array.ctypes.data) for array in (*given, *results)]
        getattr(self.handle, name)(*pointers)
        return results

    @property
    def multiplies_digits(self) -> bool:
        """Whether this processor multiplies eight pairs of 52 bits at once."""
        return bool(self.handle.certreg_fixed_vectors())

    def prove_optima(
        self,
        clouds: tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]],
        sizes: NDArray[np.int64],
        starts: NDArray[np.int64],
    ) -> ProvedOptima:
        """What is proved of the optima of many problems; rows of clouds as in `ManyPairs`.

        Raises ValueError where a problem has rows that are not there.
        """
        arrays = [np.ascontiguousarray(array, dtype=float) for array in clouds]
        sizes, starts = (np.ascontiguousarray(array, dtype=np.int64) for array in (sizes, starts))
        rows = [array.size // per_row for array, per_row in zip(arrays, (3, 3, 1), strict=True)]
        inside = starts.shape == (len(sizes), 3) and (starts >= 0).all() and (sizes >= 1).all()
        if not (inside and (starts <= np.array(rows) - sizes[:, np.newaxis]).all()):
            raise ValueError("a problem has rows that are not there")
        proved = ProvedOptima.none(len(sizes))
        passed = _Pairs(
            len(sizes),
            *[array.ctypes.data for array in (*arrays, sizes, starts)],
            *[getattr(proved, field.name).ctypes.data for field in fields(proved)],
        )
        self.handle.certreg_prove_optima(ctypes.byref(passed))
        return proved

    def stationary_poses(self, clouds: ManyClouds) -> StationaryPoses:
        """What doubles say of the stationary poses of many problems."""
        given = (clouds.sources, clouds.targets, clouds.weights)
        arrays = [np.ascontiguousarray(array, dtype=float) for array in given]
        points = clouds.weights.shape[1]
        scratch, poses = np.empty(SCRATCH * points), StationaryPoses.empty(clouds.count)
        passed = _Clouds(
            clouds.count,
            points,
            *[array.ctypes.data for array in arrays],
            *[0 if len(array) == 1 else array[0].size for array in arrays],
            scratch.ctypes.data,
            *[getattr(poses, field.name).ctypes.data for field in fields(poses)],
        )
        self.handle.certreg_stationary_poses(ctypes.byref(passed))
        return poses

    def spring_ratios(self, q: bytes, cross: bytes, inertia: bytes) -> list[float]:
        """The eigenvalues of the pencil (G, J) of one body, ascending; see native/pencil.h.

        Of doubles, 4, 9 and 6. Raises ValueError where rounding leaves J without a root.
        """
        ratios = _Ratios()
        if not self.handle.certreg_pencil(q, cross, inertia, ratios):
            raise ValueError("the inertia is not positive definite in double precision")
        return list(ratios)

    def run(self, batch: Batch, rules: Rules, log: Log | None = None) -> None:
        """Integrate every body; several run on all given threads, a log is for one body."""
        RUNS[batch.kind](self, batch, rules, log)

    def run_compiled(self, batch: Batch, rules: Rules, log: Log | None = None) -> None:
        """The same by loops in C."""
        kind, count = batch.kind, len(batch.bodies)
        if log is not None or count == 1:
            self._run(kind, batch, rules, log)
            return
        portion = min(PORTION, -(-count // rules.threads))
        parts = [batch.part(slice(k, k + portion)) for k in range(0, count, portion)]
        with ThreadPoolExecutor(rules.threads) as pool:
            for done in [pool.submit(self._run, kind, part, rules, None) for part in parts]:
                done.result()

    def _run(self, kind: Kind, batch: Batch, rules: Rules, log: Log | None) -> None:
        single = len(batch.bodies) == 1 or batch.integrator is Integrator.MIDPOINT
        loop = f"{batch.integrator.value}_{'single' if single else 'lanes'}"
        record = None
        if log is not None:
            (rows,) = _addresses((log.rows,))
            record = _Log(rows, len(log.rows), log.count, log.stride)
        count, given = len(batch.bodies), (batch.bodies, batch.basins, batch.steps)
        written = (batch.states, batch.taken, batch.status, batch.escapes, batch.times)
        logged = None if record is None else ctypes.pointer(record)
        parts = [part.tobytes() for part in given] if count == 1 else _addresses(given)
        passed = _Batch(count, *parts, *_addresses(written), logged)
        call = getattr(self.handle, f"{kind.value}{loop}")
        call(ctypes.byref(passed), ctypes.byref(_settings(rules)))
        if log is not None and record is not None:
            log.count, log.stride = record.count, record.stride


def checked(
    name: str, shape: Signature, arguments: tuple[NDArray[Any], ...]
) -> list[NDArray[np.float64]]:
    """The arguments as contiguous doubles; raises ValueError where one has another size."""
    numbers = [array if array.dtype.names is None else plain(array) for array in arguments]
    given = [np.ascontiguousarray(array, dtype=float).ravel() for array in numbers]
    sizes = tuple(array.size for array in given)
    if sizes != shape.arguments:
        raise ValueError(f"{name} takes {shape.arguments} numbers, not {sizes}")
    return given


RUNS: Mapping[Kind, Callable[[Library, Batch, Rules, Log | None], None]] = {
    Kind.RIGID: Library.run_compiled,
    Kind.SPRINGS: Library.run_compiled,
    Kind.BREATHING: run_in_python,  # of which C has the functions alone
}


def _addresses(arrays: Iterable[Any]) -> list[int]:
    """Of contiguous, writable arrays that are not empty; `array.ctypes` takes thrice as long."""
    return [_address(_first(array)) for array in arrays]


@lru_cache(maxsize=16)
def _settings(rules: Rules) -> _Settings:
    return _Settings(
        rules.speed_tolerance**2,
        BASIN_SHARE,
        rules.rest_share,
        STALLED_TORQUE,
        rules.first_perturbation,
        PERTURBATION_GROWTH,
        LARGEST_PERTURBATION,
        NEWTON_TOLERANCE,
        LARGEST_TURN,
        NEWTON_STEPS,
        HALVINGS,
        rules.max_steps,
    )


@cache
def loaded_library() -> Library:
    """The compiled library of this process. Raises MissingLibraryError where there is none."""
    path, variant = chosen_library()
    return Library(opened(path), f"compiled with the package ({variant})", generated())


@cache
def library_if_any() -> Library | None:
    """The compiled library of this process; None where there is none."""
    try:
        return loaded_library()
    except MissingLibraryError:
        return None


@cache
def little_library() -> Library | None:
    """That, for rows of bits and long integers; None where the processor keeps bytes otherwise."""
    return library_if_any() if sys.byteorder == "little" else None


def library_for(task: str) -> Library:
    """The compiled library. Raises MissingLibraryError, which says what needs it."""
    try:
        return loaded_library()
    except MissingLibraryError as error:
        raise MissingLibraryError(f"{task} needs the compiled library: {error}") from error


def little_library_for(task: str) -> Library:
    """That, for rows of bits and long integers. Raises MissingLibraryError as `library_for`."""
    library = library_for(task)
    if little_library() is None:
        raise MissingLibraryError(f"{task} needs a processor that keeps the low byte first")
    return library
