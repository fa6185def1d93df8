"""Claim: at most four equilibria, if ten quadratic forms are independent, seen modulo a number."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import sympy

from certreg.verify import coefficients, has_rank

from ..algebra import combination, contraction, facts, identity
from ..hypothesis import Standing, invertible, vanishing
from ..kernel import Claim, Mutation, Proof, Step
from ..notation import Matrix, entry, inner, matrix, quaternion, rotation, square
from ..rationals import rank
from ..shipped import checked_coefficients

Coefficients = Callable[[Any, Sequence[Any]], Any]
SIZE, PAIRS = 10, [(i, j) for i in range(4) for j in range(i, 4)]
Q = quaternion()
MONOMIALS = Matrix([Q[i] * Q[j] for i, j in PAIRS])
FORMS, INVERSE = matrix("F", SIZE), matrix("P", SIZE)
INDEPENDENT = invertible(
    r"The $10\times10$ matrix $F$ of the coefficients is invertible, $F P = I$.",
    FORMS,
    INVERSE,
    example={Q[0]: 1, entry("e", 1): 1},
)
VALUES = (MONOMIALS.T * FORMS).T
UNITS = {A[k, k]: 1 for A in (FORMS, INVERSE) for k in range(SIZE)}  # F = P = I
RESTING = vanishing(
    "The six torques vanish: an equilibrium.",
    VALUES[:6, :],
    standing=Standing.CASE,
    example={FORMS[k, k]: 1 for k in range(SIZE)}
    | {INVERSE[k, k]: 1 for k in range(SIZE)}
    | dict.fromkeys(Q, 1)
    | {entry("e", 1): 1},
)
IN_THE_CHART = vanishing(
    r"The quaternion is scaled to $a\cdot q = 1$, so that the last four forms are the $q_k$.",
    VALUES[6:, :] - Q,
    standing=Standing.CASE,
    example=UNITS | {Q[2]: 2, entry("e", 8): 1},
)
OUTSIDE = vanishing(
    r"$a\cdot q = 0$, so that the last four forms vanish.",
    VALUES[6:, :],
    standing=Standing.CASE,
    example=UNITS | {Q[2]: 2},
)
FEW = [[1, 0, 0], [0, 2, 0], [0, 0, 4]]  # exactly four equilibria: the axes' half turns, and I
MANY = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]  # infinitely many
CHART = (1, 2, 3, 5)  # orthogonal to none of the four
PRIME, COMPOSITE = 2**31 - 1, 101 * 103


def proof(shipped: Coefficients = checked_coefficients, bound: int = 4) -> Proof:
    """The ten forms; that they give all quadratic forms; at most four points; the code."""
    yield from _forms(shipped)
    yield from _spanned()
    yield from _decided(bound)


def _upper(A: Any) -> list[Any]:
    return [A[i, j] for i in range(3) for j in range(i + 1, 3)]


def _forms(shipped: Coefficients) -> Proof:
    C, a = matrix("C"), quaternion("a")
    R = rotation(Q)
    found = shipped(C, a)
    body, world = R.T * C - C.T * R, R * C.T - C * R.T
    yield identity(
        r"The checker's $10\times10$ matrix, made from the symbols of $C$ and of the chart $a$, "
        r"holds the coefficients of ten quadratic forms in $q$: the entries of $\hat R^{\mathsf T} "
        r"C - C^{\mathsf T}\hat R$ and of $\hat R C^{\mathsf T} - C \hat R^{\mathsf T}$ above the "
        r"diagonal, and $q_k\,(a\cdot q)$.",
        (MONOMIALS.T * found).T,
        [*_upper(body), *_upper(world), *(Q * inner(a, Q))],
    )
    yield identity(
        r"The first three are the torque of the springs in the body's frame, the next three in the "
        r"world's: $\hat R\,(\hat R^{\mathsf T} C - C^{\mathsf T}\hat R)\,\hat R^{\mathsf T} = "
        r"|q|^4\,(C \hat R^{\mathsf T} - \hat R C^{\mathsf T})$. At an equilibrium all six vanish, "
        r"and elsewhere they do not (claim `eigenvectors`).",
        R * body * R.T,
        square(Q) ** 2 * -world,
    )


def _spanned() -> Proof:
    e = Matrix([entry("e", k) for k in range(1, SIZE + 1)])
    outer = MONOMIALS * e.T
    lifted = INVERSE * e
    yield combination(
        r"Let $m$ be the ten monomials $q_i q_j$ and $F$ such a matrix, $m^{\mathsf T} F$ the "
        r"values of the forms. If $F$ has an inverse $P$, every monomial is a combination of the "
        r"forms: for every $e$, $m\cdot e - (m^{\mathsf T} F)(P e)$ is a combination of the "
        r"entries of $F P - I$.",
        inner(MONOMIALS, e) - inner(VALUES, lifted),
        contraction(-outer, INDEPENDENT),
    )
    linear = inner(Q, lifted[6:, :])
    yield combination(
        r"So at an equilibrium with $a\cdot q = 1$ every $q_i q_j$ is a linear function of $q$, "
        r"the same at all of them: $m\cdot e = \sum_k q_k\,(P e)_{6+k}$, as the last four forms "
        r"are the $q_k$. And $1 = a\cdot q$ is one as well. So modulo the equations every "
        r"polynomial is a combination of four, the quotient ring has at most four dimensions, and "
        r"the equations have at most four solutions, complex ones and multiplicities counted.",
        inner(MONOMIALS, e) - linear,
        [
            *contraction(-outer, INDEPENDENT),
            *zip(lifted[:6, :], RESTING.parts, strict=True),
            *zip(lifted[6:, :], IN_THE_CHART.parts, strict=True),
        ],
    )
    diagonal = Matrix([int(i == j) for i, j in PAIRS])
    top = INVERSE * diagonal
    yield combination(
        r"An equilibrium with $a\cdot q = 0$ would have $|q|^2 = 0$, a sum of monomials: there is "
        r"none. Every other one can be scaled to $a\cdot q = 1$; $q$ and $-q$ are the same "
        r"rotation.",
        square(Q),
        [
            *contraction(-MONOMIALS * diagonal.T, INDEPENDENT),
            *zip(top[:6, :], RESTING.parts, strict=True),
            *zip(top[6:, :], OUTSIDE.parts, strict=True),
        ],
    )


def _decided(bound: int) -> Proof:
    few, many = coefficients(FEW, CHART), coefficients(MANY, CHART)
    yield facts(
        r"The checker looks for ten pivots that have an inverse modulo a number. Then the "
        r"determinant has one, and is not zero; whether the number is a prime does not matter. An "
        r"example on either side: for $C = \operatorname{diag}(1, 2, 4)$ it finds them modulo "
        r"$2^{31} - 1$ and modulo $101 \cdot 103$, for $C = I$, with infinitely many equilibria, "
        r"modulo neither; the ranks, in fractions, are $10$ and less.",
        [
            *(has_rank(few, SIZE, m) for m in (PRIME, COMPOSITE)),
            *(has_rank(many, SIZE, m) for m in (PRIME, COMPOSITE)),
            rank(few),
            rank(many) < SIZE,
        ],
        [True, True, False, False, SIZE, True],
    )
    yield _attained(bound)


def _attained(bound: int) -> Step:
    C, four = Matrix(FEW), sympy.eye(4).columnspace()
    torques = [rotation(q).T * C - C.T * rotation(q) for q in four]
    return facts(
        r"Four is attained: for $C = \operatorname{diag}(1, 2, 4)$ the identity and the half turns "
        r"about the three axes exert no torque.",
        [*(torque == sympy.zeros(3) for torque in torques), len(four) <= bound],
        [True] * 5,
    )


def _of_the_transpose(C: Any, chart: Any) -> Any:
    return checked_coefficients(C.T, chart)


def _other_chart(C: Any, chart: Any) -> Any:
    return checked_coefficients(C, Matrix([-chart[0], *chart[1:]]))


CLAIM = Claim(
    name="equilibrium_count",
    title="At most four, from the torque alone",
    statement=r"Write the torque of the springs at $R(q)$ in the body's and in the world's frame "
    r"as six quadratic forms in $q$, and let $a$ be a vector of four integers. If the $10\times10$ "
    r"matrix of the coefficients of these and of the four forms $q_k\,(a\cdot q)$ is invertible, "
    r"there are at most four equilibrium rotations, complex ones and multiplicities counted. It is "
    r"invertible if it is so modulo any integer, which the checker decides of its own matrix.",
    concludes=(1, 2, 3, 4, 5, 6, 7),
    hypotheses=(INDEPENDENT, RESTING, IN_THE_CHART, OUTSIDE),
    source="ours",
    proof=proof,
    controls={
        "the torques of the transpose of C": Mutation(
            at=1, proof=lambda: proof(shipped=_of_the_transpose)
        ),
        "another chart than the one that is told": Mutation(
            at=1, proof=lambda: proof(shipped=_other_chart)
        ),
        "at most three": Mutation(at=7, proof=lambda: proof(bound=3)),
    },
    not_claimed=r"That there are four real ones, or how many: that is `classification`. That the "
    r"matrix is invertible where there are only finitely many: a half turn needs another chart "
    r"than $(1, 0, 0, 0)$.",
    needs=("quaternions", "torque", "eigenvectors"),
    standard=(
        (
            "Polynomials modulo equations form a space of as many dimensions as the equations have "
            "solutions in complex numbers, multiplicities counted."
        ),
    ),
    runs=("certreg.verify.coefficients",),
    used_by=(
        "certreg.verify.has_rank",
        "certreg.verify.CountStatement",
        "certreg.certificate.count.CountBody",
    ),
    not_in_coq="The theorem is not stated in Coq: `certreg verify --coq` does not know this kind.",
)
