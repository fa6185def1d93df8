"""Factors of springs: bit by bit as written, and near the exact matrix by a bound on rounding."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
import pytest
import spring_scalars as scalars
from hypothesis import example, given
from hypothesis import strategies as st

from certreg.problem.factors import (
    covariance_factors,
    information_factors,
    line_factors,
    plane_factors,
    ranks_of,
    weigh,
)

if TYPE_CHECKING:
    from collections.abc import Callable

U = Fraction(1, 2**53)
SIX = [0, 1, 2, 4, 5, 8]
coordinates = st.one_of(
    st.just(0.0), st.floats(1e-9, 1e9), st.floats(-1e9, -1e-9), st.integers(-3, 3).map(float)
)
vectors = st.tuples(coordinates, coordinates, coordinates).filter(any)
small = st.integers(-4, 4).map(float)


def _bits(factors: np.ndarray) -> list[list[str]]:
    return [[value.hex() for value in (row + 0.0).tolist()] for row in factors]


def _one_by_one(
    scalar: Callable[[list[float]], list[float] | None], rows: np.ndarray
) -> np.ndarray:
    return np.array([scalar(row) for row in rows.tolist()])


def _matrices(seed: int, n: int, spread: float) -> np.ndarray:
    """(n, 6): symmetric, with eigenvalues from 1 down to 10^-spread and axes at random."""
    rng = np.random.default_rng(seed)
    axes = np.linalg.qr(rng.standard_normal((n, 3, 3)))[0]
    sizes = 10.0 ** -rng.uniform(0.0, spread, size=(n, 3))
    full = np.einsum("nij,nj,nkj->nik", axes, sizes, axes)
    return ((full + full.transpose(0, 2, 1)) / 2).reshape(n, 9)[:, SIX]


def _dyads(seed: int, n: int, rank: int) -> np.ndarray:
    """(n, 6): sums of `rank` matrices v v^T, in doubles, of the exact rank 3 almost always."""
    columns = np.random.default_rng(seed).standard_normal((rank, n, 3))
    columns[:, : n // 4, 0] = 0.0
    full = sum(column[:, :, None] * column[:, None, :] for column in columns)
    return np.asarray(full).reshape(n, 9)[:, SIX]


@pytest.mark.slow
@given(vectors)
@example((1.0, 0.0, 0.0))
@example((-2.0, 0.0, 0.0))
@example((1.0, 1e-160, 0.0))
@example((1e-300, 1e-300, -1e-300))
@example((0.0, 0.0, -3.0))
def test_a_line_is_bit_by_bit_as_written_and_resists_all_but_its_direction(d) -> None:
    (factor,) = line_factors(np.array([d]))

    assert _bits(factor[np.newaxis]) == _bits(np.array([scalars.line(*d)]))
    square = sum(Fraction(x) ** 2 for x in d)
    exact = [
        [square * (i == j) - Fraction(d[i]) * Fraction(d[j]) for j in range(3)] for i in range(3)
    ]
    assert scalars.farthest(scalars.spring(factor), exact) <= 16 * U * square


def test_many_lines_are_bit_by_bit_as_written() -> None:
    directions = np.random.default_rng(2).standard_normal((500, 3))

    assert _bits(line_factors(directions)) == _bits(
        _one_by_one(lambda row: scalars.line(*row), directions)
    )


@given(vectors)
def test_a_plane_is_its_normal_as_it_is(normal) -> None:
    (factor,) = plane_factors(np.array([normal]))

    exact = [[Fraction(a) * Fraction(b) for b in normal] for a in normal]
    assert scalars.spring(factor) == exact
    assert factor.tolist() == scalars.plane(*normal)


@pytest.mark.parametrize("spread", [0, 4, 8, 11])
def test_information_is_bit_by_bit_as_written_and_near_what_was_given(spread: int) -> None:
    matrices = _matrices(spread, 60, spread)

    found = information_factors(matrices)

    assert (found.ranks == 3).all()
    assert not found.indefinite.any()
    assert not found.singular.any()
    assert _bits(found.lower) == _bits(
        np.array([scalars.information(m) for m in matrices.tolist()])
    )
    for factor, matrix in zip(found.lower, matrices, strict=True):
        error = scalars.farthest(scalars.spring(factor), scalars.symmetric(matrix))
        assert error <= 8 * U * Fraction(float(np.abs(matrix).max()))


@pytest.mark.parametrize("rank", [1, 2])
def test_sums_of_dyads_in_doubles_are_read_as_of_their_rank(rank: int) -> None:
    matrices = _dyads(rank, 60, rank)

    found = information_factors(matrices)

    assert (found.ranks == rank).all()
    assert (ranks_of(found.lower) == rank).all()
    assert not found.indefinite.any()
    assert found.singular.any()  # those that rounding left of a higher rank
    assert _bits(found.lower) == _bits(
        np.array([scalars.information(m) for m in matrices.tolist()])
    )
    for factor, matrix in zip(found.lower, matrices, strict=True):
        error = scalars.farthest(scalars.spring(factor), scalars.symmetric(matrix))
        assert error <= 128 * U * Fraction(float(np.abs(matrix).max()))


@given(st.tuples(*[small] * 6))
@example((0.0, 1.0, 0.0, 0.0, 0.0, 0.0))
@example((1.0, 0.0, 0.0, 1e-14, 0.0, -1e-14))
@example((1.0, 0.0, 0.0, 0.0, 1e-6, 0.0))
@example((1.0, 0.0, 0.0, 1.0, 0.0, -1e-6))
@example((1.0, 0.0, 0.0, 1.0, 0.0, -1e-13))
def test_a_matrix_with_an_eigenvalue_below_zero_is_refused_and_no_other(entries) -> None:
    found = information_factors(np.array([entries]))
    exact = scalars.symmetric(entries)

    reference = scalars.information(entries)
    assert bool(found.indefinite[0]) == (reference is None)
    if reference is not None:
        assert _bits(found.lower) == _bits(np.array([reference]))
    if all(entry.is_integer() for entry in entries):  # so that no pivot is near zero and is not
        minors = [exact[i][i] * exact[j][j] - exact[i][j] ** 2 for i, j in ((0, 1), (0, 2), (1, 2))]
        diagonal = [exact[i][i] for i in range(3)]
        semidefinite = min(*diagonal, *minors, scalars.determinant(exact)) >= 0
        assert bool(found.indefinite[0]) == (not semidefinite)
        assert found.indefinite[0] or found.ranks[0] == scalars.rank(exact)


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize("spread", [0, 4, 8, 10])
def test_a_covariance_is_bit_by_bit_as_written_and_its_spring_is_its_inverse(spread: int) -> None:
    matrices = _matrices(100 + spread, 60, spread)

    found = covariance_factors(matrices)

    assert (found.ranks == 3).all()
    assert _bits(found.lower) == _bits(np.array([scalars.covariance(m) for m in matrices.tolist()]))
    for factor, matrix in zip(found.lower, matrices, strict=True):
        exact = _inverse(scalars.symmetric(matrix))
        share = _largest_relative_change(scalars.spring(factor), exact)
        assert share <= 100 * U * 10**spread


def _inverse(m: scalars.Matrix) -> scalars.Matrix:
    over = scalars.determinant(m)
    cofactors = [
        [
            m[(i + 1) % 3][(j + 1) % 3] * m[(i + 2) % 3][(j + 2) % 3]
            - m[(i + 1) % 3][(j + 2) % 3] * m[(i + 2) % 3][(j + 1) % 3]
            for j in range(3)
        ]
        for i in range(3)
    ]
    return [[cofactors[j][i] / over for j in range(3)] for i in range(3)]


def _largest_relative_change(found: scalars.Matrix, exact: scalars.Matrix) -> Fraction:
    """A bound on |x^T (found - exact) x| / x^T exact x: the root of the trace of D^2.

    D = found exact^-1 - I is similar to a symmetric matrix, so its eigenvalues are real.
    """
    back = _inverse(exact)
    product = [
        [sum(found[i][k] * back[k][j] for k in range(3)) - (i == j) for j in range(3)]
        for i in range(3)
    ]
    square = [
        [sum(product[i][k] * product[k][j] for k in range(3)) for j in range(3)] for i in range(3)
    ]
    return Fraction(float(abs(sum(square[i][i] for i in range(3)))) ** 0.5)


def test_the_adjugate_would_lose_the_square_of_the_condition() -> None:
    axis = np.array([1.0, 2.0, 3.0]) / np.sqrt(14.0)
    full = axis[:, None] * axis[None, :] * (1.0 - 1e-9) + 1e-9 * np.eye(3)  # a needle
    needle = ((full + full.T) / 2).reshape(1, 9)[:, SIX]
    exact = _inverse(scalars.symmetric(needle[0]))
    a, b, c, d, e, f = needle[0].tolist()
    entries = [
        d * f - e * e,
        c * e - b * f,
        b * e - c * d,
        a * f - c * c,
        b * c - a * e,
        a * d - b * b,
    ]
    over = a * entries[0] + b * entries[1] + c * entries[2]
    adjugate = scalars.symmetric([entry / over for entry in entries])

    ours = scalars.spring(covariance_factors(needle).lower[0])

    assert _largest_relative_change(ours, exact) < 1e-6
    assert _largest_relative_change(adjugate, exact) > 1e-2


@given(st.tuples(*[small] * 6))
def test_ranks_are_exact(entries) -> None:
    assert ranks_of(np.array([entries]))[0] == scalars.rank(scalars.spring(entries))


def test_a_rank_that_products_of_doubles_cannot_tell_is_exact() -> None:
    third = 1.0 / 3.0
    rows = np.array(
        [
            [0.0, third, 1.0, third * 3.0**-30, 3.0**-30, 0.0],
            [0.0, 1.0 + 2.0**-52, 1.0, 1.0 + 2.0**-51, 1.0 + 2.0**-52, 0.0],
            [0.0, 1e-200, 1e-200, 1e-200, 2e-200, 0.0],
            [0.0, 1e-200, 1e-200, 2e-200, 2e-200, 0.0],
        ]
    )

    assert ranks_of(rows).tolist() == [scalars.rank(scalars.spring(row)) for row in rows.tolist()]
    assert ranks_of(rows[2:]).tolist() == [2, 1]


def test_sigma_divides_and_weights_multiply_by_their_root_last() -> None:
    factors = _matrices(3, 5, 1)
    sigma, weights = np.array([0.3, 0.7, 1.1, 5.0, 1e-3]), np.array([0.3, 0.0, 2.0, 9.0, 1e5])

    over, times = weigh(factors, sigma, None), weigh(factors, None, weights)

    for k in range(5):
        assert over[k].tolist() == [value / sigma[k] for value in factors[k].tolist()]
        root = float(weights[k]) ** 0.5
        assert times[k].tolist() == [value * root + 0.0 for value in factors[k].tolist()]
    assert (weigh(factors, sigma[:1], None) == factors / sigma[0]).all()
    assert not np.signbit(weigh(np.array([[-0.0] * 6]), None, None)).any()
