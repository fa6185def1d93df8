"""Claim: the closed ambient 18x18 Jacobian is the derivative of the equations of motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import sympy

from ..algebra import identity
from ..kernel import Claim, Mutation, Proof
from ..linearisation import ambient_jacobian
from ..motion import DAMPING, Body, State, rate
from ..notation import Array, Matrix, hat, jacobian, scalar, vector, vee

Jacobian = Callable[[State, Body], Array]
BLOCKS = (slice(0, 3), slice(3, 12), slice(12, 15), slice(15, 18))  # c, R row by row, v, omega


def proof(closed: Jacobian = ambient_jacobian, *, by_columns: bool = False) -> Proof:
    """The four equations written out, the two derivatives with a rule, then every entry."""
    state, body = State(), Body()
    yield from _equations(state, body)
    yield from _rules(state, body)
    derivative, found = _derivative(by_columns=by_columns), closed(state, body)
    at_c, at_R, at_v, at_omega = BLOCKS
    yield identity(
        r"The rows of $\dot c = v$ and $\dot v = -2c - \mu v$, each of 18 derivatives: constants, "
        r"and nothing couples translation to rotation.",
        [found[at_c, :], found[at_v, :]],
        [derivative[at_c, :], derivative[at_v, :]],
    )
    yield identity(
        r"The nine rows of $\dot R = R [\omega]_\times$. The state holds $R$ row by row, and the "
        r"rows $r_k$ obey $\dot r_k = r_k \times \omega$ each for itself: the derivative with "
        r"respect to $r_k$ is $-[\omega]_\times$, that with respect to $\omega$ is "
        r"$[r_k]_\times$.",
        found[at_R, :],
        derivative[at_R, :],
    )
    yield identity(
        r"The rows of $\dot\omega$: with respect to $r_k$ they are $2 J^{-1} [C_k]_\times$ with "
        r"$C_k$ the $k$-th row of $C$, with respect to $\omega$ they are "
        r"$J^{-1} ([J\omega]_\times - [\omega]_\times J) - \mu I$. So all $324$ entries of the "
        r"closed form are the derivatives of the equations of motion, at every state, for any "
        r"matrix $R$, rotation or not.",
        found[at_omega, :],
        derivative[at_omega, :],
    )


@cache
def _derivative(*, by_columns: bool) -> Array:
    """The symbolic derivative of the shipped rate, by the state with R row by row."""
    state = State()
    R = state.R.T if by_columns else state.R
    return jacobian(rate(state, Body()), [*state.c, *R, *state.v, *state.omega])


def _equations(state: State, body: Body) -> Proof:
    A = state.R.T * body.cross
    momentum = body.inertia * state.omega
    yield identity(
        r"Divide the equations of motion by the mass, so that $C$ and $J$ stand for $C/M$ and "
        r"$J/M$. They are $\dot c = v$, $\dot R = R [\omega]_\times$, $\dot v = -2c - \mu v$ and "
        r"$\dot\omega = J^{-1}\bigl(2 \operatorname{vee}(R^{\mathsf T} C - C^{\mathsf T} R) + "
        r"J\omega \times \omega\bigr) - \mu\omega$. The inverse of $J$ is a matrix of constants, "
        r"so nothing is assumed of it here.",
        rate(state, body),
        [
            *state.v,
            *(state.R * hat(state.omega)),
            *(-2 * state.c - DAMPING * state.v),
            *(
                body.inertia_inverse * (2 * vee(A - A.T) + momentum.cross(state.omega))
                - DAMPING * state.omega
            ),
        ],
    )


def _rules(state: State, body: Body) -> Proof:
    R, C = state.R, body.cross
    A = R.T * C
    rows = [(R.row(k).T, C.row(k).T) for k in range(3)]
    yield identity(
        r"The springs' torque is linear in the rows of $R$: "
        r"$2 \operatorname{vee}(R^{\mathsf T} C - C^{\mathsf T} R) = 2 \sum_k C_k \times r_k$.",
        2 * vee(A - A.T),
        sum((2 * c.cross(r) for r, c in rows), start=sympy.zeros(3, 1)),
    )
    J, omega, d = body.inertia, state.omega, vector("d")
    t = scalar("t")
    moved = omega + t * d
    yield identity(
        r"The gyroscopic torque is quadratic. Along $\omega + t d$ its derivative at $t = 0$ is "
        r"$J d \times \omega + J\omega \times d = "
        r"\bigl([J\omega]_\times - [\omega]_\times J\bigr)\, d$: the product rule has two terms.",
        sympy.diff((J * moved).cross(moved), t).subs(t, 0),
        (hat(J * omega) - hat(omega) * J) * d,
    )


def _of_the_transpose(state: State, body: Body) -> Array:
    return ambient_jacobian(state, replace(body, cross=body.cross.T))


def _without_gyroscopic_term(state: State, body: Body) -> Array:
    return ambient_jacobian(state, replace(body, inertia=sympy.zeros(3, 3)))


def _half_the_springs(state: State, body: Body) -> Array:
    return ambient_jacobian(state, replace(body, cross=body.cross / 2))


def _turned_the_other_way(state: State, body: Body) -> Array:
    found = Matrix(ambient_jacobian(state, body))
    found[3:12, 3:12] = -found[3:12, 3:12]
    return found


CLAIM = Claim(
    name="ambient_jacobian",
    title="The ambient Jacobian",
    statement=r"The closed form $A_{18}$ is the derivative $\partial \mathcal{F} / \partial s$ of "
    r"the equations of motion $\dot s = \mathcal{F}(s)$ in the 18 numbers $s = (c, R, v, \omega)$, "
    r"$R$ row by row, entry by entry. With $r_k$ and $C_k$ for the $k$-th rows of $R$ and $C$, and "
    r"$C$ and $J$ per unit of mass, its blocks that are not zero: $I$ for $\dot c$ by $v$; "
    r"$-[\omega]_\times$ for $\dot r_k$ by $r_k$ and $[r_k]_\times$ by $\omega$; $-2I$ and "
    r"$-\mu I$ for $\dot v$ by $c$ and $v$; $2 J^{-1} [C_k]_\times$ for $\dot\omega$ by $r_k$ and "
    r"$J^{-1} ([J\omega]_\times - [\omega]_\times J) - \mu I$ by $\omega$.",
    concludes=(4, 5, 6),
    setting=(r"$J^{-1}$ is a matrix of constants, of which nothing is used.",),
    source="[Yang2020], the Jacobian of the dynamics, there computed but not written out",
    proof=proof,
    controls={
        "the transpose of C": Mutation(at=6, proof=lambda: proof(closed=_of_the_transpose)),
        "without the gyroscopic term": Mutation(
            at=6, proof=lambda: proof(closed=_without_gyroscopic_term)
        ),
        "half the spring factor": Mutation(at=6, proof=lambda: proof(closed=_half_the_springs)),
        "+[omega] for -[omega]": Mutation(at=5, proof=lambda: proof(closed=_turned_the_other_way)),
        "R column by column": Mutation(at=5, proof=lambda: proof(by_columns=True)),
    },
    not_claimed=r"That its eigenvalues decide stability: six of the 18 belong to perturbations "
    r"that leave the rotations (claim `characteristic_polynomial`). [Yang2020] stacks $R$ column "
    r"by column, which permutes rows and columns alike and keeps the eigenvalues.",
    needs=("euler_poincare", "total_torque"),
    runs=(
        "derivations.linearisation.ambient_jacobian",
        "derivations.motion.rate",
    ),
    used_by=(
        "certreg.dynamics.rigid.RigidBody.ambient_jacobian",
        "derivations.linearisation",
    ),
    coq=(
        "jacobian_is_the_derivative",
        "paper_torque_is_torque",
    ),
    not_in_coq="The blocks at a state that is no equilibrium.",
)
