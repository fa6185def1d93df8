"""Claim: what a translation costs where springs are matrices, and which translations are free."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from certreg.geometry.so3 import dot, rotation_matrix, squared_norm
from certreg.objective.springs import Springs
from certreg.problem.problem import RegistrationProblem
from certreg.verify import CheckedSprings

from ..algebra import Square, combination, contraction, facts, identity, nonnegative
from ..hypothesis import Standing, vanishing
from ..kernel import Claim, Mutation, Proof
from ..notation import Matrix, entry, matrix, scalar, square, symmetric, vector
from ..shipped import eliminated_springs

TranslationEnergy = Callable[[Any, Sequence[int], Sequence[Fraction]], Fraction]
Elimination = Callable[..., Any]
SOURCE = ((1, 0, 2), (-3, 4, 0), (0, 5, 1), (2, 2, -7))
TARGET = ((8, 1, 0), (0, -2, 4), (16, 4, 4), (12, 0, -8))
STIFF = ((1, 2, 3, 0, 1, 2), (2, 0, 0, 1, 0, 0), (0, 0, 4, 5, 1, 1), (1, 0, 1, 0, 0, 3))
SLIDING = ((0, 0, 1, 0, 2, 0), (0, 0, 2, 0, 0, 1), (0, 0, 0, 0, 0, 3), (0, 0, 1, 0, 1, 0))
QUATERNIONS = ((1, 0, 0, 0), (1, 2, 3, 4), (0, 5, -1, 2))
TRANSLATION = (Fraction(1, 2), Fraction(-3), Fraction(5, 7))

L = Matrix(3, 3, lambda i, j: entry("l", i + 1, j + 1) if j <= i else 0)
R, T, X, Y, N = matrix("R"), vector("t"), vector("x"), vector("y"), vector("n")
S, B, BEST = symmetric("S"), vector("b"), vector("s")
BALANCED = vanishing(
    r"$S t^* = b$; the entries of $t^*$ are $s_1, s_2, s_3$.",
    S * BEST - B,
    standing=Standing.CASE,
    solves=tuple(B),
)
FREE = vanishing(
    r"$L^{\mathsf T} n = 0$, for the $L$ of every spring.",
    L.T * N,
    standing=Standing.CASE,
    example={L[0, 0]: 1, N[0]: 1, scalar("a"): 1},
)


def energy_of_one(factor: Any, t: Any) -> Any:
    """|L^T (y - R x - t)|^2."""
    return square(factor.T * (Y - R * X - t))


def proof(
    shipped: TranslationEnergy = Springs.translation_energy,
    eliminated: Elimination = eliminated_springs,
    *,
    transposed: bool = False,
    cost: int = 1,
) -> Proof:
    """One spring, the square completed, free translations, and the two programs."""
    W = L.T * L if transposed else L * L.T
    apart = Y - R * X
    yield identity(
        r"One spring, $W = L L^{\mathsf T}$ with $L$ lower triangular, and $d = y - R x$: its "
        r"energy $|L^{\mathsf T}(d - t)|^2$ is $d^{\mathsf T} W d - 2\, t^{\mathsf T} W d + "
        r"t^{\mathsf T} W t$. Summed over all springs the energy is $a - 2\, b \cdot t + "
        r"t^{\mathsf T} S t$, with $S = \sum_i W_i$ and $b = \sum_i W_i d_i$.",
        energy_of_one(L, T),
        (apart.T * W * apart)[0] - 2 * (T.T * W * apart)[0] + (T.T * W * T)[0],
    )
    off = T - BEST
    rise = -2 * (B.T * off)[0] + (T.T * S * T)[0] - (BEST.T * S * BEST)[0]
    yield combination(
        r"If $S t^* = b$, the energy at $t$ less that at $t^*$ is "
        r"$(t - t^*)^{\mathsf T} S (t - t^*)$.",
        rise - cost * (off.T * S * off)[0],
        contraction(2 * off, BALANCED),
    )
    yield nonnegative(
        r"It is not negative: $n^{\mathsf T} W n = |L^{\mathsf T} n|^2$, and $n^{\mathsf T} S n$ "
        r"is the sum of these. So $t^*$ is a best translation, and $S n = 0$ if and only if "
        r"$L_i^{\mathsf T} n = 0$ for all $i$. There is a $t^*$: $b$ is in the span of the columns "
        r"of all $L_i$, which is the orthogonal complement of these $n$, and so that of $S$.",
        (N.T * L * L.T * N)[0],
        [[Square(entry)] for entry in L.T * N],
    )
    a = scalar("a")
    moved = apart - T
    yield combination(
        r"Along such an $n$ nothing changes, at any rotation: $|L^{\mathsf T}(d - t - a n)|^2 = "
        r"|L^{\mathsf T}(d - t)|^2$.",
        energy_of_one(L, T + a * N) - energy_of_one(L, T),
        contraction(-2 * a * L.T * moved + a**2 * L.T * N, FREE),
    )
    yield from _programs(shipped, eliminated)


def _programs(shipped: TranslationEnergy, eliminated: Elimination) -> Proof:
    H = symmetric("H", 5)
    minors = [H[[0, 1, 2, i], [0, 1, 2, j]] for i, j in ((3, 3), (3, 4), (4, 4))]
    form, divisor = eliminated(H)
    yield identity(
        r"`certreg.verify.CheckedSprings.of`, run on polynomials, eliminates the entries of $t$ "
        r"from the form $z^{\mathsf T} H z$ (here with two more unknowns instead of ten). What is "
        r"left are the minors of $S$ bordered by a further row and column, which are "
        r"$\det S\, (H_{rr} - H_{rt} S^{-1} H_{tr})$, over $\det S$; no division left a remainder.",
        [*form, divisor],
        [
            *(minor.det(method="berkowitz") for minor in minors),
            H[:3, :3].det(method="berkowitz"),
        ],
    )
    yield facts(
        r"`energy` plus `translation_energy` of `certreg.objective.springs.Springs`, on four "
        r"springs that resist every shift and on four of which none resists a shift along $x$, at "
        r"three integer quaternions and a rational translation, is the sum of "
        r"$|L^{\mathsf T}(y - R x - t)|^2$, computed directly in fractions.",
        [_told(shipped, factors, q) for factors in (STIFF, SLIDING) for q in QUATERNIONS],
        [_summed(factors, q) for factors in (STIFF, SLIDING) for q in QUATERNIONS],
    )
    yield facts(
        r"On the same springs the checker's elimination, which passes over pivots that are zero, "
        r"finds the energy of the best translation, and that none and one direction are free. "
        r"The objective names as many.",
        [_checked(factors, q) for factors in (STIFF, SLIDING) for q in QUATERNIONS],
        [
            (_objective(factors).energy(q), free)
            for factors, free in ((STIFF, 0), (SLIDING, 1))
            for q in QUATERNIONS
        ],
    )


def _problem(factors: Sequence[Sequence[int]]) -> RegistrationProblem:
    return RegistrationProblem(
        np.array(SOURCE, float), np.array(TARGET, float), factors=np.array(factors, float)
    )


def _objective(factors: Sequence[Sequence[int]]) -> Springs:
    return Springs.of(_problem(factors))


def _told(
    shipped: TranslationEnergy, factors: Sequence[Sequence[int]], q: Sequence[int]
) -> Fraction:
    objective = _objective(factors)
    return objective.energy(q) + shipped(objective, q, TRANSLATION)


def _summed(factors: Sequence[Sequence[int]], q: Sequence[int]) -> Fraction:
    norm, rows = squared_norm(q), rotation_matrix(q)
    total = Fraction(0)
    for x, y, (a, b, c, d, e, f) in zip(SOURCE, TARGET, factors, strict=True):
        moved = [Fraction(dot(row, x), norm) + t for row, t in zip(rows, TRANSLATION, strict=True)]
        u, v, w = (i - j for i, j in zip(y, moved, strict=True))
        total += (a * u + b * v + d * w) ** 2 + (c * v + e * w) ** 2 + (f * w) ** 2
    return total


def _checked(factors: Sequence[Sequence[int]], q: Sequence[int]) -> tuple[Fraction, int]:
    """By the checker: H of the objective, reordered to (t, R by columns, 1), then eliminated."""
    objective = _objective(factors)
    H = objective.joint_form.rows
    order = (10, 11, 12, *range(1, 10), 0)
    rows = [[H[i][j] for j in order[k:]] for k, i in enumerate(order)]
    found = CheckedSprings.of(rows, 0, moves=True)
    same = found.free == len(objective.free_translations)
    return found.at(q), found.free if same else -1


def _twice(objective: Springs, q: Sequence[int], t: Sequence[Fraction]) -> Fraction:
    return 2 * Springs.translation_energy(objective, q, t)


def _undivided(H: Any) -> Any:
    form, divisor = eliminated_springs(H)
    return form, divisor**2


CLAIM = Claim(
    name="spring_translation",
    title="What a translation costs with matrices of springs",
    statement=r"Let $f(R, t) = \sum_i (y_i - R x_i - t)^{\mathsf T} W_i (y_i - R x_i - t)$, "
    r"$W_i = L_i L_i^{\mathsf T}$, $S = \sum_i W_i$, and $S t^* = \sum_i W_i (y_i - R x_i)$. For "
    r"every $R$, $$f(R, t) - f(R, t^*) = (t - t^*)^{\mathsf T} S\, (t - t^*) \ge 0.$$ $S n = 0$ if "
    r"and only if $L_i^{\mathsf T} n = 0$ for all $i$, and then $f(R, t + a n) = f(R, t)$ for all "
    r"$R$, $t$ and $a$. The checker's elimination leaves the Schur complement of $S$ times "
    r"$\det S$.",
    concludes=(1, 2, 3, 4, 5, 6, 7),
    hypotheses=(BALANCED, FREE),
    setting=("$R$ may be any matrix.",),
    source="elementary; the elimination of [Bareiss1968]",
    proof=proof,
    controls={
        "springs of the matrix L^T L": Mutation(at=1, proof=lambda: proof(transposed=True)),
        "a cost of twice the form of S": Mutation(at=2, proof=lambda: proof(cost=2)),
        "an elimination over the square of det S": Mutation(
            at=5, proof=lambda: proof(eliminated=_undivided)
        ),
        "shipped code that counts the cost twice": Mutation(
            at=6, proof=lambda: proof(shipped=_twice)
        ),
    },
    not_claimed=r"That $t^*$ is unique where $S$ is singular: it is known up to free translations. "
    r"That pivots which are zero are passed over rightly is seen on an example; it rests on $H "
    r"\succeq 0$, where all beside a zero of the diagonal is zero.",
    needs=("translation_gap", "elimination"),
    runs=(
        "certreg.verify.CheckedSprings.of",
        "certreg.objective.objective.Objective.translation_energy",
    ),
    used_by=("certreg.objective.springs.Springs.best_translation",),
    not_in_coq="All of it: the theorems in Coq are about one weight for each pair.",
)
