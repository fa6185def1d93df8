"""A quartic in doubles, made of the size of 1 around its mean: what searches work on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from certreg.objective import quartics
from certreg.objective.quartics import MONOMIALS
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.geometry.so3 import Matrix4, Vector4

    Reals = NDArray[np.float64]

ROUNDING = 16 * float(np.finfo(float).eps)  # a quartic that differs by less from a constant is one
MEAN_OVER = 24  # the mean of q_i^4 over unit quaternions is 3/24, that of q_i^2 q_j^2 1/24


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Levelled(Brief):
    """F = scale * rest + level |q|^4, up to rounding; both have the same critical lines.

    rest: (35,), of mean zero over the unit quaternions; its largest coefficient is 1 in size, or
        it is zero. scale: positive.
    """

    rest: Reals
    level: float
    scale: float


def levelled(coefficients: Sequence[float] | Reals) -> Levelled:
    """A quartic of 35 finite coefficients, levelled.

    >>> found = levelled([float(k == 0) for k in range(35)])  # w^4
    >>> round(found.level * found.rest.size, 9), round(found.scale, 9)
    (4.375, 0.875)
    """
    given = np.array(coefficients, dtype=float)
    level = float(_means() @ given)
    rest = given - level * norm_fourth()
    scale = float(np.abs(rest).max())
    if not scale > ROUNDING * abs(level):
        return Levelled(rest=np.zeros_like(rest), level=level, scale=abs(level) or 1.0)
    return Levelled(rest=rest / scale, level=level, scale=scale)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LevelledExactly(Brief):
    """F = scale * rest + level |q|^4, but for one rounding of each coefficient of rest.

    rest: (35,), largest coefficient from 1/2 to 1, or all zero. scale: a power of two over 24.
    integers: 24 (F - level |q|^4), below 2^bits.
    """

    rest: Reals
    integers: tuple[int, ...]
    bits: int
    level: Fraction
    scale: Fraction

    @property
    def is_constant(self) -> bool:
        """Whether F is level |q|^4."""
        return self.bits == 0

    def shortened(self, bits: int) -> LevelledExactly:
        """The same with integers below 2^bits, rounded down: for searches, not for proofs."""
        surplus = self.bits - bits
        if surplus <= 0:
            return self
        short = tuple([entry >> surplus for entry in self.integers])
        return replace(self, integers=short, bits=bits)

    def value(self, q: Sequence[int]) -> int:
        """24 (F(q) - level |q|^4)."""
        return quartics.value(self.integers, q)

    def gradient(self, q: Sequence[int]) -> Vector4[int]:
        """The four first derivatives of `value`."""
        return quartics.gradient(self.integers, q)

    def hessian(self, q: Sequence[int]) -> Matrix4[int]:
        """The second derivatives of `value`."""
        return quartics.hessian(self.integers, q)


def levelled_exactly(quartic: Sequence[int]) -> LevelledExactly:
    """A quartic of 35 integers, levelled: no digit is lost where it is nearly constant."""
    shape = [int(times) for times in norm_fourth()]
    mean = sum(
        (3 if times == 1 else 1) * entry
        for times, entry in zip(shape, quartic, strict=True)
        if times
    )
    integers = tuple(
        [MEAN_OVER * entry - mean * times for times, entry in zip(shape, quartic, strict=True)]
    )
    bits = max(entry.bit_length() for entry in integers)
    return LevelledExactly(
        rest=np.array([entry / (1 << bits) for entry in integers]),
        integers=integers,
        bits=bits,
        level=Fraction(mean, MEAN_OVER),
        scale=Fraction(1 << bits, MEAN_OVER),
    )


@cache
def norm_fourth() -> Reals:
    """The coefficients of |q|^4, (35,): 1 of q_i^4, 2 of q_i^2 q_j^2."""
    return _of_even_monomials(1.0, 2.0)


@cache
def _means() -> Reals:
    """The mean of each monomial over unit quaternions: 1/8 of q_i^4, 1/24 of q_i^2 q_j^2."""
    return _of_even_monomials(1.0 / 8.0, 1.0 / 24.0)


def _of_even_monomials(fourth: float, squares: float) -> Reals:
    """Numbers of the monomials q_i^4 and q_i^2 q_j^2, 0 of the others."""
    numbers = np.zeros(len(MONOMIALS))
    for place, (i, j, k, m) in enumerate(MONOMIALS):
        if i == j and k == m:
            numbers[place] = fourth if j == k else squares
    return numbers
