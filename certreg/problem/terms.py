"""What data add to the energy of a motion: pairs of points, each with its spring."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from certreg.errors import InvalidProblemError
from certreg.results import Brief

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

NO_WEIGHTS = (
    "this problem has general springs, a matrix for every pair and not a weight: what was asked is "
    "for weights only"
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pairs(Brief):
    """Pairs of points, contiguous: the energy is the sum of (y - R x - t)^T W (y - R x - t).

    source, target: (k, 3). springs: (k,), weights, W = w I, or (k, 6), factors, W = L L^T.
    """

    source: NDArray[np.float64]
    target: NDArray[np.float64]
    springs: NDArray[np.float64]

    @property
    def weights(self) -> NDArray[np.float64]:
        """(k,). Raises InvalidProblemError of factors."""
        if self.springs.ndim != 1:
            raise InvalidProblemError(NO_WEIGHTS, array="weights")
        return self.springs

    @property
    def arrays(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Source, target, springs: what states the energy."""
        return self.source, self.target, self.springs

    def rows(self, which: slice) -> Pairs:
        """Some of these pairs."""
        source, target, springs = (array[which] for array in self.arrays)
        return Pairs(source=source, target=target, springs=springs)
