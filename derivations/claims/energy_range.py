"""Claim: the range of energies lies between two multiples of the Frobenius norm of K."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import sympy

from certreg.geometry.so3 import davenport_matrix

from ..algebra import Square, combination, contraction, facts, identity, nonnegative
from ..hypotheses import SPECTRAL
from ..hypothesis import nonnegative_by, vanishing
from ..kernel import Claim, Mutation, Proof, Step
from ..notation import Matrix, entry, inner, matrix, square

GAPS = [entry("g", k) for k in (1, 2, 3)]
DESCENDING = nonnegative_by(
    r"$\lambda_1 \ge \lambda_2 \ge \lambda_3 \ge \lambda_4$ are the eigenvalues of $K$, the gaps "
    r"$g_1, g_2, g_3 \ge 0$ between neighbours.",
    GAPS,
    example={GAPS[0]: 1, GAPS[1]: -1},
)
BASIS = matrix("Q", 4)
ORTHONORMAL = vanishing(
    r"$Q^{\mathsf T}Q = I$: the columns are an orthonormal basis of eigenvectors.",
    BASIS.T * BASIS - sympy.eye(4),
)
TRACE_FREE = vanishing(
    r"$\operatorname{tr} K = 0$, as it is for Davenport's matrix.",
    sum(entry("l", k) for k in (1, 2, 3, 4)),
    solves=(entry("l", 4),),
)


def levels() -> list[Any]:
    """The eigenvalues of trace zero with these gaps."""
    first, second, third = GAPS
    top = (3 * first + 2 * second + third) / 4
    return [top, top - first, top - first - second, top - first - second - third]


def proof(lower: Any = 1, upper: Any = 2, factor: int = 4) -> Proof:
    """The norm in eigenvalues; both bounds as sums of nonnegative terms; where they hold with =."""
    yield from _norm(factor)
    yield from _bounds(sympy.sympify(lower), sympy.sympify(upper))
    yield _attained()


def _norm(factor: int) -> Proof:
    spectrum = [entry("l", k) for k in (1, 2, 3, 4)]
    D, Q = sympy.diag(*spectrum), BASIS
    total = sum(level**2 for level in spectrum)
    gram = Q.T * Q
    yield combination(
        r"In an orthonormal basis of eigenvectors $K = Q \operatorname{diag}(\lambda) Q^{\mathsf "
        r"T}$, and $F^2 = \lVert K\rVert^2 = \sum_k \lambda_k^2$: the difference is a combination "
        r"of the entries of $Q^{\mathsf T}Q - I$.",
        square(Q * D * Q.T) - total,
        contraction(D * (gram + sympy.eye(4)) * D, ORTHONORMAL),
    )
    pairs = sum((a - b) ** 2 for a, b in combinations(spectrum, 2))
    yield combination(
        r"With $\sum_k \lambda_k = 0$ it is a quarter of the sum of all squared differences, $4F^2 "
        r"= \sum_{j<k} (\lambda_j - \lambda_k)^2$.",
        4 * total - pairs,
        [(sum(spectrum), TRACE_FREE[0])],
    )
    found = levels()
    yield identity(
        r"The eigenvalues of trace zero with the gaps $g_1, g_2, g_3$ are $\lambda_1 = "
        r"\tfrac14(3g_1 + 2g_2 + g_3)$ and so on down; the range is $\lambda_1 - \lambda_4 = g_1 + "
        r"g_2 + g_3$.",
        [sum(found), found[0] - found[1], found[1] - found[2], found[2] - found[3]],
        [0, *GAPS],
    )
    C = matrix("C")
    K = Matrix(davenport_matrix(C.tolist()))
    yield identity(
        r"Davenport's matrix has trace zero, and $F^2 = 4 \lVert C\rVert^2$.",
        [K.trace(), square(K)],
        [0, factor * inner(C, C)],
    )


def _bounds(lower: Any, upper: Any) -> Proof:
    found = levels()
    norm, extent = sum(level**2 for level in found), sum(GAPS)
    first, second, third = DESCENDING.parts
    half, quarter = sympy.Rational(1, 2), sympy.Rational(1, 4)
    yield nonnegative(
        r"**Below.** $(\lambda_1 - \lambda_4)^2 - F^2 = \tfrac14 g_1^2 + \tfrac14 g_3^2 + g_1 g_2 "
        r"+ g_2 g_3 + \tfrac32 g_1 g_3 \ge 0$. So $F \le \lambda_1 - \lambda_4$.",
        extent**2 - lower * norm,
        [
            [quarter, Square(GAPS[0])],
            [quarter, Square(GAPS[2])],
            [first, second],
            [second, third],
            [3 * half, first, third],
        ],
    )
    yield nonnegative(
        r"**Above.** $2F^2 - (\lambda_1 - \lambda_4)^2 = (\lambda_1 + \lambda_4)^2 + 2\lambda_2^2 "
        r"+ 2\lambda_3^2 \ge 0$. So $\lambda_1 - \lambda_4 \le \sqrt2\, F$.",
        upper * norm - extent**2,
        [[Square(found[0] + found[3])], [2, Square(found[1])], [2, Square(found[2])]],
    )


def _attained() -> Step:
    cases = [(1, 1, -1, -1), (1, 0, 0, -1)]
    return facts(
        r"Neither can be improved: for the eigenvalues $1, 1, -1, -1$ the range is $2 = F$, for "
        r"$1, 0, 0, -1$ it is $2$ and $F^2 = 2$.",
        [value for case in cases for value in (case[0] - case[3], sum(x * x for x in case))],
        [2, 4, 2, 2],
    )


CLAIM = Claim(
    name="energy_range",
    title="The range of energies",
    statement=r"Let $K$ be a symmetric $4\times4$ matrix of trace zero, with eigenvalues "
    r"$\lambda_1 \ge \dots \ge \lambda_4$ and Frobenius norm $F$. Then $$F \le \lambda_1 - "
    r"\lambda_4 \le \sqrt2\, F,$$ and neither bound can be improved. For Davenport's matrix $F^2 = "
    r"4\lVert C\rVert^2$, and the objective over all rotations ranges over an interval of length "
    r"$2(\lambda_1 - \lambda_4)$, so between $2F$ and $2\sqrt2\, F$.",
    concludes=(1, 2, 3, 4, 5, 6, 7),
    hypotheses=(TRACE_FREE, ORTHONORMAL, DESCENDING),
    source="ours; the lower bound is Popoviciu's inequality for four numbers",
    proof=proof,
    witness=dict.fromkeys(BASIS.diagonal(), 1),
    controls={
        "a lower bound of 1.1 F": Mutation(
            at=5,
            proof=lambda: proof(lower=sympy.Rational(121, 100)),
            point={GAPS[1]: 1},
        ),
        "an upper bound of 1.4 F": Mutation(
            at=6,
            proof=lambda: proof(upper=sympy.Rational(49, 25)),
            point={GAPS[0]: 1, GAPS[2]: 1},
        ),
        "F^2 = 3 |C|^2": Mutation(at=4, proof=lambda: proof(factor=3)),
    },
    not_claimed=r"The range itself: it takes the eigenvalues. The two bounds take a sum of "
    r"squares, and a share of the range computed from them is right within a factor of $\sqrt2$, "
    r"on the side that is chosen.",
    needs=("davenport", "eigenvectors"),
    standard=(SPECTRAL,),
    runs=("certreg.geometry.so3.davenport_matrix",),
    used_by=(
        "certreg.verify.IsotropicStatement",
        "certreg.certificate.bounds.PoseBounds.share_upper",
    ),
    not_in_coq="The inequality is not stated in Coq.",
)
