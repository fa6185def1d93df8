"""Rows struck from a graph and its cliques, in Python's integers: what C is held against."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from certreg.native.bitset_graph import WORD_BITS, BitRows, OpenRow, colours, mask_of, rows_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray


def bit_rows(near: Sequence[int]) -> BitRows:
    """Of the neighbours of each row as bits of an integer."""
    size = 8 * max(1, -(-len(near) // WORD_BITS))
    packed = b"".join([mask.to_bytes(size, "little") for mask in near])
    return BitRows(np.frombuffer(packed, dtype="<u8").reshape(len(near), size // 8))


class PlainThinned:
    """As `Thinned`, in Python's integers."""

    def __init__(self, given: BitRows, alive: int, least: int, clique: int) -> None:
        self._near, self._least, self._clique = [*given.integers], least, clique
        self._failed: dict[int, int] = {}
        self.alive = linked(self._near, alive, least, alive)

    @property
    def near(self) -> BitRows:
        """The graph, without the pairs that were cut."""
        return bit_rows(self._near)

    def beside(self, row: int) -> int:
        """The neighbours of a row that are left, as bits."""
        return self._near[row] & self.alive

    def strike(self, row: int) -> None:
        """Strikes a row, and then those with too few neighbours."""
        self.alive = linked(self._near, self.alive & ~(1 << row), self._least, self._near[row])

    def cut(self, row: int, other: int) -> None:
        """Two neighbours are none any more."""
        self._near[row] &= ~(1 << other)
        self._near[other] &= ~(1 << row)
        self._failed.clear()
        self.alive = linked(self._near, self.alive, self._least, 1 << row | 1 << other)

    def strike_by_colours(self) -> list[int]:
        """Strikes rows whose neighbours take few colours."""
        struck, before = list[int](), -1
        while before < len(struck):
            before = len(struck)
            for row in self._alive_rows():
                if self._few_colours(row):
                    struck.append(row)
                    self.strike(row)
        return struck

    def open_rows(self) -> Iterator[OpenRow]:
        """Rows that fall if enough of the clique beside each must be left out."""
        for row in self._alive_rows():
            beside, others = self.beside(row), self._least - 1
            inside = (beside & self._clique).bit_count()
            if inside:
                others = colours(beside & ~self._clique, self._near, self._least - 2)
            spare = inside + others - (self._least - 1)
            if 0 <= spare < inside:
                yield OpenRow(row, spare)

    def _alive_rows(self) -> Iterator[int]:
        tried = rows_of(self.alive & ~self._clique)
        for row in sorted(tried, key=lambda e: self.beside(e).bit_count()):
            if self.alive.bit_count() < self._least:
                return
            if self.alive >> row & 1:
                yield row

    def colours(self, rows: int, most: int) -> int:
        """How many colours rows take; or most + 1."""
        return colours(rows, self._near, most)

    def _few_colours(self, row: int) -> bool:
        beside, most = self.beside(row), self._least - 2
        if self._failed.get(row) == beside or (beside & self._clique).bit_count() > most:
            return False
        if colours(beside, self._near, most) <= most:
            return True
        self._failed[row] = beside
        return False


def linked(near: Sequence[int], alive: int, least: int, touched: int) -> int:
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


def plain_greedy_clique(near: BitRows, alive: int, row: int) -> list[int]:
    """A clique that holds a row: the neighbour of most that are left is taken, again and again."""
    return sorted(_greedily(near.integers, alive, row))


def _greedily(near: list[int], alive: int, row: int) -> list[int]:
    clique, left = [row], near[row] & alive
    while left:
        counts = [((near[e] & left).bit_count(), -e) for e in rows_of(left)]
        best = -max(counts)[1]
        clique.append(best)
        left &= near[best]
    return clique


class PlainEnumeration:
    """As `Enumeration`, without recursion: a clique may have a thousand rows."""

    def __init__(self, near: BitRows, size: int, steps: int, dear: int) -> None:
        self._near, self._size, self.steps, self._dear = near.integers, size, steps, dear
        self._path: list[int] = []
        self._left = [(1 << len(near)) - 1]  # after each row of the path: which rows may follow

    def some(self, most: int) -> NDArray[np.int64]:
        """The next cliques."""
        found: list[list[int]] = []
        while self._left and len(found) < most:
            self.steps -= 1
            if self.steps < 0:
                break
            missing = self._size - len(self._path)
            if self._left[-1].bit_count() < missing:
                self._left.pop()
                if self._path:
                    self._path.pop()
                continue
            row = (self._left[-1] & -self._left[-1]).bit_length() - 1
            self._left[-1] ^= 1 << row
            if missing == 1:
                self.steps -= self._dear
                found.append([*self._path, row])
                continue
            self._path.append(row)
            self._left.append(self._left[-1] & self._near[row])
        return np.array(found, dtype=np.int64).reshape(-1, self._size)
