"""Weighted pairs of points in floating point, and the best rigid motions between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg._loading import cached_property
from certreg.geometry.so3 import is_reflection
from certreg.problem.posing import PosedPairs

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RigidMotion:
    """x to R x + t."""

    rotation: NDArray[np.float64]
    translation: NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, eq=False)
class WeightedPairs:
    """Pairs about the clouds' means, over powers of two: source (3, k), target (3, k), (k,)."""

    source: NDArray[np.float64]
    target: NDArray[np.float64]
    weights: NDArray[np.float64]

    @property
    def finite(self) -> bool:
        """Whether all numbers are, and some row has weight."""
        arrays = (self.source, self.target, self.weights)
        return all(bool(np.isfinite(array).all()) for array in arrays) and self.weights.sum() > 0

    def distances(self, motion: RigidMotion) -> NDArray[np.float64]:
        """(k,), |y - R x - t|."""
        residuals = motion.rotation @ self.source
        residuals += motion.translation[:, np.newaxis]
        residuals -= self.target
        residuals *= residuals
        return np.sqrt(residuals[0] + residuals[1] + residuals[2])

    @cached_property
    def _posed(self) -> PosedPairs | None:
        return PosedPairs.of(self.source.T, self.target.T)

    def best_motion(self, weights: NDArray[np.float64]) -> RigidMotion:
        """The best motion under these weights, in C.

        Where nothing is compiled, or numbers leave the doubles, by singular values; raises
        LinAlgError.
        """
        found = None if self._posed is None else self._posed.motion(weights)
        if found is None:
            return self.motion_by_singular_values(weights)
        return RigidMotion(rotation=found[0], translation=found[1])

    def motion_by_singular_values(self, weights: NDArray[np.float64]) -> RigidMotion:
        """The same by NumPy."""
        shares = weights / weights.sum()
        here, there = self.source @ shares, self.target @ shares
        cross = (self.target * shares) @ self.source.T - there[:, np.newaxis] * here
        left, _, right = np.linalg.svd(cross)
        rotation = left @ right
        if is_reflection(rotation):
            left[:, 2] = -left[:, 2]
            rotation = left @ right
        return RigidMotion(rotation=rotation, translation=there - rotation @ here)

    def paired(self, here: slice, there: slice) -> WeightedPairs:
        """Other pairs: these rows of the source, and these of the target with their weights."""
        source, target, weights = self.source[:, here], self.target[:, there], self.weights[there]
        return WeightedPairs(source=source, target=target, weights=weights)

    def second_moments(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(3,) each, without weights, over the trace of the source's."""
        count = self.source.shape[1]
        centred = (
            cloud - cloud.sum(axis=1, keepdims=True) / count for cloud in (self.source, self.target)
        )
        here, there = np.linalg.eigvalsh([cloud @ cloud.T for cloud in centred]).clip(min=0.0)
        return here / here.sum(), there / here.sum()

    def least_energy(self) -> float:
        """The least sum of w |y - R x - t|^2."""
        return float(self.weights @ self.distances(self.best_motion(self.weights)) ** 2)
