"""The objective of springs that are matrices: a quartic in the quaternion.

f(R, t) = sum (y - R x - t)^T W (y - R x - t) is a `Form`, and its least value over t is quadratic
in r = (1, vec R).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from certreg._loading import cached_property
from certreg.exact.dyadic import power_of_two, rational_root_above
from certreg.exact.elimination import nullspace
from certreg.geometry.so3 import Vector3, dot, rotation_matrix, squared_norm
from certreg.objective import quartics
from certreg.objective.form import FULL, Form, Reduced, bordered
from certreg.objective.objective import Objective
from certreg.objective.structure import Structure
from certreg.problem.exact_sums import UPPER
from certreg.problem.stiffness import SpringMoments, spring_moments
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.geometry.constraints import SquareMatrix
    from certreg.problem.motion import Motion
    from certreg.problem.problem import RegistrationProblem


DIAGONAL = (0, 3, 5)  # among the six entries of a symmetric matrix
FARTHEST = 8  # the largest |R - R'|^2 of two rotations, in the Frobenius norm
FARTHEST_OF_FIVE = Fraction(25, 2)  # the same of their actions on symmetric traceless matrices


@dataclass(frozen=True, slots=True, kw_only=True)
class MassMoments(Brief):
    """M = sum m, the mean of the source, and sum m (x - mean)(x - mean)^T, 3x3."""

    mass: Fraction
    centre: Vector3[Fraction]
    scatter: tuple[tuple[Fraction, ...], ...]


@dataclass(frozen=True)
class Springs(Objective):
    """The objective of the exact moments of springs that are matrices; see `Objective`.

    motion: without a translation the moments are those about the origin. For searches in doubles
    take `floating_quartic`: the integers here may be beyond the doubles.
    """

    moments: SpringMoments
    motion: Motion
    structure: ClassVar[Structure] = Structure.QUARTIC
    scaling: ClassVar[None] = None  # no scale is free

    @classmethod
    def of(cls, problem: RegistrationProblem) -> Springs:
        """The objective of a problem with general springs."""
        return cls(spring_moments(problem), problem.motion)

    @cached_property
    def joint_form(self) -> Form:
        """The energy before a translation is chosen."""
        m = self.moments
        sums = zip(m.scatter, m.source, m.stiffness, strict=True)
        return Form.of(
            [bordered(_square(six), first, mass) for six, first, mass in sums],
            [(*row, pull) for row, pull in zip(m.cross, m.target, strict=True)],
            m.spread,
            (m.source_exponent, m.target_exponent, m.weight_exponent),
        )

    @cached_property
    def reduced(self) -> Reduced:
        """The energy with the best translation, if the motion has any."""
        return self.joint_form.restricted(self.motion)

    @property
    def unit(self) -> Fraction:
        """What 1 is worth, in units of the energy."""
        return self.reduced.unit

    @cached_property
    def free_translations(self) -> tuple[Vector3[Fraction], ...]:
        """A basis of the shifts of the motion that no spring resists, at any rotation."""
        free = self.joint_form.free_translations(self.motion)
        return tuple((Fraction(a), Fraction(b), Fraction(c)) for a, b, c in free)

    # --- the objective

    def form(self) -> SquareMatrix[int]:
        """Q, 10x10, with V(R) = unit * r^T Q r for r = (1, vec R), R by columns."""
        return self.reduced.rows

    def energy(self, q: Sequence[int]) -> Fraction:
        """V at R(q): the least sum of (y - R x - t)^T W (y - R x - t) over t."""
        unit, norm = self.unit, squared_norm(q)
        return Fraction(self.value(q) * unit.numerator, norm**2 * unit.denominator)

    def best_translation(
        self, q: Sequence[int], scale: Fraction | Literal[1] | None = None
    ) -> Vector3[Fraction]:
        """The translation of least energy at the rotation R(q), exactly.

        Where `free_translations` are left, the one that does not move the source's centre of mass
        along them, the mass of a point being the trace of its W.
        """
        best, free = super().best_translation(q, scale), self.free_translations
        if not free:
            return best
        centre, norm = self.centre, squared_norm(q)
        moved: list[Any] = [
            dot(row, centre) / norm + t - c
            for row, t, c in zip(rotation_matrix(q), best, centre, strict=True)
        ]
        along = _projected(free, moved)
        x, y, z = (t - a for t, a in zip(best, along, strict=True))
        return (x, y, z)

    def image_slopes(self, point: Sequence[Fraction]) -> tuple[tuple[Fraction, ...], ...]:
        """M, 3x9, with R point + (best translation at R) = M vec R + const, R by columns.

        Where `free_translations` are left there is none: asked for nevertheless, what it is along
        them means nothing.
        """
        unit = power_of_two(self.reduced.length_exponent) / self.reduced.determinant
        slopes = [[entry * unit for entry in row[1:]] for row in self.reduced.response]
        for j, a in product(range(3), repeat=2):
            slopes[a][3 * j + a] += point[j]
        return tuple(map(tuple, slopes))

    @cached_property
    def mass_scatter(self) -> tuple[tuple[int, ...], ...]:
        """A positive multiple of the sum of m (x - mean)(x - mean)^T, m = tr W: 3x3 integers.

        Of rank below 2 where the source is collinear, and then the body has no inertia about the
        line.
        """
        mass, first, second = self.moments.traces
        return tuple(
            tuple(mass * second[FULL[3 * i + j]] - first[i] * first[j] for j in range(3))
            for i in range(3)
        )

    @cached_property
    def mass_moments(self) -> MassMoments:
        """Mass, centre and scatter of the source, with masses m = tr W / 3, in the user's unit."""
        m, total = self.moments, self.moments.traces[0]
        weight, length = power_of_two(m.weight_exponent), power_of_two(m.source_exponent)
        unit = weight * length**2 / (3 * total)
        return MassMoments(
            mass=total * weight / 3,
            centre=self.centre,
            scatter=tuple(tuple(entry * unit for entry in row) for row in self.mass_scatter),
        )

    @cached_property
    def centre(self) -> Vector3[Fraction]:
        """The mean of the source, with the traces of W as masses."""
        mass, (x, y, z), _ = self.moments.traces
        unit = power_of_two(self.moments.source_exponent) / mass
        return (x * unit, y * unit, z * unit)

    # --- what is known of it exactly

    @cached_property
    def symmetry(self) -> tuple[tuple[int, ...], ...]:
        """A basis, in integers, of the turns (a, b) with F(q + e (a q + q b)) = F(q) + O(e^2).

        Each is six numbers: a turn a of the world, a turn b of the body. Their number is the
        dimension of the group of the continuous symmetries of f: with one-parameter groups in both
        directions, the derivative vanishes everywhere iff F is constant along the group.
        """
        return nullspace(quartics.derivatives_along_turns(self.quartic), 6)

    @cached_property
    def part_sizes(self) -> tuple[Fraction, Fraction]:
        """The squared norms of C and B in f = c + <C, R> + <B, D(R)>; see `oscillation`.

        In the unit of the energy, squared. Over all rotations f has the variance of one over 3 and
        the other over 5. With E the table Q_aj,bk made symmetric in (a, b), that of B is

            sum E_ab,jk^2 - sum (E_aa,jk)^2 / 3 - sum (E_ab,jj)^2 / 3 + (E_aa,jj)^2 / 9

        where repeated indices within a bracket are summed: traces are orthogonal to the rest.
        """
        Q = self.form()
        linear, even = list[int](), list[list[int]]()
        for a, j in product(range(3), repeat=2):
            (b, c), (k, m) = _others(a), _others(j)
            skew = _entry(Q, b, c, k, m) + _entry(Q, c, b, m, k)
            skew -= _entry(Q, b, c, m, k) + _entry(Q, c, b, k, m)
            linear.append(4 * Q[0][1 + 3 * j + a] + skew)
        for a, b in UPPER:
            even.append([2 * _entry(Q, a, b, j, k) + 2 * _entry(Q, a, b, k, j) for j, k in UPPER])
        rows = [sum([row[s] for s in DIAGONAL]) for row in even]
        columns = [sum([even[p][s] for p in DIAGONAL]) for s in range(6)]
        trace = sum([rows[p] for p in DIAGONAL])
        total = 9 * _weighed([_weighed([e * e for e in row]) for row in even]) + trace**2
        total -= 3 * _weighed([e * e for e in rows]) + 3 * _weighed([e * e for e in columns])
        unit = self.unit**2
        return Fraction(sum([e * e for e in linear]), 2**2) * unit, Fraction(total, 12**2) * unit

    @property
    def isotropic_like(self) -> bool:
        """Whether f = const - 2 tr(R^T C) for some C: exactly where B = 0."""
        return self.part_sizes[1] == 0

    @cached_property
    def oscillation(self) -> Fraction:
        """An upper bound of max f - min f over all rotations, in the unit of the energy.

        Of the products R_aj R_bk, the part skew in (a, b) is skew in (j, k), too, and a cofactor
        of R, which is an entry of R; the part that is symmetric in both is a trace, delta_jk or
        delta_ab, and the rest: what R does to symmetric traceless matrices, D(R): S -> R S R^T,
        orthogonal in five dimensions. So f = c + <C, R> + <B, D(R)>, B symmetric and traceless in
        both pairs, and

            f(R) - f(R') <= norm(C) norm(R - R') + norm(B) norm(D(R) - D(R'))

        in Frobenius norms. With theta the angle of R^T R' and u = cos(theta), the traces of R^T R'
        and of D(R^T R') are 1 + 2 u and 1 + 2 cos(theta) + 2 cos(2 theta) = 4 u^2 + 2 u - 1. So
        norm(R - R')^2 = 6 - 2 (1 + 2 u) <= 8, norm(D - D')^2 = 10 - 2 (4 u^2 + 2 u - 1) <= 25/2,
        the largest at u = -1/4.
        """
        linear, even = self.part_sizes
        return rational_root_above(FARTHEST * linear) + rational_root_above(FARTHEST_OF_FIVE * even)

    # --- doubles

    def floating_quartic(self) -> tuple[NDArray[np.float64], Fraction]:
        """The 35 coefficients in doubles of at most 1, each rounded once, and what 1 is worth."""
        return self._rounded(self.quartic)

    def _rounded(self, entries: Sequence[int]) -> tuple[NDArray[np.float64], Fraction]:
        places = max(abs(entry) for entry in entries).bit_length()
        one = 1 << places
        return np.array([entry / one for entry in entries]), self.unit * one


def _square(six: Sequence[int]) -> list[list[int]]:
    """A symmetric 3x3 matrix, of which six entries are given."""
    return [[six[FULL[3 * j + k]] for k in range(3)] for j in range(3)]


def _entry(form: SquareMatrix[int], a: int, b: int, j: int, k: int) -> int:
    """The coefficient of R_aj R_bk in a form."""
    return form[1 + 3 * j + a][1 + 3 * k + b]


def _weighed(entries: Sequence[int]) -> int:
    """The sum of nine entries of a symmetric matrix, of which six are given."""
    a, b, c, d, e, f = entries
    return a + d + f + 2 * (b + c + e)


def _others(k: int) -> tuple[int, int]:
    """The two that follow cyclically."""
    return (k + 1) % 3, (k + 2) % 3


def _projected(basis: Sequence[Sequence[Fraction]], vector: Sequence[Fraction]) -> list[Fraction]:
    """The orthogonal projection of a vector onto the span of at most two vectors."""
    orthogonal: list[list[Fraction]] = []
    for one in basis:
        rest = list(one)
        for other in orthogonal:
            part = dot(rest, other) / squared_norm(other)
            rest = [a - part * b for a, b in zip(rest, other, strict=True)]
        orthogonal.append(rest)
    total = [Fraction(0)] * 3
    for one in orthogonal:
        part = dot(vector, one) / squared_norm(one)
        total = [a + part * b for a, b in zip(total, one, strict=True)]
    return total
