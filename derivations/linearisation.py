r"""Closed forms of the linearised dynamics: ambient 18x18 and intrinsic 12x12.

Nothing is differentiated here; the claims `ambient_jacobian`, `intrinsic_jacobian` and
`pushforward` prove that these are the derivatives of `motion.rate`. They are what is shipped.
"""

from __future__ import annotations

import sympy
from sympy import eye, zeros

from .motion import DAMPING, Body, State
from .notation import Array, Matrix, hat, inner


def ambient_jacobian(state: State, body: Body) -> Array:
    """dF/ds (18, 18) in the paper's state c, R row by row, v, omega, for any matrix R."""
    rows = [state.R.row(k).T for k in range(3)]
    springs = [body.inertia_inverse * 2 * hat(body.cross.row(k)) for k in range(3)]
    turning = sympy.diag(*[-hat(state.omega)] * 3)
    return _assembled(
        [zeros(3, 3), zeros(3, 9), eye(3), zeros(3, 3)],
        [zeros(9, 3), turning, zeros(9, 3), Matrix.vstack(*map(hat, rows))],
        [-2 * eye(3), zeros(3, 9), -DAMPING * eye(3), zeros(3, 3)],
        [zeros(3, 3), Matrix.hstack(*springs), zeros(3, 3), angular_drag(state.omega, body)],
    )


def intrinsic_jacobian(state: State, body: Body) -> Array:
    """The linearised dynamics (12, 12) in delta c, phi, delta v, delta omega with dR = R [phi]x."""
    aligned = state.R.T * body.cross
    spring = 2 * (aligned - inner(state.R, body.cross) * eye(3))
    return _assembled(
        [zeros(3, 3), zeros(3, 3), eye(3), zeros(3, 3)],
        [zeros(3, 3), -hat(state.omega), zeros(3, 3), eye(3)],
        [-2 * eye(3), zeros(3, 3), -DAMPING * eye(3), zeros(3, 3)],
        [zeros(3, 3), body.inertia_inverse * spring, zeros(3, 3), angular_drag(state.omega, body)],
    )


def hessian(state: State, body: Body) -> Array:
    """The Hessian G / M of the energy along R exp([phi]x): 2 tr(R^T C) I - R^T C - C^T R."""
    aligned = state.R.T * body.cross
    return 2 * inner(state.R, body.cross) * eye(3) - aligned - aligned.T


def pushforward(state: State) -> Array:
    """P (18, 12): what a perturbation delta c, phi, delta v, delta omega does to the state."""
    turned = Matrix.vstack(*[hat(state.R.row(k)) for k in range(3)])
    return sympy.diag(eye(3), turned, eye(3), eye(3))


def angular_drag(omega: Array, body: Body) -> Array:
    """The derivative of J^-1 (J omega x omega) - mu omega with respect to omega."""
    gyroscopic = hat(body.inertia * omega) - hat(omega) * body.inertia
    return body.inertia_inverse * gyroscopic - DAMPING * eye(3)


def _assembled(*blocks: list[Array]) -> Array:
    return Matrix(list(blocks))
