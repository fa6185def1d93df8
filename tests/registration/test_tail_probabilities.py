"""Tails of distributions, beside SciPy's and beside simulated variables."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import special

from certreg.registration.tail_probabilities import (
    log_beta_below,
    log_chi2_above,
    log_chi2_below,
    log_choices,
    log_ratio_below,
)


@pytest.mark.parametrize("a", [0.5, 1.0, 3.5, 40.0, 1e4])
@pytest.mark.parametrize("b", [0.5, 1.0, 6.0, 300.0])
def test_the_beta_tail_is_that_of_scipy(a, b):
    for share in (1e-9, 0.01, 0.5, 0.9, 1.0, 1.1):
        x = min(share * a / (a + b), 1.0)
        expected = special.betainc(a, b, x)
        if expected > 1e-300:
            assert math.exp(log_beta_below(x, a, b)) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("degrees", [1, 2, 3, 24, 1001, 10**6])
def test_both_chi_squared_tails_are_those_of_scipy(degrees):
    for share in (0.01, 0.5, 0.99, 1.0, 1.01, 2.0):
        x = share * degrees
        below, above = special.gammainc(degrees / 2, x / 2), special.gammaincc(degrees / 2, x / 2)
        if below > 1e-300:
            assert math.exp(log_chi2_below(x, degrees)) == pytest.approx(below, rel=1e-8)
        if above > 1e-300:
            assert math.exp(log_chi2_above(x, degrees)) == pytest.approx(above, rel=1e-8)


def test_tails_beyond_the_doubles_are_finite_logarithms():
    assert -math.inf < log_beta_below(1e-6, 1e5, 0.5) < -1e6
    assert -math.inf < log_chi2_above(1e6, 3) < -4e5
    assert log_beta_below(0.0, 2.0, 0.5) == log_chi2_below(0.0, 3) == -math.inf
    assert log_beta_below(1.0, 2.0, 0.5) == log_chi2_above(0.0, 3) == 0.0


def test_choices_are_counted():
    assert math.exp(log_choices(10, 3)) == pytest.approx(120.0)


@pytest.mark.parametrize("degrees", [3, 9, 30])
def test_a_ratio_of_dependent_variables_is_bounded(degrees):
    """Independent ones, and one that is small where the other is large."""
    one, other = np.random.default_rng(0).chisquare(degrees, (2, 20_000))
    opposed = 2.0 * special.gammaincinv(degrees / 2, special.gammaincc(degrees / 2, one / 2))
    for upper in (other, opposed):
        for ratio in (0.5, 0.2, 0.05):
            bound = math.exp(log_ratio_below(ratio, degrees))
            assert np.mean(upper <= ratio * one) <= bound + 3e-3


def test_a_ratio_of_equal_variables_needs_no_bound():
    assert log_ratio_below(0.0, 5) == -math.inf
    assert log_ratio_below(0.999, 5) >= 0.0
