"""Bounds of a problem with a free scale, beside exact roots: perfect squares, and their sides."""

from __future__ import annotations

from fractions import Fraction
from math import isqrt

import pytest

from certreg.objective.scaling import ROOT_BITS, Scaling, root_bounds
from certreg.problem.motion import Scale

PLACES = 10**100
FREE = Scaling(Scale.ASYMMETRIC, Fraction(4), Fraction(9))
EVEN = Scaling(Scale.SYMMETRIC, Fraction(4), Fraction(9))
ROUGH = Scaling(Scale.SYMMETRIC, Fraction(3), Fraction(7))
STEP = Fraction(1, 2**ROOT_BITS)


def root(value: Fraction) -> tuple[Fraction, Fraction]:
    """Numbers 1e-100 apart, with the root between."""
    low = isqrt(value.numerator * PLACES**2 // value.denominator)
    return Fraction(low, PLACES), Fraction(low + 1, PLACES)


@pytest.mark.parametrize("exponent", [0, 1, 2, 3, 479, 480, 481, 482, 483, 700, -1, -480, -900])
@pytest.mark.parametrize("odd", [Fraction(1), Fraction(5, 3), 1 - Fraction(1, PLACES**4)])
def test_a_root_is_between_its_bounds_which_are_neighbours(exponent: int, odd: Fraction):
    value = odd * Fraction(2) ** exponent
    low, high = root_bounds(value)

    assert low**2 <= value < high**2
    assert 0 < high - low <= low * 2 * STEP


def test_bounds_of_a_root_have_so_many_bits():
    assert root_bounds(Fraction(1)) == (1, 1 + STEP)
    assert root_bounds(Fraction(2))[1] - root_bounds(Fraction(2))[0] == STEP
    assert root_bounds(Fraction(4)) == (2, 2 + 2 * STEP)


@pytest.mark.parametrize("scaling", [EVEN, ROUGH])
def test_a_symmetric_energy_is_below_the_true_one_by_the_slack_at_most(scaling: Scaling):
    low, high = root(scaling.source * scaling.target)
    for alignment in (Fraction(-2), Fraction(1, 3), Fraction(4)):
        energy = scaling.energy(alignment)

        assert energy <= 2 * (high - alignment)
        assert 2 * (low - alignment) <= energy + scaling.slack + Fraction(4, PLACES)
    assert 0 < scaling.slack <= 8 * STEP * low
    assert scaling.energy(Fraction(10)) == 0
    assert FREE.slack == 0


def test_the_least_gap_of_a_symmetric_scale_takes_all_of_the_slack():
    low, high = root_bounds(Fraction(36))

    assert (low, high) == (6, 6 + 4 * STEP)
    assert EVEN.slack == 2 * (high - low)
    assert EVEN.energy(Fraction(1)) == 10


def test_a_free_scale_is_best_where_the_energy_is_least():
    assert FREE.best(Fraction(3)) == Fraction(3, 4)
    assert FREE.best(Fraction(-3)) == 0
    assert FREE.energy(Fraction(3)) == 9 - Fraction(9, 4)
    assert FREE.energy(Fraction(-3)) == FREE.energy(Fraction(0)) == 9
    assert FREE.energy(Fraction(1, 2)) == 9 - Fraction(1, 16)
    assert EVEN.best(Fraction(3)) == Fraction(3, 2)
    assert ROUGH.best(Fraction(1)) <= root(Fraction(7, 3))[1]
    assert ROUGH.best(Fraction(1)) >= root(Fraction(7, 3))[0] * (1 - 2 * STEP)


def test_the_energy_at_any_scale_is_the_sum_of_squares():
    at = Fraction(1), Fraction(1, 2), Fraction(1, 5)

    assert FREE.energy_at(*at) == 9 - 1 + 1 + Fraction(1, 5)
    assert EVEN.energy_at(*at) == 2 * (9 + Fraction(1, 5))


def test_the_range_of_energies_is_bounded_from_the_trace_or_an_alignment():
    squares = Fraction(12)  # of eigenvalues 1, 1, 1, -3: l1 = 1, and l1^2 / Sxx = 1/4

    assert FREE.least_range(Fraction(0), squares) == Fraction(1, 16)
    assert FREE.least_range(Fraction(1), squares) == Fraction(1, 16)
    assert FREE.least_range(Fraction(1, 2), squares) == Fraction(1, 16)
    assert FREE.least_range(Fraction(2), squares) == 1
    assert FREE.least_range(Fraction(-2), squares) == Fraction(1, 16)
    assert FREE.least_range(Fraction(1, 2), Fraction(0)) == Fraction(1, 256)
    assert FREE.least_range(Fraction(-2), Fraction(0)) == 0
    assert EVEN.least_range(Fraction(2), squares) == 48


def test_the_gap_is_that_of_the_largest_eigenvalue_that_is_left_open():
    a, delta = Fraction(3), Fraction(1, 8)

    assert FREE.gap(a, delta) == FREE.energy(a) - FREE.energy(a + delta)
    assert EVEN.gap(a, delta) == EVEN.energy(a) - EVEN.energy(a + delta)


@pytest.mark.parametrize("alignment", [Fraction(1, 3), Fraction(2)])
def test_the_scale_at_the_optimum_is_in_its_interval(alignment: Fraction):
    delta = Fraction(1, 7)
    low, high = FREE.interval(alignment, delta)
    tight = 1 + Fraction(1, 2**94)

    assert low.value <= alignment / 4 <= low.value * tight
    assert high.value / tight <= (alignment + delta) / 4 <= high.value
    for scaling in (EVEN, ROUGH):
        below, above = root(scaling.target / scaling.source)
        low, high = scaling.interval(alignment, delta)

        assert low.value <= above
        assert below <= high.value <= above * tight
        assert below <= low.value * tight
