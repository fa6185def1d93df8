"""What is proved of eigenlines of integer clouds: counts, energies and bounds beside exact ones."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from certreg.equilibrium.breaking import (
    _eigenline,
    _splits,
    eigenlines,
    energy_is_at_least,
)
from certreg.errors import UndecidedError
from certreg.objective.isotropic import Isotropic
from certreg.problem.problem import RegistrationProblem

TINY = Fraction(1, 1 << 90)
AXES = np.vstack([np.eye(3), -np.eye(3)])


def stretched(*factors: float) -> Isotropic:
    """Twice these on the diagonal of C: the eigenvalues are sums of theirs, with even signs."""
    return Isotropic.of(RegistrationProblem(AXES, AXES * factors))


@pytest.mark.parametrize("factors", [(3, 2, 1), (5, 5, -1), (1, 1, 1), (4, 0, 0)])
def test_the_least_energy_is_at_least_itself_and_no_more(factors: tuple[int, int, int]):
    """6 + 2 sum d^2 - 2 l1, l1 = 2 (d1 + d2 + d3), in units of one spring."""
    least = Fraction(6 + 2 * sum(d * d for d in factors) - 4 * sum(factors))
    objective = stretched(*factors)

    assert energy_is_at_least(objective, least)
    assert energy_is_at_least(objective, least - TINY)
    assert not energy_is_at_least(objective, least + TINY)


def test_a_number_splits_eigenvalues_where_so_many_are_above_it_and_none_is_there():
    objective = stretched(7, 2, 1)
    values = [space.value for space in objective.eigenspaces.spaces]

    for above in range(1, 4):
        upper, lower = values[above - 1 : above + 1]
        for count in range(5):
            assert _splits(objective, upper + lower, count) is (count == above)
            assert not _splits(objective, 2 * lower, count)  # twice an eigenvalue
        assert _splits(objective, 2 * lower + 2, above)
        assert _splits(objective, 2 * upper - 2, above)


@pytest.mark.parametrize("place", range(4))
@pytest.mark.parametrize("towards", range(4))
def test_an_eigenline_is_within_its_bound_whichever_gap_is_narrow(place: int, towards: int):
    """Eigenvalues 43.8, 28.2, -35.8, -36.2, and a quaternion 2^-10 off to one of the others."""
    objective = stretched(18, 2, 1.9)
    marks = [None, *(Fraction(k) for k in (36, -4, -36)), None]
    own, other = objective.eigenvectors[place], objective.eigenvectors[towards]
    w, x, y, z = (a + (b >> 10 if towards != place else 0) for a, b in zip(own, other, strict=True))
    line = _eigenline(objective, (w, x, y, z), 1, place, (marks[place], marks[place + 1]))
    off = Fraction(0) if towards == place else Fraction(1, 1 + (1 << 20))

    assert line.sin2 is not None
    assert line.sin2 >= off * (1 - Fraction(1, 1 << 40))
    assert abs(objective.eigenvalues[place] - objective.alignment(line.quaternion)) <= line.error


def test_an_eigenvalue_that_may_be_beyond_a_mark_is_not_decided():
    objective = stretched(3, 2, 1)
    first, second, *_ = objective.eigenvectors
    w, x, y, z = (a + (b >> 10) for a, b in zip(first, second, strict=True))
    value = objective.alignment((w, x, y, z))
    error = _eigenline(objective, (w, x, y, z), 1, 0, (None, Fraction(0))).error

    assert error > 0
    for beyond in (Fraction(0), TINY):
        for between in (
            (None, value - error - beyond),
            (value + error + beyond, None),
            (value + 1, value - error - beyond),
        ):
            if beyond:
                assert _eigenline(objective, (w, x, y, z), 1, 0, between).error == error
                continue
            with pytest.raises(UndecidedError, match="was not found to the precision asked for"):
                _eigenline(objective, (w, x, y, z), 1, 0, between)


def test_a_continuum_has_no_angle():
    first, second = eigenlines(stretched(4, 0, 0))

    assert (first.index, second.index) == (0, 2)
    assert first.sin2 is second.sin2 is None
