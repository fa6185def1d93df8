"""Stability of an equilibrium: Hessian, linearised dynamics, direction of escape.

At an eigenvector q_j of K the Hessian of the energy in the body frame is
G = 2 tr(R^T C) I - R^T C - C^T R, with eigenvalues l_j - l_k and eigenvectors L(q_j)^T q_k, k != j.
Translation decouples: each axis obeys s^2 + mu s + 2 = 0. Rotation obeys
det(s (s + mu) J + G) = 0, so with the eigenvalues g of the pencil (G, J), s^2 + mu s + g = 0.
Signs are never left to rounding: Sylvester's law of inertia (J > 0) gives the number of g that are
negative and zero, exactly, from the classification.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.geometry.so3 import body_frame

if TYPE_CHECKING:
    from numpy.typing import NDArray

DIGITS = 1e5  # an eigenvalue must exceed the rounding, cond(J) times an ulp, by that factor
WORST_CONDITION = 1e10  # of J: with it no eigenvalue would keep five digits
TRANSLATION_STIFFNESS = 2.0  # springs 2 w over masses w


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Curvature:
    """The Hessian G at an equilibrium, by its eigen-decomposition, in some unit of energy.

    values: (3,), l_j - l_k for k != j, exact zeros within the component.
    directions: (3, 3), unit columns in the body frame.
    """

    values: NDArray[np.float64]
    directions: NDArray[np.float64]

    @property
    def matrix(self) -> NDArray[np.float64]:
        """G, (3, 3)."""
        return (self.directions * self.values) @ self.directions.T

    @property
    def witness(self) -> NDArray[np.float64] | None:
        """The unit direction in which the energy falls fastest, None if it falls nowhere."""
        lowest = int(np.argmin(self.values))
        return self.directions[:, lowest] if self.values[lowest] < 0 else None


def curvature(q: NDArray[np.float64], others: NDArray[np.float64], gaps: list[float]) -> Curvature:
    """The curvature at unit quaternion q, `others` (3, 4) completing it to an eigenbasis.

    gaps: l(q) - l(other), one for each row of `others`.
    """
    frame = np.array(body_frame(tuple(q.tolist())))
    return Curvature(values=np.array(gaps), directions=(others @ frame).T)


def spring_ratios(
    curvatures: Sequence[Curvature], inertia: NDArray[np.float64]
) -> list[list[float] | None]:
    """For each equilibrium the eigenvalues g of the pencil (G, J), ascending, signs exact.

    None where double precision does not give five digits of each: J is too close to singular, or
    an eigenvalue too small beside the others.
    """
    values = np.linalg.eigvalsh(inertia)
    if not values[0] * WORST_CONDITION > values[-1]:
        return [None] * len(curvatures)
    factor = np.linalg.cholesky(inertia)
    halves = np.linalg.solve(factor, np.array([each.matrix for each in curvatures]))
    pencils = np.linalg.eigvalsh(np.linalg.solve(factor, halves.transpose(0, 2, 1)))
    rounding = float(np.finfo(float).eps * values[-1] / values[0])
    return [
        _signed(row, each, rounding) for row, each in zip(pencils.tolist(), curvatures, strict=True)
    ]


def _signed(ratios: list[float], at: Curvature, rounding: float) -> list[float] | None:
    """The ratios with the signs that Sylvester's law gives them; None where rounding drowns one."""
    gaps = at.values.tolist()
    negative, zero = sum(gap < 0.0 for gap in gaps), gaps.count(0.0)
    below, above = ratios[:negative], ratios[negative + zero :]
    least = max(map(abs, ratios)) * rounding * DIGITS
    if max(below, default=-math.inf) >= -least or min(above, default=math.inf) <= least:
        return None
    return [*below, *([0.0] * zero), *above]


def linearised_spectrum(
    ratios: Sequence[float], unit: float, damping: float
) -> NDArray[np.complex128] | None:
    """The 12 eigenvalues of the linearised dynamics, largest real part first, in 1/time.

    ratios: eigenvalues of the pencil in some unit. None where one does not fit the doubles.
    """
    springs = [unit * g for g in ratios]
    roots = [r for g in (*springs, *[TRANSLATION_STIFFNESS] * 3) for r in _oscillator(g, damping)]
    lost = sum(root == 0.0 for root in roots) != list(ratios).count(0.0)
    if lost or not np.isfinite(roots).all():
        return None
    return np.array(sorted(roots, key=lambda s: (-s.real, s.imag)), dtype=np.complex128)


def _oscillator(g: float, damping: float) -> tuple[complex, complex]:
    """The roots of s^2 + damping s + g; the small one as g / large, free of cancellation."""
    half = damping / 2.0
    discriminant = half * half - g
    if discriminant < 0.0:
        height = math.sqrt(-discriminant)
        return complex(-half, -height), complex(-half, height)
    large = -half - math.sqrt(discriminant)
    return complex(large), complex(g / large)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Oscillations:
    """The 12 eigenvalues of the linearised dynamics of many equilibria, as six damped springs.

    What `linearised_spectrum` finds for one, by the same operations in the same order.

    reals: (..., 6, 2), real parts of the two roots of each spring; the last three are those of the
        translation. heights: (..., 6), imaginary part of the second root, minus that of the first.
    """

    reals: NDArray[np.float64]
    heights: NDArray[np.float64]

    @classmethod
    def of(cls, ratios: NDArray[np.float64], damping: float) -> Oscillations:
        """From the spring ratios (..., 3); what is no number, or too large for one, stays so."""
        springs = np.empty((*ratios.shape[:-1], 6))
        springs[..., :3], springs[..., 3:] = ratios, TRANSLATION_STIFFNESS
        half = damping / 2.0
        with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
            discriminant = half * half - springs
            root = np.sqrt(np.abs(discriminant))
            swings = discriminant < 0.0
            reals = np.empty((*springs.shape, 2))
            reals[..., 0] = np.where(swings, -half, -half - root)
            reals[..., 1] = np.where(swings, -half, springs / reals[..., 0])
            return cls(reals=reals, heights=np.where(swings, root, 0.0))

    @property
    def growing(self) -> NDArray[np.intp]:
        """How many of the 12 have a positive real part, (...)."""
        return np.count_nonzero(self.reals > 0.0, axis=(-2, -1))

    @property
    def decaying(self) -> NDArray[np.intp]:
        """How many of the 12 have a negative real part, (...)."""
        return np.count_nonzero(self.reals < 0.0, axis=(-2, -1))

    @property
    def eigenvalues(self) -> NDArray[np.complex128]:
        """All of them, (..., 12), by descending real part, then ascending imaginary part."""
        roots = np.empty(self.reals.shape, dtype=np.complex128)
        roots.real = self.reals
        roots.imag[..., 0], roots.imag[..., 1] = -self.heights, self.heights
        flat = roots.reshape(*roots.shape[:-2], 12)
        return np.take_along_axis(flat, np.lexsort((flat.imag, -flat.real)), axis=-1)
