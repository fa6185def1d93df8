"""Sums of products over the points of two clouds, in one pass: compiled, or the same in NumPy.

Both add up blocks of 256 points, and the blocks with what rounding takes from each sum kept. With
deviations x, y from the origins as rounded doubles, u = 2^-53, and A the sum of the terms' absolute
values, every sum is within 260 u A of the exact one: 255 additions in any order [Higham2002, 4.2],
two roundings of a product of three, three of sums of blocks; what is left is of order N u^2.
A module of its own: it adds up, and `moments`, long enough, says of what and how well.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import cache
from itertools import chain
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.native.kernels import MissingLibraryError
from certreg.native.layout import MEANS, SUMS, Records, named, symmetric, width
from certreg.native.library import loaded_library

if TYPE_CHECKING:
    from numpy.typing import NDArray


BLOCK = 256  # points that are summed plainly
COMPILED_POINTS = 4096  # from here on in C: below, NumPy takes a millisecond at most
CHUNK_POINTS = 1 << 18  # of one call: a millisecond, and a few megabytes of copies
TAKEN = (np.dtype(np.float64), np.dtype(np.float32))  # types that the compiled pass reads


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CloudPair:
    """Two clouds in correspondence, as they stand in memory or in a mapped file.

    source, target: (N, 3), of any real type and strides. weights: (N,); None: all are one.
    origin: (6,), what is taken from the source's and the target's coordinates before all else.
    exponents: lengths of the source, of the target and weights are over these powers of two.
    """

    source: NDArray[Any]
    target: NDArray[Any]
    weights: NDArray[Any] | None
    origin: NDArray[np.float64]
    exponents: tuple[int, int, int] = (0, 0, 0)

    @property
    def origins(self) -> Records:
        """The origin as a () record MEANS: of the source, of the target."""
        return named(self.origin, MEANS)

    @property
    def n(self) -> int:
        """Number of points."""
        return len(self.source)

    def part(self, rows: slice) -> CloudPair:
        """Some of the points."""
        weights = None if self.weights is None else self.weights[rows]
        return CloudPair(
            source=self.source[rows],
            target=self.target[rows],
            weights=weights,
            origin=self.origin,
            exponents=self.exponents,
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FloatingSums:
    """Sums over the points, each times its weight, of deviations x, y from the origins.

    mass: of 1; source, target: (3,), of x and y; scatter: (3, 3), of x x^T; cross: (3, 3), of
    y x^T; spread: of y.y. `negative`: whether some weight has the sign of -1 (-0.0 has it, too).
    """

    mass: float
    source: NDArray[np.float64]
    target: NDArray[np.float64]
    scatter: NDArray[np.float64]
    cross: NDArray[np.float64]
    spread: float
    negative: bool = field(default=False)


_COLUMNS = (  # struct certreg_columns; three of them one behind the other are made in one go
    ("data", ctypes.c_void_p),
    ("row", ctypes.c_int64),
    ("column", ctypes.c_int64),
    ("single", ctypes.c_int),
)


class CloudPoints(ctypes.Structure):
    """struct certreg_points of native/sums.h."""

    _fields_ = (
        ("count", ctypes.c_int64),
        *(
            (f"{of}_{name}", kind)
            for of in ("source", "target", "weights")
            for name, kind in _COLUMNS
        ),
        ("origin", ctypes.c_double * 6),
    )


def floating_sums(clouds: CloudPair, *, threads: int = 1) -> FloatingSums:
    """The sums over all points; the same to the bit for every number of threads.

    Sums that no double holds are infinite or NaN, and so are those of numbers that are.
    """
    one_pass = _plain
    if clouds.n >= COMPILED_POINTS and clouds.exponents == (0, 0, 0):
        one_pass = compiled() or _plain
    starts = range(0, clouds.n, CHUNK_POINTS)

    def of_chunk(start: int) -> tuple[NDArray[np.float64], bool]:
        rows = slice(start, start + CHUNK_POINTS)
        return one_pass(clouds if len(starts) == 1 else clouds.part(rows))

    if threads == 1 or len(starts) == 1:
        sums = [of_chunk(start) for start in starts]
    else:
        with ThreadPoolExecutor(threads) as pool:
            sums = list(pool.map(of_chunk, starts))
    if len(sums) == 1:
        return _named(sums[0][0].sum(axis=1), sums[0][1])
    table = np.hstack([chunk for chunk, _ in sums])
    totals = np.array([total(row) for row in table])
    return _named(totals, any(negative for _, negative in sums))


def chunks(array: NDArray[Any]) -> Iterator[NDArray[np.float64]]:
    """Copies of the rows in doubles, as many at a time as one call takes."""
    for start in range(0, len(array), CHUNK_POINTS):
        yield array[start : start + CHUNK_POINTS].astype(np.float64)


def total(row: Iterable[float]) -> float:
    """The sum of some numbers, rounded once; NaN where it or one of them is beyond the doubles."""
    try:
        return math.fsum(row)
    except (OverflowError, ValueError):
        return math.nan


@cache
def compiled() -> Callable[[CloudPair], tuple[NDArray[np.float64], bool]] | None:
    """The pass in C; None where it is not compiled."""
    try:
        function = loaded_library().handle.certreg_sums
    except MissingLibraryError:
        return None
    function.restype = None

    def one_pass(clouds: CloudPair) -> tuple[NDArray[np.float64], bool]:
        kept = [_readable(array) for array in (clouds.source, clouds.target, clouds.weights)]
        sums, negative = np.empty((width(SUMS), 2)), ctypes.c_int()
        columns = chain.from_iterable(map(columns_of, kept))
        passed = CloudPoints(clouds.n, *columns, tuple(clouds.origin.tolist()))
        function(ctypes.byref(passed), ctypes.c_void_p(sums.ctypes.data), ctypes.byref(negative))
        return sums, bool(negative.value)

    return one_pass


def _readable(array: NDArray[Any] | None) -> NDArray[Any] | None:
    return array if array is None or array.dtype in TAKEN else array.astype(np.float64)


def columns_of(array: NDArray[Any] | None) -> tuple[int | None, int, int, bool]:
    """An array of a type in TAKEN as struct certreg_columns of native/sums.h."""
    if array is None:
        return None, 0, 0, False
    strides = array.strides
    if array.flags.carray and array.size:  # contiguous, and may be written: the fastest way
        memory: Any = array
        address = ctypes.addressof(ctypes.c_char.from_buffer(memory))
    else:
        address = array.__array_interface__["data"][0]  # faster than array.ctypes.data
    return address, strides[0], strides[-1], array.itemsize == 4


def _plain(clouds: CloudPair) -> tuple[NDArray[np.float64], bool]:
    """As the pass in C: block by block, and the blocks without rounding."""
    full = clouds.n // BLOCK * BLOCK
    blocks = [
        _blocks(clouds.part(slice(first, last)), size)
        for first, last, size in ((0, full, BLOCK), (full, clouds.n, clouds.n - full))
        if last > first
    ]
    sums = np.zeros((width(SUMS), 2))
    rows = [row for part in blocks for row in part.tolist()]
    sums[:, 0] = (
        rows[0] if len(rows) == 1 else [total(column) for column in zip(*rows, strict=True)]
    )
    negative = clouds.weights is not None and bool(np.signbit(clouds.weights).any())
    return sums, negative


def _blocks(clouds: CloudPair, size: int) -> NDArray[np.float64]:
    """The sums over each block, (blocks, 23)."""
    of_source, of_target, of_weights = clouds.exponents
    origins = clouds.origins
    w = np.ones(clouds.n) if clouds.weights is None else clouds.weights.astype(np.float64)
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        x = _deviations(clouds.source, origins["source"], of_source).reshape(-1, size, 3)
        y = _deviations(clouds.target, origins["target"], of_target).reshape(-1, size, 3)
        w = _scaled(w, of_weights).reshape(-1, size, 1)
        wx, wy = w * x, w * y
        scatter = wx.transpose(0, 2, 1) @ x
        cross = wy.transpose(0, 2, 1) @ x
        upper = scatter[:, (0, 0, 0, 1, 1, 2), (0, 1, 2, 1, 2, 2)]
        parts = (w.sum(axis=1), (wy * y).sum(axis=1).sum(axis=1, keepdims=True))
        parts += (wx.sum(axis=1), wy.sum(axis=1), upper, cross.reshape(-1, 9))
        return np.hstack(parts)


def _deviations(
    points: NDArray[Any], origin: NDArray[np.float64], exponent: int
) -> NDArray[np.float64]:
    """(points - origin) / 2^exponent, rounded once and without overflow."""
    doubles = points.astype(np.float64, order="C")
    if exponent > 0:
        return _scaled(doubles, exponent) - _scaled(origin, exponent)
    return _scaled(doubles - origin, exponent)


def _scaled(values: NDArray[np.float64], exponent: int) -> NDArray[np.float64]:
    return values if exponent == 0 else np.ldexp(values, -exponent)


def _named(totals: NDArray[np.float64], negative: bool) -> FloatingSums:  # noqa: FBT001 - beside its sums
    sums = named(totals, SUMS)
    return FloatingSums(
        mass=float(sums["mass"]),
        spread=float(sums["spread"]),
        source=sums["source"],
        target=sums["target"],
        scatter=symmetric(sums["scatter"]),
        cross=sums["cross"],
        negative=negative,
    )
