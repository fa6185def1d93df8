"""The angles of pairs that a rotation turns, and up to which angle each is within its bound."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Reals = NDArray[np.float64]


def angles_between(turned: Reals, target: Reals) -> Reals:
    """(N,), radians, between two vectors (N, 3) each; NaN where one of them is 0."""
    turned, target = (np.ldexp(points, -_exponents(points)) for points in (turned, target))
    across = np.linalg.norm(np.cross(turned, target), axis=1)
    along = (turned * target).sum(axis=1)
    return np.where((across == 0.0) & (along == 0.0), np.nan, np.arctan2(across, along))


def widest_angles(source: Reals, target: Reals, bounds: Reals) -> Reals:
    """(N,), radians: a rotation has a pair within its bound iff its angle is at most that.

    With a = |x|, b = |y|: |y - R x|^2 = (a - b)^2 + 4 a b sin^2(angle/2) <= bound^2. pi where every
    rotation has it within, NaN where none has, as lengths differ by more than the bound.
    """
    rows = np.column_stack([source, target, bounds])
    rows = np.ldexp(rows, -_exponents(rows))
    source, target, bounds = rows[:, :3], rows[:, 3:6], rows[:, 6]
    a, b = (np.linalg.norm(points, axis=1) for points in (source, target))
    room = (bounds - (a - b)) * (bounds + (a - b))
    with np.errstate(divide="ignore", invalid="ignore"):
        square = np.where(room >= 4.0 * a * b, 1.0, room / (4.0 * a * b))
    return np.where(room < 0.0, np.nan, 2.0 * np.arcsin(np.sqrt(np.clip(square, 0.0, 1.0))))


def _exponents(rows: Reals) -> NDArray[np.intp]:
    """(N, 1), of a power of two near the size of each row: divided by it, no square overflows."""
    return np.frexp(np.abs(rows).max(axis=1, keepdims=True))[1]
