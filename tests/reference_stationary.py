"""Stationary poses of many small problems in NumPy: what native/stationary.c is held against.

Sums are taken in another order, and the Hessian is the generated one, run by Python.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.geometry.so3 import davenport_matrix, rotation_matrix
from certreg.native.layout import MEANS, SPREADS, named
from certreg.native.stationary import StationaryPoses

if TYPE_CHECKING:
    from collections.abc import Callable

    from certreg.native.stationary import ManyClouds

Array = Any  # NDArray[np.float64]
UPPER = (slice(None), *np.triu_indices(3))


def stationary_poses(
    clouds: ManyClouds, hessians: Callable[[Array, Array], Array]
) -> StationaryPoses:
    """What doubles say of each problem.

    hessians: the generated function; (count, 3, 3) of unit quaternions (count, 4) and C (count, 9).
    """
    with np.errstate(all="ignore"):
        w, _ = _scaled(clouds.weights)
        source, target = (_Deviations(c, w) for c in (clouds.sources, clouds.targets))
        cross, _ = _products(target, source)
        scatter, source_spread = _products(source, source)
        target_scatter, target_spread = _products(target, target)
        davenport = np.moveaxis(np.array(davenport_matrix(_entries(cross))), -1, 0)
        values, vectors = _eigenbasis(davenport)
        spreads = (source_spread, target_spread, np.trace(target_scatter, axis1=1, axis2=2))
        exponents = np.column_stack(_same(source.exponents, target.exponents))
        turns = np.moveaxis(
            np.array(rotation_matrix(list(np.moveaxis(vectors, 2, 0)))), (0, 1), (2, 3)
        )
        arrays = {
            "means": named(np.column_stack(_same(source.means, target.means)), MEANS),
            "cross": cross.reshape(-1, 9),
            "scatter": scatter[UPPER],
            "spreads": named(np.column_stack(_same(*spreads)), SPREADS),
            "values": values,
            "vectors": vectors,
            "residual": _residual(davenport, values, vectors),
            "ratios": _ratios(cross, scatter, vectors, hessians),
            "translations": target.means[:, None]
            - (turns @ source.means[:, None, :, None])[..., 0],
            "rmse": _errors(source, target, exponents, turns[:, 0], values),
        }
        return StationaryPoses(
            exponents=np.broadcast_to(exponents, (clouds.count, 2)).astype(np.int32),
            **{name: _of_each(array, clouds.count) for name, array in arrays.items()},
        )


class _Deviations:
    """Points over a power of two and shifted by nearly their mean; what is left of the mean."""

    def __init__(self, points: Array, w: Array) -> None:
        self.mass = w.sum(axis=1)[:, np.newaxis]
        self.shares = w / self.mass
        shift = (self.shares[:, np.newaxis] @ points)[:, 0]
        unit, self.exponents = _scaled(points.reshape(len(points), -1))
        unit = unit.reshape(points.shape)
        near = np.ldexp(shift, -self.exponents[:, np.newaxis])
        self.points = unit - near[:, np.newaxis]
        self.weighted = w[:, :, np.newaxis] * self.points
        self.rest = self.weighted.sum(axis=1) / self.mass
        self.means = shift + np.ldexp(self.rest, self.exponents[:, np.newaxis])


def _scaled(rows: Array) -> tuple[Array, Array]:
    """Each row over a power of two, its largest entry in [1/2, 1) then; the exponents."""
    exponents = np.frexp(np.abs(rows).max(axis=1))[1]
    return np.ldexp(rows, -exponents[:, np.newaxis]), exponents


def _products(left: _Deviations, right: _Deviations) -> tuple[Array, Array]:
    """The mean of left right^T about the means (count, 3, 3); its trace about the shifts."""
    raw = (left.weighted.mT @ right.points) / left.mass[:, np.newaxis]
    centred = raw - left.rest[:, :, np.newaxis] * right.rest[:, np.newaxis]
    return centred, np.trace(raw, axis1=1, axis2=2)


def _entries(matrices: Array) -> Any:
    """(count, 3, 3) as 3 x 3 arrays: what the formulas take for numbers."""
    return np.moveaxis(matrices, 0, -1)


def _eigenbasis(matrices: Array) -> tuple[Array, Array]:
    """Eigenvalues (count, 4) and unit eigenvectors as rows (count, 4, 4), descending."""
    sound = np.isfinite(matrices).all(axis=(1, 2))
    values, vectors = np.linalg.eigh(np.where(sound[:, np.newaxis, np.newaxis], matrices, 0.0))
    rows = vectors[:, :, ::-1].mT
    first = np.take_along_axis(rows, (rows != 0.0).argmax(axis=2)[..., np.newaxis], axis=2)
    rows = np.where(first < 0.0, -rows, rows)
    values[~sound], rows[~sound] = np.nan, np.nan
    return values[:, ::-1], rows


def _residual(davenport: Array, values: Array, vectors: Array) -> Array:
    """|K V - V L| + |V^T V - I| (|K| + |L|), Frobenius norms, (count,)."""
    moved = davenport @ vectors.mT - vectors.mT * values[:, np.newaxis]
    skew = vectors @ vectors.mT - np.eye(4)
    sizes = _norm(davenport) + np.sqrt((values * values).sum(axis=1))
    return _norm(moved) + _norm(skew) * sizes


def _norm(matrices: Array) -> Array:
    return np.sqrt((matrices * matrices).sum(axis=(1, 2)))


def _ratios(
    cross: Array, scatter: Array, vectors: Array, hessians: Callable[[Array, Array], Array]
) -> Array:
    """Eigenvalues of T^-1 G T^-T with J = T T^T, (count, 4, 3), ascending."""
    inertia = np.trace(scatter, axis1=1, axis2=2)[:, np.newaxis, np.newaxis] * np.eye(3) - scatter
    factors, definite = _cholesky(inertia)
    cross, factors, definite = _same(cross.reshape(-1, 9), factors, definite)
    curvatures = hessians(vectors.reshape(-1, 4), np.repeat(cross, 4, axis=0))
    factors = np.repeat(factors, 4, axis=0)
    pencils = _solved(factors, _solved(factors, curvatures).mT).reshape(-1, 4, 3, 3)
    sound = definite & np.isfinite(pencils).all(axis=(1, 2, 3))
    ratios = np.linalg.eigvalsh(np.where(sound[:, None, None, None], pencils, 0.0))
    return np.where(sound[:, None, None], ratios, np.nan)


def _solved(left: Array, right: Array) -> Array:
    solution: Any = np.linalg.solve(np.asarray(left, dtype=float), np.asarray(right, dtype=float))
    return solution


def _cholesky(matrices: Array) -> tuple[Array, Array]:
    """Lower factors (count, 3, 3), and where the pivots are positive; elsewhere the identity."""
    (a, _, _), (b, d, _), (c, e, f) = _entries(matrices)
    p = np.sqrt(a)
    q, r = b / p, c / p
    s = np.sqrt(d - q * q)
    t = (e - q * r) / s
    u = np.sqrt(f - r * r - t * t)
    zero = np.zeros_like(a)
    factors = np.moveaxis(np.array([[p, zero, zero], [q, s, zero], [r, t, u]]), -1, 0)
    definite = np.isfinite(factors).all(axis=(1, 2)) & (p > 0.0) & (s > 0.0) & (u > 0.0)
    return np.where(definite[:, None, None], factors, np.eye(3)), definite


def _errors(
    source: _Deviations, target: _Deviations, exponents: Array, turns: Array, values: Array
) -> Array:
    """Root mean squares (count, 4): by residuals at the first pose, by the energy at the others."""
    largest = exponents.max(axis=1, keepdims=True)
    units = np.ldexp(1.0, exponents - largest)
    x = (source.points - source.rest[:, np.newaxis]) * units[:, None, :1]
    y = (target.points - target.rest[:, np.newaxis]) * units[:, None, 1:]
    off = y - x @ turns.mT
    square = (source.shares * (off * off).sum(axis=2)).sum(axis=1, keepdims=True)
    losses = 2.0 * (values[:, :1] - values) * units.prod(axis=1, keepdims=True)
    return np.ldexp(np.sqrt(square + losses), largest)


def _same(*arrays: Array) -> list[Array]:
    """Arrays of one length: those of length one repeated."""
    count = max(map(len, arrays))
    return [_of_each(array, count) for array in arrays]


def _of_each(array: Array, count: int) -> Array:
    return np.broadcast_to(array, (count, *array.shape[1:]))
