"""Moments of a problem: all that energies, forces and equilibria depend on.

The only place where the number of points appears. The potential energy is a polynomial of degree
two in the points, so sums of products of degree up to two are enough, whatever N is. Spring
matrices per point would add further sums here and change nothing below.

`ExactMoments` are integers: they decide. `Moments` are doubles, taken in one pass and about the
means, so that offsets of 1e8 and scales of 1e+-150 cost no digits: they propose.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import cached_property
from certreg.errors import InvalidProblemError
from certreg.exact.dyadic import power_of_two
from certreg.native.layout import MEANS, named
from certreg.problem.exact_sums import WEIGHTED, Sums
from certreg.problem.floating_sums import CloudPair, FloatingSums, chunks, floating_sums
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.geometry.so3 import Matrix3, Vector3
    from certreg.problem.motion import Motion
    from certreg.problem.problem import RegistrationProblem

FIRST_ORDER = slice(1, 7)  # of 28 sums
MOST_EXPONENT = 1025  # two doubles are less than 2^1025 apart
SAMPLE_POINTS = 32  # whose mean is the first origin: near enough for almost every cloud
LARGEST_LEVER = 1.0  # squared distance of origin and mean, over the mean squared radius
PASSES = 4  # origins: each is the mean as the one before it sees it; two are rare
EIGENVALUE_ROUNDING = 64.0 * 2.0**-53  # of the norm of a 4x4 matrix: more than LAPACK loses
LEAST_SUM = 2.0**-400  # of squares: what underflows is below 2^-400 of it
MOST_SUM = 2.0**400  # of squares: products of two sums do not overflow


@dataclass(frozen=True, kw_only=True)
class ExactMoments(Brief):
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
        return _dyadic_over(1, exponent, self.mass)

    @cached_property
    def spread(self) -> Fraction:
        """Sum of w |x - mean|^2 + w |y - mean|^2, in objective units: the scale of all energies."""
        a, b = 2 * self.source_exponent, 2 * self.target_exponent
        least = min(a, b)
        source = trace(self.source_scatter) << (a - least)
        target = trace(self.target_scatter) << (b - least)
        return _dyadic_over(source + target, self.weight_exponent + least, self.mass)

    @cached_property
    def inertia(self) -> Matrix3[int]:
        """Integers times 2^(2c+2a): mass * J, J = tr(S2) I - S2, the inertia about the mean."""
        return inertia(self.source_scatter)

    @cached_property
    def total_weight(self) -> Fraction:
        """M, the sum of the weights, exactly."""
        return _dyadic_over(self.mass, self.weight_exponent, 1)

    @cached_property
    def source_centroid(self) -> tuple[Fraction, Fraction, Fraction]:
        """The weighted mean of the source, exactly."""
        return _centroid(self.source_sum, self.mass, self.source_exponent)

    @cached_property
    def target_centroid(self) -> tuple[Fraction, Fraction, Fraction]:
        """The weighted mean of the target, exactly."""
        return _centroid(self.target_sum, self.mass, self.target_exponent)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Moments(Brief):
    """Sums over the points in doubles; lengths over 2^source_exponent and 2^target_exponent.

    mass: total weight over 2^weight_exponent.
    source_centroid, target_centroid: (3,), weighted means, in the user's unit.
    cross_covariance: (3, 3), C = sum w (y - mean)(x - mean)^T.
    source_scatter: (3, 3), S2 = sum w (x - mean)(x - mean)^T.
    target_spread: sum w |y - mean|^2.
    rounding: no entry of `cross_covariance` is further from the exact one.
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
    rounding: float

    @property
    def inertia(self) -> NDArray[np.float64]:
        """(3, 3), J = tr(S2) I - S2, positive definite iff three points are not collinear."""
        return np.trace(self.source_scatter) * np.eye(3) - self.source_scatter


def exact_moments(problem: RegistrationProblem) -> ExactMoments:
    """The moments of a problem in integer arithmetic: no rounding anywhere."""
    return moments_of(WEIGHTED.of(problem), problem.n, problem.motion)


def moments_of(sums: Sums, n: int, motion: Motion) -> ExactMoments:
    """The moments that exact sums over n points make."""
    mass, x, y, z, u, v, w, *products = motion.centred(sums.integers, FIRST_ORDER)
    source_sum, target_sum = (x, y, z), (u, v, w)
    return ExactMoments(
        n=n,
        source_exponent=sums.source_exponent or 0,
        target_exponent=sums.target_exponent or 0,
        weight_exponent=sums.weight_exponent or 0,
        mass=mass,
        source_sum=source_sum,
        target_sum=target_sum,
        cross=_centred(mass, products[:9], target_sum, source_sum),
        source_scatter=_scatter(mass, products[9:15], source_sum),
        target_scatter=_scatter(mass, products[15:], target_sum),
    )


def floating_moments(problem: RegistrationProblem, *, threads: int = 1) -> Moments:
    """The moments of a problem in doubles, in one pass over the points."""
    return moments_of_clouds(
        problem.source,
        problem.target,
        problem.weights,
        threads=threads,
        about_origin=not problem.motion.translations,
    )


def moments_of_clouds(
    source: NDArray[Any],
    target: NDArray[Any],
    weights: NDArray[Any] | None = None,
    *,
    threads: int = 1,
    about_origin: bool = False,
) -> Moments:
    """The moments in doubles of clouds (N, 3) of any real type and strides, none of them copied.

    about_origin: the origin in the place of both means, as where there is no translation.
    weights: (N,), or None where all are one. One pass, with deviations from the mean of a few
    points; more where the mean turns out to be far from that, or sums leave the range of doubles.
    Raises InvalidProblemError, with the row, for numbers that are not finite and weights < 0.
    """
    factor, shift = 1.0, 0
    if weights is not None and weights.strides == (0,):  # one weight in the place of all
        _require_numbers("weights", weights[:1], least=0.0)
        (factor, shift), weights = math.frexp(weights[0]), None
    origin = np.concatenate([near_mean(source), near_mean(target)]) * (not about_origin)
    clouds = CloudPair(source=source, target=target, weights=weights, origin=origin)
    clouds, sums = _summed(clouds, threads)
    for _ in range(PASSES - 1):
        if about_origin or 0.0 in (factor, sums.mass) or _is_near(sums, LARGEST_LEVER):
            break
        clouds, sums = _summed(replace(clouds, origin=_means(clouds, sums)), threads)
    if factor == 0.0 or sums.mass == 0.0:
        raise InvalidProblemError(
            "all weights are zero: no correspondence counts, so every pose is as good",
            array="weights",
            value=0.0,
        )
    if about_origin:  # of which the origin is taken for the mean
        sums = replace(sums, source=np.zeros(3), target=np.zeros(3))
    return _about_means(clouds, sums, factor=factor, weight_exponent=shift)


def inertia(scatter: Matrix3[int]) -> Matrix3[int]:
    """tr(S) I - S."""
    (a, b, c), (_, d, e), (_, _, f) = scatter
    return ((d + f, -b, -c), (-b, a + f, -e), (-c, -e, a + d))


def trace(matrix: Matrix3[int]) -> int:
    """The sum of the diagonal."""
    return matrix[0][0] + matrix[1][1] + matrix[2][2]


def _dyadic_over(number: int, exponent: int, over: int) -> Fraction:
    """The product of number and 2^exponent, over another number: reduced once."""
    return Fraction(number << max(exponent, 0), over << max(-exponent, 0))


def _centroid(total: Vector3[int], mass: int, exponent: int) -> Vector3[Fraction]:
    unit = power_of_two(exponent) / mass
    return (total[0] * unit, total[1] * unit, total[2] * unit)


def _centred(
    mass: int, products: Sequence[int], left: Vector3[int], right: Vector3[int]
) -> Matrix3[int]:
    a, b, c, d, e, f, g, h, i = products
    (u, v, w), (x, y, z) = left, right
    return (
        (mass * a - u * x, mass * b - u * y, mass * c - u * z),
        (mass * d - v * x, mass * e - v * y, mass * f - v * z),
        (mass * g - w * x, mass * h - w * y, mass * i - w * z),
    )


def _scatter(mass: int, products: Sequence[int], total: Vector3[int]) -> Matrix3[int]:
    """The same of one cloud, from the six products on the diagonal and above it."""
    (xx, xy, xz, yy, yz, zz), (x, y, z) = products, total
    xy, xz, yz = mass * xy - x * y, mass * xz - x * z, mass * yz - y * z
    return (
        (mass * xx - x * x, xy, xz),
        (xy, mass * yy - y * y, yz),
        (xz, yz, mass * zz - z * z),
    )


def _summed(clouds: CloudPair, threads: int) -> tuple[CloudPair, FloatingSums]:
    """The sums, of clouds over powers of two if they leave the range of doubles otherwise."""
    sums = floating_sums(clouds, threads=threads)
    if sums.negative or not _in_range(sums):
        _require_clouds(clouds)
    if not _in_range(sums):
        clouds = _rescaled(clouds)
        sums = floating_sums(clouds, threads=threads)
    return clouds, sums


def near_mean(points: NDArray[Any]) -> NDArray[np.float64]:
    """The mean of a few points, or one of them where that is beyond the doubles."""
    some = points[:: max(1, len(points) // SAMPLE_POINTS)]
    copied = np.empty(some.shape)  # the same sum for every layout
    copied[:] = some
    with np.errstate(all="ignore"):
        mean = np.add.reduce(copied) / len(copied)
    return mean if np.isfinite(mean).all() else copied[0]


def _in_range(sums: FloatingSums) -> bool:
    """Whether products are far from both ends of the doubles; False if a sum is not a number."""
    scatter = float(sums.scatter.trace())
    return all(LEAST_SUM <= size <= MOST_SUM for size in (sums.mass, sums.spread, scatter))


def _is_near(sums: FloatingSums, lever: float) -> bool:
    """Whether both origins are so near the means that deviations from them hold all digits."""
    parts = ((sums.source, float(sums.scatter.trace())), (sums.target, sums.spread))
    return all((1.0 + lever) * (s @ s) <= lever * sums.mass * square for s, square in parts)


def _means(clouds: CloudPair, sums: FloatingSums) -> NDArray[np.float64]:
    """(6,) weighted means of source and target, in the user's unit."""
    here, there, _ = clouds.exponents
    shifts = np.ldexp(sums.source / sums.mass, here), np.ldexp(sums.target / sums.mass, there)
    return clouds.origin + np.concatenate(shifts)


def _about_means(
    clouds: CloudPair, sums: FloatingSums, *, factor: float, weight_exponent: int
) -> Moments:
    """Moments about the means from sums about the origins.

    Each sum is within e A of the exact one, e = 260 u and A the sum of the absolute terms. With
    P = sqrt(sum w |x|^2 sum w |y|^2), Cauchy and Schwarz give A <= P for the products, and the same
    for what the sums of x and y contribute: in all 3 e P, and little more for what is rounded here.
    """
    x, y, mass, means = sums.source, sums.target, sums.mass, named(_means(clouds, sums), MEANS)
    size = math.sqrt(float(sums.scatter.trace())) * math.sqrt(sums.spread)
    mean = x / mass
    return Moments(
        n=clouds.n,
        source_exponent=clouds.exponents[0],
        target_exponent=clouds.exponents[1],
        weight_exponent=clouds.exponents[2] + weight_exponent,
        mass=factor * mass,
        source_centroid=means["source"],
        target_centroid=means["target"],
        cross_covariance=factor * (sums.cross - y[:, np.newaxis] * mean),
        source_scatter=factor * (sums.scatter - x[:, np.newaxis] * mean),
        target_spread=factor * max(0.0, sums.spread - float(y @ y) / mass),
        rounding=factor * rounding_of(size),
    )


def rounding_of(size: float) -> float:
    """What rounding may move an entry of the cross-covariance by, as above; size: P."""
    return 800.0 * 2.0**-53 * size


def davenport_error(rounding: float, norm: float) -> float:
    """What the eigenvalues of the Davenport matrix K of a rounded C may be off, once computed.

    With every entry of C off by at most `rounding`, K is off by at most 3 sqrt(3) times that, since
    K(E) has the eigenvalues s1 +- s2 +- s3 of the singular values of E. norm: of K.
    """
    return 3.0 * math.sqrt(3.0) * rounding + EIGENVALUE_ROUNDING * norm


def _rescaled(clouds: CloudPair) -> CloudPair:
    """The clouds over powers of two, so that no product of their deviations overflows."""
    origins = (clouds.origins["source"], clouds.origins["target"], np.zeros(1))
    arrays = (clouds.source, clouds.target, clouds.weights)
    a, b, c = (_exponent(*pair) for pair in zip(arrays, origins, strict=True))
    return replace(clouds, exponents=(a, b, c))


def _exponent(values: NDArray[Any] | None, origin: NDArray[np.float64]) -> int:
    """The exponent of a power of two above all distances, by coordinate, from the origin."""
    if values is None:
        return 0
    with np.errstate(over="ignore"):
        farthest = max(float(np.abs(part - origin).max()) for part in chunks(values))
    return math.frexp(farthest)[1] if farthest < math.inf else MOST_EXPONENT


def _require_clouds(clouds: CloudPair) -> None:
    _require_numbers("source", clouds.source)
    _require_numbers("target", clouds.target)
    if clouds.weights is not None:
        _require_numbers("weights", clouds.weights, least=0.0)


def _require_numbers(name: str, array: NDArray[Any], *, least: float = -math.inf) -> None:
    """Raises InvalidProblemError for the first row that is not finite, or below the least."""
    first = 0
    for part in chunks(array):
        good = (np.isfinite(part) & (part >= least)).reshape(len(part), -1).all(axis=1)
        if not good.all():
            row = int(np.argmin(good))
            message = (
                f"{name} row {first + row} (counting from 0) is {part[row].tolist()}: every value "
                f"must be finite{' and >= 0' if least == 0.0 else ''}; remove the correspondence "
                "from both clouds"
            )
            limit = 0.0 if least == 0.0 else None
            raise InvalidProblemError(
                message, array=name, row=first + row, value=part[row].tolist(), limit=limit
            )
        first += len(part)
