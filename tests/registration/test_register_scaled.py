"""`register` with a scale, and without a translation, beside what is certified and beside SciPy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from strategies import random_rotation

from certreg import Similarity, register
from certreg.errors import (
    CertregError,
    DegenerateProblemError,
    InvalidProblemError,
    OutOfRangeError,
)

NEAR = 1e-12  # of the scale, the rotation and the clouds' size


def drawn(seed: int) -> tuple[Any, Any, Any]:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(3, 40))
    x = 10.0 ** rng.uniform(-3, 3) * rng.normal(size=(n, 3))
    y = 10.0 ** rng.uniform(-2, 2) * (x @ random_rotation(rng).T + rng.normal(size=3) * x.std())
    noise = rng.choice([0.0, 0.1, 3.0]) * y.std() * rng.normal(size=y.shape)
    return x, y + noise, rng.uniform(0.1, 3.0, n)


@pytest.mark.parametrize("unit", [1e-100, 1e100])
def test_no_size_leaves_the_doubles(unit: float):
    x, y, w = drawn(4)
    for scale in ("asymmetric", "symmetric"):
        plain = register(x, y, w, scale=scale)
        found = register(x / unit, y * unit, w, scale=scale)
        assert isinstance(plain, Similarity)
        assert isinstance(found, Similarity)
        assert abs(found.scale / (plain.scale * unit * unit) - 1.0) < NEAR
        assert np.abs(found.rotation - plain.rotation).max() < NEAR


def test_a_scale_that_no_double_holds_is_refused():
    x, y, w = drawn(4)
    for scale in ("asymmetric", "symmetric"):
        for unit in (1e-165, 1e160):
            with pytest.raises(OutOfRangeError, match="the scale exceeds the range of doubles"):
                register(x / unit, y * unit, w, scale=scale)


def test_what_rounding_does_not_tell_is_refused_with_a_scale_as_without():
    line = np.outer(np.arange(5.0), [1.0, 2.0, 3.0])
    cloud = np.random.default_rng(1).normal(size=(5, 3))
    for x, y in ((line, line), (np.ones((4, 3)), cloud[:4]), (cloud, np.zeros((5, 3)))):
        for scale in ("asymmetric", "symmetric"):
            with pytest.raises(CertregError) as caught:
                register(x, y, scale=scale)
            assert isinstance(caught.value, DegenerateProblemError)


@pytest.mark.parametrize("wrong", [{"scale": "free"}, {"rotation_only": 1}, {"scale": None}])
def test_another_word_is_refused(wrong: dict[str, Any]):
    cloud = np.random.default_rng(1).normal(size=(5, 3))
    with pytest.raises(InvalidProblemError):
        register(cloud, cloud, **wrong)
