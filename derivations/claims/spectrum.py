"""Claim: the spectrum of Davenport's matrix from the special singular values of C."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy

from certreg.geometry.so3 import davenport_matrix

from ..algebra import identity, nonnegative, quoted, refuting
from ..hypothesis import nonnegative_by
from ..kernel import Claim, Mutation, Proof, Step
from ..notation import (
    Matrix,
    determinant,
    left_product,
    matrix,
    quaternion,
    right_product,
    rotation,
    square,
    vector,
)
from ..table import eigenvalues

Davenport = Callable[[Any], Any]
D = vector("d")
ORDERED = nonnegative_by(
    r"$d_1 \ge d_2 \ge d_3$, by the choice of the frame.",
    [D[0] - D[1], D[1] - D[2]],
)
LARGEST = nonnegative_by(
    r"$\lambda_1 \ge \lambda_2$: the frame was made from an eigenvector of the largest eigenvalue.",
    eigenvalues(D)[0] - eigenvalues(D)[1],
)


def proof(
    davenport: Davenport = davenport_matrix,
    levels: Callable[[Any], tuple[Any, ...]] = eigenvalues,
    middle: int = 2,
) -> Proof:
    """Rotating either cloud conjugates K; the diagonal frame exists; there K is diagonal."""
    yield from _equivariance(davenport)
    yield from _frame()
    d = vector("d")
    l1, l2, l3, l4 = levels(d)
    yield identity(
        r"In the diagonal frame $K$ is diagonal: $K(\operatorname{diag}(d_1, d_2, d_3)) = "
        r"\operatorname{diag}(\lambda_1, \lambda_2, \lambda_3, \lambda_4)$ with "
        r"$\lambda_1 = d_1 + d_2 + d_3$, $\lambda_2 = d_1 - d_2 - d_3$, "
        r"$\lambda_3 = -d_1 + d_2 - d_3$, $\lambda_4 = -d_1 - d_2 + d_3$. So these are the "
        r"eigenvalues of $K(C)$, with multiplicities; their order is still to be proved.",
        davenport(sympy.diag(*d).tolist()),
        sympy.diag(l1, l2, l3, l4),
    )
    yield identity(
        r"Neighbours in this list differ by $\lambda_1 - \lambda_2 = 2 (d_2 + d_3)$, "
        r"$\lambda_2 - \lambda_3 = 2 (d_1 - d_2)$, $\lambda_3 - \lambda_4 = 2 (d_2 - d_3)$.",
        [l1 - l2, l2 - l3, l3 - l4],
        [2 * (d[1] + d[2]), middle * (d[0] - d[1]), 2 * (d[1] - d[2])],
    )
    yield from _order(levels)


def _order(levels: Callable[[Any], tuple[Any, ...]]) -> Proof:
    d, a = D, quaternion("a")
    _, l2, l3, l4 = levels(d)
    yield nonnegative(
        r"The eigenvalue $\lambda_1$ is the largest one, as was seen when the frame was found. So "
        r"it is at least the eigenvalue $\lambda_2 = d_1 - d_2 - d_3$, and $d_2 + d_3 = (\lambda_1 "
        r"- \lambda_2)/2 \geq 0$. With $d_1 \geq d_2 \geq d_3$ this says $d_1 \geq d_2 \geq "
        r"|d_3|$: the *special* singular values of $C$, unlike the usual ones with rotations on "
        r"both sides and a sign on the last.",
        d[1] + d[2],
        [[sympy.Rational(1, 2), LARGEST[0]]],
    )
    turn = rotation(a)
    yield identity(
        r"Rotations have determinant one ($|a|^6$ for $|a|^2 R(a)$) and determinants multiply, so "
        r"$\det C = d_1 d_2 d_3$: $d_3$ has the sign of $\det C$ where $d_2 > 0$, and $d_3 = 0$ "
        r"where $d_2 = 0$.",
        [determinant(turn), determinant(sympy.diag(*d))],
        [square(a) ** 3, d[0] * d[1] * d[2]],
    )
    yield nonnegative(
        r"$\lambda_2 \geq \lambda_3$, because $d_1 \geq d_2$.",
        l2 - l3,
        [[2, ORDERED[0]]],
    )
    yield nonnegative(
        r"$\lambda_3 \geq \lambda_4$, because $d_2 \geq d_3$. With $\lambda_1 \geq \lambda_2$ "
        r"from above, the eigenvalues are in descending order.",
        l3 - l4,
        [[2, ORDERED[1]]],
    )


def _equivariance(davenport: Davenport) -> Proof:
    C, a = matrix("C"), quaternion("a")
    K = Matrix(davenport(C.tolist()))
    left, right = left_product(a), right_product(a)
    yield identity(
        r"Turning the target by $R(a)$ conjugates $K$: $K(R(a)\, C) = A^{\mathsf T} K(C)\, A$ with "
        r"$A\, q = \bar a q$, the product with the conjugate quaternion, and $A^{\mathsf T} A = "
        r"|a|^2 I$. (Of degree two in $a$; for $|a| = 1$ the matrix $A$ is orthogonal.)",
        [Matrix(davenport((rotation(a) * C).tolist())), left * left.T],
        [left * K * left.T, square(a) * sympy.eye(4)],
    )
    yield identity(
        r"Turning the source does so too: $K(C\, R(a)^{\mathsf T}) = B^{\mathsf T} K(C)\, B$ with "
        r"$B\, q = q a$ and $B^{\mathsf T} B = |a|^2 I$. So for rotations $U$ and $V$ the matrices "
        r"$K(U C V^{\mathsf T})$ and $K(C)$ have the same eigenvalues, with multiplicities, and "
        r"the same characteristic polynomial.",
        [Matrix(davenport((C * rotation(a).T).tolist())), right.T * right],
        [right.T * K * right, square(a) * sympy.eye(4)],
    )


def _frame() -> Proof:
    yield quoted(
        r"A real symmetric matrix has an orthonormal basis of eigenvectors with real eigenvalues; "
        r"its largest eigenvalue is the maximum of its quadratic form over unit vectors. For "
        r"$K(C)$ let $q$ be a unit eigenvector of the largest one, and $R = R(q)$: "
        r"$S = R^{\mathsf T} C$ is symmetric (claim `eigenvectors`). For $S$ put the eigenvectors, "
        r"in the order of descending eigenvalues $d_1 \geq d_2 \geq d_3$, into the columns of $V$; "
        r"change the sign of one if $\det V = -1$. Then $S = V \operatorname{diag}(d) "
        r"V^{\mathsf T}$ with $V \in \mathrm{SO}(3)$.",
        theorem="the spectral theorem",
        source="the spectral theorem",
    )
    d, a = vector("d"), quaternion("a")
    diagonal, turn = sympy.diag(*d), rotation(a)
    yield identity(
        r"So $C = U \operatorname{diag}(d)\, V^{\mathsf T}$ with the rotations $U = R V$ and $V$. "
        r"Conjugation keeps the trace, $\operatorname{tr}(V \operatorname{diag}(d) V^{\mathsf T}) "
        r"= d_1 + d_2 + d_3$ (with $|a|^4$ on the right for $V = R(a)$ of any length), so the "
        r"largest eigenvalue $q^{\mathsf T} K q = \operatorname{tr}(R^{\mathsf T} C) = "
        r"\operatorname{tr} S$ is $\lambda_1 = d_1 + d_2 + d_3$.",
        (turn * diagonal * turn.T).trace(),
        square(a) ** 2 * sum(d),
    )


def _wrong_sign(C: Any) -> Any:
    K = [list(row) for row in davenport_matrix(C)]
    K[3][3] = -K[3][3]
    return K


def _other_eigenvalues() -> Step:
    return refuting(
        r"For $C = \operatorname{diag}(3, 2, 1)$ that matrix is diagonal and has the eigenvalues "
        r"$6, 0, -2, 4$, not $6, 0, -2, -4$.",
        [_wrong_sign([[3, 0, 0], [0, 2, 0], [0, 0, 1]])[k][k] for k in range(4)],
        list(eigenvalues((3, 2, 1))),
    )


def _signs_lost(d: Any) -> tuple[Any, ...]:
    a, b, c = d
    return a + b + c, a + b - c, a - b + c, -a + b + c


CLAIM = Claim(
    name="spectrum",
    title="The spectrum of Davenport's matrix",
    statement=r"Every real $3\times3$ matrix is $C = U \operatorname{diag}(d_1, d_2, d_3)\, "
    r"V^{\mathsf T}$ with rotations $U, V$ and $d_1 \geq d_2 \geq |d_3|$, and $K(C)$ then has the "
    r"eigenvalues $\lambda_1 = d_1 + d_2 + d_3 \geq \lambda_2 = d_1 - d_2 - d_3 \geq "
    r"\lambda_3 = -d_1 + d_2 - d_3 \geq \lambda_4 = -d_1 - d_2 + d_3$. Their differences are "
    r"$2(d_2 + d_3)$, $2(d_1 - d_2)$ and $2(d_2 - d_3)$.",
    concludes=(1, 2, 5, 6, 7, 9, 10),
    hypotheses=(ORDERED, LARGEST),
    source="[Horn1987], [Umeyama1991] for the sign of the last singular value",
    proof=proof,
    controls={
        "K with a wrong entry": Mutation(
            at=1, proof=lambda: proof(davenport=_wrong_sign), instance=_other_eigenvalues
        ),
        "eigenvalues with one minus instead of two": Mutation(
            at=5, proof=lambda: proof(levels=_signs_lost)
        ),
        "the middle gap without its factor 2": Mutation(at=6, proof=lambda: proof(middle=1)),
    },
    not_claimed=r"That $U$ and $V$ are unique. Nothing is computed this way: the singular values "
    r"are the frame of the proof, and the code decides without them.",
    needs=("davenport", "eigenvectors", "quaternions"),
    runs=("certreg.geometry.so3.davenport_matrix",),
    used_by=(
        "certreg.objective.classification",
        "certreg.equilibrium.equilibrium_set.Margin",
        "certreg.registration.closed_form.arun",
        "certreg.verify.multiplicities",
    ),
    coq=(
        "eigenvalues_from_singular_values",
        "singular_values_ordered",
        "singular_values_symmetric_functions",
        "squares_are_eigenvalues_of_gram",
        "unique_iff_positive_margin",
    ),
    not_in_coq=(
        r"The decomposition $C = U \operatorname{diag}(d_1, d_2, d_3)\, V^{\mathsf T}$ with "
        r"rotations: in Coq the $d_i$ are made from the eigenvalues of $K$, and their "
        r"squares are proved to be the eigenvalues of $C^{\mathsf T}C$, with $d_1 d_2 d_3 = "
        r"\det C$."
    ),
)
