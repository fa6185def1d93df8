r"""One step of each integrator, in closed form: what the generated code evaluates.

`euler`: explicit Euler with projection to the nearest rotation, the paper's scheme.
`midpoint`: the implicit midpoint rule in quaternions, reduced to three unknowns.
`splitting`: kick with exact damping, then drift; one evaluation of the springs a step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import sympy

from certreg.geometry.so3 import body_frame, davenport_matrix

from .motion import DAMPING, Body, State, flat, rate
from .notation import Array, Matrix, hat, quaternion, scalar, square, vector

STEP = scalar("h")
DECAY = scalar("decay")  # exp(-mu h)
IMPULSE = scalar("impulse")  # (1 - exp(-mu h)) / mu

# Gives an intermediate value a name, so that generated code computes it once: symbols for it.
Naming = Callable[[str, Any], Any]


@dataclass(frozen=True)
class QuaternionState:
    """The state with a quaternion for the orientation: c (3), q (4), v (3), omega (3)."""

    c: Array = field(default_factory=lambda: vector("c"))
    q: Array = field(default_factory=quaternion)
    v: Array = field(default_factory=lambda: vector("v"))
    omega: Array = field(default_factory=lambda: vector("omega"))

    @property
    def parts(self) -> dict[str, Any]:
        """c, q, v, omega, in the order in which a state is kept."""
        return {"c": self.c, "q": self.q, "v": self.v, "omega": self.omega}

    @property
    def flat(self) -> Array:
        """The 13 numbers of the parts."""
        return flat(self.parts)


def plain(name: str, value: Any) -> Any:
    """The value itself, without a name."""
    del name
    return value


def polar_turn(angle: Any, root: Any, naming: Naming = plain) -> Array:
    """The rotation nearest to I + [a]x: I / n + [a]x / n + a a^T / (n (n + 1)), n^2 = 1 + |a|^2.

    Which is I + [a]x / n + [a]x^2 / (n (n + 1)). angle: a (3). root: n, an expression, or a symbol
    to be read as that root.
    """
    small = naming("small", 1 / naming("both", root * (root + 1)))
    cosine = naming("cosine", (root + 1) * small)
    sine, share = naming("sine", cosine * Matrix(angle)), naming("share", small * Matrix(angle))
    return cosine * sympy.eye(3) + hat(sine) + share * Matrix(angle).T


def euler_step(state: State, body: Body, step: Any = STEP, naming: Naming = plain) -> Array:
    """The paper's step s + h F(s), R + h R' projected to the nearest rotation (18 numbers)."""
    rates = rate(state, body)
    angle = naming("angle", step * state.omega)
    root = naming("root", sympy.sqrt(1 + square(angle)))
    turned = state.R * naming("turn", polar_turn(angle, root, naming))
    centre = state.c + step * state.v
    speeds = Matrix([*state.v, *state.omega]) + step * rates[12:, :]
    return Matrix([*centre, *turned, *speeds])


def quaternion_torque(q: Any, body: Body) -> Array:
    """The spring torque 2 L(q)^T K q over M, for a quaternion of any norm (times |q|^2)."""
    K = Matrix(davenport_matrix(body.cross.tolist()))
    L = Matrix(body_frame(tuple(q)))
    return 2 * (L.T * (K * Matrix(q)))


def accelerations(state: QuaternionState, body: Body) -> tuple[Array, Array]:
    """The rates v' and omega' of the equations of motion, for |q| = 1."""
    turning = quaternion_torque(state.q, body) - state.omega.cross(body.inertia * state.omega)
    linear = -2 * state.c - DAMPING * state.v
    return linear, body.inertia_inverse * turning - DAMPING * state.omega


def squared_speed(state: QuaternionState, body: Body) -> Any:
    """|s'|^2 of the paper's 18 numbers, for |q| = 1: a turn omega moves R by sqrt(2) |omega|."""
    linear, angular = accelerations(state, body)
    return square(state.v) + 2 * square(state.omega) + square(linear) + square(angular)


def middle_direction(q: Any, middle_omega: Any, step: Any = STEP) -> Array:
    """The vector q + (h/4) L(q) omega_m: the middle quaternion times `middle_stretch`."""
    turn = Matrix(body_frame(tuple(q))) * Matrix(middle_omega)
    return Matrix(q) + step / 4 * turn


def middle_stretch(middle_omega: Any, step: Any = STEP) -> Any:
    """The number 1 + h^2 |omega_m|^2 / 16."""
    return 1 + step**2 * square(middle_omega) / 16


def middle_quaternion(q: Any, middle_omega: Any, step: Any = STEP) -> Array:
    """The solution q_m of q_m = q + (h/4) L(q_m) omega_m; not of norm one."""
    return middle_direction(q, middle_omega, step) / middle_stretch(middle_omega, step)


def angular_balance(middle_q: Any, omega: Any, body: Body, middle_omega: Any, step: Any) -> Array:
    """What vanishes at the middle of a midpoint step, given the middle quaternion (3 numbers).

    J (omega_m - omega) - (h/2) (torque(q_m) - omega_m x J omega_m - mu J omega_m).
    """
    middle = Matrix(middle_omega)
    momentum = body.inertia * middle
    balance = quaternion_torque(middle_q, body) - middle.cross(momentum) - DAMPING * momentum
    return body.inertia * (middle - Matrix(omega)) - step / 2 * balance


def midpoint_residual(
    state: QuaternionState, body: Body, middle_omega: Any, step: Any = STEP
) -> Array:
    """`angular_balance` in the middle angular velocity omega_m alone: three equations for it."""
    middle_q = middle_quaternion(state.q, middle_omega, step)
    return angular_balance(middle_q, state.omega, body, middle_omega, step)


def midpoint_step(state: QuaternionState, middle_omega: Any, step: Any = STEP) -> Array:
    """The state after a step of the midpoint rule, given the root omega_m (13 numbers).

    The translation is linear, so its middle is solved for: v_m (1 + h mu/2 + h^2/2) = v - h c.
    """
    middle_v = (state.v - step * state.c) / (1 + step * DAMPING / 2 + step**2 / 2)
    q = 2 * middle_quaternion(state.q, middle_omega, step) - state.q
    c = state.c + step * middle_v
    return Matrix([*c, *q, *(2 * middle_v - state.v), *(2 * Matrix(middle_omega) - state.omega)])


def kick(state: QuaternionState, body: Body) -> tuple[Array, Array]:
    """The velocities after a kick with exact damping: e v + i (force), e omega + i (torque).

    e = exp(-mu h) and i = (1 - e) / mu are parameters (`DECAY`, `IMPULSE`).
    """
    momentum = body.inertia * state.omega
    torque = quaternion_torque(state.q, body) - state.omega.cross(momentum)
    v = DECAY * state.v - 2 * IMPULSE * state.c
    return v, DECAY * state.omega + IMPULSE * body.inertia_inverse * torque


def drift(q: Any, omega: Any, step: Any = STEP) -> Array:
    """The quaternion after a drift, not normalised: q + (h/2) L(q) omega, Cayley's rotation."""
    return Matrix(q) + step / 2 * Matrix(body_frame(tuple(q))) * Matrix(omega)


def splitting_step(state: QuaternionState, body: Body, step: Any = STEP) -> Array:
    """A kick, then a drift with the new velocities, q normalised (13 numbers)."""
    v, omega = kick(state, body)
    moved = drift(state.q, omega, step)
    return Matrix([*(state.c + step * v), *(moved / sympy.sqrt(square(moved))), *v, *omega])
