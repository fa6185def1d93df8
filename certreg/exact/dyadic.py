"""Dyadic numbers, and the ways from exact numbers to doubles, in a stated direction."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

DEGREE_SLACK = 1.0 + 1e-15  # radians to degrees rounds twice
ASIN_SLACK = 1.0 + 1e-12  # asin and sqrt of the C library err by an ulp or two: 1e-15
STEEP = 0.75  # sin^2 of 60 degrees: below it asin turns a relative error into at most twice that
PI_ABOVE = math.nextafter(math.pi, 4.0)  # by 3.2e-16, and a difference from it errs by 2.3e-16


MOST_WEIGHT = 1e300  # of a sigma that is sought: no root leaves the normal doubles


@lru_cache(maxsize=1024)  # the exponents of one problem's units come again and again
def power_of_two(exponent: int) -> Fraction:
    """2**exponent, exactly."""
    return Fraction(1 << exponent) if exponent >= 0 else Fraction(1, 1 << -exponent)


@dataclass(frozen=True, slots=True, kw_only=True)
class Dyadic:
    """mantissa * 2**exponent, exactly; the only kind of number that carries proof in a file."""

    mantissa: int
    exponent: int

    @property
    def value(self) -> Fraction:
        """The same number as a fraction."""
        if self.exponent >= 0:
            return Fraction(self.mantissa << self.exponent)
        return Fraction(self.mantissa, 1 << -self.exponent)

    @property
    def pair(self) -> list[int]:
        """[mantissa, exponent], as a file holds it."""
        return [self.mantissa, self.exponent]

    @classmethod
    def of_pair(cls, pair: Sequence[int]) -> Dyadic:
        """The inverse of `pair`."""
        mantissa, exponent = pair
        return cls(mantissa=mantissa, exponent=exponent)

    def shifted(self, places: int) -> Dyadic:
        """This number times 2**places."""
        return Dyadic(mantissa=self.mantissa, exponent=self.exponent + places)


def in_one_unit(*numbers: Dyadic) -> tuple[list[int], int]:
    """Integers k and one e such that the numbers are k 2^e: sums of them need no fractions."""
    least = min([number.exponent for number in numbers])
    return [number.mantissa << number.exponent - least for number in numbers], least


def weight_of_sigma(sigma: float) -> float:
    """The double nearest to 1/sigma^2; `1/(s*s)` in floating point misses it one time in four.

    Python's division of integers is correctly rounded. 0 or infinity where no double holds it.
    """
    numerator, denominator = sigma.as_integer_ratio()
    try:
        return (denominator * denominator) / (numerator * numerator)
    except OverflowError:
        return math.inf


def sigma_of_weight(weight: float) -> float | None:
    """The sigma of fewest digits that has this weight, of `weight_of_sigma`; None: none has it."""
    if not MOST_WEIGHT**-1 < weight < MOST_WEIGHT:
        return None
    near = (float(f"{weight**-0.5:.{digits}g}") for digits in range(1, 18))
    return next((sigma for sigma in near if weight_of_sigma(sigma) == weight), None)


def dyadic_above(value: Fraction, bits: int) -> Dyadic:
    """The least dyadic number >= value (>= 0) with at most `bits` bits of mantissa."""
    if value == 0:
        return Dyadic(mantissa=0, exponent=0)
    exponent = _exponent(value, bits)
    mantissa = -((-value.numerator << max(-exponent, 0)) // (value.denominator << max(exponent, 0)))
    return Dyadic(mantissa=mantissa, exponent=exponent)


def dyadic_below(value: Fraction, bits: int) -> Dyadic:
    """The greatest dyadic number <= value (>= 0) with about `bits` bits of mantissa."""
    if value == 0:
        return Dyadic(mantissa=0, exponent=0)
    exponent = _exponent(value, bits)
    mantissa = (value.numerator << max(-exponent, 0)) // (value.denominator << max(exponent, 0))
    return Dyadic(mantissa=mantissa, exponent=exponent)


def _exponent(value: Fraction, bits: int) -> int:
    return value.numerator.bit_length() - value.denominator.bit_length() - bits + 1


def nearest_double(value: Fraction) -> float | None:
    """The double nearest to the value; None where it overflows, or vanishes without being 0."""
    return nearest_quotient(value.numerator, value.denominator)


def nearest_quotient(numerator: int, denominator: int) -> float | None:
    """The double nearest to the quotient of integers, in lowest terms or not; as above.

    Python's division of integers rounds once, and no common factor has to be found for it.
    """
    nearest = quotient_or_zero(numerator, denominator)
    return None if math.isinf(nearest) or (nearest == 0.0 and numerator != 0) else nearest


def nearest_or_zero(value: Fraction) -> float:
    """The double nearest to the value, infinite beyond the doubles: for coordinates."""
    return quotient_or_zero(value.numerator, value.denominator)


def quotient_or_zero(numerator: int, denominator: int) -> float:
    """The same of a quotient of integers, in lowest terms or not; the denominator is positive."""
    try:
        return numerator / denominator
    except OverflowError:
        return math.inf if numerator > 0 else -math.inf


def double_above(value: Fraction) -> float:
    """The least double >= value (>= 0): an upper bound stays one. Infinity beyond the doubles."""
    try:
        nearest = value.numerator / value.denominator
    except OverflowError:
        return math.inf
    above, over = nearest.as_integer_ratio()
    if above * value.denominator >= value.numerator * over:
        return nearest
    return math.nextafter(nearest, math.inf)


def double_below(value: Fraction) -> float:
    """The greatest double <= value (>= 0)."""
    try:
        nearest = value.numerator / value.denominator
    except OverflowError:
        return math.nextafter(math.inf, 0.0)
    above, over = nearest.as_integer_ratio()
    if above * value.denominator <= value.numerator * over:
        return nearest
    return math.nextafter(nearest, 0.0)


def nearest_root(value: Fraction) -> float | None:
    """The square root of value (>= 0) as a double; None where no double can hold it.

    Taken over the integers, so that a square far outside the doubles costs nothing.
    """
    if value == 0:
        return 0.0
    n, d = value.numerator, value.denominator
    places = 64 - (n.bit_length() - d.bit_length()) // 2
    root = math.isqrt((n << 2 * places) // d if places >= 0 else n // (d << -2 * places))
    return nearest_quotient(root << max(-places, 0), 1 << max(places, 0))


def root_of_quotient(numerator: int, denominator: int) -> float | None:
    """The square root of a quotient >= 0 of integers, rounded once; None where no double holds it.

    For integers of thousands of bits, whose common factor takes longer to find than the root.
    """
    if numerator == 0:
        return 0.0
    places = 64 - (numerator.bit_length() - denominator.bit_length()) // 2
    above, below = (
        (numerator << 2 * places, denominator)
        if places >= 0
        else (numerator, denominator << -2 * places)
    )
    square, rest = divmod(above, below)
    root = math.isqrt(square)
    root = 2 * root + (rest != 0 or root * root != square)  # odd if anything is left: no tie then
    return nearest_quotient(root << max(-places, 0), 2 << max(places, 0))


def root_above(value: Fraction) -> float:
    """A double at or just above the square root of value (>= 0); infinity beyond the doubles."""
    return double_above(rational_root_above(value))


def rational_root_above(value: Fraction | int) -> Fraction:
    """A number just above the square root of value (>= 0): by 2^-63 of it, at most."""
    return dyadic_root_above(value).value


def dyadic_root_above(value: Fraction | int) -> Dyadic:
    """The same number."""
    if value == 0:
        return Dyadic(mantissa=0, exponent=0)
    n, d = value.numerator, value.denominator
    places = 64 - (n.bit_length() - d.bit_length()) // 2
    scaled = -((-n << 2 * places) // d) if places >= 0 else -(-n // (d << -2 * places))
    return Dyadic(mantissa=math.isqrt(scaled - 1) + 1, exponent=-places)


def half_angle_bound(sin2_half_angle: Fraction) -> float:
    """An upper bound on theta in radians, given an upper bound on sin^2(theta/2); at most pi.

    Near pi, where the arcsine is steep, pi less twice that of cos(theta/2), rounded down.
    """
    if sin2_half_angle >= 1:
        return math.pi
    if sin2_half_angle > STEEP:
        rest = math.asin(math.sqrt(double_below(1 - sin2_half_angle)))
        return min(math.pi, PI_ABOVE - 2.0 * rest / ASIN_SLACK)
    return 2.0 * math.asin(math.sqrt(double_above(sin2_half_angle))) * ASIN_SLACK


def degrees_above(radians: float) -> float:
    """An upper bound on an angle, in degrees."""
    return math.degrees(radians) * DEGREE_SLACK
