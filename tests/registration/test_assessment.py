"""What is said of a pose is true of the pose as it was given."""

from __future__ import annotations

import math
import re
from fractions import Fraction

import numpy as np
import pytest
import strategies
from commands import checked
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import certreg
from certreg import RegistrationProblem, assess
from certreg.certificate.bounds import ExactPose, pose_energy
from certreg.errors import InvalidProblemError
from certreg.exact.dyadic import double_above
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.registration.rounding import rounding_cost
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
    with pytest.raises(InvalidProblemError, match=r"finite numbers|pose has shape \(2, 2\): give"):
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


def test_the_index_of_the_worst_rotation_is_three_where_a_circle_comes_before_it():
    """Of a square the components are one point, one circle, one point: the last is no fourth."""
    found = assess(
        RegistrationProblem(strategies.SQUARE, strategies.SQUARE), np.eye(4)[3], np.zeros(3)
    )

    assert found.nearest_index == 3
    assert found.headline.startswith("SPURIOUS-EQUILIBRIUM: 0 degrees from the index-3 ")


@pytest.mark.parametrize("weight", [1.0, 100.0])
def test_the_distance_of_the_centroids_is_a_length_whatever_the_weights(weight):
    cloud = np.vstack([np.diag([3.0, 2, 1]), -np.diag([3.0, 2, 1])])
    problem = RegistrationProblem(cloud, cloud, weights=np.full(6, weight))
    found = assess(problem, np.eye(3), np.array([0.3, 0.0, 0.4]))

    assert "and the centroids 0.5 apart" in found.words


AXIAL = np.vstack([np.diag([3.0, 2, 1]), -np.diag([3.0, 2, 1])])


def numbers(words: str, before: str) -> list[float]:
    """The numbers that stand before a word."""
    return [float(one) for one in re.findall(rf"([-+.\de]+) {before}", words)]


@pytest.mark.one_in(4)
@pytest.mark.parametrize("degrees", [0.0, 1e-4, 0.5, 3.0, 30.0, 89.0, 91.0, 150.0, 180.0])
@pytest.mark.parametrize("offset", [0.0, 1e9])
def test_every_angle_in_words_is_the_one_in_the_numbers(degrees: float, offset: float):
    """About x, the longest axis: the half turn is the index-1 equilibrium, nearest beyond 90."""
    problem = RegistrationProblem(AXIAL + offset, AXIAL + offset)
    c = np.full(3, offset)
    R = about_x(degrees)
    found = assess(problem, R, c - R @ c)
    away, near = (
        math.degrees(checked(one)) for one in (found.angle_to_optimum, found.nearest_angle)
    )
    said = numbers(found.words, "degrees")

    assert away == pytest.approx(degrees, abs=1e-6)
    assert near == pytest.approx(min(degrees, 180.0 - degrees), abs=1e-6)
    assert found.nearest_index == (degrees > 90.0)
    told = {
        PoseVerdict.OPTIMAL: [],
        PoseVerdict.NEAR_OPTIMAL: [away],
        PoseVerdict.SPURIOUS_EQUILIBRIUM: [away],
        PoseVerdict.NOT_AN_EQUILIBRIUM: [near, away] if degrees > 90.0 else [away],
    }[found.verdict]
    assert said == pytest.approx(told, rel=1e-3)
    if found.verdict is PoseVerdict.NOT_AN_EQUILIBRIUM:
        nearest = "has index 1, " if degrees > 90.0 else "is the optimum; "
        assert f"The nearest one {nearest}" in found.words
        assert "rounding of its numbers" not in found.words
        above = numbers(found.headline, "and") + numbers(found.headline, "above")
        assert above == pytest.approx([found.gap_lower, found.gap_upper], rel=1e-8)
    if found.verdict is PoseVerdict.NEAR_OPTIMAL:
        within = numbers(found.headline, "degrees")
        assert within == pytest.approx([math.degrees(checked(found.angle_upper))], rel=1e-2)
        assert within[0] >= math.degrees(checked(found.angle_upper)) >= away
    assert "only one" not in found.words


def test_a_gap_that_rounding_can_explain_is_told_so():
    """Doubles near 1e16 are 2 apart: no pose in doubles fits clouds of size 1 there."""
    problem = RegistrationProblem(AXIAL, AXIAL + 1e16)
    pose = certreg.certify(problem, relaxation=False, simulation=False).pose
    shift = pose.translation + np.array([np.spacing(1e16), 0.0, 0.0])
    found = assess(problem, pose.quaternion_wxyz, shift)

    assert found.verdict is PoseVerdict.NOT_AN_EQUILIBRIUM
    assert checked(found.gap_upper) <= checked(found.rounding_cost)
    assert "can cost that much: move the origin to the clouds." in found.words


def test_where_doubles_end_the_unit_is_to_be_changed_and_not_the_origin():
    rng = np.random.default_rng(3)
    source, target = (5e-324 * rng.normal(scale=3.0, size=(10, 3)) for _ in range(2))
    problem = RegistrationProblem(source, target)
    found = assess(problem, certreg.certify(problem, relaxation=False, simulation=False).pose)

    assert found.verdict is PoseVerdict.NOT_AN_EQUILIBRIUM
    words = "can cost that much: change the unit of length: no double is finer at this size."
    assert words in found.words


@pytest.mark.parametrize("form", ["rotation", "quaternion_wxyz"])
def test_rounding_is_that_of_the_optimal_pose_in_the_form_that_was_given(form: str):
    problem = strategies.random_problem(np.random.default_rng(5), n=6, noise=0.3, offset=10.0)
    registration = certreg.certify(problem, relaxation=False, simulation=False)
    objective, pose = registration.solution.objective, registration.pose
    given_turn = {"rotation": np.eye(3), "quaternion_wxyz": np.eye(4)[0]}[form]
    found = assess(problem, given_turn, np.array([1e3, 2e5, -3e7]))
    costs = {
        name: double_above(rounding_cost(objective, getattr(pose, name), pose.translation))
        for name in ("rotation", "quaternion_wxyz")
    }

    assert costs["rotation"] != costs["quaternion_wxyz"]
    assert found.rounding_cost == costs[form]


def test_of_many_optima_the_headline_names_no_angle():
    square = np.array([[1.0, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0], [0, 0, 3], [0, 0, -3]])
    line = np.outer([-1.0, 0.0, 1.0, 5.0], [0.0, 0.0, 1.0])
    problem = RegistrationProblem(np.vstack([square, line]), np.vstack([0 * square, line]))
    good = assess(problem, np.eye(3), np.zeros(3))
    near = assess(problem, about_x(0.1), np.zeros(3))

    assert good.angle_upper is near.angle_upper is None
    assert good.headline.startswith("OPTIMAL TO ROUNDING")
    assert near.headline.startswith("NEAR-OPTIMAL: at most ")
    assert "degrees" not in good.headline + near.headline
    assert "It is 0.1 degrees from the nearest optimum" in near.words
    assert all("The optimum is not the only one: " in one.words for one in (good, near))


def test_the_optimum_costs_no_more_than_a_pose_however_far_away_the_clouds_are():
    """In doubles the certified pose itself is rounded, by more than the residuals there."""
    problem = strategies.random_problem(np.random.default_rng(3), n=6, noise=0.1)
    problem = RegistrationProblem(problem.source, problem.target + 1e15)
    registration = certreg.certify(problem, relaxation=False, simulation=False)
    found = assess(registration, registration.pose)

    assert found.optimum_rmse is not None
    assert found.optimum_rmse < 0.99 * checked(found.rmse)


def test_no_angle_is_told_that_is_larger_than_the_one_proved():
    """The proof holds more bits than a computed angle, of the very optimum."""
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    found = assess(RegistrationProblem(AXIAL, AXIAL @ quarter.T), quarter, np.zeros(3))

    assert checked(found.angle_upper) >= checked(found.angle_to_optimum)
    assert found.nearest_angle == found.angle_to_optimum


def test_the_certified_pose_is_optimal_where_every_rotation_fits_equally():
    X = np.random.default_rng(0).normal(size=(8, 3))
    alike = np.tile([1.0, 0.0, 0.0, 1.0, 0.0, 1.0], (8, 1))
    found = certreg.certify(X, np.tile([0.1, 0.2, 0.3], (8, 1)), information=alike)

    assert assess(found, found.pose).verdict is PoseVerdict.OPTIMAL


def test_the_certified_pose_is_optimal_where_the_best_scale_is_zero():
    found = certreg.certify(np.eye(3), np.ones((3, 3)), scale="asymmetric")

    assert found.pose.scale == 0.0
    assert assess(found, found.pose).verdict is PoseVerdict.OPTIMAL
