r"""One step of each integrator on springs that are matrices, in closed form.

`splitting`: kick with exact damping, then drift, as on isotropic springs.
`midpoint`: V_p is quadratic in (c, R), R a quadratic form in q. With the means c_m and R_m of c and
R before and after the step, and the middle quaternion q_m, the springs do exactly the work by which
V_p falls: so the energy of a step falls by what damping takes, as on isotropic springs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import sympy

from .integrators import (
    DECAY,
    IMPULSE,
    STEP,
    Naming,
    QuaternionState,
    drift,
    middle_quaternion,
    plain,
)
from .motion import DAMPING
from .notation import Array, Matrix, jacobian, matrix, quaternion, rotation, square, vector
from .spring_motion import SpringBody, pull, spring_force, torque_of


def springs_at(
    state: QuaternionState, body: SpringBody, naming: Naming = plain
) -> tuple[Array, Array]:
    """Force, and torque less omega x J omega, over M, for |q| = 1."""
    R = naming("R", rotation(state.q))
    pulled = naming("pull", pull(state.c, R, body))
    momentum = body.inertia * state.omega
    turning = torque_of(pulled, R) - state.omega.cross(momentum)
    return naming("force", spring_force(state.c, R, body)), naming("turning", turning)


def accelerations(
    state: QuaternionState, springs: tuple[Array, Array], body: SpringBody
) -> tuple[Array, Array]:
    """The rates v' and omega' of the equations of motion, given `springs_at`."""
    force, turning = springs
    return force - DAMPING * state.v, body.inertia_inverse * turning - DAMPING * state.omega


def squared_speed(state: QuaternionState, springs: tuple[Array, Array], body: SpringBody) -> Any:
    """|s'|^2 of the paper's 18 numbers, for |q| = 1: a turn omega moves R by sqrt(2) |omega|."""
    linear, angular = accelerations(state, springs, body)
    return square(state.v) + 2 * square(state.omega) + square(linear) + square(angular)


def splitting_step(
    state: QuaternionState, springs: tuple[Array, Array], body: SpringBody, step: Any = STEP
) -> Array:
    """A kick with exact damping, then a drift with the new velocities, q normalised (13)."""
    force, turning = springs
    v = DECAY * state.v + IMPULSE * force
    omega = DECAY * state.omega + IMPULSE * body.inertia_inverse * turning
    moved = drift(state.q, omega, step)
    return Matrix([*(state.c + step * v), *(moved / sympy.sqrt(square(moved))), *v, *omega])


@dataclass(frozen=True)
class Middle:
    """The unknowns of a midpoint step: the middle velocities v_m and omega_m."""

    v: Array
    omega: Array

    @property
    def flat(self) -> list[Any]:
        """The six numbers."""
        return [*self.v, *self.omega]


def middle() -> Middle:
    """The unknowns as symbols."""
    return Middle(vector("middle_v"), vector("middle"))


def balance(
    state: QuaternionState,
    body: SpringBody,
    middle: Middle,
    turn: Array,
    mean: Array,
    step: Any = STEP,
) -> Array:
    """What vanishes at the middle of a step (6): both equations of motion over the step.

    turn: R(q_m), a multiple of a rotation; mean: R_m, the mean of the rotations before and after.
    """
    c = state.c + step / 2 * middle.v
    force = spring_force(c, mean, body) - DAMPING * middle.v
    momentum = body.inertia * middle.omega
    torque = torque_of(pull(c, mean, body), turn) - middle.omega.cross(momentum)
    spin = body.inertia * (middle.omega - state.omega) - step / 2 * (torque - DAMPING * momentum)
    return Matrix([*(middle.v - state.v - step / 2 * force), *spin])


def turn_and_mean(q: Array, middle_q: Array) -> Array:
    """R(q_m), and the mean of R(q) and R(2 q_m - q): 18 numbers."""
    after = 2 * middle_q - Matrix(q)
    return Matrix([*rotation(middle_q), *((rotation(q) + rotation(after)) / 2)])


def midpoint_residual(state: QuaternionState, body: SpringBody, middle: Middle) -> Array:
    """`balance` in the six unknowns alone."""
    q = middle_quaternion(state.q, middle.omega)
    both = turn_and_mean(state.q, q)
    return balance(state, body, middle, Matrix(3, 3, both[:9]), Matrix(3, 3, both[9:]))


def midpoint_system(
    state: QuaternionState, body: SpringBody, middle: Middle, naming: Naming = plain
) -> tuple[Array, Array]:
    """`midpoint_residual` and its Jacobian (6, 6), by the chain rule through q_m and R_m."""
    solved = middle_quaternion(state.q, middle.omega)
    q, turn, mean = quaternion("p"), matrix("D"), matrix("N")
    both = turn_and_mean(state.q, q)
    found = balance(state, body, middle, turn, mean)
    inner_slope = jacobian(found, [*turn, *mean])  # (6, 18)
    outer = jacobian(both, q)  # (18, 4)
    named_q = naming("q", solved)
    in_q = dict(zip(q, named_q, strict=True))
    named_both = naming("both", both.subs(in_q, simultaneous=True))
    known = dict(zip([*turn, *mean], named_both, strict=True))
    slope = naming("slope", jacobian(solved, middle.omega))  # (4, 3)
    moved = naming("moved", outer.subs(in_q, simultaneous=True) * slope)  # (18, 3)
    direct = jacobian(found, middle.flat)
    pulled = naming("pulled", _substituted(inner_slope, known))
    along = direct.copy()
    along[:, 3:] = direct[:, 3:] + pulled * moved
    return _substituted(found, known), _substituted(along, known)


def _substituted(expressions: Array, known: dict[Any, Any]) -> Array:
    return expressions.subs(known, simultaneous=True)


def midpoint_step(state: QuaternionState, middle: Middle, step: Any = STEP) -> Array:
    """The state after a step of the midpoint rule, given the root (13 numbers)."""
    q = 2 * middle_quaternion(state.q, middle.omega, step) - state.q
    c = state.c + step * middle.v
    return Matrix([*c, *q, *(2 * middle.v - state.v), *(2 * middle.omega - state.omega)])


def middle_parts(unknowns: Sequence[Any]) -> Middle:
    """The unknowns of six numbers."""
    return Middle(Matrix(list(unknowns[:3])), Matrix(list(unknowns[3:])))
