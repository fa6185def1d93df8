"""Sections of a page: what each says, in words, tables, figures and pictures; no markup."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from certreg.report.lines import number

if TYPE_CHECKING:
    from certreg.registration.result import Registration
    from certreg.report.picture import Picture
    from certreg.report.pose_facts import Fact
    from certreg.report.viewer import Names


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """named: whether the second column holds names of the user's. stressed: rows with a trap."""

    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    named: bool = False
    stressed: frozenset[int] = frozenset()


@dataclass(frozen=True, slots=True, kw_only=True)
class Curve:
    """A number over time."""

    name: str
    picture: Picture


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """What a section holds, in the order in which it is shown.

    chart: residuals against bounds. lead: in small print. course: the motion on springs that break.
    """

    name: str
    title: str
    chart: Any = None
    lead: str = ""
    words: Sequence[str] = ()
    facts: Sequence[Fact] = ()
    curves: Sequence[Curve] = ()
    course: Any = None
    table: Table | None = None
    after: Sequence[str] = ()
    notes: Sequence[str] = ()


def rows_table(
    head: Sequence[str], rows: Sequence[tuple[int, Sequence[str]]], names: Names
) -> Table:
    """Rows of the clouds, each with its label if the points have labels."""
    labels = names.labels
    if labels is None:
        cells = [(str(row), *told) for row, told in rows]
        return Table(head=("row", *head), rows=cells)
    cells = [(str(row), labels[row], *told) for row, told in rows]
    return Table(head=("row", "label", *head), rows=cells, named=True)


def worst_section(registration: Registration, names: Names) -> Section:
    """The pairs that are farthest off, for a page without a script."""
    along = registration.problem.springs is not None
    rows = [(one.row, (number(one.residual),)) for one in registration.fit.worst]
    return Section(
        name="worst",
        title=f"The pairs that are farthest off{' along their springs' * along}",
        table=rows_table(("off along the springs" if along else "distance",), rows, names),
    )
