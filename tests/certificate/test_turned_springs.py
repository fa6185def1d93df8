"""Springs that turn about the origin, a part of `make rates NAME=turned_springs`."""

from __future__ import annotations

import json

import numpy as np
import pytest

from benchmarks.rates import turned_springs
from certreg.verify import check


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_certified_optimum_is_that_of_descents_and_accepted_by_the_checker_alone(seed: int):
    assert turned_springs.optimum_missed(seed) == ""


def test_another_optimum_of_the_descents_is_seen(monkeypatch: pytest.MonkeyPatch):
    least = turned_springs.least

    def changed(cost: float, at: object) -> tuple[float, object]:
        return cost * (1 + 1e-11), at

    monkeypatch.setattr(turned_springs, "least", lambda *given: changed(*least(*given)))

    assert "SciPy finds" in turned_springs.optimum_missed(0)


@pytest.mark.slow
def test_the_noise_is_estimated_with_the_right_degrees_of_freedom():
    """With 4 counted as 7, as with a translation, the mean would be above 1.15 for planes."""
    factors = np.array([turned_springs.variance_factor(seed) for seed in range(60)])
    error = factors.std(ddof=1) / np.sqrt(len(factors))

    assert abs(factors.mean() - 1.0) < 3 * error
    assert error < 0.06


@pytest.mark.slow
def test_certificates_whose_claims_are_false_are_refused():
    made = [(seed, turned_springs.forged(seed)) for seed in range(12)]
    false = [document for seed, document in made if turned_springs.is_false(document, seed)]

    assert len(false) >= 8
    assert not any(check(json.dumps(document).encode()).verified for document in false)
