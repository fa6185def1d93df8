"""The objective of one weight per correspondence: an eigenvalue problem of four dimensions.

V(q) = sum w |y - mean|^2 + sum w |x - mean|^2 - 2 q^T K q / |q|^2 at the best translation, with
Davenport's matrix K, and M |c|^2 more where the source's centre of mass is c away from the target's
[Yang2020, V_p]. So critical rotations are eigenvectors of K.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from operator import mul
from typing import TYPE_CHECKING, ClassVar, Literal

from certreg._loading import cached_property
from certreg.exact.dyadic import power_of_two, quotient_or_zero
from certreg.exact.eigenbasis import integer_eigenbasis
from certreg.exact.spaces import IntegerQuaternion, Resolution, Space, resolved
from certreg.geometry.so3 import (
    Matrix4,
    Vector3,
    davenport_matrix,
    dot,
    quadratic_form,
    rotation_matrix,
    squared_norm,
)
from certreg.native.eigenbasis import FIXED_BITS, fixed_eigenbasis
from certreg.objective.classification import Classification, Pattern, classify, with_pattern
from certreg.objective.form import Form, Reduced, bordered
from certreg.objective.objective import Objective
from certreg.objective.scaling import Real, Scaling
from certreg.objective.structure import Structure
from certreg.problem.exact_sums import UPPER
from certreg.problem.moments import ExactMoments, exact_moments, trace

if TYPE_CHECKING:
    from certreg.geometry.constraints import SquareMatrix
    from certreg.problem.problem import RegistrationProblem


KEPT = 16  # alignments that are asked for again


@dataclass(frozen=True)
class Isotropic(Objective):
    """The objective of the exact moments of a problem; see `Objective`.

    Davenport's matrix, its classification and its eigenspaces are made once, when first asked for.
    scaling: of a problem whose scale is free: energies, scales and translations are its own. The
    polynomials (`form`, `value`, `gradient`, `hessian`) are those of scale 1, which has the same
    critical rotations.
    """

    moments: ExactMoments
    scaling: Scaling | None = None
    structure: ClassVar[Structure] = Structure.LINEAR

    @classmethod
    def of(cls, problem: RegistrationProblem) -> Isotropic:
        """The objective of a problem with weights.

        Raises DegenerateProblemError where its scale is free, and the points tell none.
        """
        moments = exact_moments(problem)
        return cls(moments, Scaling.of(moments, problem.motion))

    @cached_property
    def davenport(self) -> Matrix4[int]:
        """K in units of `moments.cross_unit`."""
        return davenport_matrix(self.moments.cross)

    @cached_property
    def joint_form(self) -> Form:
        """The energy at any scale and translation, a weight being that multiple of I.

        Its `reduced` is that of the centred sums, up to the unit.
        """
        m = self.moments
        total, first = m.target_sum, m.source_sum
        second, cross = (
            [[(centred[i][j] + own[i] * first[j]) // m.mass for j in range(3)] for i in range(3)]
            for centred, own in ((m.source_scatter, first), (m.cross, total))
        )
        spread = (trace(m.target_scatter) + squared_norm(total)) // m.mass
        own, none = bordered(second, first, m.mass), bordered([[0] * 3] * 3, [0] * 3, 0)
        return Form.of(
            [own if a == b else none for a, b in UPPER],
            [(*row, pull) for row, pull in zip(cross, total, strict=True)],
            spread,
            (m.source_exponent, m.target_exponent, m.weight_exponent),
        )

    @cached_property
    def reduced(self) -> Reduced:
        """The energy at any scale with the best translation."""
        m, least = self.moments, self._least
        here, there = m.source_exponent - least, m.target_exponent - least
        rows, moves = [[0] * 10 for _ in range(10)], [[0] * 10 for _ in range(3)]
        rows[0][0] = trace(m.target_scatter) << 2 * there
        for a, j in product(range(3), repeat=2):
            place = 1 + 3 * j + a
            rows[0][place] = rows[place][0] = -m.cross[a][j] << here + there
            rows[place][1 + a :: 3] = [entry << 2 * here for entry in m.source_scatter[j]]
            moves[a][0], moves[a][place] = m.target_sum[a] << there, -m.source_sum[j] << here
        return Reduced(
            rows=tuple(map(tuple, rows)),
            unit=self.unit,
            response=tuple(map(tuple, moves)),
            stiffness=((m.mass, 0, 0), (0, m.mass, 0), (0, 0, m.mass)),
            compliance=((1, 0, 0), (0, 1, 0), (0, 0, 1)),
            determinant=m.mass,
            length_exponent=least,
        )

    @cached_property
    def largest_entry(self) -> int:
        """Of K, without its sign."""
        return max([max(*row, -min(row)) for row in self.davenport])

    @property
    def shift(self) -> int:
        """The entries of K are below 2^shift."""
        return self.largest_entry.bit_length()

    @cached_property
    def size(self) -> Fraction:
        """The largest entry of K, in units of tr(R^T C); positive even where K is zero."""
        unit = self.moments.cross_unit
        return self.largest_entry * unit or self.moments.spread or unit

    @cached_property
    def least_range_squared(self) -> Fraction:
        """(2 F)^2, F the Frobenius norm of K: at most the squared range of energies over SO(3).

        The range is 2 (l1 - l4). With the special singular values d1 >= d2 >= |d3| of C it is
        4 (d1 + d2), and F^2 = 4 (d1^2 + d2^2 + d3^2) <= 4 (d1 + d2)^2, as d3^2 <= d1 d2. So the
        range lies between 2 F and sqrt(2) times that; both are 0 only where C is.
        """
        squares = sum([entry * entry for row in self.davenport for entry in row])
        unit = self.moments.cross_unit
        if self.scaling is not None:
            return self.scaling.least_range(self.alignment(self.optimum), squares * unit**2)
        return Fraction(4 * squares * unit.numerator**2, unit.denominator**2)

    @cached_property
    def classification(self) -> Classification:
        """Which of the eight kinds of equilibrium set this is, decided in integers."""
        return classify(self.moments)

    def classified(self, pattern: Pattern) -> Classification:
        """The classification if the pattern is this one, as some method says."""
        return with_pattern(self.moments, pattern)

    # --- the objective

    @property
    def unit(self) -> Fraction:
        """What 1 is worth, in units of the energy."""
        return power_of_two(self.moments.weight_exponent + 2 * self._least) / self.moments.mass

    @property
    def _least(self) -> int:
        return min(self.moments.source_exponent, self.moments.target_exponent)

    def form(self) -> SquareMatrix[int]:
        """Q with V(R) = unit * r^T Q r, r = (1, vec R): nothing but a border.

        |R x|^2 is that of x: the trace of the source's scatter stands in the corner.
        """
        (spread, *cross), *rows = self.reduced.rows
        border = (spread + sum(rows[3 * j][1 + 3 * j] for j in range(3)), *cross)
        return (border, *((entry, *[0] * len(cross)) for entry in cross))

    def best_scale(self, q: Sequence[int]) -> Fraction:
        """The scale that is best at fixed rotation; 1 where it is not free."""
        return Fraction(1) if self.scaling is None else self.scaling.best(self.alignment(q))

    # --- the best translation is mean(y) - s R(q) mean(x): no form is made for it

    def best_translation(
        self, q: Sequence[int], scale: Fraction | Literal[1] | None = None
    ) -> Vector3[Fraction]:
        """As the base has it."""
        stretch = self.best_scale(q) if scale is None else scale
        (x, y, z), up, over = self._best_translation(q, stretch)
        return Fraction(x * up, over), Fraction(y * up, over), Fraction(z * up, over)

    def rounded_translation(
        self, q: Sequence[int], scale: Fraction | Literal[1] = 1
    ) -> list[float]:
        """As the base has it."""
        entries, up, over = self._best_translation(q, scale)
        return [quotient_or_zero(entry * up, over) for entry in entries]

    def translation_energy(
        self, q: Sequence[int], translation: Sequence[Fraction], scale: Fraction | Literal[1] = 1
    ) -> Fraction:
        """M |t - best t|^2, at a scale: what a translation adds to sum w |y - s R x - t|^2."""
        best, up, down = self._best_translation(q, scale)
        over = math.lcm(down, *[entry.denominator for entry in translation])
        worth, weight = up * (over // down), self.moments.total_weight
        offset = [
            entry.numerator * (over // entry.denominator) - own * worth
            for entry, own in zip(translation, best, strict=True)
        ]
        return Fraction(squared_norm(offset) * weight.numerator, over**2 * weight.denominator)

    def _best_translation(
        self, q: Sequence[int], scale: Fraction | Literal[1]
    ) -> tuple[list[int], int, int]:
        """The best one in integers; what one of them is worth is the quotient of the last two."""
        moments, norm = self.moments, squared_norm(q)
        stretch, over = scale.numerator, scale.denominator
        rotated = [dot(row, moments.source_sum) for row in rotation_matrix(q)]
        a, b = moments.source_exponent, moments.target_exponent
        common = min(a, b)
        entries = [
            (end * norm * over << (b - common)) - (moved * stretch << (a - common))
            for end, moved in zip(moments.target_sum, rotated, strict=True)
        ]
        return entries, 1 << max(common, 0), moments.mass * norm * over << max(-common, 0)

    # --- energies of single poses, exactly

    def alignment(self, q: Sequence[int]) -> Fraction:
        """q^T K q / |q|^2 = tr(R(q)^T C), for an integer quaternion q other than zero."""
        known = self._alignments.get(tuple(q))
        if known is not None:
            return known
        unit = self.moments.cross_unit
        alignment = Fraction(
            quadratic_form(self.davenport, q) * unit.numerator, squared_norm(q) * unit.denominator
        )
        if len(self._alignments) == KEPT:
            self._alignments.clear()
        self._alignments[tuple(q)] = alignment
        return alignment

    @cached_property
    def _alignments(self) -> dict[tuple[int, ...], Fraction]:
        """Of the last quaternions: every method, proof and page asks for the same."""
        return {}

    def energy(self, q: Sequence[int]) -> Fraction:
        """V at R(q) and the best translation: the least sum of w |y - R x - t|^2 over t.

        Where the scale is free, with the best scale, too: see `Scaling.energy`.
        """
        if self.scaling is not None:
            return self.scaling.energy(self.alignment(q))
        spread, alignment = self.moments.spread, self.alignment(q)
        a, b = spread.denominator, alignment.denominator
        return Fraction(spread.numerator * b - 2 * alignment.numerator * a, a * b)

    def energy_at(self, q: Sequence[int], shifted: Fraction, scale: Fraction) -> Fraction:
        """V at any pose: sum w |y - s R x - t|^2, over s for the symmetric scale, s > 0 there.

        shifted: the `translation_energy` of the pose.
        """
        if self.scaling is None:
            return self.energy(q) + shifted
        return self.scaling.energy_at(self.alignment(q), scale, shifted)

    def squares(self, energy: Real, scale: Real) -> Real:
        """The sum w |y - s R x - t|^2 of a pose of that energy: the symmetric one is over s."""
        return energy if self.scaling is None else energy * self.scaling.divisor(scale)

    def squared_residual(self, q: Sequence[int]) -> Fraction:
        """|K q - v q|^2 / |q|^2, v = q^T K q / |q|^2, in units of tr(R^T C) squared."""
        norm, image = squared_norm(q), [dot(row, q) for row in self.davenport]
        form = dot(image, q)
        rest = [norm * a - form * b for a, b in zip(image, q, strict=True)]
        unit = self.moments.cross_unit
        return Fraction(squared_norm(rest) * unit.numerator**2, norm**3 * unit.denominator**2)

    # --- eigenspaces, refined in integer arithmetic; a proposal, but for what the pattern says

    @cached_property
    def eigenspaces(self) -> Resolution:
        """The eigenspaces of K, largest eigenvalue first; values over 2^shift of K."""
        return resolved(self._spaces_at)

    def _spaces_at(self, bits: int) -> tuple[Space, ...]:
        values, vectors = self._eigenbasis(bits)
        shape = self.classification
        if shape.finite:
            alone = zip(values, vectors, strict=True)
            return tuple([Space(values=(value,), vectors=(v,)) for value, v in alone])
        groups = [slice(s, s + m) for s, m in zip(shape.indices, shape.pattern, strict=True)]
        return tuple([Space(values=values[g], vectors=vectors[g]) for g in groups])

    def _eigenbasis(self, bits: int) -> tuple[tuple[int, ...], tuple[tuple[int, ...], ...]]:
        """Values over 2^shift and unit vectors, with so many fractional bits: by C where it can."""
        if bits == FIXED_BITS:
            found = fixed_eigenbasis(self.davenport, self.shift)
            if found is not None:
                return found
        basis = integer_eigenbasis(self.davenport, bits)
        return basis.values, basis.vectors

    @property
    def quaternions(self) -> tuple[IntegerQuaternion, ...]:
        """The member of each eigenspace nearest to the identity, in integers; the optimum first."""
        return self.eigenspaces.quaternions

    @property
    def optimum(self) -> IntegerQuaternion:
        """The first of these: the optimum, or of several the nearest to the identity."""
        return self.eigenspaces.first

    @cached_property
    def eigenvectors(self) -> tuple[tuple[int, ...], ...]:
        """Four orthogonal vectors of one length, largest eigenvalue first."""
        return tuple([v for space in self.eigenspaces.spaces for v in space.vectors])

    @cached_property
    def eigenvalues(self) -> tuple[Fraction, ...]:
        """Of each eigenvector, in units of tr(R^T C)."""
        unit = self.eigenvalue_unit
        return tuple(v * unit for space in self.eigenspaces.spaces for v in space.values)

    @cached_property
    def eigenvalue_drops(self) -> tuple[int, ...]:
        """The largest eigenvalue minus that of each eigenvector, over `eigenvalue_unit`."""
        values = [v for space in self.eigenspaces.spaces for v in space.values]
        return tuple([values[0] - value for value in values])

    @cached_property
    def eigenvalue_unit(self) -> Fraction:
        """What one unit of the eigenspaces' values is worth, in units of tr(R^T C)."""
        return self._eigenvalue_unit(self.eigenspaces.bits)

    def eigenvalue_difference(self, upper: int, lower: int) -> Fraction:
        """The eigenvalue of one space minus that of another: half the difference in energy."""
        spaces = self.eigenspaces.spaces
        return (spaces[upper].value - spaces[lower].value) * self.eigenvalue_unit

    def energy_of_eigenvalue(self, value: int, bits: int) -> Fraction:
        """V where q^T K q / |q|^2 is value / 2^bits, in units of 2^shift of K."""
        alignment = value * self._eigenvalue_unit(bits)
        if self.scaling is not None:
            return self.scaling.energy(alignment)
        return self.moments.spread - 2 * alignment

    def _eigenvalue_unit(self, bits: int) -> Fraction:
        return power_of_two(self.shift - bits) * self.moments.cross_unit

    def angle_to(self, component: int, q: Sequence[int]) -> float:
        """The angle in radians from R(q) to the nearest rotation of an eigenspace.

        Twice the angle of q to it, from the projections in integers.
        """
        first = sum(self.classification.pattern[:component])
        group = range(first, first + self.classification.pattern[component])
        inside = self._projections(q)
        along = math.isqrt(sum(inside[k] ** 2 for k in group))
        across = math.isqrt(sum(p**2 for k, p in enumerate(inside) if k not in group))
        return 2.0 * math.atan2(across / (along + across), along / (along + across))

    def _projections(self, q: Sequence[int]) -> list[int]:
        """Of q on the eigenvectors; the last is kept: its loss and its angle are asked for both."""
        kept, key = self._projected, tuple(q)
        if key not in kept:
            kept.clear()
            kept[key] = [dot(v, q) for v in self.eigenvectors]
        return kept[key]

    @cached_property
    def _projected(self) -> dict[tuple[int, ...], list[int]]:
        """Of one quaternion at most."""
        return {}

    def angle_to_optimum(self, q: Sequence[int]) -> float:
        """The angle in radians from R(q) to the nearest optimum."""
        return self.angle_to(0, q)

    def relative_loss(self, q: Sequence[int]) -> float:
        """How far R(q) is from the best alignment, 0, to the worst, 1; 0 if all are as good.

        The mean of what eigenvalues are below the first, with the squares of the projections of q
        as weights.
        """
        weights, drops = [p * p for p in self._projections(q)], self.eigenvalue_drops
        return max(0, sum(map(mul, weights, drops))) / (sum(weights) * drops[-1] or 1)
