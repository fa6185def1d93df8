"""The body with a free scale: its equations beside sums over points, its steps, how runs end."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from certreg.dynamics.body import BreathingStatus
from certreg.dynamics.integrators import SimulationSettings
from certreg.dynamics.simulation import simulate
from certreg.dynamics.states import state_of
from certreg.dynamics.valleys import breathing_body
from certreg.equilibrium.breathing import breathing_equilibria
from certreg.equilibrium.equilibrium_set import unit_double
from certreg.errors import DegenerateProblemError
from certreg.geometry.so3 import rotation_matrix
from certreg.native.layout import BREATHING_STATE, plain
from certreg.objective.isotropic import Isotropic
from certreg.problem.problem import RegistrationProblem
from certreg.registration.simulation import never_collapses

DAMPING = 1.3


def clouds(seed: int, noise: float = 0.3, scale: float = 1.0) -> tuple[Any, Any, Any]:
    rng = np.random.default_rng(seed)
    x = rng.normal(size=(9, 3))
    y = scale * (
        Rotation.from_quat(rng.normal(size=4)).apply(x) + noise * rng.normal(size=(9, 3))
    ) + [1, 2, 3]
    return x, y, rng.uniform(0.5, 2.0, size=9)


def moved(*arguments: Any, **options: Any) -> Any:
    """The trajectory of a body with a free scale."""
    return simulate(*arguments, **options)


def objective_of(x: Any, y: Any, weights: Any = None) -> Isotropic:
    return Isotropic.of(RegistrationProblem(x, y, weights=weights, scale="asymmetric"))


def any_state(seed: int) -> Any:
    rng = np.random.default_rng(seed)
    state = np.zeros((), BREATHING_STATE)
    for part in ("c", "q", "v", "omega", "growth"):
        state[part] = rng.normal(size=state[part].shape)
    state["q"] /= np.linalg.norm(state["q"])
    state["scale"] = rng.uniform(0.3, 2.0)
    return state


def with_matrix(state: Any) -> Any:
    R = np.array(rotation_matrix(tuple(state["q"].tolist())))
    parts = (state["c"], R.ravel(), [state["scale"]], state["v"], state["omega"])
    return np.concatenate([*parts, [state["growth"]]])


@pytest.mark.parametrize("seed", range(4))
def test_the_forces_on_the_points_do_no_work_that_the_rates_leave(seed):
    x, y, w = clouds(seed)
    moving = breathing_body(objective_of(x, y, w).moments, DAMPING)
    state = any_state(seed)
    x = (x - w @ x / w.sum()) / 2.0**moving.source_exponent
    y = (y - w @ y / w.sum()) / 2.0**moving.length_exponent
    R = np.array(rotation_matrix(tuple(state["q"].tolist())))
    rates = moving.rate(with_matrix(state))
    s, p, omega = float(state["scale"]), float(state["growth"]), state["omega"]
    a, alpha, b = rates[13:16], rates[16:19], rates[19]
    spin = np.cross(omega, x)
    velocity = (s * spin + p * x) @ R.T + state["v"]
    turned = s * (np.cross(alpha, x) + np.cross(omega, spin)) + 2 * p * spin + b * x
    left = 2.0 * (y - s * x @ R.T - state["c"]) - DAMPING * velocity - (turned @ R.T + a)
    for axis in np.eye(3):
        for direction in (np.tile(axis, (9, 1)), np.cross(axis, x) @ R.T, x @ R.T):
            assert abs(np.sum(w[:, None] * left * direction)) < 1e-12 * w.sum()
    assert np.allclose(rates[:3], state["v"])
    assert rates[12] == p


@pytest.mark.parametrize("seed", range(3))
def test_the_linearisation_is_the_derivative_of_the_rates(seed):
    moving = breathing_body(objective_of(*clouds(seed)).moments, DAMPING)
    state, step, columns = any_state(seed), 1e-6, list[Any]()
    R = np.array(rotation_matrix(tuple(state["q"].tolist())))
    for k in range(14):
        ends = list[Any]()
        for sign in (1.0, -1.0):
            move = np.zeros(14)
            move[k] = sign * step
            full = with_matrix(state)
            full[:3] += move[:3]
            full[3:12] = (R @ Rotation.from_rotvec(move[3:6]).as_matrix()).ravel()
            full[12:] += move[6:]
            ends.append(moving.rate(full))
        slope = (ends[0] - ends[1]) / (2.0 * step)
        columns.append([*slope[:3], *slope[12:]])
    found = moving.jacobian(state)

    assert np.allclose(np.array(columns).T, found[[0, 1, 2, *range(6, 14)]], atol=1e-7)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("size", [0.01, 0.3, 1.0])
def test_a_step_loses_what_damping_takes_and_nothing_else(seed, size):
    settings, state = SimulationSettings(step=size, max_steps=1), any_state(seed)
    run = moved(objective_of(*clouds(seed)), DAMPING, start=state, settings=settings)
    assert run.steps == 1

    moving, after, h = run.moving, run.last, float(run.times[-1])
    ends = [total_energy(moving, each) for each in (state, after)]
    spin = [each["scale"] * each["omega"] for each in (state, after)]
    middle_v, middle_spin = (state["v"] + after["v"]) / 2.0, sum(spin) / 2.0
    breath = float(state["growth"] + after["growth"]) / 2.0
    lost = middle_v @ middle_v + middle_spin @ moving.inertia @ middle_spin
    lost += moving.size * breath**2
    assert ends[1] - ends[0] == pytest.approx(-h * DAMPING * lost, rel=1e-9, abs=1e-12)


def test_from_a_saddle_the_body_is_perturbed_and_leaves():
    source = np.array([s * row for row in np.eye(3) for s in (1.0, -1.0)])
    objective = objective_of(source, source * [4.0, 3.0, -2.0])
    found, moving = breathing_equilibria(objective), breathing_body(objective.moments, DAMPING)
    saddle = found.upright[2]
    assert saddle.scale is not None
    scale = saddle.scale / moving.unit_of_scale
    start = state_of(unit_double(objective.quaternions[saddle.component]), scale=scale)
    run = moved(objective, DAMPING, start=start)

    assert run.escapes
    assert run.scales[-1] == pytest.approx(found.upright[0].scale, rel=1e-3)


def test_a_motion_that_goes_to_the_scale_zero_stops_before_it():
    objective = objective_of(*clouds(5))
    moving = breathing_body(objective.moments, DAMPING)
    worst = unit_double(objective.quaternions[3])  # a negative eigenvalue: the springs pull through
    run = moved(objective, DAMPING, start=state_of(worst, scale=1.0))

    assert run.status is BreathingStatus.COLLAPSED
    assert (run.scales > 0.0).all()
    assert run.scales[-1] < 1e-5 * run.scales[0]
    assert total_energy(moving, run.last) >= collapse_energy(moving)


@pytest.mark.parametrize("sign", [-1, 1])
def test_a_body_that_doubles_cannot_move_is_refused(sign: int):
    x, y, w = clouds(1)
    inside, outside = (objective_of(np.ldexp(x, sign * k), y, w) for k in (254, 259))
    run = moved(inside, DAMPING)

    assert np.isfinite(run.potential).all()
    assert np.isfinite(run.scales).all()
    with pytest.raises(DegenerateProblemError, match="differ too much in size"):
        moved(outside, DAMPING)


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize("seed", range(6))
def test_with_less_energy_than_a_point_the_scale_stays_above_its_bound(seed):
    objective = objective_of(*clouds(seed, noise=1.0))
    moving = breathing_body(objective.moments, 0.05)
    values = np.linalg.eigvalsh(np.array(objective.davenport, dtype=float))
    q = np.array(unit_double(objective.quaternions[0])) + 0.5 * np.eye(4)[seed % 4]
    q /= np.linalg.norm(q)
    aligned = float(moving.energies(state_of(q, scale=1.0))["alignment"])
    start = state_of(q, scale=0.05 * aligned / moving.size)
    run = moved(objective, 0.05, start=start)
    largest = aligned_most(moving, values, objective)

    energy = float((run.potential + run.kinetic)[0])
    assert energy < collapse_energy(moving)
    least = (collapse_energy(moving) - energy) / (2.0 * largest) * moving.unit_of_scale
    assert (run.scales >= least * (1.0 - 1e-12)).all()


def total_energy(moving: Any, state: Any) -> float:
    energies = moving.energies(state)
    return float(moving.kinetic(energies) + energies["potential"])


def collapse_energy(moving: Any) -> float:
    """Syy / M, in the units of the body."""
    return float(moving.record["spread"]) - moving.size


def test_the_released_body_is_proved_to_keep_its_size_just_below_the_energy_of_a_point():
    """Of target = b times source, at scale 1: V - Syy = Sxx (1 - 2 b), plus M |shift|^2."""
    source = np.array([s * row for row in np.eye(3) for s in (1.0, -1.0)])

    for factor, proved in ((0.5, False), (np.nextafter(0.5, 1.0), True), (-1.0, False)):
        assert never_collapses(objective_of(source, factor * source)) is proved
    for shift, proved in ((1.0, False), (np.nextafter(1.0, 0.0), True)):  # Sxx = M = 6
        assert never_collapses(objective_of(source, source + np.array([shift, 0, 0]))) is proved


def aligned_most(moving: Any, values: Any, objective: Isotropic) -> float:
    """The largest eigenvalue of K over the mass, in the units of the body."""
    state = state_of(unit_double(objective.quaternions[0]), scale=1.0)
    assert values[-1] > 0.0
    return float(moving.energies(state)["alignment"])


def test_starts_and_problems_that_make_no_sense_are_refused():
    x, y, _ = clouds(0)
    with pytest.raises(ValueError, match="give one above 0"):
        moved(objective_of(x, y), 1.0, start=state_of((1, 0, 0, 0), scale=-1.0))
    line = np.outer(np.arange(9.0), [1.0, 2.0, 3.0])
    with pytest.raises(DegenerateProblemError, match="collinear"):
        moved(objective_of(line, y), 1.0)


def test_out_of_steps_is_said():
    run = moved(objective_of(*clouds(0)), DAMPING, settings=SimulationSettings(max_steps=2))

    assert run.status is BreathingStatus.OUT_OF_STEPS
    assert run.steps == 2
    assert len(plain(run.samples)) == 3
    assert "OUT_OF_STEPS" in repr(run)
