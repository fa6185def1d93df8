"""What SciPy's `align_vectors` documents, certified: weights, one vector, an infinite weight."""

from __future__ import annotations

import warnings
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import scipy.spatial.transform as scipy_transform
from strategies import random_rotation

import certreg
from certreg.results import Optimality, PoseVerdict

FIXED = 2.0**106  # of the infinite weight: see docs/howto/similarity.md
DOCUMENTED = {  # target, source, weights
    "noise": (
        [[0, 1, 0], [0, 1, 1], [0, 1, 1]],
        [[1, 0, 0], [1, 1.1, 0], [1, 0.9, 0]],
        None,
    ),
    "a vector of length zero": ([[0, 1, 0], [0, 0, 0], [0, 0, 1]], np.eye(3), None),
    "weights": ([[0, 1, 0], [0, 1, 1]], [[1, 0, 0], [1, 1.1, 0]], [1.0, 100.0]),
    "one weight is zero": (np.eye(3)[[1, 2, 0]], np.eye(3) * [1, 2, 3], [1.0, 2.0, 0.0]),
}


def certified(target: Any, source: Any, weights: Any = None) -> Any:
    return certreg.certify(
        np.array(source, dtype=float),
        np.array(target, dtype=float),
        weights=weights,
        rotation_only=True,
        relaxation=False,
        simulation=False,
    )


@pytest.mark.parametrize("name", DOCUMENTED)
def test_documented_cases_are_reproduced_and_certified(name: str):
    target, source, weights = DOCUMENTED[name]
    turn = scipy_transform.Rotation.align_vectors(target, source, weights=weights)[0]
    found = certified(target, source, weights)

    assert found.status is Optimality.CERTIFIED
    assert np.abs(found.pose.rotation - turn.as_matrix()).max() < 1e-12
    assert certreg.assess(found, turn).verdict in {PoseVerdict.OPTIMAL, PoseVerdict.NEAR_OPTIMAL}
    assert found.pose.translation.tolist() == [0.0] * 3


def test_one_vector_alone_is_certified_not_unique():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        turn = scipy_transform.Rotation.align_vectors([[0, 1, 0]], [[1, 0, 0]])[0]
    found = certified([[0, 1, 0]], [[1, 0, 0]])

    assert found.status is Optimality.CERTIFIED_NOT_UNIQUE
    assert np.allclose(found.pose.rotation @ [1, 0, 0], [0, 1, 0], atol=1e-15)
    assert certreg.assess(found, turn).verdict is PoseVerdict.OPTIMAL


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize("noise", [0.0, 0.1, 3.0])
def test_a_finite_weight_stands_for_an_infinite_one(noise: float):
    """The bounds of the page hold, and the rotation is SciPy's, for 40 sets of vectors."""
    for seed in range(40):
        rng = np.random.default_rng(seed)
        n = int(rng.integers(2, 8))
        source = rng.normal(size=(n, 3)) * 10.0 ** rng.uniform(-2, 2, (n, 1))
        target = source @ random_rotation(rng).T + noise * np.abs(source).max() * rng.normal(
            size=(n, 3)
        )
        weights = np.r_[np.inf, rng.uniform(0.1, 3.0, n - 1)]
        x, y = (np.linalg.norm(c, axis=1) for c in (source, target))
        most = float(np.sum(weights[1:] * (x + y)[1:] ** 2))
        finite = np.r_[FIXED * most / (4.0 * x[0] * y[0]), weights[1:]]
        found = certified(target, source, finite)
        scipy = scipy_transform.Rotation.align_vectors(target, source, weights=weights)[0]

        assert found.status is Optimality.CERTIFIED
        assert found.certificate.body.gap < Fraction(most) / 10**20
        assert np.abs(found.pose.rotation - scipy.as_matrix()).max() < 1e-11
        aimed = found.pose.rotation @ source[0] / x[0] - target[0] / y[0]
        assert np.abs(aimed).max() < 4e-16 + 2.0**-52
