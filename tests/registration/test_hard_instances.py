"""Hard instances as users meet them: some here, 280 in `make rates NAME=hard_instances`."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from strategies import random_problem

from benchmarks.rates.hard_instances import FAMILIES, outcome
from certreg.dynamics.integrators import SimulationSettings
from certreg.problem.problem import RegistrationProblem
from certreg.registration.exit_codes import DONE, NOT_CERTIFIED
from certreg.registration.simulation import simulate
from certreg.results import Optimality


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.__name__)
def test_what_is_certified_ends_so_and_the_simulation_converges(family):
    found = outcome(family, 0)

    assert found.sound
    assert found.converged
    assert found.status is not Optimality.NOT_CERTIFIED


def test_a_code_that_is_not_that_of_the_proof_is_seen():
    found = outcome(FAMILIES[1], 0)

    assert found.code == DONE
    assert not replace(found, code=NOT_CERTIFIED).sound
    assert not replace(found, converged=False, why="").sound


def test_where_no_damping_is_best_none_is_advised():
    """A mirrored prism: doubles do not tell the two best poses apart, and no motion would."""
    k = 7
    angles = 2 * np.pi * np.arange(k) / k
    ring = 20.0 * np.stack([np.cos(angles), np.sin(angles), np.zeros(k)], axis=1)
    source = np.vstack([ring, ring + np.array([0.0, 0.0, 400.0])])
    target = source[:, [1, 2, 0]] * np.array([1.0, 1.0, -1.0])
    few = SimulationSettings(max_steps=2000)
    stuck: Any = simulate(RegistrationProblem(source, target), "splitting", settings=few)
    slow = random_problem(np.random.default_rng(1)).damped(1e-3)
    advised: Any = simulate(slow, "splitting", settings=few)

    assert not stuck.converged
    assert not any("far from the best one" in note for note in stuck.notes)
    assert not advised.converged
    assert any("try --damping optimal" in note for note in advised.notes)
