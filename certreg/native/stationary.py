"""Stationary poses of many small problems: the arrays that native/stationary.c reads and writes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.native.layout import MEANS, SPREADS, Records

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ManyClouds:
    """`count` problems of N points each; an array of length one is shared by all of them.

    sources, targets: (count or 1, N, 3); weights: (count or 1, N), not negative.
    """

    count: int
    sources: NDArray[np.float64]
    targets: NDArray[np.float64]
    weights: NDArray[np.float64]

    def part(self, chosen: slice) -> ManyClouds:
        """Some of the problems."""
        arrays = (self.sources, self.targets, self.weights)
        sources, targets, weights = (a if len(a) == 1 else a[chosen] for a in arrays)
        count = len(range(*chosen.indices(self.count)))
        return ManyClouds(count=count, sources=sources, targets=targets, weights=weights)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StationaryPoses:
    """What doubles say of each problem; source over 2^exponents[0], target over 2^exponents[1].

    The largest coordinate of a cloud is in [1/2, 1) then. All sums are divided by the mass.

    exponents: (count, 2). means: (count,) records MEANS of source and target, in the units given.
    cross: (count, 9), C row by row. scatter: (count, 6), the upper triangle of S2.
    spreads: (count,) records SPREADS, the mean squares of source and target about the points they
        were shifted by, and of the target about its mean.
    values: (count, 4), of the Davenport matrix, descending. vectors: (count, 4, 4), their
        unit eigenvectors (w, x, y, z) row by row, the first nonzero entry positive.
    residual: (count,), how far K is from having exactly these values.
    ratios: (count, 4, 3), eigenvalues of the pencil (G, J) at each vector, ascending; NaN where J
        is not positive definite to rounding.
    translations: (count, 4, 3), target from source, and rmse: (count, 4), sqrt(sum w r^2 / sum w),
        at each vector, in the units given: the first by its residuals, the others by the energy.
    Not a number, all of them, where a coordinate or a weight is not finite.
    """

    exponents: NDArray[np.int32]
    means: Records
    cross: NDArray[np.float64]
    scatter: NDArray[np.float64]
    spreads: Records
    values: NDArray[np.float64]
    vectors: NDArray[np.float64]
    residual: NDArray[np.float64]
    ratios: NDArray[np.float64]
    translations: NDArray[np.float64]
    rmse: NDArray[np.float64]

    @classmethod
    def empty(cls, count: int) -> StationaryPoses:
        """Room for so many problems."""
        return cls(
            exponents=np.empty((count, 2), dtype=np.int32),
            means=np.empty(count, dtype=MEANS),
            spreads=np.empty(count, dtype=SPREADS),
            **{name: np.empty((count, *shape)) for name, shape in SHAPES.items()},
        )


SHAPES = {
    "cross": (9,),
    "scatter": (6,),
    "values": (4,),
    "vectors": (4, 4),
    "residual": (),
    "ratios": (4, 3),
    "translations": (4, 3),
    "rmse": (4,),
}
