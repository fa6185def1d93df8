"""Claim: Lagrange's equations in Cayley's parameters are Euler's equations of the body."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import sympy

from certreg.geometry.so3 import body_frame

from ..algebra import flat, identity, ring_of
from ..kernel import Claim, Mutation, Proof
from ..moments import MomentCloud
from ..motion import DAMPING, State, newton_euler
from ..notation import Array, Matrix, hat, inner, matrix, rotation, scalar, square, vector
from .total_torque import drag_part, spring_part

Equations = Callable[[State, MomentCloud], tuple[Array, Array]]


@dataclass(frozen=True)
class Chart:
    """Cayley's parameters p with their first two derivatives, and s = 1 / (1 + |p|^2)."""

    p: Array = field(default_factory=lambda: vector("p"))
    speed: Array = field(default_factory=lambda: vector("dp"))
    acceleration: Array = field(default_factory=lambda: vector("ddp"))
    s: Any = field(default_factory=lambda: scalar("s"))

    @property
    def orientation(self) -> Array:
        """R = s |q|^2 R(q) for q = (1, p)."""
        return self.s * rotation((1, *self.p))

    @property
    def frame(self) -> Array:
        """B (3, 3) with omega = B p': twice s times the lower part of L(q), transposed."""
        return 2 * self.s * Matrix(body_frame((1, *self.p)))[1:, :].T

    def slope(self, function: Any, k: int) -> Any:
        """The derivative with respect to p_k, s being a function of p: ds/dp_k = -2 p_k s^2."""
        through = function.diff(self.s) * (-2 * self.p[k] * self.s**2)
        return function.diff(self.p[k]) + through

    def rate(self, function: Any) -> Any:
        """The derivative along a motion, from those in p and in p'."""
        moved = [self.slope(function, k) * self.speed[k] for k in range(3)]
        pushed = [function.diff(self.speed[k]) * self.acceleration[k] for k in range(3)]
        return sum(moved + pushed, start=0 * function)

    def inside(self, ring: Any) -> Chart:
        """The chart with generators of a ring for its symbols: sparse polynomials, fast."""
        made = dict(zip(ring.symbols, ring.gens, strict=True))
        parts = [
            [made[entry] for entry in part] for part in (self.p, self.speed, self.acceleration)
        ]
        return Chart(*parts, s=made[self.s])

    def cleared(self, *sides: Any) -> tuple[list[Any], ...]:
        """Both sides of an equation times the least power of 1 + |p|^2 that clears s of both."""
        expressions = [flat(side) for side in sides]
        n = 1 + square(self.p)
        ring = ring_of([n, *(e for side in expressions for e in side)], first=[self.s])
        values = [[ring.from_expr(e) for e in side] for side in expressions]
        largest = max((k[0] for side in values for value in side for k in value), default=0)
        powers = [ring.from_expr(n) ** (largest - k) for k in range(largest + 1)]
        return tuple([_put(powers, value).as_expr() for value in side] for side in values)


def _put(powers: list[Any], value: Any) -> Any:
    """The polynomial with powers[k] for the k-th power of its first symbol."""
    parts = [value.ring.zero for _ in powers]
    for (k, *rest), coefficient in value.terms():
        parts[k][(0, *rest)] = coefficient
    return sum((part * power for part, power in zip(parts, powers, strict=True)), value.ring.zero)


def closed_form(state: State, cloud: MomentCloud) -> Array:
    """The torque of springs and drag less omega x J omega."""
    gyroscopic = state.omega.cross(cloud.inertia * state.omega)
    return spring_part(state, cloud) + drag_part(state, cloud) - gyroscopic


def proof(equations: Equations = newton_euler, *, chart: Chart | None = None) -> Proof:
    """Kinematics of the chart; kinetic, potential and dissipative part; all together."""
    chart = chart or Chart()
    state, cloud = State(), MomentCloud()
    yield identity(
        r"What is to be found again: the right-hand side of Euler's equation $J\alpha = \tau - "
        r"\omega\times J\omega$, with $\tau = 2\operatorname{vee}(R^{\mathsf T}C - "
        r"C^{\mathsf T}R) - \mu J\omega$ (claim `total_torque`).",
        equations(state, cloud)[1],
        closed_form(state, cloud),
    )
    yield from _kinematics(chart)
    yield from _springs(chart)
    yield from _together(chart)


def _kinematics(chart: Chart) -> Proof:
    R, B = chart.orientation, chart.frame
    omega = B * chart.speed
    turning = chart.rate(R)
    yield identity(
        r"Cayley's parameters $p\in\mathbb R^3$ give the quaternion $q = (1, p)$ and, with $s = "
        r"1/(1+|p|^2)$, the rotation $R(p) = s\hat R(q)$, all but the half turns. Its angular "
        r"velocity is $\omega = B(p)\,\dot p$, $B = 2s\,(I - [p]_\times)$: "
        r"$\dot R = R[B\dot p]_\times$, multiplied out with $(1+|p|^2)^2$.",
        *chart.cleared(
            [*turning, *B], [*(R * hat(omega)), *(2 * chart.s * (sympy.eye(3) - hat(chart.p)))]
        ),
    )
    yield identity(
        r"$\det B = 8s^2 \ne 0$. So $\dot p$ and $\omega$ determine each other, and an equation "
        r"multiplied by $B^{\mathsf T}$ says what it said before.",
        *chart.cleared([B.det(method="berkowitz")], [8 * chart.s**2]),
    )
    m = vector("m")
    slopes = [[chart.slope(omega[i], k) for k in range(3)] for i in range(3)]
    yield identity(
        r"The coordinates of $\omega$ are no derivatives of coordinates. How far they are from it: "
        r"$\bigl(\dot B - \partial(B\dot p)/\partial p\bigr)^{\mathsf T} m = "
        r"B^{\mathsf T}(\omega\times m)$ for every vector $m$. This is where the gyroscopic term "
        r"comes from.",
        *chart.cleared((chart.rate(B) - Matrix(slopes)).T * m, B.T * omega.cross(m)),
    )


def _springs(chart: Chart) -> Proof:
    cloud, R0 = MomentCloud(), matrix("Q")
    R = chart.orientation
    pulled = 2 * inner(R, cloud.cross)
    torque = -spring_part(State(R=R), cloud)
    yield identity(
        r"The springs' energy on rotations is a constant less $2\operatorname{tr}(R^{\mathsf "
        r"T}C)$. Its slope in $p$ is $-B^{\mathsf T}$ times the spring torque of the body.",
        *chart.cleared([-chart.slope(pulled, k) for k in range(3)], chart.frame.T * torque),
    )
    yield identity(
        r"The half turns need no chart of their own. About any rotation $Q$ the parameters of "
        r"$Q\,R(p)$ serve: $\operatorname{tr}((QR)^{\mathsf T}C) = "
        r"\operatorname{tr}(R^{\mathsf T}Q^{\mathsf T}C)$, the same problem with $Q^{\mathsf T}C$ "
        r"for $C$. As $Q$ is constant, $(QR)^{\mathsf T}\frac{d}{dt}(QR) = (QR)^{\mathsf T} QR\, "
        r"[\omega]_\times = [\omega]_\times$: $\omega$, and with it the kinetic energy and the "
        r"drag, are what they were.",
        inner(R0 * R, cloud.cross),
        inner(R, R0.T * cloud.cross),
    )


def _together(chart: Chart) -> Proof:
    cloud, B = MomentCloud(), chart.frame
    J, omega = cloud.inertia, chart.frame * chart.speed
    energy = inner(omega, J * omega) / 2
    pulled = 2 * inner(chart.orientation, cloud.cross)
    torque = closed_form(State(R=chart.orientation, omega=omega), cloud)
    yield identity(
        r"All together: with $T = \tfrac12\,\omega^{\mathsf T}J\omega$ and $L = T - V_p$ pulled "
        r"back to $p$ and $\dot p$, Lagrange's equations $\frac{d}{dt}\frac{\partial "
        r"L}{\partial\dot p} - \frac{\partial L}{\partial p} + \mu\frac{\partial T}{\partial\dot "
        r"p} = 0$, computed from these energies alone, are $B^{\mathsf T}\bigl(J\alpha + "
        r"\omega\times J\omega - \tau\bigr) = 0$ with $\alpha = \dot\omega$ and the paper's "
        r"torque $\tau$, drag included. As $B$ is invertible, they hold if and only if Euler's "
        r"equation does.",
        *chart.cleared(_lagrange(chart, energy, pulled), B.T * (J * chart.rate(omega) - torque)),
    )


def _lagrange(chart: Chart, kinetic: Any, pulled: Any) -> list[Any]:
    """d/dt dT/dp' - dT/dp - d(pulled)/dp + mu dT/dp', pulled being the energy lost, -V_p."""
    ring = ring_of([kinetic, pulled, DAMPING, *chart.acceleration])
    T, P, mu = (ring.from_expr(e) for e in (kinetic, pulled, DAMPING))
    inside = chart.inside(ring)
    momenta = [T.diff(speed) for speed in inside.speed]
    equations = [
        inside.rate(momentum) - inside.slope(T + P, k) + mu * momentum
        for k, momentum in enumerate(momenta)
    ]
    return [equation.as_expr() for equation in equations]


def _without_gyroscope(state: State, cloud: MomentCloud) -> tuple[Array, Array]:
    force, torque = newton_euler(state, cloud)
    return force, torque + state.omega.cross(cloud.inertia * state.omega)


def _backwards(state: State, cloud: MomentCloud) -> tuple[Array, Array]:
    flipped = MomentCloud(source_scatter=cloud.source_scatter, cross=-cloud.cross)
    return newton_euler(state, flipped)


class _SpaceFrame(Chart):
    """The angular velocity in the target's frame, by mistake."""

    @property
    def frame(self) -> Array:
        return 2 * self.s * (sympy.eye(3) + hat(self.p))


CLAIM = Claim(
    name="cayley_chart",
    title="The same equations from an independent chart",
    statement=r"In Cayley's parameters $p$, $R = R((1, p))$, Lagrange's equations with Rayleigh's "
    r"dissipation are $B^{\mathsf T}(J\alpha + \omega\times J\omega - \tau) = 0$ with $\omega = "
    r"B\dot p$, $\det B = 8/(1+|p|^2)^2$: equivalent to Euler's equation of the body.",
    concludes=(1, 2, 7),
    setting=(
        (
            r"$R = R(p)$ is no half turn; about another rotation $Q$ the chart is $Q\,R(p)$. "
            r"$s = 1/(1+|p|^2)$, by which everything is multiplied out."
        ),
    ),
    source="[Yang2020], the proposition on the dynamics; the chart is not in the paper",
    proof=proof,
    controls={
        "angular velocity in the target's frame": Mutation(
            at=2, proof=lambda: proof(chart=_SpaceFrame())
        ),
        "no gyroscopic term": Mutation(at=1, proof=lambda: proof(_without_gyroscope)),
        "springs that push": Mutation(at=1, proof=lambda: proof(_backwards)),
    },
    not_claimed="That one chart covers all rotations: none of dimension three does.",
    needs=("euler_poincare", "quaternions", "potential_energy", "kinetic_energy"),
    runs=("derivations.motion.newton_euler",),
    not_in_coq=(
        "In Coq the equations of motion are a definition, written point by point; no "
        "principle of mechanics leads to them there."
    ),
)
