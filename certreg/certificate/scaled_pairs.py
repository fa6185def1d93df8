"""Pairs of points whose scale is free: which two a motion may meet whose scale is in a range.

A motion with the scale s that meets two pairs makes b = |y_j - y_i| of s a, a = |x_j - x_i|, but
for d = b_i + b_j: (b - d)/a <= s <= (b + d)/a. Doubles decide where their error is too small to
matter, integers elsewhere.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from certreg.certificate.consistency import LENGTH_ERROR, lengths
from certreg.certificate.scaled_refuting import ScaledRows
from certreg.exact.dyadic import power_of_two
from certreg.geometry.so3 import rotation_matrix, squared_norm
from certreg.native.bit_rows import BitRows
from certreg.problem.lifting import lift

if TYPE_CHECKING:
    from fractions import Fraction

    from numpy.typing import NDArray

    from certreg.certificate.scaled_consensus import ScaledWitness, ScaleRange
    from certreg.problem.problem import RegistrationProblem

TINY = 1e-100  # lengths, in the unit of their cloud, whose squares may lose digits


class ScaledPairs:
    """The pairs of a problem, and between which scales two of them may be met together.

    Of the source and the target the units are their own: powers of two near their sizes.
    """

    def __init__(self, problem: RegistrationProblem) -> None:
        block = problem.points
        table = np.column_stack([block.source, block.target, problem.bounds])
        lifted = lift(table.ravel())
        parts = [lifted.integers[k::7] for k in range(7)]
        self._rows = list(zip(*parts, strict=True))
        self._low = lifted.exponent
        here, there = _exponent(block.source), _exponent(block.target, problem.bounds)
        self.exponent = there - here  # a scale of 1 in these units is 2^exponent
        self.source, self.target = block.source * 2.0**-here, block.target * 2.0**-there
        self.bounds = problem.bounds * 2.0**-there
        a, b = lengths(self.source, self.source), lengths(self.target, self.target)
        room = np.add.outer(self.bounds, self.bounds)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            self.least, self.most = np.maximum(b - room, 0.0) / a, (b + room) / a
        self._error = LENGTH_ERROR * self.most
        self._unsure = ~(np.minimum(a, b + room) > TINY)
        np.fill_diagonal(self._unsure, val=False)

    def in_units(self, scale: Fraction | None) -> float:
        """A scale in these units; infinite for None."""
        return math.inf if scale is None else float(scale * power_of_two(-self.exponent))

    def near(self, scales: ScaleRange) -> BitRows:
        """For each pair those that one motion with such a scale may meet with it, as bits."""
        low, high = self.in_units(scales.low), self.in_units(scales.high)
        allowed = (self.least <= high) & (self.most >= low)
        error = self._error + LENGTH_ERROR * low
        doubtful = self._unsure | (np.abs(self.most - low) <= error)
        if math.isfinite(high):
            doubtful |= np.abs(self.least - high) <= self._error + LENGTH_ERROR * high
        np.fill_diagonal(doubtful, val=False)
        for i, j in np.argwhere(np.triu(doubtful)).tolist():
            allowed[i, j] = allowed[j, i] = self._agree(i, j, scales)
        np.fill_diagonal(allowed, val=False)
        return BitRows.of_table(allowed)

    def _agree(self, i: int, j: int, scales: ScaleRange) -> bool:
        """Whether s a <= b + d for the least s, b <= s a + d for the largest."""
        one, other = self._rows[i], self._rows[j]
        gaps = [p - q for p, q in zip(one, other, strict=True)]
        A, B, d = squared_norm(gaps[:3]), squared_norm(gaps[3:6]), one[6] + other[6]
        return _at_most(scales.low**2 * A, B, d) and (
            scales.high is None or _at_most(B, scales.high**2 * A, d)
        )

    def met_by(self, witness: ScaledWitness) -> list[int]:
        """The rows that a motion meets, exactly."""
        s, one = witness.factor.value.as_integer_ratio()
        norm, turn = squared_norm(witness.quaternion), rotation_matrix(list(witness.quaternion))
        *shift, exponent = witness.shift
        low = min(self._low, exponent)
        up, t = self._low - low, [norm * one * k << exponent - low for k in shift]
        return [
            i
            for i, row in enumerate(self._rows)
            if squared_norm(
                [
                    (norm * one * row[3 + k] - s * sum(turn[k][m] * row[m] for m in range(3)) << up)
                    - t[k]
                    for k in range(3)
                ]
            )
            <= (norm * one * row[6] << up) ** 2
        ]

    def points(self, scales: ScaleRange) -> ScaledRows:
        """To be refuted with these scales."""
        return ScaledRows(
            self.source,
            self.target,
            self.bounds,
            self.in_units(scales.low),
            self.in_units(scales.high),
        )


def _at_most(A: Fraction, B: Fraction, d: int) -> bool:
    """Whether the root of A is at most that of B and d: A - B - d^2 <= 2 d sqrt(B)."""
    more = A - B - d * d
    return more <= 0 or more * more <= 4 * d * d * B


def _exponent(*arrays: NDArray[np.float64]) -> int:
    """Of a power of two near the largest of the numbers."""
    return int(np.frexp(max(float(np.abs(array).max()) for array in arrays))[1])
