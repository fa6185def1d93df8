"""Claim: the best scale of a rotation, what it costs, and what a gap of the alignment is worth."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any, cast

import sympy

from certreg.geometry.so3 import davenport_matrix
from certreg.objective.scaling import SCALINGS, Scaling
from certreg.problem.motion import Scale

from ..algebra import Square, facts, identity, nonnegative, positive
from ..hypothesis import Standing, invertible, nonnegative_by, positive_by
from ..kernel import Claim, Mutation, Proof
from ..notation import Matrix, entry, matrix, scalar, square

Energy = Callable[[Scaling, Any, Any], Any]
S, BEST, ALIGNED, KEPT, DELTA = (scalar(name) for name in ("s", "t", "a", "p", "delta"))
SOURCE, TARGET, WIDE, FAR = (scalar(name) for name in ("S_xx", "S_yy", "u", "z"))
LEVELS = [entry("lambda", k) for k in (1, 2, 3)]
TOP, LAST = LEVELS[0], -sum(LEVELS)

SIZE = positive_by(r"The source is no single point: $S_{xx} > 0$.", SOURCE)
OTHER = invertible(r"$s$ is another scale: $s \ne t$.", S - BEST, standing=Standing.CASE)
UPRIGHT = positive_by(r"$s > 0$.", S, standing=Standing.CASE)
TURNED = nonnegative_by(
    r"$a \le 0$.", -ALIGNED, standing=Standing.CASE, example={ALIGNED: 1, S: 1, SOURCE: 1}
)
LARGEST = nonnegative_by(
    r"$\lambda_1 \ge \lambda_k$; the sum of all four is $0$.",
    [TOP - LEVELS[1], TOP - LEVELS[2], TOP - LAST],
    prepare=lambda point: {TOP: 2 * max(abs(point[level]) for level in LEVELS)},
)
KEEPS = nonnegative_by(
    r"$p = \max(0, a)$, so $p \ge a$.",
    KEPT - ALIGNED,
    standing=Standing.CASE,
    example={ALIGNED: 3, DELTA: 1, TOP: Fraction(7, 2)},
)
ALIGNS = nonnegative_by(
    r"$a \ge 0$.",
    ALIGNED,
    standing=Standing.CASE,
    example={ALIGNED: -3, DELTA: 5, TOP: 1, SOURCE: 1},
)
BOUNDED = positive_by(
    r"$\lambda_1 < a + \delta$.",
    ALIGNED + DELTA - TOP,
    standing=Standing.CASE,
    example={TOP: 2, DELTA: 1, SOURCE: 1},
)


def shipped_energy(scaling: Scaling, alignment: Any, scale: Any) -> Any:
    """`Scaling.energy_at` at the best translation, of numbers or symbols."""
    return scaling.energy_at(alignment, scale, Fraction(0))


def of(kind: Scale, source: Any, target: Any) -> Scaling:
    """A scaling of numbers or symbols."""
    return SCALINGS[kind](cast("Fraction", source), cast("Fraction", target))


def proof(
    energy: Energy = shipped_energy,
    *,
    upright: bool = True,
    missing: int = 0,
    root: int = 1,
    share: int = 12,
) -> Proof:
    """The best scale of a rotation; the spectrum; the gap; the symmetric scale; numbers."""
    free = of(Scale.ASYMMETRIC, SOURCE, TARGET)
    yield from _best(free, energy)
    yield from _spectrum(share)
    yield _gap(free, missing, upright=upright)
    yield from _symmetric(root)
    yield _numbers()


def _best(free: Scaling, energy: Energy) -> Proof:
    yield positive(
        r"With $a = \operatorname{tr}(R^{\mathsf T} C)$ and the best translation the objective is "
        r"$W(s) = S_{yy} - 2 s a + s^2 S_{xx}$ (claim `breathing_motion`, $c = 0$), which the "
        r"shipped `energy_at` computes. At $t = a/S_{xx}$ it is less than at any other scale: "
        r"$W(s) - W(t) = S_{xx}(s - t)^2$. Where $a \ge 0$ that scale is not negative, so it is "
        r"the best one;",
        energy(free, BEST * SOURCE, S) - energy(free, BEST * SOURCE, BEST),
        [[SIZE[0], Square(OTHER[0])]],
    )
    yield identity(
        r"it costs $W(a/S_{xx}) = S_{yy} - a^2/S_{xx}$, here times $S_{xx}$.",
        sympy.cancel(SOURCE * energy(free, ALIGNED, ALIGNED / SOURCE)),
        SOURCE * TARGET - ALIGNED**2,
    )
    yield positive(
        r"Where $a \le 0$ the best one is $0$, at $S_{yy}$: every scale above $0$ costs more, "
        r"$W(s) - W(0) = -2 s a + s^2 S_{xx} > 0$. So a rotation costs $S_{yy} - \max(0, "
        r"a)^2/S_{xx}$, which falls as $a$ rises, where it is positive: with $a \le \lambda_1$, "
        r"attained, the minimum is $S_{yy} - \lambda_1^2/S_{xx}$, at the rotations that are best "
        r"without a scale if $\lambda_1 > 0$, and the scale there $\lambda_1/S_{xx}$.",
        energy(free, ALIGNED, S) - energy(free, ALIGNED, 0),
        [[2, UPRIGHT[0], TURNED[0]], [UPRIGHT[0], UPRIGHT[0], SIZE[0]]],
    )


def _spectrum(share: int) -> Proof:
    cross = matrix("C")
    K: Any = Matrix(davenport_matrix(cross.tolist()))
    yield identity(
        r"$\operatorname{tr} K = 0$, and $\operatorname{tr} K^2 = 4 |C|^2$, the sum of the squares "
        r"of its entries.",
        [K.trace(), (K * K).trace()],
        [0, 4 * square(Matrix(list(cross)))],
    )
    drops = LARGEST.parts
    yield nonnegative(
        r"So the eigenvalues add up to $0$, $4 \lambda_1 = \sum (\lambda_1 - \lambda_k) \ge 0$,",
        4 * TOP,
        [[drop] for drop in drops],
    )
    yield nonnegative(
        r"and $12 \lambda_1^2 - \sum \lambda_k^2$ is twice the sum of the products of two of "
        r"$\lambda_1 - \lambda_k$: $\lambda_1^2 \ge \tfrac{1}{12} \operatorname{tr} K^2 = "
        r"\tfrac13 |C|^2$. The best scale is $0$ if and only if $C = 0$.",
        share * TOP**2 - sum(level**2 for level in (*LEVELS, LAST)),
        [[2, drops[i], drops[j]] for i in range(3) for j in range(i)],
    )


def _gap(free: Scaling, missing: int, *, upright: bool) -> Any:
    """missing: times delta^2 taken from the gap. upright: whether a >= 0 is used."""
    gap: Any = free.gap(cast("Fraction", ALIGNED), cast("Fraction", DELTA))
    aligned = [[2, ALIGNS[0], KEEPS[0]]] if upright else []
    return positive(
        r"Let $a \ge 0$ and $\lambda_1 < a + \delta$. The rotation exceeds the minimum by "
        r"$(\lambda_1^2 - p^2)/S_{xx}$, $p = \max(0, a)$. The shipped gap $\delta (2a + "
        r"\delta)/S_{xx} = ((a + \delta)^2 - a^2)/S_{xx}$ is more; here times $S_{xx}$.",
        sympy.cancel(SOURCE * gap) - missing * DELTA**2 - TOP**2 + KEPT**2,
        [
            [Square(BOUNDED[0])],
            *([sympy.Rational(1, 2), BOUNDED[0], drop] for drop in LARGEST.parts),
            [Square(KEEPS[0])],
            *aligned,
        ],
    )


def _symmetric(root: int) -> Proof:
    horn, turned = (of(Scale.SYMMETRIC, *pair) for pair in ((WIDE**2, FAR**2), (FAR**2, WIDE**2)))
    whole = shipped_energy(horn, ALIGNED, S)
    yield identity(
        r"Symmetric, with $u = \sqrt{S_{xx}}$ and $z = \sqrt{S_{yy}}$: the shipped energy is $W(s)/"
        r"s = (z - s u)^2/s + 2 u z - 2 a$, here times $s$. So over $s > 0$ the scale $z/u$ is "
        r"best, whatever the rotation, which costs $2 u z - 2 a$ then: best without a scale is "
        r"best.",
        sympy.cancel(S * whole),
        (FAR - S * WIDE) ** 2 + 2 * root * S * WIDE * FAR - 2 * S * ALIGNED,
    )
    yield identity(
        r"Source and target may change their roles, the rotation turns back, $s$ becomes $1/s$: "
        r"the energy stays. Hence the name.",
        sympy.cancel(S * whole),
        sympy.cancel(S * shipped_energy(turned, ALIGNED, 1 / S)),
    )
    gap: Any = horn.gap(cast("Fraction", ALIGNED), cast("Fraction", DELTA))
    yield positive(
        r"It exceeds the minimum by $2(\lambda_1 - a)$, less than the shipped gap $2\delta$.",
        gap - 2 * (TOP - ALIGNED),
        [[2, BOUNDED[0]]],
    )


def _numbers() -> Any:
    scaling = of(Scale.ASYMMETRIC, Fraction(2), Fraction(9))
    low, high = scaling.interval(Fraction(3), Fraction(1))
    return facts(
        r"The shipped functions for $S_{xx} = 2$, $S_{yy} = 9$: at $a = 3$ the scale $3/2$ and the "
        r"energy $9/2$, at $a = -1$ they are $0$ and $9$; with $\delta = 1$ the scale is between "
        r"$3/2$ and $2$. Why $a \ge 0$ is asked for: at $a = -3$ the formula gives for $\delta = "
        r"6$ the gap $0$, and for $\delta = 4$ one of $-4$, where the rotation may exceed the "
        r"minimum, by $\lambda_1^2/S_{xx}$.",
        [
            *(scaling.best(Fraction(a)) for a in (3, -1)),
            *(scaling.energy(Fraction(a)) for a in (3, -1)),
            *(low.value, high.value),
            *(scaling.gap(Fraction(-3), Fraction(delta)) for delta in (6, 4)),
        ],
        [Fraction(3, 2), 0, Fraction(9, 2), 9, Fraction(3, 2), 2, 0, -4],
    )


def _twice_the_square(scaling: Scaling, alignment: Any, scale: Any) -> Any:
    """The energy with twice the square of the scale."""
    return shipped_energy(scaling, alignment, scale) + scale**2 * scaling.source


CLAIM = Claim(
    name="scale_elimination",
    title="The best scale, and what it costs",
    statement=r"Of a rotation with $a = \operatorname{tr}(R^{\mathsf T} C)$, $\sum w\,|y - s R x - "
    r"t|^2$ over $s \ge 0$ and $t$ has the best scale $\max(0, a)/S_{xx}$ and costs $S_{yy} - "
    r"\max(0, a)^2/S_{xx}$. So the best rotations are those of the rigid body, at the scale "
    r"$\lambda_1/S_{xx}$, which is $0$ if and only if $C = 0$. If $a \ge 0$ and $\lambda_1 < a + "
    r"\delta$, the rotation exceeds the minimum by less than $\delta(2a + \delta)/S_{xx}$. The "
    r"same sum over $s$, symmetric in source and target, has the best scale "
    r"$\sqrt{S_{yy}/S_{xx}}$, whatever the rotation, costs $2\sqrt{S_{xx} S_{yy}} - 2a$, and "
    r"exceeds the minimum by less than $2\delta$.",
    concludes=tuple(range(1, 11)),
    hypotheses=(SIZE, OTHER, UPRIGHT, TURNED, LARGEST, KEEPS, ALIGNS, BOUNDED),
    setting=(
        r"$S_{xx} = \sum w|x|^2$, $S_{yy} = \sum w|y|^2$, about means (the origin if $t = 0$).",
        r"$\lambda_1 \ge \dots \ge \lambda_4$ are the eigenvalues of $K$; $a = q^{\mathsf T} K q$.",
    ),
    source="[Umeyama1991], [Horn1987]",
    proof=proof,
    controls={
        "an energy with twice the square": Mutation(at=1, proof=lambda: proof(_twice_the_square)),
        "a smallest eigenvalue as large as the rest together": Mutation(
            at=6,
            proof=lambda: proof(share=11),
            point={TOP: 1, LEVELS[1]: 1, LEVELS[2]: 1},
        ),
        "a gap without its square": Mutation(
            at=7,
            proof=lambda: proof(missing=1),
            point={DELTA: 2, TOP: 1},
        ),
        "a gap where a = -3, and the best scale is 0": Mutation(
            at=7,
            proof=lambda: proof(upright=False),
            point={ALIGNED: -3, DELTA: 6, TOP: 1},
        ),
        "a symmetric cost of 4 u z": Mutation(at=8, proof=lambda: proof(root=2)),
    },
    not_claimed="That the best rotation is unique: that is the claim `classification`. Anything "
    r"of $a < 0$, where the checker refuses.",
    needs=("breathing_motion", "optimality_certificate", "eigenvectors", "davenport"),
    runs=(
        "certreg.objective.scaling.Scaling.energy_at",
        "certreg.objective.scaling.Scaling.energy",
        "certreg.objective.scaling.Scaling.best",
        "certreg.objective.scaling.Scaling.gap",
        "certreg.objective.scaling.Scaling.interval",
        "certreg.objective.scaling.SymmetricScaling.energy",
        "certreg.objective.scaling.SymmetricScaling.best",
        "certreg.objective.scaling.SymmetricScaling.gap",
        "certreg.geometry.so3.davenport_matrix",
    ),
    used_by=("certreg.verify.SimilarityStatement",),
    not_in_coq="All of it: the checker in Coq reads no scale.",
)
