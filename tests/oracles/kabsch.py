"""The best rotation of weighted pairs in balls: an oracle that shares nothing with the package.

Points as fractions, Kabsch's singular values as roots of an integer polynomial that FLINT isolates,
the best rotation by Markley's FOAM [Markley1993].
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any

import flint
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.problem.problem import RegistrationProblem

Matrix = list[list[Any]]


def ball(value: Fraction | int) -> Any:
    exact = Fraction(value)
    return flint.arb(flint.fmpq(exact.numerator, exact.denominator))


def rows(array: Any) -> Matrix:
    return [[Fraction(entry) for entry in row] for row in np.asarray(array, dtype=float).tolist()]


def product(A: Matrix, B: Matrix) -> Matrix:
    return [
        [sum(a * b for a, b in zip(r, c, strict=True)) for c in zip(*B, strict=True)] for r in A
    ]


def transpose(A: Matrix) -> Matrix:
    return [list(column) for column in zip(*A, strict=True)]


def det(A: Matrix) -> Any:
    (a, b, c), (d, e, f), (g, h, i) = A
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def cofactors(A: Matrix) -> Matrix:
    return [
        [
            A[(i + 1) % 3][(j + 1) % 3] * A[(i + 2) % 3][(j + 2) % 3]
            - A[(i + 1) % 3][(j + 2) % 3] * A[(i + 2) % 3][(j + 1) % 3]
            for j in range(3)
        ]
        for i in range(3)
    ]


def rotation(q: Sequence[Fraction]) -> Matrix:
    """The rotation of a quaternion, normalised, w first."""
    w, x, y, z = q
    n = w * w + x * x + y * y + z * z
    return [
        [(w * w + x * x - y * y - z * z) / n, 2 * (x * y - w * z) / n, 2 * (x * z + w * y) / n],
        [2 * (x * y + w * z) / n, (w * w - x * x + y * y - z * z) / n, 2 * (y * z - w * x) / n],
        [2 * (x * z - w * y) / n, 2 * (y * z + w * x) / n, (w * w - x * x - y * y + z * z) / n],
    ]


@dataclass(frozen=True)
class Oracle:
    """What is true of a problem, exactly or in balls of the precision that FLINT is set to."""

    source: Matrix
    target: Matrix
    weights: list[Fraction]
    known: dict[Any, Any] = field(default_factory=dict)  # gaps and angles of poses

    @classmethod
    def of(cls, problem: RegistrationProblem) -> Oracle:
        weights = [Fraction(w) for w in np.asarray(problem.weights, dtype=float).tolist()]
        return cls(rows(problem.source), rows(problem.target), weights)

    @cached_property
    def mass(self) -> Fraction:
        return sum(self.weights, Fraction(0))

    def mean(self, points: Matrix) -> list[Fraction]:
        pairs = list(zip(self.weights, points, strict=True))
        return [sum((w * p[k] for w, p in pairs), Fraction(0)) / self.mass for k in range(3)]

    @cached_property
    def centred(self) -> tuple[Matrix, Matrix]:
        x, y = self.mean(self.source), self.mean(self.target)
        return (
            [[a - b for a, b in zip(p, x, strict=True)] for p in self.source],
            [[a - b for a, b in zip(p, y, strict=True)] for p in self.target],
        )

    @cached_property
    def C(self) -> Matrix:
        x, y = self.centred
        weighted = [[w * a for a in p] for w, p in zip(self.weights, y, strict=True)]
        return product(transpose(weighted), x)

    @cached_property
    def spread(self) -> Fraction:
        parts = zip(self.weights, *self.centred, strict=True)
        return sum((w * sum(a * a for a in (*x, *y)) for w, x, y in parts), Fraction(0))

    @cached_property
    def singular(self) -> list[Any]:
        """The singular values of C, falling, as balls; the last has the sign of det C."""
        S = product(transpose(self.C), self.C)
        e1 = S[0][0] + S[1][1] + S[2][2]
        e2 = sum((cofactors(S)[k][k] for k in range(3)), Fraction(0))
        polynomial = flint.fmpq_poly([_fmpq(-det(S)), _fmpq(e2), _fmpq(-e1), flint.fmpq(1)])
        isolated: Any = polynomial.numer().complex_roots()
        roots = [r.real for r, times in isolated for _ in range(times)]
        d = sorted((r.sqrt() if r > 0 else flint.arb(0) for r in roots), key=_middle, reverse=True)
        return [d[0], d[1], -d[2] if det(self.C) < 0 else d[2]]

    @cached_property
    def best(self) -> Any:
        """The largest tr(R^T C) over all rotations."""
        return sum(self.singular)

    @property
    def minimum(self) -> Any:
        return ball(self.spread) - 2 * self.best

    @property
    def energy_range(self) -> Any:
        """Of the objective over all rotations: 2 (l1 - l4) = 4 (d1 + d2)."""
        return 4 * (self.singular[0] + self.singular[1])

    @cached_property
    def unique(self) -> bool:
        """d2 + d3 > 0, decided exactly: it is zero iff C has rank one, or det C < 0 and d2 = d3."""
        if all(entry == 0 for row in cofactors(self.C) for entry in row):
            return False
        d = self.singular
        return det(self.C) >= 0 or not (d[1] + d[2]).overlaps(flint.arb(0))

    @cached_property
    def optimum(self) -> Matrix:
        """R = ((kappa + |C|^2) C + lambda adj(C)^T - C C^T C) / zeta, where it is unique."""
        C, best = [[ball(entry) for entry in row] for row in self.C], self.best
        square = sum(entry * entry for row in C for entry in row)
        kappa = (best * best - square) / 2
        zeta = kappa * best - ball(det(self.C))
        cubic, adjugate = product(product(C, transpose(C)), C), cofactors(C)
        return [
            [
                ((kappa + square) * C[i][j] + best * adjugate[i][j] - cubic[i][j]) / zeta
                for j in range(3)
            ]
            for i in range(3)
        ]

    def objective(self, q: Sequence[Fraction], t: Sequence[Fraction] | None = None) -> Fraction:
        """The sum over the points as it is written down; t: the best one if there is none."""
        R = rotation(q)
        if t is None:
            x, y = self.mean(self.source), self.mean(self.target)
            t = [b - a for a, b in zip(_applied(R, x), y, strict=True)]
        total = Fraction(0)
        for w, x, y in zip(self.weights, self.source, self.target, strict=True):
            parts = zip(y, _applied(R, x), t, strict=True)
            total += w * sum((b - a - c) ** 2 for b, a, c in parts)
        return total

    def gap(self, q: Sequence[Fraction], t: Sequence[Fraction] | None = None) -> Any:
        """The objective of a pose above the minimum."""
        key = (tuple(q), None if t is None else tuple(t))
        if key not in self.known:
            self.known[key] = self._gap(q, t)
        return self.known[key]

    def _gap(self, q: Sequence[Fraction], t: Sequence[Fraction] | None) -> Any:
        if not any(entry for row in self.C for entry in row):
            return ball(self.objective(q, t) - self.spread)
        return ball(self.objective(q, t)) - self.minimum

    def angle(self, q: Sequence[Fraction]) -> Any:
        """Radians from a rotation to the one best: 4 sin^2(a/2) = 3 - tr(R*^T R)."""
        if tuple(q) not in self.known:
            self.known[tuple(q)] = self._angle(q)
        return self.known[tuple(q)]

    def _angle(self, q: Sequence[Fraction]) -> Any:
        R = [[ball(entry) for entry in row] for row in rotation(q)]
        trace = sum(
            a * b for r, s in zip(self.optimum, R, strict=True) for a, b in zip(r, s, strict=True)
        )
        return 2 * root((3 - trace) / 4).asin()


def root(square: Any) -> Any:
    """Of what is not negative: where a ball may be zero, a ball about zero."""
    return square.sqrt() if square > 0 else flint.arb(0, square.abs_upper().sqrt())


def _fmpq(value: Fraction) -> Any:
    return flint.fmpq(value.numerator, value.denominator)


def _middle(value: Any) -> Any:
    return value.mid()


def _applied(R: Matrix, x: Sequence[Fraction]) -> list[Fraction]:
    return [sum((a * b for a, b in zip(row, x, strict=True)), Fraction(0)) for row in R]
