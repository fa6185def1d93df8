"""How far apart the points of a right pair may be, and which pairs somebody labelled as right."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.errors import InvalidProblemError
from certreg.exact.decimals import as_given, at_least, at_most
from certreg.problem.arrays import diameter, finite_doubles, first_row, lengths, real_numbers
from certreg.problem.losses import Breaking, Consensus, Truncated
from certreg.problem.support import Loss, require_supported

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.problem.problem import RegistrationProblem


NAME = "max_residual"  # of the argument, as users know it
LEAST_PAIRS = 3  # two pairs of equal lengths always fit: a set of two says nothing
MOST_SPAN = 768  # bits between the numbers of a problem, as in the checker
MOST_PAIRS = 4096  # whose eight million pairs of pairs the checker tests in half a minute
MOST_TRUNCATED = 100_000  # as in the checker
MOST_BOUNDS = 1e100  # squares of residuals, in bounds, are doubles


def bounded(
    problem: RegistrationProblem, max_residual: Any, loss: Loss = Loss.CONSENSUS
) -> RegistrationProblem:
    """The same pairs with bounds: the most of them within, truncated squares, or breaking springs.

    Parameters
    ----------
    max_residual
        One bound for all pairs, or (N,) of them.
    loss
        `Loss.CONSENSUS`, for motions with a translation; `Loss.TRUNCATED`, for rotations alone and
        weights of 1; or `Loss.BREAKING`, for rigid motions and weights above 0.

    Returns
    -------
    RegistrationProblem
        Of the same arrays, and of that loss.

    Raises
    ------
    InvalidProblemError
        For bounds that are not finite and > 0; for what has no such loss. Unless springs break,
        also for bounds so wide that they say nothing, and for fewer than 3 pairs or more than
        4,096, of truncated squares 100,000.
    """
    require_supported(problem.cell._replace(loss=loss))
    return problem.under(STATED[loss](problem, max_residual))


def _consensus(problem: RegistrationProblem, max_residual: Any) -> Consensus:
    if not LEAST_PAIRS <= problem.n <= MOST_PAIRS:
        message = (
            f"{NAME} needs {LEAST_PAIRS} to {MOST_PAIRS} pairs, there are {problem.n}: "
            "give more, or some of them"
        )
        raise InvalidProblemError(
            message,
            array=NAME,
            value=problem.n,
            limit=LEAST_PAIRS if problem.n < LEAST_PAIRS else MOST_PAIRS,
        )
    bounds = checked_bounds(max_residual, problem.n)
    _require_near(problem, bounds)
    _require_narrow(problem, bounds)
    return Consensus(bounds)


def _truncated(problem: RegistrationProblem, max_residual: Any) -> Truncated:
    _require_unweighted(problem)
    bounds = checked_bounds(max_residual, problem.n)
    sizes = np.maximum(np.abs(problem.source), np.abs(problem.target)).max(axis=1)
    near = sizes / MOST_BOUNDS <= bounds
    if not near.all():
        row = int(np.argmin(near))
        raise InvalidProblemError(
            f"row {row} (counting from 0) is 1e100 bounds away from the origin: remove it",
            array=NAME,
            row=row,
        )
    _require_telling(problem, bounds)
    return Truncated(bounds)


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
        raise InvalidProblemError(
            f"{NAME} has shape {array.shape}: give one number, or ({n},), one for each pair",
            array=NAME,
            value=array.shape,
            limit=(n,),
        )
    bounds = array.reshape(-1)
    row = first_row(bounds, lambda block: ~((block > 0) & np.isfinite(block)))
    if row is not None:
        place = NAME if array.ndim == 0 else f"{NAME}[{row}]"
        value = bounds[row].item()
        message = f"{place} is {value}: a bound must be finite and > 0, in the unit of the clouds"
        raise InvalidProblemError(
            message, array=NAME, row=None if array.ndim == 0 else row, value=value, limit=0.0
        )
    doubles = np.broadcast_to(np.array(finite_doubles(bounds, NAME)), (n,))
    doubles.flags.writeable = False
    return doubles


def _require_near(problem: RegistrationProblem, bounds: NDArray[np.float64]) -> None:
    """Refuses numbers of sizes so far apart that the checker takes no certificate of them."""
    block = problem.points
    parts = (block.source, block.target, block.masses, bounds)
    sizes = np.concatenate([np.abs(part).ravel() for part in parts])
    sizes = sizes[sizes > 0.0]
    least, most = float(sizes.min()), float(sizes.max())
    if np.frexp(most)[1] - np.frexp(least)[1] > MOST_SPAN:
        raise InvalidProblemError(
            f"{NAME} with numbers from {at_least(least)} to {at_most(most)}, weights (1 where none "
            "are given) among them: their proofs would be too long; give the clouds in a unit in "
            "which they are nearer to 1, and 0 for numbers that are nothing but rounding",
            array=NAME,
            value=most,
        )


def _require_narrow(problem: RegistrationProblem, bounds: NDArray[np.float64]) -> None:
    """Refuses a bound of at least half the diameter of the smaller cloud: everything fits then.

    Of the target where the scale is free: the source may be made as small. And a cloud of one
    point, for which no bound is narrow.
    """
    block = problem.points
    for name, points in (("source", block.source), ("target", block.target)):
        if (points == points[0]).all():
            raise InvalidProblemError(
                f"all {name} points are one, which tells no rotation from another, whichever pairs "
                "are right: leave pairs that repeat a point out, and give some with other points",
                array=name,
                value=problem.n,
            )
    size, cloud = narrow_cloud(problem)
    half = size / 2.0
    if float(bounds.min()) >= half:
        least = "" if (bounds == bounds[0]).all() else " at least"
        raise InvalidProblemError(
            f"{NAME} is {as_given(bounds.min())}{least}, not below half the diameter of the "
            f"{cloud}, {at_least(half, 6)}: every pair may be brought within; give a smaller bound",
            array=NAME,
            value=float(bounds.min()),
            limit=half,
        )


def narrow_cloud(problem: RegistrationProblem) -> tuple[float, str]:
    """The diameter of the cloud that bounds are held against, and which it is.

    The smaller cloud; the target where the scale is free, since the source may be made as small.
    """
    size = diameter(problem.points.target)
    if problem.motion.scales:
        return size, "target"
    return min(size, diameter(problem.points.source)), "smaller cloud"


def _require_telling(problem: RegistrationProblem, bounds: NDArray[np.float64]) -> None:
    """Refuses bounds that every pair keeps at every rotation: |y - R x| is at most |x| + |y|."""
    with np.errstate(over="ignore"):
        reach = lengths(problem.source) + lengths(problem.target)
    if not (bounds >= reach).all():
        return
    most, value = float(reach.max()), float(bounds.min())
    if not most:
        raise InvalidProblemError(
            "all points are at the origin, where no rotation moves them: give other points",
            array="source",
            value=problem.n,
        )
    raise InvalidProblemError(
        f"{NAME} is {as_given(value)}, and no rotation takes the points of any pair farther apart "
        f"than {at_most(most, 6)}: each pair would be within, whether it is right or wrong; give a "
        "bound below that, in the unit of the clouds",
        array=NAME,
        value=value,
        limit=most,
    )


def _require_unweighted(problem: RegistrationProblem) -> None:
    """Refuses too few pairs, or too many, and weights other than 1."""
    if not LEAST_PAIRS <= problem.n <= MOST_TRUNCATED:
        raise InvalidProblemError(
            f"{problem.n} pairs: truncated squares take {LEAST_PAIRS} to {MOST_TRUNCATED} pairs",
            array="source",
            value=problem.n,
        )
    if problem.noise_given:
        raise InvalidProblemError(
            "sigma is given: the bounds weigh the pairs here, leave sigma out", array="sigma"
        )
    others = np.flatnonzero(np.asarray(problem.weights) != 1.0)
    if len(others):
        row, value = int(others[0]), float(problem.weights[others[0]])
        raise InvalidProblemError(
            f"weights[{row}] is {value}: the bounds weigh the pairs here, leave weights out",
            array="weights",
            row=row,
            value=value,
            limit=1.0,
        )


def _breaking(problem: RegistrationProblem, max_residual: Any) -> Breaking:
    row = next((i for i, w in enumerate(problem.weights.tolist()) if w == 0.0), None)
    if row is not None:
        raise InvalidProblemError(
            f"weights[{row}] is 0: such a spring neither pulls nor breaks, leave it out",
            array="weights",
            row=row,
            value=0.0,
            limit=0.0,
        )
    return Breaking(checked_bounds(max_residual, problem.n))


STATED = {Loss.CONSENSUS: _consensus, Loss.TRUNCATED: _truncated, Loss.BREAKING: _breaking}

LABELS = "labels"  # of the argument, as users know it
LEAST_DIRECTIONS = 2  # that one rotation may meet: a single one is met by infinitely many
INLIER_WORDS = {"1": True, "0": False, "inlier": True, "outlier": False}


def checked_inliers(labels: Any, n: int, least: int = LEAST_PAIRS) -> tuple[int, ...]:
    """The rows labelled as inliers, of n labels: booleans, 0 and 1, or the words.

    Raises InvalidProblemError for another number of labels, for others, and where fewer than the
    least number are inliers.
    """
    texts = np.asarray(labels)
    if texts.shape != (n,):
        raise InvalidProblemError(
            f"{LABELS} has shape {texts.shape}: give ({n},), one for each pair",
            array=LABELS,
            value=texts.shape,
            limit=(n,),
        )
    rows: list[int] = []
    for row, value in enumerate(texts.tolist()):
        word = str(int(value)) if isinstance(value, bool) else str(value)
        if word not in INLIER_WORDS:
            raise InvalidProblemError(
                f"{LABELS}[{row}] is {value!r}: give 0 or 1, outlier or inlier",
                array=LABELS,
                row=row,
                value=value,
            )
        if INLIER_WORDS[word]:
            rows.append(row)
    if len(rows) < least:
        two = least == LEAST_DIRECTIONS
        always = "a single pair of equal lengths" if two else "two of equal lengths"
        named = f"{len(rows)} inlier{'s' * (len(rows) != 1)}"
        raise InvalidProblemError(
            f"{LABELS} name {named}: give at least {least}, as {always} always fit{'s' * two}",
            array=LABELS,
            value=len(rows),
            limit=least,
        )
    return tuple(rows)
