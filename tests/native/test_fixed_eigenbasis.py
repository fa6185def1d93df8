"""The eigenbasis in fixed point by C: what rotations in integers find, to the last places."""

from __future__ import annotations

import numpy as np
import pytest
from strategies import random_rotation

from certreg.exact.eigenbasis import integer_eigenbasis
from certreg.geometry.so3 import davenport_matrix, dot
from certreg.native.eigenbasis import FIXED_BITS, fixed_eigenbasis
from certreg.native.library import library_if_any
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem

LAST_PLACES = 1 << 12  # with what rounding over a difference of 2^-5 makes of them
ONE = 1 << FIXED_BITS

pytestmark = pytest.mark.skipif(library_if_any() is None, reason="no compiled code")


def fixed(matrix: list[list[int]]) -> list[list[int]]:
    """The matrix with its largest entry from 1/2 to 1."""
    shift = max(abs(entry) for row in matrix for entry in row).bit_length()
    return [[(entry << FIXED_BITS) >> shift for entry in row] for row in matrix]


def of_values(values: list[int], seed: int) -> list[list[int]]:
    """The Davenport matrix of U diag(d1, d2, d3) V: d1 + d2 + d3 is the largest of its values."""
    rng = np.random.default_rng(seed)
    u, v = (random_rotation(rng) for _ in range(2))
    cross = u @ np.diag(values) @ v
    return [list(row) for row in davenport_matrix((cross * 2.0**50).astype(int).tolist())]


@pytest.mark.parametrize("seed", range(20))
def test_it_is_the_one_of_rotations_in_integers(seed: int):
    matrix = fixed(of_values([9 + seed, 5, 2 - 4 * (seed % 2)], seed))
    known = integer_eigenbasis(matrix, FIXED_BITS)
    found = fixed_eigenbasis(matrix)

    assert found is not None
    values, vectors = found
    assert np.allclose([a - b for a, b in zip(values, known.values, strict=True)], 0, atol=1 << 9)
    for one, other in zip(vectors, known.vectors, strict=True):
        sign = 1 if dot(one, other) > 0 else -1
        assert max(abs(a - sign * b) for a, b in zip(one, other, strict=True)) < LAST_PLACES


@pytest.mark.parametrize("seed", range(5))
def test_it_is_orthonormal_and_solves_its_equation(seed: int):
    matrix = fixed(of_values([7, 4, 1], 100 + seed))
    found = fixed_eigenbasis(matrix)

    assert found is not None
    for i, (value, v) in enumerate(zip(*found, strict=True)):
        for j, u in enumerate(found[1]):
            assert abs(dot(u, v) - ONE * ONE * (i == j)) < LAST_PLACES * ONE
        for row, entry in zip(matrix, v, strict=True):
            assert abs(dot(row, v) - value * entry) < LAST_PLACES * ONE


@pytest.mark.parametrize("share", [0.5, 2.0])
def test_values_are_well_apart_or_left_to_others(share: float):
    """l1 - l2 = 2^-12 share, beside entries below 1."""
    values = [0.75, 0.75 - 2.0**-12 * share, 0.25, -0.5]
    matrix = [[int(values[i] * ONE) if i == j else 0 for j in range(4)] for i in range(4)]
    found = fixed_eigenbasis(matrix)

    assert (found is not None) == (share > 1.0)
    if found is not None:
        assert list(found[0]) == [int(value * ONE) for value in values]


def test_a_matrix_of_zeros_is_left_to_others():
    assert fixed_eigenbasis([[0] * 4 for _ in range(4)]) is None


@pytest.mark.parametrize("size", [1.0, 1e-160, 1e140])
def test_an_objective_has_the_same_eigenspaces_with_and_without(
    monkeypatch: pytest.MonkeyPatch, size: float
):
    """Entries of K of any length: its fixed point is the same."""
    rng = np.random.default_rng(3)
    source = rng.normal(size=(9, 3))
    moments = exact_moments(RegistrationProblem(size * source, source @ random_rotation(rng).T))
    with_it = Isotropic(moments)
    quaternions, value = with_it.quaternions, with_it.eigenvalue_difference(0, 1)
    monkeypatch.setattr("certreg.objective.isotropic.fixed_eigenbasis", lambda *_: None)
    without = Isotropic(moments)

    assert quaternions == without.quaternions
    assert abs(value / without.eigenvalue_difference(0, 1) - 1) < 1e-50
