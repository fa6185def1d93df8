"""The equilibrium quadratics are those of the torque, point by point, and travel as they are."""

from __future__ import annotations

import numpy as np
import pytest
import strategies
import sympy
from hypothesis import given
from hypothesis import strategies as st
from oracles.exports import as_msolve, as_phcpack, as_singular, as_sympy
from oracles.groebner_basis import dimension_and_degree, rotation_ideal
from oracles.polynomials import multiplier_system
from oracles.systems import quaternion_system, rotation_system

from certreg.equilibrium.torques import COLUMNS, torque_table
from certreg.geometry.so3 import davenport_matrix, dot, rotation_matrix
from certreg.problem.moments import exact_moments

small = st.integers(-9, 9)
matrices = st.lists(st.lists(small, min_size=3, max_size=3), min_size=3, max_size=3)
quaternions = st.tuples(small, small, small, small)


def torque(points, targets, R):
    """Body torque by its definition, sum of x times R^T y, in integers."""
    total = [0, 0, 0]
    for x, y in zip(points, targets, strict=True):
        b = [sum(R[k][i] * y[k] for k in range(3)) for i in range(3)]
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            total[i] += x[j] * b[k] - x[k] * b[j]
    return total


@pytest.mark.slow
@given(matrices, matrices, quaternions)
def test_the_first_three_quadratics_are_the_torque_summed_point_by_point(points, targets, q):
    C = [
        [sum(y[i] * x[j] for x, y in zip(points, targets, strict=True)) for j in range(3)]
        for i in range(3)
    ]
    values = quaternion_system(C).evaluate(q)[:3]

    expected = torque(points, targets, rotation_matrix(q))
    assert values == expected


@pytest.mark.slow
@given(matrices, quaternions)
def test_the_six_quadratics_are_sums_and_differences_of_the_minors_of_q_and_Kq(C, q):
    image = [dot(row, q) for row in davenport_matrix(C)]

    def minor(i, j):
        return q[i] * image[j] - q[j] * image[i]

    cycles = ((1, 2, 3), (2, 3, 1), (3, 1, 2))
    body = [minor(0, i) - minor(j, k) for i, j, k in cycles]
    world = [minor(0, i) + minor(j, k) for i, j, k in cycles]
    assert quaternion_system(C).evaluate(q) == body + world


@pytest.mark.slow
@given(matrices, quaternions)
def test_every_rational_rotation_satisfies_all_equations_but_the_torques(C, q):
    norm = sum(c * c for c in q)
    if not norm:
        return
    R = [entry for row in rotation_matrix(q) for entry in row]
    system = rotation_system(C)
    values = [
        sum(c * _power(R, m) * norm ** (2 - sum(m)) for m, c in p.items())
        for p in system.polynomials
    ]
    torques = len(rotation_system(C).polynomials) - 21
    assert values[torques:] == [0] * 21
    still = not any(quaternion_system(C).evaluate(q))
    assert (not any(values[:torques])) == still


def _power(point, monomial):
    return np.prod([v**e for v, e in zip(point, monomial, strict=True)], dtype=object)


def test_handedness_excludes_reflections():
    mirror = [1, 0, 0, 0, 1, 0, 0, 0, -1]
    assert any(rotation_system([[0] * 3] * 3).evaluate(mirror))
    assert not any(rotation_system([[0] * 3] * 3).evaluate([1, 0, 0, 0, 1, 0, 0, 0, 1]))


def test_the_chart_is_the_homogeneous_system_with_w_one():
    C = [[3, 1, -2], [7, 2, 5], [0, -1, 4]]
    assert quaternion_system(C, chart=True).evaluate((5, -2, 3)) == quaternion_system(C).evaluate(
        (1, 5, -2, 3)
    )


def test_the_table_lists_products_of_the_last_three_coordinates_first():
    assert [pair for pair in COLUMNS if 0 not in pair] == list(COLUMNS[:6])
    assert all(len(row) == 10 for row in torque_table([[1, 2, 3], [4, 5, 6], [7, 8, 10]]))


@given(matrices, quaternions, small)
def test_the_multiplier_system_vanishes_exactly_at_eigenvectors_in_the_chart(C, q, value):
    values = multiplier_system(davenport_matrix(C), (1, 0, 0, 0)).evaluate((*q, value))
    K = davenport_matrix(C)

    assert values == [*(dot(row, q) - value * c for row, c in zip(K, q, strict=True)), q[0] - 1]


def test_sympy_receives_the_same_polynomials():
    C = [[3, 1, -2], [7, 2, 5], [0, -1, 4]]
    for system in (quaternion_system(C), rotation_system(C)):
        point = [2, -1, 3, 5, 7, -4, 1, 6, -3][: len(system.variables)]
        assert [p.eval(tuple(point)) for p in as_sympy(system)] == system.evaluate(point)


@pytest.mark.slow
def test_the_texts_parse_back_to_the_same_polynomials():
    system = quaternion_system([[3, 1, -2], [7, 2, 5], [0, -1, 4]], chart=True)
    wanted = [p.as_expr() for p in as_sympy(system)]

    *_, body = as_msolve(system).split("\n", 2)
    assert [sympy.sympify(t.replace("^", "**")) for t in body.split(",")] == wanted
    singular = as_singular(system).split("=", 2)[2].rstrip(";\n")
    assert [sympy.sympify(t.replace("^", "**")) for t in singular.split(",")] == wanted
    head, *rows = as_phcpack(system).strip().split("\n")
    assert head == "6 3"
    for row, p in zip(rows, wanted, strict=True):
        ratio = (
            sympy.nsimplify(sympy.sympify(row.rstrip(";").replace("^", "**")), rational=True) / p
        )
        assert sympy.simplify(ratio).is_number


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize("pattern", sorted({s.pattern for s in strategies.ZOO}), ids=str)
def test_the_reference_finds_dimension_and_degree_of_every_row_in_the_entries_of_R(pattern):
    """Components are points, conics, Veronese surfaces (degree 4) and SO(3) (degree 8)."""
    specimen = next(s for s in strategies.ZOO if s.pattern == pattern)
    found = rotation_ideal(exact_moments(specimen.problem).cross)

    largest = max(pattern)
    assert found.dimension == largest - 1
    assert found.degree == pattern.count(largest) * 2 ** (largest - 1)


def test_dimension_and_degree_of_known_monomial_ideals():
    assert dimension_and_degree([], 3) == (3, 1)
    assert dimension_and_degree([(2, 0), (0, 3)], 2) == (0, 6)
    assert dimension_and_degree([(1, 1, 0)], 3) == (2, 2)
    assert dimension_and_degree([(1, 1, 0), (1, 0, 1), (0, 1, 1)], 3) == (1, 3)
