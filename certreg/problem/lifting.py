"""Doubles as exact numbers.

Floating point becomes exact here and nowhere else: every finite double is a dyadic rational, so a
problem stated in doubles is an exact rational problem.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from certreg.exact.dyadic import power_of_two
from certreg.results import Brief

if TYPE_CHECKING:
    from fractions import Fraction

    from numpy.typing import NDArray

    from certreg.geometry.so3 import Vector3
    from certreg.problem.problem import RegistrationProblem

MANTISSA_BITS = 53
FEW = 32  # numbers that are lifted faster one by one than by twenty calls of NumPy


@dataclass(frozen=True, slots=True, kw_only=True)
class Lifted:
    """Doubles as exact numbers: entry i is `integers[i] * 2**exponent`."""

    integers: list[int]
    exponent: int


def lift(values: NDArray[np.float64]) -> Lifted:
    """The exact values of finite doubles (flat), over one common power of two."""
    if len(values) <= FEW:
        return _lifted(values.tolist())
    mantissas, exponents = np.frexp(values)
    integers = np.ldexp(mantissas, MANTISSA_BITS).astype(np.int64)
    exponents = exponents.astype(np.int64) - MANTISSA_BITS
    present = integers != 0
    if not present.any():
        return Lifted(integers=[0] * len(integers), exponent=0)
    lowest_bit = np.where(present, integers & -integers, 1)
    zeros = np.frexp(lowest_bit.astype(np.float64))[1].astype(np.int64) - 1
    integers >>= zeros
    exponents += zeros
    common = int(exponents[present].min())
    shifts = np.where(present, exponents - common, 0)
    if int((MANTISSA_BITS - zeros + shifts).max()) <= 63:  # bits of the longest, without its sign
        return Lifted(integers=(integers << shifts).tolist(), exponent=common)
    pairs = zip(integers.tolist(), shifts.tolist(), strict=True)
    return Lifted(integers=[m << s for m, s in pairs], exponent=common)


def _lifted(values: list[float]) -> Lifted:
    """The same, one by one."""
    ratios = [value.as_integer_ratio() for value in values]
    over = max((below for _, below in ratios), default=1)
    integers = [above * (over // below) for above, below in ratios]
    bits = 0
    for k in integers:
        bits |= k
    if not bits:
        return Lifted(integers=integers, exponent=0)
    spare = (bits & -bits).bit_length() - 1
    return Lifted(integers=[k >> spare for k in integers], exponent=spare + 1 - over.bit_length())


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
