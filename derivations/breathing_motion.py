r"""The breathing body: the moving body whose size s is a state, too.

A point stands at s R x + c and moves with s R (omega x x) + s' R x + v. Masses, springs, damping
and moments are those of `motion`; at s = 1, held, it is that body. The state needs s != 0: the
inertia of the rotation is s^2 J.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import sympy
from sympy import eye, zeros

from .linearisation import angular_drag
from .moments import MomentCloud
from .motion import DAMPING, Body, left_gradient
from .notation import Array, Matrix, gradient, hat, inner, matrix, scalar, square, vector, vee


@dataclass(frozen=True)
class BreathingState:
    """The state, as symbols: c (3), R (3, 3), scale s, v (3), omega (3), growth p = s'."""

    c: Array = field(default_factory=lambda: vector("c"))
    R: Array = field(default_factory=lambda: matrix("R"))
    scale: Any = field(default_factory=lambda: scalar("s"))
    v: Array = field(default_factory=lambda: vector("v"))
    omega: Array = field(default_factory=lambda: vector("omega"))
    growth: Any = field(default_factory=lambda: scalar("p"))

    @property
    def parts(self) -> dict[str, Any]:
        """c, R, scale, v, omega, growth, in the order in which a state is kept."""
        return {
            "c": self.c,
            "R": self.R,
            "scale": self.scale,
            "v": self.v,
            "omega": self.omega,
            "growth": self.growth,
        }


def position(state: BreathingState, x: Any) -> Array:
    """Where the body's point x (centred) is: s R x + c, seen from the target's centroid."""
    return state.scale * state.R * x + state.c


def velocity(state: BreathingState, x: Any) -> Array:
    """The velocity of the body's point x: s R (omega x x) + p R x + v."""
    return state.R * (state.scale * state.omega.cross(x) + state.growth * x) + state.v


def acceleration(state: BreathingState, x: Any, a: Any, alpha: Any, b: Any) -> Array:
    """The acceleration of the body's point x, with v' = a, omega' = alpha, p' = b."""
    spin = alpha.cross(x) + state.omega.cross(state.omega.cross(x))
    turned = state.scale * spin + 2 * state.growth * state.omega.cross(x) + b * x
    return state.R * turned + a


def potential_sum(state: BreathingState, cloud: MomentCloud) -> Any:
    """V_p as a sum over the points, m |y - s R x - c|^2, for any matrix R."""
    return cloud.total(square(cloud.y - position(state, cloud.x)))


def kinetic_sum(state: BreathingState, cloud: MomentCloud) -> Any:
    """V_k as a sum over the points, m |velocity|^2 / 2, for any matrix R."""
    return cloud.total(square(velocity(state, cloud.x))) / 2


def size(cloud: MomentCloud) -> Any:
    """Sxx = sum m |x|^2."""
    return cloud.source_scatter.trace()


def potential_energy(state: BreathingState, cloud: MomentCloud) -> Any:
    """V_p = M |c|^2 + Syy + s^2 Sxx - 2 s tr(R^T C), where R is a rotation."""
    s, aligned = state.scale, inner(state.R, cloud.cross)
    rest = cloud.target_scatter.trace() + s**2 * size(cloud) - 2 * s * aligned
    return cloud.mass * square(state.c) + rest


def kinetic_energy(state: BreathingState, cloud: MomentCloud) -> Any:
    """V_k = (M |v|^2 + s^2 omega^T J omega + Sxx p^2) / 2, where R is a rotation."""
    spin = (state.omega.T * cloud.inertia * state.omega)[0]
    rest = state.scale**2 * spin + size(cloud) * state.growth**2
    return (cloud.mass * square(state.v) + rest) / 2


def euler_poincare(state: BreathingState, cloud: MomentCloud) -> tuple[Array, Array, Any]:
    """M v', s^2 J omega' and Sxx p' from L = V_k - V_p with Rayleigh's dissipation mu V_k.

    As `motion.euler_poincare`; the momentum of the rotation, s^2 J omega, also changes with s, and
    p' is driven by dL/ds.
    """
    kinetic, potential = kinetic_energy(state, cloud), potential_energy(state, cloud)
    spin = gradient(kinetic, state.omega)
    force = -gradient(potential, state.c) - DAMPING * gradient(kinetic, state.v)
    turning = spin.cross(state.omega) - left_gradient(potential, state.R) - DAMPING * spin
    stretched = sympy.diff(spin, state.scale) * state.growth
    stretch = sympy.diff(kinetic - potential, state.scale)
    drag = DAMPING * sympy.diff(kinetic, state.growth)
    return force, turning - stretched, stretch - drag


def own_size(body: Body) -> Any:
    """Sxx / M, half the trace of J / M."""
    return body.inertia.trace() / 2


def aligning_torque(R: Array, body: Body) -> Array:
    """The torque 2 vee(R^T C - C^T R) of the springs over M, at scale 1."""
    aligned = R.T * body.cross
    return 2 * vee(aligned - aligned.T)


def rate(state: BreathingState, body: Body) -> Array:
    """The rates s' = F(s), 20 numbers in the order of the state, for a rotation R and s != 0."""
    s, omega, p = state.scale, state.omega, state.growth
    momentum = body.inertia * omega
    turning = aligning_torque(state.R, body) / s - omega.cross(momentum)
    alpha = body.inertia_inverse * turning - (DAMPING + 2 * p / s) * omega
    pull = (s * inner(omega, momentum) + 2 * inner(state.R, body.cross)) / own_size(body)
    return Matrix(
        [
            *state.v,
            *(state.R * hat(omega)),
            p,
            *(-2 * state.c - DAMPING * state.v),
            *alpha,
            pull - 2 * s - DAMPING * p,
        ]
    )


def potential(state: BreathingState, body: Body) -> Any:
    """V_p / M where R is a rotation."""
    s, own = state.scale, own_size(body)
    aligned = inner(state.R, body.cross)
    return square(state.c) + body.spread - own + s**2 * own - 2 * s * aligned


def kinetic(state: BreathingState, body: Body) -> tuple[Any, Any, Any]:
    """V_k / M in three parts: of translation, of rotation, of the scale."""
    spin = (state.omega.T * body.inertia * state.omega)[0]
    breath = own_size(body) * state.growth**2
    return square(state.v) / 2, state.scale**2 * spin / 2, breath / 2


def linearised(state: BreathingState, body: Body) -> Array:
    """The linearised dynamics (14, 14) in delta c, phi, delta s, delta v, delta omega, delta p."""
    s, omega, p, own = state.scale, state.omega, state.growth, own_size(body)
    aligned = state.R.T * body.cross
    spring = 2 * (aligned - inner(state.R, body.cross) * eye(3))
    torque = aligning_torque(state.R, body)
    momentum, inverse = body.inertia * omega, body.inertia_inverse
    drag = angular_drag(omega, body) - 2 * p / s * eye(3)
    none, column, row = zeros(3, 3), zeros(3, 1), zeros(1, 3)
    slowed = -inverse * torque / s**2 + 2 * p / s**2 * omega
    one = sympy.ones(1, 1)
    blocks = [
        [none, none, column, eye(3), none, column],
        [none, -hat(omega), column, none, eye(3), column],
        [row, row, zeros(1, 1), row, row, one],
        [-2 * eye(3), none, column, -DAMPING * eye(3), none, column],
        [none, inverse * spring / s, slowed, none, drag, -2 / s * omega],
        [
            row,
            torque.T / own,
            one * (inner(omega, momentum) / own - 2),
            row,
            2 * s * momentum.T / own,
            -DAMPING * one,
        ],
    ]
    return Matrix(blocks)


def hessian(state: BreathingState, body: Body) -> Array:
    """The Hessian (4, 4) of V_p / M in (phi, s), R turned to R exp([phi]x)."""
    aligned = state.R.T * body.cross
    G = 2 * inner(state.R, body.cross) * eye(3) - aligned - aligned.T
    cross = -aligning_torque(state.R, body)
    return Matrix([[state.scale * G, cross], [cross.T, Matrix([2 * own_size(body)])]])
