"""The simulation ends at the optimum, provably; no other end is ever accepted for it."""

from __future__ import annotations

import copy
import dataclasses
import json
import math
from functools import cache
from typing import Any

import numpy as np
import pytest
from rotations import saddle_start
from strategies import AXES, ZOO, random_problem, random_rotation

from certreg.certificate.checking import check_own, verify
from certreg.certificate.isotropic import RotationState, produce, proves_basin
from certreg.dynamics import integrators
from certreg.dynamics.body import SimulationStatus
from certreg.dynamics.integrators import SimulationSettings
from certreg.dynamics.rigid import rigid_body
from certreg.dynamics.simulation import optimal_damping, simulate
from certreg.dynamics.states import state_at_rest
from certreg.equilibrium.critical_set import by_eigenspaces
from certreg.equilibrium.equilibrium_set import rotation_double, unit_double
from certreg.errors import ContradictionError, DegenerateProblemError, InvalidProblemError
from certreg.exact.dyadic import dyadic_below
from certreg.geometry.so3 import rotation_matrix
from certreg.native.engine import current_engine, evaluator
from certreg.native.loops import Integrator
from certreg.objective.isotropic import Isotropic
from certreg.problem.lifting import lift
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem
from certreg.registration.agreement import require_basin, require_sound_trajectory
from certreg.registration.certification import certify
from certreg.registration.examples import STORIES, tell
from certreg.registration.exit_codes import DONE
from certreg.registration.pipeline import Asked
from certreg.registration.simulation import final_state
from certreg.registration.squares import certified_squares
from certreg.report.document import result_document
from certreg.report.summary import registration_summary
from certreg.results import Optimality

STORY_NAMES = [story.name for story in STORIES]
each_story = pytest.mark.parametrize("name", STORY_NAMES)


@cache
def told(name) -> Any:
    return tell(STORIES[STORY_NAMES.index(name)])


def proved_end(problem, found, trajectory):
    """The certificate whose basin is where the trajectory ended; the checker has accepted it."""
    certificate = produce(problem, found, state=final_state(trajectory))
    assert certificate is not None
    assert check_own(certificate, problem).proved
    return certificate


def margin_of(registration):
    return registration.equilibria.margin.relative


def random_case(rng):
    n, noise = int(rng.integers(3, 51)), float(rng.uniform(0.0, 1.0))
    return random_problem(rng, n=n, noise=noise, decades=float(rng.uniform(0.0, 4.0)))


PROVED_END = (SimulationStatus.CONVERGED, True, True, True)  # in the basin of the optimum


def end_of(registration) -> tuple[object, ...]:
    """How the simulation ended; whether the basin is claimed, proved and named by a theorem."""
    verdict, claims = registration.verdict, registration.certificate.body.claims
    named = any("ends at the optimum" in theorem for theorem in verdict.theorems)
    return registration.solution.trajectory.status, claims.basin, verdict.proved, named


# Starts on saddles ------------------------------------------------------------------------------


@pytest.mark.parametrize("index", [1, 2, 3])
@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-9, 1e-6, 1e-3])
def test_a_start_at_or_beside_a_saddle_ends_at_the_optimum(index, angle):
    rng = np.random.default_rng(1000 + index)
    problem = random_problem(rng, n=20, noise=0.05)
    found = Isotropic(exact_moments(problem))
    axis = rng.normal(size=3)
    start = saddle_start(found, index, angle, axis / np.linalg.norm(axis))

    trajectory = simulate(found, problem.damping, start=start)

    assert trajectory.status is SimulationStatus.CONVERGED
    assert (trajectory.escapes >= 1) == (angle <= 1e-6)
    assert proved_end(problem, found, trajectory).body.claims.basin is True
    best = unit_double(found.quaternions[0])
    assert 1.0 - abs(trajectory.quaternion @ best) < 1e-6


@pytest.mark.parametrize("index", [1, 2, 3])
def test_a_body_left_on_a_saddle_of_exact_coordinates_is_perturbed_off_it(index):
    turns = {1: (1.0, -1.0, -1.0), 2: (-1.0, 1.0, -1.0), 3: (-1.0, -1.0, 1.0)}[index]
    problem = RegistrationProblem(AXES, AXES)  # d = 18, 8, 2: half-turns about x, y, z
    found = Isotropic(exact_moments(problem))
    start = np.array([*[0.0] * 3, *np.diag(turns).ravel(), *[0.0] * 6])

    trajectory = simulate(found, problem.damping, start=start)

    assert trajectory.status is SimulationStatus.CONVERGED
    assert trajectory.escapes >= 1
    assert np.allclose(trajectory.quaternion, [1, 0, 0, 0], atol=1e-3)
    assert proved_end(problem, found, trajectory).body.claims.basin is True


# The end is proved ------------------------------------------------------------------------------


@pytest.mark.slow
@each_story
def test_the_packaged_pairs_end_in_the_proved_basin(name):
    assert end_of(told(name)) == PROVED_END


@pytest.mark.slow
def test_random_problems_end_in_the_proved_basin():
    rng = np.random.default_rng(2027)
    for _ in range(30):
        registration = certify(random_case(rng), relaxation=False)
        assert margin_of(registration) >= 1e-6
        assert end_of(registration) == PROVED_END


@pytest.mark.slow
@pytest.mark.parametrize("count", [100, pytest.param(500, marks=pytest.mark.long)])
def test_five_hundred_random_problems_end_in_the_proved_basin(count: int):
    """As `certify` simulates and proves: this test would mostly spend on all that it says."""
    rng, proved = np.random.default_rng(2028), 0
    while proved < count:
        problem = random_case(rng)
        found = Isotropic(exact_moments(problem))
        best, second, *_, worst = [part.value for part in by_eigenspaces(found).components]
        if second - best < 1e-6 * (worst - best):
            continue
        problem = problem.damped(optimal_damping(found))
        trajectory = simulate(found, problem.damping, Integrator.SPLITTING)
        assert trajectory.status is SimulationStatus.CONVERGED
        assert proved_end(problem, found, trajectory).body.claims.basin is True
        proved += 1


@pytest.mark.slow
def test_a_nearly_ambiguous_problem_is_slow_but_ends_in_the_proved_basin():
    mirrored = np.array(AXES) * [1.0, 1.0, -math.sqrt(3.9)]  # d3 near -d2: a margin of 1/250
    source = np.array(AXES) * [1.0, 1.0, 2.0]
    problem = RegistrationProblem(source, mirrored @ random_rotation(np.random.default_rng(3)).T)

    assert end_of(certify(problem, relaxation=False)) == PROVED_END


@pytest.mark.parametrize("specimen", ZOO, ids=lambda specimen: specimen.name)
def test_no_basin_is_claimed_where_the_optimum_is_not_unique(specimen):
    problem = specimen.problem
    found = Isotropic(exact_moments(problem))
    try:
        trajectory = simulate(found, problem.damping)
    except DegenerateProblemError:
        assert not found.classification.inertia_definite
        return
    certificate = proved_end(problem, found, trajectory)
    unique = found.classification.unique

    assert trajectory.converged
    assert (trajectory.status is SimulationStatus.CONVERGED) == unique
    assert (certificate.body.claims.basin is True) == unique
    assert found.angle_to_optimum(lift(trajectory.quaternion).integers) < 1e-3


def test_too_few_steps_are_reported_and_claim_no_convergence():
    problem = random_problem(np.random.default_rng(5))
    found = Isotropic(exact_moments(problem))

    trajectory = simulate(found, problem.damping, settings=SimulationSettings(max_steps=10))

    assert trajectory.status is SimulationStatus.OUT_OF_STEPS
    assert not trajectory.converged


@pytest.mark.parametrize("machine", [current_engine, evaluator])
@pytest.mark.parametrize("integrator", list(Integrator))
@pytest.mark.parametrize(("share", "near"), [(0.99, True), (1.01, False)])
def test_a_slow_body_is_at_rest_within_the_angle_asked_for(
    monkeypatch, machine, integrator, share, near
):
    """Turned towards the lowest saddle, where the energy rises least: the angle is what counts."""
    monkeypatch.setattr(integrators, "current_engine", machine)
    found = Isotropic(exact_moments(random_problem(np.random.default_rng(5))))
    best, next_best, *_ = map(unit_double, found.eigenvectors)
    half = share * 0.01 / 2.0
    turn = rotation_matrix((math.cos(half) * best + math.sin(half) * next_best).tolist())
    limits = SimulationSettings(max_steps=0, speed_tolerance=1e3, rest_angle=0.01)
    start = state_at_rest(np.array(turn))

    assert simulate(found, 1.0, integrator, start=start, settings=limits).converged == near


@pytest.mark.parametrize("machine", [current_engine, evaluator])
@pytest.mark.parametrize("integrator", list(Integrator))
def test_a_body_perturbed_at_its_last_step_is_out_of_steps(monkeypatch, machine, integrator):
    monkeypatch.setattr(integrators, "current_engine", machine)
    found = Isotropic(exact_moments(random_problem(np.random.default_rng(5))))
    start, none = saddle_start(found, 1, 0.0, [1.0, 0.0, 0.0]), SimulationSettings(max_steps=0)
    trajectory = simulate(found, 2.8, integrator, start=start, settings=none)

    assert trajectory.status is SimulationStatus.OUT_OF_STEPS
    assert trajectory.escapes == 1


@pytest.mark.parametrize("machine", [current_engine, evaluator])
@pytest.mark.parametrize("integrator", list(Integrator))
def test_perturbations_do_not_grow_beyond_the_largest(monkeypatch, machine, integrator):
    """A whole turn leads back to the saddle, and ten times that again; one radian leads off it."""
    monkeypatch.setattr(integrators, "current_engine", machine)
    found = Isotropic(exact_moments(random_problem(np.random.default_rng(5))))
    start = saddle_start(found, 1, 0.0, [1.0, 0.0, 0.0])
    whole = SimulationSettings(max_steps=3, first_perturbation=2.0 * math.pi)
    trajectory = simulate(found, 2.8, integrator, start=start, settings=whole)

    assert trajectory.escapes == 2


@pytest.mark.parametrize(("share", "far"), [(0.2, True), (0.3, False), (3.0, False), (5.0, True)])
def test_a_damping_far_from_the_best_is_named_where_the_steps_ran_out(share, far):
    problem = random_problem(np.random.default_rng(5))
    found = Isotropic(exact_moments(problem))
    limits = SimulationSettings(max_steps=10)
    (note,) = simulate(found, share * optimal_damping(found), settings=limits).notes

    assert ("is far from the best one" in note) == far


@pytest.mark.parametrize(("share", "short"), [(0.09, True), (0.11, False), (0.9, False)])
def test_a_step_is_called_short_below_a_tenth_of_the_integrators_own(share, short):
    problem = random_problem(np.random.default_rng(5))
    found, few = Isotropic(exact_moments(problem)), SimulationSettings(max_steps=2)
    usual = simulate(found, problem.damping, Integrator.SPLITTING, settings=few).step
    given = dataclasses.replace(few, step=share * usual)
    (note,) = simulate(found, problem.damping, Integrator.SPLITTING, settings=given).notes

    assert ("is short: splitting itself takes" in note) == short


@pytest.mark.slow
def test_a_body_that_weak_springs_leave_far_away_contradicts_nothing():
    rng = np.random.default_rng(2)
    source = rng.normal(size=(12, 3))
    problem = RegistrationProblem(
        source, 1e-5 * source @ random_rotation(rng).T, damping=math.sqrt(8.0)
    )
    few = SimulationSettings(max_steps=1000)
    asked = Asked(simulation=Integrator.EULER, settings=few)
    registration: Any = certified_squares(problem, asked)
    words, document = registration_summary(registration), result_document(registration)

    assert registration.status is Optimality.CERTIFIED
    assert registration.solution.agreement.simulation > 0.1
    assert registration.solution.trajectory.status is SimulationStatus.OUT_OF_STEPS
    assert registration.exit_code == DONE  # the proof's: a cross-check is a note
    assert "NOT CONVERGED: The steps ran out" in words
    assert "The certificate does not depend on it" in words
    assert "is far from the best one" in words  # why
    assert document["simulation"]["converged"] is False
    assert document["optimality"]["status"] == "certified"


def test_the_damping_that_certify_takes_lets_weak_springs_arrive():
    rng = np.random.default_rng(2)
    source = rng.normal(size=(12, 3))
    problem = RegistrationProblem(source, 1e-5 * source @ random_rotation(rng).T)
    registration: Any = certify(problem, relaxation=False)
    trajectory = registration.solution.trajectory

    assert not problem.damping_given
    assert registration.problem.damping == optimal_damping(registration.solution.objective)
    assert trajectory.status is SimulationStatus.CONVERGED
    assert trajectory.integrator is Integrator.SPLITTING

    strong = RegistrationProblem(source, source @ random_rotation(rng).T).damped(1.0)
    given: Any = certify(strong, relaxation=False, simulation="midpoint")
    assert given.problem.damping == 1.0
    assert given.solution.trajectory.integrator is Integrator.MIDPOINT
    with pytest.raises(InvalidProblemError, match="leapfrog"):
        certify(problem, relaxation=False, simulation="leapfrog")


@pytest.mark.slow  # a million steps: minutes without a compiler
def test_a_million_roundings_are_no_contradiction():
    """Nearly a continuum of optima: explicit Euler hovers at the minimum."""
    source = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1.0]])
    target = source * [1, 1, -1]
    target[0, 0] += 1e-10
    problem = RegistrationProblem(source, target, damping=math.sqrt(8.0))
    registration: Any = certify(problem, relaxation=False, simulation="euler")

    assert registration.solution.trajectory.steps == SimulationSettings().max_steps


# What is refused --------------------------------------------------------------------------------


def level_of(registration):
    body, moments = registration.certificate.body, registration.solution.moments
    v = Isotropic(moments).alignment(body.quaternion)
    return v + body.delta.value - body.mu.value


def refused_states(registration):
    """States outside the basin by what is known of them; the last two are no states at all."""
    found = registration.solution.objective
    best = [int(entry) for entry in found.quaternions[0]]
    spurious = [list(found.quaternions[k]) for k in (1, 2, 3)]
    states = {f"equilibrium {k}": (q, [0, 0, 0, 0]) for k, q in enumerate(spurious, 1)}
    states["too fast"] = (best, [1, 1, 1, 10])
    states["zero"] = ([0, 0, 0, 0], [0, 0, 0, 0])
    return states


@pytest.mark.one_in(4)
@each_story
@pytest.mark.parametrize(
    "what", ["equilibrium 1", "equilibrium 2", "equilibrium 3", "too fast", "zero"]
)
def test_a_state_outside_the_basin_is_refused(name, what):
    registration = told(name)
    quaternion, velocity = refused_states(registration)[what]
    document = json.loads(registration.certificate.to_json())
    assert verify(json.dumps(document).encode()).proved

    document["basin"] = {"quaternion": quaternion, "angular_velocity": velocity}
    verdict = verify(json.dumps(document).encode())

    assert verdict.words == "claims.basin is not proved of the state in basin"
    if any(quaternion):
        state = RotationState.from_fields(document["basin"])
        assert not proves_basin(registration.solution.objective, state, level_of(registration))


def test_the_basin_ends_at_the_barrier_whether_turned_or_spun():
    """d = 18, 8, 2: l1 - l2 = 20; turned by a about z it loses 40 sin^2(a/2) at rest."""
    problem = RegistrationProblem(AXES, AXES)
    found = Isotropic(exact_moments(problem))
    values = [float(value) for value in found.eigenvalues]
    assert values == pytest.approx([28, 8, -12, -24])
    level = found.alignment((1, 0, 0, 0)) - 10  # the certificate's mu is half the gap
    inertia_x = 2 * (2**2 + 1**2)  # J_xx = sum of y^2 + z^2: spin energy / 2 = J w^2 / 4

    def inside(k, w):
        state = RotationState(quaternion=(1000, k, 0, 0), angular_velocity=(w, 0, 0, -20))
        return proves_basin(found, state, level)

    tangent = math.sqrt(10 / (20 - 10))  # (l1 - l2) sin^2 = 10
    assert inside(int(1000 * tangent) - 1, 0)
    assert not inside(int(1000 * tangent) + 1, 0)
    spin = 2**20 * math.sqrt(4 * 10 / inertia_x)
    assert inside(0, int(spin) - 1)
    assert not inside(0, int(spin) + 2)


def test_a_basin_is_refused_where_the_inertia_is_singular():
    line = next(s for s in ZOO if s.name == "collinear source").problem
    certificate = certify(line, relaxation=False).certificate
    assert certificate is not None
    document = json.loads(certificate.to_json())
    document["basin"] = {"quaternion": document["pose"], "angular_velocity": [0, 0, 0, 0]}
    assert verify(json.dumps(document).encode()).proved  # no claim yet

    document["claims"]["basin"] = True

    assert "claims.basin" in verify(json.dumps(document).encode()).words


def test_forged_bounds_of_the_relaxation_are_refused():
    registration = told("survey")
    honest = json.loads(registration.certificate.to_json())
    v = registration.solution.objective.alignment(registration.certificate.body.quaternion)
    below = dyadic_below(v, 64)

    def verdict(change):
        document = copy.deepcopy(honest)
        change(document)
        return verify(json.dumps(document).encode()).words

    def low_multiplier(document):
        document["sdp"]["nu"] = [below.mantissa, below.exponent]

    def low_gap(document):
        document["claims"]["sdp_gap"][0] -= 1

    assert verify(json.dumps(honest).encode()).proved
    assert verdict(low_multiplier) == "sdp.nu bounds nothing"
    assert "claims.sdp_gap is below" in verdict(low_gap)
    assert "claims.sdp_gap is below" in verdict(lambda document: document.update(sdp=None))


def test_planted_contradictions_are_raised():
    registration = told("survey")
    solution, body = registration.solution, registration.certificate.body
    found, trajectory = solution.objective, solution.trajectory
    require_sound_trajectory(found, body, trajectory)
    require_basin(body, trajectory)
    minimum = trajectory.potential.min()

    lower = trajectory.course.samples.copy()
    lower["energies"]["potential"][len(lower) // 2] = minimum * (1 - 1e-6) - 1e-9
    course = dataclasses.replace(trajectory.course, samples=lower)
    with pytest.raises(ContradictionError, match="below the certified minimum"):
        require_sound_trajectory(found, body, dataclasses.replace(trajectory, course=course))
    silent = dataclasses.replace(body, claims=dataclasses.replace(body.claims, basin=None))
    with pytest.raises(ContradictionError, match="basin could not be proved"):
        require_basin(silent, trajectory)


# Physics ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(5))
def test_the_energy_falls_but_for_what_an_explicit_step_adds(seed):
    """A step from rest adds h^2/2 (M |a|^2 + alpha^T J alpha): with |a|^2 M <= 4 V_p, all < h^2."""
    problem = random_problem(np.random.default_rng(seed), n=30, noise=0.1, offset=3.0)
    found = Isotropic(exact_moments(problem))
    trajectory = simulate(found, problem.damping)
    total = trajectory.potential + trajectory.kinetic
    rises = np.diff(total) / (total[0] - total[-1])

    assert total[-1] < total[0]
    assert rises[0] > 0.0  # from rest the explicit scheme must rise (the flow does not)
    assert rises.max() < 2.0 * trajectory.step**2
    assert (rises[5:-1] <= 1e-12).mean() > 0.9


def test_no_logged_potential_is_below_the_certified_minimum():
    for name in STORY_NAMES:
        registration = told(name)
        trajectory = registration.solution.trajectory
        unit = float(registration.solution.energy_unit)
        lowest = trajectory.potential.min() * unit

        assert lowest >= registration.objective * (1 - 1e-9)
        assert lowest <= registration.objective * 1.01


def pointwise_derivative(problem, damping, state):
    """Newton and Euler from the force on each point, lengths in the user's unit."""
    w, x, y = problem.weights, problem.source, problem.target
    mass = w.sum()
    arm, y_mean = x - w @ x / mass, w @ y / mass
    c, R, v, omega = state[:3], state[3:12].reshape(3, 3), state[12:15], state[15:]
    place = y_mean + c + arm @ R.T
    speed = v + np.cross(omega, arm) @ R.T
    force = w[:, None] * (2.0 * (y - place) - damping * speed)
    torque = np.cross(arm, force @ R).sum(axis=0)
    spin = (w[:, None] * np.cross(arm, np.cross(omega, arm))).sum(axis=0)
    J = sum(m * ((a @ a) * np.eye(3) - np.outer(a, a)) for m, a in zip(w, arm, strict=True))
    alpha = np.linalg.solve(J, torque - np.cross(omega, spin))
    cross = np.array([np.cross(omega, row) for row in np.eye(3)])  # rows e_k: [omega]^T
    return np.concatenate([v, (R @ cross.T).ravel(), force.sum(axis=0) / mass, alpha])


@pytest.mark.parametrize("seed", range(10))
def test_the_derivative_is_the_sum_of_the_forces_on_the_points(seed):
    rng = np.random.default_rng(seed)
    problem = random_problem(rng, n=9, noise=0.3, scale=float(10 ** rng.uniform(-3, 3)), decades=2)
    moving = rigid_body(exact_moments(problem), 1.7)
    R = random_rotation(rng)
    state = np.concatenate([rng.normal(size=3), R.ravel(), rng.normal(size=6)])
    unit = 2.0**moving.length_exponent
    lengths = np.array([unit] * 3 + [1.0] * 9 + [unit] * 3 + [1.0] * 3)

    expected = pointwise_derivative(problem, 1.7, state * lengths) / lengths
    found = moving.rate(state)

    assert np.abs(found - expected).max() < 1e-12 * max(1.0, np.abs(expected).max())


@pytest.mark.parametrize("seed", range(5))
def test_the_energies_are_the_sums_over_points_and_springs(seed):
    rng = np.random.default_rng(seed)
    problem = random_problem(rng, n=9, noise=0.3, scale=7.0)
    moving = rigid_body(exact_moments(problem), 1.0)
    R, c = random_rotation(rng), rng.normal(size=3)
    unit, w = 2.0**moving.length_exponent, problem.weights
    arm = problem.source - w @ problem.source / w.sum()
    rest = problem.target - w @ problem.target / w.sum() - arm @ R.T - c * unit

    expected = w @ (rest**2).sum(axis=1) / w.sum() / unit**2
    v, omega = rng.normal(size=(2, 3))
    found = moving.energies(np.array([*c, *R.ravel(), *v, *omega]))
    turning = w @ (np.cross(omega, arm) ** 2).sum(axis=1) / w.sum() / unit**2 / 2
    assert found["potential"] == pytest.approx(expected)
    assert found["translation"] == pytest.approx(v @ v / 2)
    assert found["rotation"] == pytest.approx(turning)
    assert moving.kinetic(found) == pytest.approx(v @ v / 2 + turning)
    assert found["alignment"] == pytest.approx((moving.spread + c @ c - expected) / 2)


@pytest.mark.parametrize("step", [1e-4, 0.01, 1.0, 30.0])
def test_the_projection_of_a_step_is_the_polar_factor(step):
    rng = np.random.default_rng(7)
    for _ in range(50):
        R, omega = random_rotation(rng), rng.normal(size=3)
        x, y, z = omega
        moved = R @ (np.eye(3) + step * np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]))
        left, _, right = np.linalg.svd(moved)
        state = np.array([*[0.0] * 3, *R.ravel(), *[0.0] * 3, *omega])

        following, _ = current_engine().evaluate(
            "certreg_euler_step", state, np.ones(23), np.array([step])
        )
        stepped = following[3:12].reshape(3, 3)

        assert np.abs(stepped - left @ right).max() < 1e-14


def test_a_trajectory_starts_where_the_source_was_given():
    problem = random_problem(np.random.default_rng(9), offset=10.0)
    trajectory = simulate(Isotropic(exact_moments(problem)), problem.damping)
    offset = problem.source.mean(axis=0) - problem.target.mean(axis=0)
    first = trajectory.states[0]

    assert trajectory.times[0] == 0.0
    assert trajectory.times[-1] == pytest.approx(trajectory.steps * trajectory.step)
    assert np.allclose(first[:3] * 2.0**trajectory.length_exponent, offset)
    assert np.array_equal(first[3:12], np.eye(3).ravel())
    assert not first[12:].any()
    assert np.allclose(
        trajectory.states[-1][3:12],
        rotation_double(Isotropic(exact_moments(problem)).quaternions[0]).ravel(),
        atol=1e-3,
    )
