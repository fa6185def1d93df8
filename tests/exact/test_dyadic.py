from __future__ import annotations

import math
from fractions import Fraction

import pytest
from flint import arb, ctx
from hypothesis import example, given
from hypothesis import strategies as st

from certreg.exact.dyadic import (
    Dyadic,
    double_above,
    double_below,
    dyadic_above,
    dyadic_below,
    dyadic_root_above,
    half_angle_bound,
    nearest_double,
    nearest_or_zero,
    nearest_root,
    rational_root_above,
    root_above,
    root_of_quotient,
)

positive = st.builds(
    lambda n, d, e: Fraction(n, d) * Fraction(2) ** e,
    st.integers(1, 10**40),
    st.integers(1, 10**40),
    st.integers(-1500, 1500),
)


@given(positive, st.integers(2, 80))
def test_dyadic_bounds_enclose_the_value_within_their_precision(value, bits):
    above, below = dyadic_above(value, bits), dyadic_below(value, bits)

    assert below.value <= value <= above.value
    assert above.value - below.value <= value * Fraction(4, 2**bits)
    assert above.mantissa.bit_length() <= bits + 1


@given(positive)
def test_doubles_above_and_below_enclose_the_value(value):
    above, below = double_above(value), double_below(value)

    assert above == math.inf or Fraction(above) >= value
    assert Fraction(below) <= value
    assert math.nextafter(below, math.inf) >= above or above == below


@given(positive)
def test_the_nearest_double_is_none_only_outside_the_doubles(value):
    nearest = nearest_double(value)

    assert nearest != 0.0
    if nearest is None:
        assert value > Fraction(1.7e308) or value < Fraction(5e-324)
    else:
        assert abs(Fraction(nearest) - value) <= value / 2**52 + Fraction(5e-324)


@pytest.mark.slow
@given(positive)
def test_roots_are_right_where_the_square_is_far_outside_the_doubles(value):
    root = nearest_root(value)

    assert root is not None
    if root > 1e-300:
        assert abs(Fraction(root) ** 2 - value) <= value / 2**51


TIE = (2**53 + 1) ** 2  # of a root just between two doubles


@given(positive, st.integers(1, 10**30))
@example(Fraction(TIE), 3)
@example(Fraction(TIE * 4**400 + 1), 7)  # hardly above: up
@example(Fraction(TIE * 4**400 - 1, 4**900), 1)
def test_a_root_of_a_quotient_is_rounded_once_in_lowest_terms_or_not(value, factor):
    root = root_of_quotient(factor * value.numerator, factor * value.denominator)

    assert root is not None
    if root > 1e-300:
        nearer = [
            (Fraction(root) + Fraction(math.nextafter(root, end))) / 2 for end in (0.0, math.inf)
        ]
        assert nearer[0] ** 2 <= value <= nearer[1] ** 2
    assert root_of_quotient(0, factor) == 0.0
    assert root_of_quotient(4**1100, 1) is None


@given(positive)
@example(Fraction(9 * 4**500 + 1))  # hardly above a square, before and after it is cut to 64 bits
@example(Fraction(9 * 4**500 + 1, 4**900))
def test_a_root_above_is_above_and_close_at_every_size(value):
    root = rational_root_above(value)

    assert value <= root**2 <= value * (1 + Fraction(1, 2**61))
    assert root_above(value) >= root


@given(st.floats(0.0, allow_infinity=False, allow_nan=False))
def test_a_double_is_its_own_bound(value):
    exact = Fraction(value)

    assert double_above(exact) == double_below(exact) == nearest_or_zero(exact) == value


def test_coordinates_beyond_the_doubles_keep_their_side():
    far = Fraction(10) ** 400

    assert (nearest_or_zero(far), nearest_or_zero(-far)) == (math.inf, -math.inf)
    assert nearest_or_zero(1 / far) == 0.0


def test_zero_stays_zero():
    zero = Fraction(0)

    assert (nearest_double(zero), nearest_root(zero), double_above(zero)) == (0.0, 0.0, 0.0)
    assert dyadic_above(zero, 8).pair == dyadic_below(zero, 8).pair == [0, 0]


@given(st.fractions(0, 1))
def test_the_angle_bound_is_an_upper_bound_and_close(sin2):
    bound = half_angle_bound(sin2)

    assert math.sin(min(bound, math.pi) / 2) ** 2 >= float(sin2) * (1 - 1e-11)
    assert bound <= 2 * math.asin(math.sqrt(float(sin2))) * (1 + 1e-11) + 1e-300


def test_the_angle_bound_is_above_the_angle_to_the_last_bit():
    """sin^2 of doubles and of numbers between them, by ball arithmetic."""
    with ctx.workprec(200):
        for k in range(1, 400):
            sin2 = Fraction(k, 401) ** (1 + k % 7)
            exact = 2 * (arb(sin2.numerator) / sin2.denominator).sqrt().asin()
            assert arb(half_angle_bound(sin2)) > exact


def test_the_angle_bound_of_nearly_half_a_turn_is_above_the_angle():
    """There the sine hardly changes with the angle: its last bit is worth 1e-8 radians."""
    near = [1 - Fraction(1, k) for k in range(2, 40)]
    near += [1 - Fraction(k, 2**60) for k in range(1, 3000, 37)]
    with ctx.workprec(200):
        for sin2 in near:
            bound = half_angle_bound(sin2)
            exact = 2 * (arb(sin2.numerator) / sin2.denominator).sqrt().asin()
            assert exact < arb(bound) < exact * (1 + 2e-12) or bound == math.pi


def test_the_angle_bound_never_exceeds_half_a_turn():
    assert half_angle_bound(Fraction(10**400)) == math.pi


TINY = Fraction(1, 10**400)  # below the least double
ENDS = [1.0, 0.1, 3.0, 2.0**60, 5e-324, 1.7976931348623157e308]


@pytest.mark.parametrize("double", ENDS)
def test_values_just_beside_a_double_are_rounded_to_its_neighbour(double: float):
    exact = Fraction(double)
    beside = exact * Fraction(1, 10**30)

    assert double_above(exact) == double_below(exact) == double
    assert double_above(exact - beside) == double
    assert double_below(exact + beside) == double
    assert double_above(exact + beside) == math.nextafter(double, math.inf)
    assert double_below(exact - beside) == math.nextafter(double, 0.0)


@pytest.mark.parametrize("value", [Fraction(1, 10), Fraction(3), Fraction(10**50, 7), TINY])
@pytest.mark.parametrize("bits", [3, 17, 53])
def test_a_dyadic_bound_is_the_nearest_of_its_exponent_on_its_side(value: Fraction, bits: int):
    for bound, rounded in (
        (dyadic_above(value, bits), math.ceil),
        (dyadic_below(value, bits), math.floor),
    ):
        mantissa = value / Fraction(2) ** bound.exponent

        assert bound.mantissa == rounded(mantissa)
        assert bits - 1 <= math.floor(mantissa).bit_length() <= bits


@pytest.mark.parametrize("exponent", [0, 1, 2, 3, 128, 129, 130, 131, -128, -130, -131, 700])
@pytest.mark.parametrize("odd", [1, 5])
def test_a_root_above_is_the_least_integer_of_65_bits_that_is_not_below(exponent: int, odd: int):
    value = odd * Fraction(2) ** exponent
    for beside in (value, value * (1 + TINY), value * (1 - TINY)):
        root = dyadic_root_above(beside)
        squared = beside / Fraction(4) ** root.exponent

        assert (root.mantissa - 1) ** 2 < squared <= root.mantissa**2
    assert dyadic_root_above(Fraction(1)) == Dyadic(mantissa=1 << 64, exponent=-64)
    assert dyadic_root_above(Fraction(2)).exponent == -64
    assert dyadic_root_above(Fraction(4)) == Dyadic(mantissa=1 << 64, exponent=-63)


def test_bounds_of_nothing_are_written_with_exponent_0():
    nothing = Dyadic(mantissa=0, exponent=0)

    assert dyadic_root_above(Fraction(0)) == nothing
    assert dyadic_above(Fraction(0), 9) == dyadic_below(Fraction(0), 9) == nothing


def test_a_sine_too_small_for_a_double_has_an_angle_above_it():
    assert half_angle_bound(TINY) > 2e-162


@pytest.mark.parametrize("less", [Fraction(1, 10**6), Fraction(1, 10**14), Fraction(1, 10**30)])
def test_the_angle_bound_is_close_near_half_a_turn_and_pi_from_there_on(less: Fraction):
    rest = 2.0 * math.sqrt(less)

    assert math.pi - rest * (1 + 1e-5) - 1e-12 < half_angle_bound(1 - less)
    assert half_angle_bound(1 - less) <= max(
        math.pi - rest * (1 - 1e-5), math.nextafter(math.pi, 3.0)
    )
    assert half_angle_bound(1 + less) == half_angle_bound(Fraction(3, 2)) == math.pi
