"""Integer matrices: elimination and eigenbases beside rational arithmetic, signs of eigenvalues."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from certreg.exact.balls import exact_matrix, orthonormal
from certreg.exact.eigenbasis import integer_eigenbasis
from certreg.exact.elimination import is_positive_definite, rank
from certreg.exact.signs import RootSigns, characteristic, signs_of_eigenvalues, signs_of_roots
from certreg.geometry.so3 import dot

LAST_PLACES = 1 << 12


def symmetric(rng: np.random.Generator, size: int, n: int = 4) -> list[list[int]]:
    half = [[int(e) for e in row] for row in rng.integers(-size, size, (n, n))]
    return [[half[min(i, j)][max(i, j)] for j in range(n)] for i in range(n)]


MATRICES = {
    "general": symmetric(np.random.default_rng(1), 1000),
    "short": symmetric(np.random.default_rng(2), 3),
    "long": [[e << 3000 | 5 for e in row] for row in symmetric(np.random.default_rng(3), 9)],
    "nearly equal": [
        [10**30 * (i == j) + k for j, k in enumerate(row)]
        for i, row in enumerate(symmetric(np.random.default_rng(4), 9))
    ],
    "equal": [[3 if i == j else 0 for j in range(4)] for i in range(4)],
    "two pairs": [[0, 1, 0, 0], [1, 0, 0, 0], [0, 0, 0, 1], [0, 0, 1, 0]],
    "zero": [[0] * 4 for _ in range(4)],
    "three by three": symmetric(np.random.default_rng(5), 50, n=3),
}


@pytest.mark.parametrize("bits", [64, 200, 1000])
@pytest.mark.parametrize("name", MATRICES)
def test_an_eigenbasis_is_orthonormal_and_solves_its_equation_to_the_last_places(name, bits):
    matrix = MATRICES[name]
    found = integer_eigenbasis(matrix, bits)
    n, unit = len(matrix), 1 << bits
    scale = 1 << found.shift

    assert found.bits == bits
    assert list(found.values) == sorted(found.values, reverse=True)
    assert max(abs(e) for row in matrix for e in row) <= scale
    for i, (value, v) in enumerate(zip(found.values, found.vectors, strict=True)):
        for j, u in enumerate(found.vectors):
            assert abs(dot(u, v) - unit * unit * (i == j)) <= LAST_PLACES * unit
        for k in range(n):
            off = unit * dot(matrix[k], v) - scale * value * v[k]
            assert abs(off) <= LAST_PLACES * scale * unit


@pytest.mark.parametrize("shape", [(1, 1), (1, 4), (4, 1), (3, 3), (4, 4), (3, 5)])
def test_the_rank_is_that_of_rational_arithmetic(shape):
    rng = np.random.default_rng(sum(shape))
    for _ in range(30):
        matrix = rng.integers(-1, 2, shape) * rng.integers(0, 2, shape[1])
        matrix[-1] = matrix[0] * rng.integers(-2, 3)

        assert rank(matrix.tolist()) == sympy.Matrix(matrix.tolist()).rank()


def test_a_matrix_is_definite_where_all_its_values_are_positive():
    rng, seen = np.random.default_rng(8), set[bool]()
    for n in (1, 2, 3, 4):
        for _ in range(30):
            matrix = symmetric(rng, 3, n)
            for k in range(n):
                matrix[k][k] += int(rng.integers(0, 6))
            whole: Any = sympy.Matrix(matrix)
            minors = [whole[:k, :k].det() for k in range(1, n + 1)]
            definite = all(minor > 0 for minor in minors)
            seen.add(definite)

            assert is_positive_definite(matrix) == definite
    assert seen == {True, False}


def test_an_orthonormal_basis_is_taken_from_the_longest_that_remain():
    rows = exact_matrix([[1, 0, 0, 0], [1, 1 << 40, 0, 0], [3, 4, 0, 0]], 3).tolist()
    one, other = orthonormal(rows, 2)

    assert abs(float(one[1].mid()) - 1.0) < 1e-11
    assert abs(float(other[0].mid())) == pytest.approx(1.0)
    assert abs(float(dot(one, other).mid())) < 1e-11


def test_small_matrices_are_definite_as_sylvester_says():
    for a, b, c in product(range(-1, 4), repeat=3):
        assert is_positive_definite([[a, b], [b, c]]) == (a > 0 and a * c > b * b)
        bordered = [[1, 0, 0], [0, a, b], [0, b, c]]
        assert is_positive_definite(bordered) == (a > 0 and a * c > b * b)


ENTRIES = st.lists(st.integers(-50, 50), min_size=10, max_size=10)


def mirrored(entries: list[int]) -> list[list[int]]:
    upper = iter(entries)
    A = [[0] * 4 for _ in range(4)]
    for i in range(4):
        for j in range(i, 4):
            A[i][j] = A[j][i] = next(upper)
    return A


@given(ENTRIES)
def test_the_polynomial_is_that_of_sympy(entries):
    A = mirrored(entries)

    assert list(characteristic(A)) == sympy.Matrix(A).charpoly().all_coeffs()


@pytest.mark.slow
@given(st.lists(st.lists(st.integers(-9, 9), min_size=4, max_size=4), max_size=4), st.data())
def test_signs_follow_sylvesters_law(vectors, data):
    signs = data.draw(st.lists(st.sampled_from([-1, 1]), min_size=4, max_size=4))
    rank = np.linalg.matrix_rank(np.array(vectors)) if vectors else 0
    outer = [s * np.outer(v, v) for s, v in zip(signs, vectors, strict=False)]
    A = np.array(sum(outer, start=np.zeros((4, 4))), dtype=int).tolist()
    found = signs_of_eigenvalues(A)

    assert found.positive + found.zero + found.negative == 4
    if rank == len(vectors):  # then the number of each sign is that of the terms
        used = signs[: len(vectors)]
        assert found == RootSigns(positive=used.count(1), zero=4 - rank, negative=used.count(-1))


@pytest.mark.parametrize("big", [10**40, 10**80])
def test_roots_far_below_a_doubles_precision_are_counted(big):
    A = [[big, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0], [0, 0, 0, -1]]

    assert signs_of_eigenvalues(A) == RootSigns(positive=2, zero=1, negative=1)


def test_a_zero_among_the_coefficients_is_no_change():
    assert signs_of_roots((1, 0, -5, 0, 4)) == RootSigns(positive=2, zero=0, negative=2)
    assert signs_of_roots((1, 0, 0, 0, 0)) == RootSigns(positive=0, zero=4, negative=0)
