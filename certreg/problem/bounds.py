"""How far apart the two points of a pair may be, for the pair to count as right; by the loss."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.errors import InvalidProblemError
from certreg.exact import as_given, at_least, at_most
from certreg.problem.arrays import finite_doubles, real_numbers
from certreg.problem.blocks import first_row
from certreg.problem.losses import Consensus
from certreg.problem.row_lengths import diameter
from certreg.problem.support import Loss, require_supported

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.problem.problem import RegistrationProblem

NAME = "max_residual"  # of the argument, as users know it
LEAST_PAIRS = 3  # two pairs of equal lengths always fit: a set of two says nothing
MOST_SPAN = 768  # bits between the numbers of a problem, as in the checker
MOST_PAIRS = 4096  # whose eight million pairs of pairs the checker tests in half a minute


def bounded(problem: RegistrationProblem, max_residual: Any) -> RegistrationProblem:
    """The same pairs, of which one motion shall bring as many as possible within their bounds.

    Parameters
    ----------
    max_residual
        One bound for all pairs, or (N,) of them.

    Returns
    -------
    RegistrationProblem
        Of the same arrays, and of the loss `Consensus`.

    Raises
    ------
    InvalidProblemError
        For bounds that are not finite and > 0, or so wide that they say nothing; for fewer than 3
        or more than 4,096 pairs; and without a translation.
    """
    require_supported(problem.cell._replace(loss=Loss.CONSENSUS))
    if not LEAST_PAIRS <= problem.n <= MOST_PAIRS:
        message = (
            f"{NAME} needs {LEAST_PAIRS} to {MOST_PAIRS} pairs, there are {problem.n}: "
            "give more, or some of them"
        )
        limit = LEAST_PAIRS if problem.n < LEAST_PAIRS else MOST_PAIRS
        raise InvalidProblemError(message, array=NAME, value=problem.n, limit=limit)
    bounds = checked_bounds(max_residual, problem.n)
    _require_near(problem, bounds)
    _require_narrow(problem, bounds)
    return problem.under(Consensus(bounds))


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


def _require_near(problem: RegistrationProblem, bounds: NDArray[np.float64]) -> None:
    """Refuses numbers of sizes so far apart that the checker takes no certificate of them."""
    block = problem.points
    weights = problem.weights if problem.factors is None else np.ones(1)
    parts = (block.source, block.target, weights, bounds)
    sizes = np.concatenate([np.abs(part).ravel() for part in parts])
    sizes = sizes[sizes > 0.0]
    least, most = float(sizes.min()), float(sizes.max())
    if np.frexp(most)[1] - np.frexp(least)[1] > MOST_SPAN:
        message = (
            f"{NAME} with numbers from {at_least(least)} to {at_most(most)}, weights (1 where none "
            "are given) among them: their proofs would be too long; give the clouds in a unit in "
            "which they are nearer to 1, and 0 for numbers that are nothing but rounding"
        )
        raise InvalidProblemError(message, array=NAME, value=most)


def _require_narrow(problem: RegistrationProblem, bounds: NDArray[np.float64]) -> None:
    """Refuses a bound of at least half the diameter of the smaller cloud: everything fits then.

    Of the target where the scale is free: the source may be made as small. And a cloud of one
    point, for which no bound is narrow.
    """
    block = problem.points
    for name, points in (("source", block.source), ("target", block.target)):
        if (points == points[0]).all():
            message = (
                f"all {name} points are one, which tells no rotation from another, whichever pairs "
                "are right: leave pairs that repeat a point out, and give some with other points"
            )
            raise InvalidProblemError(message, array=name, value=problem.n)
    half, cloud = diameter(block.target) / 2.0, "target"
    if not problem.scaled:
        half, cloud = min(half, diameter(block.source) / 2.0), "smaller cloud"
    if float(bounds.min()) >= half:
        least = "" if (bounds == bounds[0]).all() else " at least"
        message = (
            f"{NAME} is {as_given(bounds.min())}{least}, not below half the diameter of the "
            f"{cloud}, {at_least(half, 6)}: every pair may be brought within; give a smaller bound"
        )
        raise InvalidProblemError(message, array=NAME, value=float(bounds.min()), limit=half)
