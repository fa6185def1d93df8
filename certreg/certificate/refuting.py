"""Weights that show that no rigid motion meets all pairs of a group, found in doubles.

With weights l_i >= 0 of the rows of a group T, every motion has sum l_i r_i^2 >= S - 2 l1, S the
centred squares of both clouds, l1 the largest eigenvalue of Davenport's matrix. If that is more
than sum l_i b_i^2, no motion meets all of T. The best weights belong to the motion of least largest
r_i / b_i; Lawson's method finds them: each weight times the residual that it leaves.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.geometry import rotation_matrices

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from certreg.problem import ConsensusProblem

ROUNDS = 10  # of reweighting: the weights of the few rows that matter have settled
WEIGHT_MAX = 255  # integers, so that a group takes few bytes
# Of n <= 4,096 rows, sums of products of differences err by n 2^-51 of S, the eigenvalue by 2^-47.
MARGIN = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class PointRows:
    """Points (N, 3) and bounds (N,) of a problem in doubles."""

    source: NDArray[np.float64]
    target: NDArray[np.float64]
    bounds: NDArray[np.float64]

    @classmethod
    def of(cls, problem: ConsensusProblem) -> PointRows:
        """Of a problem, in a unit of length near its size: a power of two, so without rounding."""
        block = problem.problem.block(slice(None))
        size = max(np.abs(block.source).max(), np.abs(block.target).max(), problem.bounds.max())
        one = 2.0 ** -int(np.frexp(size)[1])
        return cls(block.source * one, block.target * one, problem.bounds * one)

    def refutations(
        self, row: int, groups: Sequence[Sequence[int]]
    ) -> list[tuple[int, ...] | None]:
        """For each group weights, the row's own first, that refute it together with the row.

        None where none were found.
        """
        longest = max(map(len, groups))
        picked = np.full((len(groups), longest + 1), row)
        used = np.zeros(picked.shape, dtype=bool)
        used[:, 0] = True
        for k, group in enumerate(groups):
            picked[k, 1 : len(group) + 1] = group
            used[k, 1 : len(group) + 1] = True
        x = self.source[picked] - self.source[row]
        y = self.target[picked] - self.target[row]
        squares = self.bounds[picked] ** 2
        found: list[tuple[int, ...] | None] = [None] * len(groups)
        open_groups = list(range(len(groups)))
        weights = used / squares
        for _ in range(ROUNDS):
            share = weights * squares
            weights = share / share.max(axis=1, keepdims=True) / squares
            top = weights.max(axis=1, keepdims=True)
            whole = np.ceil(weights * (WEIGHT_MAX / top))
            good, residuals = _refuted(x, y, squares, whole)
            for k in np.flatnonzero(good).tolist():
                count = len(groups[open_groups[k]]) + 1
                found[open_groups[k]] = tuple(whole[k, :count].astype(int).tolist())
            weights *= np.sqrt(residuals / squares)
            keep = ~good & weights.any(axis=1)  # without weights: a motion fits all of them exactly
            if not keep.any():
                break
            open_groups = [k for k, still in zip(open_groups, keep.tolist(), strict=True) if still]
            x, y, squares, weights = (part[keep] for part in (x, y, squares, weights))
        return found


def _refuted(
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    squares: NDArray[np.float64],
    weights: NDArray[np.float64],
) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """(G,) whether the weights (G, m) refute, and (G, m) squared residuals at the best motion."""
    total = weights.sum(axis=1)[:, None, None]
    load = weights[:, :, None]
    x = x - (load * x).sum(axis=1, keepdims=True) / total
    y = y - (load * y).sum(axis=1, keepdims=True) / total
    spread = (load * (x * x + y * y)).sum(axis=(1, 2))
    values, vectors = np.linalg.eigh(davenport_stack(np.swapaxes(load * y, 1, 2) @ x))
    bound = (weights * squares).sum(axis=1)
    good = spread - 2.0 * values[:, 3] - bound > MARGIN * (spread + bound)
    rotations = rotation_matrices(np.ascontiguousarray(vectors[:, :, 3]))
    off = y - x @ np.swapaxes(rotations, 1, 2)
    return good, (off * off).sum(axis=2)


def davenport_stack(cross: NDArray[np.float64]) -> NDArray[np.float64]:
    """(G, 4, 4), Davenport's matrices of (G, 3, 3) matrices."""
    K = np.empty((len(cross), 4, 4))
    a, b, c = cross[:, 0, 0], cross[:, 1, 1], cross[:, 2, 2]
    K[:, 0, 0], K[:, 1, 1] = a + b + c, a - b - c
    K[:, 2, 2], K[:, 3, 3] = b - a - c, c - a - b
    for k, (i, j) in enumerate(((1, 2), (2, 0), (0, 1)), start=1):
        K[:, 0, k] = K[:, k, 0] = cross[:, j, i] - cross[:, i, j]
        K[:, i + 1, j + 1] = K[:, j + 1, i + 1] = cross[:, i, j] + cross[:, j, i]
    return K
