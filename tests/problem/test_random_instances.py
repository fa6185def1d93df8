"""Random instances: what their law says."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmarks.rates.consensus_labels import outlier_instance
from certreg.errors import InvalidProblemError


def test_right_pairs_differ_by_noise_and_wrong_ones_are_in_a_ball():
    made = outlier_instance(np.random.default_rng(0), points=4000, outliers=2000, sigma=0.01)
    off = made.target - made.source @ made.rotation.T - made.translation
    right = ~made.wrong
    lengths = np.linalg.norm(made.target[made.wrong] - made.target[right].mean(axis=0), axis=1)

    assert made.wrong.sum() == 2000
    assert np.linalg.det(made.rotation) == pytest.approx(1.0)
    assert off[right].std() == pytest.approx(0.01, rel=0.05)
    assert lengths.max() <= math.sqrt(3.0) / 2.0
    assert np.median(lengths) == pytest.approx(math.sqrt(3.0) / 2.0 * 0.5 ** (1 / 3), rel=0.02)
    assert 0.0 <= made.source.min() <= made.source.max() <= 1.0
    assert 0.4 < made.wrong[:2000].mean() < 0.6


@pytest.mark.parametrize(
    ("given", "array"),
    [
        ({"points": 3, "outliers": 3}, "outliers"),
        ({"points": 3, "outliers": -1}, "outliers"),
        ({"points": 3, "outliers": 0, "sigma": -1.0}, "sigma"),
        ({"points": 3, "outliers": 0, "sigma": math.inf}, "sigma"),
    ],
)
def test_impossible_instances_are_refused(given, array):
    with pytest.raises(InvalidProblemError) as refused:
        outlier_instance(np.random.default_rng(0), **given)

    assert refused.value.array == array
