"""Claim: the equations of motion of the body whose size is a state, and that they are shipped."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import sympy

from ..algebra import combination, contraction, identity
from ..breathing_motion import (
    BreathingState,
    acceleration,
    euler_poincare,
    hessian,
    kinetic_energy,
    linearised,
    position,
    potential,
    potential_energy,
    potential_sum,
    rate,
    size,
    velocity,
)
from ..breathing_motion import kinetic as shipped_kinetic
from ..hypotheses import INERTIA_INVERSE, ROTATION, inverted
from ..hypothesis import invertible
from ..kernel import Claim, Mutation, Proof, Step
from ..moments import MomentCloud
from ..motion import DAMPING, Body, unit_cloud
from ..notation import Array, entry, gradient, hat, inner, jacobian, scalar, square, vector

Equations = Callable[[BreathingState, MomentCloud], tuple[Array, Array, Any]]
Rates = Callable[[BreathingState, Body], Array]
Linear = Callable[[BreathingState, Body], Array]
INVERSE = scalar("u")  # of the scale
SIZED = invertible(
    r"$s \ne 0$.",
    scalar("s"),
    INVERSE,
    example={entry("J", 1, 1): 1, entry("J", 2, 2): 1, entry("J", 3, 3): 1}
    | {entry("I", k, k): 1 for k in (1, 2, 3)}
    | {entry("C", 3, 2): 1, entry("R", 1, 1): 1, entry("R", 2, 2): 1, entry("R", 3, 3): 1}
    | {entry("a", 1): 1, scalar("p"): 1, entry("omega", 1): 1},
)
HERE = {entry: int(k % 4 == 0) for k, entry in enumerate(BreathingState().R)}  # R = I
SHIFT, TURN, GROWTH = vector("xi"), vector("phi"), scalar("sigma")
A, ALPHA, B = vector("a"), vector("alpha"), scalar("b")


def proof(
    equations: Equations = euler_poincare, rates: Rates = rate, closed: Linear = linearised
) -> Proof:
    """The energies; two ways to the equations; what damping takes; the shipped code."""
    yield from _energies()
    yield _hamilton(equations)
    yield _dalembert(equations)
    yield _dissipation(equations)
    yield from _rates(equations, rates)
    yield _linear(closed)
    yield _hessian()


def _energies() -> Proof:
    state, cloud = BreathingState(), MomentCloud()
    s, spin = state.scale, state.scale * state.omega.cross(cloud.x) + state.growth * cloud.x
    yield combination(
        r"The springs: $\sum m\,|y - s R x - c|^2 = M |c|^2 + S_{yy} + s^2 S_{xx} - 2 s "
        r"\operatorname{tr}(R^{\mathsf T} C)$. The difference is $s^2 \operatorname{tr}\bigl("
        r"(R^{\mathsf T} R - I) S_2\bigr)$.",
        potential_sum(state, cloud) - potential_energy(state, cloud),
        contraction(s**2 * cloud.source_scatter, ROTATION),
    )
    moved = velocity(state, cloud.x) - state.v
    yield combination(
        r"A point moves with $R\,u + v$, $u = s\,\omega \times x + \dot s\,x$. As $R$ changes no "
        r"length and $\sum m\,x = 0$, the kinetic energy is $\tfrac12 M |v|^2 + \tfrac12 \sum "
        r"m\,|u|^2$.",
        cloud.total(square(moved) - square(spin)) / 2,
        contraction(cloud.total(spin * spin.T) / 2, ROTATION),
    )
    yield identity(
        r"And $\omega \times x$ is across $x$: $\sum m\,|u|^2 = s^2\,\omega^{\mathsf T} J \omega + "
        r"S_{xx}\,\dot s^2$.",
        [(cloud.mass * square(state.v) + cloud.total(square(spin))) / 2, cloud.total(moved)],
        [kinetic_energy(state, cloud), 0, 0, 0],
    )


def _hamilton(equations: Equations) -> Step:
    state, cloud = BreathingState(), MomentCloud()
    kinetic = kinetic_energy(state, cloud)
    lagrangian = kinetic - potential_energy(state, cloud)
    d_shift, d_turn, d_growth = vector("dxi"), vector("dphi"), scalar("dsigma")
    p, spin = gradient(kinetic, state.v), gradient(kinetic, state.omega)
    breath = sympy.diff(kinetic, state.growth)
    varied = (
        inner(gradient(lagrangian, state.c), SHIFT)
        + inner(gradient(lagrangian, state.v), d_shift)
        + inner(gradient(lagrangian, state.R), state.R * hat(TURN))
        + inner(gradient(lagrangian, state.omega), d_turn + state.omega.cross(TURN))
        + sympy.diff(lagrangian, state.scale) * GROWTH
        + breath * d_growth
    )
    drag = -DAMPING * (inner(p, SHIFT) + inner(spin, TURN) + breath * GROWTH)
    d_spin = spin.jacobian(state.omega) * ALPHA + sympy.diff(spin, state.scale) * state.growth
    boundary = (
        inner(p.jacobian(state.v) * A, SHIFT)
        + inner(p, d_shift)
        + inner(d_spin, TURN)
        + inner(spin, d_turn)
        + sympy.diff(breath, state.growth) * B * GROWTH
        + breath * d_growth
    )
    return identity(
        r"Hamilton's principle, with variations $\xi$ of $c$, $R [\varphi]_\times$ of $R$, "
        r"$\sigma$ of $s$: with $L = V_k - V_p$, $\pi = \partial L/\partial\omega = s^2 J\omega$ "
        r"and the work $-\mu\,(M v\cdot\xi + \pi\cdot\varphi + S_{xx}\dot s\,\sigma)$ of the "
        r"damping, $\delta L + \delta W = \frac{d}{dt}(M v\cdot\xi + \pi\cdot\varphi + "
        r"S_{xx}\dot s\,\sigma)$ plus $(f - M\dot v)\cdot\xi + (\tau - s^2 J\dot\omega)\cdot"
        r"\varphi + (g - S_{xx}\ddot s)\,\sigma$, in all jets. So it holds if and only if "
        r"$M\dot v = f$, $s^2 J\dot\omega = \tau$, $S_{xx}\ddot s = g$.",
        varied + drag,
        boundary + _missing(equations, state, cloud),
    )


def _missing(equations: Equations, state: BreathingState, cloud: MomentCloud) -> Any:
    """The power of what the equations leave, along the variations."""
    force, torque, stretch = equations(state, cloud)
    s = state.scale
    return (
        inner(force - cloud.mass * A, SHIFT)
        + inner(torque - s**2 * cloud.inertia * ALPHA, TURN)
        + (stretch - size(cloud) * B) * GROWTH
    )


def _dalembert(equations: Equations) -> Step:
    state, cloud = BreathingState(), MomentCloud()
    return identity(
        r"The same from d'Alembert, point by point: the forces $2m(y - r) - \mu m \dot r$ less "
        r"$m\ddot r$, $r = s R x + c$, do on every virtual motion $\xi + s R (\varphi \times x) + "
        r"\sigma R x$ the work $(f - M\dot v)\cdot\xi + (\tau - s^2 J\dot\omega)\cdot\varphi + "
        r"(g - S_{xx}\ddot s)\,\sigma$; in axes of the target that are those of the body at this "
        r"moment, $R = I$.",
        _virtual_work(),
        _missing(equations, state, cloud).subs(HERE),
    )


@cache
def _virtual_work() -> Any:
    state, cloud = BreathingState(), MomentCloud()
    pull = 2 * (cloud.y - position(state, cloud.x)) - DAMPING * velocity(state, cloud.x)
    left = pull - acceleration(state, cloud.x, A, ALPHA, B)
    shift = state.R * (state.scale * TURN.cross(cloud.x) + GROWTH * cloud.x) + SHIFT
    return cloud.total(inner(left, shift).subs(HERE))


def _dissipation(equations: Equations) -> Step:
    state, cloud = BreathingState(), MomentCloud()
    force, torque, stretch = equations(state, cloud)
    kinetic, potential_of = kinetic_energy(state, cloud), potential_energy(state, cloud)
    changes = (
        inner(gradient(potential_of, state.c), state.v)
        + inner(gradient(potential_of, state.R), state.R * hat(state.omega))
        + sympy.diff(kinetic + potential_of, state.scale) * state.growth
    )
    return identity(
        r"So $\dot V = -\mu\,(M |v|^2 + s^2\,\omega^{\mathsf T} J\omega + S_{xx}\,\dot s^2)$, "
        r"which is $-2\mu V_k$: the energy never rises.",
        changes + inner(state.v, force) + inner(state.omega, torque) + state.growth * stretch,
        -2 * DAMPING * kinetic,
    )


def _rates(equations: Equations, rates: Rates) -> Proof:
    state, body, b = BreathingState(), Body(), vector("a")
    cloud = unit_cloud(body)
    own = size(cloud)
    found = inverted(rates(state, body), {state.scale: INVERSE, own: scalar("w")})
    force, torque, stretch = equations(state, cloud)
    s, p, momentum = state.scale, state.growth, body.inertia * state.omega
    yield identity(
        r"The shipped rates of a body of mass $1$: $\dot c = v$, $\dot R = R[\omega]_\times$, "
        r"$\dot s = p$, $\dot v = f$;",
        found[:16, :],
        [*state.v, *(state.R * hat(state.omega)), p, *force],
    )
    divided = torque.applyfunc(lambda entry: sympy.expand(sympy.expand(entry) / s))
    spring = divided.subs(dict.fromkeys((*state.omega, p), 0))
    turning = spring * INVERSE - state.omega.cross(momentum)
    yield combination(
        r"$s J\dot\omega = \tau/s$, which is a polynomial, for every $a$ a combination of $u s - "
        r"1$ with $u$ for $1/s$ and of the entries of $J J^{-1} - I$. At $s = 0$ it would ask that "
        r"$2\operatorname{vee}(R^{\mathsf T} C - C^{\mathsf T} R) = 2\dot s J\omega$;",
        inner(b, s * body.inertia * found[16:19, :] - divided),
        [
            *contraction(s * b * turning.T, INERTIA_INVERSE),
            (inner(b, spring - 2 * p * momentum), SIZED[0]),
        ],
    )
    drag = -2 * s - DAMPING * p
    yield identity(
        r"and $\ddot s$ is $g/S_{xx}$ (here $\ddot s + 2s + \mu\dot s$, over $1/S_{xx}$).",
        (found[19] - drag) / scalar("w"),
        stretch - own * drag,
    )
    yield _shipped_energies(state, body, cloud)


def _shipped_energies(state: BreathingState, body: Body, cloud: MomentCloud) -> Step:
    return identity(
        r"The shipped energies are these energies, over the mass.",
        [potential(state, body), sum(shipped_kinetic(state, body))],
        [potential_energy(state, cloud), kinetic_energy(state, cloud)],
    )


@cache
def _slope() -> Array:
    state = BreathingState()
    variables = (
        *state.c,
        *state.R,
        state.scale,
        *state.v,
        *state.omega,
        state.growth,
    )
    return jacobian(rate(state, Body()), variables)


def _linear(closed: Linear) -> Step:
    state, body = BreathingState(), Body()
    d_c, d_v, d_omega, d_p = vector("d_c"), vector("d_v"), vector("d_omega"), scalar("d_p")
    moved = sympy.Matrix([*d_c, *TURN, GROWTH, *d_v, *d_omega, d_p])
    turned = [*d_c, *(state.R * hat(TURN)), GROWTH, *d_v, *d_omega, d_p]
    slope = _slope() * sympy.Matrix(turned)
    inverses = {state.scale: INVERSE, body.inertia.trace() / 2: scalar("w")}
    found = inverted(closed(state, body), inverses) * moved
    slope = inverted(slope, inverses)
    turning = hat(TURN) * hat(state.omega) - hat(state.omega) * hat(TURN) + hat(d_omega)
    return identity(
        r"The closed form (14, 14) is the derivative of these rates along $\delta c$, "
        r"$R[\varphi]_\times$, $\delta s$, $\delta v$, $\delta\omega$, $\delta\dot s$, entry by "
        r"entry; for the angles, the matrix of $\dot\varphi$ is $[\delta\omega]_\times + "
        r"[\varphi]_\times[\omega]_\times - [\omega]_\times[\varphi]_\times$, as for the rigid "
        r"body (claim `intrinsic_jacobian`).",
        [*found[:3], *hat(found[3:6, :]), *found[6:]],
        [*slope[:3], *turning, *slope[12:]],
    )


def _hessian() -> Step:
    state, body = BreathingState(), Body()
    phi = sympy.Matrix([*TURN, GROWTH])
    t = scalar("t")
    turn = sympy.eye(3) + t * hat(TURN) + t**2 / 2 * hat(TURN) ** 2
    s = state.scale + t * GROWTH
    aligned = inner(state.R * turn, body.cross)
    along = s**2 * body.inertia.trace() / 2 - 2 * s * aligned
    second = sympy.Poly(sympy.expand(along), t).coeff_monomial(t**2)
    return identity(
        r"The shipped Hessian $H$ of $V_p$ in $(\varphi, s)$, $R\exp([\varphi]_\times)$: the terms "
        r"of second order are half of its quadratic form.",
        second,
        (phi.T * hessian(state, body) * phi)[0] / 2,
    )


def _without_spin(state: BreathingState, cloud: MomentCloud) -> tuple[Array, Array, Any]:
    """The scale is not driven by the rotation: no centrifugal force."""
    force, torque, stretch = euler_poincare(state, cloud)
    pushed = state.scale * (state.omega.T * cloud.inertia * state.omega)[0]
    return force, torque, stretch - pushed


def _without_growth(state: BreathingState, cloud: MomentCloud) -> tuple[Array, Array, Any]:
    """A body that grows turns on as fast."""
    force, torque, stretch = euler_poincare(state, cloud)
    braked = 2 * state.scale * state.growth * cloud.inertia * state.omega
    return force, torque + braked, stretch


def _scaled_torque(state: BreathingState, body: Body) -> Array:
    """The rates with the rigid body's torque, not divided by the scale."""
    return rate(state, body).subs(state.scale, 1)


def _uncoupled(state: BreathingState, body: Body) -> Array:
    """The linearised dynamics where the scale does not feel the rotation."""
    found = linearised(state, body)
    found[13, 10:13] = sympy.zeros(1, 3)
    return found


CLAIM = Claim(
    name="breathing_motion",
    title="The body that breathes: equations of motion with a free scale",
    statement=r"Let the size $s \ne 0$ of the body be a state, a point at $s R x + c$. Its "
    r"energies are $V_p = M|c|^2 + S_{yy} + s^2 S_{xx} - 2 s \operatorname{tr}(R^{\mathsf T} C)$ "
    r"and $V_k = \tfrac12\bigl(M|v|^2 + s^2\,\omega^{\mathsf T} J\omega + S_{xx}\dot s^2\bigr)$. "
    r"Hamilton's principle and Newton's law, point by point, give $\dot v = -2c - \mu v$, $$s^2 "
    r"J\dot\omega = 2 s \operatorname{vee}(R^{\mathsf T} C - C^{\mathsf T} R) - s^2\,\omega \times "
    r"J\omega - (\mu s^2 + 2 s\dot s)\,J\omega,$$ $$S_{xx}\ddot s = s\,\omega^{\mathsf T} J\omega "
    r"- 2 s S_{xx} + 2\operatorname{tr}(R^{\mathsf T} C) - \mu S_{xx}\dot s,$$ and $\dot V = -2\mu "
    r"V_k$. The shipped rates, energies, linearisation and Hessian are these.",
    concludes=tuple(range(1, 13)),
    hypotheses=(ROTATION, SIZED, INERTIA_INVERSE),
    setting=(
        r"$S_{xx} = \sum m|x|^2$, $S_{yy} = \sum m|y|^2$, about the means.",
        r"$J$ is the inertia at $s = 1$; $w$ stands for $1/S_{xx}$.",
    ),
    source="ours; the body of [Yang2020] with one more coordinate",
    proof=proof,
    controls={
        "without the centrifugal force": Mutation(at=4, proof=lambda: proof(_without_spin)),
        "a body that grows turns on as fast": Mutation(at=4, proof=lambda: proof(_without_growth)),
        "the torque of the rigid body": Mutation(
            at=8, proof=lambda: proof(rates=_scaled_torque), point=dict(SIZED.example)
        ),
        "a scale that does not feel the rotation": Mutation(
            at=11, proof=lambda: proof(closed=_uncoupled)
        ),
    },
    not_claimed=r"Anything at $s = 0$, where the inertia $s^2 J$ of the rotation vanishes and the "
    r"equations say nothing of $\dot\omega$.",
    needs=("potential_energy", "kinetic_energy", "inertia", "euler_poincare", "intrinsic_jacobian"),
    runs=(
        "derivations.breathing_motion.rate",
        "derivations.breathing_motion.linearised",
        "derivations.breathing_motion.hessian",
    ),
    used_by=("derivations.breathing_emit",),
    not_in_coq="All of it: the theorems in Coq are about the rigid body.",
)
