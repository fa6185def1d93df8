r"""One step of the midpoint rule of the breathing body, in closed form.

The velocity of the rotation enters through the spin l = s omega, in which the kinetic energy is
(M |v|^2 + l^T J l + Sxx p^2) / 2. V_p is cubic in (q, s); with the mean of q^T K q before and after
a step, where the scale is driven, and the middle scale, where the rotation is, the springs do
exactly the work by which V_p falls: so the energy of a step falls by what damping takes.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from certreg.geometry.so3 import davenport_matrix

from .breathing_motion import own_size
from .integrators import STEP, middle_quaternion, quaternion_torque
from .motion import DAMPING, Body
from .notation import Array, Matrix, inner, quaternion, scalar, square, vector


@dataclass(frozen=True)
class BreathingQuaternionState:
    """The state with a quaternion: c (3), q (4), scale s, v (3), omega (3), growth p = s'."""

    c: Array = field(default_factory=lambda: vector("c"))
    q: Array = field(default_factory=quaternion)
    scale: Any = field(default_factory=lambda: scalar("s"))
    v: Array = field(default_factory=lambda: vector("v"))
    omega: Array = field(default_factory=lambda: vector("omega"))
    growth: Any = field(default_factory=lambda: scalar("p"))

    @property
    def parts(self) -> dict[str, Any]:
        """c, q, scale, v, omega, growth, in the order in which a state is kept."""
        return {
            "c": self.c,
            "q": self.q,
            "scale": self.scale,
            "v": self.v,
            "omega": self.omega,
            "growth": self.growth,
        }


@dataclass(frozen=True)
class BreathingMiddle:
    """The unknowns of a step: the middle omega_m and p_m."""

    omega: Array = field(default_factory=lambda: vector("middle"))
    growth: Any = field(default_factory=lambda: scalar("middle_p"))

    @property
    def flat(self) -> list[Any]:
        """The four numbers."""
        return [*self.omega, self.growth]


def alignment(q: Any, body: Body) -> Any:
    """q^T K q over M, which is tr(R(q)^T C) over M for |q| = 1."""
    column = Matrix(q)
    return (column.T * Matrix(davenport_matrix(body.cross.tolist())) * column)[0]


def balance(
    state: BreathingQuaternionState,
    body: Body,
    middle: BreathingMiddle,
    middle_q: Any,
    step: Any = STEP,
) -> tuple[Array, Any]:
    """What vanishes at the middle of a step: three numbers of the rotation, one of the scale.

    J (l_m - l) - (h/2) (torque(q_m) - p_m J omega_m - omega_m x J l_m - mu J l_m), and
    Sxx (p_m - p - (h/2) (-2 s_m - mu p_m)) - (h/2) (omega_m^T J l_m + 2 mean of q^T K q).
    """
    omega, p = middle.omega, middle.growth
    s = state.scale + step / 2 * p
    momentum, own = body.inertia * omega, own_size(body)
    springs = quaternion_torque(middle_q, body) - s * omega.cross(momentum)
    spin = body.inertia * (s * omega - state.scale * state.omega)
    turned = spin - step / 2 * (springs - (p + DAMPING * s) * momentum)
    after = 2 * Matrix(middle_q) - Matrix(state.q)
    mean = (alignment(state.q, body) + alignment(after, body)) / 2
    held = p - state.growth + step / 2 * (2 * s + DAMPING * p)
    return turned, own * held - step / 2 * (s * inner(omega, momentum) + 2 * mean)


def midpoint_residual(
    state: BreathingQuaternionState, body: Body, middle: BreathingMiddle
) -> Array:
    """`balance` in the four unknowns alone."""
    turned, breathed = balance(state, body, middle, middle_quaternion(state.q, middle.omega))
    return Matrix([*turned, breathed])


def midpoint_step(
    state: BreathingQuaternionState, middle: BreathingMiddle, step: Any = STEP
) -> Array:
    """The state after a step, given the root (15 numbers); the translation is solved for."""
    middle_v = (state.v - step * state.c) / (1 + step * DAMPING / 2 + step**2 / 2)
    q = 2 * middle_quaternion(state.q, middle.omega, step) - state.q
    middle_scale = state.scale + step / 2 * middle.growth
    scale = 2 * middle_scale - state.scale
    spin = 2 * middle_scale * middle.omega - state.scale * state.omega
    return Matrix(
        [
            *(state.c + step * middle_v),
            *q,
            scale,
            *(2 * middle_v - state.v),
            *(spin / scale),
            2 * middle.growth - state.growth,
        ]
    )


def squared_speed(state: BreathingQuaternionState, body: Body) -> Any:
    """|F(s)|^2 of the 20 rates of change, for |q| = 1: a turn omega moves R by sqrt(2) |omega|."""
    s, omega, p, own = state.scale, state.omega, state.growth, own_size(body)
    momentum = body.inertia * omega
    turning = quaternion_torque(state.q, body) / s - omega.cross(momentum)
    alpha = body.inertia_inverse * turning - (DAMPING + 2 * p / s) * omega
    linear = -2 * state.c - DAMPING * state.v
    pull = (s * inner(omega, momentum) + 2 * alignment(state.q, body)) / own
    stretch = pull - 2 * s - DAMPING * p
    slow = square(state.v) + 2 * square(omega) + p**2
    return slow + square(linear) + square(alpha) + stretch**2
