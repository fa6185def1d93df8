"""Some of the points of a problem: rows of arrays that may be mapped from a file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.errors import InvalidProblemError
from certreg.problem.arrays import mapped_file, row_blocks
from certreg.results import Brief

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

CHANGED = "the file of a mapped array was changed while it was read: state the problem anew"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PointBlock(Brief):
    """Some of the points of a problem: source (k, 3), target (k, 3), contiguous."""

    source: NDArray[np.float64]
    target: NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Block(PointBlock):
    """The same with one weight for each pair: weights (k,)."""

    weights: NDArray[np.float64]

    def part(self, rows: slice) -> Block:
        """Some of these points."""
        return Block(source=self.source[rows], target=self.target[rows], weights=self.weights[rows])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SpringBlock(PointBlock):
    """The same with general springs: factors (k, 6)."""

    factors: NDArray[np.float64]


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


def first_row(
    array: NDArray[np.float64], wrong: Callable[[NDArray[np.float64]], NDArray[np.bool_]]
) -> int | None:
    """The first row where something is wrong, None if nowhere."""
    for rows in row_blocks(len(array)):
        faults = wrong(contiguous(array, rows))
        if faults.any():
            return rows.start + int(np.argmax(faults))
    return None
