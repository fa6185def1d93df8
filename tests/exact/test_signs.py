"""Signs of eigenvalues, counted in integers."""

from __future__ import annotations

import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from certreg.exact.signs import RootSigns, characteristic, signs_of_eigenvalues, signs_of_roots

ENTRIES = st.lists(st.integers(-50, 50), min_size=10, max_size=10)


def symmetric(entries: list[int]) -> list[list[int]]:
    upper = iter(entries)
    A = [[0] * 4 for _ in range(4)]
    for i in range(4):
        for j in range(i, 4):
            A[i][j] = A[j][i] = next(upper)
    return A


@given(ENTRIES)
def test_the_polynomial_is_that_of_sympy(entries):
    A = symmetric(entries)

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
