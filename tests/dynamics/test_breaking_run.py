"""A body on springs that break: what each stage of narrower bounds leaves of them."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from wrong_pairs import wrong_pairs

from certreg.dynamics import breaking
from certreg.dynamics.breaking import BreakingRun, BreakingStatus, run_breaking
from certreg.errors import DegenerateProblemError
from certreg.native.loops import Integrator
from certreg.problem.bounds import bounded
from certreg.problem.problem import RegistrationProblem
from certreg.problem.support import Loss
from certreg.registration.closed_form import register

OFFSET = 1e6  # of both clouds, apart: bounds that no spring reaches are skipped
SEEDS = (0, 1, 3, 4)


def made(seed: int, n: int = 24, wrong: float = 0.5) -> RegistrationProblem:
    pairs = wrong_pairs(np.random.default_rng(seed), n, wrong)
    weights = np.random.default_rng(seed).uniform(0.5, 2.0, n)
    problem = RegistrationProblem(pairs.source + OFFSET, pairs.target - OFFSET, weights=weights)
    return bounded(problem, 0.06, Loss.BREAKING)


def ratios(problem: RegistrationProblem, run: BreakingRun) -> np.ndarray:
    ends = problem.source @ run.rotation.T + run.translation
    return np.linalg.norm(problem.target - ends, axis=1) / problem.bounds


@pytest.mark.parametrize("seed", SEEDS)
def test_at_first_all_springs_hold_and_the_energy_never_rises(seed):
    problem = made(seed)
    run = run_breaking(problem, Integrator.MIDPOINT)
    widths = [stage.width for stage in run.stages]

    assert run.status is BreakingStatus.SETTLED
    assert run.stages[0].held.all()
    assert widths[-1] == 1.0
    steps = np.log([a / b for a, b in pairwise(widths[:-1])]) / np.log(1.4)
    np.testing.assert_allclose(steps, np.rint(steps), atol=1e-9)
    assert len(widths) < 20  # however far off the body is at first
    energies = [stage.energy for stage in run.stages]
    assert all(b <= a for a, b in pairwise(energies))
    assert run.stages[-1].energy == run.stages[-1].given_energy


@pytest.mark.parametrize("seed", SEEDS)
def test_at_the_end_the_springs_within_their_bounds_hold_at_their_least_squares_fit(seed):
    problem = made(seed)
    run = run_breaking(problem, Integrator.MIDPOINT)
    last = run.stages[-1]
    fit = register(
        *(p[last.held] for p in (problem.source, problem.target)),
        weights=problem.weights[last.held],
    )
    square = ratios(problem, run) ** 2
    expected = problem.weights * problem.bounds**2 @ np.minimum(square, 1.0)

    assert ((square <= 1.0) == last.held).all()
    np.testing.assert_allclose(run.rotation, fit.rotation, atol=2e-3)
    assert last.energy == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("width", [1.0, 3.0, 40.0])
def test_a_stage_has_the_energy_of_its_bounds_and_that_of_those_given(width: float):
    problem = made(3)
    points, annealed = problem, breaking._Annealed(problem, Integrator.MIDPOINT, None)
    _, stage = annealed.stage(width)
    ends = points.source @ annealed.rotation.T + annealed.given_translation
    lengths = np.linalg.norm(points.target - ends, axis=1)
    clipped, given = (
        float(points.weights @ np.minimum(lengths, most) ** 2)
        for most in (width * problem.bounds, problem.bounds)
    )

    assert stage.energy == pytest.approx(clipped, rel=1e-6)
    assert stage.given_energy == pytest.approx(given, rel=1e-6)
    assert (given < clipped) == (width > 1.0)


def test_steps_and_time_are_those_of_all_motions_so_far(monkeypatch):
    runs = list[Any]()
    simulate = breaking.simulate

    def watched(*given: Any, **options: Any) -> Any:
        runs.append(simulate(*given, **options))
        return runs[-1]

    monkeypatch.setattr(breaking, "simulate", watched)
    stages = run_breaking(made(3), Integrator.MIDPOINT).stages
    ends = np.cumsum([stage.rounds for stage in stages])

    assert len(runs) == ends[-1] > 2
    for stage, end in zip(stages, ends.tolist(), strict=True):
        assert stage.steps == sum(run.steps for run in runs[:end])
        assert stage.time == pytest.approx(sum(float(run.times[-1]) for run in runs[:end]))


def test_springs_may_mend():
    """A spring that broke while the body was far off is within its bound later."""
    run = run_breaking(made(21), Integrator.MIDPOINT)
    held = np.array([stage.held for stage in run.stages])

    assert (held[1:] & ~held[:-1]).any()


def test_when_the_rounds_run_out_it_is_unsettled(monkeypatch):
    monkeypatch.setattr(breaking, "MOST_ROUNDS", 0)
    run = run_breaking(made(0), Integrator.MIDPOINT)

    assert run.status is BreakingStatus.UNSETTLED
    assert len(run.stages) == 1


@pytest.mark.slow
def test_weak_bounds_at_once_are_no_annealing():
    """With a huge factor the bounds jump to those given: fewer springs are saved than by steps."""
    slow, fast = (
        sum(
            run_breaking(made(seed), Integrator.MIDPOINT, shrinking=factor).stages[-1].count >= 12
            for seed in range(8)
        )
        for factor in (1.4, 1e6)
    )

    assert slow > fast


@pytest.mark.parametrize("exponent", [-900, -500, 500, 900])
def test_a_run_is_the_same_in_every_unit(exponent):
    pairs = wrong_pairs(np.random.default_rng(4), 16, 0.25)
    usual, scaled = (
        run_breaking(
            bounded(
                RegistrationProblem(np.ldexp(pairs.source, k), np.ldexp(pairs.target, k)),
                np.ldexp(pairs.bounds, k),
                Loss.BREAKING,
            ),
            Integrator.MIDPOINT,
        )
        for k in (0, exponent)
    )

    assert usual.status is BreakingStatus.SETTLED
    assert (usual.rotation == scaled.rotation).all()
    assert (np.ldexp(usual.translation, exponent) == scaled.translation).all()
    assert [s.held.tolist() for s in usual.stages] == [s.held.tolist() for s in scaled.stages]
    with np.errstate(over="ignore"):
        expected = np.ldexp([stage.energy for stage in usual.stages], 2 * exponent)
    assert [stage.energy for stage in scaled.stages] == expected.tolist()


def test_a_source_on_a_line_and_bounds_of_no_size_are_refused():
    line = [[0, 0, 0], [1, 0, 0], [2, 0, 0]]
    corner = [[0, 0, 0], [1, 0, 0], [0, 2, 0]]
    for source, bound, words in (
        (line, 1.0, "the source points are collinear"),
        (corner[:2], 1.0, "the source points are collinear"),
        (corner, 1e-101, "a bound is so small beside the clouds"),
    ):
        problem = bounded(RegistrationProblem(source, source), bound, Loss.BREAKING)
        with pytest.raises(DegenerateProblemError, match=words):
            run_breaking(problem, Integrator.MIDPOINT)
