"""How far the points may move before an optimum turns by more than a stated angle.

The springs stay as they are. Let every target point be off by at most r, and every source point,
too, where both may move; a is the angle, s = sin(a/2), R the certified rotation.

One weight per pair. The matrix K of the moved points is within
beta = r (sqrt(M kx) + sqrt(M ky)) + M r^2 of the old one, by Cauchy and Schwarz, with
kx = sum w |x - mean|^2 and ky of the target; of the first term only sqrt(M kx) is left, and no
square, where the source stays. If the largest eigenvalue of K is alone by g > 2 beta, that of the
moved K is simple, and its rotation is turned by at most arcsin(2 beta / g). The
certified rotation is within an angle a0 of the old optimum, so that 2 beta <= g (sin a - a0) is
enough.

Springs with matrices. With weights w >= the largest eigenvalue of each, W their sum, k = sum
w |x - mean|^2 and the growth form f(p) >= f(u) - delta + mu sin^2(t/2), an optimum of the moved
points at an angle t has t < a if
(mu - 8 sqrt(k) ex) s > 4 (sqrt(k) (ex + ey) + ex (sqrt(f(u)) + ex + ey)) + delta / s,
where ey = r sqrt(W), and ex the same or, where the source stays, 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING

from certreg.certificate.file_parts import FilePart
from certreg.exact.dyadic import (
    Dyadic,
    dyadic_below,
    dyadic_root_above,
    in_one_unit,
    power_of_two,
    rational_root_above,
)
from certreg.problem.moments import ExactMoments, trace

if TYPE_CHECKING:
    from certreg.problem.stiffness import SpringMoments

RADIUS_BITS = 24  # of mantissa: short numbers, at most 2^-23 of them lost
SAFE_BITS = 40
SAFE = 1 - power_of_two(-SAFE_BITS)  # what is asked for is a little less than what is proved
ZERO_ROOT = power_of_two(-70)  # what the checker takes for the root of 0: its roots are above
MOST_DEGREES = 90.0  # beyond, the sine of the angle falls again


@dataclass(frozen=True, slots=True, kw_only=True)
class Radius(FilePart):
    """How far points may move, in the unit of length, with every optimum within an angle.

    sin_half_angle: s = sin(a/2) of that angle, from the certified rotation.
    target: every target point may be off by as much. both: every point of both clouds.
    """

    sin_half_angle: Dyadic
    target: Dyadic
    both: Dyadic


@dataclass(frozen=True, slots=True, kw_only=True)
class SeparatedRadius(Radius):
    """That of one weight per pair. separation: of the largest eigenvalue of K, at least."""

    separation: Dyadic


def isotropic_radius(
    moments: ExactMoments, *, separation: Dyadic, sin2_half_angle: Fraction, degrees: float
) -> SeparatedRadius | None:
    """How far the points may move, for an objective with a unique optimum.

    separation: g > 0, proved. sin2_half_angle: proved of the angle from the certified rotation to
    the optimum, less than 1. degrees: of the angle within which optima are to stay.
    None where even points that stay are not proved to keep the optimum within that angle.
    """
    s, sine = sines(degrees)
    n, d = sin2_half_angle.as_integer_ratio()
    tangent = dyadic_root_above(Fraction(n, d - n))  # the angle is less than twice that
    source, target = (
        dyadic_root_above(trace(scatter)).shifted(moments.weight_exponent + e)
        for scatter, e in (
            (moments.source_scatter, moments.source_exponent),
            (moments.target_scatter, moments.target_exponent),
        )
    )
    mass = Dyadic(mantissa=moments.mass, exponent=moments.weight_exponent)
    given = separation, sine, tangent.shifted(1), source, target, mass
    (g, turn, own, x, y, m), unit = in_one_unit(*given)
    most = SAFE.numerator * g * (turn - own)  # beta is g (sin a - a0) / 2 at most: less by `SAFE`
    if most <= 0:
        return None
    # With r itself, and both = x + y: (most / over) = both r + m r^2
    both, places = x + y, unit - SAFE_BITS - 1
    most, over = most << max(places, 0), 1 << max(-places, 0)
    root = rational_root_above(Fraction(both * both * over + 4 * m * most, over))
    return SeparatedRadius(
        sin_half_angle=s,
        target=dyadic_below(Fraction(most, x * over), RADIUS_BITS),
        both=dyadic_below(Fraction(2 * most, over) / (both + root), RADIUS_BITS),
        separation=separation,
    )


def growth_radius(
    moments: SpringMoments, *, mu: Fraction, delta: Fraction, value: Fraction, degrees: float
) -> Radius | None:
    """The same from a growth form, for springs with matrices. value: the energy at the rotation."""
    s, _ = sines(degrees)
    weight, lever = _weight_and_lever(moments)
    k, w, fit = (rational_root_above(x) for x in (lever, weight, value))
    fit = fit or ZERO_ROOT
    left = SAFE * (mu * s.value - delta / s.value)
    if left <= 0 or not k:
        return None
    # 8 w^2 r^2 + (8 k w (1 + s) + 4 w fit) r < left
    first, second = 8 * k * w * (1 + s.value) + 4 * w * fit, 8 * w * w
    root = rational_root_above(first**2 + 4 * second * left)
    # or 4 m (fit + m) <= left s, of the target m = w r, of both clouds m = 2 w r
    moved = left * s.value / (2 * (fit + rational_root_above(fit**2 + left * s.value)))
    return Radius(
        sin_half_angle=s,
        target=dyadic_below(max(left / (4 * k), moved) / w, RADIUS_BITS),
        both=dyadic_below(max(2 * left / (first + root), moved / (2 * w)), RADIUS_BITS),
    )


def _weight_and_lever(moments: SpringMoments) -> tuple[Fraction, Fraction]:
    """Sum of w = tr W, which is at least the largest eigenvalue of W, and sum w |x - mean|^2."""
    diagonal = (0, 3, 5)  # of a symmetric matrix as six entries
    weight = sum(moments.stiffness[a] for a in diagonal)
    scatter = sum(moments.scatter[a][b] for a in diagonal for b in diagonal)
    sums = [sum(moments.source[a][j] for a in diagonal) for j in range(3)]
    lever = scatter - Fraction(sum(k * k for k in sums), weight)
    unit = power_of_two(moments.weight_exponent)
    return weight * unit, lever * unit * power_of_two(2 * moments.source_exponent)


@lru_cache(maxsize=64)
def sines(degrees: float) -> tuple[Dyadic, Dyadic]:
    """Of half the angle, rounded down, and of the angle that has this sine of its half.

    Raises ValueError outside of (0, 90].
    """
    if not 0.0 < degrees <= MOST_DEGREES:
        raise ValueError(f"the angle is {degrees!r} degrees: give more than 0, and at most 90")
    half = dyadic_below(SAFE * Fraction(math.sin(math.radians(degrees) / 2)), RADIUS_BITS)
    cosine = dyadic_root_above(1 - half.value**2)
    sine = 2 * half.mantissa * cosine.mantissa * ((1 << 60) - 1)
    return half, Dyadic(mantissa=sine, exponent=half.exponent + cosine.exponent - 60)
