"""Claim: the closed intrinsic 12x12 Jacobian is the derivative along motions of a rigid body."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import sympy

from ..algebra import combination, contraction, identity
from ..hypotheses import balanced
from ..kernel import Claim, Mutation, Proof
from ..linearisation import hessian, intrinsic_jacobian
from ..motion import Body, State, rate
from ..notation import Array, Matrix, hat, inner, jacobian, vector, vee

Jacobian = Callable[[State, Body], Array]
BALANCED = balanced()
MOVED = vector("d_c"), vector("phi"), vector("d_v"), vector("d_omega")


def proof(closed: Jacobian = intrinsic_jacobian, *, in_space: bool = False) -> Proof:
    """The velocities' rates differentiated along the perturbation, the rate of the angles phi."""
    state, body = State(), Body()
    _, phi, _, d_omega = MOVED
    found = closed(state, body) * Matrix.vstack(*MOVED)
    slope = _along_the_perturbation(state, in_space=in_space)
    yield identity(
        r"Perturb the state to $c + t\, \delta c$, $R \exp(t [\varphi]_\times) = "
        r"R\,(I + t [\varphi]_\times + \dots)$, $v + t\, \delta v$, $\omega + t\, \delta\omega$ "
        r"and differentiate the rates at $t = 0$; terms of second order in $t$ are not seen. By "
        r"the chain rule that is the symbolic derivative by all 18 numbers, applied to "
        r"$(\delta c, R [\varphi]_\times, \delta v, \delta\omega)$. For the translation: "
        r"$\dot{\delta c} = \delta v$ and $\dot{\delta v} = -2\, \delta c - \mu\, \delta v$.",
        [found[0:3, :], found[6:9, :]],
        [slope[0:3, :], slope[12:15, :]],
    )
    turn = hat(phi)
    yield identity(
        r"The derivative of $\dot R = R [\omega]_\times$ is $R \bigl([\varphi]_\times "
        r"[\omega]_\times + [\delta\omega]_\times\bigr)$.",
        slope[3:12, :],
        list(state.R * (turn * hat(state.omega) + hat(d_omega))),
    )
    yield identity(
        r"It is also the rate of $R [\varphi]_\times$, which is "
        r"$R \bigl([\omega]_\times [\varphi]_\times + [\dot\varphi]_\times\bigr)$. $R$ is "
        r"invertible, so $[\dot\varphi]_\times = [\delta\omega]_\times + [\varphi]_\times "
        r"[\omega]_\times - [\omega]_\times [\varphi]_\times$, and this is the cross-product "
        r"matrix of what the closed form says: $\dot\varphi = \delta\omega - \omega \times "
        r"\varphi$.",
        hat(d_omega) + turn * hat(state.omega) - hat(state.omega) * turn,
        hat(found[3:6, :]),
    )
    yield from _spring(state, body)
    yield identity(
        r"With the gyroscopic torque the last three rows are complete: the derivative of "
        r"$\dot\omega$ along the perturbation is $2 J^{-1} \bigl(R^{\mathsf T} C - "
        r"\operatorname{tr}(R^{\mathsf T} C) I\bigr) \varphi + J^{-1} \bigl([J\omega]_\times - "
        r"[\omega]_\times J\bigr) \delta\omega - \mu\, \delta\omega$, with every entry as in the "
        r"closed form.",
        found[9:12, :],
        slope[15:18, :],
    )
    yield from _stiffness(state, body, closed)


def _along_the_perturbation(state: State, *, in_space: bool) -> Array:
    """The derivative of the shipped rate; `in_space` perturbs R from the left, a mistake here."""
    d_c, phi, d_v, d_omega = MOVED
    turned = hat(phi) * state.R if in_space else state.R * hat(phi)
    return _derivative() * Matrix([*d_c, *turned, *d_v, *d_omega])


@cache
def _derivative() -> Array:
    state = State()
    return jacobian(rate(state, Body()), state.flat)


def _spring(state: State, body: Body) -> Proof:
    phi, A = MOVED[1], state.R.T * body.cross
    turned = hat(phi).T * A
    yield identity(
        r"The springs' torque is linear in $R$, so along $R [\varphi]_\times$ it changes by "
        r"$2 \operatorname{vee}\bigl([\varphi]_\times^{\mathsf T} A - A^{\mathsf T} "
        r"[\varphi]_\times\bigr)$ with $A = R^{\mathsf T} C$; and this is "
        r"$2 \bigl(A - \operatorname{tr}(A) I\bigr) \varphi$, for every $A$.",
        2 * vee(turned - turned.T),
        2 * (A - A.trace() * sympy.eye(3)) * phi,
    )


def _stiffness(state: State, body: Body, closed: Jacobian) -> Proof:
    a, phi = vector("a"), MOVED[1]
    block = closed(replace(state, omega=sympy.zeros(3, 1)), body)[9:12, 3:6]
    pulled = body.inertia_inverse * a  # J^-1 is symmetric
    yield combination(
        r"At an equilibrium $R^{\mathsf T} C$ is symmetric (claim `eigenvectors`), and then the "
        r"block that takes $\varphi$ to $\dot\omega$ is $-J^{-1} G$ with the Hessian $G$: for all "
        r"$a$ and $\varphi$ the difference is a combination of the entries of $R^{\mathsf T} C - "
        r"C^{\mathsf T} R$. What pulls the body back is the curvature of the energy, against its "
        r"inertia.",
        inner(a, (block + body.inertia_inverse * hessian(state, body)) * phi),
        contraction(pulled * phi.T, BALANCED),
    )


def _plus_trace(state: State, body: Body) -> Array:
    found = Matrix(intrinsic_jacobian(state, body))
    wrong = state.R.T * body.cross + inner(state.R, body.cross) * sympy.eye(3)
    found[9:12, 3:6] = 2 * body.inertia_inverse * wrong
    return found


def _turned_the_other_way(state: State, body: Body) -> Array:
    found = Matrix(intrinsic_jacobian(state, body))
    found[3:6, 3:6] = -found[3:6, 3:6]
    return found


def _without_gyroscopic_term(state: State, body: Body) -> Array:
    return intrinsic_jacobian(state, replace(body, inertia=sympy.zeros(3, 3)))


def _of_the_transpose(state: State, body: Body) -> Array:
    return intrinsic_jacobian(state, replace(body, cross=body.cross.T))


CLAIM = Claim(
    name="intrinsic_jacobian",
    title="The intrinsic Jacobian",
    statement=r"Describe a small perturbation of a state by $\delta c$, $\varphi$, $\delta v$, "
    r"$\delta\omega$, with $R$ perturbed to $R \exp([\varphi]_\times)$. To first order it obeys "
    r"$\dot{\delta c} = \delta v$, $\dot\varphi = \delta\omega - \omega \times \varphi$, "
    r"$\dot{\delta v} = -2\,\delta c - \mu\,\delta v$ and $\dot{\delta\omega} = "
    r"2 J^{-1} (R^{\mathsf T} C - \operatorname{tr}(R^{\mathsf T} C) I)\, \varphi + "
    r"J^{-1} ([J\omega]_\times - [\omega]_\times J)\, \delta\omega - \mu\, \delta\omega$: the "
    r"closed form $A_{12}$, at every state. At an equilibrium the middle term of the last "
    r"equation is zero and the first is $-J^{-1} G \varphi$ with the Hessian $G$.",
    concludes=(1, 2, 3, 5, 6),
    hypotheses=(BALANCED,),
    setting=(
        (
            r"$R$ may be any matrix; where it is invertible, $\dot\varphi$ is determined. $J^{-1}$ "
            r"is a matrix of constants, of which nothing is used."
        ),
    ),
    source="ours; [Yang2020] linearises in the ambient space",
    proof=proof,
    controls={
        "the trace with a plus": Mutation(at=5, proof=lambda: proof(closed=_plus_trace)),
        "+[omega] for -[omega]": Mutation(at=3, proof=lambda: proof(closed=_turned_the_other_way)),
        "without the gyroscopic term": Mutation(
            at=5, proof=lambda: proof(closed=_without_gyroscopic_term)
        ),
        "the transpose of C": Mutation(at=5, proof=lambda: proof(closed=_of_the_transpose)),
        "perturbed in space, exp([phi]) R": Mutation(at=2, proof=lambda: proof(in_space=True)),
    },
    not_claimed=r"That solutions of the linear equations stay near those of the true ones away "
    r"from an equilibrium: it is a derivative, at one state.",
    needs=("euler_poincare", "total_torque", "eigenvectors", "hessian"),
    runs=(
        "derivations.linearisation.intrinsic_jacobian",
        "derivations.motion.rate",
    ),
    used_by=(
        "certreg.dynamics.rigid.RigidBody.intrinsic_jacobian",
        "certreg.equilibrium.stability",
        "derivations.linearisation",
    ),
    coq=(
        "torque_linearised",
        "second_variation",
    ),
    not_in_coq=r"The $12\times12$ matrix itself, and states that are no equilibria.",
)
