"""Which pairs one motion may meet together, and which a given motion meets: exact, by rows.

A motion with the scale s that meets two pairs makes b = |y_j - y_i| of s a, a = |x_j - x_i|, but
for d = b_i + b_j: s a <= b + d and b <= s a + d, of a rigid motion with s = 1. Doubles decide where
their error is too small to matter, integers elsewhere.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from certreg._loading import cached_property
from certreg.certificate.consensus import RIGID, ScaledWitness, ScaleRange, Witness
from certreg.certificate.infeasibility_weights import PointRows
from certreg.exact.dyadic import dyadic_below, power_of_two
from certreg.geometry.so3 import quaternion_from_matrix, rotation_matrix, squared_norm
from certreg.native.bitset_graph import BitRows, agreeing
from certreg.native.cliques import triangles
from certreg.problem.lifting import lift
from certreg.relaxation.paired_scales import lengths_between, scale_ranges

if TYPE_CHECKING:
    from certreg.problem.problem import RegistrationProblem


Reals = NDArray[np.float64]

# Relative errors: a difference of doubles 2^-53, a squared length of three terms four times that,
# its root three times, and the last sums one more: eight times 2^-53 of all would do.
LENGTH_ERROR = 2.0**-48
MOTION_ERROR = 2.0**-44  # a residual: forty roundings of at most |x| + |y| + |t|, 2^-53 each
QUATERNION_BITS, SHIFT_BITS = 60, 64  # of a witness: its rounding is far below that of its points
END_BITS = 4  # more than it takes to tell the ends of a piece apart
TINY = 1e-100  # lengths, in the unit of their cloud, whose squares may lose digits


class ExactRows:
    """The points and bounds of a problem as integers over a power of two, when first asked for."""

    def __init__(self, problem: RegistrationProblem) -> None:
        self._problem = problem

    @cached_property
    def _lifted(self) -> tuple[list[tuple[int, ...]], int]:
        block = self._problem.points
        table = lift(np.column_stack([block.source, block.target, self._problem.bounds]).ravel())
        return list(zip(*(table.integers[k::7] for k in range(7)), strict=True)), table.exponent

    @property
    def rows(self) -> list[tuple[int, ...]]:
        """x1, x2, x3, y1, y2, y3 and the bound of each pair."""
        return self._lifted[0]

    @property
    def exponent(self) -> int:
        """Of the power of two."""
        return self._lifted[1]

    def agree(self, i: int, j: int, scales: ScaleRange = RIGID) -> bool:
        """Whether s a <= b + d for the least s, b <= s a + d for the largest."""
        one, other = self.rows[i], self.rows[j]
        gaps = [p - q for p, q in zip(one, other, strict=True)]
        A, B, d = squared_norm(gaps[:3]), squared_norm(gaps[3:6]), one[6] + other[6]
        return _at_most(scales.low**2 * A, B, d) and (
            scales.high is None or _at_most(B, scales.high**2 * A, d)
        )

    def met_by(self, witness: Witness, some: Sequence[int]) -> list[int]:
        """Those of some rows that a motion meets."""
        if not some:
            return []
        s, one = witness.scale.as_integer_ratio()
        norm, turn = squared_norm(witness.quaternion), rotation_matrix(list(witness.quaternion))
        *shift, exponent = witness.shift
        low = min(self.exponent, exponent)
        up, t = self.exponent - low, [norm * one * k << exponent - low for k in shift]
        return [
            i
            for i, row in ((i, self.rows[i]) for i in some)
            if squared_norm(
                [
                    (norm * one * row[3 + k] - s * sum(turn[k][m] * row[m] for m in range(3)) << up)
                    - t[k]
                    for k in range(3)
                ]
            )
            <= (norm * one * row[6] << up) ** 2
        ]


class ScaleBounds(NamedTuple):
    """(N, N) each, of two pairs: with which scales a motion may meet both, and how doubles err.

    error: of `most`, and of `least`. unsure: where lengths are too small to tell.
    """

    least: Reals
    most: Reals
    error: Reals
    unsure: NDArray[np.bool_]


class ConsistentPairs:
    """The pairs of a problem, and which two of them a motion with a scale may meet together.

    source, target, bounds: in doubles, in a unit near their size, each cloud in one of its own.
    These are powers of two. exponent: a scale of 1 there is 2^exponent.
    """

    def __init__(self, problem: RegistrationProblem) -> None:
        block, bounds = problem.points, problem.bounds
        self.exact = ExactRows(problem)
        self.unit, here = self._units(block.source, block.target, bounds)
        self.exponent = self.unit - here
        self.source, self.target = block.source * 2.0**-here, block.target * 2.0**-self.unit
        self.bounds = bounds * 2.0**-self.unit

    @staticmethod
    def of(problem: RegistrationProblem) -> ConsistentPairs:
        """Those of the motions of a problem."""
        return ConsistentPairs(problem) if problem.scaled else RigidPairs(problem)

    def _units(self, source: Reals, target: Reals, bounds: Reals) -> tuple[int, int]:
        """Exponents of those of target and source."""
        return _exponent(target, bounds), _exponent(source)

    def witness(self, rotation: Reals, translation: Reals, scale: float) -> Witness:
        """A motion in integers, next to one in doubles."""
        turned = witness_of(rotation, translation)
        factor = dyadic_below(Fraction(scale), 53)
        return ScaledWitness(quaternion=turned.quaternion, shift=turned.shift, factor=factor)

    def ranges(self, scale: Fraction) -> list[ScaleRange]:
        """All scales, cut beside one of them."""
        near = dyadic_below(scale, END_BITS).value
        below, beside = ScaleRange(Fraction(0), near / 2), ScaleRange(near / 2, near * 2)
        return [below, beside, ScaleRange(near * 2, None)]

    def points(self, scales: ScaleRange = RIGID) -> PointRows:
        """To be refuted with these scales."""
        low, high = self.in_units(scales.low), self.in_units(scales.high)
        return PointRows(self.source, self.target, self.bounds, low, high)

    def in_units(self, scale: Fraction | None) -> float:
        """A scale in these units; infinite for None."""
        return math.inf if scale is None else float(scale * power_of_two(-self.exponent))

    @cached_property
    def scales(self) -> ScaleBounds:
        """Of any two pairs."""
        a, b = lengths_between(self.source), lengths_between(self.target)
        room = np.add.outer(self.bounds, self.bounds)
        least, most = scale_ranges(a, b, room)
        return ScaleBounds(least, most, LENGTH_ERROR * most, ~(np.minimum(a, b + room) > TINY))

    def near(self, scales: ScaleRange = RIGID) -> BitRows:
        """For each pair those that one motion with such a scale may meet with it, as bits."""
        low, high = self.in_units(scales.low), self.in_units(scales.high)
        least, most, error, unsure = self.scales
        allowed = (least <= high) & (most >= low)
        doubtful = unsure | (np.abs(most - low) <= error + LENGTH_ERROR * low)
        if math.isfinite(high):
            doubtful |= np.abs(least - high) <= error + LENGTH_ERROR * high
        for i, j in np.argwhere(np.triu(doubtful, 1)).tolist():
            allowed[i, j] = allowed[j, i] = self.exact.agree(i, j, scales)
        np.fill_diagonal(allowed, val=False)
        return BitRows.of_table(allowed)

    def met_by(self, witness: Witness) -> list[int]:
        """The rows that a motion meets, in integers."""
        return self.exact.met_by(witness, range(len(self.bounds)))

    def scattered(self) -> bool:
        """Whether no motion meets three pairs, by their lengths; False means not proved."""
        return False


class RigidPairs(ConsistentPairs):
    """The same of rigid motions, which keep lengths: one unit for both clouds, one scale."""

    def _units(self, source: Reals, target: Reals, bounds: Reals) -> tuple[int, int]:
        unit = _exponent(target, bounds, source)
        return unit, unit

    def witness(self, rotation: Reals, translation: Reals, scale: float) -> Witness:  # noqa: ARG002
        """A motion in integers, next to one in doubles."""
        return witness_of(rotation, translation)

    def ranges(self, scale: Fraction) -> list[ScaleRange]:  # noqa: ARG002
        """That of scale 1."""
        return [RIGID]

    def near(self, scales: ScaleRange = RIGID) -> BitRows:  # noqa: ARG002
        """The same by compiled code, which knows no scale."""
        compiled = agreeing(self.source, self.target, self.bounds)
        more = [(i, j) for i, j in compiled.open_pairs if self.exact.agree(i, j)]
        return compiled.near.with_edges(more) if more else compiled.near

    def met_by(self, witness: Witness) -> list[int]:
        """The rows that a motion meets, exactly: in integers where doubles leave it open."""
        q = np.array([float(k) for k in witness.quaternion])
        *shift, exponent = witness.shift
        R = np.array(rotation_matrix((q / np.linalg.norm(q)).tolist()))
        t = np.array([math.ldexp(k, exponent - self.unit) for k in shift])
        room = self.bounds - np.linalg.norm(self.target - self.source @ R.T - t, axis=1)
        sizes = np.abs(self.source).sum(axis=1) + np.abs(self.target).sum(axis=1)
        error = MOTION_ERROR * (sizes + np.abs(t).sum() + self.bounds) + 1e-300
        sure = np.abs(room) > error
        doubtful = set(self.exact.met_by(witness, np.flatnonzero(~sure).tolist()))
        return [i for i in range(len(room)) if (room[i] > 0.0 if sure[i] else i in doubtful)]

    def scattered(self) -> bool:
        """Whether no three of them keep their distances from each other."""
        return not triangles(self.near(), (1 << len(self.bounds)) - 1).any()


def witness_of(rotation: Reals, translation: Reals) -> Witness:
    """A rigid motion in integers, next to one in doubles."""
    w, x, y, z = np.rint(np.ldexp(quaternion_from_matrix(rotation), QUATERNION_BITS)).tolist()
    size = float(np.abs(translation).max())
    exponent = int(np.frexp(size)[1]) - SHIFT_BITS if size else 0
    a, b, c = (int(Fraction(k) / Fraction(2) ** exponent) for k in translation.tolist())
    return Witness(quaternion=(int(w), int(x), int(y), int(z)), shift=(a, b, c, exponent))


def _at_most(A: Fraction | int, B: Fraction | int, d: int) -> bool:
    """Whether the root of A is at most that of B and d: A - B - d^2 <= 2 d sqrt(B)."""
    more = A - B - d * d
    return more <= 0 or more * more <= 4 * d * d * B


def _exponent(*arrays: Reals) -> int:
    """Of a power of two near the largest of the numbers."""
    return int(np.frexp(max(float(np.abs(array).max()) for array in arrays))[1])
