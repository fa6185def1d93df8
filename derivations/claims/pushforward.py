"""Claim: the ambient Jacobian, on perturbations of a rigid body, is the intrinsic one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy

from ..algebra import combination, contraction, identity
from ..hypotheses import WHERE_ROTATION
from ..kernel import Claim, Mutation, Proof
from ..linearisation import ambient_jacobian, intrinsic_jacobian, pushforward
from ..motion import Body, State, rate
from ..notation import Array, Matrix, hat, inner, scalar, square, vector

Push = Callable[[State], Array]


def proof(push: Push = pushforward, *, moving: int = 1, length: int = 2) -> Proof:
    """What P is, its image, how it moves with the flow, and the two Jacobians."""
    state, body = State(), Body()
    d_c, phi, d_v, d_omega = (vector(name) for name in ("d_c", "phi", "d_v", "d_omega"))
    yield identity(
        r"The $18\times12$ matrix $P$ writes a perturbation $(\delta c, \varphi, \delta v, "
        r"\delta\omega)$ as a change of the 18 numbers: $\delta R = R [\varphi]_\times$, row by "
        r"row, and the rest as it is.",
        push(state) * Matrix.vstack(d_c, phi, d_v, d_omega),
        [*d_c, *(state.R * hat(phi)), *d_v, *d_omega],
    )
    R, omega = state.R, state.omega
    P = push(state)
    yield from _injective(P, length)
    along = _along_the_flow(state, body, push)
    yield identity(
        r"$P$ depends on $R$ only, linearly. Along the flow, where $\dot R = R [\omega]_\times$ is "
        r"what the equations of motion say, its derivative $P'$ has the blocks "
        r"$[r_k \times \omega]_\times$, with $r_k$ the rows of $R$, and zeros.",
        along,
        sympy.diag(
            sympy.zeros(3, 3),
            Matrix.vstack(*[hat(R.row(k).T.cross(omega)) for k in range(3)]),
            sympy.zeros(6, 6),
        ),
    )
    yield identity(
        r"With $A_{18}$ the ambient and $A_{12}$ the intrinsic Jacobian, $A_{18} P = P' + "
        r"P A_{12}$, at every state and for any matrix $R$. So if $x(t)$ solves the intrinsic "
        r"linear equation along a motion, $P x$ solves the ambient one: the derivative of $P x$ "
        r"is $P' x + P A_{12} x = A_{18} P x$.",
        ambient_jacobian(state, body) * P,
        moving * along + P * intrinsic_jacobian(state, body),
    )
    yield from _at_rest(push)


def _along_the_flow(state: State, body: Body, push: Push) -> Array:
    """The derivative of P along the shipped rate, by the chain rule."""
    t = scalar("t")
    turning = Matrix(3, 3, list(rate(state, body)[3:12]))
    return push(State(R=state.R + t * turning)).diff(t)


def _at_rest(push: Push) -> Proof:
    rest, body = State(omega=sympy.zeros(3, 1)), Body()
    yield identity(
        r"At an equilibrium $\omega = 0$, so $P' = 0$ and $A_{18} P = P A_{12}$. An eigenvector "
        r"$x$ of $A_{12}$ gives $A_{18} P x = \lambda P x$: with $P$ injective, every eigenvalue "
        r"of the intrinsic Jacobian is one of the ambient Jacobian, on the tangent space of the "
        r"states of a rigid body.",
        ambient_jacobian(rest, body) * push(rest),
        push(rest) * intrinsic_jacobian(rest, body),
    )


def _injective(P: Array, length: int) -> Proof:
    R = State().R
    x = Matrix.vstack(*(vector(name) for name in ("d_c", "phi", "d_v", "d_omega")))
    phi, rest = x[3:6, :], [*x[0:3, :], *x[6:12, :]]
    cofactors: Any = square(phi) * sympy.eye(3) - phi * phi.T
    yield combination(
        r"$P$ is injective on rotations: $|P x|^2 = |\delta c|^2 + 2 |\varphi|^2 + |\delta v|^2 + "
        r"|\delta\omega|^2$, the difference being a combination of the entries of "
        r"$R^{\mathsf T} R - I$. So $P x = 0$ only for $x = 0$, and the image of $P$ has 12 "
        r"dimensions of the 18.",
        square(P * x) - square(rest) - length * square(phi),
        contraction(cofactors, WHERE_ROTATION),
    )
    symmetric_part = R.T * R * hat(phi) + (R * hat(phi)).T * R
    a, b = vector("a"), vector("b")
    yield combination(
        r"That is all the room there is: the six equations $R^{\mathsf T} R = I$ have the "
        r"derivative $R^{\mathsf T} \delta R + \delta R^{\mathsf T} R$, and for "
        r"$\delta R = R [\varphi]_\times$ it vanishes where $R^{\mathsf T} R = I$.",
        inner(a, symmetric_part * b),
        contraction(a * (hat(phi) * b).T + (hat(phi) * a) * b.T, WHERE_ROTATION),
    )


def _by_columns(state: State) -> Array:
    return pushforward(State(R=state.R.T))


def _in_space(state: State) -> Array:
    """The change [phi] R for R [phi]."""
    blocks = [hat(axis) * state.R for axis in sympy.eye(3).columnspace()]
    turned = Matrix([list(block) for block in blocks]).T
    return sympy.diag(sympy.eye(3), turned, sympy.eye(3), sympy.eye(3))


CLAIM = Claim(
    name="pushforward",
    title="From the intrinsic to the ambient Jacobian",
    statement=r"Let $P$ take $(\delta c, \varphi, \delta v, \delta\omega)$ to the change of the 18 "
    r"numbers $(c, R, v, \omega)$ with $\delta R = R [\varphi]_\times$, and let $P'$ be its "
    r"derivative along the flow. Then $A_{18} P = P' + P A_{12}$ at every state; at an "
    r"equilibrium $A_{18} P = P A_{12}$. On rotations $P$ is injective.",
    concludes=(1, 2, 3, 5, 6),
    hypotheses=(WHERE_ROTATION,),
    setting=(r"$J^{-1}$ is a matrix of constants, of which nothing is used.",),
    source="ours; the chain rule for the embedding of SO(3) into the 3x3 matrices",
    proof=proof,
    controls={
        "P with R column by column": Mutation(at=1, proof=lambda: proof(push=_by_columns)),
        "P that turns in space": Mutation(at=1, proof=lambda: proof(push=_in_space)),
        "without the derivative of P": Mutation(at=5, proof=lambda: proof(moving=0)),
        "|phi|^2 for 2 |phi|^2": Mutation(at=2, proof=lambda: proof(length=1)),
    },
    not_claimed=r"What the ambient Jacobian does to perturbations that are not in the image of "
    r"$P$: they leave the rotations (claim `characteristic_polynomial`).",
    needs=("ambient_jacobian", "intrinsic_jacobian"),
    runs=(
        "derivations.linearisation.pushforward",
        "derivations.linearisation.ambient_jacobian",
        "derivations.linearisation.intrinsic_jacobian",
    ),
    used_by=(
        "certreg.dynamics.rigid.RigidBody.ambient_jacobian",
        "certreg.dynamics.rigid.RigidBody.intrinsic_jacobian",
    ),
    not_in_coq=r"The $12\times12$ Jacobian is not written down in Coq.",
)
