"""What the experiments make of their numbers, on numbers that are known: no two alike."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any
from unittest.mock import MagicMock

import numpy as np
import pytest
from strategies import random_problem

from certreg.paper import (
    claims,
    experiments,
    figures,
    monte_carlo,
    observations,
    verdicts,
)
from certreg.paper.experiments import descend, equilibrium_run, signs
from certreg.paper.figures import _first_rises, angle_errors, typical
from certreg.paper.monte_carlo import MonteCarlo, pieces, solved
from certreg.paper.observations import SQUARE, TRIANGLE, Setup, flipped
from certreg.problem.problem import RegistrationProblem

CLOUD: Any = [None]  # of what is not looked at


def observed(**runs: Any) -> Any:
    return SimpleNamespace(setup=Setup(damping=2.0), comparisons=[], **runs)


def of(**parts: Any) -> Any:
    return SimpleNamespace(**parts)


def problem() -> RegistrationProblem:
    return random_problem(np.random.default_rng(3)).damped(2.0)


# the claims about the motion


def test_a_later_rise_is_none_of_the_first_step():
    falling = of(first_rise=-2e-6, predicted_rise=-2e-6, rises=3)
    rising = of(first_rise=4e-6, predicted_rise=4e-6, rises=7)
    found = claims.rising_energy(observed(simulations=[rising, falling]), CLOUD)

    assert "in the first step of 1 of 2 runs, by -2 to 4 millionths" in found.words
    assert "in 3 to 7 steps of each run" in found.words
    assert not found.agrees
    assert claims.rising_energy(observed(simulations=[rising] * 2), CLOUD).agrees


@pytest.mark.parametrize(
    ("damping", "small"), [(0.0199, False), (0.0201, True), (199.9, True), (200.1, False)]
)
def test_explicit_euler_is_stable_for_the_centre_between_two_dampings(damping: float, small):
    """h = 0.01 is below mu / 2, and h mu below 2."""
    assert claims._small_step(of(setup=Setup(damping=damping))) == small


@pytest.mark.parametrize(("end", "agrees"), [(1.5, True), (4.5, False)])
def test_the_square_out_of_the_plane_is_told_from_its_start_to_its_end(monkeypatch, end, agrees):
    run = of(rotation=None, potential=np.array([4.25, end]), steps=31, stopped=True)
    monkeypatch.setattr(claims, "descend", lambda *_: run)
    monkeypatch.setattr(claims, "_off", lambda *_: 179.6)
    found = claims.out_of_the_plane(observed(), CLOUD)

    assert "after 31 steps, 180° from the optimum" in found.words
    assert found.words.endswith(f"V from 4.2500 to {end:.4f}")
    assert found.agrees == agrees


@pytest.mark.parametrize(
    ("rises", "claimed", "agrees"), [(0.5, -1.0, True), (-0.5, -1.0, False), (2.0, 1.0, False)]
)
def test_the_energy_must_rise_at_the_shear_where_a_fall_is_claimed(
    monkeypatch, rises, claimed, agrees
):
    body = of(energy_rate=lambda _: rises, dissipation=lambda _: claimed)
    monkeypatch.setattr(claims.Particles, "of", lambda _: body)
    seen = observed()
    seen.comparisons = [of(dissipation=1e-15), of(dissipation=1e-14)]

    assert claims.energy_rate(seen, CLOUD).agrees == agrees


def test_the_worst_state_is_what_a_comparison_tells():
    assert observations._difference([1.0, 2.5, 4.0], [1.0, 2.0, 4.0]) == 0.25
    assert observations._difference([np.array([3.0, 4.0])], [np.array([3.0, 0.0])]) == 4.0 / 3.0


def test_no_runs_are_none_and_not_the_papers():
    assert (Setup(runs=0).equilibrium_runs, Setup(runs=0).simulation_runs) == (0, 0)
    assert (Setup().equilibrium_runs, Setup().simulation_runs) == (50, 100)


# single runs


def test_the_least_inertia_is_a_share_in_any_unit_of_length():
    one = problem()
    larger = RegistrationProblem(one.source * 8, one.target * 8, weights=one.weights, damping=2.0)
    share = equilibrium_run(one).least_inertia
    arms = one.source - one.weights @ one.source / one.weights.sum()
    scatter = (one.weights[:, None] * arms).T @ arms
    values = np.linalg.eigvalsh(np.trace(scatter) * np.eye(3) - scatter)

    assert share == pytest.approx(values[0] / values[-1])
    assert equilibrium_run(larger).least_inertia == pytest.approx(share)


def test_an_oscillation_that_hardly_grows_is_no_zero():
    found = signs(np.array([1e-13 + 3j, 1e-13 - 3j, -5.0, 1e-13]))

    assert (found.right, found.zero, found.left) == (2, 1, 1)


def test_a_simulation_out_of_steps_did_not_diverge_and_one_beyond_the_doubles_did():
    short = descend(problem(), max_steps=3)
    wild = descend(problem().damped(1e4), max_steps=3000)

    assert (short.stopped, short.diverged) == (False, False)
    assert (wild.stopped, wild.diverged) == (False, True)


def test_rises_are_counted_of_each_energy_and_rest_is_told_by_the_rates(monkeypatch):
    real = experiments.simulate

    def faster(*arguments: Any) -> Any:
        found = replace(real(*arguments))
        vars(found)["speed"] = 1.1e-4
        return found

    monkeypatch.setattr(experiments, "simulate", faster)
    run = experiments.simulation_run(problem(), np.eye(3))
    energy, potential = run.energy, run.potential
    least = 1e-12 * energy[0]

    assert run.rises == int((np.diff(energy) > least).sum())
    assert run.potential_rises == int((np.diff(potential) > least).sum())
    assert not run.midpoint_at_rest


def test_of_two_runs_in_the_middle_the_shorter_is_typical():
    runs: Any = [of(steps=steps) for steps in (9, 5, 12, 7)]

    assert typical(runs).steps == 7
    assert typical(runs[:3]).steps == 9


def test_first_rises_are_of_the_whole_energy_though_the_potential_falls():
    potential, energy = np.array([9.0, 8, 7, 6, 5]), np.array([9.0, 10, 11, 11, 12])
    run: Any = of(potential=potential, energy=energy)

    assert _first_rises(run) == 2


def test_angles_are_drawn_by_what_and_how_they_were_measured():
    poses = [of(angle=k, half_turn_error=10 + k, arccos_angle=100 + k) for k in range(4)]
    runs: Any = [of(poses=poses)]

    assert [each.tolist() for each in angle_errors(runs).values()] == [
        [11, 12, 13],
        [79.0, 78.0, 77.0],
        [0],
        [100],
    ]


@pytest.mark.parametrize("polygon", [TRIANGLE, SQUARE], ids=lambda p: p.name)
def test_springs_that_turn_counter_clockwise_are_solid(polygon):
    panel = MagicMock()
    figures._flipped_polygon(panel, polygon)
    angle = math.radians(40.0)
    target = np.array(polygon.points(math.sqrt(3.0))) / 2.0
    source = np.array(
        flipped(polygon, tuple(map(tuple, target.tolist())), math.cos(angle), math.sin(angle))
    )
    drawn = [call.kwargs["arrowprops"]["linestyle"] for call in panel.annotate.call_args_list]
    solid = [x[0] * (y - x)[1] - x[1] * (y - x)[0] > 0 for x, y in zip(source, target, strict=True)]

    assert [line == "-" for line in drawn] == solid


# campaigns of random instances


@pytest.mark.parametrize(
    ("count", "points", "size"),
    [
        (10**7, 100, 4096),
        (10**7, 10_000, 52),
        (10**7, 10**6, 1),
        (64 * 300, 10, 300),
        (99, 10, 256),
    ],
)
def test_a_shard_is_no_larger_than_its_limits(count: int, points: int, size: int):
    assert MonteCarlo(count=count, points=points).manifest().shard_size == size


def test_no_shard_of_a_seed_is_one_of_another_seed():
    first, second = (MonteCarlo(count=600, points=3, seed=seed).manifest() for seed in (0, 1))
    (_, here), (_, there) = (next(iter(pieces(*which))) for which in ((first, 1), (second, 0)))

    assert not np.isclose(here.sources[0], there.sources[0]).any()


def test_exceptions_are_certified_under_the_damping_of_the_campaign(monkeypatch):
    """Two points are on a line: doubles decide nothing."""
    dampings = list[float]()
    real = monte_carlo.certify

    def noted(problem: RegistrationProblem, **options: Any) -> Any:
        dampings.append(problem.damping)
        return real(problem, **options)

    monkeypatch.setattr(monte_carlo, "certify", noted)
    solved(manifest=MonteCarlo(count=2, points=2, damping=0.75).manifest(), shard=0)

    assert dampings == [0.75, 0.75]


def test_weights_of_a_counterexample_are_integers_in_their_own_unit():
    cloud = of(
        source=[[0.5, 0, 0], [0, 1, 0], [0, 0, 1]],
        target=[[0.25, 0, 0], [0, 1, 0], [0, 0, 1]],
        weights=[1, 2, 3],
    )
    made = verdicts.in_integers(cloud)

    assert made.weights.tolist() == [1.0, 2.0, 3.0]
    assert made.source[0, 0] == 2.0
    assert made.target[0, 0] == 1.0
