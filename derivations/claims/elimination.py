"""Claim: fraction-free elimination meets the leading minors, and their signs decide definiteness.

About the shipped eliminations themselves: the compiled functions are run on polynomials.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy

from certreg.exact.elimination import is_positive_definite
from certreg.verify import positive_definite

from ..algebra import Square, cases, identity, positive
from ..hypothesis import Standing, invertible, positive_by
from ..kernel import Claim, Mutation, Proof, Step
from ..notation import Matrix, entry
from ..shipped import pivots_of, upper

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


A = Matrix(SIZE, SIZE, lambda i, j: entry("a", min(i, j) + 1, max(i, j) + 1))
X = Matrix([entry("x", k) for k in range(1, SIZE + 1)])
MINORS = positive_by(
    r"The minors $D_1, \ldots, D_4$ are positive.",
    [leading_minor(A, k) for k in range(1, SIZE + 1)],
    standing=Standing.CASE,
    prepare=lambda point: {A[k, k]: abs(point[A[k, k]]) + 10 for k in range(SIZE)},
)
LAST = tuple(
    invertible(
        f"$x_{k} \\ne 0$, and the entries after it are zero.",
        x,
        standing=Standing.CASE,
        example={A[j, j]: 1 for j in range(SIZE)},
    )
    for k, x in enumerate(X, 1)
)


def proof(
    elimination: Elimination = is_positive_definite,
    checker: Elimination = positive_definite,
    minors: Callable[[Any, int], Any] = leading_minor,
) -> Proof:
    """The pivots, the sum of squares, and the converse, for a symmetric 4x4 matrix of symbols."""
    D = [minors(A, k) for k in range(SIZE + 1)]
    yield identity(
        r"The shipped function `certreg.exact.elimination.is_positive_definite`, run on a "
        r"symmetric $4\times4$ matrix $A$ of symbols, asks for the sign of four numbers. They are "
        r"the leading principal minors $D_1, \ldots, D_4$ of $A$; every division on the way left "
        r"no remainder, so that on integers all is exact.",
        pivots_of(elimination, A),
        D[1:],
    )
    yield identity(
        r"So does the elimination of the trusted checker, `certreg.verify.positive_definite`, "
        r"which is written independently and reads the rows from the diagonal on: the same four "
        r"minors.",
        pivots_of(lambda rows: checker(upper(rows)), A),
        D[1:],
    )
    yield from _sylvester(D)


def _sylvester(D: list[Any]) -> Proof:
    for k in range(1, SIZE + 1):
        yield _positive_up_to(k, D)
    yield identity(
        r"Here $y_k = D_k x_k$ where the entries of $x$ after the $k$-th are zero.",
        [
            eliminated_row(A, k + 1, X).subs({X[j]: 0 for j in range(k + 1, SIZE)})
            for k in range(SIZE)
        ],
        [D[k + 1] * X[k] for k in range(SIZE)],
    )
    vectors = [last_cofactors(A, k) for k in range(1, SIZE + 1)]
    yield identity(
        r"Conversely, let $x$ be the cofactors of the last row of the leading $k\times k$ block. "
        r"Then $x^{\mathsf T} A x = D_{k-1} D_k$ and $x_k = D_{k-1}$. If $A$ is positive definite "
        r"then $D_0 = 1 > 0$ and, step by step, $x \ne 0$ and $D_k > 0$.",
        [[(v.T * A * v)[0], v[k]] for k, v in enumerate(vectors)],
        [[D[k] * D[k + 1], D[k]] for k in range(SIZE)],
    )
    yield cases(
        r"The four cases cover: a vector $x \ne 0$ has a last entry that is not zero.",
        LAST,
        unless=X,
    )


def _positive_up_to(k: int, D: list[Any]) -> Step:
    """x^T A x is positive where x_k is the last entry that is not zero."""
    x = Matrix([*X[:k], *[0] * (SIZE - k)])
    minors = [sympy.Integer(1), *MINORS.parts]
    terms: list[list[Any]] = []
    for j in range(1, k):  # D_1 ... D_(k-1) / (D_(j-1) D_j)
        others = [minors[i] for i in range(1, k) if i not in {j - 1, j}]
        terms.append([Square(eliminated_row(A, j, x)), *others])
    last = [minors[i] for i in range(1, k - 1)]  # y_k^2 / (D_(k-1) D_k) = x_k^2 D_k / D_(k-1)
    terms.append([Square(LAST[k - 1][0]), minors[k], *last])
    words = (
        r"If all four minors are positive, $A$ is positive definite. Let $x \ne 0$, and $x_k$ its "
        r"last entry that is not zero. With $y_j$ the $j$-th row after elimination applied to $x$, "
        r"$x^{\mathsf T} A x = \sum_{j \le k} y_j^2 / (D_{j-1} D_j)$, $D_0 = 1$, here multiplied "
        r"by $D_1 \cdots D_{k-1}$, and $y_k = D_k x_k$: positive. "
    )
    return positive(
        f"{words if k == 1 else 'The same: '}${k = }$.",
        (x.T * A * x)[0] * sympy.prod(D[1:k]),
        terms,
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
    """Elimination that updates one column less, j from k + 2 on; rows from the diagonal on."""
    n = len(rows)
    rows = [[rows[min(i, j)][abs(i - j)] for j in range(n)] for i in range(n)]
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
    concludes=(1, 2, 3, 4, 5, 6, 7, 8),
    hypotheses=(MINORS, *LAST),
    setting=(
        r"$A$ is symmetric, $4\times4$; for $3\times3$ let $a_{44} = 1$, with zeros beside it.",
    ),
    source="[Bareiss1968], Sylvester's criterion",
    proof=proof,
    controls={
        "an elimination that forgets to divide by the previous pivot": Mutation(
            at=1, proof=lambda: proof(elimination=_forgetful)
        ),
        "a checker that updates one column less": Mutation(
            at=2, proof=lambda: proof(checker=_one_short)
        ),
        "the minors of the last rows and columns": Mutation(
            at=1, proof=lambda: proof(minors=lambda A, k: leading_minor(A[::-1, ::-1], k))
        ),
    },
    not_claimed=r"That a semidefinite matrix is recognised: with a zero pivot the answer is no, "
    r"which then means *not positive definite* and nothing more.",
    runs=(
        "certreg.exact.elimination.is_positive_definite",
        "certreg.verify.positive_definite",
    ),
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
