"""Claim: Hamilton's principle with Rayleigh's dissipation gives the paper's Newton-Euler equations.

And the shipped right-hand side is those equations, solved for the accelerations.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..algebra import combination, contraction, identity
from ..hypotheses import INERTIA_INVERSE, ROTATION
from ..kernel import Claim, Mutation, Proof
from ..moments import MomentCloud
from ..motion import (
    DAMPING,
    Body,
    State,
    body_kinetic_energy,
    euler_poincare,
    newton_euler,
    potential_energy,
    rate,
    unit_cloud,
)
from ..notation import Array, Matrix, gradient, hat, inner, scalar, vector

Equations = Callable[[State, MomentCloud], tuple[Array, Array]]
Rates = Callable[[State, Body], Array]


def proof(
    equations: Equations = euler_poincare,
    newton: Equations = newton_euler,
    rates: Rates = rate,
) -> Proof:
    """Variations of a rotation; integration by parts; the paper's equations; the shipped rates."""
    yield _variations_commute()
    yield _by_parts(equations)
    yield from _same_as_newton(equations, newton)
    yield from _per_unit_of_mass(newton)
    yield from _solved(newton, rates)


def _variations_commute() -> Any:
    omega, phi, slope = vector("omega"), vector("phi"), vector("dphi")
    R = State().R
    along_time = R * hat(omega) * hat(phi) + R * hat(slope)
    turned = slope + omega.cross(phi)
    return identity(
        r"A varied path turns the body by a small vector $\varphi(t)$ in its own frame: "
        r"$\delta R = R[\varphi]_\times$. Time derivative and variation commute, $\delta(\dot R) = "
        r"(\delta R)^{\cdot}$, if and only if the angular velocity varies by $\delta\omega = "
        r"\dot\varphi + \omega\times\varphi$.",
        R * hat(phi) * hat(omega) + R * hat(turned),
        along_time,
    )


def _by_parts(equations: Equations) -> Any:
    """The varied action is d/dt(momenta . variations) + (equations) . variations, in jets."""
    state, cloud = State(), MomentCloud()
    a, alpha = vector("a"), vector("alpha")
    xi, dxi, phi, dphi = vector("xi"), vector("dxi"), vector("phi"), vector("dphi")
    kinetic = body_kinetic_energy(state, cloud)
    lagrangian = kinetic - potential_energy(state, cloud)
    p, spin = gradient(kinetic, state.v), gradient(kinetic, state.omega)
    varied = (
        inner(gradient(lagrangian, state.c), xi)
        + inner(gradient(lagrangian, state.v), dxi)
        + inner(gradient(lagrangian, state.R), state.R * hat(phi))
        + inner(gradient(lagrangian, state.omega), dphi + state.omega.cross(phi))
    )
    drag = -DAMPING * (inner(p, xi) + inner(spin, phi))
    dp, dspin = p.jacobian(state.v) * a, spin.jacobian(state.omega) * alpha
    boundary = inner(dp, xi) + inner(p, dxi) + inner(dspin, phi) + inner(spin, dphi)
    force, torque = equations(state, cloud)
    return identity(
        r"Let $L = V_k - V_p$, $\delta c = \xi$, and let Rayleigh's dissipation $\mu V_k$ (that "
        r"is, $\tfrac12\mu\sum m\,|\dot r|^2$) do the work $-\mu\,(\partial V_k/\partial "
        r"v\cdot\xi + \partial V_k/\partial\omega\cdot\varphi)$. With the momenta $p = Mv$ and "
        r"$\pi = J\omega$, $\;\delta L + \delta W = \frac{d}{dt}(p\cdot\xi + \pi\cdot\varphi) + "
        r"(f - Ma)\cdot\xi + (\tau + \pi\times\omega - J\alpha)\cdot\varphi$ as polynomials in "
        r"the jets $v, a, \omega, \alpha, \xi, \dot\xi, \varphi, \dot\varphi$. The integral of "
        r"the first term vanishes with the variations at both ends; $\xi$ and $\varphi$ are "
        r"arbitrary between, so Hamilton's principle holds if and only if $Ma = f$ and $J\alpha = "
        r"\tau - \omega\times J\omega$, with the force $f$ and the torque $\tau$ of springs and "
        r"drag.",
        varied + drag,
        boundary + inner(force - cloud.mass * a, xi) + inner(torque - cloud.inertia * alpha, phi),
    )


def _same_as_newton(equations: Equations, newton: Equations) -> Proof:
    state, cloud, phi = State(), MomentCloud(), vector("phi")
    force, torque = equations(state, cloud)
    paper_force, paper_torque = newton(state, cloud)
    yield identity(
        r"The force $f$ is the one that the paper adds up over the particles, for every matrix "
        r"$R$.",
        force,
        paper_force,
    )
    yield combination(
        r"So is the torque where $R$ is a rotation: along any $\varphi$ the two differ by "
        r"$-2\operatorname{tr}(S_2 R^{\mathsf T}R[\varphi])$, which is $-2\langle [\varphi]S_2,\, "
        r"R^{\mathsf T}R - I\rangle$ because $\operatorname{tr}(S_2[\varphi]) = 0$. The principle "
        r"knows rotations only, so this is no gap: on $\mathrm{SO}(3)$ Hamilton, with Rayleigh, "
        r"gives the Newton-Euler equations of the paper.",
        inner(phi, torque - paper_torque),
        contraction(-2 * hat(phi) * cloud.source_scatter, ROTATION),
    )


def _per_unit_of_mass(newton: Equations) -> Proof:
    state, body, M = State(), Body(), scalar("M")
    unit = unit_cloud(body)
    whole = MomentCloud(
        mass=M,
        source_scatter=M * unit.source_scatter,
        target_scatter=M * unit.target_scatter,
        cross=M * unit.cross,
    )
    yield identity(
        r"The shipped dynamics knows the moments per unit of mass. $S_2 = \tfrac12\operatorname{tr}"
        r"(J)\,I - J$ gives back the inertia $J = \operatorname{tr}(S_2)\,I - S_2$, and the trace "
        r"of both scatters the spread.",
        [unit.inertia, unit.source_scatter.trace() + unit.target_scatter.trace()],
        [body.inertia, body.spread],
    )
    yield identity(
        r"Force and torque are linear in the moments: those of the whole cloud are $M$ times those "
        r"of the cloud of mass 1, so both sides of the equations can be divided by the mass.",
        newton(state, whole),
        [M * part for part in newton(state, unit)],
    )


def _solved(newton: Equations, rates: Rates) -> Proof:
    state, body, phi = State(), Body(), vector("phi")
    force, torque = newton(state, unit_cloud(body))
    found = rates(state, body)
    yield identity(
        r"The shipped right-hand side $F(s)$ holds $\dot c = v$, $\dot R = R[\omega]_\times$ and "
        r"$\dot v = f/M$, entry by entry.",
        found[:15, :],
        Matrix([*state.v, *(state.R * hat(state.omega)), *force]),
    )
    undamped = torque + DAMPING * body.inertia * state.omega
    yield combination(
        r"Its last three entries $\dot\omega$ solve Euler's equation: along any $\varphi$, "
        r"$J\dot\omega - (\tau - \omega\times J\omega)$ is a combination of the entries of "
        r"$J J^{-1} - I$, the inverse being a parameter of the code. So $F$ is the Newton-Euler "
        r"equations divided by the mass, and nothing else.",
        inner(phi, body.inertia * found[15:, :] - torque),
        contraction(phi * undamped.T, INERTIA_INVERSE),
    )


def _without_gyroscope(state: State, body: Body) -> Array:
    found = rate(state, body)
    gyroscopic = body.inertia_inverse * state.omega.cross(body.inertia * state.omega)
    return Matrix([*found[:15, :], *(found[15:, :] + gyroscopic)])


def _precessing_backwards(state: State, cloud: MomentCloud) -> tuple[Array, Array]:
    force, torque = euler_poincare(state, cloud)
    return force, torque + 2 * state.omega.cross(cloud.inertia * state.omega)


def _drag_once_more(state: State, cloud: MomentCloud) -> tuple[Array, Array]:
    force, torque = newton_euler(state, cloud)
    return force - DAMPING * cloud.mass * state.v, torque


def _wrong_handed(state: State, body: Body) -> Array:
    found = rate(state, body)
    turned = hat(state.omega) * state.R
    return Matrix([*found[:3, :], *turned, *found[12:, :]])


CLAIM = Claim(
    name="euler_poincare",
    title="From the Lagrangian to the equations of motion",
    statement=r"For $L = V_k - V_p$ with Rayleigh's dissipation $\tfrac12\mu\sum m\,|\dot r|^2$, "
    r"Hamilton's principle on $\mathbb R^3\times\mathrm{SO}(3)$ holds if and only if $\dot c = v$, "
    r"$\dot R = R[\omega]_\times$, $Ma = f$ and $J\alpha = \tau - \omega\times J\omega$ with the "
    r"paper's force and torque. The shipped right-hand side is these equations divided by $M$ and "
    r"solved for the accelerations.",
    concludes=(2, 3, 4, 7, 8),
    hypotheses=(ROTATION, INERTIA_INVERSE),
    source="[Yang2020], the proposition on the dynamics",
    proof=proof,
    controls={
        "gyroscopic term with the other sign": Mutation(
            at=2, proof=lambda: proof(_precessing_backwards)
        ),
        "rates without the gyroscopic term": Mutation(
            at=8, proof=lambda: proof(rates=_without_gyroscope)
        ),
        "drag counted twice": Mutation(at=3, proof=lambda: proof(newton=_drag_once_more)),
        "R turned from the left": Mutation(at=7, proof=lambda: proof(rates=_wrong_handed)),
    },
    not_claimed="Anything off $\\mathrm{SO}(3)$: there the principle says nothing, while the "
    "shipped rates are the paper's formula for any matrix $R$.",
    needs=("kinetic_energy", "potential_energy", "total_force", "total_torque"),
    standard=("The fundamental lemma of the calculus of variations.",),
    runs=("derivations.motion.rate",),
    used_by=("certreg.dynamics.rigid.RigidBody.rate",),
    not_in_coq=(
        "In Coq the equations of motion are a definition, written point by point; no "
        "principle of mechanics leads to them there."
    ),
)
