"""The registration problem: points, weights, damping; exact lift and digest.

Floating point becomes exact here and nowhere else: every finite double is a dyadic rational, so a
problem stated in doubles is an exact rational problem.
"""

from __future__ import annotations

import copy
import hashlib
import math
import operator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.errors import InvalidProblemError
from certreg.exact import weight_of_sigma
from certreg.problem.arrays import (
    cloud_array,
    finite_doubles,
    mapped_file,
    real_numbers,
    row_blocks,
)
from certreg.problem.row_labels import require_same_labels
from certreg.results import Brief

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import ArrayLike, NDArray

CHANGED = "the file of a mapped array was changed while it was read: state the problem anew"
DIGEST_PREFIX = b"certreg-problem/1\0"
MANTISSA_BITS = 53
FEW = 32  # numbers that are lifted faster one by one than by twenty calls of NumPy
DEFAULT_DAMPING = math.sqrt(8.0)  # critical damping of every mode of noise-free data: 2 sqrt(2)
MIN_DAMPING, MAX_DAMPING = 1e-150, 1e150  # their squares, in the spectrum, are doubles


@dataclass(frozen=True, slots=True, eq=False, init=False)
class RegistrationProblem(Brief):
    """Find the rigid motion that takes `source` to `target`, row i to row i.

    The arrays are copied and read-only. Only those that are mapped from a file for reading
    (`numpy.load(file, mmap_mode="r")`) stay in the file, of whatever type, and are read block by
    block whenever they are needed, so that a cloud may be larger than the memory. Nobody may
    change the file meanwhile. Where it happens all the same, the certificate is refused, or holds
    for the points that its digest names.

    Parameters
    ----------
    source, target
        (N, 3) arrays of numbers, N >= 1, in one unit of length, of any library that NumPy reads; or
        any object with `.points` (Open3D), `.vertices` (trimesh) or `.xyz` (laspy); or data frames.
        Those with labels must have the same in the same order: `certreg.pair` brings them into one.
    sigma
        Standard deviation of the noise per coordinate, a scalar or (N,), > 0, same unit; the weight
        is the double nearest to 1/sigma^2.
    weights
        Instead of sigma, (N,) or a scalar, >= 0, not all zero.
    damping
        Viscous damping per mass, mu > 0, per time unit of the virtual springs; where none is given
        sqrt(8), but `certify` takes the one of the fastest decay.

    Raises
    ------
    InvalidProblemError
        For what states no problem: array, row and remedy.

    Examples
    --------
    >>> RegistrationProblem([[0, 0, 0], [1, 0, 0], [0, 2, 0]], [[0, 0, 0], [1, 0, 0], [0, 2, 0]]).n
    3
    """

    source: NDArray[np.float64]
    target: NDArray[np.float64]
    weights: NDArray[np.float64]
    damping: float
    noise_given: bool  # whether sigma was given: weights alone may be relative
    damping_given: bool
    _digest: list[str]  # once it was asked for; of arrays in memory, which nobody changes

    def __init__(
        self,
        source: Any,
        target: Any,
        *,
        sigma: ArrayLike | None = None,
        weights: ArrayLike | None = None,
        damping: float | None = None,
    ) -> None:
        if sigma is not None and weights is not None:
            message = "both sigma and weights were given: give one (weights = 1/sigma^2)"
            raise InvalidProblemError(message, array="weights")
        source_points = finite_doubles(cloud_array(source, "source"), "source")
        target_points = finite_doubles(cloud_array(target, "target"), "target")
        n = len(source_points)
        if n != len(target_points):
            message = (
                f"source has {n} points, target has {len(target_points)}: correspondences pair "
                "row i with row i, so both need the same number"
            )
            raise InvalidProblemError(message, array="target", value=len(target_points), limit=n)
        require_same_labels(source, target=target, sigma=sigma, weights=weights)
        masses = _weights_from_sigma(sigma, n) if sigma is not None else _given_weights(weights, n)
        for name, value in (
            ("source", source_points),
            ("target", target_points),
            ("weights", masses),
        ):
            read_only = value.view()
            read_only.flags.writeable = False
            object.__setattr__(self, name, read_only)
        chosen = DEFAULT_DAMPING if damping is None else damping
        object.__setattr__(self, "damping", checked_damping(chosen))
        object.__setattr__(self, "damping_given", damping is not None)
        object.__setattr__(self, "noise_given", sigma is not None)
        object.__setattr__(self, "_digest", [])

    def __repr__(self) -> str:
        noise = ", sigma given" if self.noise_given else ""
        return f"<RegistrationProblem: n={self.n}{noise}>"

    def damped(self, damping: float) -> RegistrationProblem:
        """The same problem with another damping.

        Parameters
        ----------
        damping
            mu > 0.

        Returns
        -------
        RegistrationProblem
            Of the same arrays.

        Raises
        ------
        InvalidProblemError
            For others.
        """
        other = copy.copy(self)
        object.__setattr__(other, "damping", checked_damping(damping))
        object.__setattr__(other, "damping_given", True)
        return other

    @property
    def n(self) -> int:
        """Number of correspondences."""
        return len(self.source)

    @property
    def mapped(self) -> bool:
        """Whether a part of the problem stays in a file, which somebody else could change."""
        arrays = (self.source, self.target, self.weights)
        return any(mapped_file(array) is not None for array in arrays)

    @property
    def equally_weighted(self) -> bool:
        """Whether all weights are the same."""
        one = self.weights[0]
        blocks = (contiguous(self.weights, rows) for rows in row_blocks(self.n))
        return all((block == one).all() for block in blocks)

    def block(self, rows: slice) -> Block:
        """Some of the points in doubles, contiguous.

        Parameters
        ----------
        rows
            Of the points.

        Returns
        -------
        Block
            Source, target and weights of these rows.

        Raises
        ------
        InvalidProblemError
            Where a file holds no proper points any more.
        """
        weights = contiguous(self.weights, rows, "weights")
        if not (weights >= 0).all():
            row = rows.start + int(np.argmin(weights >= 0))
            raise InvalidProblemError(CHANGED, array="weights", row=row, limit=0.0)
        return Block(
            source=contiguous(self.source, rows, "source"),
            target=contiguous(self.target, rows, "target"),
            weights=weights,
        )

    def data_bytes(self) -> bytes:
        """The bytes that state the problem: prefix, n (u64), then all doubles, little-endian."""
        return b"".join(self._pieces())

    def digest(self) -> str:
        """SHA-256 of `data_bytes()`, 64 hexadecimal digits: the identity of the problem."""
        if self._digest:
            return self._digest[0]
        digest = hashlib.sha256()
        for piece in self._pieces():
            digest.update(piece)
        if not self.mapped:
            self._digest.append(digest.hexdigest())
        return digest.hexdigest()

    def _pieces(self) -> Iterator[bytes | memoryview]:
        """What `data_bytes` holds, piece by piece."""
        yield DIGEST_PREFIX + self.n.to_bytes(8, "little")
        for name in ("source", "target", "weights"):
            array = getattr(self, name)
            for rows in row_blocks(len(array)):
                yield contiguous(array, rows, name).astype("<f8", copy=False).data


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Block(Brief):
    """Some of the points of a problem: source (k, 3), target (k, 3), weights (k,), contiguous."""

    source: NDArray[np.float64]
    target: NDArray[np.float64]
    weights: NDArray[np.float64]

    def part(self, rows: slice) -> Block:
        """Some of these points."""
        return Block(source=self.source[rows], target=self.target[rows], weights=self.weights[rows])


def contiguous(
    array: NDArray[np.float64], rows: slice, name: str | None = None
) -> NDArray[np.float64]:
    """Rows of an array of a problem as contiguous doubles, -0.0 as 0.0; `name` is for errors.

    A copy where the array is mapped from a file. Raises InvalidProblemError where the file holds a
    number that is not finite: it did not, once.
    """
    if mapped_file(array) is None:
        return np.ascontiguousarray(array[rows])
    copied = array[rows].astype(np.float64, order="C")
    copied += 0.0  # -0.0 + 0.0 is 0.0: one point, one digest
    finite = np.isfinite(copied)
    if not finite.all():
        row = rows.start + int(np.argwhere(~finite)[0][0])
        raise InvalidProblemError(
            CHANGED, array=name, row=row, value=copied[row - rows.start].tolist()
        )
    return copied


@dataclass(frozen=True, slots=True, kw_only=True)
class Lifted:
    """Doubles as exact numbers: entry i is `integers[i] * 2**exponent`."""

    integers: list[int]
    exponent: int


def lift(values: NDArray[np.float64]) -> Lifted:
    """The exact values of finite doubles (flat), over one common power of two."""
    if len(values) <= FEW:
        return _lifted(values.tolist())
    mantissas, exponents = np.frexp(values)
    integers = np.ldexp(mantissas, MANTISSA_BITS).astype(np.int64)
    exponents = exponents.astype(np.int64) - MANTISSA_BITS
    present = integers != 0
    if not present.any():
        return Lifted(integers=[0] * len(integers), exponent=0)
    lowest_bit = np.where(present, integers & -integers, 1)
    zeros = np.frexp(lowest_bit.astype(np.float64))[1].astype(np.int64) - 1
    integers >>= zeros
    exponents += zeros
    common = int(exponents[present].min())
    shifts = np.where(present, exponents - common, 0)
    if int((MANTISSA_BITS - zeros + shifts).max()) <= 63:  # bits of the longest, without its sign
        return Lifted(integers=(integers << shifts).tolist(), exponent=common)
    pairs = zip(integers.tolist(), shifts.tolist(), strict=True)
    return Lifted(integers=[m << s for m, s in pairs], exponent=common)


def _lifted(values: list[float]) -> Lifted:
    """The same, one by one."""
    ratios = [value.as_integer_ratio() for value in values]
    over = max((below for _, below in ratios), default=1)
    integers = [above * (over // below) for above, below in ratios]
    bits = 0
    for k in integers:
        bits |= k
    if not bits:
        return Lifted(integers=integers, exponent=0)
    spare = (bits & -bits).bit_length() - 1
    return Lifted(integers=[k >> spare for k in integers], exponent=spare + 1 - over.bit_length())


def checked_damping(damping: Any) -> float:
    """A damping mu > 0 as a double; raises InvalidProblemError for anything else."""
    try:
        value = float(damping)
    except (TypeError, ValueError, OverflowError):
        value = math.nan
    if isinstance(damping, str) or not MIN_DAMPING <= value <= MAX_DAMPING:
        message = f"damping is {damping!r}: it must be a positive finite number, 1e-150 to 1e150"
        limit = (MIN_DAMPING, MAX_DAMPING)
        raise InvalidProblemError(message, array="damping", value=damping, limit=limit)
    return value


def checked_threads(threads: Any) -> int:
    """A number of threads, 1 or more; raises InvalidProblemError for anything else."""
    try:
        count = operator.index(threads)
    except TypeError:
        count = 0
    if isinstance(threads, bool) or count < 1:
        message = f"threads is {threads!r}: it must be a whole number, 1 or more"
        raise InvalidProblemError(message, array="threads", value=threads, limit=1)
    return count


def _per_point(values: ArrayLike, name: str, n: int) -> NDArray[np.float64]:
    """(n,) finite doubles, or (1,) that stands for all."""
    array = real_numbers(values, name)
    if array.ndim == 0:
        return finite_doubles(array.reshape(1), name)
    if array.shape != (n,):
        message = f"{name} has shape {array.shape}: expected one number, or ({n},), one per point"
        raise InvalidProblemError(message, array=name, value=array.shape, limit=(n,))
    return finite_doubles(array, name)


def first_row(
    array: NDArray[np.float64], wrong: Callable[[NDArray[np.float64]], NDArray[np.bool_]]
) -> int | None:
    """The first row where something is wrong, None if nowhere."""
    for rows in row_blocks(len(array)):
        faults = wrong(contiguous(array, rows))
        if faults.any():
            return rows.start + int(np.argmax(faults))
    return None


def _given_weights(weights: ArrayLike | None, n: int) -> NDArray[np.float64]:
    """(n,) weights >= 0, not all zero; equal ones take the place of one."""
    array = np.ones(1) if weights is None else _per_point(weights, "weights", n)
    row = first_row(array, lambda block: block < 0)
    if row is not None:
        message = f"weights[{row}] is {array[row]}: weights must be >= 0"
        value = float(array[row])
        raise InvalidProblemError(message, array="weights", row=row, value=value, limit=0.0)
    if first_row(array, lambda block: block > 0) is None:
        message = "all weights are zero: no correspondence counts, so every pose is as good"
        raise InvalidProblemError(message, array="weights", value=0.0)
    return np.broadcast_to(array, (n,))


def _weights_from_sigma(sigma: ArrayLike, n: int) -> NDArray[np.float64]:
    """(n,) weights in memory, even if the sigmas are mapped; equal ones take the place of one."""
    array = _per_point(sigma, "sigma", n)
    row = first_row(array, lambda block: block <= 0)
    if row is not None:
        place = "sigma" if np.ndim(sigma) == 0 else f"sigma[{row}]"
        message = f"{place} is {array[row]}: a standard deviation must be > 0"
        named = None if np.ndim(sigma) == 0 else row
        value = float(array[row])
        raise InvalidProblemError(message, array="sigma", row=named, value=value, limit=0.0)
    distinct, inverse = np.unique(array, return_inverse=True)
    weights = np.empty(len(distinct))
    for i, value in enumerate(distinct.astype(float).tolist()):
        weights[i] = weight_of_sigma(value)
        if not 0.0 < weights[i] < math.inf:
            message = (
                f"sigma = {value!r} gives the weight 1/sigma^2 = {weights[i]}, outside the "
                "doubles: change the unit of length, of clouds and sigma alike"
            )
            raise InvalidProblemError(message, array="sigma", value=value)
    return np.broadcast_to(weights[inverse], (n,))
