"""Which pairs one motion may meet together, and which a given motion meets: exact, by rows.

Two pairs that one motion meets have lengths that agree: with a = |x_j - x_i|, b = |y_j - y_i| and
d = b_i + b_j, a motion that moves each y by at most its bound changes b by at most d, so
|a - b| <= d. Doubles decide where their error is too small to matter, integers elsewhere.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from certreg.geometry import rotation_matrix, squared_norm
from certreg.problem import lift

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from certreg.certificate.consensus import Witness
    from certreg.problem import ConsensusProblem

# Relative errors: a difference of doubles 2^-53, a squared length of three terms four times that,
# its root three times, and the last sums one more: eight times 2^-53 of all would do.
LENGTH_ERROR = 2.0**-48
BLOCK_ROWS = 256  # rows against all others at a time: 25 MB of 4,096
QUATERNION_BITS, SHIFT_BITS = 60, 64  # of a witness: its rounding is far below that of its points


def consistent_pairs(problem: ConsensusProblem) -> list[int]:
    """For each pair those that one motion may meet with it, as bits of an integer."""
    block = problem.problem.block(slice(None))
    size = float(max(np.abs(block.source).max(), np.abs(block.target).max(), problem.bounds.max()))
    one = 2.0 ** -np.frexp(size)[1]  # exact, but for what is too small to matter beside the errors
    x, y, bounds = block.source * one, block.target * one, problem.bounds * one
    exact = ExactRows(problem)
    near: list[int] = []
    for start in range(0, problem.n, BLOCK_ROWS):
        rows = slice(start, start + BLOCK_ROWS)
        a, b = _lengths(x[rows], x), _lengths(y[rows], y)
        room = bounds[rows, None] + bounds - np.abs(a - b)
        allowed = room >= 0.0
        doubtful = np.abs(room) <= LENGTH_ERROR * (a + b + bounds[rows, None] + bounds) + 1e-300
        for i, j in np.argwhere(doubtful).tolist():
            allowed[i, j] = exact.agree(start + i, j)
        packed = np.packbits(allowed, axis=1, bitorder="little")
        near += [int.from_bytes(row.tobytes(), "little") for row in packed]
    return [mask & ~(1 << i) for i, mask in enumerate(near)]


def _lengths(points: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.float64]:
    """(m, n): distances of each point from each other."""
    square = np.zeros((len(points), len(others)))
    for axis in range(3):
        difference = points[:, None, axis] - others[None, :, axis]
        square += difference * difference
    return np.sqrt(square)


class ExactRows:
    """The points and bounds of a problem as integers over a power of two, when first asked for."""

    def __init__(self, problem: ConsensusProblem) -> None:
        self._problem = problem
        self._rows: list[tuple[int, ...]] = []
        self.exponent = 0

    @property
    def rows(self) -> list[tuple[int, ...]]:
        """x1, x2, x3, y1, y2, y3 and the bound of each pair."""
        if not self._rows:
            block = self._problem.problem.block(slice(None))
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
        """The rows that a motion meets, exactly."""
        rows, q = self.rows, witness.quaternion
        norm, turn = squared_norm(q), _turn(q)
        *shift, exponent = witness.shift
        low = min(self.exponent, exponent)
        up, t = self.exponent - low, [norm * k << exponent - low for k in shift]
        return [
            i
            for i, row in enumerate(rows)
            if squared_norm(
                [
                    (norm * row[3 + k] - sum(turn[k][m] * row[m] for m in range(3)) << up) - t[k]
                    for k in range(3)
                ]
            )
            <= (norm * row[6] << up) ** 2
        ]


def _turn(q: Sequence[int]) -> list[list[int]]:
    """|q|^2 R(q), in integers."""
    return [list(row) for row in rotation_matrix(list(q))]


def rows_of(mask: int) -> Iterator[int]:
    """The places of the ones."""
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low


def mask_of(rows: Sequence[int]) -> int:
    """The inverse of `rows_of`."""
    mask = 0
    for row in rows:
        mask |= 1 << row
    return mask
