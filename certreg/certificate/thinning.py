"""Striking pairs that no motion meets that meets enough: what remains, and what shows it.

A motion that meets K pairs meets a clique of K in the graph of consistent pairs. So a row falls
that has fewer than K - 1 neighbours; or of whose neighbours too few can be met together with it: of
each colour one at most, of each group that is refuted with it all but one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from certreg.certificate.consensus import Group, Strike
from certreg.certificate.consistency import mask_of, rows_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from certreg.certificate.refuting import PointRows

MOST_GROUPS = 64  # of one row, at effort 1
MOST_LEFT_OUT = 4  # rows, where groups share some: the sets to be tried grow as its power


@dataclass(frozen=True, slots=True, eq=False)
class Graph:
    """Pairs that one motion may meet together, as bits; their points; how hard to try."""

    near: list[int]
    points: PointRows
    effort: float = 1.0


class Thinning:
    """What is left of `alive` that a motion that meets at least `least` of it can meet.

    clique: rows that are consistent with each other, of which the groups are. None of them is
    tried: they fall by themselves where the others have fallen and they are too few.
    """

    def __init__(self, graph: Graph, alive: int, least: int, clique: int) -> None:
        self._graph, self._least, self._clique = graph, least, clique
        self._coloured: dict[int, int] = {}
        self._failed: dict[int, tuple[int, int]] = {}
        self.strikes: list[Strike] = []
        self.alive = linked(graph.near, alive, least, alive)

    def run(self) -> None:
        """Strikes rows until none falls."""
        while self._strike(self._no_groups) or self._strike(self._groups):
            pass

    def _strike(self, proof: Callable[[int], tuple[Group, ...] | None]) -> bool:
        """Tries all rows once, those with few neighbours first; whether one fell."""
        near, struck = self._graph.near, False
        rows = sorted(
            rows_of(self.alive & ~self._clique),
            key=lambda e: (near[e] & self.alive).bit_count(),
        )
        for e in rows:
            if self.alive.bit_count() < self._least:
                return False
            if self.alive >> e & 1 and (groups := proof(e)) is not None:
                self.strikes.append(Strike(row=e, groups=groups))
                self.alive = linked(near, self.alive & ~(1 << e), self._least, near[e])
                struck = True
        return struck

    def _no_groups(self, e: int) -> tuple[Group, ...] | None:
        beside, most = self._graph.near[e] & self.alive, self._least - 2
        if self._coloured.get(e) == beside or (beside & self._clique).bit_count() > most:
            return None
        if colours(beside, self._graph.near, most) <= most:
            return ()
        self._coloured[e] = beside
        return None

    def _groups(self, e: int) -> tuple[Group, ...] | None:
        """Groups of the clique, each refuted with e, so many that e falls; None if not found.

        A motion that meets e and enough others leaves out so many rows of the clique at most, and
        one of each group.
        """
        beside = self._graph.near[e] & self.alive
        rows = beside & self._clique
        others = colours(beside & ~self._clique, self._graph.near, self._least)
        most = rows.bit_count() + others - (self._least - 1)
        failed = self._failed.get(e)
        if not 0 <= most < rows.bit_count() or (failed == (rows, most)):
            return None
        family = self._apart(e, rows, most)
        if len(family) <= most:
            family = self._shared(e, rows, most, family)
        if family is None:
            self._failed[e] = rows, most
            return None
        return tuple(family)

    def _apart(self, e: int, rows: int, most: int) -> list[Group]:
        """Groups without a common row, one more than `most` if there are so many."""
        family: list[Group] = []
        while rows and len(family) <= most:
            group = self._graph.points.refutation(e, list(rows_of(rows)))
            if group is None:
                break
            family.append(group)
            rows &= ~mask_of(group.rows)
        return family

    def _shared(self, e: int, rows: int, most: int, family: list[Group]) -> list[Group] | None:
        """More groups, until no `most` rows meet all; None if not found.

        Rows that meet all so far are left out, and the others refuted.
        """
        limit = round(MOST_GROUPS * self._graph.effort)
        masks = [mask_of(group.rows) for group in family]
        while most <= MOST_LEFT_OUT and len(family) < limit:
            out = transversal(masks, most)
            if out is None:
                return family
            group = self._graph.points.refutation(e, list(rows_of(rows & ~out)))
            if group is None:
                return None
            family.append(group)
            masks.append(mask_of(group.rows))
        return None


def transversal(sets: list[int], most: int) -> int | None:
    """At most so many rows, one of each set at least, as bits; None if there are no such rows."""
    apart, taken = 0, 0
    for mask in sets:
        if not mask & taken:
            apart, taken = apart + 1, taken | mask
    if apart > most:
        return None
    if not sets:
        return 0
    for row in rows_of(sets[0]):
        found = transversal([mask for mask in sets if not mask >> row & 1], most - 1)
        if found is not None:
            return found | 1 << row
    return None


def linked(near: list[int], alive: int, least: int, touched: int) -> int:
    """Less those with fewer than `least` - 1 neighbours, until none is left that has so few.

    touched: rows that may have so few; those that lose a neighbour follow.
    """
    while touched:
        few = [i for i in rows_of(touched & alive) if (near[i] & alive).bit_count() < least - 1]
        alive &= ~mask_of(few)
        touched = 0
        for i in few:
            touched |= near[i]
    return alive


def colours(rows: int, near: list[int], most: int) -> int:
    """How many colours the rows take, the lowest first; or one more than `most`.

    A colour is given to the lowest row without one, then to every later row that is no neighbour
    of those that have it. The checker colours alike, so that it finds no more.
    """
    count = 0
    while rows and count <= most:
        count += 1
        free = rows
        while free:
            low = free & -free
            rows ^= low
            free &= ~(near[low.bit_length() - 1] | low)
    return count
