"""What each integrator promises: the paper's steps, an energy that never rises, the optimum."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from commands import certreg
from strategies import AXES, random_problem, random_rotation
from sympy import Matrix, Rational
from test_simulation import proved_end

from certreg.dynamics import integrators
from certreg.dynamics.batch import Bodies, Ends, bodies_of, simulate_many
from certreg.dynamics.body import SimulationStatus, basins_of, certified_basin
from certreg.dynamics.integrators import SimulationSettings, _halved, spring_ratios, step_parameters
from certreg.dynamics.rigid import rigid_body
from certreg.dynamics.simulation import optimal_damping, simulate
from certreg.errors import DegenerateProblemError, InvalidProblemError
from certreg.geometry.so3 import rotation_matrix
from certreg.native.engine import current_engine
from certreg.native.layout import (
    BASIN,
    BODY,
    MATRIX_STATE,
    QUATERNION_STATE,
    SPLITTING_STEP,
    STEP,
    plain,
    symmetric,
)
from certreg.native.library import Library
from certreg.native.loops import LARGEST_TURN, Batch, Ending, Integrator
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem
from certreg.registration.closed_form import register

COMPILED = isinstance(current_engine(), Library)
# instances; without a compiler each takes a millisecond
MANY, FEW, STEPS = (4_000, 83, 20_000) if COMPILED else (1_000, 11, 1_000)
ALL = 25 * MANY
of_many = pytest.mark.slow if COMPILED else pytest.mark.quick  # whoever asks first waits
EPSILON = 2.0**-52
each_integrator = pytest.mark.parametrize("integrator", Integrator)


@dataclass(frozen=True)
class Clouds:
    sources: Any
    targets: Any


def random_clouds(rng, count: int, n: int) -> Clouds:
    """Pairs of n points, any rotation; noise 0.01 to 1, target scaled 0.1 to 20."""
    x = rng.normal(size=(count, n, 3))
    noise = 10.0 ** rng.uniform(-2.0, 0.0, size=(count, 1, 1))
    scale = 0.1 * 200.0 ** rng.uniform(size=(count, 1, 1))
    turned = x @ rotations(random_quaternions(rng, count)).mT
    y = scale * (turned + noise * rng.normal(size=x.shape)) + rng.normal(size=(count, 1, 3))
    return Clouds(x, y)


def random_quaternions(rng, count: int) -> Any:
    q = rng.normal(size=(count, 4))
    return q / np.linalg.norm(q, axis=1, keepdims=True)


def rotations(q) -> Any:
    return np.moveaxis(np.array(rotation_matrix(list(q.T))), -1, 0)


def best_rotations(clouds: Clouds) -> Any:
    """The optima by singular values [Umeyama1991], a method that shares nothing with certreg's."""
    x = clouds.sources - clouds.sources.mean(axis=1, keepdims=True)
    y = clouds.targets - clouds.targets.mean(axis=1, keepdims=True)
    left, _, right = np.linalg.svd(y.mT @ x)
    signs = np.ones((len(x), 1, 3))
    signs[:, 0, 2] = np.sign(np.linalg.det(left @ right))
    return (left * signs) @ right


def angles(one, other) -> Any:
    chord = np.linalg.norm(one - other, axis=(1, 2)) / np.sqrt(8.0)
    return 2.0 * np.arcsin(np.minimum(chord, 1.0))


# Euler -------------------------------------------------------------------------------------------


def papers_loop(problem: RegistrationProblem, unit: float, step: float, tolerance: float) -> Any:
    """The scheme of [Yang2020]: forces on the points, inertia, nearest rotation."""
    w = problem.weights
    mass = w.sum()
    x = (problem.source - w @ problem.source / mass) / unit
    y = (problem.target - w @ problem.target / mass) / unit
    J = sum(m * ((a @ a) * np.eye(3) - np.outer(a, a)) for m, a in zip(w, x, strict=True))
    c = (w @ problem.source - w @ problem.target) / mass / unit
    R, v, omega, steps = np.eye(3), np.zeros(3), np.zeros(3), 0
    while True:
        place, speed = x @ R.T + c, np.cross(omega, x) @ R.T + v
        force = w[:, None] * (2.0 * (y - place) - problem.damping * speed)
        torque = np.cross(x, force @ R).sum(axis=0)
        a = force.sum(axis=0) / mass
        alpha = np.linalg.solve(J, torque - np.cross(omega, J @ omega))
        turning = R @ np.cross(omega, np.eye(3)).T
        if np.sqrt(v @ v + (turning**2).sum() + a @ a + alpha @ alpha) < tolerance:
            return steps, np.concatenate([c, R.ravel(), v, omega])
        left, _, right = np.linalg.svd(R + step * turning)
        c, R, v, omega = c + step * v, left @ right, v + step * a, omega + step * alpha
        steps += 1


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize("seed", range(3))
def test_euler_is_the_loop_of_the_paper(seed):
    problem = random_problem(np.random.default_rng(seed), n=8, noise=0.2)
    trajectory = simulate(Isotropic(exact_moments(problem)), problem.damping)
    unit = 2.0**trajectory.length_exponent

    steps, state = papers_loop(problem, unit, 0.01, 1e-4)

    assert trajectory.step == 0.01
    assert trajectory.steps == steps
    assert np.abs(trajectory.states[-1] - state).max() < 1e-11


# Midpoint ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Energies:
    """Of states (count,), and `size`, the sum of the sizes of the terms."""

    total: Any
    size: Any


def spins(bodies, omega) -> Any:
    """omega^T J omega."""
    return np.einsum("ni,nij,nj->n", omega, symmetric(bodies["inertia"]), omega)


def energies(bodies, states) -> Energies:
    aligned = np.einsum("nij,nij->n", rotations(states["q"]), bodies["cross"])
    kinetic = ((states["v"] ** 2).sum(axis=1) + spins(bodies, states["omega"])) / 2
    lengths = (states["c"] ** 2).sum(axis=1) + bodies["spread"]
    return Energies(kinetic + lengths - 2 * aligned, kinetic + lengths + 2 * np.abs(aligned))


@pytest.fixture(scope="module")
def midpoint_steps() -> tuple[Batch, Any]:
    """One step from each of many random states: |omega| to 100, h to 5, mu 1e-9 to 100."""
    count, rng = STEPS, np.random.default_rng(31)
    clouds = random_clouds(rng, count, 6)
    bodies = bodies_of(clouds.sources, clouds.targets)
    bodies.records["damping"] = 10.0 ** rng.uniform(-9.0, 2.0, size=count)
    states = np.zeros(count, dtype=QUATERNION_STATE)
    states["c"], states["q"] = rng.normal(size=(count, 3)), random_quaternions(rng, count)
    speeds = rng.normal(size=(count, 6)) * 10.0 ** rng.uniform(-6, 1, size=(count, 1))
    states["v"], states["omega"] = speeds[:, :3], speeds[:, 3:]
    fast = rng.uniform(0.0, 100.0, size=count) / np.linalg.norm(states["omega"], axis=1)
    states["omega"][::2] *= fast[::2, np.newaxis]
    steps = rng.uniform(0.0, 5.0, size=count).view(STEP)
    batch = Batch.of(
        Integrator.MIDPOINT,
        bodies=bodies.records,
        basins=bodies.basins,
        steps=steps,
        states=states,
    )
    current_engine().run(batch, SimulationSettings(max_steps=1, speed_tolerance=0.0).rules)
    return batch, states


def test_the_midpoint_rule_never_lets_the_energy_rise(midpoint_steps):
    """But for rounding: both energies are sums of a dozen terms, each right to an ulp of its size;
    the step itself adds as much, and no more, because Newton goes on to the last digit."""
    batch, before = midpoint_steps
    old, new = energies(batch.bodies, before), energies(batch.bodies, batch.states)
    rises = (new.total - old.total) / np.maximum(old.size, new.size) / EPSILON

    assert len(rises) == STEPS
    assert (batch.taken == 1).all()
    assert np.linalg.norm(before["omega"], axis=1).max() > 99.0
    assert batch.steps["h"].max() > 4.9
    assert rises.max() <= 8.0
    assert (rises < 0.0).mean() > 0.8


def test_a_midpoint_step_loses_exactly_what_damping_takes(midpoint_steps):
    batch, before = midpoint_steps
    old, new = energies(batch.bodies, before), energies(batch.bodies, batch.states)
    v, omega = ((before[part] + batch.states[part]) / 2.0 for part in ("v", "omega"))
    spin = spins(batch.bodies, omega)
    taken = batch.times * batch.bodies["damping"] * (spin + (v**2).sum(axis=1))
    difference = (new.total - old.total + taken) / np.maximum(old.size, new.size) / EPSILON

    assert np.abs(difference).max() <= 8.0


def test_a_midpoint_step_is_halved_where_newton_fails(midpoint_steps):
    batch, before = midpoint_steps
    asked = batch.steps["h"]
    ratio = np.log2(asked / batch.times)
    twice = batch.states["omega"] + before["omega"]
    turning = np.linalg.norm(twice, axis=1) / 2.0 * batch.times

    assert (ratio == np.round(ratio)).all()
    assert ratio.min() == 0.0
    assert ratio.max() >= 5.0
    assert turning.max() <= LARGEST_TURN * (1.0 + 1e-12)


def test_a_midpoint_run_logs_energies_that_fall():
    problem = random_problem(np.random.default_rng(2), n=10, noise=0.3, offset=2.0)
    for step in (0.1, 1.0, 5.0):
        trajectory = simulate(
            Isotropic(exact_moments(problem)),
            0.3,
            Integrator.MIDPOINT,
            settings=SimulationSettings(step=step),
        )
        total = trajectory.potential + trajectory.kinetic

        assert trajectory.converged
        assert np.diff(total).max() <= 8.0 * EPSILON * (trajectory.potential[0] + 4.0)
        assert (np.diff(total) < 0.0).mean() > 0.9


# Splitting ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("size", [2.0**-100, 1.0, 2.0**100])
def test_eigenvalues_are_told_apart_relative_to_their_range(size):
    values = np.array([[3.0, 1.0, -1.0, -3.0], [3.0, 3.0 - 1e-13, -3.0, -3.0]])
    basins = basins_of(np.array([np.eye(4)] * 2), size * values, np.ones((2, 1)))

    assert (basins["gaps"] == size * np.array([[0.0, 2.0, 4.0, 6.0], [0.0, 0.0, 6.0, 6.0]])).all()


@pytest.fixture(scope="module", params=[MANY, pytest.param(ALL, marks=pytest.mark.long)], ids=str)
def registrations(request) -> list[tuple[Clouds, Bodies, Ends]]:
    """A tenth of them of 4, 5, 6 points: nearly ambiguous, nearly collinear ones among them."""
    rng, found = np.random.default_rng(2029), []
    shares = {100: 0.6, 20: 0.3, 6: 0.04, 5: 0.03, 4: 0.03}
    for n, share in shares.items():
        clouds = random_clouds(rng, int(request.param * share), n)
        bodies = bodies_of(clouds.sources, clouds.targets)
        found.append((clouds, bodies, simulate_many(bodies)))
    return found


def test_the_springs_of_one_body_are_those_of_many():
    """Thin ones, and one whose inertia is no matrix of a body: NumPy says so for both."""
    clouds = random_clouds(np.random.default_rng(31), 40, 4)
    bodies = bodies_of(clouds.sources * [1.0, 1.0, 1e-3], clouds.targets)
    many = spring_ratios(bodies.records, bodies.basins)
    one = [spring_ratios(bodies.records[[k]], bodies.basins[[k]])[0] for k in range(40)]

    assert np.abs(np.array(one) - many).max() <= 1e-9 * many.max()
    assert np.allclose(np.array(one)[:, 0], many[:, 0], rtol=1e-6)
    bodies.records["inertia"][0] = -1.0
    with pytest.raises(np.linalg.LinAlgError):
        spring_ratios(bodies.records[[0]], bodies.basins[[0]])


def test_the_translations_at_the_ends_are_those_of_least_squares():
    clouds = random_clouds(np.random.default_rng(34), 5, 9)
    targets = clouds.targets + np.array([3.0, -50.0, 0.25])
    for integrator in Integrator:
        ends = simulate_many(bodies_of(clouds.sources, targets), integrator)
        best = [register(*pair) for pair in zip(clouds.sources, targets, strict=True)]
        expected = np.array([pose.translation for pose in best])

        assert (ends.at_rest == ends.converged).all()
        assert np.abs(ends.translations - expected)[ends.converged].max() < 0.05


def test_the_springs_of_one_body_are_the_same_without_compiled_code(monkeypatch):
    clouds = random_clouds(np.random.default_rng(32), 40, 5)
    bodies = bodies_of(clouds.sources, clouds.targets)
    rows = [(bodies.records[[k]], bodies.basins[[k]]) for k in range(40)]
    compiled = np.array([spring_ratios(*row)[0] for row in rows])
    monkeypatch.setattr("certreg.dynamics.integrators.library_if_any", lambda: None)
    plain = np.array([spring_ratios(*row)[0] for row in rows])

    assert (np.diff(compiled) >= 0).all()
    assert np.abs(compiled - plain).max() <= 1e-12 * plain.max()
    assert np.allclose(compiled, plain, rtol=1e-9)


def test_the_inverse_of_the_inertia_is_rounded_once():
    """Of J in integers: a body 1e5 times as long as thick, where that of J in doubles is not."""
    points = np.random.default_rng(33).normal(size=(9, 3)) * [1.0, 1e-5, 1e-5]
    moments = exact_moments(RegistrationProblem(points, points[:, [1, 2, 0]]))
    body = rigid_body(moments, 2.0)
    unit = Fraction(4) ** (moments.source_exponent - body.length_exponent) / moments.mass**2
    known: Any = Matrix(3, 3, lambda i, j: Rational(moments.inertia[i][j] * unit)).inv()
    found = symmetric(body.record["inertia_inverse"])

    assert found.tolist() == [
        [float(Fraction(*map(int, known[i, j].as_numer_denom()))) for j in range(3)]
        for i in range(3)
    ]
    assert found.tolist() != np.linalg.inv(body.inertia).tolist()


@of_many
def test_splitting_reaches_the_optimum_and_says_so(registrations):
    """|alpha| < 1e-4 bounds the torque, G / J times the angle; at convergence it is small."""
    reached = total = 0
    for clouds, bodies, ends in registrations:
        off = angles(ends.rotations, best_rotations(clouds))
        rates = spring_ratios(bodies.records, bodies.basins)
        at_optimum = off * rates[:, 0] < 1e-3
        assert (at_optimum | ~ends.converged).all()  # what does not arrive does not say so
        assert (ends.status[~ends.converged] == Ending.OUT_OF_STEPS).all()
        reached, total = reached + int(at_optimum.sum()), total + len(off)

    assert total in {MANY, ALL}
    assert reached >= 0.9999 * total


@of_many
def test_what_converged_is_slow_and_in_the_certified_basin(registrations):
    for _, bodies, ends in registrations:
        q, gaps = ends.states["q"], bodies.basins["gaps"]
        overlaps = np.einsum("nki,ni->nk", bodies.basins["quaternions"], q) ** 2
        spin = spins(bodies.records, ends.states["omega"])
        height = (gaps * overlaps).sum(axis=1) + spin / 4.0

        assert (height < 0.4 * gaps[:, 1])[ends.converged].all()


@of_many
def test_what_converged_is_within_a_thousandth_of_a_radian(registrations):
    for clouds, _, ends in registrations:
        off = angles(ends.rotations, best_rotations(clouds))

        assert (off < 1e-3 + 1e-6)[ends.converged].all()


@pytest.mark.slow
@each_integrator
@pytest.mark.parametrize(("scale", "damping"), [(1e-3, 2.8), (1e-5, 2.8), (1e-50, 2.8), (1, 1e5)])
def test_a_body_that_is_slow_far_from_the_optimum_goes_on(scale, damping, integrator):
    """Weak springs and heavy damping: |s'| < 1e-4 everywhere, or soon."""
    clouds = random_clouds(np.random.default_rng(4), 9, 12)
    sources, targets = (c - c.mean(axis=1, keepdims=True) for c in (clouds.sources, clouds.targets))
    bodies = bodies_of(sources, scale * targets, damping=damping)
    few = SimulationSettings(max_steps=200, least_step=0.0)
    ends = simulate_many(bodies, integrator, settings=few)
    alone = simulate_many(
        bodies_of(sources[:1], scale * targets[:1], damping=damping), integrator, settings=few
    )

    assert (angles(ends.rotations, best_rotations(clouds)) > 0.1).all()
    assert not ends.converged.any()
    assert (ends.steps == 200).all()
    assert np.array_equal(alone.states[0], ends.states[0])


@of_many
def test_ends_of_a_sample_are_proved(registrations):
    clouds, _, ends = registrations[0]
    for k in range(20):
        problem = RegistrationProblem(clouds.sources[k], clouds.targets[k])
        found = Isotropic(exact_moments(problem))
        run = simulate(found, problem.damping, Integrator.SPLITTING)
        end = replace(run, course=replace(run.course, last=ends.states[k : k + 1]))

        assert proved_end(problem, found, end).body.claims.basin is True


@of_many
def test_what_has_too_few_steps_is_not_called_converged(registrations):
    _, bodies, _ = registrations[1]
    ends = simulate_many(bodies, settings=SimulationSettings(max_steps=3))

    assert not ends.converged.any()
    assert set(ends.steps.tolist()) == {3}


def test_a_spin_that_loses_the_state_starts_anew_with_half_the_step(monkeypatch):
    rng = np.random.default_rng(3)
    clouds = random_clouds(rng, 25_000, 4)
    bodies = bodies_of(clouds.sources, clouds.targets)
    thin = np.argsort(np.linalg.eigvalsh(symmetric(bodies.records["inertia"]))[:, 0])[:100]
    clouds = Clouds(clouds.sources[thin], clouds.targets[thin])
    bodies = bodies_of(clouds.sources, clouds.targets)
    with monkeypatch.context() as patched:
        patched.setattr(integrators, "SPLITTING_HALVINGS", 0)
        once = simulate_many(bodies)
    lost = np.flatnonzero(~once.converged)
    retried = simulate_many(bodies)

    assert len(lost) >= 5
    assert (once.steps[lost] < 1000).all()
    assert retried.converged.all()
    assert np.array_equal(once.states[once.converged], retried.states[once.converged])

    k = int(lost[0])
    problem = RegistrationProblem(clouds.sources[k], clouds.targets[k])
    trajectory = simulate(Isotropic(exact_moments(problem)), problem.damping, Integrator.SPLITTING)
    usual = step_parameters(
        Integrator.SPLITTING, bodies.records[[k]], bodies.basins[[k]], SimulationSettings()
    )
    assert trajectory.status is SimulationStatus.CONVERGED
    assert trajectory.times[0] == 0.0
    assert np.allclose(np.diff(trajectory.times), trajectory.step)
    assert trajectory.step <= usual["h"][0] / 2.0 * (1.0 + 1e-9)


def test_half_a_step_has_the_parameters_of_half_a_step():
    mu, h = np.array([1e-3, 1.0, 30.0]), np.array([0.8, 0.3, 0.1])

    def parameters(h):
        steps = np.empty(3, dtype=SPLITTING_STEP)
        steps["h"], steps["decay"], steps["impulse"] = h, np.exp(-mu * h), -np.expm1(-mu * h) / mu
        return steps

    assert np.allclose(plain(_halved(parameters(h))), plain(parameters(h / 2.0)), rtol=1e-14)


# Batches -----------------------------------------------------------------------------------------


def batch_of(bodies: Bodies, integrator: Integrator) -> Batch:
    starts = bodies.starts
    if integrator is Integrator.EULER:
        starts = np.zeros(len(starts), dtype=MATRIX_STATE)
        starts["c"], starts["R"] = bodies.starts["c"], rotations(bodies.starts["q"])
    steps = step_parameters(integrator, bodies.records, bodies.basins, SimulationSettings())
    return Batch.of(
        integrator, bodies=bodies.records, basins=bodies.basins, steps=steps, states=starts
    )


@pytest.fixture(scope="module")
def few() -> Bodies:
    """Instances that take different numbers of steps, and no multiple of the lanes."""
    clouds = random_clouds(np.random.default_rng(77), FEW, 7)
    scale = np.array([0.5, 1.0, 2.0])[np.arange(FEW) % 3, None, None]
    return bodies_of(
        clouds.sources, clouds.sources @ random_rotation(np.random.default_rng(1)) * scale
    )


@each_integrator
def test_a_batch_ends_as_its_instances_do_alone(few, integrator):
    together, rules = batch_of(few, integrator), SimulationSettings().rules
    alone = batch_of(few, integrator)
    current_engine().run(together, rules)
    for k in range(len(few.records)):
        current_engine().run(alone.part(slice(k, k + 1)), rules)

    assert len(set(together.taken.tolist())) > 3
    assert np.array_equal(together.taken, alone.taken)
    assert np.array_equal(together.status, alone.status)
    assert np.array_equal(together.escapes, alone.escapes)
    assert np.array_equal(together.times, alone.times)
    assert np.abs(plain(together.states) - plain(alone.states)).max() < 1e-12


@each_integrator
def test_batches_escape_from_saddles_as_single_instances_do(few, integrator):
    together = batch_of(few, integrator)
    for k in range(len(few.records)):  # on the saddle of index 1, 2, 3, or where it starts
        q = few.basins["quaternions"][k, k % 4]
        if k % 4 and integrator is Integrator.EULER:
            together.states["R"][k] = rotation_matrix(q.tolist())
        elif k % 4:
            together.states["q"][k] = q
    together.states["c"] = 0.0
    alone = together.part(slice(None)).part(np.ones(len(few.records), dtype=np.bool_))
    current_engine().run(together, SimulationSettings().rules)
    for k in range(len(few.records)):
        current_engine().run(alone.part(slice(k, k + 1)), SimulationSettings().rules)

    assert (together.escapes >= 1).sum() > FEW // 2
    assert (together.status == Ending.CONVERGED).all()
    assert np.array_equal(together.taken, alone.taken)
    assert np.array_equal(together.escapes, alone.escapes)
    assert (
        np.abs(plain(together.states) - plain(alone.states)).max() < 1e-9
    )  # rounding grows off a saddle


def test_threads_change_nothing():
    clouds = random_clouds(np.random.default_rng(8), 5_000 if COMPILED else 100, 10)
    bodies = bodies_of(clouds.sources, clouds.targets)
    one = simulate_many(bodies)
    two = simulate_many(bodies, settings=SimulationSettings(threads=2))

    named = simulate_many(bodies, "splitting")
    for name in ("states", "steps", "status", "times", "escapes"):
        assert np.array_equal(getattr(one, name), getattr(two, name))
        assert np.array_equal(getattr(one, name), getattr(named, name))
    with pytest.raises(InvalidProblemError, match="integrator is 'heun': give 'euler'"):
        simulate_many(bodies, "heun")


@each_integrator
def test_a_batch_ends_where_each_problem_does(integrator):
    rng = np.random.default_rng(12)
    clouds = random_clouds(rng, 12, 9)
    clouds = Clouds(clouds.sources, clouds.sources @ random_rotation(rng).T + 3.0)
    weights = rng.uniform(0.5, 2.0, size=(12, 9))
    exact = SimulationSettings(speed_tolerance=1e-9)
    bodies = bodies_of(clouds.sources, clouds.targets, weights=weights, damping=2.0)
    ends = simulate_many(bodies, integrator, settings=exact)
    for k in range(12):
        problem = RegistrationProblem(clouds.sources[k], clouds.targets[k], weights=weights[k])
        found = Isotropic(exact_moments(problem))
        trajectory = simulate(found, 2.0, integrator, settings=exact)
        own = rigid_body(found.moments, 2.0)
        basin = certified_basin(found, own.length_exponent)
        shift = 4.0 ** (own.length_exponent - int(bodies.length_exponents[k]))

        for part in ("cross", "inertia"):
            theirs = bodies.records[part][k]
            assert np.allclose(own.record[part] * shift, theirs, atol=1e-13)
        assert np.allclose(basin.gaps * shift, bodies.basins["gaps"][k], atol=1e-12)
        assert np.abs(trajectory.states[-1][3:12] - ends.rotations[k].ravel()).max() < 1e-8
    assert ends.converged.all()


def test_one_source_serves_many_targets_and_one_target_many_sources():
    rng = np.random.default_rng(13)
    clouds = random_clouds(rng, 5, 8)
    one = bodies_of(clouds.sources[0], clouds.targets)
    other = bodies_of(np.repeat(clouds.sources[:1], 5, axis=0), clouds.targets)
    third = bodies_of(clouds.sources, clouds.targets[2])

    assert np.allclose(plain(one.records), plain(other.records), rtol=1e-14)
    assert np.allclose(plain(one.starts), plain(other.starts), rtol=1e-14)
    assert third.records.shape == (5,)
    assert simulate_many(third).converged.shape == (5,)


def test_bodies_whose_optima_are_not_unique_comes_to_rest():
    mirrored = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 2], [0, 0, -2]])
    turns = rotations(random_quaternions(np.random.default_rng(14), 50))
    bodies = bodies_of(mirrored, mirrored * [1.0, 1.0, -1.0] @ turns + 0.5)
    ends = simulate_many(bodies)

    assert not bodies.basins["gaps"][:, 1].any()  # but for rounding, and that is taken for a tie
    assert set(ends.status.tolist()) == {Ending.AT_REST}
    assert ends.converged.all()


def test_what_is_no_batch_of_problems_is_refused():
    points = np.array(AXES)
    for sources, targets, words in (
        (points, points[:-1], "they correspond"),
        (points[:, :2], points[:, :2], r"give \(count, N, 3\) or \(N, 3\)"),
        (points[0], points, r"give \(count, N, 3\) or \(N, 3\)"),
        (points, points * np.nan, "targets of instance 0, row 0, is .nan, nan, nan.: every value"),
    ):
        with pytest.raises(InvalidProblemError, match=words):
            bodies_of(sources, targets)
    sources = np.array([points, points])
    sources[1] = np.linspace(-1.0, 1.0, len(points))[:, None] * [[1.0, 1.0, 0.5]]
    with pytest.raises(DegenerateProblemError, match="instance 1 is collinear"):
        bodies_of(sources, points)


@pytest.mark.parametrize("damping", [-1.0, 0.0, np.nan, np.inf, 1e-300, 1e300, "2", None, [1, 2]])
def test_a_damping_that_is_none_is_refused_a_batch(damping):
    with pytest.raises(InvalidProblemError, match=r"^damping is .*: it must be a positive finite"):
        bodies_of(AXES, AXES, damping=damping)


@pytest.mark.parametrize("scale", [1e-290, 1e-300])
def test_springs_too_weak_for_doubles_are_refused(scale):
    """Their gaps would vanish, as where every pose is optimal."""
    source, target = np.array(AXES) * 1e150, np.array(AXES) @ np.diag([1, -1, -1]) * scale
    found = Isotropic(exact_moments(RegistrationProblem(source, target)))
    with pytest.raises(DegenerateProblemError, match="less than double precision can tell"):
        simulate(found, 2.8)
    with pytest.raises(DegenerateProblemError, match="instance 0 differ too much in size"):
        bodies_of(source, target)


def test_too_stiff_a_batch_is_refused_to_euler():
    points = np.array(AXES)
    with pytest.raises(DegenerateProblemError, match="one unit of length"):
        simulate_many(bodies_of(points, 1e6 * points), Integrator.EULER)


def test_batches_of_other_shapes_are_refused():
    with pytest.raises(ValueError, match=r"steps are \(2,\) of .*: expected .*decay"):
        Batch.of(
            Integrator.SPLITTING,
            bodies=np.zeros(2, dtype=BODY),
            basins=np.zeros(2, dtype=BASIN),
            steps=np.zeros(2, dtype=STEP),
            states=np.zeros(2, dtype=QUATERNION_STATE),
        )


# Damping and rates -------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(5))
def test_no_damping_beside_the_optimal_one_decays_faster(seed):
    rng = np.random.default_rng(seed)
    problem = random_problem(rng, n=8, noise=0.4)
    found = Isotropic(exact_moments(problem))
    best = optimal_damping(found)

    def predicted(damping: float) -> float:
        rate = simulate(found, damping, Integrator.SPLITTING).predicted_rate
        assert rate is not None
        return rate

    rates = {share: predicted(share * best) for share in (0.5, 0.9, 0.99, 1.0, 1.01, 1.1, 2.0)}

    assert max(rates, key=lambda share: rates[share]) == 1.0
    assert rates[0.5] < rates[0.9] < rates[0.99]
    assert rates[1.01] > rates[1.1] > rates[2.0]
    # at critical damping the slowest pair meets: its rate is right to the root of rounding only
    assert rates[1.0] == pytest.approx(best / 2.0, rel=1e-6)


def test_the_optimal_damping_without_noise_is_the_root_of_eight():
    problem = random_problem(np.random.default_rng(6), n=8, noise=0.0)

    assert optimal_damping(Isotropic(exact_moments(problem))) == pytest.approx(np.sqrt(8.0))


@each_integrator
@pytest.mark.parametrize("damping", [1.0, 2.0, 4.0, 8.0])
def test_the_energy_decays_as_fast_as_predicted(integrator, damping):
    problem = random_problem(np.random.default_rng(16), n=12, noise=0.3, offset=4.0)
    settings = SimulationSettings(speed_tolerance=1e-6, step=0.01)
    found = Isotropic(exact_moments(problem))
    trajectory = simulate(found, damping, integrator, settings=settings)

    assert trajectory.predicted_rate is not None
    assert trajectory.decay_rate == pytest.approx(trajectory.predicted_rate, rel=0.05)
    assert trajectory.speed < 1e-6


def test_the_command_takes_the_optimal_damping(data):
    clouds = (data / "survey_source.csv", data / "survey_target.csv")
    best = certreg("simulate", *clouds, "--damping", "optimal", "--json").document
    usual = certreg("simulate", *clouds, "--json").document
    light = certreg("simulate", *clouds, "--damping", "1", "--json").document

    assert best["converged"] is best["in_certified_basin"] is True
    assert best["predicted_rate"] >= usual["predicted_rate"] > light["predicted_rate"]
    assert certreg("simulate", *clouds, "--damping", "OPTIMAL", "--json").document == best
    assert certreg("simulate", *clouds, "--damping", "best").code == 2


@each_integrator
def test_converged_means_slow_and_in_the_proved_basin(integrator):
    rng = np.random.default_rng(17)
    for tolerance in (1e-2, 1e-4, 1e-10):
        problem = random_problem(rng, n=10, noise=0.5)
        found = Isotropic(exact_moments(problem))
        settings = SimulationSettings(speed_tolerance=tolerance)
        trajectory = simulate(found, problem.damping, integrator, settings=settings)

        assert trajectory.status is SimulationStatus.CONVERGED
        assert trajectory.speed < tolerance
        assert proved_end(problem, found, trajectory).body.claims.basin is True
