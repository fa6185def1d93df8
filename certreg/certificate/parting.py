"""Striking two rows that no motion meets together that meets enough: where single rows stay.

A motion that meets two rows and K - 2 others meets a clique of K - 2 among their common neighbours.
So they are neighbours no longer where these take too few colours, or where too few go together of
those that may be met at one turn about the two, whatever the turn.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.certificate.consensus import Strike
from certreg.certificate.turning import sets_of, turned
from certreg.native.bit_rows import rows_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from certreg.certificate.thinning import GraphThinning

MOST_STRUCK = 5000  # pairs of rows: each is four of the 50,000 commas and brackets of a certificate
MOST_TURNED = 400  # pairs of rows that are tried by turns and stay, at effort 1: 0.1 ms each


class Parting:
    """Strikes pairs of rows one of which is open: left by a thinning, and not of its clique."""

    def __init__(self, thinning: GraphThinning) -> None:
        self._thinning = thinning
        self._left = round(MOST_TURNED * thinning.graph.effort)
        self._struck = 0
        self._stayed = dict[tuple[int, int], int]()

    def run(self, rows: int = -1) -> bool:
        """Tries the pairs with one of these rows, as bits; whether one fell."""
        return self._strike(rows, self._few_colours) or self._strike(rows, self._few_at_each_turn)

    def _strike(self, rows: int, proof: Callable[[int, int, int], bool]) -> bool:
        """Tries all pairs once; whether one fell."""
        thinning, struck = self._thinning, False
        for e, f in self._pairs(rows):
            if self._struck == MOST_STRUCK:
                break
            if proof(e, f, thinning.beside(e) & thinning.beside(f)):
                self._struck += 1
                thinning.strike(Strike(struck=(e, f)))
                struck = True
        return struck

    def _pairs(self, rows: int) -> Iterator[tuple[int, int]]:
        """Neighbours, those of rows with few of them first, while a row is open."""
        thinning = self._thinning
        for e in [e for e in thinning.open_rows() if rows >> e & 1]:
            for f in rows_of(thinning.beside(e)):
                if thinning.closed:
                    return
                if thinning.alive >> e & 1 and thinning.beside(e) >> f & 1:
                    yield e, f

    def _few_colours(self, _e: int, _f: int, beside: int) -> bool:
        return self._few(beside)

    def _few_at_each_turn(self, e: int, f: int, beside: int) -> bool:
        """Not tried where so many are of the clique that a motion may meet them and these two."""
        thinning, pair = self._thinning, (min(e, f), max(e, f))
        if not thinning.graph.rigid or self._left == 0 or self._stayed.get(pair) == beside:
            return False
        if (beside & thinning.clique).bit_count() <= thinning.least - 3:
            rows = list(rows_of(beside))
            turns = turned(thinning.graph.points, e, f, rows)
            if turns is not None and all(map(self._few, sets_of(turns, rows, thinning.least - 2))):
                return True
            self._left -= 1
        self._stayed[pair] = beside
        return False

    def _few(self, rows: int) -> bool:
        """Whether they take fewer colours than there must be rows beside two."""
        thinning = self._thinning
        most = thinning.least - 3
        if (rows & thinning.clique).bit_count() > most:
            return False
        return thinning.colours(rows, most) <= most
