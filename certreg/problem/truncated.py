"""The problem of least truncated squares over rotations: points, and a bound for each pair."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import cached_property
from certreg.errors import InvalidProblemError
from certreg.exact import as_given, at_most
from certreg.problem.bounds import NAME, checked_bounds
from certreg.problem.row_lengths import lengths
from certreg.problem.support import Loss, require_supported
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.problem.problem import RegistrationProblem

TRUNCATED_PREFIX = b"certreg-truncated-rotation/1\0"
LEAST_PAIRS = 3
MOST_PAIRS = 100_000  # as in the checker
MOST_BOUNDS = 1e100  # squares of residuals, in bounds, are doubles


@dataclass(frozen=True, eq=False, init=False)
class TruncatedProblem(Brief):
    """Find the rotation of least sum of min(|y - R x|^2 / bound^2, 1) over all pairs.

    Parameters
    ----------
    points
        A problem with `rotation_only=True`, 3 to 100,000 pairs, without a free scale; all of its
        weights are 1.
    max_residual
        One bound for all pairs or (N,), > 0, in the unit of the clouds: a pair within its bound
        counts by how near it is to it, one beyond it as 1.

    Raises
    ------
    InvalidProblemError
        For others, with the remedy.
    """

    points: RegistrationProblem
    bounds: NDArray[np.float64]

    def __init__(self, points: RegistrationProblem, max_residual: Any) -> None:
        _require_model(points)
        bounds = checked_bounds(max_residual, points.n)
        sizes = np.maximum(np.abs(points.source), np.abs(points.target)).max(axis=1)
        near = sizes / MOST_BOUNDS <= bounds
        if not near.all():
            row = int(np.argmin(near))
            message = f"row {row} (counting from 0) is 1e100 bounds away from the origin: remove it"
            raise InvalidProblemError(message, array="max_residual", row=row)
        _require_narrow(points, bounds)
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "bounds", bounds)

    @property
    def n(self) -> int:
        """Number of pairs."""
        return self.points.n

    @property
    def source(self) -> NDArray[np.float64]:
        """(N, 3)."""
        return self.points.source

    @property
    def target(self) -> NDArray[np.float64]:
        """(N, 3)."""
        return self.points.target

    @cached_property
    def data(self) -> bytes:
        """The bytes that state the problem: prefix, n (u64), points, weights, bounds."""
        numbers = (self.source, self.target, self.points.weights, self.bounds)
        doubles = b"".join(np.asarray(part, dtype="<f8").tobytes() for part in numbers)
        return TRUNCATED_PREFIX + self.n.to_bytes(8, "little") + doubles

    def digest(self) -> str:
        """SHA-256 of `data`, 64 hexadecimal digits."""
        return hashlib.sha256(self.data).hexdigest()


def _require_narrow(points: RegistrationProblem, bounds: NDArray[np.float64]) -> None:
    """Refuses bounds that every pair keeps at every rotation: |y - R x| is at most |x| + |y|."""
    with np.errstate(over="ignore"):
        reach = lengths(points.source) + lengths(points.target)
    if not (bounds >= reach).all():
        return
    most, value = float(reach.max()), float(bounds.min())
    if not most:
        message = "all points are at the origin, where no rotation moves them: give other points"
        raise InvalidProblemError(message, array="source", value=points.n)
    message = (
        f"{NAME} is {as_given(value)}, and no rotation takes the points of any pair farther apart "
        f"than {at_most(most, 6)}: each pair would be within, whether it is right or wrong; give a "
        "bound below that, in the unit of the clouds"
    )
    raise InvalidProblemError(message, array=NAME, value=value, limit=most)


def _require_model(points: RegistrationProblem) -> None:
    """InvalidProblemError where this is no problem of rotations alone, with weights of 1."""
    require_supported(points.cell._replace(loss=Loss.TRUNCATED))
    if not LEAST_PAIRS <= points.n <= MOST_PAIRS:
        message = f"{points.n} pairs: truncated squares take {LEAST_PAIRS} to {MOST_PAIRS} pairs"
        raise InvalidProblemError(message, array="source", value=points.n)
    if points.noise_given:
        message = "sigma is given: the bounds weigh the pairs here, leave sigma out"
        raise InvalidProblemError(message, array="sigma")
    others = np.flatnonzero(np.asarray(points.weights) != 1.0)
    if len(others):
        row, value = int(others[0]), float(points.weights[others[0]])
        message = f"weights[{row}] is {value}: the bounds weigh the pairs here, leave weights out"
        raise InvalidProblemError(message, array="weights", row=row, value=value, limit=1.0)
