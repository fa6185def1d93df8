from __future__ import annotations

import numpy as np
import pytest
import strategies
from hypothesis import assume, given
from hypothesis import strategies as st

from certreg.exact.elimination import is_positive_definite, rank
from certreg.geometry.so3 import rotation_matrix
from certreg.objective.classification import PRIME, Ambiguity, classify, pattern_of
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem

small = st.integers(-6, 6)
integer_quaternions = st.tuples(small, small, small, small).filter(any)


def product(A, B):
    return [
        [sum(a * b for a, b in zip(row, col, strict=True)) for col in zip(*B, strict=True)]
        for row in A
    ]


def pattern_of_singular_values(d1, d2, d3):
    """The pattern by the eigenvalues of K themselves, d1 >= d2 >= |d3|."""
    values = sorted((d1 + d2 + d3, d1 - d2 - d3, -d1 + d2 - d3, -d1 - d2 + d3), reverse=True)
    return tuple(values.count(v) for v in sorted(set(values), reverse=True))


@given(st.tuples(*[st.integers(-5, 5)] * 3), integer_quaternions, integer_quaternions)
def test_the_pattern_is_that_of_the_singular_values(d, p, q):
    """C = U diag(d) V^T in integers: U and V are rotations times |p|^2 and |q|^2."""
    magnitudes = sorted(map(abs, d), reverse=True)
    sign = -1 if d[0] * d[1] * d[2] < 0 else 1
    diagonal = [[d[i] if i == j else 0 for j in range(3)] for i in range(3)]
    V = [list(column) for column in zip(*rotation_matrix(q), strict=True)]
    C = product(product(rotation_matrix(p), diagonal), V)

    expected = pattern_of_singular_values(magnitudes[0], magnitudes[1], sign * magnitudes[2])
    assert pattern_of(C) == expected


@given(st.lists(st.lists(st.integers(-9, 9), min_size=3, max_size=3), min_size=3, max_size=3))
def test_the_pattern_does_not_depend_on_scale_nor_on_which_cloud_moves(C):
    assert pattern_of([[1000003 * e for e in row] for row in C]) == pattern_of(C)
    assert pattern_of(list(zip(*C, strict=True))) == pattern_of(C)


@pytest.mark.parametrize(
    "C", [((PRIME, 0, 0), (0, 2, 0), (0, 0, 0)), ((1, 0, 0), (0, 1 + PRIME, 0), (0, 0, 5))]
)
def test_a_pattern_that_looks_degenerate_modulo_the_prime_is_decided_in_full(C):
    assert pattern_of(C) == (1, 1, 1, 1)
    assert pattern_of([[entry % PRIME for entry in row] for row in C]) != (1, 1, 1, 1)


def test_a_relative_difference_of_a_trillionth_is_told_from_equality():
    big = 10**12
    assert pattern_of(((big, 0, 0), (0, big, 0), (0, 0, 1))) == (1, 2, 1)
    assert pattern_of(((big + 1, 0, 0), (0, big, 0), (0, 0, 1))) == (1, 1, 1, 1)


@pytest.mark.parametrize("specimen", strategies.ZOO, ids=lambda s: s.name)
def test_every_cloud_of_the_zoo_gets_its_row(specimen):
    assert classify(exact_moments(specimen.problem)).pattern == specimen.pattern


def test_the_zoo_has_all_eight_rows():
    rows = {(1, 1, 1, 1), (1, 2, 1), (1, 1, 2), (1, 3), (2, 1, 1), (3, 1), (2, 2), (4,)}

    assert {specimen.pattern for specimen in strategies.ZOO} == rows


@pytest.mark.parametrize("specimen", strategies.ZOO, ids=lambda s: s.name)
def test_the_alternating_sum_of_euler_characteristics_is_that_of_the_rotation_group(specimen):
    """Morse-Bott: sum of (-1)^index chi(component) = chi(SO(3)) = 0."""
    found = classify(exact_moments(specimen.problem))
    chi = {"point": 1, "circle": 0, "projective-plane": 1, "rotation-group": 0}

    terms = [(-1) ** i * chi[k.value] for i, k in zip(found.indices, found.kinds, strict=True)]
    assert sum(terms) == 0


@pytest.mark.parametrize(
    ("name", "ambiguity"),
    [
        ("collinear source", Ambiguity.COLLINEAR_SOURCE),
        ("collinear target", Ambiguity.COLLINEAR_TARGET),
        ("coincident source", Ambiguity.COINCIDENT_SOURCE),
        ("coincident target", Ambiguity.COINCIDENT_TARGET),
        ("cancelling octahedron", Ambiguity.UNCORRELATED),
        ("mirrored tetrahedron", Ambiguity.MIRRORED),
        ("mirrored tall", Ambiguity.MIRRORED),
        ("tetrahedron", None),
        ("rectangle", None),
    ],
)
def test_an_ambiguous_optimum_is_explained(name, ambiguity):
    specimen = next(s for s in strategies.ZOO if s.name == name)

    assert classify(exact_moments(specimen.problem)).ambiguity is ambiguity


@pytest.mark.parametrize("swapped", [False, True])
def test_of_a_line_and_a_point_the_point_is_the_reason(swapped):
    line, point = np.outer(np.arange(4.0), [1.0, 2.0, 3.0]), np.ones((4, 3))
    clouds = (point, line) if swapped else (line, point)
    reason = Ambiguity.COINCIDENT_SOURCE if swapped else Ambiguity.COINCIDENT_TARGET

    assert classify(exact_moments(RegistrationProblem(*clouds))).ambiguity is reason


def test_spurious_equilibria_are_counted():
    counts = {s.pattern: classify(exact_moments(s.problem)).spurious for s in strategies.ZOO}

    assert counts[1, 1, 1, 1] == 3
    assert counts[2, 1, 1] == 2
    assert counts[3, 1] == 1
    assert counts[(4,)] == 0
    assert counts[1, 2, 1] is counts[1, 1, 2] is counts[1, 3] is counts[2, 2] is None


def test_the_dynamics_is_undefined_exactly_where_the_source_is_collinear():
    for specimen in strategies.ZOO:
        found = classify(exact_moments(specimen.problem))
        collinear = specimen.name in {
            "collinear source",
            "two points",
            "coincident source",
            "one point",
        }
        assert (found.unstable is None) == collinear, specimen.name


@given(st.lists(st.lists(small, min_size=3, max_size=3), min_size=1, max_size=4))
def test_a_gram_matrix_is_definite_exactly_when_its_rank_is_full(rows):
    columns = list(zip(*rows, strict=True))
    gram = [[sum(a * b for a, b in zip(c, d, strict=True)) for d in columns] for c in columns]

    assert is_positive_definite(gram) == (rank(rows) == 3)


@pytest.mark.slow
@given(st.lists(small, min_size=6, max_size=6), st.lists(small, min_size=3, max_size=3))
def test_a_definite_matrix_is_positive_on_every_vector(entries, v):
    assume(any(v))
    a, b, c, d, e, f = entries
    matrix = [[a, b, c], [b, d, e], [c, e, f]]
    form = sum(matrix[i][j] * v[i] * v[j] for i in range(3) for j in range(3))

    assert not is_positive_definite(matrix) or form > 0
