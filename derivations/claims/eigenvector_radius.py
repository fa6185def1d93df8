"""Claim: how far the points of isotropic springs may move, by the gap of Davenport's matrix."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import sympy

from certreg.verify import davenport, proves_separation, room_of_eigenvector

from ..algebra import combination, facts, identity, nonnegative, positive, quoted
from ..hypothesis import Standing, nonnegative_by, positive_by, vanishing
from ..kernel import Claim, Mutation, Proof
from ..notation import Matrix, matrix, quaternion, scalar, square, symmetric, vector
from ..shipped import UNIT, checked_davenport, checked_matrix

Room = Callable[[Fraction, Fraction, Fraction], Fraction]
Separates = Callable[[Any, int, Any, int], bool]
C, S = scalar("c"), scalar("s")  # cos phi, sin phi
FIRST, OTHER, THEN = scalar("kappa"), scalar("lambda"), scalar("kappa'")
D = symmetric("D", 2)
G, M, SINE, ANGLE, LEFT = (scalar(name) for name in ("g", "m", "sin_a", "b", "sin_ab"))
LITTLE = Fraction(1, 2**50)

TURNED = vanishing(
    r"$p' = \cos\varphi\, p + \sin\varphi\, q$ is an eigenvector of $K + D$.",
    (sympy.diag(FIRST, OTHER) + D) * Matrix([C, S]) - THEN * Matrix([C, S]),
    standing=Standing.CASE,
    solves=tuple(D),
)
ALONE = positive_by("$g > 0$.", G, standing=Standing.CASE)
GAP = nonnegative_by(
    r"$\kappa - q^{\mathsf T} K q \ge g$.", FIRST - OTHER - G, standing=Standing.CASE
)
SIZE = nonnegative_by(
    r"$\cos\varphi \sin\varphi$ times $\kappa - q^{\mathsf T} K q$ is at most $m$.",
    M - C * S * (FIRST - OTHER),
    standing=Standing.CASE,
)
ACUTE = nonnegative_by(
    r"$\cos\varphi \sin\varphi \ge 0$ (choose the sign of $p'$).",
    C * S,
    standing=Standing.CASE,
    example={C: 1, S: -1, FIRST: 10, M: -10, G: 1, ANGLE: 21, SINE: 1, LEFT: -20},
)
ROOM = nonnegative_by(r"$2 m \le g\, (\sin a - b)$.", G * (SINE - ANGLE) - 2 * M)
AWAY = positive_by("$b > 0$.", ANGLE)
BELOW = nonnegative_by(r"$\sin a \le 1$.", 1 - SINE, standing=Standing.CASE)
CHORD = nonnegative_by(
    r"$\sin(a - b) \ge \sin a - b$.", LEFT - SINE + ANGLE, standing=Standing.CASE
)


def proof(
    room: Room = room_of_eigenvector,
    separates: Separates = proves_separation,
    *,
    size: int = 1,
    half: int = 2,
) -> Proof:
    """K is linear; of rank one; the eigenvector's turn; the angle; and the program."""
    yield from _linear(size)
    yield from _alone(separates)
    old = sympy.diag(FIRST, OTHER)
    new, across = Matrix([C, S]), Matrix([-S, C])
    yield combination(
        r"Let $K p = \kappa p$, and let $p'$ be a unit eigenvector of $K + D$; in the plane of "
        r"both, $q \perp p$ and $q' = -\sin\varphi\, p + \cos\varphi\, q \perp p'$ are of unit "
        r"length. Then $0 = p'^{\mathsf T} (K + D) q'$, and as $p^{\mathsf T} K q = 0$: "
        r"$\cos\varphi \sin\varphi\, (\kappa - q^{\mathsf T} K q) = -p'^{\mathsf T} K q' = "
        r"p'^{\mathsf T} D q'$, which is at most $m$ if $|D| \le m$.",
        C * S * (FIRST - OTHER) - (new.T * D * across)[0],
        [(S, TURNED[0]), (-C, TURNED[1])],
    )
    yield identity(
        r"There $-p'^{\mathsf T} K q'$ is what it was said to be.",
        -(new.T * old * across)[0],
        C * S * (FIRST - OTHER),
    )
    yield positive(
        r"If $2 m \le g (\sin a - b)$, then $2 m < g$.",
        G - 2 * M,
        [[ROOM[0]], [ALONE[0], BELOW[0]], [ALONE[0], AWAY[0]]],
    )
    yield quoted(
        r"No eigenvalue of $K + t D$ is off the one of $K$ by more than $t m$. So for $0 \le t \le "
        r"1$ the largest one is alone by $g - 2 t m > 0$, and its line turns continuously. From "
        r"$\varphi = 0$ on, as $\sin 2\varphi \le 2 t m/g < 1$ all the time, $2 \varphi$ stays "
        r"below $90$ degrees.",
        theorem="Weyl's inequality",
        source="[HornJohnson2012], Weyl's inequality",
    )
    yield nonnegative(
        r"The optimum turns by $2\varphi$, the angle of the rotations being twice that of the "
        r"quaternions. With $\sin(a - b) \ge \sin a - b$ for $0 \le b \le a$ (as $\cos \le 1$), "
        r"$\sin 2\varphi \le 2m/g \le \sin(a - b)$, here times $g$: as $a \le 90$ degrees, $2 "
        r"\varphi \le a - b$. The old optimum is within $b$ of $R$, so the new one is within $a$.",
        G * (LEFT - half * C * S),
        [[ALONE[0], CHORD[0]], [ROOM[0]], [2, SIZE[0]], [2, ACUTE[0], GAP[0]]],
    )
    yield facts(
        r"`certreg.verify.room_of_eigenvector` at $s = 3/5$ and $5/13$, where $\sin a = 2 s "
        r"\sqrt{1 - s^2}$ is $24/25$ and $120/169$: below $g (\sin a - b)/2$, and by very little.",
        [_within(room, *at) for at in _cases()],
        [True, True],
    )


def _linear(size: int) -> Proof:
    A, B, t = matrix("A"), matrix("B"), scalar("t")
    b, c, e, h = (vector(name) for name in "bceh")
    yield identity(
        r"$K(C)$, from `certreg.verify.davenport` run on symbols, is linear in $C$.",
        checked_davenport(A + t * B),
        checked_davenport(A) + t * checked_davenport(B),
    )
    K = checked_davenport(b * c.T)
    yield identity(
        r"For $C = b c^{\mathsf T}$: $K^2 = |b|^2 |c|^2 I$ and $\operatorname{tr} K = 0$. So $K$ "
        r"has the eigenvalues $|b||c|$ and $-|b||c|$, twice each, and $|K| = |b||c|$.",
        [K * K, K.trace()],
        [size * square(b) * square(c) * sympy.eye(4), 0],
    )
    yield identity(
        r"The new $C$ is $\sum_i w_i (y_i + dy_i)(x_i + dx_i)^{\mathsf T}$, all less their means. "
        r"So $D$, the change of $K$, is a sum of those of rank one, and $|D| \le m = \sum_i w_i "
        r"(|y_i||dx_i| + |dy_i||x_i| + |dx_i||dy_i|)$. By Cauchy and Schwarz that is at most $dx "
        r"\sqrt{M \sum_i w_i |y_i|^2} + dy \sqrt{M \sum_i w_i |x_i|^2} + M\, dx\, dy$ if no point "
        r"moves by more than $dx$, $dy$: taking means away makes sums of squares no larger.",
        (b + e) * (c + h).T - b * c.T,
        b * h.T + e * c.T + e * h.T,
    )


def _alone(separates: Separates) -> Proof:
    K, q, p = symmetric("K", 4), quaternion(), quaternion("p")
    level, along = scalar("level"), scalar("mu")
    yield identity(
        r"`certreg.verify.proves_level`, run on symbols, decides whether $A$ is positive definite: "
        r"$p^{\mathsf T} A p = \ell\, |p|^2 - |q|^2 p^{\mathsf T} K p + \mu\, (q \cdot p)^2$. "
        r"Where it is, $p^{\mathsf T} K p < \ell/|q|^2$ for unit $p \perp q$, so that the second "
        r"eigenvalue of $K$ is below that (Courant, Fischer).",
        (p.T * checked_matrix(K, q, level, along) * p)[0],
        level * square(p) - square(q) * UNIT * (p.T * K * p)[0] + along * (q.T * p)[0] ** 2,
    )
    tilted = davenport([[3, 0, 0], [0, 2, 0], [0, 0, 1]])
    yield facts(
        r"`certreg.verify.proves_separation` for $C = \operatorname{diag}(3, 2, 1)$, of which $K$ "
        r"has the eigenvalues $6, 0, -2, -4$: at $q = (1, 0, 0, 0)$ the level $1$ is proved, and "
        r"$0$ is not; nor are they at the second eigenvector, where $p^{\mathsf T} K p = 6$.",
        [separates(tilted, 1, q, level) for q in ((1, 0, 0, 0), (0, 1, 0, 0)) for level in (1, 0)],
        [True, False, False, False],
    )


def _cases() -> tuple[tuple[Fraction, Fraction], ...]:
    return (Fraction(3, 5), Fraction(24, 25)), (Fraction(5, 13), Fraction(120, 169))


def _within(room: Room, s: Fraction, sine: Fraction) -> bool:
    """Whether the room is just below what is proved to be enough."""
    g, angle = Fraction(4), Fraction(1, 8)
    enough = g * (sine - angle) / 2
    return 0 < enough - room(g, angle, s) < LITTLE


def _generous(g: Fraction, angle: Fraction, s: Fraction) -> Fraction:
    return room_of_eigenvector(g, angle, s) + LITTLE


def _trusting(*_parts: Any) -> bool:
    return True


CLAIM = Claim(
    name="eigenvector_radius",
    title="How far the points may move before the eigenvector has turned",
    statement=r"Let the largest eigenvalue of $K$ be above the second by at least $g > 0$, its "
    r"rotation within $b > 0$ of $R$, and let points move. With $s = \sin(a/2)$, $a \le 90$ "
    r"degrees, if all about the means $$\sum_i w_i \bigl(|y_i||dx_i| + |dy_i||x_i| + "
    r"|dx_i||dy_i|\bigr) \le \tfrac12 g\, (\sin a - b), \qquad \sin a = 2 s \sqrt{1 - s^2},$$ the "
    r"moved points have one optimum, within the angle $a$ of $R$.",
    concludes=(1, 2, 3, 4, 5, 6, 7, 8, 10, 11),
    hypotheses=(TURNED, ALONE, GAP, SIZE, ACUTE, ROOM, AWAY, BELOW, CHORD),
    source="[Davis1970], for one eigenvector; [HornJohnson2012], Weyl's inequality",
    proof=proof,
    controls={
        "twice the square of K": Mutation(at=2, proof=lambda: proof(size=2)),
        "a checker that takes any eigenvector for alone": Mutation(
            at=5, proof=lambda: proof(separates=_trusting)
        ),
        "a turn by four times the angle": Mutation(
            at=10,
            proof=lambda: proof(half=4),
            point={
                C: Fraction(4, 5),
                S: Fraction(3, 5),
                FIRST: 1,
                G: 1,
                M: Fraction(12, 25),
                SINE: 1,
                ANGLE: Fraction(1, 25),
                LEFT: Fraction(24, 25),
            },
        ),
        "a little more room": Mutation(at=11, proof=lambda: proof(_generous)),
    },
    not_claimed=r"That this is the largest such motion. Weights do not move.",
    needs=("davenport", "quaternions", "optimality_certificate"),
    runs=(
        "certreg.verify.davenport",
        "certreg.verify.proves_level",
        "certreg.verify.proves_separation",
        "certreg.verify.room_of_eigenvector",
    ),
    used_by=(
        "certreg.verify.IsotropicStatement.prove",
        "certreg.certificate.radius.isotropic_radius",
    ),
    standard=("The inequality of Cauchy and Schwarz; the theorem of Courant and Fischer.",),
    not_in_coq="All of it: the checker in Coq reads no radius.",
)
