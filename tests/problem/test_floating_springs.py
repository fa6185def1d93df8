"""The moments of general springs in doubles: near the exact ones, whatever offset and scale."""

from __future__ import annotations

import numpy as np
import pytest

from certreg.exact.dyadic import power_of_two
from certreg.native.library import library_if_any
from certreg.objective.springs import Springs
from certreg.problem import floating_stiffness
from certreg.problem.floating_stiffness import floating_spring_moments
from certreg.problem.problem import RegistrationProblem

ROUNDING = 1e-12  # of the largest entry of the form; 1000 points


def problem_of(n=1000, *, scale=1.0, stiff=1.0, offset=0.0, seed=3):
    rng = np.random.default_rng(seed)
    source, target = (scale * (rng.normal(size=(n, 3)) + offset) for _ in range(2))
    return RegistrationProblem(source, target, factors=stiff * rng.normal(size=(n, 6)))


def worst_entry(problem):
    """The largest difference of both forms, over the largest entry of the exact one."""
    found = floating_spring_moments(problem)
    objective = Springs.of(problem)
    one = max(abs(entry) for row in objective.form() for entry in row)
    exact = np.array([[entry / one for entry in row] for row in objective.form()])
    own = power_of_two(found.weight_exponent + 2 * found.length_exponent)
    worth = float(objective.unit * one / own)
    return np.abs(found.form / worth - exact).max() / np.abs(exact).max()


@pytest.mark.parametrize(
    "problem",
    [
        problem_of(),
        problem_of(7),
        problem_of(300, offset=1e4),
        problem_of(scale=1e200),
        problem_of(scale=1e-200),
        problem_of(stiff=1e-150),
        problem_of(scale=1e-150, stiff=1e150),
    ],
)
def test_the_form_is_near_the_exact_one(problem):
    assert worst_entry(problem) < ROUNDING


def test_numpy_finds_the_same(monkeypatch):
    want = floating_spring_moments(problem_of()).sums
    monkeypatch.setattr(floating_stiffness, "library_if_any", lambda: None)

    np.testing.assert_allclose(floating_spring_moments(problem_of()).sums, want, rtol=1e-9)


def test_a_few_first_points_far_from_the_rest_do_not_matter():
    problem = problem_of(2000)
    source, target = problem.source.copy(), problem.target.copy()
    source[::62] += 1e9  # all that the first origin is made of
    target[::62] -= 1e9
    factors = np.array(problem.factors)
    factors[::62] = 0.0

    assert worst_entry(RegistrationProblem(source, target, factors=factors)) < ROUNDING


@pytest.mark.skipif(library_if_any() is None, reason="nothing is compiled")
def test_one_pass_is_enough_for_most(monkeypatch):
    passes = []
    summed = floating_stiffness._summed
    monkeypatch.setattr(
        floating_stiffness, "_summed", lambda *given: passes.append(1) or summed(*given)
    )
    floating_spring_moments(problem_of(offset=1e3))

    assert len(passes) == 1
