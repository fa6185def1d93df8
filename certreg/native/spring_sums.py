"""Exact sums over points whose springs are matrices, by native/exact_springs.c and limbs.c."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.native.kernels import MissingLibraryError
from certreg.native.library import LEAST_PLACE, NOT_FINITE, NOWHERE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from certreg.native.library import Library

SPRING_SUMS, WORDS = 73, 136  # CERTREG_SPRINGS and CERTREG_SPRINGS_WORDS, as in exact_springs.h
LIMB_BITS, LIMB_PLACES = 22, 33
WORD_BYTES = 8
_Words, _About = ctypes.c_uint64 * (SPRING_SUMS * WORDS), ctypes.c_int64 * 7


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringIntegers:
    """The 73 sums in the order of exact_springs.h, over powers of two.

    units: exponents for source, target and W, once for each of them that is a factor of a sum.
    lowest: exponents of the lowest bits set in source, target, L; None: all are zero.
    """

    integers: tuple[int, ...]
    units: tuple[int, int, int]
    lowest: tuple[int | None, int | None, int | None]


def springs_by_exponent(library: Library, *points: NDArray[np.float64]) -> SpringIntegers:
    """The sums over contiguous points, source and target (k, 3), factors (k, 6).

    Raises ValueError for other arrays and for numbers that are not finite, MissingLibraryError
    where the compiled code cannot do it.
    """
    arrays, passed = _passed(points)
    words, about = _Words(), _About()
    refused = library.handle.certreg_exact_springs(*passed, words, about)
    del arrays
    if refused == NOT_FINITE:
        raise ValueError("a number is not finite")
    if refused:
        raise MissingLibraryError("no memory for exact sums, or no integers of 128 bits")
    numbers = list(about)
    size = WORD_BYTES * numbers[6]
    memory: Any = words
    used = np.frombuffer(memory, dtype="=u8", count=SPRING_SUMS * numbers[6])
    content = used.astype("<u8", copy=False).tobytes()
    parts = [content[k : k + size] for k in range(0, len(content), size)]
    x, y, factor = (LEAST_PLACE + k for k in numbers[:3])
    return SpringIntegers(
        integers=tuple([int.from_bytes(part, "little", signed=True) for part in parts]),
        units=(x, y, 2 * factor),
        lowest=_lowest(numbers[3:6]),
    )


def springs_by_limbs(library: Library, *points: NDArray[np.float64]) -> SpringIntegers | None:
    """The same; None where the numbers are of too many sizes."""
    arrays, passed = _passed(points)
    digits, about = np.empty((SPRING_SUMS, LIMB_PLACES), dtype=np.int64), _About()
    memory = ctypes.c_void_p(digits.ctypes.data)
    refused = library.handle.certreg_limb_springs(*passed, memory, about)
    del arrays
    if refused == NOT_FINITE:
        raise ValueError("a number is not finite")
    if refused:
        return None
    numbers = list(about)
    x, y, factor = (LEAST_PLACE + k for k in numbers[:3])
    return SpringIntegers(
        integers=tuple([_joined(row) for row in digits.tolist()]),
        units=(x, y, 2 * factor - LIMB_BITS * (LIMB_PLACES - 1)),
        lowest=_lowest(numbers[3:6]),
    )


def _passed(points: Sequence[NDArray[np.float64]]) -> tuple[list[NDArray[np.float64]], list[Any]]:
    """The arrays, that must live as long, and what a function of exact_springs.h takes first."""
    arrays = [np.ascontiguousarray(array, dtype=float) for array in points]
    shapes, k = [array.shape for array in arrays], len(arrays[0])
    if shapes != [(k, 3), (k, 3), (k, 6)]:
        raise ValueError(f"points of shapes {shapes}: expected (k, 3), (k, 3), (k, 6)")
    return arrays, [ctypes.c_int64(k), *[ctypes.c_void_p(a.ctypes.data) for a in arrays]]


def _lowest(bits: Sequence[int]) -> tuple[int | None, int | None, int | None]:
    x, y, factor = (None if bit == NOWHERE else LEAST_PLACE + bit for bit in bits)
    return x, y, factor


def _joined(digits: Sequence[int]) -> int:
    """One number of digits with sign, the highest first."""
    value = 0
    for digit in digits:
        value = (value << LIMB_BITS) + digit
    return value
