"""How far apart the two points of a pair may be, for the pair to count as right."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.errors import InvalidProblemError
from certreg.problem.arrays import finite_doubles, real_numbers
from certreg.problem.blocks import first_row

if TYPE_CHECKING:
    from numpy.typing import NDArray

NAME = "max_residual"  # of the argument, as users know it


def checked_bounds(max_residual: Any, n: int) -> NDArray[np.float64]:
    """The bounds of n pairs.

    Parameters
    ----------
    max_residual
        One number for all pairs or (n,), finite and > 0, in the unit of the clouds.

    Returns
    -------
    NDArray[np.float64]
        (n,), read-only.

    Raises
    ------
    InvalidProblemError
        For others, naming the row.
    """
    array = real_numbers(max_residual, NAME)
    if array.shape not in {(), (n,)}:
        message = f"{NAME} has shape {array.shape}: give one number, or ({n},), one for each pair"
        raise InvalidProblemError(message, array=NAME, value=array.shape, limit=(n,))
    bounds = array.reshape(-1)
    row = first_row(bounds, lambda block: ~((block > 0) & np.isfinite(block)))
    if row is not None:
        place = NAME if array.ndim == 0 else f"{NAME}[{row}]"
        value = bounds[row].item()
        message = f"{place} is {value}: a bound must be finite and > 0, in the unit of the clouds"
        named = None if array.ndim == 0 else row
        raise InvalidProblemError(message, array=NAME, row=named, value=value, limit=0.0)
    doubles = np.broadcast_to(np.array(finite_doubles(bounds, NAME)), (n,))
    doubles.flags.writeable = False
    return doubles
