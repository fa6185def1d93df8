"""Slope and curvature of an energy on the rotations, beside its oscillation: in doubles."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from certreg.exact import nearest_or_zero
from certreg.geometry import body_frame, squared_norm

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from certreg.objective import Springs

SOFT = 1e-6  # of the oscillation: a curvature that is told from zero is larger


def slope_and_curvature(
    objective: Springs, q: Sequence[int]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(3,) and (3, 3): derivatives in rotation angle about the source's axes, over the oscillation.

    At the unit quaternion u with body frame E they are E^T F'(u) / 2 and
    (E^T F''(u) E - 4 F(u) I) / 4. Zero where the energy is constant.
    """
    frame, norm = np.array(body_frame(tuple(q)), dtype=object), squared_norm(q)
    scale = objective.oscillation / objective.unit * norm**2
    first = frame.T @ np.array(objective.gradient(q), dtype=object)
    second = frame.T @ np.array(objective.hessian(q), dtype=object) @ frame
    second = second - 4 * objective.value(q) * np.eye(3, dtype=object)
    if not scale:
        return np.zeros(3), np.zeros((3, 3))
    slope = [nearest_or_zero(Fraction(entry) / scale) / 2 for entry in first]
    curved = [[nearest_or_zero(Fraction(entry) / scale) / 4 for entry in row] for row in second]
    return np.array(slope), np.array(curved)


def soft_axes(objective: Springs, q: Sequence[int]) -> NDArray[np.float64]:
    """(k, 3), the source's axes about which the energy hardly curves, in doubles."""
    _, curvature = slope_and_curvature(objective, q)
    levels, axes = np.linalg.eigh(curvature)
    return axes.T[levels <= SOFT]
