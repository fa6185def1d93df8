"""The energy of a motion as one exact form, and what is left of it without the translation.

Every residual is linear in z = (1, vec M, t), where M = s R moves the source and vec M stands by
columns. So the energy is z^T H z whatever the data are, and the forms of several data add up. It is
semidefinite in t: its least value over t is quadratic in r = (1, vec M).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, product
from math import gcd
from typing import TYPE_CHECKING

from certreg._loading import cached_property
from certreg.exact import definite_inverse, nullspace, power_of_two
from certreg.geometry import dot, quadratic_form
from certreg.problem import UPPER
from certreg.results import Brief

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.geometry import SquareMatrix, Vector3

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
        sources: Sequence[Sequence[Sequence[int]]],
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
        places = (here, here, here, 0)
        rows = [[0] * SIZE for _ in range(SIZE)]
        rows[0][0] = spread << 2 * there
        for j, a in product(range(4), range(3)):
            row, parts = rows[1 + 3 * j + a], [sources[FULL[3 * a + b]][j] for b in range(3)]
            row[0] = rows[0][1 + 3 * j + a] = -pulls[a][j] << places[j] + there
            row[1:] = [part[k] << places[j] + places[k] for k in range(4) for part in parts]
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
        rows = tuple(
            tuple(entry << p + q for entry, q in zip(row, places, strict=True))
            for row, p in zip(self.rows, places, strict=True)
        )
        return Form(rows, self.unit, exponent)

    def energy(self, z: Sequence[Fraction | int]) -> Fraction:
        """The energy at z = (1, vec M, t)."""
        shift = [entry / power_of_two(self.length_exponent) for entry in z[10:]]
        return quadratic_form(self.rows, [*z[:10], *shift]) * self.unit

    # --- the translation

    @cached_property
    def stiffness(self) -> tuple[tuple[int, ...], ...]:
        """S, 3x3, what resists a shift: semidefinite."""
        return tuple(row[10:] for row in self.rows[10:])

    @cached_property
    def free_translations(self) -> tuple[tuple[int, ...], ...]:
        """A basis of the kernel of S: shifts that cost nothing, whatever M is."""
        return nullspace(self.stiffness, 3)

    @cached_property
    def _pivots(self) -> tuple[tuple[int, ...], int, list[list[int]]]:
        """Rows of S, as many as its rank, with their determinant, positive, and adjugate."""
        choices = [c for size in (3, 2, 1, 0) for c in combinations(range(3), size)]
        parts = ([[self.stiffness[i][j] for j in chosen] for i in chosen] for chosen in choices)
        inverses = zip(choices, map(definite_inverse, parts), strict=False)
        return next((chosen, *inverse) for chosen, inverse in inverses if inverse is not None)

    @property
    def determinant(self) -> int:
        """Of as many rows of S as its rank: what `response` and `compliance` are over."""
        return self._pivots[1]

    @cached_property
    def compliance(self) -> tuple[tuple[int, ...], ...]:
        """3x3, over `determinant`: S^-1, or one with zero in the rows that are no pivots."""
        chosen, _, adjugate = self._pivots
        rows = [[0] * 3 for _ in range(3)]
        for (i, a), (j, b) in product(enumerate(chosen), repeat=2):
            rows[a][b] = adjugate[i][j]
        return tuple(map(tuple, rows))

    @cached_property
    def response(self) -> tuple[tuple[int, ...], ...]:
        """-S^-1 H_tr, 3x10, over `determinant`: the best translation by r.

        H is semidefinite in t, so the columns of H_tr are in the span of those of S: the energy
        does not depend on what t is along the kernel of S.
        """
        columns = list(zip(*(row[:10] for row in self.rows[10:]), strict=True))
        return tuple(tuple(-dot(row, column) for column in columns) for row in self.compliance)

    def best_translation(self, r: Sequence[int], over: int) -> Vector3[Fraction]:
        """The translation of least energy at r / over; 0 in the rows that are no pivots."""
        unit = power_of_two(self.length_exponent) / (self.determinant * over)
        x, y, z = (dot(row, r) * unit for row in self.response)
        return (x, y, z)

    # --- what is left without it

    @property
    def unit_without_translation(self) -> Fraction:
        """What 1 is worth in `without_translation`."""
        return self.unit / self.determinant

    @cached_property
    def without_translation(self) -> SquareMatrix[int]:
        """Q = d (H_rr - H_rt S^-1 H_tr), 10x10, d the determinant: least energy = r^T Q r."""
        H, determinant = self.rows, self.determinant
        responses = list(zip(*self.response, strict=True))
        rows = [[0] * 10 for _ in range(10)]
        for r in range(10):
            row, coupled = H[r], H[r][10:]
            for s in range(r + 1):
                rows[r][s] = rows[s][r] = determinant * row[s] + dot(coupled, responses[s])
        return tuple(map(tuple, rows))


def bordered(
    second: Sequence[Sequence[int]], first: Sequence[int], mass: int
) -> list[tuple[int, ...]]:
    """The sum of m u u^T, u = (x, 1), 4x4, from those of m x x^T, of m x and of m."""
    return [*((*row, end) for row, end in zip(second, first, strict=True)), (*first, mass)]
