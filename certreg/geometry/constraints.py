"""The quadratic constraints that make a 3x3 matrix a rotation, in ten variables: plain integers.

With r = (1, vec R) (10,), R by columns, everything of degree two that holds on rotations is a
combination of 21 forms r^T A r = 0, more than are needed to define them: redundant there, they make
a relaxation tighter. Source: [Briales2017], redundant rotation constraints.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations_with_replacement, product
from typing import Any

from certreg.geometry.so3 import T

SquareMatrix = tuple[tuple[T, ...], ...]
Monomials = dict[tuple[int, int], int]  # (i, j): the coefficient of r_i r_j

ROTATION_SIZE = 10
CYCLES = ((0, 1, 2), (1, 2, 0), (2, 0, 1))


def homogeneous(R: Sequence[Sequence[T]], unit: Any = 1) -> tuple[T, ...]:
    """The vector r = (unit, vec R), R by columns; unit = |q|^2 goes with the multiple |q|^2 R(q).

    >>> homogeneous(((1, 2, 3), (4, 5, 6), (7, 8, 9)))
    (1, 1, 4, 7, 2, 5, 8, 3, 6, 9)
    """
    return (unit, *(R[i][j] for j, i in product(range(3), repeat=2)))


def rotation_polynomials() -> tuple[Monomials, ...]:
    """The 21 quadratics in r that vanish for every rotation; they span 20 dimensions.

    6 of R^T R = I, 6 of R R^T = I, 9 of handedness. The one dependence: the diagonals of the first
    two have the same sum, |R|^2 = 3.
    """
    rows = _orthonormal(lambda k, a: _place(a, k))
    return (*_orthonormal(_place), *rows, *_handedness())


def rotation_quadratics() -> tuple[SquareMatrix[int], ...]:
    """The 21 matrices A with r^T A r = 0 for the r of every rotation: twice the polynomials."""
    return tuple(symmetric(polynomial) for polynomial in rotation_polynomials())


def _orthonormal(place: Callable[[int, int], int]) -> Iterator[Monomials]:
    """The entries of R^T R - I on and above the diagonal; place: of an entry of R in r."""
    for a, b in combinations_with_replacement(range(3), 2):
        yield {(0, 0): -int(a == b)} | {(place(k, a), place(k, b)): 1 for k in range(3)}


def _handedness() -> Iterator[Monomials]:
    """The entries of a x b - c for the columns a, b, c in each cyclic order."""
    for (a, b, c), (i, j, k) in product(CYCLES, repeat=2):
        yield {
            (_place(j, a), _place(k, b)): 1,
            (_place(k, a), _place(j, b)): -1,
            (0, _place(i, c)): -1,
        }


def _place(row: int, column: int) -> int:
    """Where R[row][column] stands in r."""
    return 1 + 3 * column + row


def symmetric(polynomial: Monomials, multiple: int = 2) -> SquareMatrix[int]:
    """The symmetric matrix A with r^T A r = multiple * polynomial(r)."""
    matrix = [[0] * ROTATION_SIZE for _ in range(ROTATION_SIZE)]
    for (i, j), coefficient in polynomial.items():
        if i == j:
            matrix[i][i] += multiple * coefficient
        else:
            matrix[i][j] += multiple * coefficient // 2
            matrix[j][i] += multiple * coefficient // 2
    return tuple(tuple(row) for row in matrix)
