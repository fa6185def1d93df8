"""Claim: all motions that bring the same pairs within their bounds have nearly one rotation."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

from certreg.geometry.so3 import body_frame, dot
from certreg.verify import LabelledStatement, RefusalError, weighed

from ..algebra import Square, facts, identity, nonnegative, positive
from ..hypotheses import definite
from ..hypothesis import Hypothesis, Standing, nonnegative_by, positive_by
from ..kernel import Claim, Mutation, Proof
from ..notation import Matrix, inner, quaternion, rotation, scalar, square, symmetric

Built = Callable[[], Any]
Test = Callable[[list[list[int]], Fraction, Fraction], bool]
SPREAD, BUDGET, COST = scalar("S"), scalar("B"), scalar("W")
TAU, SINE = scalar("tau"), scalar("s")
K, Q, P = symmetric("K", 4), quaternion(), quaternion("p")
VALUE = 2 * (P.T * K * P)[0]

WITHIN = nonnegative_by(
    r"$W = \sum w_i |r_i|^2$ is at most $B = \sum w_i \beta_i^2$: all pairs are within.",
    BUDGET - COST,
    standing=Standing.CASE,
    example={COST: 1, P[0]: 1, SPREAD: 1},
)
BEST = nonnegative_by(
    r"No translation is better than the best one: $W \ge S - 2 p^{\mathsf T} K p/|p|^2$.",
    (COST - SPREAD) * square(P) + VALUE,
    standing=Standing.CASE,
    example={SPREAD: 1, P[0]: 1},
)
ENOUGH = nonnegative_by(
    r"$2 p^{\mathsf T} K p \ge (S - B) |p|^2$.",
    VALUE - (SPREAD - BUDGET) * square(P),
    standing=Standing.CASE,
    example={SPREAD: 9, P[0]: 1, P[1]: 2, Q[0]: 1, TAU: 1, SINE: Fraction(1, 4)},
)


def reach_matrix() -> Any:
    """|q|^2 times (S - B - tau (1 - s)) I - 2 K + tau q q^T / |q|^2."""
    level = SPREAD - BUDGET - TAU * (1 - SINE)
    return square(Q) * (level * Matrix.eye(4) - 2 * K) + TAU * Q * Q.T


def _definite_by(built: Built) -> Hypothesis:
    A = built()
    return positive_by(
        r"$A \succ 0$, and so its form is positive at $p \ne 0$.",
        (P.T * A * P)[0],
        further=lambda point: definite(A, point),
    )


DEFINITE = _definite_by(reach_matrix)


def octahedron(bound: int) -> list[list[int]]:
    """Six corners at a distance of 4, each its own target, as the checker has them."""
    corners = [[4 * sign * (i == j) for j in range(3)] for i in range(3) for sign in (1, -1)]
    return [[*corner, *corner, 1, bound] for corner in corners]


def reached(rows: list[list[int]], tau: Fraction, sine: Fraction) -> bool:
    """Whether the checker proves that reach of the rows about the identity."""
    statement: Any = SimpleNamespace(sin2_half_angle=sine, tau=tau, fit={"pose": [1, 0, 0, 0]})
    try:
        squares, bound, K = weighed(rows, [row[6] for row in rows])
        return len([*LabelledStatement.reach(statement, squares - bound, squares, K, 6)]) == 1
    except RefusalError:
        return False


def proof(
    built: Built = reach_matrix,
    test: Test = reached,
    *,
    trace: int = 4,
) -> Proof:
    """What all motions within the bounds share; the angle; an octahedron."""
    n, m = square(Q), square(P)
    along = dot(tuple(Q), tuple(P))
    across = Matrix(body_frame(tuple(Q))).T * P
    yield nonnegative(
        "Let a motion with the rotation $R(p)$ bring all pairs of a set within their bounds. "
        r"With weights $w \ge 0$ its sum of squares is $W \le B$ (claim `weighted_refutation`), "
        r"and no less than with the best translation: $2 p^{\mathsf T} K p \ge (S - B)\, |p|^2$.",
        VALUE - (SPREAD - BUDGET) * m,
        [[BEST[0]], *([WITHIN[0], Square(entry)] for entry in P)],
    )
    given = DEFINITE if built is reach_matrix else _definite_by(built)
    yield positive(
        r"So $\tau\,\bigl((q \cdot p)^2 - (1 - s)\,|q|^2 |p|^2\bigr) = p^{\mathsf T}(|q|^2 A)\, p "
        r"+ |q|^2\,\bigl(2 p^{\mathsf T} K p - (S - B)\, |p|^2\bigr)$ is positive.",
        TAU * (along**2 - (1 - SINE) * n * m),
        [[given[0]], *([ENOUGH[0], Square(entry)] for entry in Q)],
    )
    yield identity(
        r"With $\sin^2(\theta/2) = |L(q)^{\mathsf T} p|^2/(|q|^2 |p|^2)$, as the trace of "
        r"$R(q)^{\mathsf T} R(p)$ is $3 - 4 \sin^2(\theta/2)$, that is $\tau\,|q|^2|p|^2\,(s - "
        r"\sin^2(\theta/2))$: if $\tau > 0$, then $\sin^2(\theta/2) < s$.",
        [along**2 - (1 - SINE) * n * m, inner(rotation(Q), rotation(P))],
        [SINE * n * m - square(across), 3 * n * m - trace * square(across)],
    )
    yield facts(
        r"The six corners $\pm 4 e_j$, each its own target, with bounds of $1$ and equal weights. "
        r"The function of the checker that decides the reach, which is given $\tau/S$, proves "
        r"$\sin^2(\theta/2) < 1/32$ about the identity with $5/4$, and not $1/64$, which a turn "
        r"about an axis reaches: it moves four corners by $8 \sin(\theta/2) = 1$.",
        [test(octahedron(1), Fraction(5, 4), Fraction(1, k)) for k in (32, 64)],
        [True, False],
    )


def _without_bounds() -> Any:
    return reach_matrix() + square(Q) * BUDGET * Matrix.eye(4)


def _cosine() -> Any:
    """A with s in the place of 1 - s."""
    return reach_matrix().xreplace({SINE: 1 - SINE})


CLAIM = Claim(
    name="angle_of_consensus",
    title="The rotation of every motion within the bounds",
    statement=r"Let weights $w \ge 0$ have the sums $S$ and $K$ over a set of pairs, as in claim "
    r"`weighted_refutation`, and $B = \sum w_i \beta_i^2$. If for some $\tau > 0$ $$A = (S - B)\, "
    r"I - 2 K + \tau\,\Bigl(\frac{q q^{\mathsf T}}{|q|^2} - (1 - s)\, I\Bigr)$$ is positive "
    "definite, then every rigid motion that brings all these pairs within their bounds has a "
    r"rotation whose angle $\theta$ to $R(q)$ has $\sin^2(\theta/2) < s$.",
    concludes=(1, 2, 3, 4),
    hypotheses=(WITHIN, BEST, DEFINITE, ENOUGH),
    setting=("$p$ is the quaternion of such a motion.",),
    source="elementary; Lagrange's multipliers",
    proof=proof,
    witness={TAU: 1, SINE: 2, Q[0]: 1, P[0]: 1},
    controls={
        "a matrix without the bounds": Mutation(
            at=2,
            proof=lambda: proof(_without_bounds),
            point={SPREAD: 12, BUDGET: Fraction(3, 8), TAU: 1, SINE: Fraction(1, 1000)}
            | {K[0, 0]: 6, K[1, 1]: -2, K[2, 2]: -2, K[3, 3]: -2, Q[0]: 1, P[0]: 8, P[1]: 1},
        ),
        "the square of the cosine for that of the sine": Mutation(
            at=2,
            proof=lambda: proof(_cosine),
            point={SPREAD: 1, TAU: 4, SINE: Fraction(1, 4), Q[0]: 1, P[0]: 1, P[1]: 1}
            | {K[0, 0]: Fraction(3, 2), K[1, 1]: Fraction(-1, 2), K[2, 2]: -1, K[3, 3]: -1},
        ),
        "the trace as 3 - 2 sin^2": Mutation(at=3, proof=lambda: proof(trace=2)),
        "a program that forgets the bounds": Mutation(
            at=4, proof=lambda: proof(test=lambda _, tau, s: reached(octahedron(0), tau, s))
        ),
    },
    not_claimed="That $s$ is as small as can be. Nor anything of motions that bring other pairs "
    "within their bounds.",
    needs=("davenport", "weighted_refutation", "optimality_certificate", "elimination"),
    runs=("certreg.verify.LabelledStatement.reach", "certreg.verify.weighed"),
    used_by=("certreg.certificate.producing_consensus.ConsensusProver",),
    not_in_coq="All of it: the checker in Coq reads no bounds of pairs.",
)
