"""A simulation on general springs, as it is told, and what is proved of its end."""

from __future__ import annotations

import json
from fractions import Fraction
from itertools import product
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from spring_families import plane, statement
from springs_certified import moved_springs

import certreg
from certreg.certificate.basin import Barrier, barrier_of, basin_of_springs, state_energy
from certreg.exact.dyadic import Dyadic
from certreg.problem.problem import RegistrationProblem
from certreg.registration.valley import SimulatedSprings
from certreg.results import Ruling

SCHEMAS = Path(certreg.__file__).parent / "report" / "schemas"


def problem_of(seed: int, n: int) -> RegistrationProblem:
    made = plane(np.random.default_rng(seed), n, 0.05)
    return RegistrationProblem(**statement(made))


@pytest.fixture(scope="module")
def good() -> SimulatedSprings:
    """A motion that ends at the optimum."""
    return moved_springs(problem_of(4, 30))


@pytest.mark.slow
def test_a_body_at_rest_at_the_optimum_is_proved_to_end_there(good):
    assert good.converged
    assert good.basin.proved
    assert good.angle_to_best < 1e-3
    assert "Proved: from its last state" in str(good)


def test_the_exact_energy_of_the_end_is_that_of_the_motion(good):
    energy = state_energy(good.objective, good.exact_end)
    assert float(energy) == pytest.approx(good.energies[1], rel=1e-9)


def test_a_state_is_in_the_basin_below_the_barrier_and_not_on_it(good):
    energy = state_energy(good.objective, good.exact_end)
    least = Fraction(1, 10**30)

    def ruling(lower: Fraction | None, upper: Fraction | None = None) -> Ruling:
        barrier = Barrier(lower=lower, upper=upper)
        return basin_of_springs(good.objective, barrier, good.exact_end).ruling

    assert ruling(energy + least) is Ruling.PROVED
    assert ruling(energy) is Ruling.INCONCLUSIVE
    assert ruling(energy - least, energy) is Ruling.REFUTED
    assert ruling(energy - least, energy + least) is Ruling.INCONCLUSIVE
    assert ruling(energy - least) is Ruling.INCONCLUSIVE
    assert ruling(energy, energy) is Ruling.REFUTED
    assert ruling(None) is Ruling.INCONCLUSIVE


def test_the_barrier_has_all_energies_of_the_second_box_at_most_above_it(good):
    """Of 8 bits: the corners of its box, and what is between, may be the second equilibrium."""
    objective, bits, second = good.objective, 8, Dyadic(mantissa=1, exponent=-3)
    q = (256, 93, -171, 40)
    body: Any = SimpleNamespace(
        claims=SimpleNamespace(unique=True, second=second), quaternions=[(1, 0, 0, 0), q], bits=bits
    )
    barrier = barrier_of(objective, body)
    corners = [
        objective.energy([w + d for w, d in zip(q, (0, *off), strict=True)])
        for off in product((-1, 0, 1), repeat=3)
    ]

    assert barrier.lower == second.value
    assert barrier.upper is not None
    assert max(corners) <= barrier.upper
    assert max(corners) > objective.energy(q)
    for other in (
        SimpleNamespace(claims=SimpleNamespace(unique=unique), quaternions=known)
        for unique, known in ((None, [q, q]), (False, [q, q]), (True, [q]))
    ):
        assert barrier_of(objective, cast("Any", other)) == Barrier(lower=None)


@pytest.mark.slow
def test_a_body_at_rest_elsewhere_is_not_called_converged():
    spurious = moved_springs(problem_of(11, 7), "splitting")

    assert spurious.at_rest
    assert not spurious.converged
    assert not spurious.basin.proved
    assert spurious.excess > 0
    assert "another equilibrium" in str(spurious)


@pytest.mark.slow
def test_a_wall_is_told_to_coast():
    source = np.random.default_rng(7).normal(size=(10, 3))
    target = source + np.array([3, 0, 0.5])
    wall = RegistrationProblem(source, target, normals=[[0.0, 0.0, 1.0]] * 10)
    run = moved_springs(wall)
    assert any("coasts" in note for note in run.notes)
    assert run.converged
    assert run.basin.ruling is Ruling.INCONCLUSIVE


@pytest.mark.slow
def test_simulate_takes_problems_with_springs_and_documents_them(good):
    run = certreg.simulate(problem_of(4, 30))
    assert isinstance(run, SimulatedSprings)
    document = run.to_dict()
    schema = json.loads((SCHEMAS / "certreg-simulation-1.json").read_text("utf-8"))
    assert list(Draft202012Validator(schema).iter_errors(document)) == []
    assert document["in_certified_basin"] is True
    assert document["basin"]["verdict"] == "proved"
    assert run.states.shape[1] == 18
    assert "best rotation found" in run._repr_html_()
