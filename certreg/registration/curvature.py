"""Slope and curvature of an energy on the rotations, beside its oscillation: in doubles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from certreg.exact.dyadic import quotient_or_zero
from certreg.objective.neighbourhood import Neighbourhood

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.objective.springs import Springs


SOFT = 1e-6  # of the oscillation: a curvature that is told from zero is larger


def slope_and_curvature(
    objective: Springs, q: Sequence[int]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(3,) and (3, 3): derivatives in rotation angle about the source's axes, over the oscillation.

    Zero where the energy is constant.
    """
    if not objective.oscillation:
        return np.zeros(3), np.zeros((3, 3))
    near = Neighbourhood(objective.reduced, q, objective.motion)
    above, below = (near.unit / objective.oscillation).as_integer_ratio()
    rows = [near.gradient, *near.hessian]
    slope, *curved = [[quotient_or_zero(entry * above, below) for entry in row] for row in rows]
    return np.array(slope), np.array(curved)


def soft_axes(objective: Springs, q: Sequence[int]) -> NDArray[np.float64]:
    """(k, 3), the source's axes about which the energy hardly curves, in doubles."""
    _, curvature = slope_and_curvature(objective, q)
    levels, axes = np.linalg.eigh(curvature)
    return axes.T[levels <= SOFT]
