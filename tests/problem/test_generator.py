"""Random instances are what the paper says they are."""

from __future__ import annotations

import numpy as np
import pytest

from certreg.errors import InvalidProblemError
from certreg.geometry.so3 import quaternion_from_matrix
from certreg.problem.random_instances import gaussian_instances


def test_the_noise_is_what_the_motion_does_not_explain():
    made = gaussian_instances(np.random.default_rng(1), points=200, sigma=0.01, count=300)

    moved = np.matmul(made.sources, made.rotations.mT) + made.translations[:, np.newaxis]
    noise = made.targets - moved
    assert noise.std() == pytest.approx(0.01, rel=0.01)
    assert np.abs(noise.mean(axis=(0, 1))).max() < 5 * 0.01 / np.sqrt(200 * 300)


def test_without_noise_the_motion_is_exact_to_rounding():
    made = gaussian_instances(np.random.default_rng(2), points=5, sigma=0.0, count=50)

    moved = np.matmul(made.sources, made.rotations.mT) + made.translations[:, np.newaxis]
    assert np.abs(made.targets - moved).max() < 1e-13


def test_rotations_are_rotations_and_uniform():
    """For uniform R every entry has mean 0 and mean square 1/3, and E[trace] = 0."""
    rotations = gaussian_instances(np.random.default_rng(3), points=1, count=20000).rotations

    assert np.abs(np.matmul(rotations, rotations.mT) - np.eye(3)).max() < 1e-14
    assert np.linalg.det(rotations).min() > 0
    assert np.abs(rotations.mean(axis=0)).max() < 5 / np.sqrt(3 * 20000)
    assert np.abs((rotations**2).mean(axis=0) - 1 / 3).max() < 0.012
    turns = np.array([quaternion_from_matrix(R)[0] ** 2 for R in rotations[:2000]])
    assert turns.mean() == pytest.approx(1 / 4, abs=0.03)  # of a uniform unit quaternion


def test_targets_are_centred_and_sources_shifted_with_them():
    """x + y_mean has mean 0 in the mean over clouds, where x itself is not centred."""
    made = gaussian_instances(np.random.default_rng(4), points=50, count=2000)

    assert np.abs(made.targets.mean(axis=1)).max() < 1e-14
    shifts = made.sources.mean(axis=1)  # x_mean - y_mean, and y_mean is about t ~ N(0, I)
    assert shifts.var() == pytest.approx(1.0 + 2 / 50, rel=0.06)


def test_one_seed_is_one_set_of_doubles():
    first, second = (gaussian_instances(np.random.default_rng(5), count=20) for _ in range(2))

    assert first.sources.tobytes() == second.sources.tobytes()
    assert first.targets.tobytes() == second.targets.tobytes()


@pytest.mark.parametrize(
    "wrong", [{"points": 0}, {"sigma": -1.0}, {"sigma": np.inf}, {"count": -1}]
)
def test_what_is_no_experiment_is_refused(wrong):
    with pytest.raises(InvalidProblemError, match="at least one point"):
        gaussian_instances(np.random.default_rng(0), **wrong)
