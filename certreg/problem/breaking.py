"""Springs that break, in integers: points, weights, and the length at which each one breaks."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from certreg.exact.dyadic import power_of_two
from certreg.problem.lifting import lift
from certreg.results import Brief

if TYPE_CHECKING:
    from collections.abc import Sequence
    from fractions import Fraction

    from certreg.geometry.so3 import Vector3
    from certreg.problem.problem import RegistrationProblem


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

    def broken_energy(self, unbroken: Sequence[int]) -> Fraction:
        """The energy of all other springs, broken: exact, in objective units."""
        kept = set(unbroken)
        broken = [i for i in range(len(self.bounds)) if i not in kept]
        return sum(self.broken(i) for i in broken) * power_of_two(self.exponent)


@lru_cache(maxsize=1)  # every set of springs of a problem asks for it
def exact_springs(problem: RegistrationProblem) -> ExactSprings:
    """Points, bounds and weights in integers."""
    block = problem.block(slice(None))
    lengths = lift(np.column_stack([block.source, block.target, problem.bounds]).ravel())
    weights = lift(block.weights)
    x, y, z, a, b, c, bounds = (lengths.integers[k::7] for k in range(7))
    return ExactSprings(
        sources=tuple(zip(x, y, z, strict=True)),
        targets=tuple(zip(a, b, c, strict=True)),
        bounds=tuple(bounds),
        weights=tuple(weights.integers),
        exponent=weights.exponent + 2 * lengths.exponent,
    )
