"""Lawson's iteration by native/lawson.c: rows that no motion meets, poses that fit them best."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.native.library import WRONG_PAIRS, library_for

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Reals = NDArray[np.float64]

SCRATCH, SPARE = 13, 8  # CERTREG_LAWSON_SCRATCH, CERTREG_LAWSON_SPARE, as in native/lawson.h


@dataclass(frozen=True, slots=True)
class Refuted:
    """Rows that no motion meets, the one that was named first, and weights that show it."""

    rows: list[int]
    weights: list[int]


@dataclass(frozen=True, slots=True, eq=False)
class LeastRatios:
    """Of B sets of n rows: poses y = R x + t, (B, 3, 3) and (B, 3), of the least largest ratio met.

    weights: (B, n), of the last step.
    """

    rotations: Reals
    translations: Reals
    weights: Reals


class LawsonColumns:
    """Points (3, n), (3, n) and bounds (n,), of about one in size, for the compiled code."""

    def __init__(self, source: Reals, target: Reals, bounds: Reals) -> None:
        """Raises MissingLibraryError where there is no compiled code."""
        self._handle = library_for(WRONG_PAIRS).handle
        self._columns = np.empty((7, len(bounds)))
        self._columns[:3], self._columns[3:6], self._columns[6] = source, target, bounds
        self._place = ctypes.c_void_p(self._columns.ctypes.data)
        self._height = ctypes.c_int64(len(bounds))

    def refuted(self, rows: Sequence[int]) -> Refuted | None:
        """Few of the rows, the first and others, that no motion meets; None if none were found."""
        count = len(rows)
        numbers = np.empty((2, count), dtype=np.int64)
        numbers[0] = rows
        scratch = np.empty(SCRATCH * (count + SPARE))
        start = numbers.ctypes.data
        found: int = self._handle.certreg_refutation(
            self._height,
            self._place,
            ctypes.c_void_p(start),
            ctypes.c_int64(count),
            ctypes.c_void_p(start + 8 * count),
            ctypes.c_void_p(scratch.ctypes.data),
        )
        return Refuted(*numbers[:, :found].tolist()) if found else None

    def fits(self, sets: NDArray[np.bool_]) -> LeastRatios:
        """The pose of each set (B, n), that is not empty, until it fits or cannot fit."""
        count, height = sets.shape
        given = np.ascontiguousarray(sets)
        poses, weights = np.empty((count, 12)), np.empty(sets.shape)
        scratch = np.empty(SCRATCH * (height + SPARE))
        self._handle.certreg_lawson_fits(
            self._height,
            self._place,
            ctypes.c_int64(count),
            *[ctypes.c_void_p(array.ctypes.data) for array in (given, poses, weights, scratch)],
        )
        return LeastRatios(poses[:, :9].reshape(count, 3, 3), poses[:, 9:], weights)
