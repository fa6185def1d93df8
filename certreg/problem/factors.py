"""The lower triangular factor L of a spring matrix W = L L^T, from what a user gives for a pair.

L is what a proof is about, and its bits are what the digest binds. So each function here is a list
of single operations on doubles: + - * / and square roots, each rounded to nearest, none fused with
another, in the order that is written; brackets stand where Python's own order is not meant. Another
language that follows the list makes the same bits. Arrays run over pairs; no step mixes two.

Rank is visible in L: a plane is one column, a line two, and what is left is exactly zero.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Column = NDArray[np.float64]

RELATIVE_ZERO = 1e-12  # of the largest entry: below is rounding, which leaves 1e-16 of n n^T
LARGEST_ENTRY = 2.0**400  # of a matrix; its products are doubles, and so are those of its inverse
SMALLEST_ENTRY = 2.0**-400


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FactoredMatrices(Brief):
    """Factors of symmetric matrices, and of which rows there are none.

    lower: (k, 6), L. ranks: (k,), as the pivots have them. indefinite: (k,), where a pivot is below
    zero by more than rounding. singular: (k,), where a pivot that is not 0 was read as 0.
    """

    lower: NDArray[np.float64]
    ranks: NDArray[np.int64]
    indefinite: NDArray[np.bool_]
    singular: NDArray[np.bool_]


def plane_factors(normals: NDArray[np.float64]) -> NDArray[np.float64]:
    """(k, 6): L = (n, 0, 0), the normals (k, 3) as they are: W = n n^T."""
    factors = np.zeros((len(normals), 6))
    factors[:, [0, 1, 3]] = normals
    return factors


def line_factors(directions: NDArray[np.float64]) -> NDArray[np.float64]:
    """(k, 6): W = |d|^2 I - d d^T, of directions d = (a, b, c), (k, 3), not zero.

    With (p, q) = (b, c) / sqrt(b^2 + c^2), or (1, 0) where b = c = 0, the two columns are
    (sqrt(b^2 + c^2), -a p, -a q) and |d| (0, q, -p); the third is zero. No square leaves the
    doubles, for everything is over the largest entry first.
    """
    a, b, c = directions.T
    m = np.maximum(np.abs(b), np.abs(c))
    along = m == 0.0
    unit = np.where(along, 1.0, m)
    beta, gamma = b / unit, c / unit
    rho = np.sqrt(beta * beta + gamma * gamma)
    unit = np.where(along, 1.0, rho)
    p, q = np.where(along, 1.0, beta / unit), gamma / unit
    big = np.maximum(np.abs(a), m)
    x, y, z = a / big, b / big, c / big
    length = big * np.sqrt((x * x + y * y) + z * z)
    zero = np.zeros(len(directions))
    return np.stack([m * rho, -(a * p), length * q, -(a * q), -(length * p), zero], axis=1)


def information_factors(matrices: NDArray[np.float64]) -> FactoredMatrices:
    """Of W, (k, 6), xx, xy, xz, yy, yz, zz, positive semidefinite up to rounding.

    Pivoted elimination W = sum of s s^T / pivot finds the rank: a pivot below RELATIVE_ZERO of the
    largest entry counts as 0. With three pivots L is the scalar Cholesky factor of W; with two
    their columns, turned in their plane until the second begins with 0; with one its column.
    """
    pivots = _eliminated(matrices)
    factors = np.zeros((len(matrices), 6))
    for rank, made in ((1, _one_column), (2, _two_columns), (3, _cholesky)):
        rows = np.flatnonzero((pivots.ranks == rank) & ~pivots.indefinite)
        if len(rows):
            factors[rows] = made(matrices[rows], pivots.of(rows))
    return FactoredMatrices(
        lower=factors,
        ranks=pivots.ranks,
        indefinite=pivots.indefinite,
        singular=pivots.singular & ~pivots.indefinite,
    )


def covariance_factors(matrices: NDArray[np.float64]) -> FactoredMatrices:
    """Of W = S^-1, for covariances S, (k, 6), xx, xy, xz, yy, yz, zz, which need the rank 3.

    With S = U U^T, U upper triangular, found from the last entry to the first, L = (U^-1)^T. So W
    is positive definite whatever is rounded, and its eigenvalues are off by about u cond(S) of
    their size; W by the adjugate over the determinant loses u cond(S)^2.
    """
    pivots = _eliminated(matrices)
    factors = np.zeros((len(matrices), 6))
    rows = np.flatnonzero((pivots.ranks == 3) & ~pivots.indefinite)
    xx, xy, xz, yy, yz, zz = matrices[rows].T
    u33 = np.sqrt(zz)
    u23, u13 = yz / u33, xz / u33
    u22 = np.sqrt(yy - u23 * u23)
    u12 = (xy - u13 * u23) / u22
    u11 = np.sqrt((xx - u13 * u13) - u12 * u12)
    l11, l22, l33 = 1.0 / u11, 1.0 / u22, 1.0 / u33
    l21 = -((u12 * l11) / u22)
    l31 = -((u13 * l11 + u23 * l21) / u33)
    l32 = -((u23 * l22) / u33)
    factors[rows] = np.stack([l11, l21, l22, l31, l32, l33], axis=1)
    return FactoredMatrices(
        lower=factors, ranks=pivots.ranks, indefinite=pivots.indefinite, singular=pivots.singular
    )


def symmetric_matrices(six: NDArray[np.float64]) -> NDArray[np.float64]:
    """(k, 3, 3) of xx, xy, xz, yy, yz, zz."""
    return six[:, [0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(-1, 3, 3)


def lower_triangles(factors: NDArray[np.float64]) -> NDArray[np.float64]:
    """(k, 3, 3): L, of its six entries by rows."""
    return np.tril(symmetric_matrices(factors[:, [0, 1, 3, 2, 4, 5]]))


def weigh(
    factors: NDArray[np.float64], sigma: Column | None, weights: Column | None
) -> NDArray[np.float64]:
    """L / sigma, or L times the root of the weight, of each pair: the last operation on L.

    sigma, weights: (k,) or (1,). With -0.0 as 0.0: one problem, one digest.
    """
    if sigma is not None:
        factors = factors / sigma[:, np.newaxis]
    if weights is not None:
        factors = factors * np.sqrt(weights)[:, np.newaxis]
    return factors + 0.0


def ranks_of(factors: NDArray[np.float64]) -> NDArray[np.int64]:
    """(k,): the exact rank of every L.

    Where l11 is not zero, the first column is independent of the others, which have the rank of
    [[l22, 0], [l32, l33]]. Else L has the rank of its other rows (l21, l22, 0), (l31, l32, l33).
    """
    l11, l21, l22, l31, l32, l33 = (column != 0.0 for column in factors.T)
    rest = (l22 | l32 | l33).astype(np.int64) + (l22 & l33)
    upper, lower = l21 | l22, l31 | l32 | l33
    other = (upper | lower).astype(np.int64) + (upper & l33)
    for row in np.flatnonzero(~l11 & upper & lower & ~l33):
        _, a, b, c, d, _ = map(Fraction, factors[row].tolist())
        other[row] += a * d != b * c
    other[l11] = 1 + rest[l11]
    return other


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Pivots(Brief):
    """Elimination with the largest diagonal entry first, (k,) each; of two equal ones the former.

    order: (k, 3), the rows in the order of their pivots. second: (k, 2), what is left below the
    first pivot in the column of the second: its pivot, and the entry under it.
    """

    order: NDArray[np.int64]
    second: NDArray[np.float64]
    ranks: NDArray[np.int64]
    indefinite: NDArray[np.bool_]
    singular: NDArray[np.bool_]

    def of(self, rows: NDArray[np.int64]) -> _Pivots:
        return _Pivots(
            order=self.order[rows],
            second=self.second[rows],
            ranks=self.ranks[rows],
            indefinite=self.indefinite[rows],
            singular=self.singular[rows],
        )


def _eliminated(matrices: NDArray[np.float64]) -> _Pivots:
    full, least = symmetric_matrices(matrices), RELATIVE_ZERO * np.abs(matrices).max(axis=1)
    every = np.arange(len(full))
    diagonal = matrices[:, [0, 3, 5]]
    first = np.asarray(np.argmax(diagonal, axis=1), dtype=np.int64)
    j, k = _OTHERS[first, 0], _OTHERS[first, 1]
    pivot = full[every, first, first]
    positive = (pivot > 0.0) & (pivot >= least)
    over = np.where(positive, pivot, 1.0)
    to_j, to_k = full[every, first, j], full[every, first, k]
    times_j, times_k = to_j / over, to_k / over
    s_jj = full[every, j, j] - times_j * to_j
    s_kk = full[every, k, k] - times_k * to_k
    s_jk = full[every, j, k] - times_j * to_k
    swapped = s_kk > s_jj
    large, small = np.where(swapped, s_kk, s_jj), np.where(swapped, s_jj, s_kk)
    counts = positive & (large > 0.0) & (large >= least)
    third = small - (s_jk / np.where(counts, large, 1.0)) * s_jk
    last = counts & (third > 0.0) & (third >= least)
    of_one = (small <= -least) | (np.abs(s_jk) > least)
    below = (diagonal <= -least[:, np.newaxis]).any(axis=1) | ~positive
    below |= (counts & (third <= -least)) | (~counts & of_one)
    none = ~np.asarray(matrices.any(axis=1))
    rest = ~counts & ((large != 0.0) | (small != 0.0) | (s_jk != 0.0))
    left = (counts & (third != 0.0)) | rest
    return _Pivots(
        order=_ORDERS[first, swapped.astype(np.int64)],
        second=np.stack([large, s_jk], axis=1),
        ranks=positive.astype(np.int64) + counts + last,
        indefinite=below & ~none,
        singular=left & ~last & ~none,
    )


_OTHERS = np.array([[1, 2], [0, 2], [0, 1]])
_ORDERS = np.array([[[0, 1, 2], [0, 2, 1]], [[1, 0, 2], [1, 2, 0]], [[2, 0, 1], [2, 1, 0]]])


def _cholesky(matrices: NDArray[np.float64], _: _Pivots) -> NDArray[np.float64]:
    xx, xy, xz, yy, yz, zz = matrices.T
    l11 = np.sqrt(xx)
    l21, l31 = xy / l11, xz / l11
    l22 = np.sqrt(yy - l21 * l21)
    l32 = (yz - l21 * l31) / l22
    l33 = np.sqrt((zz - l31 * l31) - l32 * l32)
    return np.stack([l11, l21, l22, l31, l32, l33], axis=1)


def _one_column(matrices: NDArray[np.float64], pivots: _Pivots) -> NDArray[np.float64]:
    """The column of the first pivot over its root."""
    return plane_factors(_first_column(matrices, pivots))


def _first_column(matrices: NDArray[np.float64], pivots: _Pivots) -> NDArray[np.float64]:
    every, first = np.arange(len(matrices)), pivots.order[:, 0]
    column = symmetric_matrices(matrices)[every, first]
    return column / np.sqrt(column[every, first])[:, np.newaxis]


def _two_columns(matrices: NDArray[np.float64], pivots: _Pivots) -> NDArray[np.float64]:
    """The columns u, v of both pivots, turned in their plane.

    With h = |(u1, v1)|: (u u1 + v v1) / h and (v u1 - u v1) / h, whose first entry is 0; u and v as
    they are where h = 0.
    """
    every = np.arange(len(matrices))
    u, v = _first_column(matrices, pivots), np.zeros((len(matrices), 3))
    pivot, under = pivots.second.T
    v[every, pivots.order[:, 1]] = np.sqrt(pivot)
    v[every, pivots.order[:, 2]] = under / np.sqrt(pivot)
    (u1, u2, u3), (v1, v2, v3) = u.T, v.T
    h = np.sqrt(u1 * u1 + v1 * v1)
    none = h == 0.0
    unit = np.where(none, 1.0, h)
    c, s = np.where(none, 1.0, u1 / unit), v1 / unit
    l21, l31 = c * u2 + s * v2, c * u3 + s * v3
    l22, l32 = c * v2 - s * u2, c * v3 - s * u3
    return np.stack([h, l21, l22, l31, l32, np.zeros(len(h))], axis=1)
