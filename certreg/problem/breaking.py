"""Springs that break: points, weights, and for each spring the length at which it breaks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import cached_property
from certreg.errors import InvalidProblemError
from certreg.exact import power_of_two
from certreg.problem.bounds import checked_bounds
from certreg.problem.lifting import lift
from certreg.problem.problem import RegistrationProblem
from certreg.problem.support import Verb, require_supported
from certreg.results import Brief

if TYPE_CHECKING:
    from collections.abc import Sequence
    from fractions import Fraction

    from numpy.typing import NDArray

    from certreg.geometry import Vector3


@dataclass(frozen=True, eq=False)
class BreakingProblem(Brief):
    """The body whose spring i breaks where its residual |y - R x - t| exceeds bounds[i].

    Its energy is V = sum of the least of w |y - R x - t|^2 and w bounds^2.

    problem: points and weights, all > 0. bounds: (N,), > 0, in the unit of the clouds.
    """

    problem: RegistrationProblem
    bounds: NDArray[np.float64]

    @classmethod
    def of(cls, problem: RegistrationProblem, max_residual: Any) -> BreakingProblem:
        """The problem with one bound for all springs, or (N,) of them.

        Raises InvalidProblemError for bounds that are not finite and > 0, for a weight of 0, for
        general springs, a free scale, and without a translation.
        """
        require_supported(problem.cell, Verb.BREAKING)
        row = next((i for i, w in enumerate(problem.weights.tolist()) if w == 0.0), None)
        if row is not None:
            message = f"weights[{row}] is 0: such a spring neither pulls nor breaks, leave it out"
            raise InvalidProblemError(message, array="weights", row=row, value=0.0, limit=0.0)
        return cls(problem, checked_bounds(max_residual, problem.n))

    @property
    def n(self) -> int:
        """Number of springs."""
        return self.problem.n

    @cached_property
    def rows(self) -> ExactSprings:
        """Points, bounds and weights in integers."""
        block = self.problem.block(slice(None))
        lengths = lift(np.column_stack([block.source, block.target, self.bounds]).ravel())
        weights = lift(block.weights)
        parts = [lengths.integers[k::7] for k in range(7)]
        x, y, z, a, b, c, bounds = parts
        return ExactSprings(
            sources=tuple(zip(x, y, z, strict=True)),
            targets=tuple(zip(a, b, c, strict=True)),
            bounds=tuple(bounds),
            weights=tuple(weights.integers),
            exponent=weights.exponent + 2 * lengths.exponent,
        )

    def broken_energy(self, unbroken: Sequence[int]) -> Fraction:
        """The energy of all other springs, broken: exact, in objective units."""
        rows, kept = self.rows, set(unbroken)
        broken = [i for i in range(self.n) if i not in kept]
        return sum(rows.broken(i) for i in broken) * power_of_two(rows.exponent)

    def of_rows(self, rows: Sequence[int]) -> RegistrationProblem:
        """The problem of some of the springs, which do not break."""
        block, kept = self.problem.block(slice(None)), list(rows)
        return RegistrationProblem(
            block.source[kept],
            block.target[kept],
            weights=block.weights[kept],
            damping=self.problem.damping,
        )


@dataclass(frozen=True, slots=True, eq=False)
class ExactSprings(Brief):
    """The numbers of a problem as integers, lengths over one power of two, weights over another.

    exponent: 1 is worth 2^exponent as energy, a weight times a squared length.
    """

    sources: tuple[Vector3[int], ...]
    targets: tuple[Vector3[int], ...]
    bounds: tuple[int, ...]
    weights: tuple[int, ...]
    exponent: int

    def broken(self, row: int) -> int:
        """The energy of a spring that is broken, w b^2."""
        return self.weights[row] * self.bounds[row] ** 2
