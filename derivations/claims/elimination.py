"""Claim: fraction-free elimination meets the leading minors, and their signs decide definiteness.

About the shipped eliminations themselves: the compiled functions are run on polynomials.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy

from certreg.exact.elimination import is_positive_definite

from ..algebra import Given, Square, identity, nonnegative
from ..kernel import Claim, Proof
from ..notation import Matrix, scalar
from ..shipped import checked_elimination, pivots_of

SIZE = 4
Elimination = Callable[[Any], bool]


def leading_minor(A: Any, k: int) -> Any:
    """The determinant of the first k rows and columns."""
    return A[:k, :k].det(method="berkowitz") if k else sympy.Integer(1)


def last_cofactors(A: Any, k: int) -> Any:
    """The vector x, zero beyond k, with A_k x = D_k e_k: cofactors of the k-th row of the block."""
    block = A[:k, :k]
    values = [block.cofactor(k - 1, j, method="berkowitz") for j in range(k)]
    return Matrix([*values, *[0] * (SIZE - k)])


def eliminated_row(A: Any, k: int, x: Any) -> Any:
    """y_k: the minor of rows 1..k, columns 1..k-1 and j, summed over j with the weights x_j."""
    columns = [A[:k, [*range(k - 1), j]] for j in range(k - 1, SIZE)]
    minors = [block.det(method="berkowitz") for block in columns]
    return sum(minor * x[k - 1 + j] for j, minor in enumerate(minors))


def proof(
    elimination: Elimination = is_positive_definite,
    checker: Elimination = checked_elimination,
    minors: Callable[[Any, int], Any] = leading_minor,
) -> Proof:
    """The pivots, the sum of squares, and the converse, for a symmetric 4x4 matrix of symbols."""
    A = Matrix(SIZE, SIZE, lambda i, j: scalar(f"a_{min(i, j) + 1}{max(i, j) + 1}"))
    x = Matrix([scalar(f"x_{k}") for k in range(1, SIZE + 1)])
    D = [minors(A, k) for k in range(SIZE + 1)]
    yield identity(
        r"The shipped function `certreg.exact.is_positive_definite`, run on a symmetric "
        r"$4\times4$ matrix $A$ of symbols, asks for the sign of four numbers. They are the "
        r"leading principal minors $D_1, \ldots, D_4$ of $A$; every division on the way left no "
        r"remainder, so that on integers all is exact.",
        pivots_of(elimination, A),
        D[1:],
    )
    yield identity(
        r"So does the elimination of the trusted checker, `certreg.verify.positive_definite`, "
        r"which is written independently: the same four minors.",
        pivots_of(checker, A),
        D[1:],
    )
    yield from _sylvester(A, x, D)


def _sylvester(A: Any, x: Any, D: list[Any]) -> Proof:
    y = [eliminated_row(A, k, x) for k in range(1, SIZE + 1)]
    form = (x.T * A * x)[0]
    positive = [Given(d, f"$D_{k} > 0$") for k, d in enumerate(D)]
    yield nonnegative(
        r"If all four minors are positive, $A$ is positive definite: with $y_k$ the $k$-th row "
        r"after elimination applied to $x$, $\;x^{\mathsf T} A x = \sum_k y_k^2 / (D_{k-1} D_k)$, "
        r"$D_0 = 1$, here multiplied by $D_1 D_2 D_3$, and $y_4 = D_4 x_4$. Where the sum "
        r"vanishes, $y_4, y_3, y_2, y_1$ do, and as $y_k$ is $D_k x_k$ and terms in later "
        r"entries, so do $x_4, x_3, x_2, x_1$.",
        form * D[1] * D[2] * D[3],
        [
            (Square(y[0]), positive[2], positive[3]),
            (Square(y[1]), positive[3]),
            (Square(y[2]), positive[1]),
            (Square(x[3]), positive[1], positive[2], positive[4]),
        ],
    )
    yield identity(
        r"and indeed $y_k = D_k x_k$ when the entries of $x$ after the $k$-th are zero.",
        [y[k].subs({x[j]: 0 for j in range(k + 1, SIZE)}) for k in range(SIZE)],
        [D[k + 1] * x[k] for k in range(SIZE)],
    )
    vectors = [last_cofactors(A, k) for k in range(1, SIZE + 1)]
    yield identity(
        r"Conversely, let $x$ be the cofactors of the last row of the leading $k\times k$ block. "
        r"Then $x^{\mathsf T} A x = D_{k-1} D_k$ and $x_k = D_{k-1}$. If $A$ is positive definite "
        r"then $D_0 = 1 > 0$ and, step by step, $x \ne 0$ and $D_k > 0$.",
        [[(v.T * A * v)[0], v[k]] for k, v in enumerate(vectors)],
        [[D[k] * D[k + 1], D[k]] for k in range(SIZE)],
    )


def _forgetful(rows: Any) -> bool:
    """Elimination that divides by the pivot before the last but one: never."""
    rows = [list(row) for row in rows]
    for k in range(len(rows)):
        if rows[k][k] <= 0:
            return False
        for row in rows[k + 1 :]:
            factor = row[k]
            for j in range(k + 1, len(rows)):
                row[j] = row[j] * rows[k][k] - factor * rows[k][j]
    return True


def _one_short(rows: Any) -> bool:
    """Elimination that updates one column less: j from k + 2 on."""
    rows = [list(row) for row in rows]
    previous: Any = 1
    for k in range(len(rows)):
        pivot = rows[k][k]
        if pivot <= 0:
            return False
        for row in rows[k + 1 :]:
            factor = row[k]
            for j in range(k + 2, len(rows)):
                row[j] = row[j] * pivot - factor * rows[k][j]
        previous = pivot
    return previous is not None


CLAIM = Claim(
    name="elimination",
    title="Elimination decides definiteness",
    statement=r"The pivots that the shipped fraction-free eliminations meet on a symmetric "
    r"$4\times4$ matrix $A$ of integers are its leading principal minors $D_1, \ldots, D_4$, and "
    r"$A$ is positive definite if and only if all four are positive. The answer is exact.",
    assumptions=(
        r"$A$ is symmetric, $4\times4$; for $3\times3$ let $a_{44} = 1$, with zeros beside it.",
    ),
    source="[Bareiss1968], Sylvester's criterion",
    proof=proof,
    controls={
        "an elimination that forgets to divide by the previous pivot": lambda: proof(
            elimination=_forgetful
        ),
        "a checker that updates one column less": lambda: proof(checker=_one_short),
        "the minors of the last rows and columns": lambda: proof(
            minors=lambda A, k: leading_minor(A[::-1, ::-1], k)
        ),
    },
    not_claimed=r"That a semidefinite matrix is recognised: with a zero pivot the answer is no, "
    r"which then means *not positive definite* and nothing more.",
    used_by=("certreg.exact.elimination.is_positive_definite", "certreg.verify.positive_definite"),
    coq=(
        "positive4_iff",
        "positive3_definite",
        "zpositive4_real",
        "solid_real",
    ),
    not_in_coq=(
        "That the Python code computes these numbers: the theorems are about the "
        "eliminations of the checker in Coq."
    ),
)
