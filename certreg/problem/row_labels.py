"""Labels of rows: what the index of a data frame, or a column of it, calls each point.

Rows pair in order. So two clouds that say by labels that they are in another order are refused.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from certreg.errors import InvalidProblemError
from certreg.problem.arrays import data_frame
from certreg.results import Brief

LABEL = "label"


@dataclass(frozen=True, slots=True, kw_only=True)
class RowLabels(Brief):
    """What names the rows.

    certain: whether that is what they are for. An index 0, 1, 2, ... that nobody chose, or a column
    of numbers, says something only where the other cloud has the same in another order.
    """

    values: Sequence[Any]
    certain: bool = True

    def first_other(self, other: RowLabels) -> int | None:
        """The first row that the other cloud names otherwise; None where rows may pair in order."""
        here, there = list(map(str, self.values)), list(map(str, other.values))
        certain = self.certain and other.certain
        if here == there or not (certain or Counter(here) == Counter(there)):
            return None
        pairs = enumerate(zip(here, there, strict=False))
        return next((row for row, (a, b) in pairs if a != b), min(len(here), len(there)))


def labels_of(given: Any) -> RowLabels | None:
    """The labels of the rows of a cloud or of weights; None where they have none."""
    called: tuple[str, ...] | None = getattr(given, "identifiers", None)
    if isinstance(called, tuple):  # a cloud that certreg read
        return RowLabels(values=called, certain=given.labels is not None)
    if data_frame(given):
        columns = [one for one in given.columns if isinstance(one, str)]
        found = [one for one in columns if one.strip().lower() == LABEL]
        if len(found) == 1:
            return RowLabels(values=list(given[found[0]]))
    index = _index(given)
    if index is None:
        return None
    size = len(index)
    if type(index).__name__ == "RangeIndex" and (index.start, index.step) == (0, 1):
        return RowLabels(values=range(size), certain=False)
    values: list[Any] = index.tolist()
    return RowLabels(values=values, certain=values != list(range(size)))


def _index(given: Any) -> Any:
    """The index of the rows, of pandas or xarray; None of anything else."""
    if hasattr(given, "dims") and hasattr(given, "indexes"):
        return given.indexes.get(given.dims[0]) if given.dims else None
    index = getattr(given, "index", None) if hasattr(given, "to_numpy") else None
    return index if hasattr(index, "tolist") else None


def require_same_labels(source: Any, *, called: str = "source", **others: Any) -> None:
    """That all whose rows have labels have those of the source, in its order.

    called: what the first is in errors. Raises InvalidProblemError: the first row where they
    differ, and what to type.
    """
    first = labels_of(source)
    if first is None:
        return
    for name, other in others.items():
        labels = None if other is None else labels_of(other)
        row = None if labels is None else first.first_other(labels)
        if labels is None or row is None:
            continue
        known = [None if row >= len(each.values) else each.values[row] for each in (first, labels)]
        remedy = f"give {name}.loc[{called}.index]"
        if name == "target":
            remedy = "take source, target = certreg.pair(source, target), which pairs by label"
        raise InvalidProblemError(
            f"row {row} (counting from 0) is labelled {known[0]!r} in {called} and {known[1]!r} "
            f"in {name}, and rows pair in order: {remedy}",
            array=name,
            row=row,
            value=known[1],
            limit=known[0],
        )
