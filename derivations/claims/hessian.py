"""Claim: the Hessian of the potential at an equilibrium, exactly, and its eigenvalues."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy

from certreg.geometry.so3 import davenport_matrix

from ..algebra import combination, contraction, identity, modulo
from ..hypotheses import AT_P, AT_Q, CIRCLE, SPECTRAL
from ..kernel import Claim, Mutation, Proof, Step
from ..linearisation import hessian as shipped_hessian
from ..linearisation import intrinsic_jacobian
from ..moments import MomentCloud
from ..motion import Body, State
from ..notation import (
    Array,
    Matrix,
    body,
    hat,
    inner,
    left_product,
    matrix,
    quaternion,
    rotation,
    scalar,
    square,
    symmetric,
    vector,
    vee,
)


def hessian_of(A: Any) -> Array:
    """G = 2 tr(A) I - A - A^T for A = R^T C."""
    return 2 * A.trace() * sympy.eye(3) - A - A.T


Hessian = Callable[[Any], Array]


def proof(
    hessian: Hessian = hessian_of,
    shipped: Callable[[State, Body], Array] = shipped_hessian,
    *,
    swapped: bool = False,
    noise_free: int = 2,
) -> Proof:
    """Second derivative, the exact potential along a turn, eigenvectors, the case without noise."""
    yield from _second_derivative(hessian)
    C, q = matrix("C"), quaternion()
    K, L, A = Matrix(davenport_matrix(C.tolist())), body(q), rotation(q).T * C
    yield identity(
        r"In quaternions, for $R = R(q)$, $|q| = 1$ (both sides are of degree two in $q$): "
        r"$G = (q^{\mathsf T} K q)\, I - L(q)^{\mathsf T} K L(q)$.",
        hessian(A),
        (q.T * K * q)[0] * sympy.eye(3) - L.T * K * L,
    )
    yield from _along_a_turn()
    yield _eigenvector(swapped=swapped)
    yield from _in_the_code(hessian, shipped)
    cloud, R = MomentCloud(), State().R
    yield identity(
        r"Without noise $\tilde y_i = R \tilde x_i$, and then $C = \sum_i m_i \tilde y_i "
        r"\tilde x_i^{\mathsf T} = R S_2$, so that $R^{\mathsf T} C = S_2$ at this $R$. The "
        r"Hessian there is twice the inertia: $2 \operatorname{tr}(S_2) I - 2 S_2 = 2 J$.",
        [cloud.total((R * cloud.x) * cloud.x.T), hessian(cloud.source_scatter)],
        [R * cloud.source_scatter, noise_free * cloud.inertia],
    )


def _second_derivative(hessian: Hessian) -> Proof:
    A, phi, t = matrix("A"), vector("phi"), scalar("t")
    turn = sympy.eye(3) + t * hat(phi) + t**2 / 2 * hat(phi) ** 2
    potential = -2 * inner(turn, A)
    yield identity(
        r"On rotations $V_p$ is a constant minus $2 \operatorname{tr}(R^{\mathsf T} C)$. Let "
        r"$A = R^{\mathsf T} C$ and move along $R \exp(t [\varphi]_\times) = "
        r"R\,(I + t [\varphi]_\times + \tfrac{1}{2} t^2 [\varphi]_\times^2 + \dots)$, where "
        r"the alignment is $\operatorname{tr}(\exp(t [\varphi]_\times)^{\mathsf T} A)$. The first "
        r"derivative at $t = 0$ is $-\tau \cdot \varphi$ with the springs' torque $\tau = "
        r"2 \operatorname{vee}(A - A^{\mathsf T})$.",
        sympy.diff(potential, t).subs(t, 0),
        -inner(2 * vee(A - A.T), phi),
    )
    yield identity(
        r"The second derivative is $\varphi^{\mathsf T} G \varphi$ with $G = "
        r"2 \operatorname{tr}(R^{\mathsf T} C)\, I - R^{\mathsf T} C - C^{\mathsf T} R$: $G$ is "
        r"the Hessian itself, with no further factor, and $V_p = V_p(R) - \tau \cdot \varphi + "
        r"\tfrac{1}{2} \varphi^{\mathsf T} G \varphi + \dots$",
        sympy.diff(potential, t, 2).subs(t, 0),
        (phi.T * hessian(A) * phi)[0],
    )


def _along_a_turn() -> Proof:
    K, q, n = symmetric("K", 4), quaternion(), vector("n")
    c, s = scalar("c"), scalar("s")
    L = body(q)
    turned = c * q + s * L * n
    yield identity(
        r"Turning the body by the angle $\theta$ about the axis $n$ multiplies $q$ by "
        r"$(c, s n)$ with $c = \cos\tfrac{\theta}{2}$, $s = \sin\tfrac{\theta}{2}$: the new "
        r"quaternion is $c\, q + s\, L(q) n$.",
        left_product(q) * Matrix([c, *(s * n)]),
        turned,
    )
    level, slope, across = (q.T * K * q)[0], (n.T * L.T * K * q)[0], (n.T * L.T * K * L * n)[0]
    yield identity(
        r"The alignment there is a quadratic form in $(c, s)$: $q_\theta^{\mathsf T} K q_\theta = "
        r"c^2\, q^{\mathsf T} K q + 2 c s\, n^{\mathsf T} L^{\mathsf T} K q + "
        r"s^2\, n^{\mathsf T} L^{\mathsf T} K L\, n$.",
        (turned.T * K * turned)[0],
        c**2 * level + 2 * c * s * slope + s**2 * across,
    )
    Q, B, F = scalar("Q"), scalar("B"), scalar("F")
    yield modulo(
        r"Call the three values $Q, B, F$; for $|n| = 1$ the formula for $G$ above says "
        r"$n^{\mathsf T} G n = Q - F$, and $\tau \cdot n = 2 B$. With $c^2 + s^2 = 1$ the whole "
        r"turn is known, to any angle and without a remainder: $V_p(\theta) - V_p(0) = "
        r"2 (Q - q_\theta^{\mathsf T} K q_\theta) = 2 s^2\, n^{\mathsf T} G n - "
        r"2 s c\, \tau \cdot n$. At an equilibrium $V_p(\theta) = V_p(0) + (1 - \cos\theta)\, "
        r"n^{\mathsf T} G n$: every turn away from it is a cosine, uphill or downhill for a whole "
        r"half turn.",
        2 * (Q - c**2 * Q - 2 * c * s * B - s**2 * F),
        2 * s**2 * (Q - F) - 2 * s * c * (2 * B),
        [CIRCLE],
    )


def _eigenvector(*, swapped: bool) -> Step:
    K, q, p, a = symmetric("K", 4), quaternion("q"), quaternion("p"), vector("a")
    v, u = scalar("v"), scalar("u")
    L = body(q)
    G = (q.T * K * q)[0] * sympy.eye(3) - L.T * K * L
    image = inner(a, G * L.T * p)
    drop = (u - v) if swapped else (v - u)
    along = inner(a, L.T * p)
    pairs = [
        *contraction(along * q + inner(p, q) * L * a, AT_Q),
        *contraction(-square(q) * L * a, AT_P),
    ]
    return combination(
        r"Let $K q = v q$ and $K p = u p$. Then $G\, L(q)^{\mathsf T} p = |q|^2 (v - u)\, "
        r"L(q)^{\mathsf T} p$, the difference being a combination of the entries of $K q - v q$ "
        r"and $K p - u p$ (contracted with any $a$). Complete a unit eigenvector $q_j$ to an "
        r"orthonormal eigenbasis: the three vectors $L(q_j)^{\mathsf T} q_k$, $k \neq j$, are "
        r"orthonormal (claim `half_turns`) and are eigenvectors of $G$ with the eigenvalues "
        r"$\lambda_j - \lambda_k$.",
        image - square(q) * drop * along,
        pairs,
    )


def _in_the_code(hessian: Hessian, shipped: Callable[[State, Body], Array]) -> Proof:
    state = State(omega=sympy.zeros(3, 1))
    frame = Body(inertia_inverse=sympy.eye(3))
    yield identity(
        r"The function that is turned into code returns this matrix, as a function of $R$ and $C$ "
        r"(per unit of mass): entry by entry the same polynomial.",
        shipped(state, frame),
        hessian(state.R.T * frame.cross),
    )
    stiffness = -intrinsic_jacobian(state, frame)[9:12, 3:6]
    yield identity(
        r"Looking ahead, and not used for the theorem: the linearised dynamics has this Hessian "
        r"for its stiffness. The block of the $12\times12$ matrix that the code takes for the "
        r"intrinsic Jacobian (that it is one is the claim `intrinsic_jacobian`) and that takes "
        r"$\varphi$ to $J \dot\omega$ has the symmetric part $-G$, and at an equilibrium, where "
        r"$R^{\mathsf T} C$ is symmetric, it is $-G$.",
        stiffness + stiffness.T,
        2 * hessian(state.R.T * frame.cross),
    )


def _turned_the_other_way(state: State, body: Body) -> Array:
    return hessian_of(state.R * body.cross)


CLAIM = Claim(
    name="hessian",
    title="The Hessian and its eigenvalues",
    statement=r"The Hessian of $V_p$ in $\varphi$ along $R \exp([\varphi]_\times)$ is $G = 2 "
    r"\operatorname{tr}(R^{\mathsf T} C)\, I - R^{\mathsf T} C - C^{\mathsf T} R = (q^{\mathsf T} "
    r"K q)\, I - L(q)^{\mathsf T} K L(q)$ for $R = R(q)$, $|q| = 1$. At the equilibrium of the "
    r"eigenvector $q_j$ of $K$ its eigenvalues are $\lambda_j - \lambda_k$, $k \neq j$, with the "
    r"eigenvectors $L(q_j)^{\mathsf T} q_k$. Along a turn by $\theta$ about a unit axis $n$ the "
    r"potential changes by $2 s^2\, n^{\mathsf T} G n - 2 s c\, \tau \cdot n$, $c = "
    r"\cos\tfrac\theta2$, $s = \sin\tfrac\theta2$. Without noise $G = 2J$ at the optimum. The "
    r"function that is turned into code returns $G$.",
    concludes=(2, 3, 6, 7, 8, 10),
    hypotheses=(AT_Q, AT_P, CIRCLE),
    setting=(r"$R$ is a rotation; $q_1, \dots, q_4$ is an orthonormal eigenbasis of $K$.",),
    source="ours in this form; the gradient and Hessian of a trace on rotations are classical",
    proof=proof,
    controls={
        "half of it": Mutation(at=2, proof=lambda: proof(hessian=lambda A: hessian_of(A) / 2)),
        "tr(A) for 2 tr(A)": Mutation(
            at=2, proof=lambda: proof(hessian=lambda A: A.trace() * sympy.eye(3) - A - A.T)
        ),
        "2 A for A + A^T, not symmetric": Mutation(
            at=3, proof=lambda: proof(hessian=lambda A: 2 * A.trace() * sympy.eye(3) - 2 * A)
        ),
        "eigenvalues l_k - l_j": Mutation(at=7, proof=lambda: proof(swapped=True)),
        "code that takes R C for R^T C": Mutation(
            at=8, proof=lambda: proof(shipped=_turned_the_other_way)
        ),
        "G = J without noise": Mutation(at=10, proof=lambda: proof(noise_free=1)),
    },
    not_claimed=r"Stability: that needs $J \succ 0$ and damping and is proved in the chapter on "
    r"stability. Away from equilibria the second derivative depends on the curve; "
    r"$R \exp(t[\varphi]_\times)$ is meant.",
    needs=("eigenvectors", "torque", "half_turns"),
    standard=(SPECTRAL,),
    runs=(
        "derivations.linearisation.hessian",
        "derivations.linearisation.intrinsic_jacobian",
    ),
    used_by=(
        "certreg.equilibrium.stability.curvature",
        "certreg.registration.covariance",
    ),
    coq=(
        "first_variation",
        "second_variation",
        "torque_linearised",
        "index_at_eigenvector",
    ),
    not_in_coq=(
        "The eigenvalues of $G$ one by one: in Coq they are counted by sign. That $G = 2J$ "
        "without noise."
    ),
)
