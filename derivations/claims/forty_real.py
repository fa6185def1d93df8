"""Claim: all forty equilibria can be real, eight of them stable; six planes in integers."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import cache
from itertools import combinations, pairwise, product
from typing import Any

import numpy as np
import sympy

from certreg.geometry.so3 import body_frame, squared_norm
from certreg.objective.springs import Springs
from certreg.problem.problem import RegistrationProblem

from ..algebra import combination, facts, identity
from ..hypothesis import Standing, vanishing
from ..kernel import Claim, Mutation, Proof
from ..notation import Matrix, gradient, inner, quaternion, rotation, scalar, square, vector

Shipped = Callable[..., Any]
Line = tuple[int, ...]
Q = quaternion()
NORM = square(Q)
FOURTH = sum(entry**4 for entry in Q)
E = sympy.eye(3)
SIGNS = ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))  # q_i^2 = (1 + SIGNS[i] . r)/4
POINTS = tuple(tuple(s * int(k == j) for k in range(3)) for j in range(3) for s in (1, -1))
A, S, B = quaternion("a"), scalar("s"), vector("b")
ALPHA = [sum(a * row[j] for a, row in zip(A, SIGNS, strict=True)) for j in range(3)]
LEFT = sum(A) - 2 * S  # what is left of the squares of R_jj
OFFSETS = vanishing(
    r"$2 g b_j = 3 \alpha_j$, with $g = \sum_i a_i - 2 s$.",
    [2 * LEFT * b - 3 * alpha for b, alpha in zip(B, ALPHA, strict=True)],
    standing=Standing.CASE,
    solves=tuple(B),
    example={A[0]: 1, S: Fraction(1, 4)},
)


def lines() -> Iterator[Line]:
    """The vectors with entries 0, 1, -1 that are not zero, one of each pair of opposite ones."""
    for q in product((0, 1, -1), repeat=4):
        if next((entry for entry in q if entry), 0) == 1:
            yield q


@cache
def six_planes() -> Springs:
    """The shipped objective of +-e_j on the plane through the origin with the normal e_j."""
    points = np.array(POINTS, float)
    problem = RegistrationProblem(points, np.zeros((6, 3)), normals=np.abs(points))
    return Springs.of(problem)


def proof(curvature: Shipped = Springs.hessian, *, least: int = 2, share: int = 8) -> Proof:
    """The energy of six planes, forty lines and no other, their indices; springs for any a_i."""
    R = rotation(Q)
    yield identity(
        r"Six pairs: the points $\pm e_j$, each on the plane through the origin with the normal "
        r"$e_j$, the target $0$. The forces at $t = 0$ are opposite in pairs and add up to zero, "
        r"so $t = 0$ is best, and $f = 2 \sum_j R_{jj}^2$. Times $|q|^4$ that is $F = 8 \sum_i "
        r"q_i^4 - 2 |q|^4$.",
        2 * sum(R[j, j] ** 2 for j in range(3)),
        8 * FOURTH - least * NORM**2,
    )
    dF = gradient(8 * FOURTH - least * NORM**2, Q)
    yield identity(
        r"The minors of $[\,q \mid \nabla F\,]$ are $32\, q_i q_j\,(q_j^2 - q_i^2)$. They all "
        r"vanish, for complex $q$ as well, only where all $q_i$ that are not zero have the same "
        r"square: at the multiples of vectors with entries $0, 1, -1$. Up to the sign these are "
        r"$(3^4 - 1)/2 = 40$, and all are real.",
        [Q[i] * dF[j] - Q[j] * dF[i] for i, j in combinations(range(4), 2)],
        [32 * Q[i] * Q[j] * (Q[j] ** 2 - Q[i] ** 2) for i, j in combinations(range(4), 2)],
    )
    found = [_seen(curvature, q) for q in lines()]
    yield facts(
        r"At each of the forty `certreg.objective.springs.Springs`, made of the points and the "
        r"normals, finds the energy $8 \sum_i q_i^4/|q|^4 - 2$, a gradient along $q$, and a "
        r"Hessian whose determinant is not zero. Those with one entry that is not zero have "
        r"index 3, with two index 2, with three index 1, with four index 0: 4, 12, 16 and 8 "
        r"lines. The eight are stable, with the energy 0: turns by $120^\circ$ about the "
        r"diagonals of the cube, forwards and back.",
        found,
        [(Fraction(8, sum(map(abs, q))) - 2, True, 4 - sum(map(abs, q))) for q in lines()],
    )
    yield from _any_weights(share)


def _seen(curvature: Shipped, q: Line) -> tuple[Fraction, bool, int | None]:
    """Energy, whether the gradient is along q, and the index."""
    objective = six_planes()
    norm, level = squared_norm(q), 4 * objective.value(q)
    along = all(norm * g == level * e for g, e in zip(objective.gradient(q), q, strict=True))
    return objective.energy(q), along, index_of(curvature, objective, q)


def index_of(curvature: Shipped, objective: Springs, q: Line) -> int | None:
    """The number of negative eigenvalues of the Hessian in angles; None where it is singular.

    They are the positive roots of det(x I + H), all of whose roots are real: its changes of sign.
    """
    norm, frame = squared_norm(q), Matrix(body_frame(q))
    H = norm * (frame.T * Matrix(curvature(objective, q)) * frame)
    H -= 4 * objective.value(q) * norm * sympy.eye(3)
    coefficients = (-H).charpoly().all_coeffs()
    signs = [c > 0 for c in coefficients if c]
    return sum(a is not b for a, b in pairwise(signs)) if coefficients[-1] else None


def _any_weights(share: int) -> Proof:
    R = rotation(Q)
    yield identity(
        r"More generally, write $r_j = R_{jj}$, so that $4 q_i^2 = 1 + \epsilon_i \cdot r$ with "
        r"signs $\epsilon_i$, $|q| = 1$; here with $\hat R = |q|^2 R$.",
        [4 * q**2 for q in Q],
        [NORM + sum(sign * R[j, j] for j, sign in enumerate(row)) for row in SIGNS],
    )
    total: Any = sympy.Integer(0)
    for one in range(3):
        j, k = (one + 1) % 3, (one + 2) % 3
        plus, minus = E[:, j] + E[:, k], E[:, j] - E[:, k]
        same, other = S / 2 + ALPHA[one] / share, S / 2 - ALPHA[one] / share
        total += same * sum(inner(n, R * n) ** 2 for n in (plus, minus))
        total += other * (inner(plus, R * minus) ** 2 + inner(minus, R * plus) ** 2)
        total += LEFT * (R[one, one] + B[one] * NORM) ** 2
    weights = [a * q**4 for a, q in zip(A, Q, strict=True)]
    constant = 6 * S - sum(A) + LEFT * square(B)
    yield combination(
        r"For any $a_i$ let $\alpha_j = \sum_i a_i \epsilon_{ij}$, $g = \sum_i a_i - 2s$ and $2 g "
        r"b_j = 3\alpha_j$. Then $16 \sum_i a_i q_i^4$ plus a constant is the sum of $g\,(R_{jj} + "
        r"b_j)^2$ and, for each pair of axes with $n = e_j + e_k$, $m = e_j - e_k$ and the third "
        r"axis $l$, of $(\tfrac s2 + \tfrac{\alpha_l}{8})\,[(n \cdot R n)^2 + (m \cdot R m)^2]$ "
        r"and $(\tfrac s2 - \tfrac{\alpha_l}{8})\,[(n \cdot R m)^2 + (m \cdot R n)^2]$. If all "
        r"$a_i > 0$, take $4 s = \max |\alpha_l| \le \sum_i a_i$: no factor is negative, and these "
        r"are planes, each with its mirror image.",
        16 * sum(weights) + constant * NORM**2 - total,
        [(-NORM * R[j, j], part) for j, part in enumerate(OFFSETS.parts)],
    )


def _degenerate(objective: Springs, q: Line) -> Any:
    """A Hessian without its second part."""
    level, norm = Springs.value(objective, q), squared_norm(q)
    return Matrix(4, 4, lambda i, j: 4 * int(i == j) * level / norm)


CLAIM = Claim(
    name="forty_real",
    title="Forty real equilibria, eight of them stable",
    statement=r"Let the points $\pm e_j$ lie on the planes through the origin with normals $e_j$, "
    r"$j = 1, 2, 3$. The energy of the six springs is $F/|q|^4$ with $F = 8 \sum_i q_i^4 - 2 "
    r"|q|^4$. It has exactly 40 complex critical lines. All are real and none is degenerate; 8, "
    r"16, 12 and 4 of them have the index 0, 1, 2 and 3. For all $a_i > 0$, $\sum_i a_i q_i^4$ is "
    r"the energy of planes, up to a factor and a constant.",
    concludes=(1, 2, 3, 5),
    hypotheses=(OFFSETS,),
    setting=(r"A critical line is a $q \ne 0$, up to factors, with $\nabla F(q)$ along $q$.",),
    source="ours",
    proof=proof,
    controls={
        "without the constant": Mutation(at=1, proof=lambda: proof(least=0)),
        "a Hessian that is a multiple of I": Mutation(at=3, proof=lambda: proof(_degenerate)),
        "a fourth for an eighth": Mutation(at=5, proof=lambda: proof(share=4)),
    },
    not_claimed=r"That any of the eight is spurious: here all have the energy 0, and for other "
    r"$a_i > 0$ they share one energy, too. Stable ones that are spurious: claim "
    r"`stable_spurious`.",
    needs=("quaternions", "spring_translation", "quartic_relaxation"),
    runs=("certreg.objective.objective.Objective.hessian",),
    used_by=("derivations.spring_counterexamples",),
    not_in_coq="All of it: the theorems in Coq are about one weight for each pair.",
)
