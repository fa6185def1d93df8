"""Bounds of a free scale and of its energies, beside the numbers themselves."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import pytest

from certreg.objective.scaling import Scaling, root_bounds
from certreg.problem.motion import Scale

SPREADS = [(2, 3), (2, 1), (1, 3), (5, 1), (1, 6), (7, 1), (4, 9)]  # with roots of both halves
TRACELESS = [  # eigenvalues of Davenport's matrix
    diagonal
    for diagonal in product(range(-3, 4), repeat=4)
    if not sum(diagonal) and list(diagonal) == sorted(diagonal, reverse=True)
]


def of(kind: Scale, source: int, target: int) -> Scaling:
    return Scaling(kind, Fraction(source), Fraction(target))


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
