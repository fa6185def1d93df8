"""How high a slow body is above the optimum, as the loops see it: beside the definition.

The height is l1 - q^T K q + omega^T J omega / 4 over the mass; a body may stop where it is below a
share of l1 - l2. States just inside and just outside, whatever part of the height is motion.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from engines import engine
from scipy.spatial.transform import Rotation
from strategies import random_problem

from certreg.dynamics.body import certified_basin
from certreg.dynamics.integrators import SimulationSettings
from certreg.dynamics.rigid import rigid_body
from certreg.native import loops
from certreg.native.layout import named, width
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments

SHARE = 0.3  # of the barrier, for these tests: below BASIN_SHARE
MARGIN = 1e-9  # of the height: on which side a state is
RULES = replace(SimulationSettings(max_steps=0).rules, speed_tolerance=1e6, rest_share=SHARE)


def davenport(C: np.ndarray) -> np.ndarray:
    z = np.array([C[2, 1] - C[1, 2], C[0, 2] - C[2, 0], C[1, 0] - C[0, 1]])
    lower = C + C.T - np.trace(C) * np.eye(3)
    return np.block([[np.array([[np.trace(C)]]), z[None]], [z[:, None], lower]])


def ended(
    machine: loops.Engine, integrator: loops.Integrator, body: Any, basin: Any, state: Any
) -> loops.Ending:
    """How a run of no steps ends from a state (18,) that counts as slow."""
    batch = loops.Batch.of(
        integrator,
        bodies=body.record.reshape(1),
        basins=basin.record.reshape(1),
        steps=named(np.full((1, width(integrator.step)), 0.1), integrator.step),
        states=body.stated(state, integrator),
    )
    machine.run(batch, RULES)
    return loops.Ending(int(batch.status[0]))


@pytest.mark.parametrize("moving", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("integrator", loops.Integrator)
@pytest.mark.parametrize("name", ["compiled", "evaluator"])
def test_a_slow_body_may_stop_below_a_share_of_the_barrier_and_not_above(name, integrator, moving):
    rng = np.random.default_rng(16)
    problem = random_problem(rng, noise=0.3, decades=2.0)
    objective = Isotropic(exact_moments(problem))
    body = rigid_body(objective.moments, problem.damping)
    basin = certified_basin(objective, body.length_exponent)
    unit, mass = 2.0**body.length_exponent, problem.weights.sum()
    x, y = (
        (points - problem.weights @ points / mass) / unit
        for points in (problem.source, problem.target)
    )
    S = np.einsum("i,ij,ik->jk", problem.weights, x, x) / mass
    K = davenport(np.einsum("i,ij,ik->jk", problem.weights, y, x) / mass)
    values, vectors = np.linalg.eigh(K)
    omega = rng.normal(size=3)
    quarter = omega @ (np.trace(S) * np.eye(3) - S) @ omega / 4

    ends: list[loops.Ending] = []
    for side in (1 - MARGIN, 1 + MARGIN):
        height = side * SHARE * (values[-1] - values[-2])
        sine = np.sqrt((1 - moving) * height / (values[-1] - values[0]))  # of half the angle
        q = np.sqrt(1 - sine * sine) * vectors[:, -1] + sine * vectors[:, 0]
        R = Rotation.from_quat(q, scalar_first=True).as_matrix()
        spin = omega * np.sqrt(moving * height / quarter)
        state = np.concatenate([np.zeros(3), R.ravel(), np.zeros(3), spin])
        ends.append(ended(engine(name), integrator, body, basin, state))
    assert ends == [loops.Ending.CONVERGED, loops.Ending.OUT_OF_STEPS]
