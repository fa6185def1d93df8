"""The covariance of the pose is that of repeated experiments, in all three conventions.

Ten thousand repetitions are registered in one batch by an SVD that is no code of the package. The
sample covariance, whitened by the predicted one, has the eigenvalues of a Wishart matrix: 1, with
a standard deviation of sqrt(2/n) in each direction. The noise is small: the prediction is of first
order.
"""

from __future__ import annotations

import math
from fractions import Fraction
from functools import cache
from typing import Any

import mpmath
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from strategies import TETRAHEDRON, ZOO, random_rotation

from certreg.geometry.pose import Pose
from certreg.objective.isotropic import Isotropic
from certreg.problem import arrays as problems
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem
from certreg.registration.certification import certify
from certreg.registration.covariance import (
    LEAST_CORRELATION,
    PoseCovariance,
    RationalMatrix,
    _in_doubles,
    pose_covariance,
    residual_distances,
    worst_residuals,
)
from certreg.registration.tail_probabilities import log_chi2_above
from certreg.report.uncertainty import FIRST_ORDER
from certreg.results import OUT_OF_RANGE, Absent

REPETITIONS = 10_000
SIGMA = 1e-3
SHAPES = {"isotropic": (1.0, 1.0, 1.0), "elongated": (50.0, 1.0, 0.2)}


def covariance_of(problem) -> Any:
    return pose_covariance(problem, Isotropic(exact_moments(problem)))


class Experiment:
    """A true pose, noise-free points, and the poses found from many noisy targets."""

    def __init__(self, shape: str, *, even: bool = False, n: int = 12) -> None:
        rng = np.random.default_rng(61)
        self.source = rng.normal(size=(n, 3)) * SHAPES[shape] + [3.0, -2.0, 5.0]
        self.R, self.t = random_rotation(rng), np.array([1.0, 2.0, -4.0])
        self.sigma = SIGMA * (np.ones(n) if even else rng.uniform(0.5, 2.0, size=n))
        self.weights = 1.0 / self.sigma**2
        self.clean = self.source @ self.R.T + self.t
        noise = rng.normal(size=(REPETITIONS, n, 3)) * self.sigma[:, None]
        self.targets = self.clean + noise
        self._register()

    def _register(self) -> None:
        w, mass = self.weights, self.weights.sum()
        x_mean = w @ self.source / mass
        y_mean = np.einsum("n,rnk->rk", w, self.targets) / mass
        centred = self.targets - y_mean[:, None]
        C = np.einsum("n,rnj,nk->rjk", w, centred, self.source - x_mean)
        left, _, right = np.linalg.svd(C)
        sign = np.linalg.det(left @ right)
        left[:, :, 2] *= sign[:, None]
        self.found_R = left @ right
        self.found_t = y_mean - self.found_R @ x_mean
        rest = self.targets - self.source @ self.found_R.transpose(0, 2, 1) - self.found_t[:, None]
        self.objectives = np.einsum("n,rnk,rnk->r", w, rest, rest)

    def problem(self, target) -> RegistrationProblem:
        return RegistrationProblem(self.source, target, sigma=self.sigma)

    @cache  # noqa: B019 (three answers, for as long as the module's tests)
    def errors(self, convention: str):
        """(repetitions, 6): what the true pose is off the found one, in that parametrisation."""
        forward = self.found_R.transpose(0, 2, 1) @ self.R  # R_true = R exp([phi])
        phi = Rotation.from_matrix(forward).as_rotvec()
        dt = self.t - self.found_t
        if convention == "matrix":
            return np.hstack([dt, phi])
        if convention == "ros":  # R_true = exp([theta]) R, translation first, fixed frame
            theta = Rotation.from_matrix(self.R @ self.found_R.transpose(0, 2, 1)).as_rotvec()
            return np.hstack([dt, theta])
        return np.array([_logarithm(a, b) for a, b in zip(phi, self._moved(dt), strict=True)])

    def _moved(self, dt):
        """The translation part of T^-1 T_true."""
        return np.einsum("rkj,rk->rj", self.found_R, dt)


def _logarithm(phi, shift):
    """(phi, v) with Exp((phi, v)) = (exp([phi]), shift): gtsam's Pose3, rotation first."""
    a = np.linalg.norm(phi)
    x, y, z = phi
    W = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    V = np.eye(3) + (1 - math.cos(a)) / a**2 * W + (a - math.sin(a)) / a**3 * W @ W
    return np.concatenate([phi, np.linalg.solve(V, shift)])


@pytest.fixture(scope="module", params=SHAPES)
def experiment(request):
    return Experiment(request.param)


def whitened_eigenvalues(samples, predicted):
    scatter = samples.T @ samples / len(samples)  # about the truth, not about the mean
    root = np.linalg.cholesky(predicted)
    inverse = np.linalg.inv(root)
    return np.linalg.eigvalsh(inverse @ scatter @ inverse.T)


def is_sampled_from(samples, predicted) -> bool:
    """Within five standard deviations of each variance, and the spread of six eigenvalues."""
    off = np.abs(whitened_eigenvalues(samples, predicted) - 1.0).max()
    return bool(off < 5.0 * math.sqrt(2.0 / len(samples)))


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize("convention", ["matrix", "ros", "gtsam"])
def test_the_covariance_is_that_of_ten_thousand_experiments(experiment, convention):
    covariance = covariance_of(experiment.problem(experiment.clean))

    assert is_sampled_from(experiment.errors(convention), getattr(covariance, convention))


@pytest.mark.slow
def test_what_is_told_of_each_number_is_the_scatter_of_the_experiments(experiment):
    """Each within five standard deviations, 1/sqrt(2 n) of a standard deviation's own."""
    covariance = covariance_of(experiment.problem(experiment.clean))
    errors = experiment.errors("matrix")
    mean = experiment.weights @ experiment.source / experiment.weights.sum()
    centre = errors[:, :3] - (experiment.found_R - experiment.R) @ mean  # of t + R mean
    told = [*covariance.translation_sigma, *covariance.rotation_sigma]

    error = 5.0 / math.sqrt(2.0 * REPETITIONS)
    assert np.allclose(np.sqrt(np.mean(errors**2, axis=0)), told, rtol=error)
    assert np.allclose(np.sqrt(np.mean(centre**2, axis=0)), covariance.centre_sigma, rtol=error)
    along = errors[:, 3:] @ covariance.loosest_axis
    assert np.sqrt(np.mean(along**2)) == pytest.approx(covariance.loosest_sigma, rel=error)
    assert covariance.loosest_sigma >= max(covariance.rotation_sigma)


@pytest.mark.slow
@pytest.mark.one_in(2)
def test_the_p_value_of_chi_squared_is_uniform(experiment):
    """Kolmogorov and Smirnov: sqrt(n) times the distance is above 2.2 once in 10^4 samples."""
    degrees = 3 * len(experiment.source) - 6
    p = np.sort(
        [math.exp(log_chi2_above(value, degrees)) for value in experiment.objectives[:2000]]
    )
    steps = np.arange(len(p) + 1) / len(p)

    distance = max(np.abs(p - steps[1:]).max(), np.abs(p - steps[:-1]).max())
    assert math.sqrt(len(p)) * distance < 2.2
    other = np.sort(
        [math.exp(log_chi2_above(v, degrees + 3)) for v in experiment.objectives[:2000]]
    )
    assert math.sqrt(len(p)) * np.abs(other - steps[1:]).max() > 2.2  # 3 N - 3 would be seen


def test_chi_squared_of_a_fit_is_its_objective(experiment):
    target, objective = experiment.targets[0], experiment.objectives[0]
    registration = certify(experiment.problem(target), relaxation=False, simulation=False)
    chi2, degrees = registration.fit.chi2, 3 * len(experiment.source) - 6

    assert chi2 is not None
    assert (chi2.dof, chi2.value) == (degrees, pytest.approx(objective, rel=1e-6))
    assert chi2.p == pytest.approx(math.exp(log_chi2_above(objective, degrees)), rel=1e-4)


def test_the_first_order_is_right_to_a_twentieth_up_to_where_it_is_told():
    """The turn of a thin cloud about its axis, of 0.2 radians; 5 / sqrt(2 n) of it is chance."""
    rng = np.random.default_rng(5)
    source = rng.normal(size=(12, 3)) * [10.0, 0.3, 0.2]
    source -= source.mean(axis=0)
    unit = covariance_of(RegistrationProblem(source, source, sigma=1.0))
    sigma = FIRST_ORDER / unit.loosest_sigma
    count = 4000
    noisy = source + sigma * rng.normal(size=(count, 12, 3))
    left, _, right = np.linalg.svd(np.einsum("rnj,nk->rjk", noisy, source))
    left[:, :, 2] *= np.linalg.det(left @ right)[:, None]
    phi = Rotation.from_matrix((left @ right).transpose(0, 2, 1)).as_rotvec()

    ratio = np.sqrt(np.mean(phi**2, axis=0)) / (sigma * unit.rotation_sigma)
    assert np.allclose(ratio, 1.0, rtol=0.05 + 5.0 / math.sqrt(2.0 * count))


SQUARE = np.array([[1.0, 1, 0], [1, -1, 0], [-1, 1, 0], [-1, -1, 0]])


def test_the_second_order_of_the_turn_is_that_of_sampled_turns():
    """Of a cloud far off along one axis: beside the tangent there the arc is not small."""
    rng = np.random.default_rng(6)
    turn = Rotation.from_rotvec([0.2, -0.5, 0.9]).as_matrix()
    source = rng.normal(size=(9, 3)) + turn.T @ [400.0, 0.0, 0.0]
    covariance = covariance_of(RegistrationProblem(source, source @ turn.T, sigma=0.01))
    phi = rng.multivariate_normal(np.zeros(3), np.asarray(covariance)[3:, 3:], size=20_000)
    arms = source.mean(axis=0) @ turn.T - Rotation.from_rotvec(phi).apply(source.mean(0)) @ turn.T
    first = np.cross(source.mean(axis=0), phi) @ turn.T

    share = np.sqrt(np.mean((arms - first) ** 2, axis=0)) / covariance.translation_sigma
    assert share.argmax() == 0
    assert covariance.second_order == pytest.approx(share.max(), rel=0.05)
    assert covariance_of(RegistrationProblem(SQUARE, SQUARE, sigma=0.01)).second_order == 0.0


@pytest.mark.slow
def test_a_sigma_from_the_residuals_is_as_sure_as_is_said():
    """Its standard deviation is 1/sqrt(2 (3N - 6)) of it, to a tenth at 30 degrees of freedom."""
    experiment = Experiment("isotropic", even=True)
    degrees = 3 * len(experiment.source) - 6
    sigmas = np.sqrt(experiment.objectives / degrees)

    assert np.std(sigmas) == pytest.approx(1.0 / math.sqrt(2.0 * degrees), rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("told", ["matrix", "ros", "gtsam"])
@pytest.mark.parametrize("meant", ["matrix", "ros", "gtsam"])
def test_the_conventions_are_told_apart(experiment, told, meant):
    covariance = covariance_of(experiment.problem(experiment.clean))

    same = is_sampled_from(experiment.errors(told), getattr(covariance, meant))

    assert same == (told == meant)


def test_an_error_of_a_tenth_in_the_covariance_would_be_seen(experiment):
    covariance = covariance_of(experiment.problem(experiment.clean))

    assert not is_sampled_from(experiment.errors("matrix"), covariance.matrix * 1.1)
    assert not is_sampled_from(experiment.errors("matrix"), covariance.matrix / 1.1)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("shape", "count"),
    [
        ("elongated", 100),
        pytest.param("elongated", 300, marks=pytest.mark.long),
        pytest.param("isotropic", 300, marks=pytest.mark.long),
    ],
)
def test_the_estimated_covariance_is_that_of_the_experiments_in_the_mean(shape, count):
    """Each run estimates its own variance; the factor's mean is s^2, its error sqrt(2/(3N - 6))."""
    experiment = Experiment(shape, even=True)
    degrees = 3 * len(experiment.source) - 6
    variances, matrices = [], []
    for target, objective in zip(experiment.targets[:count], experiment.objectives, strict=False):
        estimated = covariance_of(RegistrationProblem(experiment.source, target))
        given = covariance_of(experiment.problem(target))
        assert (estimated.estimated, given.estimated) == (True, False)
        assert given.variance_factor == pytest.approx(objective / degrees, rel=1e-6)
        assert estimated.variance_factor == pytest.approx(SIGMA**2 * given.variance_factor)
        assert np.allclose(estimated.matrix, given.matrix * given.variance_factor, rtol=1e-9)
        variances.append(estimated.variance_factor)
        matrices.append(estimated.matrix / estimated.variance_factor)

    assert abs(np.mean(variances) / SIGMA**2 - 1.0) < 5.0 * math.sqrt(2.0 / degrees / count)
    mean_variance = SIGMA**2 * np.mean(experiment.objectives) / degrees
    assert is_sampled_from(experiment.errors("matrix"), mean_variance * np.mean(matrices, axis=0))


def test_the_variance_factor_shows_a_sigma_that_is_wrong(experiment):
    right = covariance_of(experiment.problem(experiment.targets[0]))
    wrong = covariance_of(
        RegistrationProblem(experiment.source, experiment.targets[0], sigma=experiment.sigma / 10)
    )

    assert 0.2 < right.variance_factor < 2.5
    assert wrong.variance_factor == pytest.approx(100 * right.variance_factor)


def test_the_mean_of_all_variance_factors_is_one(experiment):
    degrees = 3 * len(experiment.source) - 6
    factors = experiment.objectives / degrees

    assert abs(factors.mean() - 1.0) < 5.0 * math.sqrt(2.0 / degrees / REPETITIONS)


@pytest.mark.parametrize("specimen", ZOO, ids=lambda specimen: specimen.name)
def test_there_is_a_covariance_exactly_where_the_optimum_is_unique(specimen):
    problem = RegistrationProblem(specimen.source, specimen.target, sigma=1.0)

    assert isinstance(covariance_of(problem), PoseCovariance) == (specimen.pattern[0] == 1)


def test_a_covariance_is_symmetric_and_positive_definite():
    covariance = covariance_of(RegistrationProblem(TETRAHEDRON, TETRAHEDRON, sigma=0.1))

    for matrix in (covariance.matrix, covariance.ros, covariance.gtsam):
        assert np.allclose(matrix, matrix.T, rtol=0, atol=1e-18)
        assert np.linalg.eigvalsh(matrix).min() > 0


def test_the_tetrahedron_has_the_covariance_found_by_hand():
    """N = 4, J = 8 I, G = 2 J = 16 I (unit weights), mean 0: cov phi = s^2 I/8, cov t = s^2 I/4."""
    covariance = covariance_of(RegistrationProblem(TETRAHEDRON, TETRAHEDRON, sigma=0.5))

    assert np.allclose(covariance.matrix, 0.25 * np.diag([1 / 4] * 3 + [1 / 8] * 3))


def covariance_by_definition(problem: RegistrationProblem) -> Any:
    """(6, 6), the inverse of the normal equations, where the pose moves nothing; sigma given."""
    info = mpmath.zeros(6)
    for point, weight in zip(problem.source.tolist(), problem.weights.tolist(), strict=True):
        x, y, z = (mpmath.mpf(entry) for entry in point)
        turned = mpmath.matrix([[0, z, -y], [-z, 0, x], [y, -x, 0]])
        jacobian = mpmath.zeros(3, 6)
        for i in range(3):
            jacobian[i, i] = 1
            for j in range(3):
                jacobian[i, 3 + j] = turned[i, j]
        info += weight * jacobian.T * jacobian
    return info**-1


LINE = np.outer(np.arange(6.0), [1.0, 2.0, 3.0])
BENT = [*LINE[:2], LINE[2] + [1e-8, 0.0, 0.0], *LINE[3:]]


@pytest.mark.parametrize(
    ("source", "held"),
    [(LINE / 7 + np.eye(6, 3), True), (BENT, False), (np.eye(4, 3) + 1e8, False)],
    ids=["points", "almost on a line", "far away"],
)
def test_deviations_are_right_where_a_matrix_of_doubles_would_lose_them(source, *, held: bool):
    """The residuals are zero: linearised by the points or at the Hessian, all is the same."""
    problem = RegistrationProblem(source, source, sigma=0.001)
    found = covariance_of(problem)
    with mpmath.workdps(120):
        right = covariance_by_definition(problem)
        sigmas = [float(mpmath.sqrt(right[i, i])) for i in range(6)]
        turns = mpmath.eigsy(right[3:, 3:], eigvals_only=True)
        loosest = float(mpmath.sqrt(max(turns)))
        full = np.array([[float(right[i, j]) for j in range(6)] for i in range(6)])

    told = [*found.translation_sigma, *found.rotation_sigma]
    assert np.allclose(told, sigmas, rtol=1e-12)
    assert found.loosest_sigma == pytest.approx(loosest, rel=1e-12)
    assert (found.matrix is not None) == held
    if held:
        assert np.allclose(found.matrix, full, rtol=1e-9, atol=1e-12 * full.max())
    else:
        assert found.stated("matrix").reason.startswith("lost in rounding: ")
        assert found.ros is found.gtsam is None
        with pytest.raises(ValueError, match="lost in rounding"):
            np.asarray(found)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("width", [1e-20, 1e-60, 1e-100])
def test_a_turn_about_a_line_is_told_however_near_it_the_points_are(width: float, *, turned: bool):
    """The optimum has as many bits as that takes; the deviation is inverse to the width."""
    line = np.outer([-2.0, -1.0, 0.0, 1.0, 3.0], [1.0, 0.0, 0.0])
    aside = np.array([[0, 0, 0], [0, 1, 0], [0, 0, 0], [0, 0, 1], [0, -1, 0]])
    turn = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]) if turned else np.eye(3)

    near, far = (
        covariance_of(RegistrationProblem(x, x @ turn.T, sigma=0.01)).loosest_sigma * e
        for e, x in ((e, line + e * aside) for e in (1e-10, width))
    )
    assert far == pytest.approx(near, rel=1e-12)


def test_where_a_matrix_is_lost_the_reason_names_what_to_do():
    far, bent = (
        covariance_of(RegistrationProblem(points, points, sigma=0.001)).stated("matrix").reason
        for points in (np.eye(4, 3) + 1e8, BENT)
    )

    assert far.endswith("so far are the points from the origin: move it to them")
    assert bent.endswith("one turn is hardly determined, beside the others")


def test_a_matrix_is_lost_just_where_a_variance_could_be_off_by_a_hundredth():
    """Two turns whose correlation leaves 1 - c, the least eigenvalue of the correlations."""

    def kept(rest: Fraction) -> bool:
        rows = rest.denominator * np.eye(6, dtype=int).astype(object)
        rows[3, 4] = rows[4, 3] = rest.denominator - rest.numerator
        exact = RationalMatrix(rows=rows, denominator=rest.denominator)
        return not isinstance(_in_doubles(exact), Absent)

    assert kept(Fraction(1.05 * LEAST_CORRELATION))
    assert not kept(Fraction(0.95 * LEAST_CORRELATION))
    assert Fraction(6, 2**53) / Fraction(LEAST_CORRELATION) <= Fraction(1, 100)


@pytest.mark.parametrize("unit", [1e-250, 1e-200, 1e120])
def test_deviations_are_told_where_no_double_holds_their_squares(unit: float):
    source = np.array(TETRAHEDRON) + np.eye(4, 3)
    noise = np.random.default_rng(2).normal(size=(4, 3))
    near = covariance_of(RegistrationProblem(source, source + 0.01 * noise))
    far = covariance_of(RegistrationProblem(source * unit, (source + 0.01 * noise) * unit))

    assert np.allclose(far.translation_sigma / unit, near.translation_sigma, rtol=1e-9)
    assert np.allclose(far.rotation_sigma, near.rotation_sigma, rtol=1e-9)
    if unit < 1.0:
        assert far.matrix is None
        assert far.stated("matrix") == OUT_OF_RANGE


def test_points_of_weight_zero_give_no_degree_of_freedom():
    weights = [1.0, 1.0, 1.0, 0.0]
    moved = np.array([[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1], [9, 9, 9]])
    target = np.array(TETRAHEDRON) + moved
    three = RegistrationProblem(TETRAHEDRON[:3], target[:3], weights=weights[:3])
    four = RegistrationProblem(TETRAHEDRON, target, weights=weights)

    assert np.allclose(covariance_of(four).matrix, covariance_of(three).matrix)
    assert covariance_of(four).variance_factor == covariance_of(three).variance_factor
    assert covariance_of(three).variance_factor > 0


def test_residual_distances_are_those_of_the_points_and_do_not_overflow():
    rng = np.random.default_rng(8)
    source = rng.normal(size=(7, 3))
    target = source @ random_rotation(rng).T + 0.1 * rng.normal(size=(7, 3))
    problem = RegistrationProblem(source, target)
    pose = certify(problem, relaxation=False, simulation=False).pose
    expected = np.linalg.norm(target - source @ pose.rotation.T - pose.translation, axis=1)

    assert np.allclose(residual_distances(problem, pose), expected, rtol=1e-12)
    huge = RegistrationProblem(source * 2.0**700, target * 2.0**700)
    pose = certify(huge, relaxation=False, simulation=False).pose
    assert np.allclose(residual_distances(huge, pose) / 2.0**700, expected, rtol=1e-6)


def test_the_worst_residuals_are_the_largest_and_of_equal_ones_the_first(monkeypatch):
    rng = np.random.default_rng(3)
    offsets = rng.integers(0, 6, size=200).astype(float)  # many equal distances
    target = np.zeros((200, 3))
    target[:, 0] = offsets
    problem = RegistrationProblem(np.zeros((200, 3)), target)
    pose = Pose(
        rotation=np.eye(3), translation=np.zeros(3), quaternion_wxyz=np.array([1.0, 0, 0, 0])
    )
    expected = sorted(range(200), key=lambda k: (-offsets[k], k))
    monkeypatch.setattr(problems, "BLOCK_POINTS", 7)

    for count in (1, 3, 50, 300):
        found = worst_residuals(problem, pose, count)
        assert [one.row for one in found] == expected[:count]
        assert [one.distance for one in found] == [offsets[k] for k in expected[:count]]


@pytest.mark.parametrize("n", [3, 4, 12])
def test_the_variance_factor_is_the_objective_over_its_degrees_of_freedom(n):
    """3 N - 6 of them; a point of weight zero is none. It scales the covariance if estimated."""
    rng = np.random.default_rng(n)
    x, w = rng.normal(size=(n + 1, 3)), np.append(np.full(n, 4.0), 0.0)
    y = x + 0.1 * rng.normal(size=x.shape)
    found = covariance_of(RegistrationProblem(x, y, weights=w))
    given = covariance_of(RegistrationProblem(x[:n], y[:n], sigma=0.5))
    objective = Isotropic(exact_moments(RegistrationProblem(x, y, weights=w)))
    factor = float(objective.energy(objective.quaternions[0])) / (3 * n - 6)

    assert found.estimated
    assert not given.estimated
    assert found.variance_factor == given.variance_factor == pytest.approx(factor, rel=1e-15)
    assert found.matrix == pytest.approx(factor * given.matrix, rel=1e-12)


@pytest.mark.parametrize("least", [1e-30, 1e-9, 1e-3])
def test_points_that_hardly_count_are_no_degrees_of_freedom(least):
    """Three points carry the fit; a deviation from all degrees would be far too small."""
    rng = np.random.default_rng(5)
    x = rng.normal(size=(30, 3))
    y = x + 0.01 * rng.normal(size=(30, 3))
    weights = np.where(np.arange(30) < 3, 1.0, least)

    found = pose_covariance(*_stated(x, y, weights=weights))
    assert isinstance(found, Absent)
    assert "the weights differ so much" in found.reason
    given = pose_covariance(*_stated(x, y, sigma=0.01 / np.sqrt(weights)))
    assert not isinstance(given, Absent)
    halves = np.where(np.arange(30) < 15, 1.0, least)  # half of the points carry it
    assert not isinstance(pose_covariance(*_stated(x, y, weights=halves)), Absent)


def _stated(x, y, **weights):
    problem = RegistrationProblem(x, y, **weights)
    return problem, Isotropic(exact_moments(problem))


def test_springs_without_a_translation_have_the_translation_zero_and_no_doubt_of_it():
    rng = np.random.default_rng(1)
    X, N = rng.normal(size=(2, 12, 3))
    X[:, 0] += 40.0
    found = certify(
        X,
        X + 0.01 * rng.normal(size=X.shape),
        normals=N / np.linalg.norm(N, axis=1)[:, None],
        rotation_only=True,
        sigma=0.01,
    )

    assert found.covariance is not None
    assert found.covariance.second_order == 0.0
    told = found.to_dict()["pose"]["uncertainty"]
    assert told["translation"] == [0.0, 0.0, 0.0]
