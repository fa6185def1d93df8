"""What each integrator promises: the paper's steps, an energy that never rises, the optimum."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from commands import certreg
from strategies import AXES, random_problem, random_rotation
from test_simulation import proved_end

from certreg.dynamics.batch import Ends, Ensemble, ensemble, simulate_many
from certreg.dynamics.body import body_of
from certreg.dynamics.integrators import _halved, inertias, spring_ratios, step_parameters
from certreg.dynamics.simulation import SimulationStatus, certified_basin, optimal_damping, simulate
from certreg.equilibrium.spectral import spectrum
from certreg.errors import DegenerateProblemError, InvalidProblemError
from certreg.geometry.so3 import rotation_matrix
from certreg.native.batch import Batch, Ending, Integrator
from certreg.native.engine import current_engine
from certreg.native.library import Library
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem
from certreg.settings import SimulationSettings

COMPILED = isinstance(current_engine(), Library)
# instances; without a compiler each takes a millisecond
MANY, FEW, STEPS = (100_000, 83, 20_000) if COMPILED else (1_000, 11, 1_000)
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
    """The optima by singular values [Umeyama1991], a road that shares nothing with certreg's."""
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


@pytest.mark.parametrize("seed", range(3))
def test_euler_is_the_loop_of_the_paper(seed):
    problem = random_problem(np.random.default_rng(seed), n=8, noise=0.2)
    trajectory = simulate(spectrum(exact_moments(problem)), problem.damping)
    unit = 2.0**trajectory.length_exponent

    steps, state = papers_loop(problem, unit, 0.01, 1e-4)

    assert trajectory.step == 0.01
    assert trajectory.steps == steps
    assert np.abs(trajectory.states[-1] - state).max() < 1e-11


# Midpoint ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Energies:
    """Of states (count, 13), and `size`, the sum of the sizes of the terms."""

    total: Any
    size: Any


def energies(bodies, states) -> Energies:
    c, q, v, omega = np.split(states, [3, 7, 10], axis=1)
    aligned = np.einsum("nij,nij->n", rotations(q), bodies[:, :9].reshape(-1, 3, 3))
    kinetic = ((v**2).sum(axis=1) + np.einsum("ni,nij,nj->n", omega, inertias(bodies), omega)) / 2
    lengths = (c**2).sum(axis=1) + bodies[:, 21]
    return Energies(kinetic + lengths - 2 * aligned, kinetic + lengths + 2 * np.abs(aligned))


@pytest.fixture(scope="module")
def midpoint_steps() -> tuple[Batch, Any]:
    """One step from each of many random states: |omega| to 100, h to 5, mu 1e-9 to 100."""
    count, rng = STEPS, np.random.default_rng(31)
    clouds = random_clouds(rng, count, 6)
    bodies = ensemble(clouds.sources, clouds.targets)
    bodies.bodies[:, 22] = 10.0 ** rng.uniform(-9.0, 2.0, size=count)
    states = np.hstack([rng.normal(size=(count, 3)), bodies.starts[:, 3:7], np.zeros((count, 6))])
    states[:, 3:7] = random_quaternions(rng, count)
    states[:, 7:] = rng.normal(size=(count, 6)) * 10.0 ** rng.uniform(-6, 1, size=(count, 1))
    fast = rng.uniform(0.0, 100.0, size=count) / np.linalg.norm(states[:, 10:], axis=1)
    states[::2, 10:] *= fast[::2, np.newaxis]
    steps = rng.uniform(0.0, 5.0, size=(count, 1))
    batch = Batch.of(
        Integrator.MIDPOINT,
        bodies=bodies.bodies,
        basins=bodies.basins,
        steps=steps,
        states=states,
    )
    current_engine().run(batch, SimulationSettings(max_steps=1, speed_tolerance=0.0))
    return batch, states


def test_the_midpoint_rule_never_lets_the_energy_rise(midpoint_steps):
    """But for rounding: both energies are sums of a dozen terms, each right to an ulp of its size;
    the step itself adds as much, and no more, because Newton goes on to the last digit."""
    batch, before = midpoint_steps
    old, new = energies(batch.bodies, before), energies(batch.bodies, batch.states)
    rises = (new.total - old.total) / np.maximum(old.size, new.size) / EPSILON

    assert len(rises) == STEPS
    assert (batch.taken == 1).all()
    assert np.linalg.norm(before[:, 10:], axis=1).max() > 99.0
    assert batch.steps.max() > 4.9
    assert rises.max() <= 8.0
    assert (rises < 0.0).mean() > 0.8


def test_a_midpoint_step_loses_exactly_what_damping_takes(midpoint_steps):
    batch, before = midpoint_steps
    old, new = energies(batch.bodies, before), energies(batch.bodies, batch.states)
    middle = (before + batch.states) / 2.0
    v, omega = middle[:, 7:10], middle[:, 10:]
    spin = np.einsum("ni,nij,nj->n", omega, inertias(batch.bodies), omega)
    taken = batch.times * batch.bodies[:, 22] * (spin + (v**2).sum(axis=1))
    difference = (new.total - old.total + taken) / np.maximum(old.size, new.size) / EPSILON

    assert np.abs(difference).max() <= 8.0


def test_a_midpoint_step_is_halved_where_newton_fails(midpoint_steps):
    batch, before = midpoint_steps
    asked = batch.steps[:, 0]
    ratio = np.log2(asked / batch.times)
    turning = np.linalg.norm(batch.states[:, 10:] + before[:, 10:], axis=1) / 2.0 * batch.times

    assert (ratio == np.round(ratio)).all()
    assert ratio.min() == 0.0
    assert ratio.max() >= 5.0
    assert turning.max() <= SimulationSettings().largest_turn * (1.0 + 1e-12)


def test_a_midpoint_run_logs_energies_that_fall():
    problem = random_problem(np.random.default_rng(2), n=10, noise=0.3, offset=2.0)
    for step in (0.1, 1.0, 5.0):
        trajectory = simulate(
            spectrum(exact_moments(problem)),
            0.3,
            Integrator.MIDPOINT,
            settings=SimulationSettings(step=step),
        )
        total = trajectory.potential + trajectory.kinetic

        assert trajectory.converged
        assert np.diff(total).max() <= 8.0 * EPSILON * (trajectory.potential[0] + 4.0)
        assert (np.diff(total) < 0.0).mean() > 0.9


# Splitting ---------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def registrations() -> list[tuple[Clouds, Ensemble, Ends]]:
    """A tenth of them of 4, 5, 6 points: nearly ambiguous, nearly collinear ones among them."""
    rng, found = np.random.default_rng(2029), []
    shares = {100: 0.6, 20: 0.3, 6: 0.04, 5: 0.03, 4: 0.03}
    for n, share in shares.items():
        clouds = random_clouds(rng, int(MANY * share), n)
        bodies = ensemble(clouds.sources, clouds.targets)
        found.append((clouds, bodies, simulate_many(bodies)))
    return found


def test_splitting_reaches_the_optimum_and_says_so(registrations):
    """|alpha| < 1e-4 bounds the torque, G / J times the angle; at convergence it is small."""
    reached = total = 0
    for clouds, bodies, ends in registrations:
        off = angles(ends.rotations, best_rotations(clouds))
        rates = spring_ratios(bodies.bodies, bodies.basins)
        at_optimum = off * rates[:, 0] < 1e-3
        assert (at_optimum | ~ends.converged).all()  # what does not arrive does not say so
        assert (ends.status[~ends.converged] == Ending.OUT_OF_STEPS).all()
        reached, total = reached + int(at_optimum.sum()), total + len(off)

    assert total == MANY
    assert reached >= 0.9999 * total


def test_what_converged_is_slow_and_in_the_certified_basin(registrations):
    for _, bodies, ends in registrations:
        q, omega = ends.states[:, 3:7], ends.states[:, 10:]
        overlaps = np.einsum("nki,ni->nk", bodies.basins[:, :16].reshape(-1, 4, 4), q) ** 2
        spin = np.einsum("ni,nij,nj->n", omega, inertias(bodies.bodies), omega)
        height = (bodies.basins[:, 16:] * overlaps).sum(axis=1) + spin / 4.0

        assert (height < 0.4 * bodies.basins[:, 17])[ends.converged].all()


def test_what_converged_is_within_a_thousandth_of_a_radian(registrations):
    for clouds, _, ends in registrations:
        off = angles(ends.rotations, best_rotations(clouds))

        assert (off < 1e-3 + 1e-6)[ends.converged].all()


@each_integrator
@pytest.mark.parametrize(("scale", "damping"), [(1e-3, 2.8), (1e-5, 2.8), (1e-50, 2.8), (1, 1e5)])
def test_a_body_that_is_slow_far_from_the_optimum_goes_on(scale, damping, integrator):
    """Weak springs and heavy damping: |s'| < 1e-4 everywhere, or soon."""
    clouds = random_clouds(np.random.default_rng(4), 9, 12)
    sources, targets = (c - c.mean(axis=1, keepdims=True) for c in (clouds.sources, clouds.targets))
    bodies = ensemble(sources, scale * targets, damping=damping)
    few = SimulationSettings(max_steps=200, least_step=0.0)
    ends = simulate_many(bodies, integrator, settings=few)
    alone = simulate_many(
        ensemble(sources[:1], scale * targets[:1], damping=damping), integrator, settings=few
    )

    assert (angles(ends.rotations, best_rotations(clouds)) > 0.1).all()
    assert not ends.converged.any()
    assert (ends.steps == 200).all()
    assert np.array_equal(alone.states[0], ends.states[0])


def test_ends_of_a_sample_are_proved(registrations):
    clouds, _, ends = registrations[0]
    for k in range(20):
        problem = RegistrationProblem(clouds.sources[k], clouds.targets[k])
        found = spectrum(exact_moments(problem))
        end = replace(
            simulate(found, problem.damping, Integrator.SPLITTING),
            quaternion=ends.states[k, 3:7],
            angular_velocity=ends.states[k, 10:],
        )

        assert proved_end(problem, found, end).body.claims.basin is True


def test_what_has_too_few_steps_is_not_called_converged(registrations):
    _, bodies, _ = registrations[1]
    ends = simulate_many(bodies, settings=SimulationSettings(max_steps=3))

    assert not ends.converged.any()
    assert set(ends.steps.tolist()) == {3}


def test_a_spin_that_loses_the_state_starts_anew_with_half_the_step():
    rng = np.random.default_rng(3)
    clouds = random_clouds(rng, 25_000, 4)
    bodies = ensemble(clouds.sources, clouds.targets)
    thin = np.argsort(np.linalg.eigvalsh(inertias(bodies.bodies))[:, 0])[:100]
    clouds = Clouds(clouds.sources[thin], clouds.targets[thin])
    bodies = ensemble(clouds.sources, clouds.targets)
    once = simulate_many(bodies, settings=SimulationSettings(splitting_halvings=0))
    lost = np.flatnonzero(~once.converged)
    retried = simulate_many(bodies)

    assert len(lost) >= 5
    assert (once.steps[lost] < 1000).all()
    assert retried.converged.all()
    assert np.array_equal(once.states[once.converged], retried.states[once.converged])

    k = int(lost[0])
    problem = RegistrationProblem(clouds.sources[k], clouds.targets[k])
    trajectory = simulate(spectrum(exact_moments(problem)), problem.damping, Integrator.SPLITTING)
    usual = step_parameters(
        Integrator.SPLITTING, bodies.bodies[[k]], bodies.basins[[k]], SimulationSettings()
    )
    assert trajectory.status is SimulationStatus.CONVERGED
    assert trajectory.times[0] == 0.0
    assert np.allclose(np.diff(trajectory.times), trajectory.step)
    assert trajectory.step <= usual[0, 0] / 2.0 * (1.0 + 1e-9)


def test_half_a_step_has_the_parameters_of_half_a_step():
    mu, h = np.array([1e-3, 1.0, 30.0]), np.array([0.8, 0.3, 0.1])

    def parameters(h):
        return np.column_stack([h, np.exp(-mu * h), -np.expm1(-mu * h) / mu])

    assert np.allclose(_halved(parameters(h)), parameters(h / 2.0), rtol=1e-14)


# Batches -----------------------------------------------------------------------------------------


def batch_of(bodies: Ensemble, integrator: Integrator) -> Batch:
    starts = bodies.starts
    if integrator is Integrator.EULER:
        turned = rotations(starts[:, 3:7]).reshape(-1, 9)
        starts = np.hstack([starts[:, :3], turned, starts[:, 7:]])
    steps = step_parameters(integrator, bodies.bodies, bodies.basins, SimulationSettings())
    return Batch.of(
        integrator, bodies=bodies.bodies, basins=bodies.basins, steps=steps, states=starts
    )


@pytest.fixture(scope="module")
def few() -> Ensemble:
    """Instances that take different numbers of steps, and no multiple of the lanes."""
    clouds = random_clouds(np.random.default_rng(77), FEW, 7)
    scale = np.array([0.5, 1.0, 2.0])[np.arange(FEW) % 3, None, None]
    return ensemble(
        clouds.sources, clouds.sources @ random_rotation(np.random.default_rng(1)) * scale
    )


@each_integrator
def test_a_batch_ends_as_its_instances_do_alone(few, integrator):
    together, settings = batch_of(few, integrator), SimulationSettings()
    alone = batch_of(few, integrator)
    current_engine().run(together, settings)
    for k in range(len(few.bodies)):
        current_engine().run(alone.part(slice(k, k + 1)), settings)

    assert len(set(together.taken.tolist())) > 3
    assert np.array_equal(together.taken, alone.taken)
    assert np.array_equal(together.status, alone.status)
    assert np.array_equal(together.escapes, alone.escapes)
    assert np.array_equal(together.times, alone.times)
    assert np.abs(together.states - alone.states).max() < 1e-12


@each_integrator
def test_batches_escape_from_saddles_as_single_instances_do(few, integrator):
    together = batch_of(few, integrator)
    for k in range(len(few.bodies)):  # on the saddle of index 1, 2, 3, or where it starts
        q = few.basins[k, 4 * (k % 4) : 4 * (k % 4) + 4]
        if k % 4 and integrator is Integrator.EULER:
            together.states[k, 3:12] = np.ravel(rotation_matrix(q.tolist()))
        elif k % 4:
            together.states[k, 3:7] = q
        together.states[k, :3] = 0.0
    alone = together.part(slice(None)).chosen(np.ones(len(few.bodies), dtype=np.bool_))
    current_engine().run(together, SimulationSettings())
    for k in range(len(few.bodies)):
        current_engine().run(alone.part(slice(k, k + 1)), SimulationSettings())

    assert (together.escapes >= 1).sum() > FEW // 2
    assert (together.status == Ending.CONVERGED).all()
    assert np.array_equal(together.taken, alone.taken)
    assert np.array_equal(together.escapes, alone.escapes)
    assert np.abs(together.states - alone.states).max() < 1e-9  # rounding grows off a saddle


def test_threads_change_nothing():
    clouds = random_clouds(np.random.default_rng(8), 5_000 if COMPILED else 100, 10)
    bodies = ensemble(clouds.sources, clouds.targets)
    one = simulate_many(bodies)
    two = simulate_many(bodies, settings=SimulationSettings(threads=2))

    for name in ("states", "steps", "status", "times", "escapes"):
        assert np.array_equal(getattr(one, name), getattr(two, name))


@each_integrator
def test_an_ensemble_ends_where_each_problem_does(integrator):
    rng = np.random.default_rng(12)
    clouds = random_clouds(rng, 12, 9)
    clouds = Clouds(clouds.sources, clouds.sources @ random_rotation(rng).T + 3.0)
    weights = rng.uniform(0.5, 2.0, size=(12, 9))
    exact = SimulationSettings(speed_tolerance=1e-9)
    bodies = ensemble(clouds.sources, clouds.targets, weights=weights, damping=2.0)
    ends = simulate_many(bodies, integrator, settings=exact)
    for k in range(12):
        problem = RegistrationProblem(clouds.sources[k], clouds.targets[k], weights=weights[k])
        found = spectrum(exact_moments(problem))
        trajectory = simulate(found, 2.0, integrator, settings=exact)
        own = body_of(found.moments, 2.0)
        basin = certified_basin(found, own.length_exponent)
        shift = 4.0 ** (own.length_exponent - int(bodies.length_exponents[k]))

        assert np.allclose(own.parameters[:15] * shift, bodies.bodies[k, :15], atol=1e-13)
        assert np.allclose(basin.deficits * shift, bodies.basins[k, 16:], atol=1e-12)
        assert np.abs(trajectory.states[-1][3:12] - ends.rotations[k].ravel()).max() < 1e-8
    assert ends.converged.all()


def test_one_source_serves_many_targets_and_one_target_many_sources():
    rng = np.random.default_rng(13)
    clouds = random_clouds(rng, 5, 8)
    one = ensemble(clouds.sources[0], clouds.targets)
    other = ensemble(np.repeat(clouds.sources[:1], 5, axis=0), clouds.targets)
    third = ensemble(clouds.sources, clouds.targets[2])

    assert np.allclose(one.bodies, other.bodies, rtol=1e-14)
    assert np.allclose(one.starts, other.starts, rtol=1e-14)
    assert third.bodies.shape == (5, 23)
    assert simulate_many(third).converged.shape == (5,)


def test_an_ensemble_whose_optima_are_not_unique_comes_to_rest():
    mirrored = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 2], [0, 0, -2]])
    turns = rotations(random_quaternions(np.random.default_rng(14), 50))
    bodies = ensemble(mirrored, mirrored * [1.0, 1.0, -1.0] @ turns + 0.5)
    ends = simulate_many(bodies)

    assert not bodies.basins[:, 17].any()  # but for rounding, and that is taken for a tie
    assert set(ends.status.tolist()) == {Ending.AT_REST}
    assert ends.converged.all()


def test_what_is_no_ensemble_is_refused():
    points = np.array(AXES)
    for sources, targets, words in (
        (points, points[:-1], "they correspond"),
        (points[:, :2], points[:, :2], "give finite numbers"),
        (points[0], points, "give finite numbers"),
        (points, points * np.nan, "targets of instance 0, row 0, is .nan, nan, nan.: every value"),
    ):
        with pytest.raises(InvalidProblemError, match=words):
            ensemble(sources, targets)
    sources = np.array([points, points])
    sources[1] = np.linspace(-1.0, 1.0, len(points))[:, None] * [[1.0, 1.0, 0.5]]
    with pytest.raises(DegenerateProblemError, match="instance 1 is collinear"):
        ensemble(sources, points)


@pytest.mark.parametrize("damping", [-1.0, 0.0, np.nan, np.inf, 1e-300, 1e300, "2", None, [1, 2]])
def test_a_damping_that_is_none_is_refused_an_ensemble(damping):
    with pytest.raises(InvalidProblemError, match=r"^damping is .*: it must be a positive finite"):
        ensemble(AXES, AXES, damping=damping)


@pytest.mark.parametrize("scale", [1e-290, 1e-300])
def test_springs_too_weak_for_doubles_are_refused(scale):
    """Their deficits would vanish, as where every pose is optimal."""
    source, target = np.array(AXES) * 1e150, np.array(AXES) @ np.diag([1, -1, -1]) * scale
    found = spectrum(exact_moments(RegistrationProblem(source, target)))
    with pytest.raises(DegenerateProblemError, match="less than double precision can tell"):
        simulate(found, 2.8)
    with pytest.raises(DegenerateProblemError, match="instance 0 differ too much in size"):
        ensemble(source, target)


def test_too_stiff_an_ensemble_is_refused_to_euler():
    points = np.array(AXES)
    with pytest.raises(DegenerateProblemError, match="one unit of length"):
        simulate_many(ensemble(points, 1e6 * points), Integrator.EULER)


def test_batches_of_other_shapes_are_refused():
    with pytest.raises(ValueError, match=r"steps has shape \(2, 1\): expected \(2, 3\)"):
        Batch.of(
            Integrator.SPLITTING,
            bodies=np.ones((2, 23)),
            basins=np.ones((2, 20)),
            steps=np.ones((2, 1)),
            states=np.ones((2, 13)),
        )


# Damping and rates -------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(5))
def test_no_damping_beside_the_optimal_one_decays_faster(seed):
    rng = np.random.default_rng(seed)
    problem = random_problem(rng, n=8, noise=0.4)
    found = spectrum(exact_moments(problem))
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

    assert optimal_damping(spectrum(exact_moments(problem))) == pytest.approx(np.sqrt(8.0))


@each_integrator
@pytest.mark.parametrize("damping", [1.0, 2.0, 4.0, 8.0])
def test_the_energy_decays_as_fast_as_predicted(integrator, damping):
    problem = random_problem(np.random.default_rng(16), n=12, noise=0.3, offset=4.0)
    settings = SimulationSettings(speed_tolerance=1e-6, step=0.01)
    found = spectrum(exact_moments(problem))
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
        found = spectrum(exact_moments(problem))
        settings = SimulationSettings(speed_tolerance=tolerance)
        trajectory = simulate(found, problem.damping, integrator, settings=settings)

        assert trajectory.status is SimulationStatus.CONVERGED
        assert trajectory.speed < tolerance
        assert proved_end(problem, found, trajectory).body.claims.basin is True
