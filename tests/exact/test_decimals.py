"""Numbers in words are on the stated side of the number, and next to it."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest
from flint import arb, ctx
from hypothesis import given
from hypothesis import strategies as st

from certreg.exact.decimals import as_given, at_least, at_most
from certreg.exact.dyadic import degrees_above

positive = st.builds(
    lambda n, d, e: Fraction(n, d) * Fraction(10) ** e,
    st.integers(1, 10**12),
    st.integers(1, 10**12),
    st.integers(-400, 400),
)


@given(positive, st.integers(1, 9))
def test_both_sides_are_next_to_each_other(value: Fraction, digits: int):
    below, above = Fraction(at_least(value, digits)), Fraction(at_most(value, digits))

    assert below <= value <= above
    assert above - below <= value / 10 ** (digits - 1)
    assert (below == above) == (value == below)


@pytest.mark.parametrize(
    ("value", "below", "above"),
    [
        (Fraction(1) - Fraction(1, 10**40), "0.999", "1"),
        (Fraction(1), "1", "1"),
        (Fraction(1) + Fraction(1, 10**40), "1", "1.01"),
        (math.nextafter(5.0, 0.0), "4.99", "5"),
        (math.nextafter(5.0, 9.0), "5", "5.01"),
        (0.1, "0.1", "0.101"),  # the double is above a tenth
        (Fraction(1, 10), "0.1", "0.1"),
        (Fraction(12345, 10**8), "0.000123", "0.000124"),
        (Fraction(12345, 10**9), "1.23e-5", "1.24e-5"),
        (0.0, "0", "0"),
    ],
)
def test_a_number_beside_a_decimal_keeps_its_side(value: Fraction | float, below: str, above: str):
    assert Fraction(at_least(value)) == Fraction(below)
    assert Fraction(at_most(value)) == Fraction(above)


def test_numbers_below_a_ten_thousandth_are_written_with_an_exponent():
    assert at_least(Fraction(101, 10**6)) == "0.000101"
    assert at_least(Fraction(999, 10**7)) == "9.99e-5"


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_given_number_is_read_as_the_same_double(value: float):
    assert math.copysign(1.0, float(as_given(value))) == math.copysign(1.0, value)
    assert float(as_given(value)) == value


def test_a_given_number_is_printed_as_it_is_written():
    given_ = ("5", "0.05", "0.9999996", "1e-06", "1.23456789e-05", "1e+22", "123456.7")

    assert [as_given(float(text)) for text in given_] == list(given_)


@given(st.floats(1e-300, math.pi))
def test_degrees_are_no_fewer_than_radians_say(angle: float):
    with ctx.workprec(200):
        exact = arb(angle) * 180 / arb.pi()
        assert exact < arb(degrees_above(angle)) < exact * (1 + 2e-15)


def test_small_numbers_have_an_exponent_and_nothing_and_negative_ones_have_none():
    assert (at_most(0.0), at_least(-0.5), at_most(-0.00025)) == ("0", "-0.5", "-0.000250")
    assert (at_most(1e-7), at_least(1.2345e-5)) == ("1.00e-7", "1.23e-5")
