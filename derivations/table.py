"""The table of the eight kinds of equilibrium set: its rows, in coordinates that make it plain.

The coordinates are the gaps between neighbouring eigenvalues l1 >= l2 >= l3 >= l4 of Davenport's
matrix, g1 = 2 (d2 + d3), g2 = 2 (d1 - d2), g3 = 2 (d2 - d3), with d1 >= d2 >= |d3| the special
singular values of C. Which of the gaps vanish is the row.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import sympy

from certreg.geometry.so3 import rotation_matrix
from certreg.objective.classification import Pattern

from .notation import Array, Matrix, entry
from .rings import ring_of

GAPS = tuple(entry("g", k) for k in (1, 2, 3))  # l1 - l2, l2 - l3, l3 - l4
Signs = tuple[int | None, ...]  # of disc, e1, e2, s, D; None: not determined by the row


@dataclass(frozen=True, slots=True)
class Row:
    """A row of the table: which of the three gaps vanish, and what follows.

    condition: on the special singular values d1 >= d2 >= |d3|. signs: of the discriminant,
    e1, e2, s and D; None where the row leaves it open. spurious: their number, None for infinity.
    """

    vanish: tuple[bool, bool, bool]
    pattern: Pattern
    condition: str
    signs: Signs
    spurious: int | None

    @property
    def gaps(self) -> tuple[Any, ...]:
        """The gaps, zero or a symbol that stands for a positive number."""
        return tuple(0 if gone else gap for gap, gone in zip(GAPS, self.vanish, strict=True))


NO, YES, ANY = False, True, None
ROWS = (
    Row((NO, NO, NO), (1, 1, 1, 1), r"$d_1 > d_2 > |d_3|$", (1, 1, 1, ANY, ANY), 3),
    Row((NO, YES, NO), (1, 2, 1), r"$d_1 = d_2 > |d_3|$", (0, 1, 1, -1, ANY), None),
    Row((NO, NO, YES), (1, 1, 2), r"$d_1 > d_2 = d_3 > 0$", (0, 1, 1, 1, 1), None),
    Row((NO, YES, YES), (1, 3), r"$d_1 = d_2 = d_3 > 0$", (0, 1, 1, 0, 1), None),
    Row((YES, NO, NO), (2, 1, 1), r"$d_1 > d_2 = -d_3 > 0$", (0, 1, 1, 1, -1), 2),
    Row((YES, YES, NO), (3, 1), r"$d_1 = d_2 = -d_3 > 0$", (0, 1, 1, 0, -1), 1),
    Row((YES, NO, YES), (2, 2), r"$d_1 > d_2 = d_3 = 0$", (0, 1, 0, ANY, 0), None),
    Row((YES, YES, YES), (4,), r"$C = 0$", (0, 0, 0, 0, 0), 0),
)


def singular_values(gaps: Sequence[Any]) -> Array:
    """d1, d2, d3 from the gaps 2 (d2 + d3), 2 (d1 - d2), 2 (d2 - d3)."""
    a, b, c = gaps
    quarter = sympy.Rational(1, 4)
    return quarter * Matrix([a + 2 * b + c, a + c, a - c])


def sign(polynomial: Any) -> int | None:
    """The sign at positive arguments that the coefficients show: all of one sign, or none at all.

    None where coefficients of both signs occur: then this test does not tell.
    """
    polynomial = sympy.sympify(polynomial)
    coefficients = ring_of([polynomial]).from_expr(polynomial).coeffs()
    if not coefficients:
        return 0
    signs = {1 if c > 0 else -1 for c in coefficients}
    return signs.pop() if len(signs) == 1 else None


def eigenvalues(d: Any) -> tuple[Any, Any, Any, Any]:
    """l1 ... l4 of the special singular values d1 >= d2 >= |d3|, in descending order."""
    a, b, c = d
    return a + b + c, a - b - c, -a + b - c, -a - b + c


def multiplicities_of(vanish: Sequence[bool]) -> Pattern:
    """The lengths of the runs of equal eigenvalues."""
    runs = [1]
    for gone in vanish:
        if gone:
            runs[-1] += 1
        else:
            runs.append(1)
    return tuple(runs)


def representatives(row: Row) -> list[list[list[int]]]:
    """Integer matrices of a row: diagonal ones of every sign of D, and turned on both sides."""
    choices = [(0,) if gone else (4, 8) for gone in row.vanish]
    found = []
    for gaps in product(*choices):
        D = sympy.diag(*singular_values(gaps))
        U, V = Matrix(rotation_matrix((1, 2, 3, 4))), Matrix(rotation_matrix((2, -1, 0, 1)))
        found += [A.tolist() for A in (D, U * D * V.T)]
    return [[[int(entry) for entry in line] for line in A] for A in found]
