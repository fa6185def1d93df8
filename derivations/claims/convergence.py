"""Claim: every motion of the body tends to the set of equilibria (hypotheses of LaSalle)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy

from ..algebra import Given, combination, contraction, identity, nonnegative, quoted
from ..hypotheses import SPECTRAL, cofactor_matrix, orthogonality
from ..kernel import Claim, Proof
from ..moments import inertia_of
from ..motion import DAMPING, Body, State, newton_euler, potential_energy, rate, unit_cloud
from ..notation import Array, Matrix, diagonal, gradient, hat, inner, square, vector
from .properness import spin_terms
from .total_torque import spring_part

Rates = Callable[[State, Body], Array]


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
    inverse = body.inertia * body.inertia_inverse - sympy.eye(3)
    return combination(
        r"Along the shipped right-hand side $F$ the energy per unit of mass changes at the rate "
        r"$\nabla V\cdot F = -\mu|v|^2 - \mu\,\omega^{\mathsf T}J\omega$ where $R$ is a rotation "
        r"and $JJ^{-1} = I$: the rest is a combination of the entries of $R^{\mathsf T}R - I$ and "
        r"of $JJ^{-1} - I$. It is never positive (claim `dissipation`).",
        change + loss,
        [
            *contraction(-2 * cloud.source_scatter * hat(state.omega), orthogonality(state.R)),
            *contraction(state.omega * undamped.T, inverse),
        ],
    )


def _only_at_rest() -> Proof:
    J, v, omega = inertia_of(diagonal("d")), vector("v"), vector("omega")
    values = [Given(J[k, k], "J is positive semidefinite") for k in range(3)]
    damping = Given(DAMPING, "the damping is positive")
    whole = J.trace() ** 2
    lost = DAMPING * (square(v) + (omega.T * J * omega)[0])
    yield nonnegative(
        r"The set $\dot V = 0$ is $v = \omega = 0$. In principal axes "
        r"$(\operatorname{tr}J)^2\,(-\dot V) - \mu\,\bigl((\operatorname{tr}J)^2|v|^2 + "
        r"\det(J)\,|\omega|^2\bigr)$ is a sum of nonnegative products. With $\mu > 0$ and $J "
        r"\succ 0$ both squares vanish with $\dot V$.",
        whole * lost - DAMPING * (whole * square(v) + J.det() * square(omega)),
        [[damping, *term] for term in spin_terms(omega, values)],
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
        contraction(-u * torque.T, body.inertia * body.inertia_inverse - sympy.eye(3)),
    )


def _driven(state: State, body: Body) -> Array:
    return rate(state, body).subs(DAMPING, -DAMPING)


def _drifting(state: State, body: Body) -> Array:
    found = rate(state, body)
    return Matrix([*found[:3, :], *(found[3:12, :] + Matrix(list(state.R))), *found[12:, :]])


def _stiffer_torque(state: State, body: Body) -> Array:
    found = rate(state, body)
    spring = body.inertia_inverse * spring_part(state, unit_cloud(body))
    return Matrix([*found[:15, :], *(found[15:, :] + spring)])


CLAIM = Claim(
    name="convergence",
    title="Every motion comes to rest",
    statement=r"If $J \succ 0$ and $\mu > 0$, every solution of the equations of motion on "
    r"$\mathrm{SO}(3)\times\mathbb R^9$ exists for all $t \ge 0$ and tends to the set of "
    r"equilibria $c = v = \omega = 0$, $R^{\mathsf T}C = C^{\mathsf T}R$.",
    assumptions=(
        r"$J \succ 0$: three of the points are not collinear. $\mu > 0$.",
        r"$R(0)$ is a rotation.",
        "The flow is the exact one, not a discretised one.",
    ),
    source="[Yang2020], the proposition on convergence to equilibria; [LaSalle1960]",
    proof=proof,
    controls={
        "drag that drives": lambda: proof(_driven),
        "R that grows": lambda: proof(_drifting),
        "springs of double stiffness in the torque alone": lambda: proof(_stiffer_torque),
    },
    not_claimed="That the limit is the optimum: starts exist that end at a spurious equilibrium. "
    "See `instability`, and `certified_basin` for a test of the state. Nor is any "
    "rate claimed.",
    needs=("dissipation", "properness", "equilibrium_equations", "euler_poincare"),
    standard=(
        SPECTRAL,
        "Solutions of polynomial differential equations are unique and go on while bounded.",
    ),
    used_by=("certreg.dynamics.simulation.simulate", "certreg.dynamics.basin.Basin"),
    not_in_coq=(
        "Neither that solutions exist nor LaSalle's theorem is proved in Coq; "
        "`certified_basin` shows where it is a hypothesis."
    ),
)
