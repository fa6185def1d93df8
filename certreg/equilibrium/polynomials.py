"""The equilibrium quadratics: where the torque of the springs vanishes, as exact polynomials.

R is at rest iff the torque does, which in the body frame is 2 vee(R^T C - C^T R) and in the world
frame 2 vee(C R^T - R C^T): six equations that are linear in R. With R = R(q), homogeneous of degree
two in the quaternion q, they are six quadratic forms in q; nothing else is assumed here, above all
not that their solutions are eigenvectors. One is led there: the six forms are, up to sign and sums
of two, the 2x2 minors of the 4x2 matrix [q, K q] with Davenport's K(C), so they vanish iff K q is a
multiple of q, which gives the square `multiplier_system` for methods that need as many equations as
unknowns. In the nine entries of R the torques are joined by orthogonality of rows and columns and
handedness.

All coefficients are integers: C may be given up to a positive factor. Source: [Yang2020], torque.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING, Any

from certreg.geometry import davenport_matrix, rotation_matrix

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

Monomial = tuple[int, ...]  # exponents
Polynomial = dict[Monomial, int]
Table = list[list[int]]

# Pairs (i, j) for the product q_i q_j: first those that are quadratic where w = 1, then the rest.
COLUMNS = ((1, 1), (1, 2), (1, 3), (2, 2), (2, 3), (3, 3), (0, 1), (0, 2), (0, 3), (0, 0))
TURNS = ((2, 1), (0, 2), (1, 0))  # vee(A - A^T) = (A[2][1] - A[1][2], ...)
QUATERNION = ("w", "x", "y", "z")
ROTATION = ("r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33")


@dataclass(frozen=True, slots=True, kw_only=True)
class PolynomialSystem:
    """Polynomials with integer coefficients, to be zero together.

    polynomials: for each the coefficient, never 0, of each monomial; a monomial is the tuple of the
        exponents of `variables`.
    """

    variables: tuple[str, ...]
    polynomials: tuple[Mapping[Monomial, int], ...]

    def evaluate(self, point: Sequence[Any]) -> list[Any]:
        """The values at a point of integers, balls, or of any other ring."""
        return [
            sum(c * _power_product(point, monomial) for monomial, c in polynomial.items())
            for polynomial in self.polynomials
        ]


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


def quaternion_system(C: Sequence[Sequence[int]], *, chart: bool = False) -> PolynomialSystem:
    """The six torque quadratics in q = (w, x, y, z), homogeneous; with w = 1 in the chart.

    The chart misses the half turns, w = 0.
    """
    first = 1 if chart else 0
    polynomials = [
        _collected((_exponents(pair, 4)[first:], c) for pair, c in zip(COLUMNS, row, strict=True))
        for row in torque_table(C)
    ]
    return PolynomialSystem(variables=QUATERNION[first:], polynomials=tuple(polynomials))


def multiplier_system(
    C: Sequence[Sequence[int]], chart: Sequence[int] = (1, 0, 0, 0), *, unit: int = 1
) -> PolynomialSystem:
    """K q = unit l q and chart . q = 1: five equations in (w, x, y, z, l), as many as unknowns.

    The six torques are the minors of [q, K q]: for q other than 0 they vanish iff an l exists. Then
    unit l = chart . K q, the critical value q^T K q / |q|^2; a unit of the size of K keeps l near 1
    for programs that compute in doubles. Solutions with chart . q = 0 are missed.
    """
    K = davenport_matrix(C)
    rows = [
        _collected(
            [*((_exponents((k,), 5), c) for k, c in enumerate(row)), (_exponents((j, 4), 5), -unit)]
        )
        for j, row in enumerate(K)
    ]
    norm = [(_exponents((k,), 5), c) for k, c in enumerate(chart)]
    rows.append(_collected([*norm, ((0,) * 5, -1)]))
    return PolynomialSystem(variables=(*QUATERNION, "l"), polynomials=tuple(rows))


def rotation_system(C: Sequence[Sequence[int]]) -> PolynomialSystem:
    """All equations in the nine entries of R, row by row: torques, orthogonality, handedness.

    Torque balance in both frames (6, linear), orthogonality of columns and rows (12), and R equal
    to its own cofactors, which leaves of the orthogonal matrices those with determinant 1 (9).
    """
    polynomials = [*_torques(C), *_orthogonality(), *_handedness()]
    return PolynomialSystem(variables=ROTATION, polynomials=tuple(p for p in polynomials if p))


def _torques(C: Sequence[Sequence[int]]) -> Iterator[Polynomial]:
    for i, j in TURNS:
        body = [(_entry((k, a)), s * C[k][b]) for k in range(3) for a, b, s in _skew(i, j)]
        world = [(_entry((b, k)), s * C[a][k]) for k in range(3) for a, b, s in _skew(i, j)]
        yield _collected(body)
        yield _collected(world)


def _skew(i: int, j: int) -> tuple[tuple[int, int, int], tuple[int, int, int]]:
    """Entry (i, j) of A - A^T, as places and signs."""
    return ((i, j, 1), (j, i, -1))


def _orthogonality() -> Iterator[Polynomial]:
    for i, j in combinations_with_replacement(range(3), 2):
        one = [((0,) * 9, -int(i == j))]
        yield _collected([*((_entry((k, i), (k, j)), 1) for k in range(3)), *one])
        yield _collected([*((_entry((i, k), (j, k)), 1) for k in range(3)), *one])


def _handedness() -> Iterator[Polynomial]:
    for i in range(3):
        for j in range(3):
            (a, b), (c, d) = ((i + 1) % 3, (i + 2) % 3), ((j + 1) % 3, (j + 2) % 3)
            minor = [(_entry((a, c), (b, d)), 1), (_entry((a, d), (b, c)), -1)]
            yield _collected([*minor, (_entry((i, j)), -1)])


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
                    for a, b, s in _skew(i, j)
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


def _entry(*places: tuple[int, int]) -> Monomial:
    """The product of entries of R as a monomial in the nine."""
    return _exponents([3 * i + j for i, j in places], 9)


def _exponents(factors: Sequence[int], variables: int) -> Monomial:
    return tuple(sum(f == k for f in factors) for k in range(variables))


def _collected(terms: Iterable[tuple[Monomial, int]]) -> Polynomial:
    """The polynomial that is the sum of the terms."""
    total: Polynomial = {}
    for monomial, coefficient in terms:
        total[monomial] = total.get(monomial, 0) + coefficient
    return {monomial: coefficient for monomial, coefficient in total.items() if coefficient}


def _power_product(point: Sequence[Any], monomial: Monomial) -> Any:
    product: Any = 1
    for value, exponent in zip(point, monomial, strict=True):
        for _ in range(exponent):
            product = product * value
    return product
