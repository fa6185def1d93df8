"""Striking two rows that no motion meets together that meets enough: where single rows stay.

A motion that meets two rows and K - 2 others meets a clique of K - 2 among their common neighbours.
So they are neighbours no longer where these take too few colours, or where too few go together of
those that may be met at one turn about the two, whatever the turn. Which these are is the rule of
`certreg.verify.turned`, here in doubles; what they leave open is not told.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from certreg.certificate.consensus import Strike
from certreg.native.bitset_graph import mask_of, rows_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.certificate.infeasibility_weights import PointRows
    from certreg.certificate.vertex_elimination import GraphThinning


MOST_STRUCK = 5000  # pairs of rows: each is four of the 50,000 commas and brackets of a certificate
MOST_TURNED = 400  # pairs of rows that are tried by turns and stay, at effort 1: 0.1 ms each


class Parting:
    """Strikes pairs of rows one of which is open: left by a thinning, and not of its clique."""

    def __init__(self, thinning: GraphThinning) -> None:
        self._thinning = thinning
        self._left = round(thinning.graph.turned * thinning.graph.effort)
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
            if proof(e, f, thinning.left.beside(e) & thinning.left.beside(f)):
                self._struck += 1
                thinning.strike(Strike(struck=(e, f)))
                struck = True
        return struck

    def _pairs(self, rows: int) -> Iterator[tuple[int, int]]:
        """Neighbours, those of rows with few of them first, while a row is open."""
        thinning = self._thinning
        for e in [e for e in thinning.open_rows() if rows >> e & 1]:
            for f in rows_of(thinning.left.beside(e)):
                if thinning.closed:
                    return
                if thinning.left.alive >> e & 1 and thinning.left.beside(e) >> f & 1:
                    yield e, f

    def _few_colours(self, _e: int, _f: int, beside: int) -> bool:
        return self._few(beside)

    def _few_at_each_turn(self, e: int, f: int, beside: int) -> bool:
        """Not tried where so many are of the clique that a motion may meet them and these two."""
        thinning, pair = self._thinning, (min(e, f), max(e, f))
        if self._left == 0 or self._stayed.get(pair) == beside:
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
        return thinning.left.colours(rows, most) <= most


# The checker's turns and frames: cosines and sines of 2 arctan(k / QUARTER) in each quarter.
QUARTER = 32
AXIS = np.array([17.0, 29.0, 43.0])
_TANGENTS = np.arange(QUARTER) / QUARTER
_COS = (1.0 - _TANGENTS**2) / (1.0 + _TANGENTS**2)
_SIN = 2.0 * _TANGENTS / (1.0 + _TANGENTS**2)
TURNS = np.array([np.r_[_COS, -_SIN, -_COS, _SIN], np.r_[_SIN, _COS, -_SIN, -_COS]])
# Differences of doubles err by 2^-53 of themselves; a frame by 2^-51 of 1 / LEAST_ACROSS.
LEAST_ACROSS = 2.0**-8
ERROR = 2.0**-40  # of squares, sums and products of what is of the size of |p|, |q|
TINY = 2.0**-400  # of the size of all: squares of what is smaller lose digits
TILT_ERROR = 2.0**-44  # of 4 sin^2(delta/2), where both lengths are above eps: 2^-49 of it


def turned(points: PointRows, e: int, f: int, rows: Sequence[int]) -> NDArray[np.bool_] | None:
    """(T, m): for each turn which of the rows a motion may meet with e and f.

    None where doubles cannot tell of every one, and where rows e and f are too near each other.
    """
    x, y, bounds = points.source, points.target, points.bounds
    a, b, reach = x[f] - x[e], y[f] - y[e], bounds[e] + bounds[f]
    long, wide = float(np.linalg.norm(a)), float(np.linalg.norm(b))
    if min(long, wide) <= max(reach, TINY):
        return None
    frames = _frame(a, long), _frame(b, wide)
    if frames[0] is None or frames[1] is None:
        return None
    tilt = (reach + long - wide) * (reach - long + wide) / (long * wide)
    others = list(rows)
    p, q = x[others] - x[e], y[others] - y[e]
    squares = (p * p).sum(axis=1), (q * q).sum(axis=1)
    short, all_squares = np.sqrt(np.minimum(*squares)), squares[0] + squares[1]
    own = bounds[others] + bounds[e]
    p, q = p @ frames[0].T, q @ frames[1].T
    left = p[:, 0] * q[:, 0] + p[:, 1] * q[:, 1]
    right = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
    values = np.stack([left, right], axis=1) @ TURNS
    allowed: list[NDArray[np.bool_]] = []
    for sign in (-1.0, 1.0):
        far = own + (np.sqrt(max(0.0, tilt + sign * TILT_ERROR)) + 1.0 / QUARTER) * short
        level = (all_squares - far * far) / 2.0 - p[:, 2] * q[:, 2]
        slack = sign * (ERROR * (all_squares + far * far) + TINY**2)
        allowed.append(values >= (level - slack)[:, None])
    return allowed[1].T if np.array_equal(allowed[0], allowed[1]) else None


def _frame(a: NDArray[np.float64], size: float) -> NDArray[np.float64] | None:
    """Three axes, one across the other, the last along a; None where the first is in doubt."""
    across = np.cross(a, AXIS)
    width = float(np.linalg.norm(across))
    if width <= LEAST_ACROSS * size * float(np.linalg.norm(AXIS)):
        return None
    beside = np.cross(a, across)
    return np.array([across / width, beside / np.linalg.norm(beside), a / size])


def sets_of(turns: NDArray[np.bool_], rows: Sequence[int], least: int) -> set[int]:
    """The different sets of at least so many rows, as bits."""
    different = np.unique(turns[turns.sum(axis=1) >= least], axis=0)
    return {mask_of([rows[k] for k in np.flatnonzero(one).tolist()]) for one in different}
