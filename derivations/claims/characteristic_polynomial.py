"""Claim: the characteristic polynomial of the ambient Jacobian at every equilibrium."""

from __future__ import annotations

from collections.abc import Callable
from math import prod
from typing import Any

import sympy

from ..algebra import combination, contraction, identity
from ..hypotheses import INERTIA_INVERSE, WHERE_ROTATION, balanced
from ..hypothesis import Standing
from ..kernel import Claim, Mutation, Proof, Step
from ..linearisation import ambient_jacobian, hessian, intrinsic_jacobian
from ..motion import DAMPING, Body, State
from ..notation import Array, Matrix, hat, inner, matrix, scalar, symmetric, vector

Curvature = Callable[[State, Body], Array]
ROOT = scalar("lambda")
BALANCED = balanced(Standing.ASSUMED)


def proof(curvature: Curvature = hessian, *, zeros: int = 6, stiffness: int = 2) -> Proof:
    """Block elimination in 18 and in 12 dimensions, the equilibrium, where the zeros come from."""
    state, body = State(omega=sympy.zeros(3, 1)), Body()
    rows = Matrix.vstack(*[hat(state.R.row(k)) for k in range(3)])
    A = state.R.T * body.cross
    spring = 2 * body.inertia_inverse * (A - A.trace() * sympy.eye(3))
    ambient = ambient_jacobian(state, body)
    E = _columns_combined(rows)
    B = (ROOT * sympy.eye(18) - ambient) * E
    yield from _triangular(B, E, spring, stiffness)
    yield identity(
        r"Now take determinants. That of $E$ is the product of its diagonal, $\lambda^6$; that of "
        r"the right-hand side begins with $\lambda^{12}$. Hence $\lambda^6 \chi_{18}(\lambda) = "
        r"\lambda^{12} (\lambda^2 + \mu\lambda + 2)^3 \det\bigl(\lambda(\lambda+\mu) I - "
        r"2 J^{-1} (A - \operatorname{tr}(A) I)\bigr)$, an equation of polynomials in which "
        r"$\lambda^6$ may be cancelled: six zeros remain.",
        prod(B[k, k] for k in range(12)),
        ROOT**zeros * prod(E[k, k] for k in range(18)),
    )
    yield _at_equilibrium(state, body, curvature, spring)
    yield from _intrinsic(state, body, spring, stiffness)
    yield from _without_inverse()
    yield from _where_the_zeros_live(state, ambient)


def _columns_combined(turning: Array) -> Array:
    """E: adds the columns of c and R to those of v and omega, which are multiplied by lambda."""
    n = 3 + turning.rows
    above = sympy.diag(sympy.eye(3), turning)
    return Matrix.vstack(
        Matrix.hstack(sympy.eye(n), above),
        Matrix.hstack(sympy.zeros(6, n), ROOT * sympy.eye(6)),
    )


def _eliminated(turning: int, spring: Array, left: Array, stiffness: int) -> Array:
    """The block triangular matrix that elimination leaves."""
    translation = ROOT**2 + DAMPING * ROOT + stiffness
    found = sympy.zeros(9 + turning, 9 + turning)
    n = 3 + turning
    found[:n, :n] = ROOT * sympy.eye(n)
    found[n : n + 3, :3] = 2 * sympy.eye(3)
    found[n : n + 3, n : n + 3] = translation * sympy.eye(3)
    found[n + 3 :, 3:n] = left
    found[n + 3 :, n + 3 :] = ROOT * (ROOT + DAMPING) * sympy.eye(3) - spring
    return found


def _triangular(B: Array, E: Array, spring: Array, stiffness: int) -> Proof:
    body = Body()
    left = -2 * body.inertia_inverse * Matrix.hstack(*[hat(body.cross.row(k)) for k in range(3)])
    yield identity(
        r"At an equilibrium $\omega = 0$. Eliminate in $\lambda I - A_{18}$ by columns: multiply "
        r"those of $v$ and $\omega$ by $\lambda$ and add to them those of $c$ and $R$, combined so "
        r"that the rates $\dot c$ and $\dot R$ cancel. This is multiplication from the right by a "
        r"matrix $E$ that is zero below its diagonal, with twelve times $1$ and six times "
        r"$\lambda$ on it.",
        [*(E[i, j] for i in range(18) for j in range(i)), *E.diagonal()],
        [*[0] * 153, *[1] * 12, *[ROOT] * 6],
    )
    yield identity(
        r"Multiplied out, all 324 entries: $(\lambda I - A_{18})\, E$ is block triangular, with "
        r"the diagonal blocks $\lambda I$ (12 dimensions), $(\lambda^2 + \mu\lambda + 2) I$ for "
        r"the translation and $\lambda(\lambda+\mu) I - 2 J^{-1}(A - \operatorname{tr}(A) I)$ for "
        r"the rotation, $A = R^{\mathsf T} C$. All that stands above them is zero.",
        B,
        _eliminated(9, spring, left, stiffness),
    )


def _at_equilibrium(state: State, body: Body, curvature: Curvature, spring: Array) -> Step:
    a, b = vector("a"), vector("b")
    return combination(
        r"At an equilibrium $A$ is symmetric as well (claim `eigenvectors`), and then "
        r"$2 (A - \operatorname{tr}(A) I) = -G$ with the Hessian $G$: contracted with any $a$ and "
        r"$b$ the difference is a combination of the entries of $A - A^{\mathsf T}$. So "
        r"$\chi_{18}(\lambda) = \lambda^6 (\lambda^2 + \mu\lambda + 2)^3 "
        r"\det\bigl(\lambda(\lambda+\mu) I + J^{-1} G\bigr)$.",
        inner(a, (spring + body.inertia_inverse * curvature(state, body)) * b),
        contraction(body.inertia_inverse * a * b.T, BALANCED),
    )


def _intrinsic(state: State, body: Body, spring: Array, stiffness: int) -> Proof:
    E = _columns_combined(sympy.eye(3))
    yield identity(
        r"The same elimination in the intrinsic $12\times12$ Jacobian, with angles for the nine "
        r"entries of $R$: the blocks are $\lambda I$ (6 dimensions), $(\lambda^2 + \mu\lambda + 2) "
        r"I$ and the same last one, and $\det E = \lambda^6$ again, which cancels. So "
        r"$\chi_{12}(\lambda) = (\lambda^2 + \mu\lambda + 2)^3 \det\bigl(\lambda(\lambda+\mu) I + "
        r"J^{-1} G\bigr)$, and $\chi_{18} = \lambda^6 \chi_{12}$.",
        (ROOT * sympy.eye(12) - intrinsic_jacobian(state, body)) * E,
        _eliminated(3, spring, -spring, stiffness),
    )


def _without_inverse() -> Proof:
    J, inverse, G = symmetric("J"), symmetric("I"), matrix("G")
    s, a, b = scalar("sigma"), vector("a"), vector("b")
    yield combination(
        r"Without the inverse: $J (\sigma I + J^{-1} G) = \sigma J + G$, a combination of the "
        r"entries of $J J^{-1} - I$. So with $\sigma = \lambda(\lambda+\mu)$ the last factor is "
        r"$\det(\sigma J + G) / \det J$, and its zeros are the $\sigma = -g$ with $g$ the "
        r"eigenvalues of the pencil $(G, J)$.",
        inner(a, (J * (s * sympy.eye(3) + inverse * G) - (s * J + G)) * b),
        contraction(a * (G * b).T, INERTIA_INVERSE),
    )


def _where_the_zeros_live(state: State, ambient: Array) -> Proof:
    S, R = symmetric("S"), state.R
    functional: Any = Matrix([*[0] * 3, *(R * S), *[0] * 6]).T
    d_omega = vector("d_omega")
    d, spin = Matrix([*vector("d_c"), *matrix("D"), *vector("d_v"), *d_omega]), hat(d_omega)
    yield combination(
        r"Where the six zeros come from: for symmetric $S$ let $\ell_S(\delta s) = "
        r"\operatorname{tr}(S R^{\mathsf T} \delta R)$, half the change of $\operatorname{tr}"
        r"(S R^{\mathsf T} R)$. Then $\ell_S A_{18} = 0$, a combination of the entries of "
        r"$R^{\mathsf T} R - I$: the equations of motion keep $R^{\mathsf T} R = I$, and to first "
        r"order no motion changes these six numbers. Six independent $S$ are six left eigenvectors "
        r"with eigenvalue $0$.",
        (functional * ambient * d)[0],
        contraction(S * spin.T, WHERE_ROTATION),
    )
    yield combination(
        r"And $\ell_S$ vanishes on the tangent space of the rotations, the $\delta R = "
        r"R [\varphi]_\times$, because the trace of a symmetric times a skew matrix is zero. So "
        r"the six zeros are those of the six directions that leave the rotations. They are there "
        r"at every equilibrium and say nothing about its stability, which the intrinsic Jacobian "
        r"decides.",
        inner(R * S, R * spin),
        contraction(S * spin.T, WHERE_ROTATION),
    )


def _of_the_transpose(state: State, body: Body) -> Array:
    return hessian(State(R=state.R.T), body)


CLAIM = Claim(
    name="characteristic_polynomial",
    title="The characteristic polynomial",
    statement=r"At every equilibrium the ambient $18\times18$ Jacobian has the characteristic "
    r"polynomial $\chi_{18}(\lambda) = \lambda^6\, (\lambda^2 + \mu\lambda + 2)^3\, "
    r"\det\bigl(\lambda(\lambda+\mu) I + J^{-1} G\bigr)$ with the Hessian $G$ of the potential, "
    r"and the intrinsic $12\times12$ Jacobian has $\chi_{12} = \chi_{18} / \lambda^6$. The "
    r"six zeros belong to perturbations that leave the rotations.",
    concludes=(2, 3, 4, 5, 6, 7, 8),
    hypotheses=(BALANCED, INERTIA_INVERSE, WHERE_ROTATION),
    setting=(r"The state is an equilibrium: $v = \omega = 0$, $c = 0$; see `eigenvectors`.",),
    source="ours; [Yang2020] computes these eigenvalues numerically",
    proof=proof,
    controls={
        "five zeros": Mutation(at=3, proof=lambda: proof(zeros=5)),
        "-G for G": Mutation(at=4, proof=lambda: proof(curvature=lambda s, b: -hessian(s, b))),
        "G of R C for R^T C": Mutation(at=4, proof=lambda: proof(curvature=_of_the_transpose)),
        "springs of stiffness 1": Mutation(at=2, proof=lambda: proof(stiffness=1)),
    },
    not_claimed=r"That all eigenvalues at the optimum lie in the left half-plane, as a caption "
    r"of [Yang2020] says: six of the 18 are zero, at every equilibrium.",
    needs=("ambient_jacobian", "intrinsic_jacobian", "pushforward", "eigenvectors", "hessian"),
    runs=(
        "derivations.linearisation.ambient_jacobian",
        "derivations.linearisation.intrinsic_jacobian",
    ),
    used_by=(
        "certreg.equilibrium.stability.linearised_spectrum",
        "certreg.dynamics.rigid.RigidBody.ambient_jacobian",
    ),
    coq=(
        "six_rates_vanish",
        "symmetric_parts_are_all",
        "kernel_is_six_dimensional",
        "zero_is_semisimple",
    ),
    not_in_coq=(
        "The polynomial as a determinant. Proved there instead: zero has multiplicity "
        "exactly six where $J$ and $G$ are invertible."
    ),
)
