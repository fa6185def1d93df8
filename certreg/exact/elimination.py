"""Exact positive definiteness of a symmetric integer matrix."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence


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


def rank(matrix: Sequence[Sequence[int]]) -> int:
    """The rank of an integer matrix, by the same elimination with row and column pivoting.

    >>> rank([[1, 2], [2, 4]]), rank([[0, 0], [0, 0]])
    (1, 0)
    """
    rows = [list(row) for row in matrix]
    found = 0
    while rows and rows[0]:
        column = next((j for j in range(len(rows[0])) if any(row[j] for row in rows)), None)
        if column is None:
            break
        pivot_row = next(row for row in rows if row[column])
        rows.remove(pivot_row)
        pivot = pivot_row[column]
        rows = [
            [row[j] * pivot - row[column] * pivot_row[j] for j in range(len(row)) if j != column]
            for row in rows
        ]
        found += 1
    return found
