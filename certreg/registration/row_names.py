"""The rows of a problem in words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

from certreg.verify import shown

if TYPE_CHECKING:
    from certreg.results import Json

T = TypeVar("T", str, int)


@dataclass(frozen=True, slots=True)
class RowNames:
    """Rows in words.

    labels: of each row. rows: which rows of a larger problem they are, where they are some of its.
    """

    labels: Sequence[str] | None
    rows: Sequence[int] | None = None

    def label(self, row: int) -> str | None:
        """The label of a row, if it has one."""
        return None if self.labels is None else self.labels[row]

    @classmethod
    def of(cls, about: dict[str, Any], n: int) -> RowNames:
        """Labels and rows that a certificate holds, unproved, if there is one for each row."""
        return cls(_each(about.get("labels"), str, n), _each(about.get("rows"), int, n))

    def words(self, rows: Sequence[int], count: int) -> str:
        """For example: rows 3 (P4), 9 (P10) and 5 others."""
        named = [self._word(row) for row in rows]
        more = count - len(rows)
        tail = f" and {more} {'other' if more == 1 else 'others'}" if more else ""
        return f"row{'' if count == 1 else 's'} {', '.join(named)}{tail}"

    def counted(self, rows: Sequence[int], count: int) -> str:
        """The same, and from where rows are counted."""
        return f"{self.words(rows, count)}, counting from 0"

    def _word(self, row: int) -> str:
        number, label = row if self.rows is None else self.rows[row], self.label(row)
        return f"{number}" if label is None else f"{number} ({shown(label)})"


def _each(given: Json, kind: type[T], n: int) -> tuple[T, ...] | None:
    """The entries of a list of n, all of one kind; None where it is none."""
    right = tuple(one for one in given if type(one) is kind) if isinstance(given, list) else ()
    return right if len(right) == n else None
