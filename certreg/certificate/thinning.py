"""Striking pairs that no motion meets that meets enough: what remains, and what shows it.

A motion that meets K pairs meets a clique of K in the graph of consistent pairs. So a row falls
that has fewer than K - 1 neighbours; or of whose neighbours too few can be met together with it: of
each colour one at most, of each group that is refuted with it all but one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.certificate.consensus import Group, Strike
from certreg.certificate.consistency import mask_of, rows_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from certreg.certificate.refuting import PointRows

SIZES = (3, 5, 8)  # of groups, tried in this order, and at last all rows in as few as will do
SHUFFLES = 4  # of the rows that are dealt into groups, for each size, at effort 1
MOST_GROUPS = 64  # refuted at a time


@dataclass(frozen=True, slots=True, eq=False)
class Graph:
    """Pairs that one motion may meet together, as bits; their points; how hard to try."""

    near: list[int]
    points: PointRows
    effort: float = 1.0


class Thinning:
    """What is left of `alive` that a motion that meets at least `least` of it can meet.

    clique: rows that are consistent with each other, dealt into groups. Where they are as many as
    `least` a motion that meets them may be there, and none of them is tried.
    """

    def __init__(self, graph: Graph, alive: int, least: int, clique: int) -> None:
        self._graph, self._least, self._clique = graph, least, clique
        self._spared = clique if clique.bit_count() >= least else 0
        self._random = np.random.default_rng(0)
        self.strikes: list[Strike] = []
        self.alive = linked(graph.near, alive, least)

    def run(self) -> None:
        """Strikes rows until none falls."""
        while self._strike(self._no_groups) or self._strike(self._groups):
            pass

    def _strike(self, proof: Callable[[int], tuple[Group, ...] | None]) -> bool:
        """Tries all rows once, those with few neighbours first; whether one fell."""
        near, struck = self._graph.near, False
        rows = sorted(
            rows_of(self.alive & ~self._spared),
            key=lambda e: (near[e] & self.alive).bit_count(),
        )
        for e in rows:
            if self.alive.bit_count() < self._least:
                return False
            if self.alive >> e & 1 and (groups := proof(e)) is not None:
                self.strikes.append(Strike(row=e, groups=groups))
                self.alive = linked(near, self.alive & ~(1 << e), self._least)
                struck = True
        return struck

    def _no_groups(self, e: int) -> tuple[Group, ...] | None:
        most = self._least - 2
        few = colours(self._graph.near[e] & self.alive, self._graph.near, most) <= most
        return () if few else None

    def _groups(self, e: int) -> tuple[Group, ...] | None:
        """Groups of the clique, each refuted with e, so many that e falls; None if not found.

        Of p rows of the clique beside e and m groups of them p - m are met, of the other rows at
        most as many as they have colours.
        """
        beside = self._graph.near[e] & self.alive
        rows = list(rows_of(beside & self._clique))
        others = colours(beside & ~self._clique, self._graph.near, self._least)
        needed = len(rows) + others - (self._least - 2)
        if not 0 < needed <= len(rows) // 2:
            return None
        found: list[Group] = []
        most = len(rows) // needed
        for size in sorted({min(size, most) for size in (*SIZES, most)}):
            for _ in range(max(1, round(SHUFFLES * self._graph.effort))):
                self._refute(e, rows, size, found, needed)
                if len(found) >= needed:
                    return tuple(found[:needed])
        return None

    def _refute(self, e: int, rows: list[int], size: int, found: list[Group], needed: int) -> None:
        """Adds groups of so many rows that are in no group yet, dealt at random."""
        used = {row for group in found for row in group.rows}
        free = self._random.permutation([row for row in rows if row not in used]).tolist()
        count = min(len(free) // size, max(2 * needed, 8), MOST_GROUPS)
        groups = [free[k * size : (k + 1) * size] for k in range(count)]
        if groups:
            weights = self._graph.points.refutations(e, groups)
            for group, weight in zip(groups, weights, strict=True):
                if weight is not None:
                    found.append(Group(rows=tuple(group), weights=weight))


def linked(near: list[int], alive: int, least: int) -> int:
    """Less those with fewer than `least` - 1 neighbours, until none is left that has so few."""
    while True:
        few = [i for i in rows_of(alive) if (near[i] & alive).bit_count() < least - 1]
        if not few:
            return alive
        alive &= ~mask_of(few)


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
