"""Basins, thick sources and scales that never vanish: each limit on both sides of equality."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import product

import numpy as np
import pytest

from certreg.dynamics import body
from certreg.dynamics.body import basin_gaps, certified_basin, clearly_thick
from certreg.errors import DegenerateProblemError
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem
from certreg.registration.simulation import never_collapses

AXES = np.array([sign * row for row in np.eye(3) for sign in (1.0, -1.0)])


def of_axes(diagonal: list[float], here: int = 0, there: int = 0, weight: float = 1.0) -> Isotropic:
    """C = 2 w diag(d), over six points, in units of 2^here and 2^there."""
    source, target = np.ldexp(AXES, here), np.ldexp(AXES * diagonal, there)
    return Isotropic(exact_moments(RegistrationProblem(source, target, weights=np.full(6, weight))))


def drops(diagonal: list[float]) -> list[Fraction]:
    """l1 - lk over the mass, 0 for the optima: lk = 2 w sum d r at the turns diag(r)."""
    turns = [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]
    values = [Fraction(sum(a * b for a, b in zip(diagonal, turn, strict=True))) for turn in turns]
    return sorted((max(values) - value) / 3 for value in values)


@pytest.mark.parametrize("diagonal", [[4, 3, 2], [2, 1, -1], [1, 1, 1], [7, 2, -5]])
@pytest.mark.parametrize("exponents", [(0, 0, 0), (3, -5, 2), (-7, 1, -400), (2, 2, 400)])
@pytest.mark.parametrize("weight", [1.0, 0.375])
def test_the_gaps_of_a_basin_are_those_of_the_eigenvalues_over_the_mass(
    diagonal, exponents: tuple[int, int, int], weight: float
):
    here, there, unit = exponents
    objective = of_axes(diagonal, here, there, weight)
    worth = Fraction(2) ** (here + there - 2 * unit)
    expected = [float(drop * worth) for drop in drops(diagonal)]
    optima = expected.count(0.0)
    gaps = certified_basin(objective, unit).gaps.tolist()

    assert gaps == pytest.approx(expected, rel=1e-15, abs=0.0)
    assert gaps[:optima] == [0.0] * optima
    assert basin_gaps(objective, unit) == gaps[optima:]


def test_a_basin_is_given_from_the_smallest_barrier_on(monkeypatch):
    objective = of_axes([4, 3, 2])
    least, *_ = gaps = basin_gaps(objective, 0)
    monkeypatch.setattr(body, "SMALLEST_BARRIER", least)
    assert basin_gaps(objective, 0) == gaps
    monkeypatch.setattr(body, "SMALLEST_BARRIER", math.nextafter(least, math.inf))
    with pytest.raises(DegenerateProblemError, match="hardly turn") as refused:
        certified_basin(objective, 0)
    assert refused.value.value == least


def test_where_every_pose_is_optimal_there_is_no_barrier():
    assert basin_gaps(of_axes([0, 0, 0]), 0) == []


def determinant(upper: list[Fraction]) -> Fraction:
    a, b, c, d, e, f = upper
    return a * d * f + 2 * b * c * e - a * e * e - d * c * c - f * b * b


@pytest.mark.parametrize("trace", [Fraction(1, 2), Fraction(1), Fraction(2), Fraction(4)])
def test_a_source_is_thick_at_a_glance_above_a_share_of_its_trace(monkeypatch, trace: Fraction):
    """Entries in eighths, so that doubles are exact; the limit is set to what is equal, too."""
    little = Fraction(1, 1 << 20)
    for b, c, e, a in product((-1, 0, 1, 2), (-1, 1, 2), (-2, 0, 1), (1, 3, 5)):
        eighths = [a, b, c, a + 2, e, 8 - 2 * a - 2]
        upper = [Fraction(entry, 8) * trace for entry in eighths]
        share = 4 * determinant(upper) / (trace * trace * max(1, trace))
        for limit in (share - little, share, share + little):
            monkeypatch.setattr(body, "CLEARLY_THICK", float(limit))
            thick = clearly_thick([float(entry) for entry in upper])

            assert thick == (share > limit), (eighths, limit)


def test_what_is_thick_at_a_glance_has_no_eigenvalue_below_its_bound():
    rng = np.random.default_rng(4)
    for thin in (1e-11, 1e-10, 1e-9, 1e-3, 1.0):
        for _ in range(20):
            turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
            full = rng.uniform(0.1, 9.0) * turn @ np.diag([thin, 1.0, rng.uniform(0, 2)]) @ turn.T
            if clearly_thick(full[np.triu_indices(3)].tolist()):
                assert np.linalg.eigvalsh(full)[0] >= body.CLEARLY_THICK


@pytest.mark.parametrize("scale", ["none", "asymmetric"])
@pytest.mark.parametrize("factors", [(1.0, 1.0, 1.0), (3.0, 2.0, 1.0), (1.0, 0.5, 0.25)])
def test_a_body_released_keeps_its_size_below_the_energy_of_a_point(scale, factors):
    """Of target = B source, released at scale 1: V - Syy = Sxx - 2 tr C + M |shift|^2."""
    for weight, shift in product((1.0, 0.375), (0.0, 0.5, 1.0, math.nextafter(1.0, 0.0), 2.0)):
        for times in (0.25, 0.5, math.nextafter(0.5, 1.0), 1.0, 4.0):
            target = AXES * (times * np.array(factors)) + np.array([shift, 0.0, 0.0])
            problem = RegistrationProblem(AXES, target, weights=np.full(6, weight), scale=scale)
            alignment = sum(Fraction(times * factor) for factor in factors)
            above = 6 - 4 * alignment + 6 * Fraction(shift) ** 2

            assert never_collapses(Isotropic.of(problem)) == (above < 0), (weight, shift, times)
