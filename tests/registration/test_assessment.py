"""What is said of a pose is true of the pose as it was given."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
import strategies
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import certreg
from certreg import RegistrationProblem, assess
from certreg.certificate.bounds import ExactPose, pose_energy
from certreg.errors import InvalidProblemError
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.results import PoseVerdict

ROD = [[-1.0, 0, 0], [0, 1e-6, 0], [1, 0, 0], [0.5, 0, 1e-6]]


def about_x(degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


@pytest.mark.parametrize("degrees", [1.0, 30.0, 90.0, 179.0, 180.0])
def test_a_turned_rod_is_not_optimal_however_little_is_at_stake(degrees):
    problem = RegistrationProblem(ROD, ROD)
    centroid = np.mean(ROD, axis=0)
    R = about_x(degrees)
    found = assess(problem, R, centroid - R @ centroid)

    assert found.verdict is not PoseVerdict.OPTIMAL
    assert degrees < 5 or found.verdict is not PoseVerdict.NEAR_OPTIMAL
    if degrees == 180.0:
        assert found.verdict is PoseVerdict.SPURIOUS_EQUILIBRIUM
        assert found.nearest_index == 1


@pytest.mark.parametrize("offset", [0.0, 1e8])
def test_bounds_on_a_given_quaternion_are_those_of_exactly_that_pose(offset):
    problem = strategies.random_problem(np.random.default_rng(1), n=10, offset=offset)
    registration = certreg.certify(problem, relaxation=False, simulation=False)
    pose, bounds = registration.pose, registration.bounds
    assert bounds is not None

    found = assess(problem, pose.quaternion_wxyz, pose.translation)

    assert (found.gap_lower, found.gap_upper) == (bounds.gap_lower, bounds.gap_upper)
    assert found.objective == registration.objective
    assert found.verdict is PoseVerdict.OPTIMAL


def test_the_energy_of_a_pose_is_that_of_its_definition_point_by_point():
    problem = strategies.random_problem(np.random.default_rng(2), n=6, offset=1e6)
    q, t = np.array([0.5, -0.5, 0.5, 0.5]), np.array([1.0, 2.0, 3.0])
    R = [[0, -1, 0], [0, 0, 1], [-1, 0, 0]]  # of that quaternion, exactly
    exact = Fraction(0)
    for x, y, w in zip(
        problem.source.tolist(), problem.target.tolist(), problem.weights.tolist(), strict=True
    ):
        for row, a, shift in zip(R, y, t.tolist(), strict=True):
            moved = sum(r * Fraction(b) for r, b in zip(row, x, strict=True)) + Fraction(shift)
            exact += Fraction(w) * (Fraction(a) - moved) ** 2

    assert pose_energy(Isotropic(exact_moments(problem)), ExactPose.of_doubles(q, t)) == exact


@pytest.mark.parametrize("digits", [5, 7, 9])
def test_a_matrix_with_few_digits_is_judged_about_the_centroid_and_says_so(digits):
    problem = strategies.random_problem(np.random.default_rng(3), n=10, offset=1e6)
    pose = certreg.certify(problem, relaxation=False, simulation=False).pose
    R = np.round(pose.rotation, digits)
    t = problem.target.mean(axis=0) - R @ problem.source.mean(axis=0)

    found = assess(problem, R, t)

    assert found.verdict in {PoseVerdict.OPTIMAL, PoseVerdict.NEAR_OPTIMAL}
    assert "judged as the nearest one" in found.words
    assert "judged" not in assess(problem, pose.rotation, pose.translation).words


@pytest.mark.slow
@given(st.floats(-6, 0.4), st.integers(0, 2**32 - 1))
def test_the_gap_of_any_pose_lies_within_its_bounds(exponent, seed):
    rng = np.random.default_rng(seed)
    problem = strategies.random_problem(rng, n=5, noise=0.3)
    registration = certreg.certify(problem, relaxation=False, simulation=False)
    q = registration.pose.quaternion_wxyz + 10.0**exponent * rng.normal(size=4)
    q /= np.linalg.norm(q)
    t = registration.pose.translation + 10.0**exponent * rng.normal(size=3)
    found = assess(problem, q, t)
    moments, certificate = registration.solution.moments, registration.certificate
    assert certificate is not None
    energy = pose_energy(Isotropic(moments), ExactPose.of_doubles(q, t))
    least = pose_energy(
        Isotropic(moments),
        ExactPose(
            quaternion=certificate.body.quaternion,
            translation=certreg_translation(moments, certificate.body.quaternion),
        ),
    )

    assert found.gap_lower is not None
    assert found.gap_upper is not None
    assert Fraction(found.gap_lower) <= energy - least <= Fraction(found.gap_upper)


def certreg_translation(moments, q):
    return Isotropic(moments).best_translation(q)


def test_own_pose_is_optimal_where_energies_exceed_the_doubles():
    source = np.array(strategies.BENT) * 1e100
    problem = RegistrationProblem(source, source @ about_x(30).T, sigma=1e-120)
    pose = certreg.certify(problem, relaxation=False, simulation=False).pose

    found = assess(problem, pose.quaternion_wxyz, pose.translation)
    assert found.verdict is PoseVerdict.OPTIMAL


def test_nothing_is_called_unstable_where_the_dynamics_is_undefined():
    line = [[-1.0, 0, 0], [0, 0, 0], [1, 0, 0]]
    found = assess(RegistrationProblem(line, line), np.diag([-1.0, -1, 1]), np.zeros(3))

    assert found.verdict is PoseVerdict.SPURIOUS_EQUILIBRIUM
    assert "the energy falls in 2 directions" in found.words
    assert "unstable" not in found.words


@pytest.mark.parametrize(
    ("matrix", "words"),
    [
        (np.diag([1.0, 1, -1]), "reflection"),
        (1.001 * np.eye(3), "scales by 1.001"),
        (-2.0 * np.eye(3), "scales by 2 and reflects"),
        (np.zeros((3, 3)), "not orthogonal"),
        (np.array([[1.0, 0.1, 0], [0, 1, 0], [0, 0, 1]]), "not orthogonal"),
        (np.array([2.0, 0, 0, 0]), "norm 2"),
        (np.array([0.5, 0, 0, 0]), "norm 0.5"),
    ],
)
def test_what_is_no_rotation_is_told_why(matrix, words):
    found = assess(RegistrationProblem(ROD, ROD), matrix, np.zeros(3))

    assert found.verdict is PoseVerdict.NOT_A_ROTATION
    assert words in found.words
    assert found.gap_upper is None


@pytest.mark.parametrize(
    ("rotation", "translation"),
    [(np.eye(2), np.zeros(3)), (np.eye(3), np.zeros(2)), (np.full((3, 3), np.nan), np.zeros(3))],
)
def test_arrays_of_other_shapes_are_refused(rotation, translation):
    with pytest.raises(InvalidProblemError, match="finite numbers"):
        assess(RegistrationProblem(ROD, ROD), rotation, translation)


def at_saddle(factor: float) -> tuple[RegistrationProblem, np.ndarray, np.ndarray]:
    """The index-1 rotation, and a translation that costs `factor` times the range of energies."""
    problem = strategies.random_problem(np.random.default_rng(3), n=12, noise=0.1)
    objective = Isotropic(exact_moments(problem))
    first, second, *_, last = map(float, objective.eigenvalues)
    q = np.array(objective.eigenvectors[1], dtype=float)
    q /= np.linalg.norm(q)
    R = Rotation.from_quat(q, scalar_first=True).as_matrix()
    mass = problem.weights.sum()
    x, y = problem.weights @ problem.source / mass, problem.weights @ problem.target / mass
    length = math.sqrt(2 * (first - last) / mass * factor)
    assert second < first
    return problem, q, y - R @ x + length * np.array([0.6, 0.0, 0.8])


@pytest.mark.parametrize(
    ("factor", "verdict"),
    [
        (0.99e-6, PoseVerdict.SPURIOUS_EQUILIBRIUM),
        (1.01e-6, PoseVerdict.NOT_AN_EQUILIBRIUM),
        (1e-4, PoseVerdict.NOT_AN_EQUILIBRIUM),
    ],
)
def test_an_equilibrium_may_be_shifted_by_a_thousandth_of_the_clouds_size(factor, verdict):
    """Energies are squares of lengths: 1e-3 of the size costs 1e-6 of the range."""
    assert assess(*at_saddle(factor)).verdict is verdict
    assert certreg.AssessmentSettings().equilibrium_shift == 1e-3


@pytest.mark.parametrize(("factor", "said"), [(0.98e-18, False), (1.02e-18, True), (1e-10, True)])
def test_centroids_apart_are_told_from_a_billionth_of_the_clouds_size_on(factor, said):
    problem, q, t = at_saddle(factor)
    turned = q + 1e-2 * np.array([-q[1], q[0], q[3], -q[2]])
    R, S = (Rotation.from_quat(r, scalar_first=True).as_matrix() for r in (q, turned))
    x = problem.weights @ problem.source / problem.weights.sum()
    found = assess(problem, turned / np.linalg.norm(turned), t + (R - S) @ x)

    assert found.verdict is PoseVerdict.NOT_AN_EQUILIBRIUM
    assert ("and the centroids" in found.words) == said


@pytest.mark.parametrize("index", [1, 2, 3])
def test_a_spurious_equilibrium_is_as_far_from_the_optimum_as_it_is_and_one_is_the_worst(index):
    """C = diag(18, 8, 2): half turns about the axes, the longest first, rise in energy."""
    cloud = np.vstack([np.diag([3.0, 2, 1]), -np.diag([3.0, 2, 1])])
    found = assess(RegistrationProblem(cloud, cloud), np.eye(4)[index], np.zeros(3))

    assert found.nearest_index == index
    assert found.headline.startswith(f"SPURIOUS-EQUILIBRIUM: 0 degrees from the index-{index} ")
    assert ("the worst rotation there is" in found.headline) == (index == 3)
    assert found.words.endswith("and the pose is 180 degrees from the global optimum.")


@pytest.mark.parametrize("weight", [1.0, 100.0])
def test_the_distance_of_the_centroids_is_a_length_whatever_the_weights(weight):
    cloud = np.vstack([np.diag([3.0, 2, 1]), -np.diag([3.0, 2, 1])])
    problem = RegistrationProblem(cloud, cloud, weights=np.full(6, weight))
    found = assess(problem, np.eye(3), np.array([0.3, 0.0, 0.4]))

    assert "and the centroids 0.5 apart" in found.words
