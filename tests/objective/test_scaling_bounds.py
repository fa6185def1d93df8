"""Bounds of a free scale and of its energies, beside the numbers themselves and exact roots."""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from math import isqrt

import pytest

from certreg.objective.scaling import ROOT_BITS, SCALINGS, Scaling, SymmetricScaling, root_bounds
from certreg.problem.motion import Scale

PLACES = 10**100
FREE = Scaling(Fraction(4), Fraction(9))
EVEN = SymmetricScaling(Fraction(4), Fraction(9))
ROUGH = SymmetricScaling(Fraction(3), Fraction(7))
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


def test_what_a_rotation_costs_more_than_the_best_is_exact():
    low, best = Fraction(1), Fraction(3)

    assert FREE.lost(low, best) == Fraction(9 - 1, 4)
    assert ROUGH.lost(low, best) == 4
    assert FREE.lost(Fraction(-1), best) == FREE.lost(Fraction(0), best) == Fraction(9, 4)


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


SPREADS = [(2, 3), (2, 1), (1, 3), (5, 1), (1, 6), (7, 1), (4, 9)]  # with roots of both halves
TRACELESS = [  # eigenvalues of Davenport's matrix
    diagonal
    for diagonal in product(range(-3, 4), repeat=4)
    if not sum(diagonal) and list(diagonal) == sorted(diagonal, reverse=True)
]


def of(kind: Scale, source: int, target: int) -> Scaling:
    return SCALINGS[kind](Fraction(source), Fraction(target))


@pytest.mark.parametrize("diagonal", TRACELESS)
def test_a_bound_of_the_range_is_at_most_the_range_of_all_rotations(diagonal: tuple[int, ...]):
    """At the best rotation, or at none; met by (1, 1, 1, -3), and by (1, 1, -1, -1)."""
    most, least = Fraction(max(diagonal)), Fraction(min(diagonal))
    squares = Fraction(sum(k * k for k in diagonal))
    free, symmetric = of(Scale.ASYMMETRIC, 7, 50), of(Scale.SYMMETRIC, 7, 50)
    own = free.energy(least) - free.energy(most)
    mirrored = 2 * (most - least)

    assert free.least_range(most, squares) == own**2
    assert free.least_range(Fraction(0), squares) <= own**2
    assert symmetric.least_range(most, squares) <= mirrored**2
    if diagonal == (1, 1, 1, -3):
        assert free.least_range(least, squares) == own**2
    if diagonal == (1, 1, -1, -1):
        assert symmetric.least_range(most, squares) == mirrored**2


@pytest.mark.parametrize(("source", "target"), SPREADS)
def test_a_symmetric_energy_is_below_the_true_one_by_its_slack_at_most(source: int, target: int):
    """2 sqrt(Sxx Syy) - 2 a, squared to be compared."""
    symmetric = of(Scale.SYMMETRIC, source, target)
    for alignment in (Fraction(0), Fraction(1, 3), Fraction(-2)):
        energy = symmetric.energy(alignment)
        lower, upper = (energy / 2 + alignment, (energy + symmetric.slack) / 2 + alignment)

        assert lower**2 <= source * target < upper**2
    assert of(Scale.ASYMMETRIC, source, target).slack == 0


@pytest.mark.parametrize("delta", [Fraction(0), Fraction(1, 3)])
@pytest.mark.parametrize(("source", "target"), SPREADS)
def test_the_best_scale_is_within_its_interval(source: int, target: int, delta: Fraction):
    """s = l1 / Sxx, a <= l1 < a + delta; or s^2 = Syy / Sxx."""
    alignment = Fraction(5, 7)
    low, high = of(Scale.ASYMMETRIC, source, target).interval(alignment, delta)
    least, most = of(Scale.SYMMETRIC, source, target).interval(alignment, delta)

    assert low.value * source <= alignment <= alignment + delta <= high.value * source
    assert (high.value - low.value) * source - delta < Fraction(1, 1 << 90)
    assert least.value**2 * source <= target < most.value**2 * source
    assert most.value - least.value < Fraction(1, 1 << 90)


@pytest.mark.parametrize("delta", [Fraction(0), Fraction(1, 3), Fraction(4)])
@pytest.mark.parametrize("alignment", [Fraction(0), Fraction(5, 7)])
def test_the_gap_is_what_the_energy_falls_to_the_largest_eigenvalue(
    alignment: Fraction, delta: Fraction
):
    for kind in (Scale.ASYMMETRIC, Scale.SYMMETRIC):
        scaling = of(kind, 4, 400)  # whose root is an integer
        falls = scaling.energy(alignment) - scaling.energy(alignment + delta)
        assert abs(scaling.gap(alignment, delta) - falls) <= scaling.slack


@pytest.mark.parametrize("shift", [-301, -1, 0, 1, 300])
@pytest.mark.parametrize("value", [Fraction(1), Fraction(2), Fraction(1, 3), Fraction(15, 7)])
def test_a_root_is_between_its_bounds_and_they_are_near(value: Fraction, shift: int):
    low, high = root_bounds(value * Fraction(2) ** shift)

    assert low**2 <= value * Fraction(2) ** shift < high**2
    assert high - low <= low / (1 << 238)
