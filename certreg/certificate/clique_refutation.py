"""Striking a row by what would be met with it: cliques of its neighbours, and groups against each.

A motion that meets row e and K - 1 others meets a clique of these among its neighbours, and none of
the groups that are refuted with e as a whole. As long as there is such a clique, it is refuted with
e: that gives one group more. Where there is none any more, e falls; where a clique is not refuted,
e stays.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from certreg.certificate.consensus import Group, Strike
from certreg.native.bitset_graph import colours, mask_of, rows_of

if TYPE_CHECKING:
    from certreg.certificate.vertex_elimination import GraphThinning

MOST_CHOICES = 10_000  # of a row that is in or out, at effort 1: each takes 3 microseconds
MOST_GROUPS = 200  # of one row: the file grows by 30 bytes with each
MOST_IN_ALL = 1000  # groups: each is some 15 of the 50,000 commas and brackets of a certificate


class Assuming:
    """Strikes open rows of a thinning, as long as its effort lasts.

    given_up: rows that stay for want of it, as bits.
    """

    def __init__(self, thinning: GraphThinning) -> None:
        self._thinning = thinning
        self._choices = round(MOST_CHOICES * thinning.graph.effort)
        self._met: dict[int, int] = {}
        self._made = 0
        self.given_up = 0

    def run(self) -> bool:
        """Tries each row once; whether one fell."""
        thinning, struck, self.given_up = self._thinning, False, 0
        for e in thinning.open_rows():
            if thinning.closed:
                break
            if thinning.left.alive >> e & 1 and not self._is_met(e):
                groups = self._groups(e)
                if groups is not None:
                    thinning.strike(Strike(struck=e, groups=groups))
                    struck = True
        return struck

    def _is_met(self, e: int) -> bool:
        """Whether a clique that was not refuted with the row is still one of its neighbours."""
        clique, near = self._met.get(e), self._thinning.left.near
        if clique is None or clique & ~self._thinning.left.beside(e):
            return False
        return all(clique & ~(near[i] | 1 << i) == 0 for i in rows_of(clique))

    def _groups(self, e: int) -> tuple[Group, ...] | None:
        """The groups with which the row falls; None where it stays."""
        thinning, groups, sets = self._thinning, list[Group](), list[int]()
        search = CliqueAvoiding(thinning.left.near.integers, self._choices)
        most = min(MOST_GROUPS, MOST_IN_ALL - self._made)
        while len(groups) <= most and search.choices:
            clique = search.clique(thinning.left.beside(e), sets, thinning.least - 1)
            self._choices = search.choices
            if clique is None:
                if not search.choices:
                    break
                self._made += len(groups)
                return tuple(groups)
            group = thinning.graph.points.refutation(e, list(rows_of(clique)))
            if group is None:
                self._met[e] = clique
                return None
            groups.append(group)
            sets.append(mask_of(group.rows))
        self.given_up |= 1 << e
        return None


class CliqueAvoiding:
    """Searches a graph; choices: how many there may be yet, and none when it was given up."""

    def __init__(self, near: Sequence[int], choices: int) -> None:
        self._near = near
        self.choices = choices

    def clique(self, rows: int, sets: Sequence[int], count: int) -> int | None:
        """So many of the rows, each other's neighbours, that hold none of the sets as a whole.

        None where there are none, or none was found. Each row is in or out, as the checker does.
        """
        trail = [(rows, list(sets), count, 0)]
        while trail and self.choices:
            rows, sets, count, taken = trail.pop()
            self.choices -= 1
            for T in sets:
                if T & (T - 1) == 0:
                    rows &= ~T
            sets = [T for T in sets if T & ~rows == 0]
            if count <= 0:
                return taken
            if colours(rows, self._near, count - 1) >= count:
                low = rows & -rows
                trail.append((rows ^ low, sets, count, taken))
                beside = rows & self._near[low.bit_length() - 1]
                trail.append((beside, [T & ~low for T in sets], count - 1, taken | low))
        return None
