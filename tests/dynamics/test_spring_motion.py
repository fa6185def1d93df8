"""The body on general springs: its equations beside sums over points, integrators, stops; many."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import spring_families
from engines import engine as either

from benchmarks.rates.spring_stability import counted, unstable_directions
from certreg import RegistrationProblem, bodies_on_springs, simulate_many, solve_many_springs
from certreg.dynamics.body import SpringStatus, steps_of
from certreg.dynamics.integrators import SimulationSettings
from certreg.dynamics.simulation import simulate
from certreg.dynamics.states import CUBE
from certreg.dynamics.valleys import SprungBody, spring_body, without_traces
from certreg.errors import DegenerateProblemError, InvalidProblemError
from certreg.geometry.so3 import rotation_matrix
from certreg.native.layout import QUATERNION_STATE, plain
from certreg.native.loops import Batch, Ending, Integrator, Rules
from certreg.objective.isotropic import Isotropic
from certreg.objective.springs import Springs
from certreg.problem.moments import exact_moments
from certreg.problem.stiffness import spring_moments

STEPS = (Integrator.MIDPOINT, Integrator.SPLITTING)
RULES = Rules(speed_tolerance=1e-6, rest_share=1e-7, first_perturbation=1e-3, max_steps=20_000)


def clouds(n: int, seed: int) -> tuple[Any, Any, Any]:
    rng = np.random.default_rng(seed)
    source = rng.normal(size=(n, 3)) + 5.0
    target = source + [3.0, -2.0, 1.0] + 0.1 * rng.normal(size=(n, 3))
    return source, target, rng.normal(size=(n, 3))


def planes(n: int = 12, seed: int = 0) -> RegistrationProblem:
    source, target, normals = clouds(n, seed)
    return RegistrationProblem(source, target, normals=normals)


def matrices(n: int = 9, seed: int = 1) -> RegistrationProblem:
    source, target, _ = clouds(n, seed)
    A = np.random.default_rng(seed).normal(size=(n, 3, 3))
    return RegistrationProblem(source, target, information=A @ A.transpose(0, 2, 1))


def objective_of(problem: RegistrationProblem) -> Springs:
    return Springs.of(problem)


def any_state(seed: int) -> Any:
    rng = np.random.default_rng(seed)
    state = np.zeros((), QUATERNION_STATE)
    for part in ("c", "q", "v", "omega"):
        state[part] = rng.normal(size=state[part].shape)
    state["q"] /= np.linalg.norm(state["q"])
    return state


class Points:
    """The same body as sums over its points, written as one reads them."""

    def __init__(self, problem: RegistrationProblem, moving: SprungBody) -> None:
        L = np.zeros((problem.n, 3, 3))
        L[:, (0, 1, 1, 2, 2, 2), (0, 0, 1, 0, 1, 2)] = problem.factors
        unit = 2.0**moving.length_exponent
        self.W = L @ L.transpose(0, 2, 1)
        self.m = np.trace(self.W, axis1=1, axis2=2) / 3
        self.x = (problem.source - np.array(moving.centre, float)) / unit
        self.y = (problem.target - np.array(moving.origin, float)) / unit

    def potential(self, c: Any, R: Any) -> float:
        e = self.y - self.x @ R.T - c
        return float(np.einsum("ni,nij,nj", e, self.W, e) / self.m.sum())

    def pulls(self, state: Any) -> Any:
        R = np.array(rotation_matrix(state["q"].tolist()))
        e = self.y - self.x @ R.T - state["c"]
        pull = 2 * np.einsum("nij,nj->ni", self.W, e)
        return np.r_[pull.sum(axis=0), np.cross(self.x, pull @ R).sum(axis=0)] / self.m.sum()

    def kinetic(self, state: Any) -> float:
        R = np.array(rotation_matrix(state["q"].tolist()))
        speeds = np.cross(state["omega"], self.x) @ R.T + state["v"]
        return float((self.m * (speeds**2).sum(axis=1)).sum() / 2 / self.m.sum())


@pytest.mark.parametrize("problem", [planes(), matrices()])
def test_the_generated_functions_are_sums_over_the_points(problem):
    moving = spring_body(spring_moments(problem), 1.3)
    points, state = Points(problem, moving), any_state(2)
    R = np.array(rotation_matrix(state["q"].tolist()))

    energies = moving.energies(state)
    _, force = moving.curvature(state)

    assert energies["potential"] == pytest.approx(points.potential(state["c"], R), rel=1e-13)
    assert moving.kinetic(energies) == pytest.approx(points.kinetic(state), rel=1e-13)
    assert np.allclose(force, points.pulls(state), rtol=1e-12, atol=1e-12)


def moved(state: Any, change: Any) -> Any:
    """A state after small changes of c, along R exp([phi]x), of v and of omega."""
    after = state.copy()
    w, *v = state["q"]
    half = np.asarray(change[3:6]) / 2
    after["q"] = np.r_[w - v @ half, w * half + np.cross(v, half) + np.array(v)]
    after["q"] /= np.linalg.norm(after["q"])
    after["c"] += change[:3]
    after["v"] += change[6:9]
    after["omega"] += change[9:]
    return after


def test_the_hessian_and_the_linearisation_are_derivatives():
    moving, state, h = spring_body(spring_moments(matrices()), 1.3), any_state(3), 1e-6
    hessian, _ = moving.curvature(state)
    jacobian, inverse = moving.jacobian(state), np.linalg.inv(moving.inertia)

    def rates(at: Any) -> Any:
        _, force = moving.curvature(at)
        omega = at["omega"]
        spin = force[3:] - np.cross(omega, moving.inertia @ omega)
        return np.r_[force[:3] - 1.3 * at["v"], inverse @ spin - 1.3 * omega]

    def slope(function: Any) -> Any:
        axes = h * np.eye(12)
        return np.array([(function(moved(state, e)) - function(moved(state, -e))) for e in axes]).T

    forces = -slope(lambda at: moving.curvature(at)[1])[:, :6] / (2 * h)
    twisted = (forces - forces.T)[3:, 3:]  # off an equilibrium: the torque itself
    assert np.allclose((forces + forces.T) / 2, hessian, atol=1e-7)
    assert np.abs(forces[:3] - hessian[:3]).max() < 1e-7
    assert np.abs(twisted).max() > 0.1
    assert np.allclose(slope(rates) / (2 * h), jacobian[6:], atol=1e-6)


def run(problem: RegistrationProblem, integrator: Integrator, start: Any, h: float) -> Any:
    moving = spring_body(spring_moments(problem), 1.3)
    settings = SimulationSettings(step=h, speed_tolerance=1e-6)
    return simulate(
        objective_of(problem), moving.damping, integrator, start=start, settings=settings
    )


@pytest.mark.parametrize("problem", [planes(), matrices()])
@pytest.mark.parametrize("h", [0.05, 1.0])
def test_the_midpoint_rule_loses_what_damping_takes_to_rounding(problem, h):
    found = run(problem, Integrator.MIDPOINT, any_state(4), h)
    samples = found.samples
    states, energy = samples["state"], found.potential + found.kinetic
    v, omega = ((states[part][1:] + states[part][:-1]) / 2 for part in ("v", "omega"))
    J = found.moving.inertia
    power = (v**2).sum(axis=1) + np.einsum("ni,ij,nj->n", omega, J, omega)
    loss = 1.3 * np.diff(samples["time"]) * power

    missed = np.abs(np.diff(energy)[: len(loss)] + loss) / energy[0]

    assert found.at_rest
    assert missed.max() < 2e-15
    assert (np.diff(energy) <= 1e-15 * energy[0]).all()


def test_both_integrators_approach_one_motion():
    problem, start, ends = planes(), any_state(5), {}
    for integrator, h in ((STEPS[0], 1e-3), (STEPS[1], 1e-3), (STEPS[1], 5e-4)):
        moving = spring_body(spring_moments(problem), 1.3)
        steps = steps_of(integrator, (moving,), start[None], SimulationSettings(step=h))
        batch = Batch.of(integrator, bodies=moving.record[None], steps=steps, states=start[None])
        rules = Rules(
            speed_tolerance=0.0, rest_share=0.0, first_perturbation=0.0, max_steps=round(1 / h)
        )
        either("library").run(batch, rules)
        ends[integrator, h] = plain(batch.states)[0]
    first, one, half = ends.values()

    assert np.abs(one - first).max() < 0.02
    assert np.abs(half - first).max() < 0.6 * np.abs(one - first).max()


@pytest.mark.parametrize("integrator", STEPS)
def test_isotropic_data_move_as_on_the_isotropic_road(integrator):
    source, target, _ = clouds(12, 6)
    weights = np.random.default_rng(6).integers(1, 5, 12) / 2.0
    factors = np.zeros((12, 6))
    factors[:, (0, 2, 5)] = weights[:, None]
    settings = SimulationSettings(step=0.1)
    alone = RegistrationProblem(source, target, weights=weights**2)
    general = RegistrationProblem(source, target, factors=factors)

    one = simulate(Isotropic(exact_moments(alone)), 1.5, integrator, settings=settings)
    other = simulate(objective_of(general), 1.5, integrator, settings=settings)

    mine, theirs = one.course.samples["state"], other.samples["state"]
    unit = 2.0 ** (other.length_exponent - one.length_exponent)
    count = min(len(mine), len(theirs))
    assert count > 50
    for part, scale in (("c", unit), ("q", 1.0), ("v", unit), ("omega", 1.0)):
        assert np.abs(mine[part][:count] - scale * theirs[part][:count]).max() < 1e-12, part


@pytest.mark.parametrize("integrator", STEPS)
def test_one_wall_released_with_a_sliding_velocity_comes_to_rest(integrator):
    source = np.random.default_rng(7).normal(size=(10, 3))
    target = source + np.array([3, 0, 0.5])
    wall = RegistrationProblem(source, target, normals=[[0.0, 0.0, 1.0]] * 10)
    start = spring_body(spring_moments(wall), 1.5).start.copy()
    start["v"], start["omega"] = (1.0, 2.0, 0.0), (0.0, 0.0, 0.7)

    found = simulate(objective_of(wall), 1.5, integrator, start=start)

    assert found.at_rest
    assert found.speed < 1e-4
    # c + v / mu is constant along the wall, up to what is left of v where the body is slow
    slid = found.last["c"] - start["c"] - start["v"] / 1.5
    share = 0.6 if integrator is Integrator.SPLITTING else 1e-4  # a kick before the drift
    assert np.abs(slid[:2]).max() < share


def test_a_body_on_a_saddle_is_perturbed_off_it():
    """Points turned by half a turn, on isotropic springs: where they are given is a saddle."""
    axes = np.diag([1.0, 2.0, 3.0])
    source = np.concatenate([axes, -axes])
    factors = np.tile([1.0, 0.0, 1.0, 0.0, 0.0, 1.0], (6, 1))
    turned = RegistrationProblem(source, source * [1.0, -1.0, -1.0], factors=factors)

    found = simulate(objective_of(turned), 1.5)

    assert found.escapes >= 1
    assert found.at_rest
    assert abs(found.quaternion[0]) < 1e-3  # half a turn from where it was


def test_compiled_code_and_python_take_the_same_way():
    problem, start = planes(8, 3), any_state(8)
    moving = spring_body(spring_moments(problem), 1.3)
    for integrator in STEPS:
        ends = []
        for engine in (either("library"), either("evaluator")):
            steps = steps_of(integrator, (moving,), start[None], SimulationSettings())
            batch = Batch.of(
                integrator, bodies=moving.record[None], steps=steps, states=start[None]
            )
            engine.run(batch, replace(RULES, max_steps=30))
            ends.append((batch.taken[0], plain(batch.states)[0]))
        (one, mine), (other, theirs) = ends
        assert one == other
        assert np.abs(mine - theirs).max() < 1e-11


@pytest.mark.slow
def test_bodies_side_by_side_end_as_each_alone():
    bodies = [spring_body(spring_moments(planes(20, seed)), 1.5) for seed in range(19)]
    starts = np.array([body.start for body in bodies])
    for integrator in STEPS:
        steps = steps_of(integrator, bodies, starts, SimulationSettings())
        records = np.array([body.record for body in bodies])
        many = Batch.of(integrator, bodies=records, steps=steps, states=starts)
        either("library").run(many, RULES)
        for k in range(0, 19, 6):
            part = slice(k, k + 1)
            one = Batch.of(integrator, bodies=records[part], steps=steps[part], states=starts[part])
            either("library").run(one, RULES)
            assert one.taken[0] == many.taken[k]
            assert np.allclose(plain(one.states), plain(many.states[part]), atol=1e-12)
        assert (many.status == Ending.AT_REST).all()


def test_a_collinear_source_is_refused():
    line = np.arange(5.0)[:, None] * [1.0, 2.0, 3.0]
    problem = RegistrationProblem(line, line, normals=np.random.default_rng(0).normal(size=(5, 3)))
    with pytest.raises(DegenerateProblemError, match="collinear"):
        simulate(objective_of(problem), 1.5)


def test_explicit_euler_is_refused():
    with pytest.raises(InvalidProblemError, match="take 'midpoint'"):
        simulate(objective_of(planes()), 1.5, Integrator.EULER)


def test_steps_that_run_out_are_told():
    few = SimulationSettings(max_steps=2)
    assert simulate(objective_of(planes()), 1.5, settings=few).status is (SpringStatus.OUT_OF_STEPS)


def test_the_rotations_of_the_cube_are_24():
    R = np.array([rotation_matrix(q.tolist()) for q in CUBE])
    assert len({tuple(np.round(r).ravel()) for r in R}) == 24
    assert np.abs(R - np.round(R)).max() < 1e-15


def test_what_has_no_trace_has_none():
    rest, _ = without_traces(np.random.default_rng(1).integers(-9, 9, (6, 6)).tolist())
    table = np.array(rest, dtype=float)
    assert np.abs(table[:, (0, 3, 5)].sum(axis=1)).max() < 1e-14
    assert np.abs(table[(0, 3, 5), :].sum(axis=0)).max() < 1e-14


@pytest.mark.slow
def test_unstable_eigenvalues_are_the_proved_index():
    tally = counted(2, families=("plane", "aniso"))
    assert tally.equilibria >= 16
    assert tally.missed == 0


def test_an_index_that_is_wrong_is_seen():
    problem = planes(20, 2)
    moving = spring_body(spring_moments(problem), 1.3)
    q = np.array([1.0, 0.0, 0.0, 0.0])
    assert unstable_directions(moving, q, np.eye(6)) != 6


COUNT = 3
CELL = spring_families.Cell("plane", 20, 0.05)
MADE = [spring_families.instance(CELL, seed) for seed in range(COUNT)]
SOURCES, TARGETS = (np.array([getattr(m, side) for m in MADE]) for side in ("source", "target"))
NORMALS = np.array([m.springs["normals"] for m in MADE])


@pytest.mark.parametrize("integrator", ["midpoint", "splitting"])
def test_each_of_many_bodies_ends_where_it_does_alone(integrator):
    ends = simulate_many(bodies_on_springs(SOURCES, TARGETS, normals=NORMALS), integrator)

    for k, one in enumerate(MADE):
        problem = RegistrationProblem(one.source, one.target, normals=one.springs["normals"])
        objective = Springs.of(problem)
        alone = simulate(objective, problem.damping, Integrator(integrator))
        assert alone.at_rest is bool(ends.at_rest[k])
        assert abs(int(alone.steps) - int(ends.steps[k])) <= 1
        assert np.abs(alone.quaternion - ends.states["q"][k]).max() < 1e-9


def test_where_they_end_is_one_of_the_equilibria_that_are_listed():
    """The list comes from paths, in another arithmetic: rotations and translations alike."""
    settings = SimulationSettings(threads=2)
    ends = simulate_many(bodies_on_springs(SOURCES, TARGETS, normals=NORMALS), settings=settings)
    listed = solve_many_springs(SOURCES, TARGETS, normals=NORMALS)

    assert ends.at_rest.all()
    assert not ends.converged.any()
    for k in range(COUNT):
        q = ends.states["q"][k] / np.linalg.norm(ends.states["q"][k])
        here = listed.quaternions[k, : listed.counts[k]]
        nearest = int(np.abs(here @ q).argmax())
        assert abs(here[nearest] @ q) > 1.0 - 1e-5
        assert listed.indices[k, nearest] == 0
        assert np.abs(listed.translations[k, nearest] - ends.translations[k]).max() < 1e-2


def test_progress_and_threads_change_no_bit():
    bodies = bodies_on_springs(SOURCES, TARGETS, normals=NORMALS)
    told = list[tuple[int, int]]()

    def tell(*done: int) -> None:
        told.append((done[0], done[1]))

    one = simulate_many(bodies, settings=SimulationSettings(threads=1), progress=tell)
    two = simulate_many(bodies, settings=SimulationSettings(threads=2))

    assert told == [(COUNT, COUNT)]
    assert one.states.tobytes() == two.states.tobytes()
    assert (
        bodies.starts.tobytes()
        == bodies_on_springs(SOURCES, TARGETS, normals=NORMALS).starts.tobytes()
    )


def test_explicit_euler_is_refused_of_many():
    bodies = bodies_on_springs(SOURCES, TARGETS, normals=NORMALS)
    with pytest.raises(InvalidProblemError, match="'euler' is for one weight per pair alone"):
        simulate_many(bodies, "euler")


def test_a_collinear_source_and_a_wrong_damping_are_refused_by_name():
    line: Any = np.arange(20.0)[:, np.newaxis] * np.ones(3)
    sources = SOURCES.copy()
    sources[1] = line
    with pytest.raises(DegenerateProblemError, match="instance 1: the source points are") as caught:
        bodies_on_springs(sources, TARGETS, normals=NORMALS)
    assert caught.value.instance == 1
    with pytest.raises(InvalidProblemError, match="damping"):
        bodies_on_springs(SOURCES, TARGETS, normals=NORMALS, damping=-1.0)
