"""The rows of a problem in words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

from certreg.verify import shown

if TYPE_CHECKING:
    from collections.abc import Sequence


@dataclass(frozen=True, slots=True)
class RowNames:
    """Rows in words."""

    labels: Sequence[str] | None

    def label(self, row: int) -> str | None:
        """The label of a row, if it has one."""
        return None if self.labels is None else self.labels[row]

    @classmethod
    def of(cls, about: dict[str, Any], n: int) -> RowNames:
        """The labels that a certificate holds, unproved, if there is one for each row."""
        labels: Any = about.get("labels")
        given = cast("list[Any]", labels) if isinstance(labels, list) else []
        texts = tuple(one for one in given if isinstance(one, str))
        return cls(texts if len(texts) == n else None)

    def words(self, rows: Sequence[int], count: int) -> str:
        """For example: rows 3 (P4), 9 (P10) and 5 others."""
        named = [f"{r}" if self.labels is None else f"{r} ({shown(self.labels[r])})" for r in rows]
        more = count - len(rows)
        tail = f" and {more} {'other' if more == 1 else 'others'}" if more else ""
        return f"row{'' if count == 1 else 's'} {', '.join(named)}{tail}"
