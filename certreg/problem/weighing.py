"""What each pair weighs: from weights, or from the standard deviation of the noise."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.errors import InvalidProblemError
from certreg.exact.dyadic import weight_of_sigma
from certreg.problem.arrays import finite_doubles, first_row, real_numbers
from certreg.problem.springs import stated_springs

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from certreg.problem.springs import GivenSprings, StatedSprings


def masses(sigma: ArrayLike | None, weights: ArrayLike | None, n: int) -> NDArray[np.float64]:
    """(n,) weights, from whichever was given."""
    return _weights_from_sigma(sigma, n) if sigma is not None else given_weights(weights, n)


def _per_point(values: ArrayLike, name: str, n: int) -> NDArray[np.float64]:
    """(n,) finite doubles, or (1,) that stands for all."""
    array = real_numbers(values, name)
    if array.ndim == 0:
        return finite_doubles(array.reshape(1), name)
    if array.shape != (n,):
        message = f"{name} has shape {array.shape}: expected one number, or ({n},), one per point"
        raise InvalidProblemError(message, array=name, value=array.shape, limit=(n,))
    return finite_doubles(array, name)


def given_weights(weights: ArrayLike | None, n: int) -> NDArray[np.float64]:
    """(n,) weights >= 0, not all zero; equal ones take the place of one."""
    array = np.ones(1) if weights is None else _per_point(weights, "weights", n)
    row = first_row(array, lambda block: block < 0)
    if row is not None:
        message = f"weights[{row}] is {array[row]}: weights must be >= 0"
        value = float(array[row])
        raise InvalidProblemError(message, array="weights", row=row, value=value, limit=0.0)
    if first_row(array, lambda block: block > 0) is None:
        message = "all weights are zero: no correspondence counts, so every pose is as good"
        raise InvalidProblemError(message, array="weights", value=0.0)
    return np.broadcast_to(array, (n,))


def given_sigma(sigma: ArrayLike, n: int) -> NDArray[np.float64]:
    """(n,) or (1,) standard deviations > 0."""
    if np.ndim(sigma) == 0 and not np.isfinite(real_numbers(sigma, "sigma")):
        message = f"sigma is {sigma}: a standard deviation must be finite and > 0"
        raise InvalidProblemError(message, array="sigma", value=sigma, limit=0.0)
    array = _per_point(sigma, "sigma", n)
    row = first_row(array, lambda block: block <= 0)
    if row is not None:
        place = "sigma" if np.ndim(sigma) == 0 else f"sigma[{row}]"
        message = f"{place} is {array[row]}: a standard deviation must be > 0"
        named = None if np.ndim(sigma) == 0 else row
        value = float(array[row])
        raise InvalidProblemError(message, array="sigma", row=named, value=value, limit=0.0)
    return array


def _weights_from_sigma(sigma: ArrayLike, n: int) -> NDArray[np.float64]:
    """(n,) weights in memory, even if the sigmas are mapped; equal ones take the place of one."""
    array = given_sigma(sigma, n)
    distinct, inverse = np.unique(array, return_inverse=True)
    weights = np.empty(len(distinct))
    for i, value in enumerate(distinct.astype(float).tolist()):
        weights[i] = weight_of_sigma(value)
        if not 0.0 < weights[i] < math.inf:
            message = (
                f"sigma = {value!r} gives the weight 1/sigma^2 = {weights[i]}, outside the "
                "doubles: change the unit of length, of clouds and sigma alike"
            )
            raise InvalidProblemError(message, array="sigma", value=value)
    return np.broadcast_to(weights[inverse], (n,))


def weighed_springs(
    given: GivenSprings,
    clouds: tuple[Any, Any],
    sigma: ArrayLike | None,
    weights: ArrayLike | None,
    n: int,
) -> StatedSprings:
    """General springs over sigma, or times the weights."""
    over = None if sigma is None else given_sigma(sigma, n)
    times = None if weights is None else given_weights(weights, n)
    return stated_springs(given, clouds, n, sigma=over, weights=times)
