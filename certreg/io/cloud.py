"""What a reader makes of a file: points, and what calls its rows."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.problem.arrays import row_blocks
from certreg.results import Brief

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray


MIXERS = (np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB))  # of splitmix64
SHIFT = np.uint64(31)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RowNumbers(Brief):
    """A number for each row, (N,), still in the file."""

    column: NDArray[Any]

    @classmethod
    def of(cls, names: tuple[str, ...] | None) -> RowNumbers | None:
        """Of names that were read; None where one is no number."""
        try:
            return None if names is None else cls(column=np.array([float(one) for one in names]))
        except ValueError:
            return None

    def first_other(self, others: RowNumbers) -> int | None:
        """The first row that is called otherwise there; None if there is none."""
        for rows in row_blocks(len(self.column)):
            other = np.flatnonzero(self._bits(rows) != others._bits(rows))
            if len(other):
                return rows.start + int(other[0])
        return None

    @property
    def sum(self) -> int:
        """A sum that does not depend on the order: that of other numbers is another, but by chance.

        The chance is 2^-64, if the mixed bits are as random as they look.
        """
        total = 0
        for rows in row_blocks(len(self.column)):
            bits = self._bits(rows)
            for mixer in MIXERS:
                bits = (bits ^ (bits >> SHIFT)) * mixer
            total += int((bits ^ (bits >> SHIFT)).sum(dtype=np.uint64))
        return total % 2**64

    def _bits(self, rows: slice) -> NDArray[np.uint64]:
        """The numbers as doubles, bit by bit, so that what is no number is equal to itself."""
        return (self.column[rows].astype(np.float64) + 0.0).view(np.uint64)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cloud(Brief):
    """Points read from a file: (N, 3), labels if the file has them, names of columns not read.

    Points of a large .npy or binary .ply file are mapped from it: they stay there, as doubles or
    floats, and nobody may change the file meanwhile.
    """

    path: Path
    points: NDArray[np.float64]
    labels: tuple[str, ...] | None = None
    ignored: tuple[str, ...] = ()
    identifiers: tuple[str, ...] | None = None  # labels, or what a column not read calls the points
    numbers: RowNumbers | None = None  # what names the rows of a large file, in their place
    sigma: NDArray[np.float64] | None = None  # of the column of this name: one for each point
    weights: NDArray[np.float64] | None = None  # of the column `weight`
    normals: NDArray[np.float64] | None = None  # of nx, ny, nz, where `load` was asked for all
    covariances: NDArray[np.float64] | None = None  # (N, 6), of cxx, cxy, cxz, cyy, cyz, czz
    times: NDArray[np.float64] | None = None  # ascending, of a trajectory: they pair rows
    notes: tuple[str, ...] = ()  # on how the file was read
    further: dict[str, NDArray[Any]] = field(default_factory=dict[str, Any], repr=False)  # asked

    def __array__(self, dtype: Any = None, *, copy: bool | None = None) -> NDArray[Any]:
        """The points, where NumPy asks for an array."""
        points = np.asarray(self.points, dtype=dtype)
        return points.copy() if copy else points
