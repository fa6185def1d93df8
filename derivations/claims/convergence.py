"""Claim: every motion of the body tends to the set of equilibria (hypotheses of LaSalle)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy

from ..algebra import Square, combination, contraction, identity, positive, quoted
from ..hypotheses import (
    DAMPED,
    INERTIA_INVERSE,
    PRINCIPAL,
    ROTATION,
    SPECTRAL,
    cofactor_matrix,
    orthogonality,
)
from ..hypothesis import Standing, nonzero
from ..kernel import Claim, Mutation, Proof
from ..moments import inertia_of
from ..motion import DAMPING, Body, State, newton_euler, potential_energy, rate, unit_cloud
from ..notation import Array, Matrix, diagonal, gradient, hat, inner, square, vector
from .total_torque import spring_part

Rates = Callable[[State, Body], Array]
TURNING = nonzero(r"The body turns, $\omega \ne 0$.", vector("omega"), standing=Standing.CASE)
MOVING = nonzero(r"The body moves, $v \ne 0$.", vector("v"), standing=Standing.CASE)


def energy(state: State, body: Body) -> Any:
    """(V_k + V_p) / M for any matrix R."""
    spin = (state.omega.T * body.inertia * state.omega)[0]
    return (square(state.v) + spin) / 2 + potential_energy(state, unit_cloud(body))


def proof(rates: Rates = rate) -> Proof:
    """SO(3) is invariant; V falls along the shipped rates; where it stays; the conclusion."""
    state, body = State(), Body()
    found = rates(state, body)
    yield from _stays_on_rotations(state, found)
    yield _falls(state, body, found)
    yield from _only_at_rest()
    yield from _stays_at_rest(rates)
    yield quoted(
        r"LaSalle's invariance principle: if the state stays in a compact set on which $V$ never "
        r"increases along the flow, it tends to the largest invariant set in $\{\dot V = 0\}$. "
        r"What it needs was checked: $F$ is a polynomial, so the flow exists as long as it is "
        r"bounded and is unique; $\{V \le E\}$ is compact (claim `properness`) and invariant. "
        r"What it gives: every motion from any rotation, with any speeds, tends to the set of "
        r"equilibria. The set of its limits is connected, so where the equilibria are isolated it "
        r"tends to one of them.",
        theorem="LaSalle's principle",
        source="[LaSalle1960]",
    )


def _stays_on_rotations(state: State, found: Array) -> Proof:
    R, turning = state.R, Matrix(3, 3, list(found[3:12, :]))
    E, spin = orthogonality(R), hat(state.omega)
    yield identity(
        r"Along the flow $E = R^{\mathsf T}R - I$ obeys the linear equation $\dot E = "
        r"E[\omega]_\times - [\omega]_\times E$. A solution that starts at $E = 0$ stays there, so "
        r"$R$ stays orthogonal.",
        turning.T * R + R.T * turning,
        E * spin - spin * E,
    )
    yield identity(
        r"And $\det R$ is constant, its derivative being $\langle\operatorname{cof}R, \dot "
        r"R\rangle = \det(R)\operatorname{tr}[\omega]_\times = 0$: a rotation stays a rotation.",
        inner(cofactor_matrix(R), turning),
        0,
    )


def _falls(state: State, body: Body, found: Array) -> Any:
    """dV/dt along F, as a combination of the entries of R^T R - I and of J J^-1 - I."""
    value = energy(state, body)
    cloud = unit_cloud(body)
    change = inner(gradient(value, state.flat), found)
    loss = DAMPING * (square(state.v) + (state.omega.T * body.inertia * state.omega)[0])
    undamped = newton_euler(state, cloud)[1] + DAMPING * body.inertia * state.omega
    return combination(
        r"Along the shipped right-hand side $F$ the energy per unit of mass changes at the rate "
        r"$\nabla V\cdot F = -\mu|v|^2 - \mu\,\omega^{\mathsf T}J\omega$ where $R$ is a rotation "
        r"and $JJ^{-1} = I$: the rest is a combination of the entries of $R^{\mathsf T}R - I$ and "
        r"of $JJ^{-1} - I$. It is never positive (claim `dissipation`).",
        change + loss,
        [
            *contraction(-2 * cloud.source_scatter * hat(state.omega), ROTATION),
            *contraction(state.omega * undamped.T, INERTIA_INVERSE),
        ],
    )


def _only_at_rest() -> Proof:
    J, v, omega = inertia_of(diagonal("d")), vector("v"), vector("omega")
    damping, lost = DAMPED[0], DAMPING * (square(v) + (omega.T * J * omega)[0])
    moving = [[damping, Square(speed)] for speed in v]
    turning = [[damping, j, Square(speed)] for j, speed in zip(PRINCIPAL.parts, omega, strict=True)]
    yield positive(
        r"The set $\dot V = 0$ is $v = \omega = 0$. In principal axes, $J = "
        r"\operatorname{diag}(j_1, j_2, j_3)$, the loss is $-\dot V = \mu\,\bigl(|v|^2 + \sum_k "
        r"j_k \omega_k^2\bigr)$: with $\mu > 0$ and $J \succ 0$ it is positive where the body "
        r"turns,",
        lost,
        [*moving, *([damping, PRINCIPAL[k], Square(TURNING[k])] for k in range(3))],
    )
    yield positive(
        r"and where it moves.",
        lost,
        [*([damping, Square(speed)] for speed in MOVING.parts), *turning],
    )


def _stays_at_rest(rates: Rates) -> Proof:
    rest, body = State(v=sympy.zeros(3, 1), omega=sympy.zeros(3, 1)), Body()
    found, torque = rates(rest, body), spring_part(rest, unit_cloud(body))
    yield identity(
        r"On that set $F$ is $\dot c = 0$, $\dot R = 0$, $\dot v = -2c$, $\dot\omega = "
        r"J^{-1}\tau$. A motion that stays in it keeps $v = \omega = 0$, so both accelerations "
        r"vanish all the time: $c = 0$ and $J^{-1}\tau = 0$.",
        found,
        Matrix([*[0] * 12, *(-2 * rest.c), *(body.inertia_inverse * torque)]),
    )
    u = vector("u")
    yield combination(
        r"And then $\tau = 0$: $u\cdot\tau - (Ju)\cdot J^{-1}\tau$ is a combination of the "
        r"entries of $JJ^{-1} - I$. Conversely $F = 0$ where $c = 0$ and $\tau = 0$. The largest "
        r"invariant set in $\{\dot V = 0\}$ is the set of equilibria, $c = 0$, $R^{\mathsf T}C = "
        r"C^{\mathsf T}R$.",
        inner(u, torque) - inner(body.inertia * u, found[15:, :]),
        contraction(-u * torque.T, INERTIA_INVERSE),
    )


def _driven(state: State, body: Body) -> Array:
    return rate(state, body).subs(DAMPING, -DAMPING)


def _drifting(state: State, body: Body) -> Array:
    found = rate(state, body)
    return Matrix([*found[:3, :], *(found[3:12, :] + Matrix(list(state.R))), *found[12:, :]])


def _wound_up(state: State, body: Body) -> Array:
    """A constant moment besides the springs."""
    found = rate(state, body)
    return Matrix([*found[:15, :], *(found[15:, :] + body.inertia_inverse * vector("g"))])


CLAIM = Claim(
    name="convergence",
    title="Every motion comes to rest",
    statement=r"If $J \succ 0$ and $\mu > 0$, every solution of the equations of motion on "
    r"$\mathrm{SO}(3)\times\mathbb R^9$ exists for all $t \ge 0$ and tends to the set of "
    r"equilibria $c = v = \omega = 0$, $R^{\mathsf T}C = C^{\mathsf T}R$. Along it $R$ stays a "
    r"rotation, and the energy per unit of mass falls at the rate $\mu|v|^2 + "
    r"\mu\,\omega^{\mathsf T}J\omega$.",
    concludes=(1, 2, 3, 4, 5, 6, 7),
    hypotheses=(ROTATION, INERTIA_INVERSE, PRINCIPAL, DAMPED, TURNING, MOVING),
    setting=("The flow is the exact one, not a discretised one.",),
    source="[Yang2020], the proposition on convergence to equilibria; [LaSalle1960]",
    proof=proof,
    controls={
        "drag that drives": Mutation(at=3, proof=lambda: proof(_driven)),
        "R that grows": Mutation(at=1, proof=lambda: proof(_drifting)),
        "a constant moment besides the springs": Mutation(at=3, proof=lambda: proof(_wound_up)),
    },
    not_claimed="That the limit is the optimum: starts exist that end at a spurious equilibrium. "
    "See `instability`, and `certified_basin` for a test of the state. Nor is any "
    "rate claimed.",
    needs=("dissipation", "properness", "equilibrium_equations", "euler_poincare"),
    standard=(
        SPECTRAL,
        "Solutions of polynomial differential equations are unique and go on while bounded.",
    ),
    runs=("derivations.motion.rate",),
    used_by=(
        "certreg.dynamics.simulation.simulate",
        "certreg.dynamics.body.Basin",
    ),
    not_in_coq=(
        "Neither that solutions exist nor LaSalle's theorem is proved in Coq; "
        "`certified_basin` shows where it is a hypothesis."
    ),
)
