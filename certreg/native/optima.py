"""Optima of many small problems, proved by native/certifying.c: the arrays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ProvedOptima:
    """What is proved of each problem; where it is not, and `proved` is False, nothing stands.

    quaternions: (count, 4) integers (w, x, y, z), of the rotation that is optimal.
    mu, delta, sine: (count, 2), mantissas of 32 bits and exponents, as in a certificate; sine is of
        sin^2 of half the angle to the optimum. K has four eigenvalues there.
    poses: (count, 4, 4), that rotation and its best translation in doubles.
    """

    quaternions: NDArray[np.int64]
    mu: NDArray[np.int64]
    delta: NDArray[np.int64]
    sine: NDArray[np.int64]
    poses: NDArray[np.float64]
    proved: NDArray[np.bool_]

    @classmethod
    def none(cls, count: int) -> ProvedOptima:
        """Nothing is proved yet of so many problems."""
        return cls(
            quaternions=np.zeros((count, 4), dtype=np.int64),
            mu=np.zeros((count, 2), dtype=np.int64),
            delta=np.zeros((count, 2), dtype=np.int64),
            sine=np.zeros((count, 2), dtype=np.int64),
            poses=np.zeros((count, 4, 4)),
            proved=np.zeros(count, dtype=np.bool_),
        )
