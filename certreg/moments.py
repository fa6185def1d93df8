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
from typing import TYPE_CHECKING

import numpy as np

from certreg.dyadic import power_of_two
from certreg.exact_sums import sums

if TYPE_CHECKING:
    from collections.abc import Sequence
    from fractions import Fraction

    from numpy.typing import NDArray

    from certreg.exact_sums import Sums
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
    return moments_of(sums(problem), problem.n)


def moments_of(found: Sums, n: int) -> ExactMoments:
    """The moments that exact sums over n points make."""
    mass, *rest = found.integers
    source_sum, target_sum = _vector(rest[:3]), _vector(rest[3:6])
    return ExactMoments(
        n=n,
        source_exponent=found.source_exponent or 0,
        target_exponent=found.target_exponent or 0,
        weight_exponent=found.weight_exponent or 0,
        mass=mass,
        source_sum=source_sum,
        target_sum=target_sum,
        cross=_centred(mass, rest[6:15], target_sum, source_sum),
        source_scatter=_centred(mass, _symmetric(rest[15:21]), source_sum, source_sum),
        target_scatter=_centred(mass, _symmetric(rest[21:]), target_sum, target_sum),
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


def _vector(entries: Sequence[int]) -> Vector3[int]:
    x, y, z = entries
    return (x, y, z)


def _symmetric(upper: Sequence[int]) -> list[int]:
    """The nine entries of a symmetric matrix from the six above the diagonal and on it."""
    xx, xy, xz, yy, yz, zz = upper
    return [xx, xy, xz, xy, yy, yz, xz, yz, zz]


def _centred(
    mass: int, products: Sequence[int], left: Vector3[int], right: Vector3[int]
) -> Matrix3[int]:
    entries = [mass * product - left[k // 3] * right[k % 3] for k, product in enumerate(products)]
    return (_vector(entries[:3]), _vector(entries[3:6]), _vector(entries[6:]))


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
