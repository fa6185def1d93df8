"""Many problems at once: the answers of each alone, and no claim that doubles cannot make."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from strategies import ZOO, random_problem

from certreg.instances import Solutions, exactly, solve_many

if TYPE_CHECKING:
    from certreg.equilibria.components import EquilibriumSet
    from certreg.problem import RegistrationProblem


def assert_same(found: Solutions, k: int, expected: EquilibriumSet, problem: RegistrationProblem):
    """Row by row to rounding, which grows as the eigenvalues come near to each other."""
    near = 1e-13 / found.margins[k]
    size = np.ptp(problem.target, axis=0).max()
    mean_x, mean_y = (
        np.average(cloud, axis=0, weights=problem.weights)
        for cloud in (problem.source, problem.target)
    )
    reach = np.abs(mean_x).max() + np.abs(mean_y).max() + size
    assert found.eigenvalues is not None
    for row, one in enumerate(expected.components):
        assert one.eigenvalues is not None
        assert one.rmse is not None
        assert found.quaternions[k, row] == pytest.approx(one.quaternion_wxyz, abs=near)
        translation = mean_y - one.rotation @ mean_x
        assert found.translations[k, row] == pytest.approx(translation, abs=near * reach)
        assert found.rmse[k, row] == pytest.approx(one.rmse, rel=1e-12, abs=1e-13 * size)
        assert found.unstable[k, row] == one.unstable_eigenvalues == row
        assert found.eigenvalues[k, row] == pytest.approx(one.eigenvalues, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("points", [3, 4, 5, 20, 100, 10_000])
def test_many_are_solved_as_each_alone(points):
    rng = np.random.default_rng(points)
    problems = [random_problem(rng, n=points, noise=noise) for noise in (0.0, 1e-3, 0.1, 3.0)]

    found = solve_many(
        [p.source for p in problems], [p.target for p in problems], spectrum=True, damping=1.7
    )

    assert found.decided.all()
    for k, problem in enumerate(problems):
        assert_same(found, k, exactly(problem.source, problem.target, damping=1.7), problem)


@pytest.mark.parametrize("specimen", ZOO, ids=lambda specimen: specimen.name)
def test_what_is_not_generic_is_left_undecided(specimen):
    found = solve_many(specimen.source, specimen.target)

    assert found.decided.tolist() == [specimen.pattern == (1, 1, 1, 1)]
    assert (found.unstable >= 0).all() == found.decided[0]
