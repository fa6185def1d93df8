"""The energy of a motion as one exact form, and what is left of it without the translation.

Every residual is linear in z = (1, vec M, t), where M = s R moves the source and vec M stands by
columns. So the energy is z^T H z whatever the data are, and the forms of several data add up. It is
semidefinite in t: its least value over t is quadratic in r = (1, vec M).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain, combinations, combinations_with_replacement, product
from math import gcd, lcm
from typing import TYPE_CHECKING

from certreg._loading import cached_property
from certreg.exact.dyadic import power_of_two
from certreg.exact.elimination import definite_inverse, nullspace
from certreg.geometry.so3 import Vector3, dot, quadratic_form
from certreg.problem.exact_sums import UPPER
from certreg.results import Brief

if TYPE_CHECKING:
    from certreg.geometry.constraints import SquareMatrix
    from certreg.problem.motion import Motion


SIZE = 13
TRANSLATION = range(10, 13)  # where t stands in z: as a fourth column of M
FULL = tuple(UPPER.index((min(a, b), max(a, b))) for a, b in product(range(3), repeat=2))


@dataclass(frozen=True)
class Form(Brief):
    """The energy unit * z^T rows z, for t in units of 2^length_exponent: symmetric, 13x13 integers.

    The data have no other unit: energies and lengths are in the user's.
    """

    rows: SquareMatrix[int]
    unit: Fraction
    length_exponent: int

    @classmethod
    def of(
        cls,
        sources: Sequence[SquareMatrix[int]],
        pulls: Sequence[Sequence[int]],
        spread: int,
        exponents: tuple[int, int, int],
    ) -> Form:
        """The sum of (y - M x - t)^T W (y - M x - t), from sums over the points with u = (x, 1).

        sources: W_ab u u^T, six of 4x4, as `UPPER` has a, b. pulls: W y u^T, 3x4. spread: y^T W y.
        exponents: of two, what 1 is worth in x, y and W.
        """
        length = min(exponents[:2])
        here, there = exponents[0] - length, exponents[1] - length
        blocks = [_in_units(block, (here, here, here, 0)) for block in sources]
        rows = [[0] * SIZE for _ in range(SIZE)]
        rows[0][0] = spread << 2 * there
        for j, a in product(range(4), range(3)):
            x, y, z = (blocks[FULL[3 * a + b]][j] for b in range(3))
            pull = -pulls[a][j] << (here if j < 3 else 0) + there
            rows[0][1 + 3 * j + a] = pull
            rows[1 + 3 * j + a] = [pull, *chain(*zip(x, y, z, strict=True))]
        return cls(tuple(map(tuple, rows)), power_of_two(exponents[2] + 2 * length), length)

    def __add__(self, other: Form) -> Form:
        """The sum of two energies, exactly."""
        length = max(self.length_exponent, other.length_exponent)
        one, two = self._in_lengths(length), other._in_lengths(length)
        (m, n), (p, q) = one.unit.as_integer_ratio(), two.unit.as_integer_ratio()
        unit = Fraction(gcd(m * q, p * n), n * q)
        a, b = int(one.unit / unit), int(two.unit / unit)
        pairs = zip(one.rows, two.rows, strict=True)
        rows = tuple(tuple(a * e + b * f for e, f in zip(*pair, strict=True)) for pair in pairs)
        return Form(rows, unit, length)

    def _in_lengths(self, exponent: int) -> Form:
        """The same energy with t in units of a power of two that is no smaller."""
        places = [exponent - self.length_exponent if k in TRANSLATION else 0 for k in range(SIZE)]
        return Form(_in_units(self.rows, places), self.unit, exponent)

    def energy(self, z: Sequence[Fraction | int]) -> Fraction:
        """The energy at z = (1, vec M, t)."""
        shift = [entry / power_of_two(self.length_exponent) for entry in z[10:]]
        return quadratic_form(self.rows, [*z[:10], *shift]) * self.unit

    # --- the translation

    @cached_property
    def stiffness(self) -> tuple[tuple[int, ...], ...]:
        """S, 3x3, what resists a shift: semidefinite."""
        return tuple(row[10:] for row in self.rows[10:])

    def free_translations(self, motion: Motion) -> tuple[tuple[int, ...], ...]:
        """A basis of the kernel of S: shifts of a motion that cost nothing, whatever M is."""
        axes = motion.axes
        return nullspace([[row[k] for k in axes] for row in self.stiffness], len(axes))

    def restricted(self, motion: Motion) -> Reduced:
        """The least energy over t, d (H_rr - H_rt C H_tr); without a translation H_rr.

        C = S_pp^-1, with 0 in the other rows, of as many rows p of S as its rank; d = det S_pp. H
        is semidefinite in t, so the columns of H_tr are in the span of those of S: the energy does
        not depend on what t is along the kernel of S. Without a translation there are no rows p.
        """
        choices = [c for size in range(3, -1, -1) for c in combinations(motion.axes, size)]
        parts = ([[self.stiffness[i][j] for j in chosen] for i in chosen] for chosen in choices)
        inverses = zip(choices, map(definite_inverse, parts), strict=False)
        chosen, (determinant, adjugate) = next((c, found) for c, found in inverses if found)
        compliance = [[0] * 3 for _ in range(3)]
        for (i, a), (j, b) in product(enumerate(chosen), repeat=2):
            compliance[a][b] = adjugate[i][j]
        H, columns = self.rows, list(zip(*(row[:10] for row in self.rows[10:]), strict=True))
        moves = [[-dot(row, column) for row in compliance] for column in columns]
        rows = [[0] * 10 for _ in range(10)]
        for r, s in combinations_with_replacement(range(10), 2):
            rows[r][s] = rows[s][r] = determinant * H[r][s] + dot(H[r][10:], moves[s])
        return Reduced(
            rows=tuple(map(tuple, rows)),
            unit=self.unit / determinant,
            response=tuple(zip(*moves, strict=True)),
            stiffness=self.stiffness,
            compliance=tuple(map(tuple, compliance)),
            determinant=determinant,
            length_exponent=self.length_exponent,
        )


@dataclass(frozen=True, kw_only=True)
class Reduced(Brief):
    """The energy unit * r^T rows r of r = (1, vec M) with the best translation, 10x10 integers.

    response: 3x10, the translation by r, in units of 2^length_exponent over the determinant.
    stiffness, compliance: 3x3, S in the unit of a form, and S^-1 over the determinant; like the
    response with 0 in rows that are no pivots, for which any translation is as good.
    """

    rows: SquareMatrix[int]
    unit: Fraction
    response: tuple[tuple[int, ...], ...]
    stiffness: SquareMatrix[int]
    compliance: SquareMatrix[int]
    determinant: int
    length_exponent: int

    @property
    def stiffness_unit(self) -> Fraction:
        """What 1 is worth in S, in units of the energy over those of length, squared."""
        return self.unit * self.determinant / power_of_two(2 * self.length_exponent)

    def best_translation(self, r: Sequence[int], over: int) -> Vector3[Fraction]:
        """The translation of least energy at r / over; 0 in the rows that are no pivots."""
        (x, y, z), below = self._best(r, over)
        return (Fraction(x, below), Fraction(y, below), Fraction(z, below))

    def _best(self, r: Sequence[int], over: int) -> tuple[list[int], int]:
        """The same in integers, and what they are over."""
        up, down = power_of_two(self.length_exponent).as_integer_ratio()
        return [up * dot(row, r) for row in self.response], down * self.determinant * over

    def translation_energy(
        self, translation: Sequence[Fraction], r: Sequence[int], over: int
    ) -> Fraction:
        """What a translation adds to the least energy at r / over: d^T S d, d from the best one."""
        best, under = self._best(r, over)
        whole = lcm(under, *[entry.denominator for entry in translation])
        off = [
            entry.numerator * (whole // entry.denominator) - own * (whole // under)
            for entry, own in zip(translation, best, strict=True)
        ]
        above, below = self.stiffness_unit.as_integer_ratio()
        return Fraction(quadratic_form(self.stiffness, off) * above, whole**2 * below)


def _in_units(rows: SquareMatrix[int], places: Sequence[int]) -> SquareMatrix[int]:
    """A form of variables that are so many powers of two times others, by these."""
    if not any(places):
        return rows
    return tuple(
        tuple(entry << p + q for entry, q in zip(row, places, strict=True))
        for row, p in zip(rows, places, strict=True)
    )


def bordered(second: Sequence[Sequence[int]], first: Sequence[int], mass: int) -> SquareMatrix[int]:
    """The sum of m u u^T, u = (x, 1), 4x4, from those of m x x^T, of m x and of m."""
    above = ((*row, end) for row, end in zip(second, first, strict=True))
    return (*above, (*first, mass))
