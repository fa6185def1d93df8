"""What a column of a large file calls its rows: too many to be texts, but not to be compared."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.errors import InvalidFileError
from certreg.io.labels import require_same_order
from certreg.problem import row_blocks
from certreg.results import Brief
from certreg.verify import shown

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from certreg.io.clouds import Cloud

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


def require_same_rows(source: Cloud, target: Cloud) -> None:
    """That rows which are to pair in order do not name the same points in another order.

    By the names that were read, or the numbers of large files. Raises InvalidFileError.
    """
    files = (source.path, target.path)
    require_same_order(source.identifiers, target.identifiers, files)
    if source.numbers is None and target.numbers is None:
        return
    here, there = (c.numbers or RowNumbers.of(c.identifiers) for c in (source, target))
    if here is not None and there is not None:
        _require_same(here, there, files)


def _require_same(source: RowNumbers, target: RowNumbers, files: tuple[Path, Path]) -> None:
    row = source.first_other(target)
    if row is None or source.sum != target.sum:
        return
    names = [shown(file) for file in files]
    here, there = source.column[row].item(), target.column[row].item()
    message = (
        f"{names[0]} and {names[1]} number the same points in another order: point {row} (counting "
        f"from 0) is {here:.16g} and {there:.16g}, and files this large are not paired by "
        "label: give pairs, or sort both by it"
    )
    raise InvalidFileError(message, path=files[1], row=row, value=there, limit=here)
