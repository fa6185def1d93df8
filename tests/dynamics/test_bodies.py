"""What all moving bodies have: one kind of trajectory, whatever the springs and the scale are."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from certreg import RegistrationProblem
from certreg.dynamics.integrators import SimulationSettings
from certreg.dynamics.simulation import simulate
from certreg.errors import InvalidProblemError
from certreg.native.loops import Integrator
from certreg.objective.by_structure import objective_of
from certreg.results import Absent

if TYPE_CHECKING:
    from certreg.dynamics.trajectory import Trajectory


RNG = np.random.default_rng(21)
SOURCE = RNG.normal(size=(9, 3))
TARGET = SOURCE @ np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]) + 0.1 * RNG.normal(size=(9, 3))
KINDS: dict[str, dict[str, Any]] = {
    "weights": {"weights": RNG.uniform(0.5, 2.0, 9)},
    "planes": {"normals": RNG.normal(size=(9, 3))},
    "free scale": {"scale": "asymmetric"},
}
each_kind = pytest.mark.parametrize("kind", KINDS)


def run(kind: str, **settings: Any) -> Trajectory:
    problem = RegistrationProblem(SOURCE, TARGET, **KINDS[kind])
    given = SimulationSettings(**settings)
    return simulate(objective_of(problem), 1.5, Integrator.MIDPOINT, settings=given)


@each_kind
def test_a_body_that_is_released_at_rest_loses_energy_until_it_rests(kind):
    found = run(kind)
    energy = found.potential + found.kinetic

    assert found.at_rest
    assert found.kinetic[0] == 0.0
    assert found.escapes or (np.diff(energy) <= 1e-14 * energy[0]).all()
    assert found.speed < 1e-4
    assert found.states.shape == (len(found.times), 18)


@each_kind
def test_the_last_state_is_logged_with_its_energies_also_between_two_samples(kind):
    found = run(kind, step=1e-3, max_steps=2051)  # more than the log holds: every second is kept
    end = found.moving.energies(found.last)

    assert found.times[-1] == found.time
    assert found.times[-1] - found.times[-2] == pytest.approx(1e-3)
    assert found.times[-2] - found.times[-3] == pytest.approx(2e-3)
    assert found.kinetic[-1] == pytest.approx(found.moving.kinetic(end), rel=1e-12)
    assert found.potential[-1] == pytest.approx(end["potential"], rel=1e-12)
    rotation, q = found.states[-1, 3:12].reshape(3, 3), found.quaternion
    assert np.trace(rotation) == pytest.approx(4.0 * q[0] ** 2 - 1.0)


@each_kind
def test_what_a_body_has_not_is_none_with_its_reason(kind):
    found = run(kind)
    for name in ("scales", "predicted_rate", "decay_rate", "energy_left"):
        assert isinstance(found.stated(name), Absent) == (getattr(found, name) is None)
    assert (found.scales is not None) == (kind == "free scale")
    assert (found.predicted_rate is not None) == (kind == "weights")


@pytest.mark.parametrize("kind", ["planes", "free scale"])
def test_an_integrator_that_does_not_move_a_body_is_refused(kind):
    problem = RegistrationProblem(SOURCE, TARGET, **KINDS[kind])
    with pytest.raises(InvalidProblemError, match="midpoint"):
        simulate(objective_of(problem), 1.5, Integrator.EULER)
