"""A quartic on quaternions in doubles: derivatives of many points at once, descent to its minima.

The quartic is given by 35 plain coefficients in the order of MONOMIALS. Points are rows (m, 4),
real or complex. Derivatives in rotation angle are those of F(q exp(phi / 2)) at unit q.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import permutations
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.geometry.so3 import body_frame
from certreg.objective.quartics import MONOMIALS, PAIR_PLACE, PAIRS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Reals = NDArray[np.float64]

FIRST, SECOND = np.array(PAIRS).T
QUARTIC_SIZE = len(MONOMIALS)
LARGEST_TURN = 0.5  # radians of one step: beyond, the quadratic model says little
LEAST_CURVATURE = 1e-9  # of the largest: below, a direction counts as flat
DESCENT_STEPS = 100  # ten are usual; at a minimum of order four each takes a third of what is left
ARRIVED = 1e-11  # radians of a step: squared, nothing is left
SHRINK, GROW = 0.25, 2.0  # of the largest turn, after a step that went up or down
NUDGE = 1e-2  # radians off a saddle, where the gradient says nothing
ROUNDING = 64 * np.finfo(float).eps  # of a value, over the largest coefficient


@dataclass(frozen=True, slots=True, eq=False)
class FloatingQuartic:
    """F by its Hessian, of which each entry is a quadratic form: table (10, 16).

    size: the largest coefficient, without its sign.
    """

    table: Any
    size: float

    @classmethod
    def of(cls, coefficients: NDArray[Any]) -> FloatingQuartic:
        """The quartic of 35 coefficients."""
        table = (_hessian_table() @ coefficients).reshape(len(PAIRS), 16)
        return cls(table, float(np.abs(coefficients).max()))

    def hessians(self, q: Any) -> Any:
        """F''(q), (m, 4, 4)."""
        return ((q[:, FIRST] * q[:, SECOND]) @ self.table).reshape(-1, 4, 4)

    def values(self, q: Any) -> Any:
        """F(q), (m,): by Euler, q^T F''(q) q / 12."""
        return ((self.hessians(q) @ q[..., None])[..., 0] * q).sum(axis=1) / 12.0

    def curvatures(self, q: Any) -> tuple[Any, Any, Any]:
        """Values (m,), gradients (m, 3) and Hessians (m, 3, 3) in rotation angle, at unit q."""
        hessians = self.hessians(q)
        gradients = (hessians @ q[..., None])[..., 0] / 3.0
        values = (gradients * q).sum(axis=1) / 4.0
        frames = _frames(q)
        turned = frames.transpose(0, 2, 1)
        curved = 0.25 * (turned @ hessians @ frames - 4.0 * values[:, None, None] * np.eye(3))
        return values, 0.5 * (turned @ gradients[..., None])[..., 0], curved


@dataclass(frozen=True, slots=True, eq=False)
class StackedQuartics(FloatingQuartic):
    """A quartic for each point, table (m, 10, 16), and points in the same order."""

    @classmethod
    def of(cls, coefficients: NDArray[Any]) -> StackedQuartics:
        """The quartics of coefficients (m, 35)."""
        tables = (_hessian_table() @ coefficients[..., np.newaxis]).reshape(-1, len(PAIRS), 16)
        return cls(tables, float(np.abs(coefficients).max(initial=0.0)))

    def chosen(self, which: NDArray[np.integer[Any]]) -> StackedQuartics:
        """The quartics with these numbers."""
        return StackedQuartics(self.table[which], self.size)

    def hessians(self, q: Any) -> Any:
        """F''(q), (m, 4, 4), of each quartic at its point."""
        pairs = q[:, np.newaxis, FIRST] * q[:, np.newaxis, SECOND]
        return (pairs @ self.table).reshape(-1, 4, 4)


@cache
def _hessian_table() -> Reals:
    """(160, 35): what each coefficient adds to each coefficient of each entry of F''."""
    table = np.zeros((len(PAIRS), 4, 4, QUARTIC_SIZE))
    for place, monomial in enumerate(MONOMIALS):
        for a, b, c, d in permutations(range(4)):
            i, j, k, m = (monomial[p] for p in (a, b, c, d))
            table[PAIR_PLACE[min(k, m), max(k, m)], i, j, place] += 0.5  # both orders of c and d
    return table.reshape(-1, QUARTIC_SIZE)


def _frames(q: Any) -> Any:
    """The frames (m, 4, 3) of the tangent spaces at rows q."""
    entries: Any = q.T
    return np.moveaxis(np.array(body_frame(entries)), -1, 0)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class QuarticDescent:
    """Where descents ended. points: (m, 4), unit. values: (m,). curvatures: (m, 3), ascending.

    The curvatures are the eigenvalues of the Hessian in rotation angle.
    """

    points: Reals
    values: Reals
    curvatures: Reals


def descended(form: FloatingQuartic, starts: Reals) -> QuarticDescent:
    """Local minima, by Newton's method on the sphere with turned signs and bounded turns."""
    q: Any = starts / np.linalg.norm(starts, axis=1, keepdims=True)
    values, gradients, hessians = form.curvatures(q)
    radius: Any = np.full(len(q), LARGEST_TURN)
    slack = ROUNDING * form.size
    for _ in range(DESCENT_STEPS):
        turns = _newton_turns(gradients, hessians, radius)
        lengths = _norms(turns)
        if not (lengths > ARRIVED).any():
            break
        new = q + 0.5 * (_frames(q) @ turns[..., None])[..., 0]
        new /= np.linalg.norm(new, axis=1, keepdims=True)
        new_values, new_gradients, new_hessians = form.curvatures(new)
        down = new_values <= values + slack
        longer: Any = np.minimum(GROW * radius, LARGEST_TURN)
        radius = _chosen(down, longer, SHRINK * lengths)
        q, values = _chosen(down, new, q), _chosen(down, new_values, values)
        gradients = _chosen(down, new_gradients, gradients)
        hessians = _chosen(down, new_hessians, hessians)
    return QuarticDescent(points=q, values=values, curvatures=_eigenvalues(hessians))


def _chosen(rows: NDArray[np.bool_], new: Reals, old: Reals) -> Any:
    """The new where a row is chosen, the old elsewhere."""
    return np.where(rows.reshape(-1, *[1] * (new.ndim - 1)), new, old)


def _norms(rows: Any) -> Any:
    return np.linalg.norm(rows, axis=1)


def _eigenvalues(matrices: Any) -> Any:
    linear: Any = np.linalg  # whose stubs know no stacks of matrices
    return linear.eigvalsh(matrices)


def _newton_turns(gradients: Any, hessians: Any, radius: Any) -> Any:
    """Steps (m, 3) down the gradient, by the sizes of the curvatures, no longer than the radius."""
    linear: Any = np.linalg  # as above
    scales, axes = linear.eigh(hessians)
    sizes = np.abs(scales)
    floor = np.maximum(LEAST_CURVATURE * sizes.max(axis=1, keepdims=True), np.finfo(float).tiny)
    inside: Any = (axes.transpose(0, 2, 1) @ gradients[..., None])[..., 0]
    inside = inside / np.maximum(sizes, floor)
    saddle = (scales < -floor) & (np.abs(inside) < NUDGE)
    inside[saddle] = np.copysign(NUDGE, inside[saddle])
    turns: Any = -(axes @ inside[..., None])[..., 0]
    shares: Any = np.minimum(1.0, radius / np.maximum(_norms(turns), np.finfo(float).tiny))
    return turns * shares[:, None]
