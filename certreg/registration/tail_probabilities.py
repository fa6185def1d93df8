"""Tails of the beta and the chi-squared distribution, as logarithms: no p-value underflows.

Continued fractions by Lentz's method. SciPy has both functions, but loading it takes longer than
most registrations do. Source: [Olver2010], 8.17.22 and 8.9.2.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import lru_cache

CONVERGED = 1e-14  # of the last factor from one
ROUNDING = 2.0**-53  # of 1 - p: a complement is never as small as a tail that matters
LEAST = 1e-300  # stands for a zero denominator, as Lentz has it
CUTS = 32  # of which the best gives a bound: half a per cent of the exponent is lost
MOST_TERMS = 1_000_000  # about sqrt(max(a, b)) are needed: more than any cloud in memory asks for


@lru_cache(maxsize=16)  # the p-value of a scale is asked for its warning, and as a number
def log_beta_below(x: float, a: float, b: float) -> float:
    """Log of the probability that a beta variable with parameters a, b > 0 is at most x.

    >>> round(math.exp(log_beta_below(0.25, 1.0, 1.0)), 12)
    0.25
    """
    if x <= 0.0:
        return -math.inf
    if x >= 1.0:
        return 0.0
    front = _log_gamma_ratio(a, b) + a * math.log(x) + b * math.log1p(-x)
    if x < (a + 1.0) / (a + b + 2.0):
        return front - math.log(a) - math.log(_fraction(1.0, _beta_terms(x, a, b)))
    other = front - math.log(b) - math.log(_fraction(1.0, _beta_terms(1.0 - x, b, a)))
    return _complement(other)


def log_chi2_above(value: float, degrees: float) -> float:
    """Log of the probability that a chi-squared variable is at least `value`.

    >>> round(math.exp(log_chi2_above(2.0, 2)), 12) == round(math.exp(-1.0), 12)
    True
    """
    x, a = value / 2.0, degrees / 2.0
    if x <= 0.0:
        return 0.0
    return _log_upper(x, a) if x >= a + 1.0 else _complement(_log_lower(x, a))


def log_chi2_below(value: float, degrees: float) -> float:
    """Log of the probability that a chi-squared variable is at most `value`."""
    x, a = value / 2.0, degrees / 2.0
    if x <= 0.0:
        return -math.inf
    return _log_lower(x, a) if x < a + 1.0 else _complement(_log_upper(x, a))


def log_ratio_below(ratio: float, degrees: float) -> float:
    """Log of a bound on the probability that one chi-squared variable is at most ratio of another.

    Both of these degrees of freedom, and dependent in any way: for every c, one is at most c or the
    other at least c / ratio.
    """
    if ratio <= 0.0:
        return -math.inf
    bounds: list[float] = []
    for k in range(1, CUTS):
        cut = degrees * ratio ** (k / CUTS)
        tails = log_chi2_below(cut, degrees), log_chi2_above(cut / ratio, degrees)
        bounds.append(max(tails) + math.log(2.0))
    return min(bounds)


def log_choices(n: int, k: int) -> float:
    """Log of the number of ways to choose k of n."""
    return math.lgamma(n + 1) - math.lgamma(k + 1) - math.lgamma(n - k + 1)


def _log_gamma_ratio(a: float, b: float) -> float:
    return math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b)


def _log_upper(x: float, a: float) -> float:
    """Log of the upper incomplete gamma function over Gamma(a), for x >= a + 1."""
    front = a * math.log(x) - x - math.lgamma(a)
    return front - math.log(_fraction(x + 1.0 - a, _gamma_terms(x, a)))


def _log_lower(x: float, a: float) -> float:
    """Log of the lower incomplete gamma function over Gamma(a), for x < a + 1, by its series."""
    term = total = 1.0 / a
    for k in range(1, MOST_TERMS):
        term *= x / (a + k)
        total += term
        if term < CONVERGED * total:
            break
    return a * math.log(x) - x - math.lgamma(a) + math.log(total)


def _complement(log_p: float) -> float:
    """Log of 1 - p; where rounding leaves nothing, of the least it leaves."""
    return math.log(max(-math.expm1(log_p), ROUNDING)) if log_p < 0.0 else math.log(ROUNDING)


def _beta_terms(x: float, a: float, b: float) -> Iterator[tuple[float, float]]:
    """(numerator, denominator) of each level of the fraction of the incomplete beta function."""
    m = 0
    while True:
        yield -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1)), 1.0
        m += 1
        yield m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)), 1.0


def _gamma_terms(x: float, a: float) -> Iterator[tuple[float, float]]:
    k = 0
    while True:
        k += 1
        yield -k * (k - a), x + 2 * k + 1.0 - a


def _fraction(first: float, terms: Iterator[tuple[float, float]]) -> float:
    """The continued fraction first + n1 / (d1 + n2 / (d2 + ...)), by Lentz's method."""
    value = first or LEAST
    c, d = value, 0.0
    for _, (numerator, denominator) in zip(range(MOST_TERMS), terms, strict=False):
        d = 1.0 / ((denominator + numerator * d) or LEAST)
        c = (denominator + numerator / c) or LEAST
        value *= c * d
        if abs(c * d - 1.0) < CONVERGED:
            break
    return value
