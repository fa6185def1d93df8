"""Striking pairs that no motion meets that meets enough: what remains, and what shows it.

A motion that meets K pairs meets a clique of K in the graph of consistent pairs. So a row falls
that has fewer than K - 1 neighbours; or of whose neighbours too few can be met together with it: of
each colour one at most, of each group that is refuted with it all but one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from certreg.certificate.consensus import Group, Strike
from certreg.native.bitset_graph import BitRows, Thinned, mask_of, rows_of

if TYPE_CHECKING:
    from certreg.certificate.infeasibility_weights import PointRows


MOST_GROUPS = 64  # of one row, at effort 1
MOST_LEFT_OUT = 4  # rows, where groups share some: the sets to be tried grow as its power


@dataclass(frozen=True, slots=True, eq=False)
class Graph:
    """Pairs that one motion may meet together, as bits; their points; how hard to try.

    turned: how many pairs of rows are tried by turns and stay, at effort 1: 0 where motions may
    change lengths.
    """

    near: BitRows
    points: PointRows
    effort: float = 1.0
    turned: int = 0


class GraphThinning:
    """What is left of `alive` that a motion that meets at least `least` of it can meet.

    clique: rows that are consistent with each other, of which the groups are. None of them is
    tried: they fall by themselves where the others have fallen and they are too few. left: the
    graph that is left, without the pairs that are struck together.
    """

    def __init__(self, graph: Graph, alive: int, least: int, clique: int) -> None:
        self.graph, self.least, self.clique = graph, least, clique
        self._failed: dict[int, tuple[int, int]] = {}
        self.left = Thinned(graph.near, alive, least, clique)
        self.strikes: list[Strike] = []

    @property
    def closed(self) -> bool:
        """Whether no row is open, or too few are left for any motion."""
        alive = self.left.alive
        return not alive & ~self.clique or alive.bit_count() < self.least

    def open_rows(self) -> list[int]:
        """Those left that are not of the clique, those with few neighbours first."""
        rows = rows_of(self.left.alive & ~self.clique)
        return sorted(rows, key=lambda e: self.left.beside(e).bit_count())

    def strike(self, strike: Strike) -> None:
        """Strikes a row, or two neighbours together; and then what has too few neighbours."""
        self.strikes.append(strike)
        if isinstance(strike.struck, int):
            self.left.strike(strike.struck)
        else:
            self.left.cut(*strike.struck)

    def run(self) -> None:
        """Strikes rows until none falls."""
        while self._strike_by_colours() or self._strike_by_groups():
            pass

    def _strike_by_colours(self) -> bool:
        struck = self.left.strike_by_colours()
        self.strikes += [Strike(struck=row) for row in struck]
        return bool(struck)

    def _strike_by_groups(self) -> bool:
        """Tries all rows once, those with few neighbours first; whether one fell."""
        before = len(self.strikes)
        for tried in self.left.open_rows():
            groups = self._groups(tried.row, tried.spare)
            if groups is not None:
                self.strike(Strike(struck=tried.row, groups=groups))
        return len(self.strikes) > before

    def _groups(self, e: int, most: int) -> tuple[Group, ...] | None:
        """Groups of the clique, each refuted with e, that more than `most` of its rows miss.

        Every motion that meets e leaves out one of each group. None if they are not found.
        """
        rows = self.left.beside(e) & self.clique
        if self._failed.get(e) == (rows, most):
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
            group = self.graph.points.refutation(e, list(rows_of(rows)))
            if group is None:
                break
            family.append(group)
            rows &= ~mask_of(group.rows)
        return family

    def _shared(self, e: int, rows: int, most: int, family: list[Group]) -> list[Group] | None:
        """More groups, until no `most` rows meet all; None if not found.

        Rows that meet all so far are left out, and the others refuted.
        """
        limit = round(MOST_GROUPS * self.graph.effort)
        masks = [mask_of(group.rows) for group in family]
        while most <= MOST_LEFT_OUT and len(family) < limit:
            out = transversal(masks, most)
            if out is None:
                return family
            group = self.graph.points.refutation(e, list(rows_of(rows & ~out)))
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
