"""A problem with wrong pairs: points, weights, and for each pair a bound on its residual."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.errors import InvalidProblemError
from certreg.exact import as_given, at_least, at_most
from certreg.problem.bounds import NAME, checked_bounds
from certreg.problem.motion import Scale
from certreg.problem.problem import RegistrationProblem
from certreg.problem.row_lengths import diameter
from certreg.problem.support import Loss, require_supported
from certreg.results import Brief

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

PREFIXES = {  # by scale: no digest stands for two problems
    Scale.NONE: b"certreg-consensus/1\0",
    Scale.ASYMMETRIC: b"certreg-consensus-similarity/1\0",
    Scale.SYMMETRIC: b"certreg-consensus-similarity-symmetric/1\0",
}
SPRUNG_PREFIX = b"certreg-consensus-springs/1\0"
LEAST_PAIRS = 3  # two pairs of equal lengths always fit: a set of two says nothing
MOST_SPAN = 768  # bits between the numbers of a problem, as in the checker
MOST_PAIRS = 4096  # whose eight million pairs of pairs the checker tests in half a minute


@dataclass(frozen=True, slots=True, eq=False)
class ConsensusProblem(Brief):
    """Pairs of which one motion shall bring as many as possible within their bounds.

    A motion (R, t) meets pair i where |y_i - R x_i - t| <= bounds[i]; where the scale is free, a
    motion (s, R, t), s > 0, where |y_i - s R x_i - t| <= bounds[i].

    Attributes
    ----------
    problem
        Points, and the weights and the scale of the least squares over the pairs that are met.
    bounds
        (N,), > 0, in the unit of the clouds; where the scale is free, in that of the target.
    sprung
        The same with the general springs of that least squares; None where it has weights. They
        change no bound: which pairs a motion meets is a matter of their points.
    """

    problem: RegistrationProblem
    bounds: NDArray[np.float64]
    sprung: RegistrationProblem | None = None

    @classmethod
    def of(cls, problem: RegistrationProblem, max_residual: Any) -> ConsensusProblem:
        """The problem with one bound for all pairs, or (N,) of them.

        Raises InvalidProblemError for bounds that are not finite and > 0, or so wide that they say
        nothing; for fewer than 3 or more than 4,096 pairs; and without a translation.
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
        if problem.factors is None:
            _require_near(problem, bounds)
            _require_narrow(problem, bounds)
            return cls(problem, bounds)
        block = problem.spring_block(slice(None))
        points = RegistrationProblem(block.source, block.target)
        _require_near(points, bounds)
        _require_narrow(points, bounds)
        return cls(points, bounds, problem)

    @property
    def n(self) -> int:
        """Number of pairs."""
        return self.problem.n

    @property
    def factors(self) -> NDArray[np.float64] | None:
        """(N, 6), of the general springs; None where there are weights."""
        return None if self.sprung is None else self.sprung.spring_block(slice(None)).factors

    @property
    def notes(self) -> tuple[str, ...]:
        """What the user should know of the general springs."""
        springs = None if self.sprung is None else self.sprung.springs
        return () if springs is None else springs.notes

    def data_bytes(self) -> bytes:
        """The bytes that state the problem: prefix, n (u64), points, weights, then bounds.

        With general springs there are no weights, and their factors come last.
        """
        block = self.problem.block(slice(None))
        if (factors := self.factors) is None:
            prefix, own = PREFIXES[self.problem.scale], (block.weights, self.bounds)
        else:
            prefix, own = SPRUNG_PREFIX, (self.bounds, factors)
        head, arrays = prefix + self.n.to_bytes(8, "little"), (block.source, block.target, *own)
        return head + b"".join((array + 0.0).astype("<f8").tobytes() for array in arrays)

    def digest(self) -> str:
        """SHA-256 of `data_bytes()`, 64 hexadecimal digits: the identity of the problem."""
        return hashlib.sha256(self.data_bytes()).hexdigest()

    def of_rows(self, rows: Sequence[int]) -> RegistrationProblem:
        """The least-squares problem of some of the pairs, with all that goes with them.

        Raises InvalidProblemError where all of them are 0.
        """
        return (self.sprung or self.problem).of_rows(rows)


def _require_near(problem: RegistrationProblem, bounds: NDArray[np.float64]) -> None:
    """Refuses numbers of sizes so far apart that the checker takes no certificate of them."""
    block = problem.block(slice(None))
    parts = (block.source, block.target, block.weights, bounds)
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
    block = problem.block(slice(None))
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
