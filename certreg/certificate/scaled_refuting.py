"""Weights that refute rows for all scales of a range: proposals, as all of `refuting`.

With X = sum w |x|^2 and Y = sum w |y|^2 about means and l the largest eigenvalue of Davenport's
matrix, the least sum of w r^2 at a scale s is s^2 X + Y - 2 s l: convex in s, and least at l/X.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.certificate.refuting import PointRows

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.certificate.consensus import Group
    from certreg.certificate.refuting import Reals


@dataclass(frozen=True, eq=False)
class ScaledRows(PointRows):
    """Points and bounds, each cloud in a unit of its own, and scales from low to high."""

    low: float
    high: float

    def refutation(self, row: int, rows: Sequence[int]) -> Group | None:
        """As of a rigid motion, in NumPy: the compiled code knows no scale."""
        return self._refutation(row, rows)

    def _scaled(self, x: Reals, y: Reals, load: Reals, level: Reals) -> tuple[Reals, Reals]:
        """Of a rigid motion the scale is 1; here it is the best of the range."""
        here, there = ((load * p * p).sum(axis=(1, 2)) for p in (x, y))
        with np.errstate(divide="ignore", invalid="ignore"):
            best = np.where(here > 0.0, level / here, self.low)
        scale = np.clip(best, self.low, self.high)
        return scale, scale * scale * here + there
