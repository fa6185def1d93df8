"""The section of the report on general springs that lists all equilibria."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from certreg.equilibrium.line_set import Finiteness
from certreg.errors import MissingToolError
from certreg.registration.spring_release import listed_springs, returns
from certreg.report.parts import sprung
from certreg.report.sections import Section, Table
from certreg.report.spring_equilibria import magnitude, spring_count_words, spring_notes
from certreg.results import Guarantee

if TYPE_CHECKING:
    from certreg.registration.result import Registration
    from certreg.registration.spring_equilibria import SpringEquilibrium


COUNTED = {  # on what the number of equilibria rests
    Finiteness.FORTY: ("forty_lines",),
    Finiteness.FOUR: ("eigenvectors", "classification"),
}
MOST_RELEASED = 8  # stable ones of which a run is made: more than eight were never seen

CAME_BACK = (
    "A body comes back: released at rest, turned by 1°, it came to rest within 0.1° of where it "
    "was, as seen in doubles."
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ListedRow:
    """An equilibrium as the table shows it; trap: it is stable, and not the optimum."""

    index: str
    stable: str
    energy: str
    rmse: str
    angle: str
    words: str
    trap: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Listed:
    """What the section says: how many there are and how that is known, a row for each, notes.

    angle: the head of the column of angles, which are to the first row.
    complete: whether these are proved to be all, and finitely many. theorems: that show it.
    """

    words: str
    angle: str = ""
    rows: tuple[ListedRow, ...] = ()
    notes: tuple[str, ...] = ()
    complete: bool = False
    guarantee: Guarantee = Guarantee.NUMERICAL
    theorems: tuple[str, ...] = ()

    @property
    def section(self) -> Section:
        """As a page shows it."""
        rows = [
            (one.index, one.stable, one.energy, one.rmse, one.angle, one.words) for one in self.rows
        ]
        table = Table(
            head=("index", "stable", "energy", "RMSE", self.angle, ""),
            rows=rows,
            stressed=frozenset(k for k, one in enumerate(self.rows) if one.trap),
        )
        return Section(
            name="listed",
            title="All equilibria of these springs",
            words=(self.words,),
            table=table if rows else None,
            notes=self.notes,
        )


def listed(registration: Registration) -> Listed | None:
    """All equilibria of these springs; None where nothing can be listed.

    Without python-flint no rows, and the words say so: the proof of the optimum needs no list.
    """
    own = sprung(registration)
    if own is None:
        return None
    problem, objective = own.problem, own.solution.objective
    try:
        found = listed_springs(problem, objective)
    except MissingToolError as error:
        return Listed(words=f"None is listed here: {error}.")
    if found is None:
        return None
    stable = [part for part in found.components if part.stable][:MOST_RELEASED]
    kept = {id(part): returns(problem, objective, part) for part in stable}
    rows = tuple(_row(part, returned=kept.get(id(part))) for part in found.components)
    notes = spring_notes(found)
    if any(kept.values()):
        notes.append(CAME_BACK)
    known = any(part.angle_to_optimum is not None for part in found.components)
    return Listed(
        words=spring_count_words(found),
        angle="to the optimum" if known else "to the first row",
        rows=rows,
        notes=tuple(notes),
        complete=found.count is not None,
        guarantee=found.guarantee,
        theorems=COUNTED.get(found.finiteness, ()),
    )


def _row(part: SpringEquilibrium, *, returned: bool | None) -> ListedRow:
    trap = part.stable is True and part.optimal is False
    return ListedRow(
        index="–" if part.morse_index is None else str(part.morse_index),
        stable={True: "yes", False: "no", None: "–"}[part.stable],
        energy=magnitude(part, part.energy),
        rmse=magnitude(part, part.rmse),
        angle=f"{math.degrees(part.angle_to_first):.4g}°",
        words=_words(part, returned=returned, trap=trap),
        trap=trap,
    )


def _words(part: SpringEquilibrium, *, returned: bool | None, trap: bool) -> str:
    if not part.separated:
        return "not told apart from others"
    kind = {True: "the optimum", False: "", None: "may be optimal"}[part.optimal]
    if trap:
        kind = "stable, and wrong"
    if not part.stable:
        return kind
    seen = {True: "a body comes back", False: "", None: ""}[returned]
    return "; ".join(filter(None, (kind, seen)))
