"""Claim: springs that are nearly isotropic have exactly four equilibria."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations
from typing import Any

import sympy

from certreg.objective.quartics import MONOMIALS, hessian

from ..algebra import Square, identity, positive, quoted
from ..hypothesis import Standing, invertible, nonnegative_by, nonzero, positive_by
from ..kernel import Claim, Mutation, Proof
from ..notation import Matrix, body, quaternion, scalar, square, symmetric, vector

Second = Callable[..., Any]
Q, A = quaternion(), quaternion("a")
EPSILON, NORM = scalar("epsilon"), square(Q)
AXES = sympy.eye(4).columnspace()
APART = invertible(
    r"$a_w \ne a_x$.",
    A[0] - A[1],
    standing=Standing.CASE,
    example={Q[0]: 1, Q[1]: 1},
)
FIRST = invertible(r"$q_w \ne 0$.", Q[0], standing=Standing.CASE)
SECOND = invertible(r"$q_x \ne 0$.", Q[1], standing=Standing.CASE)
SMALL = positive_by(
    r"$2\epsilon < a_w - a_x$.",
    A[0] - A[1] - 2 * EPSILON,
    standing=Standing.CASE,
    example={A[0]: 2, EPSILON: 1, Q[1]: 1},
)
RISING = nonnegative_by(
    r"$\epsilon \ge 0$.",
    EPSILON,
    standing=Standing.CASE,
    example={EPSILON: -1, A[0]: -1, Q[0]: 1},
)
TURN, MASS, BOUND, V = symmetric("E"), scalar("M"), scalar("e"), vector("v")
DISTURBED = nonnegative_by(
    r"$v^{\mathsf T} E v \ge -e\, |v|^2$.",
    BOUND * square(V) + (V.T * TURN * V)[0],
    standing=Standing.CASE,
    example={V[0]: 1, MASS: 1, EPSILON: 1, TURN[0, 0]: -2},
)
SLIGHTLY = positive_by(
    r"$\epsilon e < M$.",
    MASS - EPSILON * BOUND,
    standing=Standing.CASE,
    example={V[0]: 1},
)
SOMEWHERE = nonzero(r"$v \ne 0$.", V, standing=Standing.CASE)


def isotropic(a: Any) -> list[Any]:
    """The coefficients of |q|^2 sum a_i q_i^2."""
    found: list[Any] = []
    for m in MONOMIALS:
        pairs = sorted(set(m))
        even = all(m.count(k) % 2 == 0 for k in pairs)
        found.append(sum(a[k] for k in pairs) if even else 0)
    return found


def proof(second: Second = hessian, *, sign: int = -1, room: int = 2) -> Proof:
    """Where one weight for each pair has equilibria, and what a small change does."""
    yield from _four(second, sign)
    yield quoted(
        r"So outside four small balls about the axes the gradient on the sphere is longer than a "
        r"positive constant, as the sphere is compact, and inside each the Hessian is invertible. "
        r"If $F$ and its first two derivatives change by little enough, the gradient stays "
        r"different from zero outside, and inside there stays exactly one zero, of the same index.",
        theorem="the implicit function theorem",
        source="the implicit function theorem",
    )
    yield _continuous()
    yield from _how_small(room)


def _four(second: Second, sign: int) -> Proof:
    D = sympy.diag(*A)
    along = (Q.T * D * Q)[0]
    yield identity(
        r"One weight for each pair: $F = |q|^2\, q^{\mathsf T} A q$ with a constant and $-2 K$ in "
        r"$A$ (claim `quartic_relaxation`), here in its axes, $A = \operatorname{diag}(a)$. The "
        r"square of the gradient of $q^{\mathsf T} A q$ along the unit sphere is four times $|q|^2 "
        r"|A q|^2 - (q^{\mathsf T} A q)^2 = \sum_{i < j} (a_i - a_j)^2 q_i^2 q_j^2$.",
        NORM * square(D * Q) - along**2,
        sum((A[i] + sign * A[j]) ** 2 * (Q[i] * Q[j]) ** 2 for i, j in combinations(range(4), 2)),
    )
    others = [
        [Square((A[i] - A[j]) * Q[i] * Q[j])]
        for i, j in combinations(range(4), 2)
        if (i, j) != (0, 1)
    ]
    yield positive(
        r"If the $a_i$ are different, it is positive wherever two entries of $q$ are not zero, $w$ "
        r"and $x$, say: the four axes are the only critical lines.",
        NORM * square(D * Q) - along**2,
        [[Square(APART[0]), Square(FIRST[0]), Square(SECOND[0])], *others],
    )
    found, expected = Matrix([]), []
    for k, axis in enumerate(AXES):
        frame = body(axis)
        H = frame.T * Matrix(second(isotropic(A), tuple(axis))) * frame - 4 * A[k] * sympy.eye(3)
        found = Matrix([*found, *H])
        rest = frame.T * (D - A[k] * sympy.eye(4)) * frame
        expected += list(2 * rest)
    yield identity(
        r"At the axis $k$ the Hessian $L^{\mathsf T} F'' L - 4 F I$ is $2 L^{\mathsf T} (A - a_k "
        r"I)\, L$, with the three $2 (a_j - a_k)$ on its diagonal: not singular, of index 0, 1, 2 "
        r"and 3.",
        list(found),
        expected,
    )


def _continuous() -> Any:
    S = MASS * sympy.eye(3) + EPSILON * TURN
    disturbed = [RISING[0], DISTURBED[0]]
    return positive(
        r"Now $W_i = m_i (I + \epsilon E_i)$. Then $S = M I + \epsilon E$, $E = \sum_i m_i E_i$, "
        r"is positive definite for small $\epsilon$: $v^{\mathsf T} S v > 0$ for $v \ne "
        r"0$, if $\epsilon e < M$. So $F$, a rational function of $\epsilon$ with $\det S$ "
        r"below, is near the isotropic one in all its 35 coefficients, and with it its "
        r"derivatives: if the eigenvalues of $K$ are different, there are exactly four equilibria "
        r"for all small $\epsilon$ (of either sign: $-E$ for $E$).",
        (V.T * S * V)[0],
        [
            *([SLIGHTLY[0], Square(e)] for e in SOMEWHERE.parts),
            disturbed,
        ],
    )


def _how_small(room: int) -> Proof:
    F = NORM * sum(a * q**2 for a, q in zip(A, Q, strict=True))
    F += EPSILON * sum(q**4 for q in Q)
    dF = [sympy.diff(F, q) for q in Q]
    yield identity(
        r"An example of how small. With $F = |q|^2 \sum_i a_i q_i^2 + \epsilon \sum_i q_i^4$, one "
        r"weight for each pair and the six planes of claim `forty_real`, the minors of $[\,q \mid "
        r"\nabla F\,]$ are $2 q_i q_j\,[(a_j - a_i) |q|^2 + 2\epsilon (q_j^2 - q_i^2)]$.",
        [Q[i] * dF[j] - Q[j] * dF[i] for i, j in combinations(range(4), 2)],
        [
            2 * Q[i] * Q[j] * ((A[j] - A[i]) * NORM + 2 * EPSILON * (Q[j] ** 2 - Q[i] ** 2))
            for i, j in combinations(range(4), 2)
        ],
    )
    w, x, y, z = Q
    grown = room * EPSILON
    yield positive(
        r"While $2\epsilon$ is less than every distance of the $a_i$ the bracket is not zero, here "
        r"of $w$ and $x$ with $a_w > a_x$: there are the four axes and no other. Where $2\epsilon "
        r"> a_w - a_x$ there is another, with $q_x^2 - q_w^2 = (a_w - a_x)/2\epsilon$, $|q| = 1$.",
        (A[0] - A[1]) * NORM + grown * (w**2 - x**2),
        [
            [SMALL[0], Square(FIRST[0])],
            *([SMALL[0], Square(e)] for e in (x, y, z)),
            [4, RISING[0], Square(w)],
            *([2, RISING[0], Square(e)] for e in (y, z)),
        ],
    )


def _doubled(quartic: Any, q: Any) -> Any:
    return 2 * Matrix(hessian(quartic, q))


CLAIM = Claim(
    name="near_isotropy",
    title="Near one weight for each pair: exactly four",
    statement=r"Let $W_i = m_i (I + \epsilon E_i)$, and let the eigenvalues of Davenport's $K$ of "
    r"the weights $m_i$ be different. For all $\epsilon$ small enough there are exactly four real "
    r"equilibria, of index 0, 1, 2 and 3. For $F = |q|^2 \sum_i a_i q_i^2 + \epsilon \sum_i q_i^4$ "
    r"it is enough that $0 \le 2\epsilon < |a_i - a_j|$ for all $i \ne j$.",
    concludes=(1, 2, 3, 5, 6, 7),
    hypotheses=(APART, FIRST, SECOND, DISTURBED, SLIGHTLY, SOMEWHERE, SMALL, RISING),
    setting=(r"$E_i$ are symmetric; $M$ is the sum of the $m_i$.",),
    source="ours",
    proof=proof,
    controls={
        "sums of eigenvalues for differences": Mutation(at=1, proof=lambda: proof(sign=1)),
        "twice the second derivatives": Mutation(at=3, proof=lambda: proof(_doubled)),
        "half the room": Mutation(
            at=7,
            proof=lambda: proof(room=4),
            point={A[0]: 3, EPSILON: 1, Q[0]: 1, Q[1]: 3},
        ),
    },
    not_claimed=r"How small $\epsilon$ must be for other springs.",
    needs=("quartic_relaxation", "forty_real", "discriminant", "real_lines"),
    runs=("certreg.objective.quartics.hessian",),
    used_by=("certreg.objective.springs.Springs.isotropic_like",),
    not_in_coq="All of it: the theorems in Coq are about one weight for each pair.",
)
