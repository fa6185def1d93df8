"""Claim: both semidefinite relaxations have the true optimum for their value.

The quaternion form is an eigenvalue problem. The rotation form follows, because its quadratics are
all that hold on rotations: a quadratic form in (1, vec R) is known by the quartic in q it becomes.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations_with_replacement
from typing import Any

import sympy

from certreg.geometry.so3 import davenport_matrix, quadratic_form
from certreg.relaxation.qcqp import (
    homogeneous,
    quaternion_program,
    rotation_program,
    rotation_quadratics,
)

from ..algebra import Square, facts, identity, nonnegative
from ..hypotheses import SPECTRAL
from ..hypothesis import nonnegative_by
from ..kernel import Claim, Mutation, Proof
from ..notation import Matrix, diagonal, entry, inner, matrix, quaternion, rotation, square
from ..rationals import rank

Quadratics = Callable[[], Any]
LEVELS = [entry("l", k) for k in (1, 2, 3, 4)]
LARGEST = nonnegative_by(
    r"$\lambda_1$ is the largest eigenvalue of $K$.",
    [LEVELS[0] - level for level in LEVELS],
)
DIAGONAL_LEVELS = [davenport_matrix(diagonal("d").tolist())[k][k] for k in range(4)]
LARGEST_OF_C = nonnegative_by(
    r"$\lambda_1$ is the largest eigenvalue of $K$.",
    [DIAGONAL_LEVELS[0] - level for level in DIAGONAL_LEVELS],
)
SIZE, PAIRS = 10, tuple(combinations_with_replacement(range(10), 2))


def proof(
    program: Callable[[Any], Any] = quaternion_program,
    quadratics: Quadratics = rotation_quadratics,
    level: int = 0,
) -> Proof:
    """Weak duality, attainment, and the passage from the 4x4 to the 10x10 form."""
    C = matrix("C")
    K = davenport_matrix(C.tolist())
    shipped = program(C.tolist())
    yield identity(
        r"The shipped quaternion form asks for the largest $q^{\mathsf T} F q$ with "
        r"$q^{\mathsf T} N q = 1$ and no further quadratics: $F = K(C)$ and $N = I$. Its "
        r"relaxation is to maximise $\operatorname{tr}(K Z)$ over $Z \succeq 0$ with "
        r"$\operatorname{tr} Z = 1$.",
        [*shipped.objective, *shipped.normalisation, len(shipped.quadratics)],
        [*K, *Matrix.eye(4).tolist(), 0],
    )
    yield from _quaternion_form(level)
    yield from _rotation_form(quadratics())


def _quaternion_form(level: int) -> Proof:
    top = LEVELS[level]
    B, p = Matrix(4, 4, lambda i, j: entry("b", i + 1, j + 1)), quaternion("p")
    Z, spectrum = B * B.T, sympy.diag(*LEVELS)
    yield nonnegative(
        r"**Weak duality.** In an orthonormal eigenbasis $K = \operatorname{diag}(\lambda_1, "
        r"\ldots, \lambda_4)$; trace and semidefiniteness do not depend on the basis. Every "
        r"$Z \succeq 0$ is a $B B^{\mathsf T}$, and $\lambda_1 \operatorname{tr} Z - "
        r"\operatorname{tr}(K Z) = \operatorname{tr}((\lambda_1 I - K) Z) = \sum_{kj} "
        r"(\lambda_1 - \lambda_k)\, b_{kj}^2 \ge 0$. So the relaxation's value is at most "
        r"$\lambda_1$.",
        top * Z.trace() - inner(spectrum, Z),
        [(LARGEST[k], Square(B[k, j])) for k in range(4) for j in range(4)],
    )
    K = davenport_matrix(matrix("C").tolist())
    yield identity(
        r"**Attained.** $Z = p p^{\mathsf T} / |p|^2$ is feasible and has the value "
        r"$p^{\mathsf T} K p / |p|^2 = \operatorname{tr}(R(p)^{\mathsf T} C)$, which is "
        r"$\lambda_1$ at the optimum. So the relaxation has exactly the value of the problem: it "
        r"is tight.",
        [inner(Matrix(K), p * p.T), (p * p.T).trace()],
        [quadratic_form(K, tuple(p)), square(p)],
    )


def _rotation_form(quadratics: Any) -> Proof:
    C, q = matrix("C"), quaternion()
    r = homogeneous(rotation(q).tolist(), unit=square(q))
    shipped = rotation_program(C.tolist())
    yield identity(
        r"**The rotation form.** With $r = (1, \operatorname{vec} R)$, here times $|q|^2$: the "
        r"shipped objective is $r^{\mathsf T} F r = 2 \operatorname{tr}(R^{\mathsf T} C)$ and the "
        r"normalisation $r_0^2$.",
        [quadratic_form(shipped.objective, r), quadratic_form(shipped.normalisation, r)],
        [2 * square(q) * inner(rotation(q), C), square(q) ** 2],
    )
    yield identity(
        r"The 21 quadratics vanish on every rotation: $r^{\mathsf T} A r = 0$ for all $q$.",
        [quadratic_form(A, r) for A in quadratics],
        [0] * len(quadratics),
    )
    table = _quartics(r)
    yield facts(
        r"They span 20 dimensions. Nothing is missing: of the 55 products $r_i r_j$, quartic forms "
        r"in $q$, exactly 35 are linearly independent, so that the quadratic forms in $r$ that "
        r"vanish on all rotations are a space of dimension $55 - 35 = 20$. The 21 quadratics span "
        r"it. (Ranks by elimination in fractions.)",
        [len(quadratics), rank([_upper(A) for A in quadratics]), rank(table), len(table)],
        [21, 20, 35, 55],
    )
    yield identity(
        r"The one dependence: the diagonals of $R^{\mathsf T} R - I$ and of $R R^{\mathsf T} - I$ "
        r"have the same sum.",
        sum((Matrix(quadratics[k]) for k in (0, 3, 5)), start=sympy.zeros(SIZE)),
        sum((Matrix(quadratics[k]) for k in (6, 9, 11)), start=sympy.zeros(SIZE)),
    )
    yield from _rotation_tight(r)


def _rotation_tight(r: Any) -> Proof:
    q, values = quaternion(), DIAGONAL_LEVELS
    yield facts(
        r"The ten entries of $r$ are linearly independent quadratic forms in $q$, and there are "
        r"ten products $q_i q_k$: each $q_i q_k$ is a linear form $\ell_{ik}$ in $r$.",
        [rank(_quadratics_in_q(r))],
        [SIZE],
    )
    yield nonnegative(
        r"In a frame in which $C$ is diagonal, $K$ is too, and $|q|^2 (\lambda_1 |q|^2 - "
        r"q^{\mathsf T} K q) = \sum_{ik} (\lambda_1 - \lambda_k) (q_i q_k)^2$. So the forms "
        r"$\lambda_1 r_0^2 - \tfrac12 r^{\mathsf T} F r$ and $\sum_{ik} (\lambda_1 - \lambda_k)\, "
        r"\ell_{ik}(r)^2$ are the same quartic in $q$, and differ by a combination of the 21 "
        r"quadratics. These vanish on every feasible $Z$; the second form is $\succeq 0$. Hence "
        r"$\tfrac12 \langle F, Z \rangle \le \lambda_1$: the rotation form has the same value, and "
        r"is tight as well.",
        square(q) * (values[0] * square(q) - sum(v * c**2 for v, c in zip(values, q, strict=True))),
        [(LARGEST_OF_C[k], Square(q[i] * q[k])) for i in range(4) for k in range(4)],
    )


def _upper(A: Any) -> list[int]:
    """The coefficients of the 55 products r_i r_j in r^T A r."""
    return [A[i][j] if i == j else 2 * A[i][j] for i, j in PAIRS]


def _quartics(r: Any) -> list[list[int]]:
    """Rows: the coefficients of the products r_i r_j as polynomials in q."""
    return _coefficients([r[i] * r[j] for i, j in PAIRS])


def _quadratics_in_q(r: Any) -> list[list[int]]:
    return _coefficients(list(r))


def _coefficients(polynomials: list[Any]) -> list[list[int]]:
    terms: list[Any] = [sympy.Poly(p, *quaternion()).as_dict() for p in polynomials]
    monomials = sorted({powers for row in terms for powers in row})
    return [[int(row.get(powers, 0)) for powers in monomials] for row in terms]


def _one_sign_off() -> Any:
    *others, last = rotation_quadratics()
    rows = enumerate(last)
    return (*others, [[-e if 0 in {i, j} else e for j, e in enumerate(row)] for i, row in rows])


def _without_the_last() -> Any:
    return rotation_quadratics()[:-1] + rotation_quadratics()[:1]


CLAIM = Claim(
    name="relaxation_tightness",
    title="The relaxation is tight",
    statement=r"The maximum of $\operatorname{tr}(K Z)$ over $Z \succeq 0$, $\operatorname{tr} Z = "
    r"1$, is $\lambda_1$, the largest $\operatorname{tr}(R^{\mathsf T} C)$ over all rotations. The "
    r"relaxation in $(1, \operatorname{vec} R)$ with 21 redundant quadratics, which vanish on all "
    r"rotations and span the 20 dimensions of all that do, has the same value.",
    concludes=(1, 2, 3, 4, 5, 6, 8, 9),
    hypotheses=(LARGEST, LARGEST_OF_C),
    setting=(r"Every $C$, the optimum unique or not.",),
    source="[Briales2017], redundant rotation constraints; [Horn1987], the eigenvalue problem",
    proof=proof,
    controls={
        "the second eigenvalue bounds the relaxation": Mutation(at=2, proof=lambda: proof(level=1)),
        "the program of -C": Mutation(
            at=1,
            proof=lambda: proof(lambda C: quaternion_program([[-e for e in row] for row in C])),
        ),
        "a column product with the wrong sign": Mutation(
            at=5, proof=lambda: proof(quadratics=_one_sign_off)
        ),
        "one of the 21 quadratics given twice, one left out": Mutation(
            at=6, proof=lambda: proof(quadratics=_without_the_last)
        ),
    },
    not_claimed=r"That an optimal $Z$ has rank one: where the optimum is not unique it need not. "
    r"Nor that the value a solver prints is $\lambda_1$: see `dual_bound`.",
    needs=("davenport", "quaternions", "eigenvectors"),
    standard=(SPECTRAL,),
    runs=(
        "certreg.relaxation.qcqp.quaternion_program",
        "certreg.relaxation.qcqp.rotation_program",
        "certreg.geometry.constraints.rotation_quadratics",
    ),
    used_by=("certreg.relaxation.shor.relax",),
    not_in_coq=(
        "Nothing in Coq speaks of semidefinite programs; the bound from a multiplier is on "
        "the page `dual_bound`."
    ),
)
