"""Between which numbers the scale, an eigenvalue over a sum of squares, stays when points move.

Where no source point moves by more than dx, no target point by more than dy, Davenport's matrix
moves by at most m = sqrt(M Syy) dx + sqrt(M Sxx) dy + M dx dy, and with it its largest eigenvalue;
sqrt(Sxx) moves by at most sqrt(M) dx. Proof: derivations, scale_radius. The rotation's radius is
that of the rigid body, since the matrix is the same. Without a translation all sums are about the
origin; the bounds are the same.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import TYPE_CHECKING

from certreg.exact.dyadic import double_above, double_below, power_of_two, rational_root_above
from certreg.problem.moments import ExactMoments, trace
from certreg.problem.motion import Scale

if TYPE_CHECKING:
    from certreg.certificate.isotropic import SimilarityBody

Spreads = tuple[Fraction, Fraction, Fraction]  # M, Sxx, Syy
Scales = tuple[Fraction, Fraction]  # the least and the largest


def spreads_of(moments: ExactMoments) -> Spreads:
    """The total weight and the sums of squares about the means, exact."""
    weight = power_of_two(moments.weight_exponent)
    source, target = (
        Fraction(trace(scatter), moments.mass) * power_of_two(2 * exponent) * weight
        for scatter, exponent in (
            (moments.source_scatter, moments.source_exponent),
            (moments.target_scatter, moments.target_exponent),
        )
    )
    return moments.total_weight, source, target


def proved_scales(
    body: SimilarityBody, moments: ExactMoments, *, source: Fraction, target: Fraction
) -> tuple[float, float] | None:
    """Between which scales every optimum stays while no point moves by more; None: no bound.

    body: of a certificate that was accepted. Rounded outwards, to doubles.
    """
    found = MOVED[Scale(body.scale)](body, spreads_of(moments), source, target)
    if found is None:
        return None
    low, high = max(0.0, double_below(found[0])), double_above(found[1])
    return (low, high) if math.isfinite(high) else None


def _asymmetric(
    body: SimilarityBody, spreads: Spreads, source: Fraction, target: Fraction
) -> Scales | None:
    """From the bounds that the certificate proves."""
    bounds = (body.claims.scale_lower, body.claims.scale_upper)
    least, most = (bound.value * spreads[1] for bound in bounds)
    return moved_scale(least, most, spreads, source, target)


def _symmetric(
    body: SimilarityBody, spreads: Spreads, source: Fraction, target: Fraction
) -> Scales | None:
    """Whatever the rotation."""
    del body
    return moved_symmetric_scale(spreads, source, target)


MOVED = {Scale.ASYMMETRIC: _asymmetric, Scale.SYMMETRIC: _symmetric}


def moved_scale(
    least: Fraction, most: Fraction, spreads: Spreads, source: Fraction, target: Fraction
) -> tuple[Fraction, Fraction] | None:
    """The least and the largest scale lambda / Sxx of points that moved; None: no bound.

    least, most: of the largest eigenvalue now, proved. spreads: M, Sxx, Syy. source, target: no
    point moves by more. Rounded outwards.
    """
    mass, own, other = (Fraction(number) for number in spreads)
    source, target = Fraction(source), Fraction(target)
    moved = rational_root_above(mass * other) * source + rational_root_above(mass * own) * target
    moved += mass * source * target
    root, shift = rational_root_above(own), rational_root_above(mass) * source
    inner = own / root - shift  # own / root is at most the root
    if inner <= 0:
        return None
    return max(Fraction(0), least - moved) / (root + shift) ** 2, (most + moved) / inner**2


def moved_symmetric_scale(
    spreads: Spreads, source: Fraction, target: Fraction
) -> tuple[Fraction, Fraction] | None:
    """The same of the scale sqrt(Syy / Sxx), which no rotation enters."""
    mass, own, other = (Fraction(number) for number in spreads)
    heavy = rational_root_above(mass)
    own_root, other_root = rational_root_above(own), rational_root_above(other)
    inner = own / own_root - heavy * source
    if inner <= 0 or not other:
        return None
    least = max(Fraction(0), other / other_root - heavy * target)
    return least / (own_root + heavy * source), (other_root + heavy * target) / inner
