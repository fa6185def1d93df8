"""Exact sums over points, by the C of exact.c, fixed.c, exact_springs.c and limbs.c."""

from __future__ import annotations

import ctypes
import struct
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.native.kernels import MissingLibraryError
from certreg.native.layout import EXACT_SUMS, width

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.native.library import Library

POINT_SUMS, SPRING_SUMS = width(EXACT_SUMS), 73  # CERTREG_SPRINGS, as in exact_springs.h
EXACT_WORDS, FEW_WORDS = 101, 6  # as in exact.h
FIXED_WORDS, SPRING_WORDS = 7, 136  # as in fixed.h and exact_springs.h
LIMB_BITS, LIMB_PLACES = 22, 33
WORD_BYTES = 8
SUMMED, NOT_FINITE, NOWHERE = 0, 2, 2**63 - 1
FEW_POINTS = 1024  # up to here memory that is not asked for is worth reading them twice
LEAST_PLACE = -1074  # every double is an integer times 2^-1074
_POINTER = ctypes.c_void_p
_LongSums, _Lowest = ctypes.c_uint64 * (POINT_SUMS * EXACT_WORDS), ctypes.c_int64 * 3
_FewSums = ctypes.c_uint64 * (POINT_SUMS * FEW_WORDS)
_FixedSums, _About = ctypes.c_uint64 * (POINT_SUMS * FIXED_WORDS), ctypes.c_int64 * 8
_SpringSums = ctypes.c_uint64 * (SPRING_SUMS * SPRING_WORDS)


@dataclass(frozen=True, slots=True, kw_only=True)
class IntegerSums:
    """The 28 sums of exact.h, or of springs that are matrices the 73 of exact_springs.h.

    integers: each over 2^units of its factors, which are of source, target, weights.
    lowest: exponents of the lowest bits set in these; None: all are zero.
    biases: p, q where the sums are of the integers X + 2^p and Y + 2^q, with source = X 2^a,
        target = Y 2^b. Then without weights W = 1, also for points of zeros that were added.
    """

    integers: tuple[int, ...]
    units: tuple[int, ...]
    lowest: tuple[int | None, ...]
    biases: tuple[int, ...] = ()


def sums_by_exponent(library: Library, *points: NDArray[np.float64]) -> IntegerSums:
    """The sums over contiguous points, source and target (k, 3), weights (k,), by exact.c.

    Raises ValueError for other arrays and for numbers that are not finite, MissingLibraryError
    where the compiled code cannot do it.
    """
    arrays = _arrays(points)
    if len(arrays[0]) <= FEW_POINTS:
        count, few, lowest = ctypes.c_int64(len(arrays[0])), _FewSums(), _Lowest()
        given = [array.tobytes() for array in arrays]  # sooner done than asking for addresses
        if library.handle.certreg_few_sums(count, *given, few, lowest) == SUMMED:
            exponents = _exponents(lowest)
            units = tuple([bit or 0 for bit in exponents])
            return IntegerSums(integers=_integers(bytes(few)), units=units, lowest=exponents)
    words, lowest = _LongSums(), _Lowest()
    _require(library.handle.certreg_exact_sums(*_passed(arrays), words, lowest))
    return IntegerSums(
        integers=_integers(bytes(words)), units=(LEAST_PLACE,) * 3, lowest=_exponents(lowest)
    )


def fixed_point_fits(library: Library, *points: NDArray[np.float64] | None) -> bool:
    """Whether `sums_in_fixed_point` would take these points."""
    arrays = _arrays(points)
    return library.handle.certreg_fixed_fits(*_passed(arrays)) == SUMMED


def sums_in_fixed_point(
    library: Library, *points: NDArray[np.float64] | None
) -> IntegerSums | None:
    """The same by fixed.c, of integers that are not negative; weights: None if all are one.

    None where the numbers are of too many sizes, or a weight is negative, or the compiled code has
    no integers of 128 bits. Raises ValueError for other arrays and for numbers that are not finite.
    """
    arrays, words, about = _arrays(points), _FixedSums(), _About()
    if _is_refused(library.handle.certreg_fixed_sums(*_passed(arrays), words, about)):
        return None
    x, y, w, *biases = about[:5]
    bits = zip((x, y, w), about[5:], strict=True)
    return IntegerSums(
        integers=_integers(bytes(words)),
        units=(x, y, w),
        lowest=tuple([None if bit < 0 else unit + bit for unit, bit in bits]),
        biases=tuple(biases),
    )


def springs_by_exponent(library: Library, *points: NDArray[np.float64]) -> IntegerSums:
    """The sums over contiguous points, source and target (k, 3), factors (k, 6); raises alike."""
    arrays, words, about = _arrays(points, factors=True), _SpringSums(), _About()
    _require(library.handle.certreg_exact_springs(*_passed(arrays), words, about))
    used = ctypes.string_at(words, SPRING_SUMS * WORD_BYTES * about[6])
    return _of_springs(_integers(used, SPRING_SUMS), about[:6], 0)


def springs_by_limbs(library: Library, *points: NDArray[np.float64]) -> IntegerSums | None:
    """The same; None where the numbers are of too many sizes."""
    arrays, about = _arrays(points, factors=True), _About()
    digits = np.empty((SPRING_SUMS, LIMB_PLACES), dtype=np.int64)
    memory = _POINTER(digits.ctypes.data)
    if _is_refused(library.handle.certreg_limb_springs(*_passed(arrays), memory, about)):
        return None
    integers = tuple([joined(row, LIMB_BITS) for row in digits.tolist()])
    return _of_springs(integers, about[:6], LIMB_BITS * (LIMB_PLACES - 1))


def _of_springs(integers: tuple[int, ...], about: Sequence[int], places: int) -> IntegerSums:
    """Sums whose W are of a product of two factors, over 2^places less."""
    x, y, factor = (LEAST_PLACE + unit for unit in about[:3])
    a, b, c = _exponents(about[3:6])
    return IntegerSums(
        integers=integers,
        units=(x, y, 2 * factor - places),
        lowest=(a, b, None if c is None else 2 * c),
    )


def _arrays(
    points: Sequence[NDArray[np.float64] | None], *, factors: bool = False
) -> list[NDArray[np.float64]]:
    """The arrays as C takes them. Raises ValueError for those of other shapes."""
    arrays = [np.ascontiguousarray(a, dtype=float) for a in points if a is not None]
    shapes, k = [array.shape for array in arrays], len(arrays[0])
    if shapes != [(k, 3), (k, 3), (k, 6) if factors else (k,)][: len(arrays)]:
        third = "(k, 6)" if factors else "(k,)"
        raise ValueError(f"points of shapes {shapes}: expected (k, 3), (k, 3), {third}")
    return arrays


def _passed(arrays: Sequence[NDArray[np.float64]]) -> list[Any]:
    """How many points, and where they are: the arrays must live as long."""
    places = [_POINTER(array.ctypes.data) for array in arrays]
    return [ctypes.c_int64(len(arrays[0])), *places, *[_POINTER()] * (3 - len(arrays))]


def _is_refused(code: int) -> bool:
    """Whether the compiled code leaves it to others. Raises ValueError for NaN and infinity."""
    if code == NOT_FINITE:
        raise ValueError("a number is not finite")
    return code != SUMMED


def _require(code: int) -> None:
    """Raises MissingLibraryError where the compiled code cannot do it; as `_is_refused`."""
    if _is_refused(code):
        raise MissingLibraryError("no memory for exact sums, or no integers of 128 bits")


def _integers(words: bytes, count: int = POINT_SUMS) -> tuple[int, ...]:
    """So many integers, each of as many words, low first."""
    if sys.byteorder == "big":
        words = np.frombuffer(words, dtype="=u8").astype("<u8").tobytes()
    number, parts = int.from_bytes, _parts(len(words), count).unpack(words)
    return tuple([number(part, "little", signed=True) for part in parts])


@cache
def _parts(size: int, count: int) -> struct.Struct:
    """So many parts of so many bytes."""
    return struct.Struct(f"{size // count}s" * count)


def _exponents(lowest: Iterable[int]) -> tuple[int | None, ...]:
    """Of lowest bits that are told over 2^-1074."""
    return tuple([None if bit == NOWHERE else bit + LEAST_PLACE for bit in lowest])


def joined(digits: Sequence[int], bits: int) -> int:
    """One number of digits with sign of so many bits each, the highest first."""
    value = 0
    for digit in digits:
        value = (value << bits) + digit
    return value
