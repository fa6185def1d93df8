r"""The moving body: state, Lagrangian, and the equations of motion derived from it.

The state is the paper's s = (c, R, v, omega): c the centre of mass of the source minus that of the
target, R the orientation, v = c', omega the angular velocity in the body frame. Masses are m_i,
springs 2 m_i, damping mu m_i. All sums over points go through the moment functional, so N is any
number of points.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import sympy

from .moments import MomentCloud
from .notation import Array, Matrix, gradient, hat, inner, matrix, scalar, square, symmetric, vector


@dataclass(frozen=True)
class State:
    """The paper's state, as symbols: c (3), R (3, 3) any matrix, v (3), omega (3)."""

    c: Array = field(default_factory=lambda: vector("c"))
    R: Array = field(default_factory=lambda: matrix("R"))
    v: Array = field(default_factory=lambda: vector("v"))
    omega: Array = field(default_factory=lambda: vector("omega"))

    @property
    def parts(self) -> dict[str, Any]:
        """c, R, v, omega, in the order in which a state is kept."""
        return {"c": self.c, "R": self.R, "v": self.v, "omega": self.omega}

    @property
    def flat(self) -> Array:
        """The 18 numbers of the parts, R row by row."""
        return flat(self.parts)


def flat(parts: Mapping[str, Any]) -> Array:
    """All numbers of matrices (row by row), sequences and numbers, one after the other."""
    rows = [value if hasattr(value, "__len__") else [value] for value in parts.values()]
    return Matrix([entry for row in rows for entry in row])


DAMPING = scalar("mu")


def position(state: State, x: Any) -> Array:
    """Where the body's point x (centred) is: R x + c, seen from the target's centroid."""
    return state.R * x + state.c


def velocity(state: State, x: Any) -> Array:
    """The velocity R (omega x x) + v of the body's point x."""
    return state.R * state.omega.cross(x) + state.v


def potential_energy(state: State, cloud: MomentCloud) -> Any:
    """V_p: the springs' energy, the sum of m |y - R x - c|^2 (spring 2 m, energy half of it)."""
    return cloud.total(square(cloud.y - position(state, cloud.x)))


def kinetic_energy(state: State, cloud: MomentCloud) -> Any:
    """V_k as the sum of m |velocity|^2 / 2, for any matrix R."""
    return cloud.total(square(velocity(state, cloud.x))) / 2


def body_kinetic_energy(state: State, cloud: MomentCloud) -> Any:
    """V_k = M |v|^2 / 2 + omega^T J omega / 2, which the sum is where R is a rotation."""
    rotational = (state.omega.T * cloud.inertia * state.omega)[0]
    return (cloud.mass * square(state.v) + rotational) / 2


def spring_force(state: State, cloud: MomentCloud) -> Array:
    """The total spring force, the sum of 2 m (y - R x - c), in the target's frame."""
    return cloud.total(2 * (cloud.y - position(state, cloud.x)))


def spring_torque(state: State, cloud: MomentCloud) -> Array:
    """The total spring torque of the paper in the body frame, the sum of x times 2 m R^T (y - c).

    The paper writes the force in the body frame with x for R^T R x: the same where R is a rotation.
    """
    pull = 2 * (state.R.T * (cloud.y - state.c) - cloud.x)
    return cloud.total(cloud.x.cross(pull))


def newton_euler(state: State, cloud: MomentCloud) -> tuple[Array, Array]:
    """M a and J alpha of the paper: total force, and total torque less omega x J omega."""
    damping = DAMPING * cloud.total(state.R * hat(state.omega) * cloud.x + state.v)
    drag = DAMPING * cloud.total(cloud.x.cross(state.omega.cross(cloud.x)))
    momentum = cloud.inertia * state.omega
    force = spring_force(state, cloud) - damping
    return force, spring_torque(state, cloud) - drag - state.omega.cross(momentum)


def left_gradient(function: Any, R: Array) -> Array:
    """The derivative of a function of R along R exp([phi]x) with respect to phi, at phi = 0."""
    slope = gradient(function, R)
    return Matrix([inner(slope, R * hat(axis)) for axis in sympy.eye(3).columnspace()])


def euler_poincare(state: State, cloud: MomentCloud) -> tuple[Array, Array]:
    """M a and J alpha from the Lagrangian L = V_k - V_p with Rayleigh's dissipation mu V_k.

    d/dt dL/dv = dL/dc - dD/dv and, with p = dL/domega in the body frame,
    p' = p x omega + (derivative of L along R exp([phi]x)) - dD/domega.
    """
    kinetic = body_kinetic_energy(state, cloud)
    potential = potential_energy(state, cloud)
    momentum = gradient(kinetic, state.omega)
    force = -gradient(potential, state.c) - DAMPING * gradient(kinetic, state.v)
    torque = -left_gradient(potential, state.R) - DAMPING * momentum
    return force, torque + momentum.cross(state.omega)


@dataclass(frozen=True)
class Body:
    """The constants of the dynamics per unit of mass, the parameters of the generated code.

    cross C / M; inertia J / M; inertia_inverse, the inverse of that; spread
    (tr T2 + tr S2) / M. On SO(3) the energies and rates need no more, but the damping.
    """

    cross: Array = field(default_factory=lambda: matrix("C"))
    inertia: Array = field(default_factory=lambda: symmetric("J"))
    inertia_inverse: Array = field(default_factory=lambda: symmetric("I"))
    spread: Any = field(default_factory=lambda: scalar("spread"))

    @property
    def parts(self) -> dict[str, Any]:
        """What is kept of a body, in order: of both inertias the upper triangles."""
        return {
            "cross": self.cross,
            "inertia": upper_triangle(self.inertia),
            "inertia_inverse": upper_triangle(self.inertia_inverse),
            "spread": self.spread,
            "damping": DAMPING,
        }

    @property
    def flat(self) -> Array:
        """The 23 numbers of the parts, cross row by row."""
        return flat(self.parts)


def upper_triangle(A: Array) -> list[Any]:
    """The entries 11 12 13 22 23 33 of a symmetric matrix."""
    return [A[i, j] for i in range(3) for j in range(i, 3)]


def unit_cloud(body: Body) -> MomentCloud:
    """The cloud of mass 1 with the body's moments: S2 = tr(J)/2 I - J, target scatter the rest."""
    scatter = body.inertia.trace() / 2 * sympy.eye(3) - body.inertia
    target = Matrix(3, 3, lambda i, j: (body.spread - scatter.trace()) if i == j == 0 else 0)
    return MomentCloud(
        mass=sympy.Integer(1), source_scatter=scatter, target_scatter=target, cross=body.cross
    )


def rate(state: State, body: Body) -> Array:
    """The rates s' = F(s), 18 numbers in the order of the state: `newton_euler` solved for them.

    For any 3x3 matrix R, as in the paper. With the inverse of J as a parameter; J^-1 mu J omega is
    written mu omega.
    """
    force, torque = newton_euler(state, unit_cloud(body))
    undamped = torque.subs(DAMPING, 0)
    alpha = body.inertia_inverse * undamped - DAMPING * state.omega
    return Matrix([*state.v, *(state.R * hat(state.omega)), *force, *alpha])


def potential(state: State, body: Body) -> Any:
    """V_p / M where R is a rotation: |c|^2 + spread - 2 tr(R^T C)."""
    return square(state.c) + body.spread - 2 * inner(state.R, body.cross)


def kinetic(state: State, body: Body) -> tuple[Any, Any]:
    """V_k / M in two parts: of translation |v|^2 / 2, and of rotation omega^T J omega / 2."""
    return square(state.v) / 2, (state.omega.T * body.inertia * state.omega)[0] / 2
