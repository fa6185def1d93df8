"""All equilibria of general springs by elimination: eigenvalues of one 40x40 matrix, in balls.

Let I be the ideal of the 2x2 minors of [q, grad F], of which two ranks prove that there are at most
40 critical lines and none on a plane l = 0 (see `line_set`). The linear functionals on the forms
of degree 8 that vanish on I_8 are spanned by the columns of a matrix N, 165 x 40, one row for each
monomial: which rows of the products of the minors determine it is read off modulo a prime, and
what is not singular there is not singular. With k another linear form, and N_l the rows of N for l
times a monomial of degree 7, 120 x 40, the values at a critical line q make a vector v with

    N_k v = (k(q) / l(q)) N_l v,

so that k/l are eigenvalues of M = N_l^-1 N_k, on 40 rows where N_l has an inverse. If the 40
eigenvalues lie in disjoint balls, then each belongs to one line, all are simple, and the real ones
are those whose ball meets no other's conjugate: a conjugate eigenvalue is in one of the balls. The
entries of q are quotients of entries of N v.

Nothing is known here of paths and boxes: of what the homotopy finds this is a proof of its own.
Floats never enter.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from flint import acb_mat, arb, arb_mat, ctx, nmod_mat

from certreg.equilibrium.groebner import GROEBNER
from certreg.equilibrium.line_boxes import BallQuartic, critical_at
from certreg.equilibrium.line_set import (
    LINES,
    Finiteness,
    LineCount,
    LineSet,
    at_most_forty,
    constant_set,
    finiteness_of,
    forms,
    line_set,
    minor_terms,
    minors_modulo,
    product_places,
    products,
)
from certreg.errors import UndecidedError
from certreg.exact.balls import negative_eigenvalues, radius_bits
from certreg.objective.normalisation import LevelledExactly, levelled_exactly

if TYPE_CHECKING:
    from certreg.objective.springs import Springs


START_BITS = 256  # a third of it is lost
MOST_BITS = 512  # where balls still overlap, lines meet or nearly so
BITS = 72  # of a quaternion that is told
SEPARATING = (0, 3, 5, 7)  # coefficients of k; another where it takes one value at two lines
DEGREE = 8
GUARD_BITS = 16  # of a coefficient, beyond those of the arithmetic


def by_quotient_ring(objective: Springs) -> LineSet:
    """The real points of the quotient ring, with their number proved by its eigenvalues.

    Raises UndecidedError where the ring is not known to be of dimension 40, or points meet.
    """
    finiteness = finiteness_of(objective)
    if finiteness is Finiteness.CONSTANT:
        return constant_set(GROEBNER, objective)
    levelled = levelled_exactly(objective.quartic)
    count = at_most_forty(levelled.integers) if finiteness is Finiteness.FORTY else None
    if count is None:
        raise UndecidedError(f"{GROEBNER}: {finiteness.value}", method=GROEBNER)
    shape = Shape.of(levelled, count)
    bits = START_BITS
    while bits <= MOST_BITS:
        with ctx.workprec(bits):
            lines = shape.real_lines(levelled)
        if lines is not None and _are_told(lines):
            return _listed(objective, levelled, lines)
        bits *= 2
    raise UndecidedError(
        f"{GROEBNER}: the quotient ring has the dimension 40, counted with multiplicity, but lines "
        "meet, or so nearly that their eigenvalues could not be told apart.",
        method=GROEBNER,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Shape:
    """Which rows and columns of the matrices are independent: modulo a prime, hence over Q.

    plane: the linear form l. rows, pivots: of the products of degree 8, 125 each. columns: the 40
    monomials that are left. basis: 40 monomials of degree 7 on which N_l has an inverse.
    """

    plane: tuple[int, ...]
    rows: list[int]
    pivots: list[int]
    columns: list[int]
    basis: list[int]

    @classmethod
    def of(cls, levelled: LevelledExactly, count: LineCount) -> Shape:
        """By elimination modulo the prime that proved the ranks."""
        prime = count.prime
        table = products(minors_modulo(levelled.integers, prime), DEGREE)
        matrix = nmod_mat(len(table), table.shape[1], table.ravel().tolist(), prime)
        reduced, _ = matrix.rref()
        entries = [[int(entry) for entry in row] for row in reduced.table()]
        pivots = _pivots(entries)
        free = [k for k in range(table.shape[1]) if k not in set(pivots)]
        null = np.zeros((table.shape[1], len(free)), dtype=object)
        for row, pivot in zip(entries, pivots, strict=False):
            null[pivot] = [-row[k] % prime for k in free]
        for column, k in enumerate(free):
            null[k, column] = 1
        raised = np.zeros((len(forms(4, DEGREE - 1)), len(free)), dtype=object)
        for k, factor in enumerate(count.plane):
            raised += factor * null[_raised(k)]
        raised %= prime
        return cls(
            plane=count.plane,
            rows=_independent(matrix.transpose()),
            pivots=pivots,
            columns=free,
            basis=_independent(nmod_mat(len(free), len(raised), raised.T.ravel().tolist(), prime)),
        )

    def real_lines(self, levelled: LevelledExactly) -> list[tuple[arb, ...]] | None:
        """The real critical lines, in balls; None where these bits do not tell all 40 apart."""
        try:
            null = self._functionals(levelled)
            matrix = self._on_basis(null, self.plane).solve(self._on_basis(null, SEPARATING))
            values, vectors = acb_mat(matrix).eig(right=True)
        except (ValueError, ZeroDivisionError):  # eigenvalues not apart; singular as far as told
            return None
        real = [k for k, value in enumerate(values) if not bool(value.imag != 0)]
        if any(
            values[k].conjugate().overlaps(other)
            for k in real
            for j, other in enumerate(values)
            if j != k
        ):
            return None
        lines = [_line_of(null, vectors, k) for k in real]
        return [q for q in lines if q is not None] if None not in lines else None

    def _functionals(self, levelled: LevelledExactly) -> list[list[arb]]:
        """N, by rows: what the free monomials and the equations leave of the others."""
        table = _ball_products(levelled)
        left = arb_mat([[table[row][k] for k in self.pivots] for row in self.rows])
        right = arb_mat([[table[row][k] for k in self.columns] for row in self.rows])
        solved = left.solve(right).table()
        null = [[arb(0)] * len(self.columns) for _ in range(len(self.pivots) + len(self.columns))]
        for row, pivot in zip(solved, self.pivots, strict=True):
            null[pivot] = [-entry for entry in row]
        for column, k in enumerate(self.columns):
            null[k][column] = arb(1)
        return null

    def _on_basis(self, null: list[list[arb]], form: Sequence[int]) -> arb_mat:
        """The rows of N for a linear form times each monomial of the basis."""
        raised = [(_raised(k), factor) for k, factor in enumerate(form) if factor]
        return arb_mat(
            [
                [
                    sum((factor * null[to[m]][column] for to, factor in raised), arb(0))
                    for column in range(len(self.columns))
                ]
                for m in self.basis
            ]
        )


def _ball_products(levelled: LevelledExactly) -> list[list[Any]]:
    """The products of degree 8, 210 x 165, at the working precision."""
    short = levelled.shortened(ctx.prec + GUARD_BITS)
    radius = 0 if short is levelled else 1  # what is cut off is below 1
    unit = arb((1, -short.bits))
    quartic = [arb(entry, radius) * unit for entry in short.integers]
    where = product_places(4, DEGREE)
    table: list[list[Any]] = []
    for form in minor_terms().tolist():
        minor = [sum((c * quartic[k] for k, c in enumerate(terms) if c), arb(0)) for terms in form]
        for times in where.T.tolist():
            row: list[Any] = [0] * len(forms(4, DEGREE))
            for place, entry in zip(times, minor, strict=True):
                row[place] = entry
            table.append(row)
    return table


def _line_of(null: list[list[arb]], vectors: Any, k: int) -> tuple[arb, ...] | None:
    """The quaternion of a real eigenvector: q_i / q_j = (x_i x_j^7) / x_j^8, q_j the largest."""
    places = forms(4, DEGREE)
    values = [_value(null[places[(j,) * DEGREE]], vectors, k) for j in range(4)]
    j = max(range(4), key=lambda i: values[i].abs_lower())
    if not bool(values[j] != 0):
        return None
    return tuple(
        arb(1) if i == j else (_value(null[_power(i, j)], vectors, k) / values[j]).real
        for i in range(4)
    )


def _power(i: int, j: int) -> int:
    """The place of x_i x_j^7."""
    return forms(4, DEGREE)[tuple(sorted((i, *(j,) * (DEGREE - 1))))]


def _value(row: Sequence[arb], vectors: Any, k: int) -> Any:
    return sum((entry * vectors[m, k] for m, entry in enumerate(row)), vectors[0, k] * 0)


def _listed(objective: Springs, levelled: LevelledExactly, lines: list[tuple[arb, ...]]) -> LineSet:
    """The list of proved lines, by ascending energy."""
    quartic = BallQuartic(levelled)
    with ctx.workprec(MOST_BITS):
        parts = [
            (
                critical_at(objective, q, negative_eigenvalues(quartic.curvature(q)), BITS),
                quartic.level(q),
            )
            for q in lines
        ]
    least = min((level for _, level in parts), key=lambda level: level.mid())
    parts.sort(key=lambda part: (bool(part[1] > least), part[0].value))
    return line_set(
        GROEBNER,
        [part for part, _ in parts],
        finiteness=Finiteness.FORTY,
        pairs=(LINES - len(lines)) // 2,
        tied=sum(not bool(level > least) for _, level in parts),
        bits=BITS,
    )


def _are_told(lines: Sequence[tuple[arb, ...]]) -> bool:
    """Whether the entries, of which the largest is 1, are known to `BITS` and more."""
    return all(radius_bits(entry) < -BITS for q in lines for entry in q)


def _raised(k: int) -> list[int]:
    """Where x_k times each monomial of degree 7 stands among those of degree 8."""
    places = forms(4, DEGREE)
    return [places[tuple(sorted((*monomial, k)))] for monomial in forms(4, DEGREE - 1)]


def _pivots(reduced: list[list[int]]) -> list[int]:
    """The first column that is not zero, of each row of a reduced matrix."""
    firsts = (next((k for k, entry in enumerate(row) if entry), None) for row in reduced)
    return [first for first in firsts if first is not None]


def _independent(matrix: nmod_mat) -> list[int]:
    """Columns that span all, of a matrix modulo a prime."""
    reduced, _ = matrix.rref()
    return _pivots([[int(entry) for entry in row] for row in reduced.table()])
