"""Costs and ranges beside exact values: of perfect squares equal, of others on the safe side."""

from __future__ import annotations

import math
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from certreg.certificate.radius import Radius
from certreg.exact.dyadic import Dyadic
from certreg.objective.scaling import Scaling, SymmetricScaling
from certreg.registration import scale_range
from certreg.registration.gap_parts import GapParts, _percent
from certreg.registration.robustness import Robustness
from certreg.registration.rounding import RANGE, UNIT, rounding_cost, rounding_errors
from certreg.registration.scale_range import moved_scale, moved_symmetric_scale, proved_scales

LITTLE = Fraction(1, 10**30)
PLACES = 10**60
SQUARES = Fraction(4), Fraction(9), Fraction(25)  # M, Sxx, Syy
ROUGH = Fraction(2), Fraction(7), Fraction(11)
MOVES = Fraction(1, 10), Fraction(1, 5)


def roots(value: Fraction) -> tuple[Fraction, Fraction]:
    low = math.isqrt(value.numerator * PLACES**2 // value.denominator)
    return Fraction(low, PLACES), Fraction(low + 1, PLACES)


def test_a_scale_moves_as_far_as_eigenvalue_and_spread_do():
    """2 * 5 * 0.1 + 2 * 3 * 0.2 + 4 * 0.1 * 0.2 = 2.28; the spread's root 3 moves by 2 * 0.1."""
    moved = Fraction(228, 100)

    assert moved_scale(Fraction(50), Fraction(52), SQUARES, *MOVES) == (
        (50 - moved) / Fraction(32, 10) ** 2,
        (52 + moved) / Fraction(28, 10) ** 2,
    )
    low = moved_scale(Fraction(2), Fraction(3), SQUARES, *MOVES)
    assert low is not None
    assert low[0] == 0
    assert moved_symmetric_scale(SQUARES, *MOVES) == (
        Fraction(46, 10) / Fraction(32, 10),
        Fraction(54, 10) / Fraction(28, 10),
    )
    far = moved_symmetric_scale(SQUARES, Fraction(0), Fraction(3))
    assert far == (0, Fraction(11, 3))


def test_ends_of_a_range_of_scales_are_rounded_outwards():
    mass, own, other = ROUGH
    a, b = MOVES
    heavy, root, target = roots(mass), roots(own), roots(other)
    m = [roots(mass * other)[k] * a + roots(mass * own)[k] * b + mass * a * b for k in (0, 1)]
    made = moved_scale(Fraction(50), Fraction(52), ROUGH, a, b)
    even = moved_symmetric_scale(ROUGH, a, b)
    assert made is not None
    assert even is not None
    exact = (50 - m[0]) / (root[0] + heavy[0] * a) ** 2, (52 + m[0]) / (root[1] - heavy[0] * a) ** 2
    symmetric = (
        (target[1] - heavy[0] * b) / (root[0] + heavy[0] * a),
        (target[0] + heavy[0] * b) / (root[1] - heavy[0] * a),
    )
    near = 1 + Fraction(1, 2**50)

    for (low, high), (least, most) in ((made, exact), (even, symmetric)):
        assert low <= least <= low * near
        assert high / near <= most <= high


def test_a_source_that_may_shrink_to_a_point_has_no_range():
    edge = Fraction(3, 2)

    assert moved_scale(Fraction(50), Fraction(52), SQUARES, edge, Fraction(0)) is None
    assert moved_scale(Fraction(50), Fraction(52), SQUARES, edge - LITTLE, Fraction(0)) is not None
    assert moved_symmetric_scale(SQUARES, edge, Fraction(0)) is None
    assert moved_symmetric_scale(SQUARES, edge - LITTLE, Fraction(0)) is not None
    assert moved_symmetric_scale((SQUARES[0], SQUARES[1], Fraction(0)), *MOVES) is None


@pytest.mark.parametrize("ends", [(0.5, 2.0), (0.1, 0.3)])
@pytest.mark.parametrize("beside", [-LITTLE, Fraction(0), LITTLE])
def test_ends_are_written_as_doubles_on_the_outer_side(monkeypatch, ends, beside: Fraction):
    low, high = (Fraction(end) + beside for end in ends)
    monkeypatch.setattr(scale_range, "spreads_of", lambda _: SQUARES)
    monkeypatch.setattr(scale_range, "moved_symmetric_scale", lambda *_: (low, high))
    body: Any = SimpleNamespace(scale="symmetric")
    moments: Any = None
    found = proved_scales(body, moments, source=MOVES[0], target=MOVES[1])

    assert found is not None
    assert found[0] <= low < math.nextafter(found[0], math.inf)
    assert math.nextafter(found[1], 0.0) < high <= found[1]
    monkeypatch.setattr(scale_range, "moved_symmetric_scale", lambda *_: (low, Fraction(10) ** 400))
    assert proved_scales(body, moments, source=MOVES[0], target=MOVES[1]) is None


def test_a_claimed_scale_is_an_eigenvalue_over_the_spread(monkeypatch):
    monkeypatch.setattr(scale_range, "spreads_of", lambda _: SQUARES)
    scales = Dyadic(mantissa=50, exponent=-3), Dyadic(mantissa=52, exponent=-3)
    claims = SimpleNamespace(scale_lower=scales[0], scale_upper=scales[1])
    body: Any = SimpleNamespace(scale="asymmetric", claims=claims)
    moments: Any = None
    found = proved_scales(body, moments, source=MOVES[0], target=MOVES[1])
    exact = moved_scale(Fraction(450, 8), Fraction(468, 8), SQUARES, *MOVES)

    assert found is not None
    assert exact is not None
    assert found[0] <= exact[0] < math.nextafter(found[0], math.inf)
    assert math.nextafter(found[1], 0.0) < exact[1] <= found[1]


def half(entry: float) -> Fraction:
    return Fraction(math.ulp(entry)) / 2


TURN = np.array([[0.5, -3.0, 0.1], [2.0**-60, 1.0, -0.25], [7.0, 0.0, 1e-5]])
SHIFT = np.array([1.0, -1000.0, 0.125])
CENTRE = Fraction(3), Fraction(-5), Fraction(1, 7)


def test_rounding_errors_of_a_matrix_are_those_of_half_units_in_the_last_place():
    sine, away = rounding_errors(TURN, SHIFT, CENTRE)
    rows = [
        half(t) + sum(half(e) * abs(c) for e, c in zip(row, CENTRE, strict=True))
        for t, row in zip(SHIFT.tolist(), TURN.tolist(), strict=True)
    ]

    assert sine == sum(half(e) ** 2 for e in TURN.ravel().tolist()) / 2
    assert away == sum(row * row for row in rows)
    assert rounding_errors(TURN, None, CENTRE) == (sine, 0)


def test_rounding_errors_of_a_quaternion_are_relative_to_its_length():
    q = np.array([1.0, 0.5, -2.0, 0.25])
    sine, away = rounding_errors(q, SHIFT, CENTRE)
    squares = [sum(half(e) ** 2 for e in array.tolist()) for array in (q, SHIFT)]
    centre = sum(c * c for c in CENTRE)

    assert sine == squares[0] / sum(Fraction(e) ** 2 for e in q.tolist())
    assert away == 2 * (squares[1] + 4 * sine * centre)


def fake(scaling: Any = None, squared: Fraction = Fraction(18)) -> Any:
    moments = SimpleNamespace(total_weight=Fraction(7), source_centroid=CENTRE)
    return SimpleNamespace(least_range_squared=squared, moments=moments, scaling=scaling)


def test_the_cost_of_rounding_is_the_range_for_the_turn_and_the_weight_for_the_shift():
    sine, away = rounding_errors(TURN, SHIFT, CENTRE)
    other = Fraction(1), Fraction(2), Fraction(3)

    assert rounding_cost(fake(), TURN, SHIFT) == 6 * sine + 7 * away
    assert rounding_cost(fake(), TURN, SHIFT, other) == (
        6 * sine + 7 * rounding_errors(TURN, SHIFT, other)[1]
    )
    assert rounding_cost(fake(squared=Fraction(3)), TURN, None) >= roots(Fraction(6))[0] * sine


@pytest.mark.parametrize("symmetric", [False, True])
def test_the_cost_of_rounding_a_scale_is_that_of_half_a_unit(symmetric):
    scale = Fraction(5, 2)
    scaling = (SymmetricScaling if symmetric else Scaling)(Fraction(11), Fraction(1))
    objective = fake(scaling, Fraction(16))
    sine, away = rounding_errors(TURN, SHIFT, [scale * c for c in CENTRE])
    shifted = 7 * away + 11 * (scale * UNIT) ** 2

    assert rounding_cost(objective, TURN, SHIFT, scale=scale) == 4 * (
        4 * RANGE * sine + (shifted / scale if symmetric else shifted)
    )
    assert rounding_cost(objective, TURN, SHIFT, scale=Fraction(0)) == 0


@pytest.mark.parametrize("beside", [-LITTLE, Fraction(0), LITTLE])
@pytest.mark.parametrize("double", [0.1, 0.75])
def test_parts_are_doubles_above_and_lengths_doubles_below(double: float, beside: Fraction):
    value = Fraction(double) + beside
    parts = GapParts(rotation=value, scale=value, translation=value)
    above = math.nextafter(double, 1.0) if beside > 0 else double
    length = Dyadic(mantissa=int(value * 2**200), exponent=-200)
    below = math.nextafter(double, 0.0) if beside < 0 else double
    claimed = Robustness.of(
        Radius(sin_half_angle=Dyadic(mantissa=1, exponent=-1), target=length, both=length)
    )

    assert parts.doubles == (above, above, above)
    assert (claimed.target, claimed.both) == (below, below)
    assert claimed.angle == 60.0001  # six digits, rounded up


SHARES = 0, 1, 99, 100, 99_900, 99_901, 10**5, 60_000


def test_a_share_is_not_rounded_up_to_all_nor_down_to_nothing():
    told = [_percent(Fraction(share, 100_000)) for share in SHARES]

    assert told[0].startswith("0")
    assert told[1] == told[2] == "under 0.1 %"
    assert told[3] == "0.1 %"
    assert told[4] == told[5] == "over 99.9 %"
    assert told[7] == "60 %"
    assert told[6].startswith("100")
