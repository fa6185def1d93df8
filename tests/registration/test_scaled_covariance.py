"""The covariance with a free scale, or without a translation, is that of repeated experiments.

Six hundred repetitions are registered by Umeyama's closed form, which is no code of the package.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from certreg import RegistrationProblem, certify
from certreg.objective.isotropic import Isotropic
from certreg.problem.motion import Scale
from certreg.registration.covariance import BIASED, TURNED, pose_covariance
from certreg.report.pose_facts import pose_of
from certreg.report.residual_table import residual_table
from certreg.results import Absent

if TYPE_CHECKING:
    from certreg.registration.result import Registration

REPETITIONS = 600
SCALE, SIGMA = 2.5, 1e-3
WITHIN = 0.2  # 600 draws tell a standard deviation to 3 %, a variance to 6
MODELS = [
    {"scale": "asymmetric"},
    {"rotation_only": True},
    {"scale": "asymmetric", "rotation_only": True},
]


def certified(source: Any, target: Any, **model: Any) -> Registration:
    return certify(source, target, relaxation=False, simulation=False, **model)


class Experiment:
    """A source, a true similarity, and the best ones of many noisy targets."""

    def __init__(self, model: dict[str, Any], *, n: int = 15) -> None:
        rng = np.random.default_rng(21)
        self.model = model
        self.R = Rotation.from_quat(np.random.default_rng(3).normal(size=4)).as_matrix()
        self.s = SCALE if "scale" in model else 1.0
        self.t = np.zeros(3) if "rotation_only" in model else np.array([1.0, 2.0, -4.0])
        self.source = rng.normal(size=(n, 3)) * [3.0, 1.0, 0.5] + np.array([2.0, -1.0, 3.0])
        self.sigma = SIGMA * rng.uniform(0.5, 2.0, size=n)
        self.clean = self.s * self.source @ self.R.T + self.t
        noise = rng.normal(size=(REPETITIONS, n, 3)) * self.sigma[:, None]
        self.targets = self.clean + noise
        self.errors = np.array([self.error(target) for target in self.targets])

    def error(self, target):
        """(7,): what the true similarity is off the best one, (dt, phi, ds)."""
        w, x, y = self.weights, self.source, target
        mx, my = (np.zeros(3), np.zeros(3))
        if "rotation_only" not in self.model:
            mx, my = w @ x / w.sum(), w @ y / w.sum()
        C = ((y - my) * w[:, None]).T @ (x - mx)
        left, _, right = np.linalg.svd(C)
        left[:, 2] *= np.linalg.det(left @ right)
        R = left @ right
        s = np.sum(R * C) / np.sum(w[:, None] * (x - mx) ** 2) if "scale" in self.model else 1.0
        t = my - s * R @ mx
        phi = Rotation.from_matrix(R.T @ self.R).as_rotvec()
        return np.concatenate([self.t - t, phi, [self.s - s]])

    @property
    def weights(self):
        return 1.0 / self.sigma**2

    def registration(self, target) -> Registration:
        return certified(self.source, target, sigma=self.sigma, **self.model)


@pytest.fixture(scope="module", params=MODELS, ids="-".join)
def experiment(request):
    return Experiment(request.param)


@pytest.mark.slow
@pytest.mark.one_in(3)
def test_it_is_that_of_six_hundred_experiments(experiment):
    covariance = experiment.registration(experiment.clean).covariance
    assert covariance is not None
    size = 7 if "scale" in experiment.model else 6
    given = 3 if "rotation_only" in experiment.model else 0
    predicted, errors = np.array(covariance), experiment.errors[:, given:size]

    assert predicted.shape == (size, size)
    assert not predicted[:given].any()
    assert not predicted[:, :given].any()
    root = np.linalg.cholesky(predicted[given:, given:])
    white = np.linalg.solve(root, errors.T)
    values = np.linalg.eigvalsh(white @ white.T / REPETITIONS)
    assert np.allclose(np.diag(white @ white.T) / REPETITIONS, 1.0, atol=WITHIN)
    # of seven: 1 +- (2 sqrt(7 / 600) + 7 / 600), and a tenth of chance
    assert np.abs(values - 1.0).max() < 2.0 * math.sqrt(7 / REPETITIONS) + 0.1
    told = [*covariance.translation_sigma, *covariance.rotation_sigma]
    told += [] if covariance.scale_sigma is None else [covariance.scale_sigma]
    assert np.allclose(told, np.sqrt(np.diag(predicted)), rtol=1e-12)


@pytest.mark.slow
@pytest.mark.one_in(3)
def test_chi_squared_has_as_many_degrees_of_freedom_as_the_numbers_found_leave(experiment):
    found = [experiment.registration(target) for target in experiment.targets[:60]]
    tests = [one.fit.chi2 for one in found]
    degrees = {(False, True): 38, (True, False): 42, (True, True): 41}[
        "rotation_only" in experiment.model, "scale" in experiment.model
    ]

    assert {one.dof for one in tests if one} == {degrees}
    assert all(one.degrees_of_freedom == degrees for one in found)
    mean = np.mean([one.value for one in tests if one])  # of deviation sqrt(2 dof / 60)
    assert abs(mean - degrees) < 4.0 * math.sqrt(2.0 * degrees / len(found))


@pytest.mark.slow
@pytest.mark.one_in(4)
def test_without_sigma_it_is_scaled_by_the_residuals(experiment):
    target = experiment.targets[0]
    given = experiment.registration(target).covariance
    model = {**experiment.model, "weights": experiment.weights}
    estimated = certified(experiment.source, target, **model).covariance
    assert given is not None
    assert estimated is not None

    factor = estimated.variance_factor
    assert factor == pytest.approx(given.variance_factor)
    assert np.allclose(np.array(estimated), np.array(given) * factor, rtol=1e-9)


def test_without_a_translation_the_centre_has_no_deviation_and_says_why():
    experiment = Experiment({"rotation_only": True})
    covariance = experiment.registration(experiment.clean).covariance
    assert covariance is not None

    assert covariance.centre_sigma is None
    assert covariance.stated("centre_sigma") == TURNED


@pytest.mark.slow
def test_a_turn_and_the_scale_are_uncorrelated_and_the_centre_scatters_as_the_mean():
    experiment = Experiment(MODELS[0])
    covariance = experiment.registration(experiment.clean).covariance
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
    rigid, scaled = (certified(x, x, sigma=0.01, **model).covariance for model in ({}, MODELS[0]))
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
    assert registration.solution.stated_covariance == BIASED[Scale.SYMMETRIC]
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


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize("model", MODELS)
def test_it_is_told_everywhere(model):
    experiment = Experiment(model)
    registration = experiment.registration(experiment.targets[0])
    document, text = registration.to_dict(), str(registration)
    size = 7 if "scale" in model else 6

    assert np.array(document["pose"]["covariance"]).shape == (size, size)
    assert ("scale" in document["pose"]["uncertainty"]) == ("scale" in model)
    assert ("scale +/-" in text) == ("scale" in model)
    assert ("translation +/-" in text) != ("rotation_only" in model)
    assert "rotation +/-" in text
    assert registration.covariance is not None
    facts = {fact.name for fact in pose_of(registration).facts}
    assert ("Scale ±" in facts) == ("scale" in model)
    assert ("Centre ±" in facts) != ("rotation_only" in model)


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
    experiment = Experiment(MODELS[0])
    found = certified(
        experiment.source, experiment.targets[0], sigma=experiment.sigma / factor, **MODELS[0]
    )

    assert bool(found.fit.warnings) == warned
    assert ("What to do" in str(found)) == warned


def test_a_line_has_no_covariance():
    line = np.outer([-1.0, 0.0, 1.0, 5.0], [1, 2, 3])
    problem = RegistrationProblem(line, 2 * line, scale="asymmetric", sigma=0.1)
    assert isinstance(pose_covariance(problem, Isotropic.of(problem)), Absent)
