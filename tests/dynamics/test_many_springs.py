"""Many bodies on general springs: each ends where it does by itself."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import spring_families

from certreg import RegistrationProblem, bodies_on_springs, simulate_many, solve_many_springs
from certreg.dynamics.integrators import SimulationSettings
from certreg.dynamics.simulation import simulate
from certreg.errors import DegenerateProblemError, InvalidProblemError
from certreg.native.loops import Integrator
from certreg.objective.springs import Springs

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


def test_explicit_euler_is_refused():
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
