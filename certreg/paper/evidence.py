"""What was measured of a claim, in words, and whether it agrees with the finding of the audit."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from certreg.problem.problem import RegistrationProblem

if TYPE_CHECKING:
    from collections.abc import Sequence

# What counts as equal in doubles; differences are relative to the size of what is compared.
SAME_SUM = 1e-12  # of two ways to add 100 terms: a thousand times their rounding
SAME_ANGLE = 1e-9  # degrees, of two eigenvectors of a 4x4 matrix: their rounding
NEAR = 1.0  # degrees: a simulation stops near its end, not at it; saddles are at 180

Clouds = list[RegistrationProblem]
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True, slots=True, kw_only=True)
class Evidence:
    """What was measured, in words, and whether it agrees with the finding on the claim."""

    words: str
    agrees: bool


def tally(count: int, of: Sequence[Any], words: str) -> Evidence:
    """`count` of all, which agrees if it is all of them."""
    return Evidence(words=f"{share(count, of)} {words}", agrees=count == len(of))


def share(count: int, of: Sequence[Any]) -> str:
    """How many of how many."""
    return f"{count:,} of {len(of):,}"


def listed(counts: Sequence[int | None]) -> str:
    """Numbers of equilibria in a row of words."""
    words = ["infinitely many" if count is None else str(count) for count in counts]
    return " and ".join(filter(None, [", ".join(words[:-1]), words[-1]]))


def rough(value: float) -> str:
    """A positive number rounded up to one digit, as powers of ten are printed."""
    if value == 0.0 or not math.isfinite(value):
        return f"{value:g}"
    exponent = math.floor(math.log10(value))
    digit = math.ceil(value / 10.0**exponent * (1.0 - 1e-12))  # 1e-12: the quotient is rounded
    digit, exponent = (1, exponent + 1) if digit == 10 else (digit, exponent)
    return f"{digit}·10{str(exponent).translate(SUPERSCRIPTS)}"
