"""Exact answers about integer matrices, by elimination without fractions."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from operator import mul

PRIME = 2**61 - 1  # a matrix loses rank modulo it once in 2^61, and then only time is lost


def is_positive_definite(matrix: Sequence[Sequence[int]]) -> bool:
    """Whether all leading principal minors are positive (Sylvester's criterion): an exact answer.

    Fraction-free elimination [Bareiss1968]: the k-th pivot is the k-th leading minor, every
    division is exact, so no rational arithmetic is needed and integers stay short. What is left
    stays symmetric, so only what is on the diagonal and above is read.

    >>> is_positive_definite([[2, 1], [1, 1]]), is_positive_definite([[1, 1], [1, 1]])
    (True, False)
    """
    rows = [list(row) for row in matrix]
    size, previous = len(rows), 1
    for k, first in enumerate(rows):
        pivot = first[k]
        if pivot <= 0:
            return False
        for i in range(k + 1, size):
            row, factor = rows[i], first[i]
            for j in range(i, size):
                row[j] = (row[j] * pivot - factor * first[j]) // previous
        previous = pivot
    return True


def definite_inverse(matrix: Sequence[Sequence[int]]) -> tuple[int, list[list[int]]] | None:
    """The determinant and the adjugate of a symmetric positive definite matrix; None of any other.

    By the method of Faddeev and LeVerrier: M_0 = I, e_j = tr(A M_j-1) / j, M_j = e_j I - A M_j-1,
    all in integers. The e_j are the sums of products of j eigenvalues: all of them are positive
    exactly where the eigenvalues, which are real, are.

    >>> definite_inverse([[2, 1], [1, 1]]), definite_inverse([[1, 1], [1, 1]])
    ((1, [[1, -1], [-1, 2]]), None)
    """
    found = 1, list[list[int]]()
    for found in leverrier(matrix):
        if found[0] <= 0:
            return None
    return found


def leverrier(matrix: Sequence[Sequence[int]]) -> Iterator[tuple[int, list[list[int]]]]:
    """e_j and M_j-1 of a square matrix for j = 1, 2, ..., as above: every division is exact."""
    size = range(len(matrix))
    part = [[int(i == j) for j in size] for i in size]
    for k in size:
        columns = list(zip(*part, strict=True))
        product = [[sum(map(mul, row, column)) for column in columns] for row in matrix]
        value = sum(product[i][i] for i in size) // (k + 1)
        yield value, part
        part = [[-entry for entry in row] for row in product]
        for i in size:
            part[i][i] += value


def rank(matrix: Sequence[Sequence[int]]) -> int:
    """The rank of an integer matrix.

    >>> rank([[1, 2], [2, 4]]), rank([[0, 0], [0, 0]])
    (1, 0)
    """
    columns = len(matrix[0]) if matrix else 0
    return columns - len(nullspace(matrix, columns))


def nullspace(matrix: Sequence[Sequence[int]], columns: int) -> tuple[tuple[int, ...], ...]:
    """A basis of the vectors that an integer matrix of so many columns takes to zero.

    Each vector is of coprime integers, its last entry other than zero positive. Rows that are
    independent modulo a prime are independent; what these take to zero is tried on all.

    >>> nullspace([[1, 2, 0], [2, 4, 0]], 3)
    ((-2, 1, 0), (0, 0, 1))
    """
    some = [matrix[k] for k in _independent(matrix, columns)]
    if len(some) == columns:
        return ()
    basis = _nullspace(some, columns)
    if all(sum(map(mul, row, vector)) == 0 for row in matrix for vector in basis):
        return basis
    return _nullspace(matrix, columns)


def _independent(matrix: Sequence[Sequence[int]], columns: int) -> list[int]:
    """Numbers of rows that are independent modulo `PRIME`, as many as are."""
    found, pivots = list[int](), list[tuple[int, list[int]]]()
    for number, entries in enumerate(matrix):
        row = [entry % PRIME for entry in entries]
        for column, pivot in pivots:
            factor = row[column]
            if factor:
                row = [(a - factor * b) % PRIME for a, b in zip(row, pivot, strict=True)]
        column = next((k for k, entry in enumerate(row) if entry), None)
        if column is not None:
            inverse = pow(row[column], -1, PRIME)
            pivots.append((column, [entry * inverse % PRIME for entry in row]))
            found.append(number)
        if len(found) == columns:
            break
    return found


def _nullspace(matrix: Sequence[Sequence[int]], columns: int) -> tuple[tuple[int, ...], ...]:
    rows, pivots = [list(row) for row in matrix], list[int]()
    reduced: list[list[int]] = []
    for column in range(columns):
        first = next((row for row in rows if row[column]), None)
        if first is None:
            continue
        rows.remove(first)
        rows, reduced = (
            [_eliminated(row, first, column) for row in group] for group in (rows, reduced)
        )
        reduced.append(first)
        pivots.append(column)
    free = [k for k in range(columns) if k not in pivots]
    return tuple(_solution(reduced, pivots, k, columns) for k in free)


def _eliminated(row: list[int], first: list[int], column: int) -> list[int]:
    """A multiple of a row with zero in a column, by a row that has another number there."""
    if not row[column]:
        return row
    a, b = first[column], row[column]
    less = [a * own - b * other for own, other in zip(row, first, strict=True)]
    common = math.gcd(*less) or 1
    return [entry // common for entry in less]


def _solution(
    reduced: Sequence[Sequence[int]], pivots: Sequence[int], free: int, columns: int
) -> tuple[int, ...]:
    """The vector of the kernel with one free variable, cleared of denominators."""
    multiple = math.lcm(*(row[p] for row, p in zip(reduced, pivots, strict=True)))
    vector = [0] * columns
    vector[free] = multiple
    for row, pivot in zip(reduced, pivots, strict=True):
        vector[pivot] = -multiple // row[pivot] * row[free]
    common = math.gcd(*vector)
    return tuple(entry // common for entry in vector)
