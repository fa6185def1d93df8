"""An error carries what its words say: which array, row, instance, what stands there, which limit.

Values and limits are beside each other where errors are raised: nothing else sees them exchanged.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from strategies import AXES, LINE, random_problem

from certreg.dynamics.batch import bodies_of, simulate_many
from certreg.dynamics.body import SMALLEST_BARRIER, SMALLEST_INERTIA, basins_of, certified_basin
from certreg.dynamics.integrators import SimulationSettings
from certreg.dynamics.rigid import rigid_body
from certreg.dynamics.simulation import optimal_damping, simulate
from certreg.equilibrium.batch import solve_many
from certreg.errors import DegenerateProblemError, InvalidProblemError
from certreg.native.loops import Integrator
from certreg.objective.isotropic import Isotropic
from certreg.problem.budget import checked_threads
from certreg.problem.moments import exact_moments, moments_of_clouds
from certreg.problem.problem import RegistrationProblem
from certreg.problem.random_instances import gaussian_instances

if TYPE_CHECKING:
    from collections.abc import Callable

POINTS = np.array(AXES)  # six
MANY = np.stack([POINTS] * 4)
FLAT = np.stack([POINTS, POINTS, *[np.linspace(-1, 1, 6)[:, None] * [1.0, 2.0, 3.0]] * 2])
WEAK = (1e150 * POINTS, 1e-290 * POINTS @ np.diag([1.0, -1.0, -1.0]))
STIFF = np.array([1.0, 1.0, 1e6, 2e6])[:, None, None] * POINTS


def changed(array: np.ndarray, place: Any, value: float) -> np.ndarray:
    array = array.copy()
    array[place] = value
    return array


def objective_of(source: Any, target: Any) -> Isotropic:
    return Isotropic(exact_moments(RegistrationProblem(source, target)))


INVALID: list[tuple[Callable[[], Any], dict[str, Any]]] = [
    (lambda: RegistrationProblem(POINTS[:5], POINTS), {"array": "target", "value": 6, "limit": 5}),
    (lambda: RegistrationProblem(POINTS[:0], POINTS), {"array": "source", "value": 0, "limit": 1}),
    (lambda: RegistrationProblem(POINTS.T, POINTS), {"array": "source", "value": (3, 6)}),
    (
        lambda: RegistrationProblem(POINTS, POINTS, weights=[1.0, 2.0]),
        {"array": "weights", "value": (2,), "limit": (6,)},
    ),
    (
        lambda: RegistrationProblem(POINTS, POINTS, weights=changed(np.ones(6), 4, -2.0)),
        {"array": "weights", "row": 4, "value": -2.0, "limit": 0.0},
    ),
    (
        lambda: RegistrationProblem(POINTS, POINTS, sigma=changed(np.ones(6), 4, -2.0)),
        {"array": "sigma", "row": 4, "value": -2.0, "limit": 0.0},
    ),
    (
        lambda: RegistrationProblem(POINTS, POINTS, sigma=-2.0),
        {"array": "sigma", "row": None, "value": -2.0, "limit": 0.0},
    ),
    (
        lambda: RegistrationProblem(POINTS, POINTS, sigma=1e-170),
        {"array": "sigma", "row": None, "value": 1e-170},
    ),
    (
        lambda: RegistrationProblem(POINTS, POINTS, weights=np.zeros(6)),
        {"array": "weights", "row": None, "value": 0.0},
    ),
    (
        lambda: RegistrationProblem(POINTS, POINTS, damping=-3.0),
        {"array": "damping", "value": -3.0, "limit": (1e-150, 1e150)},
    ),
    (lambda: checked_threads(0), {"array": "threads", "value": 0, "limit": 1}),
    (
        lambda: moments_of_clouds(POINTS, POINTS, changed(np.ones(6), 3, -2.0)),
        {"array": "weights", "row": 3, "value": -2.0, "limit": 0.0},
    ),
    (
        lambda: moments_of_clouds(POINTS, changed(POINTS, 3, np.inf)),
        {"array": "target", "row": 3, "value": [np.inf] * 3, "limit": None},
    ),
    (lambda: moments_of_clouds(POINTS, POINTS, np.zeros(6)), {"array": "weights", "value": 0.0}),
    (
        lambda: gaussian_instances(np.random.default_rng(0), points=0),
        {"array": "points", "value": 0},
    ),
    (
        lambda: gaussian_instances(np.random.default_rng(0), count=-2),
        {"array": "count", "value": -2},
    ),
    (
        lambda: gaussian_instances(np.random.default_rng(0), sigma=-0.5),
        {"array": "sigma", "value": -0.5},
    ),
    (lambda: solve_many(MANY, POINTS[:5]), {"array": "targets", "value": 5, "limit": 6}),
    (lambda: solve_many(MANY, MANY[:3]), {"array": "targets", "value": 3, "limit": 4}),
    (lambda: solve_many(MANY[:, :0], MANY), {"array": "sources", "value": (4, 0, 3)}),
    (
        lambda: solve_many(MANY, MANY, weights=np.ones(5)),
        {"array": "weights", "value": (1, 5)},
    ),
    (
        lambda: solve_many(MANY, MANY, weights=changed(np.ones((4, 6)), (2, 1), -1.0)),
        {"array": "weights", "instance": 2, "limit": 0.0},
    ),
    (
        lambda: solve_many(MANY, changed(MANY, (2, 1), np.nan)),
        {"array": "targets", "instance": 2, "row": 1, "value": [np.nan] * 3},
    ),
]


@pytest.mark.parametrize(("call", "carried"), INVALID)
def test_what_states_no_problem_is_carried_by_the_error(call, carried):
    with pytest.raises(InvalidProblemError) as refusal:
        call()
    for name, value in carried.items():
        assert repr(getattr(refusal.value, name)) == repr(value), name


@pytest.mark.parametrize(
    ("call", "limit", "instance"),
    [
        (lambda: bodies_of(FLAT, MANY), SMALLEST_INERTIA, 2),
        (
            lambda: rigid_body(objective_of(POINTS * [1.0, 1e-9, 1e-9], POINTS).moments, 2.0),
            SMALLEST_INERTIA,
            None,
        ),
        (lambda: certified_basin(objective_of(*WEAK), 500), SMALLEST_BARRIER, None),
        (
            lambda: simulate_many(bodies_of(MANY, STIFF), Integrator.EULER),
            SimulationSettings().least_step,
            2,
        ),
    ],
)
def test_a_number_that_is_too_small_is_carried_beside_its_limit(call, limit, instance):
    with pytest.raises(DegenerateProblemError) as refusal:
        call()
    error: Any = refusal.value

    assert (error.limit, error.instance) == (limit, instance)
    assert error.value < limit
    assert type(error.value) is float


def test_the_least_of_the_gaps_is_carried():
    weak = np.diag([1.0, 1e-150, 3e-150])
    weak = np.vstack([weak, -weak])  # gaps of the order of 1e-300, 1e-300 and 1
    with pytest.raises(DegenerateProblemError) as refusal:
        certified_basin(objective_of(weak, weak), 0)
    error: Any = refusal.value

    assert 0.0 < error.value < 1e-298


def test_an_instance_whose_springs_are_too_weak_is_carried():
    values = np.array([[1.0, 0.0, -0.5, -0.5]] * 3)
    unit = np.array([1.0, 0.5, 0.4])[:, None] * [[1.0], *[[SMALLEST_BARRIER]] * 2]
    with pytest.raises(DegenerateProblemError) as refusal:
        basins_of(np.array([np.eye(4)] * 3), values, unit)
    error = refusal.value

    assert (error.instance, error.limit) == (1, SMALLEST_BARRIER)


@pytest.mark.parametrize(("source", "rank"), [(LINE, 1), ([[1.0, 2.0, 3.0]] * 4, 0), (AXES[:4], 2)])
def test_the_rank_of_the_source_is_carried(source, rank):
    target = np.ones((4, 3)) if rank == 2 else np.array(AXES[:4])
    objective = objective_of(source, target)
    calls: list[Callable[[], Any]] = [lambda: optimal_damping(objective)]
    if rank < 2:
        calls.append(lambda: simulate(objective, 2.0))
    for call in calls:
        with pytest.raises(DegenerateProblemError) as refusal:
            call()
        assert refusal.value.rank == rank


def test_the_damping_under_which_energy_grows_is_carried():
    objective = Isotropic(exact_moments(random_problem(np.random.default_rng(2))))
    start = np.concatenate([np.zeros(3), np.eye(3).ravel(), np.zeros(3), [1e200, 3e200, -1e200]])
    with pytest.raises(DegenerateProblemError, match="gained energy") as refusal:
        simulate(objective, 1.25, Integrator.SPLITTING, start=start)
    assert refusal.value.value == 1.25


@pytest.mark.parametrize(
    ("setting", "value", "words"),
    [
        ("step", 0.0, "step is 0.0: give a finite number above 0"),
        ("step", np.inf, "step is inf: give a finite number above 0"),
        ("speed_tolerance", -1.0, "speed_tolerance is -1.0: give a finite number, 0 or more"),
        ("least_step", np.nan, "least_step is nan: give a finite number, 0 or more"),
        ("max_steps", -1, "max_steps is -1: give a whole number from 0 on"),
        ("threads", 0, "threads is 0: give a whole number from 1 on"),
        ("max_steps", 2**53 + 1, f"max_steps is {2**53 + 1}: give a whole number from 0 on"),
    ],
)
def test_a_setting_that_is_none_is_named_with_what_it_takes(setting, value, words):
    with pytest.raises(ValueError, match=f"^{words}$"):
        SimulationSettings(**{setting: value})
