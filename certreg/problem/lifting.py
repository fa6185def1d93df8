"""Doubles as exact numbers.

Floating point becomes exact here and nowhere else: every finite double is a dyadic rational, so a
problem stated in doubles is an exact rational problem.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

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
