"""Scales that two units of length would explain, as far as the data tell them from others."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from certreg.exact.dyadic import nearest_or_zero

if TYPE_CHECKING:
    from fractions import Fraction

UNITS = {  # of the smaller unit in the larger one, or a foot in a metre
    10.0: "angstrom against nanometres",
    1000.0: "millimetres against metres",
    100.0: "centimetres against metres",
    1e6: "micrometres against metres",
    25.4: "millimetres against inches",
    2.54: "centimetres against inches",
    12.0: "inches against feet",
    0.3048: "feet against metres",
}
DEVIATIONS = 5.0  # standard ones: a probability of 6e-7
MOST_SPREAD = 0.01  # of an interval that tells one ratio from another: the nearest are 19 % apart
LEAST_DEGREES = 1  # of freedom, 3 n - 7, that tell the noise
ROUNDING = 2.0**-50  # of a scale whose data are rounded to doubles


def unit_between(low: float, high: float) -> tuple[float, str] | None:
    """The ratio of two units that lies between, whichever is the target's, and their names.

    None where there is none, or where low and high are too far apart to mean one.
    """
    if not (0.0 < low <= high < math.inf and high <= low * (1.0 + MOST_SPREAD)):
        return None
    ratios = [(ratio, words) for k, words in UNITS.items() for ratio in (k, 1.0 / k)]
    return next((one for one in ratios if low <= one[0] <= high), None)


def scale_between(scale: Fraction, explained: Fraction, degrees: float) -> tuple[float, float]:
    """Between which scales the true one is, whichever cloud the noise is in.

    With all noise in the target the asymmetric scale a / Sxx is right on average, with all in the
    source its mirror image Syy / a, which is larger by 1 / R^2; in between lies what noise in both
    has. Each has the relative variance (1 / R^2 - 1) / (3 n - 7), of which five standard deviations
    are added on both sides, and the rounding of the data.

    scale: a / Sxx. explained: R^2. degrees: 3 n - 7; where it is below 1 nothing is known.
    """
    if scale <= 0 or explained <= 0 or degrees < LEAST_DEGREES:
        return 0.0, math.inf
    lost = float(1 / explained - 1)
    slack = DEVIATIONS * math.sqrt(lost / degrees) + ROUNDING
    least, most = nearest_or_zero(scale), nearest_or_zero(scale / explained)
    return least * (1.0 - slack), most * (1.0 + slack)


def unit_words(scale: Fraction, explained: Fraction, degrees: float) -> str | None:
    """The unit that would explain a scale, asked as a question; None where none does.

    >>> from fractions import Fraction
    >>> unit_words(Fraction(1000), Fraction(1), 5)
    '1000.0 times: a unit? (millimetres against metres)'
    >>> unit_words(Fraction(1001), Fraction(1), 5) is None
    True
    """
    unit = unit_between(*scale_between(scale, explained, degrees))
    if unit is None:
        return None
    return f"{float(f'{unit[0]:.6g}')!r} times: a unit? ({unit[1]})"
