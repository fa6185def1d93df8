"""Weights that show that no motion meets all pairs of a group, found in doubles.

With weights l_i >= 0 of the rows of a group T, X = sum l |x|^2 and Y = sum l |y|^2 about means and
l1 the largest eigenvalue of Davenport's matrix, every motion with the scale s has sum l_i r_i^2 >=
s^2 X + Y - 2 s l1: convex in s, and least at l1/X. If that is more than sum l_i b_i^2 for all
scales of a range, no motion meets all of T; a rigid one has s = 1. The best weights belong to the
motion of least largest r_i / b_i; Lawson's method finds them: each weight times the residual that
it leaves.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from certreg._loading import cached_property
from certreg.certificate.consensus import Group
from certreg.geometry.so3 import davenport_matrices, rotation_matrices
from certreg.native.lawson import LawsonColumns

Reals = NDArray[np.float64]

# What follows stands in native/lawson.c, too.
ROUNDS = 100  # of reweighting: five are usual, more where the least largest residual is near 1
WEIGHT_MAX = 65535  # integers, so that a group takes few bytes; 255 miss refutations of one percent
SIZES = (3, 4, 5, 6, 8, 12, 20, 40)  # of the heaviest rows of a group, which may do without others
# Of n <= 4,096 rows, sums of products of differences err by n 2^-51 of S, the eigenvalue by 2^-47.
MARGIN = 1e-9


@dataclass(frozen=True, eq=False)
class PointRows:
    """Points (N, 3) and bounds (N,) in doubles, and scales from low to high."""

    source: Reals
    target: Reals
    bounds: Reals
    low: float = 1.0
    high: float = 1.0

    def refutation(self, row: int, rows: Sequence[int]) -> Group | None:
        """Few of the rows, and weights that refute them together with the row.

        None where none were found: mostly because a motion meets them all.
        """
        if (columns := self._columns) is None:
            return self._refutation(row, rows)
        refuted = columns.refuted([row, *rows])
        if refuted is None:
            return None
        return Group(rows=tuple(refuted.rows[1:]), weights=tuple(refuted.weights))

    @cached_property
    def _columns(self) -> LawsonColumns | None:
        """None where there is a scale, which C does not know."""
        if not self.low == self.high == 1.0:
            return None
        return LawsonColumns(self.source.T, self.target.T, self.bounds)

    def _refutation(self, row: int, rows: Sequence[int]) -> Group | None:
        """The same in NumPy."""
        picked, best = np.array([row, *rows]), None
        while (weights := self._weights(picked)) is not None:
            kept = self._heaviest(picked, weights)
            picked = picked[kept]
            whole = weights[kept].astype(int).tolist()
            best = Group(rows=tuple(picked[1:].tolist()), weights=tuple(whole))
            if len(kept) == len(weights):
                break
        return best

    def _weights(self, picked: NDArray[np.int64]) -> NDArray[np.float64] | None:
        """Integers that refute the rows, by Lawson's method; None where none were found."""
        squares = self.bounds[picked] ** 2
        shares = np.ones(len(picked))
        for _ in range(ROUNDS):
            whole = _whole(shares / squares)
            good, residuals = self._tried(picked, whole[None])
            if good[0]:
                return whole
            ratios = residuals[0] / squares
            if ratios.max() <= 1.0:  # perhaps 0: a motion fits all of them exactly
                return None
            shares = shares * np.sqrt(ratios)
            shares /= shares.max()
        return None

    def _heaviest(
        self, picked: NDArray[np.int64], weights: NDArray[np.float64]
    ) -> NDArray[np.int64]:
        """The first place, and so few of those with the most weight that they refute still."""
        order = 1 + np.argsort(-weights[1:] * self.bounds[picked[1:]] ** 2, kind="stable")
        sizes = [size for size in SIZES if size < len(order)]
        fewer = np.zeros((len(sizes), len(picked)))
        for k, size in enumerate(sizes):
            places = [0, *order[:size].tolist()]
            fewer[k, places] = weights[places]
        if sizes:
            good, _ = self._tried(picked, fewer)
            for k in np.flatnonzero(good).tolist():
                return np.array([0, *order[: sizes[k]].tolist()])
        return np.arange(len(picked))

    def _tried(
        self, picked: NDArray[np.int64], weights: NDArray[np.float64]
    ) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
        """(G,) whether weights (G, m) refute, and (G, m) squared residuals at the best motions."""
        first = picked[0]
        x, y = self.source[picked] - self.source[first], self.target[picked] - self.target[first]
        total, load = weights.sum(axis=1)[:, None, None], weights[:, :, None]
        x = x - (load * x).sum(axis=1, keepdims=True) / total
        y = y - (load * y).sum(axis=1, keepdims=True) / total
        values, vectors = np.linalg.eigh(davenport_matrices(np.swapaxes(load * y, 1, 2) @ x))
        level = np.maximum(values[:, 3], 0.0)
        scale, squares = self._scaled(x, y, load, level)
        bound = (weights * self.bounds[picked] ** 2).sum(axis=1)
        good = squares - 2.0 * scale * level - bound > MARGIN * (squares + bound)
        rotations = rotation_matrices(np.ascontiguousarray(vectors[:, :, 3]))
        off = y - scale[:, None, None] * (x @ np.swapaxes(rotations, 1, 2))
        return good, (off * off).sum(axis=2)

    def _scaled(self, x: Reals, y: Reals, load: Reals, level: Reals) -> tuple[Reals, Reals]:
        """(G,) scales of the best motions, and (G,) the squares of both clouds at them."""
        here, there = ((load * p * p).sum(axis=(1, 2)) for p in (x, y))
        with np.errstate(divide="ignore", invalid="ignore"):
            best = np.where(here > 0.0, level / here, self.low)
        scale = np.clip(best, self.low, self.high)
        return scale, scale * scale * here + there


def _whole(weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Next integers above, the largest WEIGHT_MAX."""
    return np.ceil(weights * (WEIGHT_MAX / weights.max()))
