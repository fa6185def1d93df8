"""Moments of a problem: all that energies, forces and equilibria depend on.

The only place where the number of points appears. The potential energy is a polynomial of degree
two in the points, so sums of products of degree up to two are enough, whatever N is. Spring
matrices per point would add further sums here and change nothing below.

`ExactMoments` are integers: they decide. `Moments` are doubles, shifted and rescaled so that
offsets of 1e8 and scales of 1e+-150 cost no digits: they propose.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from operator import mul
from typing import TYPE_CHECKING

import numpy as np

from certreg.dyadic import power_of_two
from certreg.problem import lift

if TYPE_CHECKING:
    from fractions import Fraction

    from numpy.typing import NDArray

    from certreg.problem import RegistrationProblem
    from certreg.so3 import Matrix3, Vector3


@dataclass(frozen=True, kw_only=True)
class ExactMoments:
    """Sums over the points in integers, each times a power of two.

    With source = X 2^a, target = Y 2^b, weights = W 2^c (integers X, Y, W), summed over the points:

    mass = sum W                                            times 2^c
    source_sum = sum W X, target_sum = sum W Y              times 2^(c+a), 2^(c+b)
    cross = mass sum W Y X^T - target_sum source_sum^T      times 2^(2c+a+b): mass * C
    source_scatter = mass sum W X X^T - source_sum^2        times 2^(2c+2a): mass * S2
    target_scatter                                          times 2^(2c+2b)

    Products with the mass keep everything an integer: centring would divide by it.
    Source: [Yang2020], total force, total torque and energies.
    """

    n: int
    source_exponent: int
    target_exponent: int
    weight_exponent: int
    mass: int
    source_sum: Vector3[int]
    target_sum: Vector3[int]
    cross: Matrix3[int]
    source_scatter: Matrix3[int]
    target_scatter: Matrix3[int]

    @cached_property
    def cross_unit(self) -> Fraction:
        """What one unit of `cross` is worth as cross-covariance C: 2^(c+a+b) / mass."""
        exponent = self.weight_exponent + self.source_exponent + self.target_exponent
        return power_of_two(exponent) / self.mass

    @cached_property
    def spread(self) -> Fraction:
        """Sum of w |x - mean|^2 + w |y - mean|^2, in objective units: the scale of all energies."""
        c = self.weight_exponent
        source = trace(self.source_scatter) * power_of_two(c + 2 * self.source_exponent)
        target = trace(self.target_scatter) * power_of_two(c + 2 * self.target_exponent)
        return (source + target) / self.mass

    @cached_property
    def inertia(self) -> Matrix3[int]:
        """Integers times 2^(2c+2a): mass * J, J = tr(S2) I - S2, the inertia about the mean."""
        return inertia(self.source_scatter)

    @cached_property
    def total_weight(self) -> Fraction:
        """M, the sum of the weights, exactly."""
        return self.mass * power_of_two(self.weight_exponent)

    @property
    def source_centroid(self) -> tuple[Fraction, Fraction, Fraction]:
        """The weighted mean of the source, exactly."""
        return _centroid(self.source_sum, self.mass, self.source_exponent)

    @property
    def target_centroid(self) -> tuple[Fraction, Fraction, Fraction]:
        """The weighted mean of the target, exactly."""
        return _centroid(self.target_sum, self.mass, self.target_exponent)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Moments:
    """Sums over the points in doubles; lengths over 2^source_exponent and 2^target_exponent.

    mass: total weight over 2^weight_exponent.
    source_centroid, target_centroid: (3,), weighted means.
    cross_covariance: (3, 3), C = sum w (y - mean)(x - mean)^T.
    source_scatter: (3, 3), S2 = sum w (x - mean)(x - mean)^T.
    target_spread: sum w |y - mean|^2.
    """

    n: int
    source_exponent: int
    target_exponent: int
    weight_exponent: int
    mass: float
    source_centroid: NDArray[np.float64]
    target_centroid: NDArray[np.float64]
    cross_covariance: NDArray[np.float64]
    source_scatter: NDArray[np.float64]
    target_spread: float

    @property
    def inertia(self) -> NDArray[np.float64]:
        """(3, 3), J = tr(S2) I - S2, positive definite iff three points are not collinear."""
        return np.trace(self.source_scatter) * np.eye(3) - self.source_scatter


def exact_moments(problem: RegistrationProblem) -> ExactMoments:
    """The moments of a problem in integer arithmetic: no rounding anywhere."""
    source, target = lift(problem.source.ravel()), lift(problem.target.ravel())
    weights = lift(problem.weights)
    x = [source.integers[k::3] for k in range(3)]
    y = [target.integers[k::3] for k in range(3)]
    w = weights.integers
    mass = sum(w)
    wx = [list(map(mul, w, column)) for column in x]
    wy = [list(map(mul, w, column)) for column in y]
    source_sum = (sum(wx[0]), sum(wx[1]), sum(wx[2]))
    target_sum = (sum(wy[0]), sum(wy[1]), sum(wy[2]))
    return ExactMoments(
        n=problem.n,
        source_exponent=source.exponent,
        target_exponent=target.exponent,
        weight_exponent=weights.exponent,
        mass=mass,
        source_sum=source_sum,
        target_sum=target_sum,
        cross=_centred(mass, _products(wy, x), target_sum, source_sum),
        source_scatter=_centred(mass, _symmetric_products(wx, x), source_sum, source_sum),
        target_scatter=_centred(mass, _symmetric_products(wy, y), target_sum, target_sum),
    )


def floating_moments(problem: RegistrationProblem) -> Moments:
    """The moments of a problem in doubles, two passes: shift to the mean first, then multiply."""
    w, weight_exponent = _rescaled(problem.weights)
    x, source_exponent = _rescaled(problem.source)
    y, target_exponent = _rescaled(problem.target)
    mass = float(w.sum())
    x_mean, dx = _shifted(x, w, mass)
    y_mean, dy = _shifted(y, w, mass)
    weighted = w[:, None] * dx
    return Moments(
        n=problem.n,
        source_exponent=source_exponent,
        target_exponent=target_exponent,
        weight_exponent=weight_exponent,
        mass=mass,
        source_centroid=x_mean,
        target_centroid=y_mean,
        cross_covariance=dy.T @ weighted,
        source_scatter=dx.T @ weighted,
        target_spread=float(w @ (dy * dy).sum(axis=1)),
    )


def inertia(scatter: Matrix3[int]) -> Matrix3[int]:
    """tr(S) I - S."""
    (a, b, c), (_, d, e), (_, _, f) = scatter
    return ((d + f, -b, -c), (-b, a + f, -e), (-c, -e, a + d))


def trace(matrix: Matrix3[int]) -> int:
    """The sum of the diagonal."""
    return matrix[0][0] + matrix[1][1] + matrix[2][2]


def _centroid(total: Vector3[int], mass: int, exponent: int) -> Vector3[Fraction]:
    unit = power_of_two(exponent) / mass
    return (total[0] * unit, total[1] * unit, total[2] * unit)


def _dot(a: list[int], b: list[int]) -> int:
    return sum(map(mul, a, b))


def _products(left: list[list[int]], right: list[list[int]]) -> Matrix3[int]:
    rows = [tuple(_dot(a, b) for b in right) for a in left]
    return (rows[0], rows[1], rows[2])  # pyright: ignore[reportReturnType]


def _symmetric_products(left: list[list[int]], right: list[list[int]]) -> Matrix3[int]:
    xx, xy, xz = (_dot(left[0], column) for column in right)
    yy, yz = _dot(left[1], right[1]), _dot(left[1], right[2])
    return ((xx, xy, xz), (xy, yy, yz), (xz, yz, _dot(left[2], right[2])))


def _centred(
    mass: int, products: Matrix3[int], left: Vector3[int], right: Vector3[int]
) -> Matrix3[int]:
    rows = [tuple(mass * products[i][j] - left[i] * right[j] for j in range(3)) for i in range(3)]
    return (rows[0], rows[1], rows[2])  # pyright: ignore[reportReturnType]


def _rescaled(values: NDArray[np.float64]) -> tuple[NDArray[np.float64], int]:
    """The values over a power of two, so that the largest is in [1/2, 1): no product overflows."""
    exponent = int(np.frexp(np.abs(values).max())[1])
    return np.ldexp(values, -exponent), exponent


def _shifted(
    points: NDArray[np.float64], w: NDArray[np.float64], mass: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mean and deviations. The second subtraction removes what rounding left of the mean."""
    mean = (w @ points) / mass
    deviations = points - mean
    rest = (w @ deviations) / mass
    return mean + rest, deviations - rest
