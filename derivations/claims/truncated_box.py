"""Claim: a box of rotations is without a better truncated cost, by one test of a 4x4 matrix."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

from certreg.verify import davenport, proves_level

from ..algebra import Square, combination, contraction, facts, identity, nonnegative, positive
from ..hypotheses import ROTATION, definite
from ..hypothesis import Hypothesis, Standing, nonnegative_by, positive_by
from ..kernel import Claim, Mutation, Proof
from ..moments import MomentCloud
from ..notation import (
    Matrix,
    entry,
    inner,
    matrix,
    quaternion,
    rotation,
    scalar,
    square,
    symmetric,
    vector,
)

Built = Callable[[], Any]
A, P, Q, K = vector("a"), quaternion("p"), quaternion(), symmetric("K", 4)
SPREAD, OUT, LEVEL, COST = scalar("S"), scalar("n"), scalar("U"), scalar("V")
TAU, SINE = scalar("tau"), scalar("sigma")  # sin^2(alpha / 2)
COSTS = [entry("c", k) for k in (1, 2, 3)]
SQUARES = [entry("v", k) for k in (1, 3)]  # omega |r|^2

NEAR = nonnegative_by(
    r"The turn $R(p)$ is by at most $\alpha$: $|v|^2 \le \sigma |p|^2$, $v$ the vector of $p$.",
    SINE * square(P) - square(P[1:]),
    standing=Standing.CASE,
    example={P[1]: 1, A[1]: 1},
)
EACH = nonnegative_by(
    r"A pair costs $\omega |r|^2$ at least if it is in or open, and $1$ if it is out.",
    [COSTS[0] - SQUARES[0], COSTS[1] - 1, COSTS[2] - SQUARES[1]],
    standing=Standing.CASE,
)
BOX = nonnegative_by(
    r"$R(p)$ is in the box about $R(q)$: $(1 - \sigma)\,|q|^2 |p|^2$ is at most $(q \cdot p)^2$.",
    (Q.T * P)[0] ** 2 - (1 - SINE) * square(Q) * square(P),
    standing=Standing.CASE,
    example={SPREAD: 1, TAU: 8, Q[0]: 1, P[1]: 1, K[1, 1]: 2, SINE: Fraction(1, 2), K[0, 0]: -3},
)
FOUND = {SPREAD: 2, TAU: 1, SINE: Fraction(1, 2), Q[0]: 1, P[0]: 1, K[0, 0]: 1} | dict.fromkeys(
    (K[k, k] for k in (1, 2, 3)), -2
)
RISES = nonnegative_by(r"$\tau \ge 0$.", TAU, example=FOUND | {TAU: -1})
WHOLE = nonnegative_by(
    r"The cost there is $V \ge n + S - 2 p^{\mathsf T} K p/|p|^2$.",
    (COST - OUT - SPREAD) * square(P) + 2 * (P.T * K * P)[0],
    standing=Standing.CASE,
    example={COST: -9, Q[0]: 1, P[0]: 1, SPREAD: 2, SINE: 1},
)


def box_matrix() -> Any:
    """|q|^2 times (S + n - U) I - 2 K - tau (q q^T / |q|^2 - (1 - sigma) I)."""
    level = SPREAD + OUT - LEVEL + TAU * (1 - SINE)
    return square(Q) * (level * Matrix.eye(4) - 2 * K) - TAU * Q * Q.T


def _definite_by(built: Built) -> Hypothesis:
    form = built()
    return positive_by(
        r"$A \succ 0$, and so its form is positive at $p \ne 0$.",
        (P.T * form * P)[0],
        further=lambda point: definite(form, point),
    )


DEFINITE = _definite_by(box_matrix)


def half_turn_excluded(level: Fraction, *, out: int = 2) -> bool:
    """Whether the cost is above the level near the half turn about e_3.

    The pairs are e_j -> e_j; about that half turn the first two are out, the third is open.
    """
    rows = [[0, 0, 0], [0, 0, 0], [0, 0, 8]]
    unit = level.denominator
    bound = int((8 + out - level) * unit)
    turned = [[entry * unit for entry in row] for row in davenport(rows)]
    return proves_level(turned, 1, (0, 0, 0, 1), bound, 0)


def proof(
    built: Built = box_matrix,
    test: Callable[[Fraction], bool] = half_turn_excluded,
    *,
    chord: int = 4,
    outer: int = 1,
) -> Proof:
    """How far a point moves in a box; what pairs cost there; the test; an instance."""
    yield from _turned(chord)
    yield from _costs(outer)
    given = DEFINITE if built is box_matrix else _definite_by(built)
    norm, p = square(Q), square(P)
    yield positive(
        r"So at a rotation $R(p)$ of the box $|q|^2 |p|^2\,(V - U)$ is $p^{\mathsf T}(|q|^2 A)\, "
        r"p$ plus $|q|^2$ times the excess $|p|^2 (V - n - S) + 2 p^{\mathsf T} K p \ge 0$ plus "
        r"$\tau\,\bigl((q \cdot p)^2 - (1 - \sigma)\,|q|^2 |p|^2\bigr) \ge 0$: positive. The box "
        "holds no rotation with a cost of $U$ or less.",
        norm * p * (COST - LEVEL),
        [[given[0]], *([WHOLE[0], Square(e)] for e in Q), [RISES[0], BOX[0]]],
    )
    yield facts(
        r"The pairs $e_j \to e_j$ with $\beta = \tfrac12, \tfrac12, \tfrac14$, in the box about "
        r"the half turn about $e_3$ with $\sin(\alpha/2) = \tfrac14$, where points move by "
        r"$\tfrac12$ at most: two residuals are $\tfrac32$ at least, out, and one is $\tfrac12$ "
        r"at most, open with $\omega = 4$. So $C = 4 e_3 e_3^{\mathsf T}$, $S = 8$, $n = 2$: "
        r"`certreg.verify.proves_level` proves with $\tau = 0$ that the cost is above $1$, and "
        "not that it is above $2$, which the half turn itself has.",
        [test(Fraction(1)), test(Fraction(2))],
        [True, False],
    )


def _turned(chord: int) -> Proof:
    moved = rotation(P) * A - square(P) * A
    v = Matrix(P[1:])
    yield identity(
        r"A turn $R(p)$ moves a point $a$ by $|R(p) a - a| = 2\,|v \times a|/|p|$, $v$ the vector "
        "of $p$: here the square, times $|p|^4$.",
        square(moved),
        4 * square(P) * square(v.cross(A)),
    )
    yield nonnegative(
        r"Let it be by an angle of at most $\alpha$, and $\sigma = \sin^2(\alpha/2)$: then the "
        r"point moves by at most $\rho = 2 \sin(\alpha/2)\, |a|$. For $R = R_c R(p)$ of the box, "
        r"$|b - R a|$ is between $|b - R_c a| - \rho$ and $|b - R_c a| + \rho$.",
        chord * SINE * square(P) ** 2 * square(A) - square(moved),
        [
            *([4, Square(e), Square((v.T * A)[0])] for e in P),
            *([4, Square(e), NEAR[0], Square(x)] for e in P for x in A),
        ],
    )


def _costs(outer: int) -> Proof:
    yield nonnegative(
        r"In the box let $lo \le |r| \le h$. A pair with $h \le \beta$ is in: it costs $\omega "
        r"|r|^2$, $\omega = 1/\beta^2$. One with $lo \ge \beta$ is out: it costs $1$. Another one "
        r"is open: it costs at least $\omega |r|^2$ with $\omega = 1/h^2$ (claim `chord_bound`). "
        r"Together they cost at least $n + \sum \omega |r|^2$, $n$ the number of those that are "
        r"out (one of each written out, $v$ for $\omega |r|^2$).",
        sum(COSTS) - outer - sum(SQUARES),
        [[part] for part in EACH.parts],
    )
    cloud, R = MomentCloud(), matrix("R")
    yield combination(
        r"The sum is $S - 2 \operatorname{tr}(R^{\mathsf T} C)$ with $S = \sum \omega\,(|a|^2 + "
        r"|b|^2)$ and $C = \sum \omega\, b a^{\mathsf T}$, that is $S - 2 p^{\mathsf T} K "
        "p/|p|^2$ at $R(p)$ (claim `davenport`).",
        cloud.total(square(cloud.y - R * cloud.x))
        - cloud.target_scatter.trace()
        - cloud.source_scatter.trace()
        + 2 * inner(R, cloud.cross),
        contraction(cloud.source_scatter, ROTATION),
    )


def _other_sign() -> Any:
    return box_matrix().xreplace({TAU: -TAU})


CLAIM = Claim(
    name="truncated_box",
    title="A box of rotations without a better truncated cost",
    statement=r"Of directions or points $a_i \to b_i$ let a rotation cost $\sum \min(|b_i - R "
    r"a_i|^2/\beta_i^2, 1)$. In the box of all rotations within the angle $\alpha$ of $R(q)$ let "
    r"$n$ pairs be out, and let $\omega_i$ be $1/\beta_i^2$ of those that are in, $1/h_i^2$ of "
    r"those that are open. With $S$, $K$ of these weights and $\sigma = \sin^2(\alpha/2)$: if for "
    r"some $\tau \ge 0$ $$A = (S + n - U)\, I - 2 K - \tau\,\Bigl(\frac{q q^{\mathsf T}}{|q|^2} - "
    r"(1 - \sigma)\, I\Bigr)$$ is positive definite, every rotation of the box costs more than "
    "$U$.",
    concludes=tuple(range(1, 7)),
    hypotheses=(NEAR, EACH, ROTATION, BOX, RISES, WHOLE, DEFINITE),
    setting=(
        r"In, out, open: $|b - R a| \le \beta$ in all of the box; $\ge \beta$; else, at most $h$.",
    ),
    source="elementary; Lagrange's multipliers",
    proof=proof,
    witness={LEVEL: -1, Q[0]: 1, P[0]: 1} | dict.fromkeys(matrix("R").diagonal(), 1),
    controls={
        "points that move by half as much": Mutation(
            at=2,
            proof=lambda: proof(chord=1),
            point={P[0]: 1, P[1]: 1, SINE: Fraction(1, 2), A[1]: 1},
        ),
        "a pair that is out for two": Mutation(
            at=3, proof=lambda: proof(outer=2), point={COSTS[1]: 1}
        ),
        "the other sign of the box": Mutation(
            at=5,
            proof=lambda: proof(_other_sign),
            point=FOUND,
        ),
        "a third pair that is out": Mutation(
            at=6, proof=lambda: proof(test=lambda level: half_turn_excluded(level, out=3))
        ),
    },
    not_claimed="That a box which the test leaves holds a better rotation: it is cut, and its "
    "parts are tested.",
    needs=("davenport", "chord_bound", "optimality_certificate", "elimination"),
    standard=("The triangle inequality.",),
    runs=("certreg.verify.davenport", "certreg.verify.proves_level"),
    not_in_coq="All of it: the checker in Coq reads no bounds of pairs.",
)
