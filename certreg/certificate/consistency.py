"""Which pairs one motion may meet together, and which a given motion meets: exact, by rows.

Two pairs that one motion meets have lengths that agree: with a = |x_j - x_i|, b = |y_j - y_i| and
d = b_i + b_j, a motion that moves each y by at most its bound changes b by at most d, so
|a - b| <= d. Doubles decide where their error is too small to matter, integers elsewhere.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from certreg.geometry.so3 import rotation_matrix, squared_norm
from certreg.native.bit_rows import BitRows, agreeing
from certreg.problem.lifting import lift

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from certreg.certificate.consensus import Witness
    from certreg.problem.problem import RegistrationProblem

# Relative errors: a difference of doubles 2^-53, a squared length of three terms four times that,
# its root three times, and the last sums one more: eight times 2^-53 of all would do.
LENGTH_ERROR = 2.0**-48
MOTION_ERROR = 2.0**-44  # a residual: forty roundings of at most |x| + |y| + |t|, 2^-53 each
BLOCK_ROWS = 32  # rows against all others at a time: of 1,000 they stay in the cache
QUATERNION_BITS, SHIFT_BITS = 60, 64  # of a witness: its rounding is far below that of its points


def consistent_pairs(problem: RegistrationProblem) -> BitRows:
    """For each pair those that one motion may meet with it."""
    block = problem.points
    one = 2.0 ** -_exponent(problem)  # exact, but for what is too small to matter beside errors
    points = np.hstack([block.source, block.target]) * one
    exact, found = ExactRows(problem), agreeing(points, problem.bounds * one)
    if found is None:
        return _agreeing(exact, points, problem.bounds * one)
    more = [(i, j) for i, j in found.open_pairs if exact.agree(i, j)]
    return found.near.with_edges(more) if more else found.near


def _agreeing(
    exact: ExactRows, points: NDArray[np.float64], bounds: NDArray[np.float64]
) -> BitRows:
    """Where there is no compiled code."""
    x, y, n = points[:, :3], points[:, 3:], len(bounds)
    allowed = np.empty((n, n), dtype=bool)
    for start in range(0, n, BLOCK_ROWS):
        rows, later = slice(start, start + BLOCK_ROWS), slice(start, None)
        a, b = lengths(x[rows], x[later]), lengths(y[rows], y[later])
        error = LENGTH_ERROR * float(a.max() + b.max() + 2.0 * bounds.max()) + 1e-300
        room = np.add.outer(bounds[rows], bounds[later])
        a -= b
        room -= np.abs(a, out=a)
        block = room >= 0.0
        for i, j in np.argwhere(np.abs(room, out=room) <= error).tolist():
            block[i, j] = exact.agree(start + i, start + j)
        allowed[rows, later] = block
        allowed[later, rows] = block.T
    np.fill_diagonal(allowed, val=False)
    return BitRows.of_table(allowed)


def _exponent(problem: RegistrationProblem) -> int:
    """Of a power of two near the size of the problem."""
    block = problem.points
    size = max(np.abs(block.source).max(), np.abs(block.target).max(), problem.bounds.max())
    return int(np.frexp(size)[1])


def lengths(points: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.float64]:
    """(m, n): distances of each point from each other."""
    square = np.subtract.outer(points[:, 0], others[:, 0])
    square *= square
    for axis in (1, 2):
        difference = np.subtract.outer(points[:, axis], others[:, axis])
        difference *= difference
        square += difference
    return np.sqrt(square, out=square)


class ExactRows:
    """The points and bounds of a problem as integers over a power of two, when first asked for."""

    def __init__(self, problem: RegistrationProblem) -> None:
        self._problem = problem
        self._rows: list[tuple[int, ...]] = []
        self.exponent = 0

    @property
    def rows(self) -> list[tuple[int, ...]]:
        """x1, x2, x3, y1, y2, y3 and the bound of each pair."""
        if not self._rows:
            block = self._problem.points
            table = np.column_stack([block.source, block.target, self._problem.bounds])
            lifted = lift(table.ravel())
            self.exponent = lifted.exponent
            parts = [lifted.integers[k::7] for k in range(7)]
            self._rows = list(zip(*parts, strict=True))
        return self._rows

    def agree(self, i: int, j: int) -> bool:
        """Whether |a - b| <= d, that is a <= b + d and b <= a + d: a^2 - b^2 - d^2 <= 2 b d."""
        one, other = self.rows[i], self.rows[j]
        gaps = [p - q for p, q in zip(one, other, strict=True)]
        A, B, d = squared_norm(gaps[:3]), squared_norm(gaps[3:6]), one[6] + other[6]
        return all(
            long - short - d * d <= 0 or (long - short - d * d) ** 2 <= 4 * short * d * d
            for long, short in ((A, B), (B, A))
        )

    def met_by(self, witness: Witness) -> list[int]:
        """The rows that a motion meets, exactly: in integers where doubles leave it open."""
        block, unit = self._problem.points, _exponent(self._problem)
        one, q = 2.0**-unit, np.array([float(k) for k in witness.quaternion])
        x, y, bounds = block.source * one, block.target * one, self._problem.bounds * one
        *shift, exponent = witness.shift
        R = np.array(rotation_matrix((q / np.linalg.norm(q)).tolist()))
        t = np.array([math.ldexp(k, exponent - unit) for k in shift])
        room = bounds - np.linalg.norm(y - x @ R.T - t, axis=1)
        sizes = np.abs(x).sum(axis=1) + np.abs(y).sum(axis=1)
        error = MOTION_ERROR * (sizes + np.abs(t).sum() + bounds) + 1e-300
        sure = np.abs(room) > error
        doubtful = set(self._met_by(witness, np.flatnonzero(~sure).tolist()))
        return [i for i in range(len(room)) if (room[i] > 0.0 if sure[i] else i in doubtful)]

    def _met_by(self, witness: Witness, some: list[int]) -> list[int]:
        """Those of some rows."""
        if not some:
            return []
        rows, q = self.rows, witness.quaternion
        norm, turn = squared_norm(q), _turn(q)
        *shift, exponent = witness.shift
        low = min(self.exponent, exponent)
        up, t = self.exponent - low, [norm * k << exponent - low for k in shift]
        return [
            i
            for i in some
            if squared_norm(
                [
                    (norm * rows[i][3 + k] - sum(turn[k][m] * rows[i][m] for m in range(3)) << up)
                    - t[k]
                    for k in range(3)
                ]
            )
            <= (norm * rows[i][6] << up) ** 2
        ]


def _turn(q: Sequence[int]) -> list[list[int]]:
    """|q|^2 R(q), in integers."""
    return [list(row) for row in rotation_matrix(list(q))]
