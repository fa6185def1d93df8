"""What it can cost to write the optimal pose down in doubles: the least that any tool can promise.

A rotation R written as a matrix R + E is read as the nearest rotation R', so |R' - R| <= 2 |E|
(Frobenius), and with |R' - R|^2 = 8 sin^2(a/2), a the angle, sin^2(a/2) <= |E|^2 / 2. Written as a
quaternion q + e, it is read as one whose line is nearer than |e|: sin^2(a/2) <= |e|^2 / |q + e|^2.
At the optimum that angle costs at most the range of energies times sin^2(a/2): it is a mean of the
2 (l1 - lk). A centroid c away from its place costs M |c|^2 more. Every entry is at most half a unit
in its last place off if it was rounded once.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from certreg.exact.dyadic import nearest_root, power_of_two, rational_root_above
from certreg.problem.moments import ExactMoments, trace

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from certreg.objective.isotropic import Isotropic

MATRIX = (3, 3)
UNIT = Fraction(1, 2**50)  # of a scale that is read from a matrix, or rounded once
RANGE = 9  # the range over its lower bound: l1^2 <= 3/4 F^2 over F^2 / 12; symmetric: sqrt(2)
SMALLEST_HALF = -1075  # exponent of half the smallest double
LEAST_COST = Fraction(1, 2**200)  # two roundings of 2^-53, squared, and 2^12 for many points


def rounding_cost(
    objective: Isotropic,
    turn: NDArray[np.float64],
    shift: NDArray[np.float64] | None,
    centre: Sequence[Fraction] | None = None,
    *,
    scale: Fraction = Fraction(1),
) -> Fraction:
    """A bound on objective - minimum of the optimal pose, each of its numbers rounded once.

    turn: the rotation as it was written, (3, 3) or a quaternion (4,), near the optimal one; shift:
    the translation (3,); None where it is not written, but the best one. In the clouds' unit.
    centre: of the cloud that the pose moves, where it is written as the inverse, for the target.
    scale: of the pose, where it is free. An entry of s R is rounded twice, R and the product: so
    all is counted twice, its square four times. A scale off by s u costs Sxx (s u)^2, or that over
    s.
    """
    scaling, centre = objective.scaling, centre or objective.moments.source_centroid
    sine, away = rounding_errors(turn, shift, [scale * entry for entry in centre])
    shifted = objective.moments.total_weight * away
    if scaling is None:  # the range of energies, of the root of twice its square's lower bound
        return rational_root_above(2 * objective.least_range_squared) * sine + shifted
    if not scale:
        return Fraction(0)
    shifted += scaling.source * (scale * UNIT) ** 2
    most = rational_root_above(objective.least_range_squared) * RANGE
    return 4 * (most * sine + shifted / scaling.divisor(scale))


def rounding_errors(
    turn: NDArray[np.float64], shift: NDArray[np.float64] | None, centre: Sequence[Fraction]
) -> tuple[Fraction, Fraction]:
    """Bounds on sin^2(a/2) of the turn, and on the square of how far the centre is off its place.

    Of a pose each of whose numbers is rounded once; arguments as of `rounding_cost`.
    """
    halves = [_half(entry) for entry in turn.ravel().tolist()]
    moved = [_half(entry) for entry in ([0.0] * 3 if shift is None else shift.tolist())]
    off = _squares(halves)
    if turn.shape == MATRIX:
        sine = off / 2
        rows = (halves[:3], halves[3:6], halves[6:])
        away = _squares([h + _lever(row, centre) for h, row in zip(moved, rows, strict=True)])
    else:
        sine = off / _squares([Fraction(entry) for entry in turn.tolist()])
        away = 2 * (_squares(moved) + 4 * sine * _squares(list(centre)))
    return sine, Fraction(0) if shift is None else away


def rounding_remedy(moments: ExactMoments, matters: Fraction) -> str:
    """What to do where the rounding of the translation costs too much beside an energy.

    About the clouds' means a translation is as small as the rounding of the points, so that its own
    rounding costs LEAST_COST of the spread, or little more; no less than that of the least double.
    """
    if 3 * moments.total_weight * power_of_two(2 * SMALLEST_HALF) > matters:
        return "change the unit of length: no double is finer at this size"
    if LEAST_COST * moments.spread <= matters:
        return "move the origin to the clouds"
    source = trace(moments.source_scatter) * power_of_two(2 * moments.source_exponent)
    source *= power_of_two(moments.weight_exponent) / moments.mass
    target = moments.spread - source
    names = ("target", "source") if target > source else ("source", "target")
    times = nearest_root(max(source, target) / min(source, target)) if source and target else None
    much = (
        "" if times is None else f"the {names[0]} is {times:.3g} times as large as the {names[1]}: "
    )
    return f"{much}no translation in doubles is closer"


def _lever(row: Sequence[Fraction], centre: Sequence[Fraction]) -> Fraction:
    """How far the rounding of a row of the matrix moves a centroid."""
    return sum((h * abs(x) for h, x in zip(row, centre, strict=True)), start=Fraction(0))


def _half(entry: float) -> Fraction:
    """Half a unit in the last place of a double."""
    return Fraction(math.ulp(entry)) / 2


def _squares(entries: Sequence[Fraction]) -> Fraction:
    return sum((entry * entry for entry in entries), start=Fraction(0))
