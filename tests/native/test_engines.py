"""What either engine does with a slow body, a full log, a fast spin: beside definitions."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from engines import engine
from strategies import ZOO, random_rotation

from certreg.dynamics.batch import bodies_of
from certreg.dynamics.body import certified_basin
from certreg.dynamics.integrators import SimulationSettings, step_parameters
from certreg.dynamics.rigid import rigid_body
from certreg.equilibrium import batch as instances
from certreg.geometry.so3 import body_frame, rotation_matrix
from certreg.native import loops
from certreg.native.engine import evaluator
from certreg.native.layout import named, plain
from certreg.native.stationary import SHAPES
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments

if TYPE_CHECKING:
    from certreg.dynamics.batch import Bodies

KICK = 0.3  # radians
SLOW = replace(SimulationSettings(first_perturbation=KICK, max_steps=0).rules, speed_tolerance=1e6)
each_machine = pytest.mark.parametrize("machine", ["compiled", "evaluator"])
each_integrator = pytest.mark.parametrize("integrator", loops.Integrator)


@pytest.fixture(scope="module")
def bodies() -> Bodies:
    """Half of them on springs a thousandth as strong."""
    rng = np.random.default_rng(3)
    sources = rng.normal(size=(10, 12, 3))
    turns = np.array([random_rotation(rng) for _ in sources])
    targets = sources @ turns.mT + 0.3 * rng.normal(size=sources.shape)
    targets[::2] *= 1e-3
    return bodies_of(sources, targets)


def released(
    bodies: Bodies, integrator: loops.Integrator, q: np.ndarray, omega: Any = 0.0
) -> loops.Batch:
    """The bodies at quaternions (count, 4), with angular velocities."""
    states = np.zeros(len(q), dtype=integrator.state)
    states["omega"] = omega
    if integrator is loops.Integrator.EULER:
        states["R"] = [rotation_matrix(one) for one in q.tolist()]
    else:
        states["q"] = q
    settings = SimulationSettings()
    return loops.Batch.of(
        integrator,
        bodies=bodies.records,
        basins=bodies.basins,
        steps=step_parameters(integrator, bodies.records, bodies.basins, settings),
        states=states,
    )


def turned(q: np.ndarray, axes: np.ndarray, angles: Any) -> np.ndarray:
    """Quaternions after turns by angle vectors in the body frame."""
    half = np.broadcast_to(angles, len(q)) / 2
    return np.array(
        [
            math.cos(a) * p + math.sin(a) * np.array(body_frame(p)) @ axis
            for p, axis, a in zip(q, axes, half, strict=True)
        ]
    )


def rotations(batch: loops.Batch) -> np.ndarray:
    if batch.integrator is loops.Integrator.EULER:
        return batch.states["R"]
    return np.array([rotation_matrix(q) for q in batch.states["q"]])


def ways_down(bodies: Bodies, index: int) -> tuple[np.ndarray, np.ndarray]:
    """Saddles (count, 4) and unit axes (count, 3) to the optimum, largest entries positive."""
    q = bodies.basins["quaternions"][:, index]
    best = bodies.basins["quaternions"][:, 0]
    axes = np.array([np.array(body_frame(p)).T @ b for p, b in zip(q, best, strict=True)])
    largest = np.take_along_axis(axes, np.abs(axes).argmax(axis=1)[:, None], axis=1)
    return q, axes * np.sign(largest)


def torque_over_curvature(bodies: Bodies, q: np.ndarray, axis: np.ndarray, k: int) -> float:
    """The largest entry of the torque over that of the Hessian at body k turned from q."""
    state = np.zeros((), dtype=loops.Integrator.SPLITTING.state)
    state["q"] = q
    name = "certreg_quaternion_curvature"
    hessian, torque = evaluator().evaluate(name, plain(state), plain(bodies.records[k]))
    assert np.abs(np.cross(torque, axis)).max() <= 1e-6 * np.abs(hessian).max()
    return float(np.abs(torque).max() / np.abs(hessian).max())


@pytest.mark.one_in(4)
@each_machine
@each_integrator
@pytest.mark.parametrize("index", [1, 2, 3])
def test_a_body_on_a_saddle_is_turned_towards_the_optimum(machine, integrator, index, bodies):
    q, axes = ways_down(bodies, index)
    batch = released(bodies, integrator, q)
    engine(machine).run(batch, SLOW)
    expected = [rotation_matrix(p.tolist()) for p in turned(q, axes, KICK)]

    assert (batch.escapes == 1).all()
    assert (batch.status == loops.Ending.OUT_OF_STEPS).all()
    assert np.abs(rotations(batch) - expected).max() < 1e-12


@pytest.mark.one_in(4)
@each_machine
@each_integrator
@pytest.mark.parametrize(("share", "heard"), [(1 / 3, False), (3.0, True)])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_torque_above_its_rounding_chooses_the_side(
    machine, integrator, share, heard, side, bodies
):
    q, axes = ways_down(bodies, 2)
    beside = []
    for k, (p, axis) in enumerate(zip(q, axes, strict=True)):
        off = turned(p[None], axis[None], 1e-6)[0]
        angle = 1e-6 * share * 1e-12 / torque_over_curvature(bodies, off, axis, k)
        beside.append(turned(p[None], axis[None], side * angle)[0])
    batch = released(bodies, integrator, np.array(beside))
    engine(machine).run(batch, SLOW)
    expected = turned(q, axes, (side if heard else 1.0) * KICK)

    assert np.abs(rotations(batch) - [rotation_matrix(p) for p in expected]).max() < 1e-10


@pytest.mark.one_in(4)
@each_machine
@each_integrator
@pytest.mark.parametrize(("share", "kicked"), [(0.98, True), (1.02, False)])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_body_is_off_a_saddle_where_the_torque_is_a_share_of_the_curvature(
    machine, integrator, share, kicked, side, bodies
):
    q, axes = ways_down(bodies, 3)
    beside = []
    for k, (p, axis) in enumerate(zip(q, axes, strict=True)):
        angle = 0.05
        for _ in range(6):  # the ratio is nearly proportional to the angle
            off = turned(p[None], axis[None], angle)[0]
            angle *= share * loops.STALLED_TORQUE / torque_over_curvature(bodies, off, axis, k)
        beside.append(turned(p[None], axis[None], side * angle)[0])
    batch = released(bodies, integrator, np.array(beside))
    engine(machine).run(batch, SLOW)

    assert (batch.escapes == kicked).all()


@pytest.mark.one_in(3)
@each_integrator
def test_steps_and_kicks_from_a_saddle_are_counted_alike(integrator, bodies):
    """In lanes, alone and in Python; what stands in the counters before is of no account."""
    q, _ = ways_down(bodies, 2)
    rules = SimulationSettings(max_steps=25).rules
    lanes, alone, python = (released(bodies, integrator, q) for _ in range(3))
    lanes.escapes[:], lanes.taken[:], lanes.status[:], lanes.times[:] = 7, 7, 3, 7.0
    engine("compiled").run(lanes, rules)
    for k in range(len(q)):
        engine("compiled").run(alone.part(slice(k, k + 1)), rules)
    engine("evaluator").run(python, rules)

    assert (python.escapes > 0).all()
    for other in (lanes, alone):
        for name in ("escapes", "taken", "status"):
            assert np.array_equal(getattr(other, name), getattr(python, name)), name
        assert np.allclose(other.times, python.times, rtol=1e-12)
        assert np.allclose(plain(other.states), plain(python.states), rtol=0.0, atol=1e-9)


@each_integrator
def test_no_body_is_given_more_steps_than_there_are_whatever_lane_it_takes(integrator):
    rng = np.random.default_rng(8)
    source = rng.normal(size=(60, 5, 3)) * rng.uniform(0.2, 1.0, (60, 1, 3))
    target = source @ random_rotation(rng).T + 0.3 * rng.normal(size=source.shape)
    many = bodies_of(source, target)
    whole, cut = (released(many, integrator, many.starts["q"]) for _ in range(2))
    engine("compiled").run(whole, SimulationSettings(max_steps=20_000).rules)
    most = int(np.median(whole.taken))
    engine("compiled").run(cut, SimulationSettings(max_steps=most).rules)

    assert np.array_equal(cut.taken, np.minimum(whole.taken, most))
    ended = whole.taken <= most
    assert np.array_equal(cut.status, np.where(ended, whole.status, loops.Ending.OUT_OF_STEPS))


@each_machine
def test_arguments_of_other_sizes_are_refused(machine):
    state, body = np.ones(18), np.ones(23)
    run = engine(machine)
    assert run.evaluate("certreg_rate", state, body)[0].shape == (18,)
    for wrong in ((body, state), (state, body[:-1]), (state,)):
        with pytest.raises(ValueError, match="numbers, not"):
            run.evaluate("certreg_rate", *wrong)
    for size in (17, 19, 36):
        with pytest.raises(ValueError, match=r"expected \(\.\.\., 18\)"):
            named(np.ones(size), loops.MATRIX_STATE)


def test_a_batch_of_records_that_are_not_as_many_is_refused():
    moving = [np.zeros(n, dtype=loops.MATRIX_STATE) for n in (2, 3)]
    parts: dict[str, Any] = {
        "bodies": np.zeros(2, dtype=loops.BODY),
        "basins": np.zeros(2, dtype=loops.BASIN),
        "steps": np.zeros(2, dtype=loops.STEP),
    }
    kept = loops.Batch.of(loops.Integrator.EULER, **parts, states=moving[0])
    kept.states["c"] = 1.0

    assert not moving[0]["c"].any()  # a copy
    with pytest.raises(ValueError, match="states are"):
        loops.Batch.of(loops.Integrator.EULER, **parts, states=moving[1])


def test_a_log_that_is_cleared_is_as_new():
    log = loops.Log.of_capacity(8, loops.Integrator.EULER.sample)
    log.count, log.stride = 7, 4
    log.clear()

    assert (log.count, log.stride, len(log.samples)) == (0, 1, 0)


@each_integrator
def test_more_threads_than_bodies_change_nothing(integrator, bodies):
    q = bodies.basins["quaternions"][:, 1]
    few, many = (released(bodies, integrator, q).part(slice(0, 2)) for _ in range(2))
    engine("compiled").run(few, SimulationSettings(max_steps=9).rules)
    engine("compiled").run(many, SimulationSettings(max_steps=9, threads=5).rules)

    assert np.array_equal(few.states, many.states)
    assert np.array_equal(few.taken, many.taken)


@each_machine
@each_integrator
def test_a_body_that_spins_in_a_valley_is_not_turned(machine, integrator, bodies):
    q = bodies.basins["quaternions"][:, 0]
    batch = released(bodies, integrator, q, omega=10.0)
    engine(machine).run(batch, SLOW)

    assert (batch.escapes == 0).all()
    assert (batch.status == loops.Ending.OUT_OF_STEPS).all()


@each_machine
@each_integrator
def test_rest_at_the_optimum_is_converged_only_where_it_is_unique(machine, integrator):
    for specimen in ZOO:
        objective = Isotropic(exact_moments(specimen.problem))
        if not objective.classification.inertia_definite:
            continue
        moving = rigid_body(objective.moments, 2.0)
        basin = certified_basin(objective, moving.length_exponent)
        one = type("One", (), {"records": moving.record[None], "basins": basin.record[None]})
        batch = released(one, integrator, basin.optimum[None])  # type: ignore[arg-type]
        engine(machine).run(batch, SLOW)
        unique = specimen.pattern[0] == 1

        assert batch.status[0] == (loops.Ending.CONVERGED if unique else loops.Ending.AT_REST)


def test_the_share_of_the_basin_is_below_what_a_certificate_proves():
    assert loops.BASIN_SHARE < 0.5


@each_machine
@each_integrator
@pytest.mark.parametrize("capacity", [2, 3, 4, 5, 8, 30])
def test_a_full_log_keeps_every_second_sample(machine, integrator, capacity, bodies):
    batch = released(bodies, integrator, bodies.starts["q"]).part(slice(1, 2))
    log, steps = loops.Log.of_capacity(capacity, integrator.sample), 21
    batch.steps["h"] = np.minimum(batch.steps["h"], 0.1)  # no midpoint step of that is halved
    engine(machine).run(batch, replace(SLOW, speed_tolerance=0.0, max_steps=steps), log)
    stride = next(2**k for k in range(9) if steps // 2**k < capacity)
    count = steps // stride + 1
    h = batch.steps["h"][0]

    assert (log.stride, log.count) == (stride, count)
    assert log.samples["time"] == pytest.approx(h * stride * np.arange(count), rel=1e-12)


@pytest.mark.parametrize("spin", [1.0, 5.0, 20.0, 100.0])
def test_both_engines_halve_the_same_midpoint_steps(spin, bodies):
    ends = []
    for machine in ("compiled", "evaluator"):
        batch = released(bodies, loops.Integrator.MIDPOINT, bodies.starts["q"], omega=spin)
        batch.steps["h"] = 0.3
        engine(machine).run(batch, replace(SLOW, speed_tolerance=0.0, max_steps=3))
        ends.append(batch)
    one, other = ends

    assert one.times == pytest.approx(other.times, rel=1e-12)
    assert (one.times < 0.899).any() == (spin > 10.0)  # whose turn in a step is above two
    assert np.abs(plain(one.states) - plain(other.states)).max() < 1e-9 * spin


@pytest.mark.parametrize("offset", [0.0, 30.0])
@pytest.mark.parametrize("size", [1.0, 1e5])
def test_both_engines_say_the_same_of_stationary_poses(offset, size):
    rng = np.random.default_rng(8)
    sources = rng.normal(size=(13, 9, 3)) + offset
    targets = size * (sources @ random_rotation(rng).T + 0.2 * rng.normal(size=sources.shape))
    weights = rng.uniform(0.1, 4.0, size=(13, 9))
    given = instances.clouds(sources, targets, weights)
    one, other = (engine(name).stationary_poses(given) for name in ("compiled", "evaluator"))

    assert (one.exponents == other.exponents).all()
    for name in SHAPES:
        mine, theirs = getattr(one, name), getattr(other, name)
        if name != "residual":
            assert np.abs(mine - theirs).max() <= 1e-11 * np.abs(theirs).max(), name
    for name in ("means", "spreads"):
        mine, theirs = getattr(one, name), getattr(other, name)
        for part in mine.dtype.names:
            assert mine[part] == pytest.approx(theirs[part], rel=1e-11), part
    shares = weights / weights.sum(axis=1, keepdims=True)
    centred = targets - (shares[:, None] @ targets)
    square = (shares * (centred**2).sum(axis=2)).sum(axis=1)
    unit = 4.0 ** one.exponents[:, 1]
    assert unit * one.spreads["centred_target"] == pytest.approx(square, rel=1e-9)


@each_machine
@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_of_a_problem_that_is_not_finite_nothing_is_a_number_and_the_others_stay(machine, bad):
    rng = np.random.default_rng(5)
    sources, targets = rng.normal(size=(2, 3, 6, 3))
    sound = engine(machine).stationary_poses(instances.clouds(sources, targets, None))
    sources[1, 2, 0] = bad
    found = engine(machine).stationary_poses(instances.clouds(sources, targets, None))

    for name in ("values", "vectors", "residual", "ratios", "translations", "rmse"):
        assert np.isnan(getattr(found, name)[1]).all(), name
        for k in (0, 2):
            assert (getattr(found, name)[k] == getattr(sound, name)[k]).all(), name


@each_machine
@pytest.mark.parametrize("axis", range(3))
def test_a_source_on_an_axis_has_no_ratios(machine, axis):
    sources = np.zeros((1, 5, 3))
    sources[0, :, axis] = [-2.0, -1.0, 0.0, 1.0, 2.0]
    targets = np.random.default_rng(1).normal(size=(1, 5, 3))
    found = engine(machine).stationary_poses(instances.clouds(sources, targets, None))

    assert np.isnan(found.ratios).all()
    assert np.isfinite(found.values).all()
