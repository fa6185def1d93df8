"""The torque quadratics: where the torque of the springs vanishes, as exact polynomials.

R is at rest iff the torque is zero, which in the body frame is 2 vee(R^T C - C^T R) and in the
world frame 2 vee(C R^T - R C^T): six equations that are linear in R. With R = R(q), homogeneous of
degree two in the quaternion q, they are six quadratic forms in q; nothing else is assumed here,
above all not that their solutions are eigenvectors. One is led there: the six forms are, up to sign
and sums of two, the 2x2 minors of the 4x2 matrix [q, K q] with Davenport's K(C), so they vanish iff
K q is a multiple of q, which gives a square system for methods that need as many equations as
unknowns.

All coefficients are integers: C may be given up to a positive factor. Source: [Yang2020], torque.

There are at most four equilibria, proved by the rank of one 10x10 integer matrix modulo a prime.
The six torque quadratics and the four products q_i (a . q) are ten quadratic forms in q, which has
ten quadratic monomials. If their coefficients have rank ten, every quadratic monomial is a
combination of them. So on the solutions with a . q = 1 every q_i q_j is linear in q, the quotient
ring is spanned by the four q_i, and there are at most four solutions, complex ones and
multiplicities included; and a solution with a . q = 0 has all q_i q_j = 0, it is none. The rank is
ten over Q if it is ten modulo any prime: a determinant that is not zero modulo p is not zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

from certreg._loading import library
from certreg.geometry.so3 import rotation_matrix

Table = list[list[int]]

# Pairs (i, j) for the product q_i q_j: first those that are quadratic where w = 1, then the rest.
COLUMNS = ((1, 1), (1, 2), (1, 3), (2, 2), (2, 3), (3, 3), (0, 1), (0, 2), (0, 3), (0, 0))
TURNS = ((2, 1), (0, 2), (1, 0))  # vee(A - A^T) = (A[2][1] - A[1][2], ...)
CHARTS = 13  # four lines lie in at most 4 * 3 = 12 hyperplanes (1, t, t^2, t^3)
PRIMES = (2**61 - 1,)  # divides a determinant by accident once in 10^18


def torque_table(C: Sequence[Sequence[int]]) -> Table:
    """6x10: the coefficients of the six torque quadratics; rows body, then world; see `COLUMNS`.

    Each has the factor 2 of the springs taken out.

    >>> torque_table(((3, 0, 0), (0, 2, 0), (0, 0, 1)))[0]
    [0, 0, 0, 0, 2, 0, -6, 0, 0, 0]
    """
    entries = [*C[0], *C[1], *C[2]]
    return [
        [sum(factor * entries[place] for place, factor in cell) for cell in row]
        for row in _torque_pattern()
    ]


def skew(i: int, j: int) -> tuple[tuple[int, int, int], tuple[int, int, int]]:
    """Entry (i, j) of A - A^T, as places and signs."""
    return ((i, j, 1), (j, i, -1))


@cache
def _torque_pattern() -> tuple[tuple[tuple[tuple[int, int], ...], ...], ...]:
    """For each cell of the table the entries of C (0 to 8, row by row) in it, and their factors."""
    rotations = [_coefficient(pair) for pair in COLUMNS]
    rows: list[tuple[tuple[tuple[int, int], ...], ...]] = []
    for world in (False, True):
        for i, j in TURNS:
            cells: list[tuple[tuple[int, int], ...]] = []
            for R in rotations:
                terms = [
                    (3 * a + k, s * R[b][k]) if world else (3 * k + b, s * R[k][a])
                    for k in range(3)
                    for a, b, s in skew(i, j)
                ]
                cells.append(tuple((place, factor) for place, factor in terms if factor))
            rows.append(tuple(cells))
    return tuple(rows)


def _coefficient(pair: tuple[int, int]) -> list[list[int]]:
    """The 3x3 coefficient of q_i q_j in |q|^2 R(q), by polarisation."""
    i, j = pair
    e = [[int(k == i) for k in range(4)], [int(k == j) for k in range(4)]]
    both = rotation_matrix([a + b for a, b in zip(*e, strict=True)])
    if i == j:
        return [[entry // 4 for entry in row] for row in both]
    one, other = rotation_matrix(e[0]), rotation_matrix(e[1])
    return [[both[r][c] - one[r][c] - other[r][c] for c in range(3)] for r in range(3)]


@dataclass(frozen=True, slots=True, kw_only=True)
class RankProof:
    """A chart a and a prime with which the ten quadratic forms are seen to be independent."""

    chart: tuple[int, int, int, int]
    prime: int


def macaulay_matrix(C: Sequence[Sequence[int]], chart: Sequence[int]) -> Table:
    """10x10: the torque quadratics, then q_i (chart . q), in the monomials `COLUMNS`."""
    products = [[0] * len(COLUMNS) for _ in range(4)]
    for column, (i, j) in enumerate(COLUMNS):
        products[i][column] = chart[j]
        products[j][column] = chart[i]
    return [*torque_table(C), *products]


def at_most_four(C: Sequence[Sequence[int]]) -> RankProof | None:
    """A proof that C has at most four equilibria; None where the solutions form a continuum.

    None means not proved, not disproved; it would be wrong once in 10^17 problems.
    """
    flint = library("flint", "the proof that there are at most four equilibria")
    for t in range(CHARTS):
        chart = (1, t, t * t, t**3)
        entries = [entry for row in macaulay_matrix(C, chart) for entry in row]
        for prime in PRIMES:
            if flint.nmod_mat(10, 10, [entry % prime for entry in entries], prime).rank() == 10:
                return RankProof(chart=chart, prime=prime)
    return None
