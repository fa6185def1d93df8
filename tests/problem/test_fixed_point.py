"""Sums in fixed point, of every compiled variant, against integers by definition.

The edges are those of native/fixed.c: what fits, and where it takes more digits. With the largest
number m 2^e and the smallest m' 2^f, 1 <= m, m' < 2, a cloud takes e - f + 53 bits.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from engines import libraries_of_all_variants
from hypothesis import given, settings
from hypothesis import strategies as st

from certreg import RegistrationProblem
from certreg.native.sums import fixed_point_fits, sums_in_fixed_point
from certreg.problem import exact_sums
from certreg.problem.exact_sums import FACTORS, PRODUCTS

ONES = 2.0 - 2.0**-52  # all 53 bits
CLOUD_SPAN, WEIGHT_SPAN = 50, 51  # e - f: 103 and 104 bits
VECTORS = 8
GATHERED = 1024 * VECTORS  # points until totals are gathered


@pytest.fixture(scope="module")
def libraries():
    """The library of each variant that this processor runs, the widest last."""
    return libraries_of_all_variants()


def by_definition(source, target, weights):
    """The 28 sums, point by point, of what Python's integers make of the doubles."""
    sides = [[list(map(over_least, row)) for row in side.tolist()] for side in (source, target)]
    w = list(map(over_least, weights.tolist()))
    rows = [(*x, *y) for x, y in zip(*sides, strict=True)]
    return [
        sum(w),
        *(sum(v * row[i] for v, row in zip(w, rows, strict=True)) for i in range(6)),
        *(sum(v * row[i] * row[j] for v, row in zip(w, rows, strict=True)) for i, j in PRODUCTS),
    ]


def over_least(value):
    """The integer that a double is over 2^-1074."""
    above, below = value.as_integer_ratio()
    return above * (2**1074 // below)


def as_stated(found):
    """Sums over 2^-1074 to the power of the number of factors; exponents are as large as can be."""
    a, b, c = (
        -1074 if e is None else e
        for e in (found.source_exponent, found.target_exponent, found.weight_exponent)
    )
    return [
        k * 2 ** (c + 1074 + x * (a + 1074) + y * (b + 1074))
        for k, (x, y) in zip(found.integers, FACTORS, strict=True)
    ]


def exponent_of(values):
    """Of the lowest bit that is set anywhere."""
    present = [abs(over_least(value)) for value in values.ravel().tolist() if value]
    return min((k & -k).bit_length() for k in present) - 1075 if present else None


def block_of(source, target, weights=None):
    return RegistrationProblem(source, target, weights=weights).block(slice(None))


def summed(library, block):
    """Fails where the numbers do not fit."""
    assert fixed_point_fits(library, block.source, block.target, exact_sums._unequal(block.weights))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(exact_sums, "_by_limbs", None)
        return exact_sums._by_fixed_point(library, block)


def taken(library, source, target, weights=None):
    """Whether they fit, which both functions must say."""
    block = block_of(source, target, weights)
    given = (block.source, block.target, exact_sums._unequal(block.weights))
    fits = fixed_point_fits(library, *given)
    assert fits is (sums_in_fixed_point(library, *given) is not None)
    return fits


@st.composite
def fitting_blocks(draw):
    """Doubles over all normal exponents, within what fits; zeros, signs, ties, patterns of bits."""
    n = draw(st.integers(1, 19))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))

    def some(shape, span):
        last = draw(st.integers(0, span))
        first = draw(st.one_of(st.integers(-1022, 1022 - last), st.integers(-3, 3)))
        exponents = first + rng.integers(0, last + 1, size=shape)
        bits = draw(st.sampled_from([0, 3, 52]))
        pattern = rng.integers(0, 2**bits, size=shape) << (52 - bits)
        if draw(st.booleans()):
            pattern[...] = 2**52 - 1
        numbers = np.ldexp(1.0 + pattern / 2.0**52, exponents)
        return numbers * (rng.random(shape) < draw(st.sampled_from([0.0, 0.5, 1.0, 1.0])))

    signs = rng.choice([-1.0, 1.0], size=(2, n, 3))
    clouds = [some((n, 3), CLOUD_SPAN) * sign for sign in signs]
    weights = draw(st.sampled_from([1.0, 0.3, None]))
    if weights is None:
        weights = some(n, WEIGHT_SPAN)
        weights[0] = weights[0] or weights.max() or 1.0
    return block_of(clouds[0], clouds[1], weights)


@pytest.mark.slow
@given(fitting_blocks())
@settings(max_examples=60)
def test_every_variant_gives_the_integers_of_the_definition(libraries, block):
    expected = by_definition(block.source, block.target, block.weights)
    lowest = [exponent_of(part) for part in (block.source, block.target, block.weights)]
    for library in libraries:
        found = summed(library, block)

        assert as_stated(found) == expected
        assert [found.source_exponent, found.target_exponent, found.weight_exponent] == lowest


def extremes(n, span, sign=1.0):
    """Points of the largest size, and one of the smallest that makes them take all their bits."""
    cloud = np.full((n, 3), sign * np.ldexp(ONES, span))
    cloud[-1] = 1.0
    return cloud


def expected_of(block):
    """By definition, of points that are all the same but for the last."""
    parts = (block.source, block.target, block.weights)
    first, last = (
        by_definition(*[part[rows] for part in parts]) for rows in (slice(1), slice(-1, None))
    )
    return [(len(block.weights) - 1) * one + other for one, other in zip(first, last, strict=True)]


# Spans of both clouds, and of the weights: with 54 + span bits of a cloud and 53 + span of weights,
# products of the highest digits are below 2^52, and one multiplication less is made, where 2 cloud
# <= 156 without weights, and weight + 2 cloud <= 208 with them.
SPANS = [
    *[(span, None) for span in (0, 24, 25, CLOUD_SPAN)],
    *[(0, span) for span in (0, 47, 48, WEIGHT_SPAN)],
    *[(23, span) for span in (1, 2)],
    (24, 0),
    (CLOUD_SPAN, WEIGHT_SPAN),
]


@pytest.mark.one_in(4)
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("span", "weight"), SPANS)
def test_no_total_overflows_and_no_digit_is_lost_at_the_edges(libraries, span, weight, sign):
    n = 5 * GATHERED + 1
    weights = None if weight is None else extremes(n, weight)[:, 0]
    block = block_of(extremes(n, span, sign), extremes(n, span), weights)
    expected = expected_of(block)

    for library in libraries:
        assert as_stated(summed(library, block)) == expected


@pytest.mark.parametrize("n", [1, 7, 8, 9, 127, 128, 129, GATHERED - 1, GATHERED, GATHERED + 1])
@pytest.mark.parametrize("weight", [None, 3])
def test_every_point_counts_wherever_vectors_and_blocks_end(libraries, n, weight):
    weights = None if weight is None else extremes(n, weight)[:, 0]
    block = block_of(extremes(n, 20, -1.0), extremes(n, 9), weights)

    for library in libraries:
        assert as_stated(summed(library, block)) == expected_of(block)


def test_what_takes_more_bits_is_refused(libraries):
    plain = np.ones((2, 3))
    for library in libraries:
        for cloud, fits in ((extremes(2, CLOUD_SPAN), True), (extremes(2, CLOUD_SPAN + 1), False)):
            assert taken(library, cloud, plain) is fits
            assert taken(library, plain, cloud) is fits
        assert taken(library, plain, plain, extremes(2, WEIGHT_SPAN)[:, 0])
        assert not taken(library, plain, plain, extremes(2, WEIGHT_SPAN + 1)[:, 0])


@pytest.mark.parametrize(
    ("value", "fits"),
    [
        (2.0**-1022, True),  # the least normal number
        (2.0**-1022 - 2.0**-1074, False),
        (np.ldexp(ONES, 1022), True),
        (2.0**1023, False),
        (0.0, True),
        (-0.0, True),
    ],
)
def test_numbers_at_the_ends_of_the_doubles(libraries, value, fits):
    plain, alike = np.ones((2, 3)), np.full((2, 3), value)
    for library in libraries:
        assert taken(library, alike, plain) is fits
        assert taken(library, plain, alike) is fits
        if fits:
            block = block_of(alike, plain)
            expected = by_definition(block.source, block.target, block.weights)
            assert as_stated(summed(library, block)) == expected


def test_negative_weights_are_refused_and_negative_zeros_are_not(libraries):
    plain = np.ones((2, 3))
    for library in libraries:
        assert sums_in_fixed_point(library, plain, plain, np.array([1.0, -0.0])) is not None
        assert sums_in_fixed_point(library, plain, plain, np.array([1.0, -1e-9])) is None


def test_more_points_than_totals_of_128_bits_take_are_refused(libraries):
    points = np.zeros((2**20 + 1, 3))
    for library in libraries:
        assert fixed_point_fits(library, points[1:], points[1:], None)
        assert not fixed_point_fits(library, points, points, None)


def test_the_processor_is_asked_whether_it_multiplies_digits(libraries):
    flags = Path("/proc/cpuinfo")
    if not flags.exists():
        pytest.skip("this system does not say what its processor has")
    words = set(flags.read_text("utf-8").partition("flags")[2].partition("\n")[0].split())
    for library in libraries:
        wide = "x86-64-v4" in library.words and "avx512ifma" in words
        assert library.multiplies_digits is wide
