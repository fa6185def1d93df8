"""Numbers in words: what was proved of a number holds of the printed one, too."""

from __future__ import annotations

import math
from decimal import MAX_EMAX, MIN_EMIN, ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction

LEAST_PLAIN = 1e-4  # smaller numbers are written with an exponent


def at_most(value: float | Fraction, digits: int = 3) -> str:
    """An upper bound in few digits, rounded up: what is printed is still a bound.

    >>> at_most(0.12345), at_most(Fraction(1, 3), 6), at_most(5.0)
    ('0.124', '0.333334', '5')
    """
    return _rounded(value, digits, ROUND_CEILING)


def at_least(value: float | Fraction, digits: int = 3) -> str:
    """A lower bound in few digits, rounded down.

    >>> at_least(0.12345), at_least(Fraction(2, 3), 6), at_least(5.0)
    ('0.123', '0.666666', '5')
    """
    return _rounded(value, digits, ROUND_FLOOR)


def as_given(value: float) -> str:
    """A number of the user in the fewest digits that are read as the same double.

    >>> as_given(5.0), as_given(0.9999996), as_given(1e-6)
    ('5', '0.9999996', '1e-06')
    """
    return repr(float(value)).removesuffix(".0")


def _rounded(value: float | Fraction, digits: int, direction: str) -> str:
    """In decimal digits, of any size."""
    if isinstance(value, float) and math.isinf(value):
        return "(beyond doubles)"
    exact = Fraction(value)
    context = Context(prec=digits, rounding=direction, Emax=MAX_EMAX, Emin=MIN_EMIN)
    quotient = context.divide(Decimal(exact.numerator), Decimal(exact.denominator))
    small = 0 < quotient < LEAST_PLAIN
    return f"{quotient:.{digits - 1}e}" if small else f"{quotient:g}"
