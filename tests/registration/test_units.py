"""A scale is told to be a unit only where the data leave room for that one, and not for much."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from strategies import random_rotation

from certreg import RegistrationProblem
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.registration.misfits import FitSums
from certreg.registration.units import (
    DEVIATIONS,
    MOST_SPREAD,
    UNITS,
    scale_between,
    unit_between,
    unit_words,
)


@pytest.mark.parametrize(
    ("ratio", "names"),
    [
        (10.0, "angstrom against nanometres"),
        (1000.0, "millimetres against metres"),
        (1e-3, "millimetres against metres"),
        (100.0, "centimetres against metres"),
        (1e-6, "micrometres against metres"),
        (25.4, "millimetres against inches"),
        (2.54, "centimetres against inches"),
        (12.0, "inches against feet"),
        (0.3048, "feet against metres"),
        (1.0 / 0.3048, "feet against metres"),
    ],
)
def test_the_usual_units_are_known_either_way_round(ratio: float, names: str):
    words = unit_words(Fraction(ratio), Fraction(1), 5)

    assert words == f"{float(f'{ratio:.6g}')!r} times: a unit? ({names})"
    assert unit_words(Fraction(ratio * (1 + 1e-9)), Fraction(1), 5) is None


def test_units_are_far_enough_apart_for_one_to_be_meant():
    ratios = sorted(ratio for k in UNITS for ratio in (k, 1 / k))

    assert min(b / a for a, b in pairwise(ratios)) > 1.19 > 1 + MOST_SPREAD


def test_an_interval_holds_its_ends_and_tells_nothing_where_it_is_wide():
    assert unit_between(999.0, 1000.0) is not None
    assert unit_between(1000.0, 1001.0) is not None
    assert unit_between(1000.0001, 1001.0) is None
    assert unit_between(995.1, 1000.0) is not None
    assert unit_between(985.0, 1005.0) is None
    for low, high in ((0.0, math.inf), (-1.0, 1.0), (math.nan, 1.0), (2.0, 1.0)):
        assert unit_between(low, high) is None


def test_too_few_pairs_tell_no_unit_but_by_the_data_themselves():
    assert scale_between(Fraction(1000), Fraction(1), 0) == (0.0, math.inf)
    assert unit_words(Fraction(1000), Fraction(1), -1) is None
    assert unit_words(Fraction(0), Fraction(0), 5) is None


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize("of", ["source", "target", "both"])
def test_the_true_scale_is_between_whichever_cloud_the_noise_is_in(of: str):
    """Of 200 problems with up to 10 % of noise; without the deviations it is not."""
    inside = narrow = 0
    for seed in range(200):
        rng = np.random.default_rng(seed)
        x, noise = rng.normal(size=(12, 3)), 10.0 ** rng.uniform(-4, -1)
        y = 1000.0 * x @ random_rotation(rng).T
        x = x + noise * rng.normal(size=x.shape) * (of != "target")
        y = y + 1000.0 * noise * rng.normal(size=x.shape) * (of != "source")
        moments = exact_moments(RegistrationProblem(x, y))
        sums = FitSums(Isotropic(moments))
        assert sums.scale is not None
        assert sums.explained is not None
        low, high = scale_between(sums.scale, sums.explained, 3 * 12 - 7)
        inside += low <= 1000.0 <= high
        narrow += sums.scale <= 1000 <= sums.scale / sums.explained

    assert inside == 200
    assert narrow < 200
    assert DEVIATIONS == 5.0
