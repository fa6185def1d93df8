from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
import strategies
from hypothesis import given

from certreg.exact.dyadic import power_of_two
from certreg.problem.moments import (
    EIGENVALUE_ROUNDING,
    davenport_error,
    exact_moments,
    floating_moments,
    rounding_of,
)


def definition(problem):
    """C, S2, spread of the target and means by their definitions, in fractions, point by point."""
    x = [[Fraction(v) for v in row] for row in problem.source.tolist()]
    y = [[Fraction(v) for v in row] for row in problem.target.tolist()]
    w = [Fraction(v) for v in problem.weights.tolist()]
    mass = sum(w)
    mx = [sum(a * r[k] for a, r in zip(w, x, strict=True)) / mass for k in range(3)]
    my = [sum(a * r[k] for a, r in zip(w, y, strict=True)) / mass for k in range(3)]
    dx = [[r[k] - mx[k] for k in range(3)] for r in x]
    dy = [[r[k] - my[k] for k in range(3)] for r in y]
    points = list(zip(w, dx, dy, strict=True))
    C = [[sum(a * q[i] * p[j] for a, p, q in points) for j in range(3)] for i in range(3)]
    S = [[sum(a * p[i] * p[j] for a, p, _ in points) for j in range(3)] for i in range(3)]
    T = sum(a * q[i] ** 2 for a, _, q in points for i in range(3))
    return mass, mx, my, C, S, T


@pytest.mark.slow
@given(strategies.problems())
def test_exact_moments_are_those_of_the_definition(problem):
    mass, mx, my, C, S, T = definition(problem)
    m = exact_moments(problem)
    scatter_unit = power_of_two(m.weight_exponent + 2 * m.source_exponent) / m.mass

    assert m.total_weight == mass
    assert list(m.source_centroid) == mx
    assert list(m.target_centroid) == my
    assert [[m.cross_unit * e for e in row] for row in m.cross] == C
    assert [[scatter_unit * e for e in row] for row in m.source_scatter] == S
    assert m.spread == T + S[0][0] + S[1][1] + S[2][2]


@pytest.mark.slow
@given(strategies.problems())
def test_moments_do_not_depend_on_the_order_of_the_points(problem):
    from certreg import RegistrationProblem

    turned = RegistrationProblem(
        problem.source[::-1], problem.target[::-1], weights=problem.weights[::-1]
    )

    assert exact_moments(turned).cross == exact_moments(problem).cross


@pytest.mark.parametrize("offset", [0.0, 1e6, 1e8])
@pytest.mark.parametrize("scale", [1e-170, 1.0, 1e150])
def test_floating_moments_keep_their_digits_at_offsets_and_scales(offset, scale):
    rng = np.random.default_rng(3)
    problem = strategies.random_problem(rng, n=200, offset=offset, scale=scale)
    m, f = exact_moments(problem), floating_moments(problem)
    unit = m.cross_unit / power_of_two(f.weight_exponent + f.source_exponent + f.target_exponent)
    exact = np.array([[float(unit * e) for e in row] for row in m.cross])

    assert np.abs(f.cross_covariance - exact).max() <= 1e-14 * np.abs(exact).max()


def test_one_pass_moments_without_the_shift_would_lose_them():
    rng = np.random.default_rng(3)
    problem = strategies.random_problem(rng, n=200, offset=1e8)
    x, y, n = problem.source, problem.target, problem.n
    naive = y.T @ x - np.outer(y.sum(axis=0), x.sum(axis=0)) / n
    m = exact_moments(problem)
    exact = np.array([[float(m.cross_unit * e) for e in row] for row in m.cross])

    assert np.abs(naive - exact).max() > 1e-3 * np.abs(exact).max()


@pytest.mark.parametrize("size", [1e-200, 1.0, 3.0, 1e200])
def test_the_rounding_of_a_covariance_is_a_little_more_than_three_sums_lose(size: float):
    """Each of three sums is within 260 u of the size."""
    unit = Fraction(2) ** -53 * Fraction(size)

    assert 3 * 260 * unit < Fraction(rounding_of(size)) <= Fraction(801) * unit


def test_the_error_of_eigenvalues_is_that_of_the_entries_and_of_the_decomposition():
    """3 sqrt(3) times that of an entry, and 64 u of the norm."""
    entries, norm = davenport_error(0.5, 0.0), davenport_error(0.0, 8.0)

    assert entries == pytest.approx(0.5 * math.sqrt(27.0), rel=1e-15)
    assert norm == 8.0 * EIGENVALUE_ROUNDING == 2.0**-44
    assert davenport_error(0.5, 8.0) == entries + norm
