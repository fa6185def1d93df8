"""The covariance with a free scale: what is uncorrelated, what is told, and where there is none."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from certreg import RegistrationProblem, certify
from certreg.objective.isotropic import Isotropic
from certreg.registration.covariance import BIASED, pose_covariance
from certreg.report.residual_table import residual_table
from certreg.results import Absent

if TYPE_CHECKING:
    from certreg.registration.result import Registration

SCALE, SIGMA = 2.5, 1e-3


def certified(source: Any, target: Any, **model: Any) -> Registration:
    return certify(source, target, relaxation=False, simulation=False, **model)


class Experiment:
    """Points with a noise of their own, and what a true similarity makes of them."""

    def __init__(self, n: int = 15) -> None:
        rng = np.random.default_rng(21)
        self.R = Rotation.from_quat(np.random.default_rng(3).normal(size=4)).as_matrix()
        self.source = rng.normal(size=(n, 3)) * [3.0, 1.0, 0.5] + np.array([2.0, -1.0, 3.0])
        self.sigma = SIGMA * rng.uniform(0.5, 2.0, size=n)
        self.clean = SCALE * self.source @ self.R.T + np.array([1.0, 2.0, -4.0])
        self.noisy = self.clean + rng.normal(size=(n, 3)) * self.sigma[:, None]

    @property
    def weights(self):
        return 1.0 / self.sigma**2


@pytest.mark.slow
def test_a_turn_and_the_scale_are_uncorrelated_and_the_centre_scatters_as_the_mean():
    experiment = Experiment()
    covariance = certified(
        experiment.source, experiment.clean, sigma=experiment.sigma, scale="asymmetric"
    ).covariance
    matrix, w = np.array(covariance), experiment.weights
    mean = experiment.R @ (w @ experiment.source / w.sum())

    assert np.abs(matrix[3:6, 6]).max() < 1e-25 * matrix[6, 6]  # but for the optimum's last bit
    spread = np.sum(w[:, None] * (experiment.source - w @ experiment.source / w.sum()) ** 2)
    assert matrix[6, 6] == pytest.approx(1.0 / spread)
    assert np.allclose(matrix[:3, 6], -mean / spread)
    assert covariance is not None
    assert covariance.centre_sigma == pytest.approx(w.sum() ** -0.5)
    assert covariance.ros is not None
    assert covariance.ros.shape == (6, 6)


def test_the_sizes_are_those_of_the_rigid_body_at_scale_one():
    rng = np.random.default_rng(5)
    x = rng.normal(size=(9, 3)) + np.array([1.0, 0.0, 4.0])
    rigid, scaled = (
        certified(x, x, sigma=0.01, **model).covariance for model in ({}, {"scale": "asymmetric"})
    )
    assert rigid is not None
    assert scaled is not None

    assert np.allclose(rigid.rotation_sigma, scaled.rotation_sigma, rtol=1e-12)
    assert np.array(scaled)[:6, :6] - np.array(rigid) == pytest.approx(
        np.outer(np.array(scaled)[:6, 6], np.array(scaled)[:6, 6]) / np.array(scaled)[6, 6]
    )


def test_of_the_symmetric_scale_none_is_told():
    """Noise in the target shifts it: 1 / 2 s Sxx times 3 (N - 1), of 4,000 points twice sigma."""
    rng = np.random.default_rng(8)
    x = rng.normal(size=(4000, 3))
    y = SCALE * x + 0.1 * rng.normal(size=x.shape)
    registration = certified(x, y, scale="symmetric", sigma=0.1)
    asymmetric = certified(x, y, scale="asymmetric", sigma=0.1)
    assert asymmetric.covariance is not None

    off = registration.pose.scale - asymmetric.pose.scale  # type: ignore[union-attr]
    assert off > 2.0 * asymmetric.covariance.scale_sigma  # type: ignore[operator]
    assert registration.covariance is None
    assert registration.solution.stated_covariance == BIASED
    assert registration.fit.chi2 is None
    reasons = registration.to_dict()["reasons"]
    assert reasons["pose.covariance"] == (
        "noise in the target makes the symmetric scale too large, of many points by more than it "
        "scatters, which no covariance tells"
    )
    assert reasons["fit.chi2"] == (
        "the symmetric scale is not the one of the least squares, which are tested"
    )
    assert reasons["fit.scale_p"] == (
        "with a free scale, or without a translation, no rows and no scale are tested"
    )


def test_standardised_residuals_are_in_standard_deviations():
    rng = np.random.default_rng(11)
    x = rng.normal(size=(400, 3))
    y = SCALE * x + 0.01 * rng.normal(size=x.shape)
    for model in ({"sigma": 0.01}, {}):
        for scale in ("asymmetric", "symmetric"):
            found = certified(x, y, scale=scale, **model)
            rows = b"".join(residual_table(found)).decode().splitlines()[1:]
            squares = sum(float(row.split(",")[3]) ** 2 for row in rows)

            assert squares == pytest.approx(3 * 400 - 7, rel=0.15 if model else 1e-9)


def test_residuals_at_rounding_tell_no_noise():
    rng = np.random.default_rng(2)
    x = rng.normal(size=(8, 3))
    registration = certified(x, SCALE * x, scale="asymmetric")

    assert registration.fit.rounded
    assert "not known: the residuals are so near rounding" in str(registration)
    assert not certified(
        x, SCALE * x + 1e-9 * rng.normal(size=(8, 3)), scale="asymmetric"
    ).fit.rounded


@pytest.mark.slow
@pytest.mark.one_in(2)
@pytest.mark.parametrize(("factor", "warned"), [(1.0, False), (3.0, True)])
def test_residuals_larger_than_sigma_are_warned_of(factor, warned):
    experiment = Experiment()
    found = certified(
        experiment.source, experiment.noisy, sigma=experiment.sigma / factor, scale="asymmetric"
    )

    assert bool(found.fit.warnings) == warned
    assert ("What to do" in str(found)) == warned


def test_a_line_has_no_covariance():
    line = np.outer([-1.0, 0.0, 1.0, 5.0], [1, 2, 3])
    problem = RegistrationProblem(line, 2 * line, scale="asymmetric", sigma=0.1)
    assert isinstance(pose_covariance(problem, Isotropic.of(problem)), Absent)
