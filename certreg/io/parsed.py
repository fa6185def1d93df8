"""What a reader that is no reader of text makes of a file: points, and what calls its rows."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.problem.arrays import row_blocks
from certreg.results import Brief

if TYPE_CHECKING:
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
class Parsed:
    """Points (N, 3) and what is told of them, as in a cloud."""

    points: NDArray[np.float64]
    ignored: tuple[str, ...] = ()
    labels: tuple[str, ...] | None = None
    identifiers: tuple[str, ...] | None = None
    numbers: RowNumbers | None = None
    sigma: NDArray[np.float64] | None = None
    weights: NDArray[np.float64] | None = None
    times: NDArray[np.float64] | None = None  # seconds, ascending, of the poses of a trajectory
    notes: tuple[str, ...] = ()
    further: dict[str, NDArray[Any]] = field(default_factory=dict[str, Any])  # columns asked for
