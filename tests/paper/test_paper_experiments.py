"""The experiments of the paper: what they observe obeys laws, and other methods observe it, too."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from strategies import random_problem, random_rotation

from certreg.dynamics.states import state_at_rest
from certreg.geometry.so3 import quaternion_from_matrix
from certreg.paper.experiments import (
    STEP,
    angle,
    arccos_angle,
    descend,
    equilibrium_run,
    half_turn_error,
    sides,
    signs,
    simulation_run,
)
from certreg.paper.observations import (
    LANDMARKS,
    LINKS,
    SQUARE,
    TRIANGLE,
    coil,
    compare,
    exact_sums,
    gallery,
    projected,
    scene,
    turn,
    turned_over,
)
from certreg.paper.particles import Particles, hat, parts
from certreg.problem.problem import RegistrationProblem

each_polygon = pytest.mark.parametrize("polygon", [TRIANGLE, SQUARE], ids=lambda p: p.name)


def instance(seed: int = 0, *, damping: float = 2.0) -> RegistrationProblem:
    return random_problem(np.random.default_rng(seed)).damped(damping)


def random_state(rng) -> np.ndarray:
    c, v, omega = rng.normal(size=(3, 3))
    return np.concatenate([c, random_rotation(rng).ravel(), v, omega])


# the paper's equations, as sums over points


def test_hat_is_the_cross_product():
    a, b = np.random.default_rng(0).normal(size=(2, 5, 3))

    np.testing.assert_allclose(np.einsum("nij,nj->ni", hat(a), b), np.cross(a, b), atol=1e-15)


def test_the_force_and_the_torque_are_the_closed_forms_in_moments():
    particles = Particles.of(random_problem(np.random.default_rng(1), decades=3).damped(1.3))
    state = random_state(np.random.default_rng(2))
    c, R, v, omega = parts(state)
    C = np.einsum("n,ni,nj->ij", particles.masses, particles.target, particles.arms)
    A = R.T @ C - C.T @ R
    torque = 2 * np.array([A[2, 1], A[0, 2], A[1, 0]]) - 1.3 * particles.inertia @ omega
    force = -2 * particles.mass * c - 1.3 * particles.mass * v

    np.testing.assert_allclose(particles.force(state), force, rtol=1e-12)
    np.testing.assert_allclose(particles.torque(state), torque, rtol=1e-11)


def test_the_two_forms_of_the_kinetic_energy_agree_on_rotations():
    particles = Particles.of(instance())
    state = random_state(np.random.default_rng(3))
    _, _, v, omega = parts(state)

    whole = particles.mass * v @ v / 2 + omega @ particles.inertia @ omega / 2

    assert particles.energy(state) == pytest.approx(particles.potential(state) + whole, rel=1e-13)


def test_the_energy_rate_is_the_derivative_of_the_energy_along_the_motion():
    particles = Particles.of(instance())
    state = random_state(np.random.default_rng(4))
    h = 1e-6
    ahead, back = (particles.energy(state + s * h * particles.rate(state)) for s in (1, -1))

    assert particles.energy_rate(state) == pytest.approx((ahead - back) / (2 * h), rel=1e-7)


def test_comparisons_see_no_difference_between_certreg_and_the_paper():
    found = compare(instance(), np.random.default_rng(0), states=5)

    assert max(found.objective, found.rate, found.dissipation) < 1e-13


# equilibria and their eigenvalues


def test_the_eighteen_eigenvalues_are_the_twelve_and_six_zeros():
    for rest in equilibrium_run(instance()).poses:
        nonzero = rest.ambient[sides(rest.ambient) != 0]
        assert (len(rest.intrinsic), len(nonzero)) == (12, 12)
        for value in rest.intrinsic:
            assert np.abs(nonzero - value).min() < 1e-9


def test_the_eigenvalues_sum_to_the_trace_and_count_the_index():
    run = equilibrium_run(instance(damping=0.7))

    assert [signs(rest.intrinsic).right for rest in run.poses] == [0, 1, 2, 3]
    for rest in run.poses:
        assert rest.intrinsic.sum() == pytest.approx(-6 * 0.7, abs=1e-10)
        assert rest.ambient.sum() == pytest.approx(-6 * 0.7, abs=1e-10)


def test_signs_are_counted_and_what_rounding_made_of_zero_is_zero():
    found = signs(np.array([2.0, -1 + 3j, -1 - 3j, 1e-15, -1e-16, 1e-6]))

    assert (found.right, found.zero, found.left) == (2, 2, 2)


def test_a_cloud_with_a_continuum_of_equilibria_is_told():
    square = [[1.0, 1, 0], [1, -1, 0], [-1, -1, 0], [-1, 1, 0]]

    run = equilibrium_run(RegistrationProblem(square, square))

    assert (run.count, run.unique, len(run.poses)) == (None, True, 3)


@pytest.mark.parametrize("degrees", [0.0, 1e-9, 30.0, 90.0, 180.0 - 1e-9, 180.0])
def test_angles_are_right_from_zero_to_half_a_turn(degrees: float):
    half = math.radians(degrees) / 2
    p, q = np.array([1.0, 0, 0, 0]), np.array([math.cos(half), 0.0, math.sin(half), 0.0])

    assert angle(p, -q) == pytest.approx(degrees, rel=1e-12, abs=1e-20)
    assert half_turn_error(p, q) == pytest.approx(180.0 - degrees, rel=1e-5, abs=1e-14)


def test_the_papers_formula_loses_half_of_the_digits_near_half_a_turn():
    turned = np.diag([1.0, -1, -1])
    rounded = turned + 4e-16 * np.eye(3)  # in the last digits

    assert arccos_angle(np.eye(3), turned) == 180.0
    assert 1e-7 < abs(180.0 - arccos_angle(np.eye(3), rounded)) < 1e-5
    assert arccos_angle(1.0000000001 * np.eye(3), np.eye(3)) > 0.0  # outside [-1, 1]: complex


# the simulation


def projected_euler(problem: RegistrationProblem, step: float, stop: float) -> list[np.ndarray]:
    """The paper's scheme written down naively, the projection by singular values."""
    particles = Particles.of(problem)
    states = [particles.start]
    while np.linalg.norm(rate := particles.rate(states[-1])) >= stop:
        state = states[-1] + step * rate
        u, _, vt = np.linalg.svd(state[3:12].reshape(3, 3))
        state[3:12] = (u @ vt).ravel()
        states.append(state)
    return states


@pytest.mark.slow
def test_the_simulation_is_the_papers_scheme_step_by_step():
    problem = instance(5)
    particles = Particles.of(problem)

    states = projected_euler(problem, STEP, 1e-2)
    found = descend(problem, stop=1e-2)

    assert (found.steps, found.stopped) == (len(states) - 1, True)
    np.testing.assert_allclose(found.state, states[-1], atol=1e-11)
    np.testing.assert_allclose(found.potential, [particles.potential(s) for s in states], rtol=1e-9)
    energy = [particles.energy(s) for s in states]
    np.testing.assert_allclose(found.energy, energy, rtol=1e-9)
    np.testing.assert_allclose(found.times, STEP * np.arange(len(states)), rtol=1e-12)


def test_the_simulation_keeps_the_users_unit_of_length():
    problem = instance(6)
    finer = RegistrationProblem(problem.source * 1000, problem.target * 1000, damping=2.0)

    assert descend(finer).steps > descend(problem).steps


def test_a_simulation_out_of_steps_did_not_stop():
    assert not descend(instance(), max_steps=3).stopped


def test_the_first_rise_of_the_energy_is_the_one_told():
    problem = instance(7)

    run = simulation_run(problem, np.eye(3))

    assert run.first_rise == pytest.approx(run.predicted_rise, rel=1e-9)
    assert run.first_rise > 0.0 >= run.midpoint_rise
    assert run.rises >= 1


def test_the_simulation_and_the_closed_form_miss_the_truth_alike():
    rng = np.random.default_rng(8)
    source, R = rng.normal(size=(50, 3)), random_rotation(rng)
    problem = RegistrationProblem(source, source @ R.T + 0.01 * rng.normal(size=(50, 3)), damping=2)

    run = simulation_run(problem, R)

    assert run.stopped
    assert 0.0 < run.closed_form_error < 1.0
    assert run.distance < 0.1
    assert abs(run.error - run.closed_form_error) <= run.distance


# triangle and square


@each_polygon
def test_the_polygons_balance_exactly_at_every_angle(polygon):
    assert exact_sums(polygon) == (0, 0, 0, 0)


@each_polygon
def test_a_polygon_that_is_not_flipped_does_not_balance(polygon):
    plain = replace(polygon, flip=((1, 0), (0, 1)))

    assert exact_sums(plain)[2] != 0


@each_polygon
def test_a_polygon_with_a_corner_moved_does_not_balance(polygon):
    first, *others = polygon.corners
    moved = replace(polygon, corners=(((3, 0), (0, 0)), *others))

    assert first == ((2, 0), (0, 0))
    assert exact_sums(moved)[2] != 0


@each_polygon
def test_the_drawn_torques_are_those_of_the_springs_in_space(polygon):
    found = turn(polygon, 2.0, steps=24)
    corners = np.array(polygon.points(math.sqrt(3))) / 2
    cloud = np.column_stack([corners, np.zeros(len(corners))])

    np.testing.assert_allclose(np.linalg.norm(corners, axis=1), 1.0, rtol=1e-15)
    for theta, torques in zip(found.angles, found.torques, strict=True):
        moved = cloud @ turned_over(polygon, theta).T
        np.testing.assert_allclose(torques, np.cross(moved, 2 * (cloud - moved))[:, 2], atol=1e-14)
    assert np.abs(found.torques).max() > 1.9
    assert set(found.unstable) == {1}


@each_polygon
def test_turning_over_is_a_rotation_by_half_a_turn(polygon):
    R = turned_over(polygon, 0.7)

    np.testing.assert_allclose(R @ R, np.eye(3), atol=1e-15)
    assert np.linalg.det(R) == pytest.approx(1.0)


# pictures


def test_the_construction_shows_the_papers_start():
    shown = scene()

    assert len(shown.source) == len(shown.target) == 10
    assert {i for link in LINKS for i in link} == set(range(10))
    np.testing.assert_allclose(shown.centres[1], shown.target.mean(axis=0), atol=1e-15)
    np.testing.assert_allclose(shown.centres[0], shown.source.mean(axis=0), atol=1e-15)


def test_the_body_of_the_construction_is_the_scene_moved_but_for_noise():
    shown = scene()
    first, second = np.array(LINKS).T
    moved, fixed = (
        np.linalg.norm(cloud[first] - cloud[second], axis=1)
        for cloud in (shown.source, shown.target)
    )

    assert 0.0 < np.abs(moved - fixed).max() < 0.5


def test_a_coil_leads_from_its_start_to_its_end():
    start, end = np.array([1.0, 2.0]), np.array([4.0, -2.0])
    line = coil(start, end)
    along = (end - start) / 5.0

    np.testing.assert_allclose(line[[0, -1]], [start, end])
    assert (np.diff(line @ along) > 0).all()


def test_the_projection_is_orthographic():
    points = np.random.default_rng(0).normal(size=(6, 3))
    a, b = projected(np.eye(3)).T

    np.testing.assert_allclose([a @ a, b @ b, a @ b], [1, 1, 0], atol=1e-15)
    np.testing.assert_allclose(projected(points), points @ projected(np.eye(3)), atol=1e-15)


def test_the_gallery_has_the_four_equilibria_of_the_head():
    shown = gallery()
    best, *others = shown.poses

    assert [pose.index for pose in shown.poses] == [0, 1, 2, 3]
    for pose in shown.poses:
        rmse = math.sqrt(((pose.points - shown.target) ** 2).sum(axis=1).mean())
        assert pose.rmse == pytest.approx(rmse, rel=1e-9)
    for pose in others:
        assert pose.angle == pytest.approx(180.0, abs=1e-9)
        middles = best.points + pose.points  # of a half turn, all on its axis
        assert np.linalg.matrix_rank(middles, tol=1e-8) == 1


def test_the_landmarks_are_nose_and_ears():
    target = gallery().target
    left, right, nose = (target[LANDMARKS[n]] for n in ("left ear", "right ear", "nose"))

    assert left[0] < -50 < 50 < right[0]
    assert nose[1] > 50


def test_a_rotation_is_read_back_from_its_quaternion():
    R = random_rotation(np.random.default_rng(0))

    assert angle(quaternion_from_matrix(R), quaternion_from_matrix(np.eye(3))) == pytest.approx(
        arccos_angle(R, np.eye(3)), rel=1e-9
    )
    np.testing.assert_allclose(parts(state_at_rest(R))[1], R)
