"""What `certify` and `assess` give for general springs, held against independent computations."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from commands import checked
from numpy.typing import NDArray
from spring_families import lidar, line, mixed, plane, statement

import certreg
from certreg.equilibrium.equilibrium_set import unit_double
from certreg.equilibrium.paths import critical_lines
from certreg.errors import InvalidProblemError
from certreg.problem.factors import lower_triangles
from certreg.problem.problem import RegistrationProblem
from certreg.registration.assessment import assess
from certreg.registration.certification import certify
from certreg.registration.curvature import slope_and_curvature
from certreg.registration.simulation import optimally_damped
from certreg.registration.spring_rows import SpringAxes
from certreg.relaxation.refining import refined
from certreg.results import PoseVerdict

Array = NDArray[np.float64]

FAMILIES = {"plane": plane, "line": line, "mixed": mixed, "lidar": lidar}


def problem_of(family: str, n: int = 20, s: float = 0.05, **more: Any) -> RegistrationProblem:
    given = FAMILIES[family](np.random.default_rng(7), n, s)
    return RegistrationProblem(given.source, given.target, **given.springs, **more)


@cache
def registered(family: str, **more: Any) -> Any:
    return certify(problem_of(family, **more))


def energy(problem: RegistrationProblem, rotation: Array, translation: Array) -> float:
    """The objective, by the definition."""
    block = problem.block(slice(None))
    residuals = block.target - block.source @ rotation.T - translation
    springs = np.einsum("kij,klj->kil", *[lower_triangles(block.springs)] * 2)
    return float(np.einsum("ki,kij,kj->", residuals, springs, residuals))


def turned(rotation: Array, turn: Array) -> Array:
    """R exp([turn])."""
    angle = float(np.linalg.norm(turn))
    x, y, z = turn
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    near = np.eye(3) + cross + cross @ cross / 2
    if angle < 1e-6:
        return rotation @ near
    sine, rest = np.sin(angle) / angle, (1 - np.cos(angle)) / angle**2
    return rotation @ (np.eye(3) + sine * cross + rest * cross @ cross)


@pytest.mark.parametrize("family", FAMILIES)
def test_the_pose_of_each_family_is_certified_and_no_small_move_lowers_its_objective(family: str):
    found = registered(family)
    rng = np.random.default_rng(0)

    assert found.exit_code == 0
    assert found.unique
    here = energy(found.problem, found.pose.rotation, found.pose.translation)
    assert here == pytest.approx(found.objective, rel=1e-9)
    for move in rng.standard_normal((40, 6)) * 1e-3:
        there = turned(found.pose.rotation, move[3:]), found.pose.translation + move[:3]
        assert energy(found.problem, *there) >= here


@pytest.mark.parametrize("family", FAMILIES)
def test_half_the_hessian_is_that_of_finite_differences(family: str):
    found = registered(family)
    pose, solution, h = found.pose, found.solution, 1e-4
    half, centre = solution.near.half_hessian(solution.centre), np.array(solution.centre, float)
    image = pose.rotation @ centre + pose.translation

    def at(move: Array) -> float:
        rotation = turned(pose.rotation, move[3:])
        return energy(found.problem, rotation, image + move[:3] - rotation @ centre)

    steps = h * np.eye(6)
    measured = [
        [(at(a + b) - at(a - b) - at(b - a) + at(-a - b)) / (8 * h * h) for b in steps]
        for a in steps
    ]
    assert np.abs(np.array(measured) - half).max() <= 1e-5 * np.abs(half).max()


@pytest.mark.slow
def test_the_covariance_is_that_of_many_draws_of_the_noise():
    """Planes of N = 30, s = 0.01: each draw is solved by five steps of Gauss and Newton."""
    rng, s = np.random.default_rng(3), 0.01
    given = plane(rng, 30, 0.0)
    normals, x = given.springs["normals"], given.source
    draws: list[Array] = []
    for _ in range(600):
        y = given.target + s * rng.standard_normal(x.shape)
        rotation, shift = given.rotation, given.translation
        for _ in range(3):
            rows = np.hstack([normals, np.cross(x, normals @ rotation)])
            off = np.einsum("ki,ki->k", normals, y - x @ rotation.T - shift)
            move = np.linalg.lstsq(rows, off, rcond=None)[0]
            rotation, shift = turned(rotation, move[3:]), shift + move[:3]
        apart = given.rotation.T @ rotation
        turn = [apart[2, 1] - apart[1, 2], apart[0, 2] - apart[2, 0], apart[1, 0] - apart[0, 1]]
        draws.append(np.array([*(shift - given.translation), *(np.array(turn) / 2)]))
    measured = np.cov(np.array(draws).T)

    told = certify(RegistrationProblem(x, given.target, normals=normals, sigma=s)).covariance
    assert told is not None
    assert told.matrix is not None
    scale = np.sqrt(np.diag(told.matrix))
    assert np.abs((measured - told.matrix) / scale / scale[:, None]).max() <= 0.2
    assert np.diag(measured) == pytest.approx(np.diag(told.matrix), rel=0.2)


def test_springs_alike_in_every_way_give_the_numbers_of_the_road_of_one_weight():
    given = plane(np.random.default_rng(5), 12, 0.05)
    points = np.tile([1.0, 0.0, 1.0, 0.0, 0.0, 1.0], (12, 1))
    springs = certify(RegistrationProblem(given.source, given.target, factors=points, sigma=0.1))
    alike = certify(RegistrationProblem(given.source, given.target, sigma=0.1), simulation=False)

    assert springs.pose.rotation == pytest.approx(alike.pose.rotation, abs=1e-14)
    assert springs.rmse == pytest.approx(alike.rmse, rel=1e-12)
    assert springs.residuals == pytest.approx(alike.residuals, rel=1e-12)
    assert springs.covariance is not None
    assert alike.covariance is not None
    assert np.array(springs.covariance) == pytest.approx(np.array(alike.covariance), rel=1e-6)
    assert checked(springs.fit.chi2).dof == checked(alike.fit.chi2).dof
    assert springs.degrees_of_freedom == alike.degrees_of_freedom


def test_residuals_of_planes_and_lines_are_the_distances_to_them():
    for family in ("plane", "line"):
        found = registered(family)
        block = found.problem.block(slice(None))
        moved = found.pose.apply(block.source)
        nearest = SpringAxes.of(block.springs).pulled_to(moved, block.target)

        assert found.residuals == pytest.approx(np.linalg.norm(moved - nearest, axis=1), abs=1e-12)
        assert found.rmse == pytest.approx(np.sqrt(np.mean(found.residuals**2)))


@pytest.mark.parametrize("size", [1e-100, 1e100])
def test_normals_of_any_length_leave_the_noise_that_the_residuals_tell(size: float):
    given = plane(np.random.default_rng(7), 20, 0.05)
    clouds, normals = (given.source, given.target), given.springs["normals"]
    one, other = (certify(*clouds, normals=times * normals) for times in (1.0, size))

    assert one.covariance is not None
    assert other.covariance is not None
    assert other.covariance.rotation_sigma == pytest.approx(one.covariance.rotation_sigma)


def test_more_noise_than_was_given_is_warned_of_and_less_is_not():
    assert registered("plane", sigma=0.05).fit.warnings == ()
    warned = registered("plane", sigma=0.001)
    assert [code.value for code in warned.fit.codes] == ["chi2"]
    assert str(warned).startswith("CERTIFIED OPTIMUM, BUT THE FIT IS POOR: the residuals are ")
    assert warned.exit_code == 0


def test_a_certified_pose_is_judged_optimal_and_another_by_its_proved_distance():
    found = registered("plane", sigma=0.05)
    own = assess(found, found.pose)
    off = turned(found.pose.rotation, np.array([0.0, 0.3, 0.0]))
    other = assess(found, (off, found.pose.translation))

    assert own.verdict is PoseVerdict.OPTIMAL
    assert own.green
    assert other.verdict is PoseVerdict.NOT_AN_EQUILIBRIUM
    assert other.angle_to_optimum == pytest.approx(0.3, abs=1e-12)
    assert other.gap_lower is not None
    above = energy(found.problem, off, found.pose.translation) - found.objective
    assert other.gap_lower == pytest.approx(above, rel=1e-6)
    assert other.angle_upper is not None
    assert 0.3 <= other.angle_upper <= 0.3001


@pytest.mark.slow
def test_a_stable_wrong_pose_is_named_as_what_a_local_method_stops_at():
    given = plane(np.random.default_rng(3), 7, 0.3)
    found: Any = certify(RegistrationProblem(**statement(given)))
    levelled, objective = found.solution.found.levelled, found.solution.objective
    lines = [refined(levelled, q) for q in critical_lines(levelled.rest).points.real]
    shapes = [(q, *slope_and_curvature(objective, q)) for q in lines]
    real = [(q, curved) for q, slope, curved in shapes if np.abs(slope).max() < 1e-12]
    ends = [q for q, _ in real]
    index = [int((np.linalg.eigvalsh(curved) < 0).sum()) for _, curved in real]
    judged = [assess(found, unit_double(q)) for q in ends]

    assert index.count(0) == 3
    assert [one.nearest_index for one in judged] == index
    others = [one for one in judged if one.verdict is PoseVerdict.SPURIOUS_EQUILIBRIUM]
    assert len(others) == len(ends) - 1
    words = "a stable equilibrium, at which a local method stops, and not the optimum"
    assert sum(words in one.headline for one in others) == index.count(0) - 1


def test_a_reflection_is_no_rotation_whatever_the_springs_are():
    judged = assess(registered("plane"), (-np.eye(3), np.zeros(3)))
    assert judged.verdict is PoseVerdict.NOT_A_ROTATION


def test_a_scale_that_a_pose_has_apart_is_judged_whatever_the_springs_are():
    problem = problem_of("plane")
    pose = certify(problem).pose
    given = pose.rotation, pose.translation

    assert assess(problem, (*given, 1.0)).verdict is assess(problem, given).verdict
    judged = assess(problem, (*given, 1.5))
    assert judged.verdict is PoseVerdict.NOT_A_ROTATION
    assert "scales by 1.5" in judged.headline


def test_what_is_for_one_weight_per_pair_alone_says_so_in_one_line():
    with pytest.raises(InvalidProblemError, match="optimal damping is computed for") as caught:
        optimally_damped(problem_of("plane"))
    assert "\n" not in str(caught.value)
    assert registered("plane").equilibria is None
    assert registered("plane").trajectory is None


def test_a_registration_on_springs_is_short_and_shows_itself():
    found = registered("plane")

    assert repr(found).startswith("<Registration: certified; n=20, rmse=")
    assert len(repr(found)) <= 200
    assert found.summary() == str(found)
    assert "CERTIFIED" in found._repr_html_()
    assert certreg.verify(found.certificate, found.problem).proved
