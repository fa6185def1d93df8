"""Weights that refute rows for all scales of a range: proposals, as all of `refuting`.

With X = sum w |x|^2 and Y = sum w |y|^2 about means and l the largest eigenvalue of Davenport's
matrix, the least sum of w r^2 at a scale s is s^2 X + Y - 2 s l: convex in s, and least at l/X.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.certificate.refuting import MARGIN, PointRows, davenport_stack
from certreg.geometry import rotation_matrices

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from certreg.certificate.consensus import Group


@dataclass(frozen=True, eq=False)
class ScaledRows(PointRows):
    """Points and bounds, each cloud in a unit of its own, and scales from low to high."""

    low: float
    high: float

    def refutation(self, row: int, rows: Sequence[int]) -> Group | None:
        """As of a rigid motion, in NumPy: the compiled code knows no scale."""
        return self._refutation(row, rows)

    def _tried(
        self, picked: NDArray[np.int64], weights: NDArray[np.float64]
    ) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
        """(G,) whether weights (G, m) refute, and (G, m) squared residuals at the best motions."""
        first = picked[0]
        x, y = self.source[picked] - self.source[first], self.target[picked] - self.target[first]
        total, load = weights.sum(axis=1)[:, None, None], weights[:, :, None]
        x = x - (load * x).sum(axis=1, keepdims=True) / total
        y = y - (load * y).sum(axis=1, keepdims=True) / total
        here, there = ((load * p * p).sum(axis=(1, 2)) for p in (x, y))
        values, vectors = np.linalg.eigh(davenport_stack(np.swapaxes(load * y, 1, 2) @ x))
        level = np.maximum(values[:, 3], 0.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            best = np.where(here > 0.0, level / here, self.low)
        scale = np.clip(best, self.low, self.high)
        bound = (weights * self.bounds[picked] ** 2).sum(axis=1)
        least = scale * scale * here + there - 2.0 * scale * level
        good = least - bound > MARGIN * (scale * scale * here + there + bound)
        rotations = rotation_matrices(np.ascontiguousarray(vectors[:, :, 3]))
        off = y - scale[:, None, None] * (x @ np.swapaxes(rotations, 1, 2))
        return good, (off * off).sum(axis=2)
