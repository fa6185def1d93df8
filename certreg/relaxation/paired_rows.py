"""Pairs of points with a bound each, and the poses that fit some of them, in floating point.

Both clouds are shifted to their medians, which a few wrong rows do not move, and scaled by a power
of two: an offset costs no digits, and squares neither overflow nor vanish.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from certreg.geometry.so3 import davenport_matrix

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Reals = NDArray[np.float64]
    Rows = NDArray[np.int64]

FAR = 1e60  # units: farther points are out of reach, bounds are between 1 / FAR and this

# Davenport's matrix is linear in C, and R(q)_ij is q^T of its part of C_ij, by its definition.
DAVENPORT = np.array(
    [davenport_matrix(one.reshape(3, 3).tolist()) for one in np.eye(9)], dtype=np.float64
).reshape(9, 16)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PairedRows:
    """The rows about their medians, in units of `unit`.

    rows: (N,), the numbers that they were given with. source, target: (3, N). bounds: (N,).
    features: (N, 16), each row's 1, x, y and y x^T, of which every weighted fit takes sums.
    source_centre, target_centre: (3,), in the unit of the clouds.
    """

    rows: Rows
    source: Reals
    target: Reals
    bounds: Reals
    features: Reals
    source_centre: Reals
    target_centre: Reals
    unit: float

    def __len__(self) -> int:
        return len(self.bounds)

    @property
    def precisions(self) -> Reals:
        """The weights (N,) that count distances in bounds."""
        return 1.0 / (self.bounds * self.bounds)

    def of(self, rows: Rows) -> PairedRows:
        """These rows alone, in the same unit and about the same centres."""
        return replace(
            self,
            rows=self.rows[rows],
            source=self.source[:, rows],
            target=self.target[:, rows],
            bounds=self.bounds[rows],
            features=self.features[rows],
        )


@dataclass(frozen=True, slots=True, eq=False)
class Poses:
    """Rigid motions y = R x + t of paired rows, in their unit and about their centres.

    rotations: (..., 3, 3), proper. translations: (..., 3).
    """

    rotations: Reals
    translations: Reals

    def __getitem__(self, index: int | Rows) -> Poses:
        return Poses(self.rotations[index], self.translations[index])


def paired_rows(source: Reals, target: Reals, bounds: Reals) -> PairedRows:
    """Points (N, 3) and (N, 3) with bounds (N,), centred and scaled, but for rows out of reach."""
    source_centre, target_centre = np.median(source, axis=0), np.median(target, axis=0)
    x, y = (source - source_centre).T, (target - target_centre).T
    unit = _unit(x, y, bounds)
    x, y = np.ascontiguousarray(x) / unit, np.ascontiguousarray(y) / unit
    rows = np.flatnonzero((np.maximum(np.abs(x), np.abs(y)) < FAR).all(axis=0))
    if len(rows) < len(bounds):
        x, y, bounds = x[:, rows], y[:, rows], bounds[rows]
    features = np.empty((len(bounds), 16))
    features[:, 0], features[:, 1:4], features[:, 4:7] = 1.0, x.T, y.T
    features[:, 7:] = (y[:, np.newaxis] * x).reshape(9, -1).T
    return PairedRows(
        rows=rows,
        source=x,
        target=y,
        bounds=np.clip(bounds / unit, 1.0 / FAR, FAR),
        features=features,
        source_centre=source_centre,
        target_centre=target_centre,
        unit=unit,
    )


def _unit(x: Reals, y: Reals, bounds: Reals) -> float:
    """A power of two near the usual distance from the centre, or what there is if that is 0."""
    sizes = [np.abs(points).max(axis=0) for points in (x, y)]
    usual = max(float(np.median(size)) for size in sizes)
    size = usual or max(float(size.max()) for size in sizes) or float(bounds.max())
    return math.ldexp(1.0, math.frexp(size)[1])


def fitted(pairs: PairedRows, weights: Reals) -> Poses:
    """The poses of least weighted squares, of weights (..., N) whose sums are positive.

    The rotation is the top eigenvector of Davenport's matrix: never a reflection.
    """
    sums = weights @ pairs.features
    means = sums[..., 1:7] / sums[..., :1]
    shift = means[..., 3:, np.newaxis] * sums[..., np.newaxis, 1:4]
    C = sums[..., 7:] - shift.reshape(*shift.shape[:-2], 9)
    K = (C @ DAVENPORT).reshape(*C.shape[:-1], 4, 4)
    q = np.linalg.eigh(K)[1][..., -1]
    products = (q[..., np.newaxis] * q[..., np.newaxis, :]).reshape(*q.shape[:-1], 16)
    R = (products @ DAVENPORT.T).reshape(*q.shape[:-1], 3, 3)
    t = means[..., 3:] - (R @ means[..., :3, np.newaxis])[..., 0]
    return Poses(R, t)


def squared_ratios(pairs: PairedRows, poses: Poses) -> Reals:
    """(|R x + t - y| / bound)^2 of each row, (..., N): at most 1 within the bound."""
    misses = poses.rotations @ pairs.source
    misses += poses.translations[..., np.newaxis]
    misses -= pairs.target
    misses *= misses
    ratios = misses.sum(axis=-2)
    ratios /= pairs.bounds * pairs.bounds
    return ratios


def poses_of_triples(pairs: PairedRows, triples: Rows) -> Poses:
    """The least-squares pose of each of B triples of rows, (B, 3)."""
    weights = np.zeros((len(triples), len(pairs)))
    np.put_along_axis(weights, triples, pairs.precisions[triples], axis=1)
    return fitted(pairs, weights)
