"""Every problem that the table accepts has a prover, and a finder for each method: just one."""

from __future__ import annotations

from itertools import product

import pytest

from certreg.equilibrium.methods import FINDERS
from certreg.objective.structure import Structure
from certreg.problem.motion import Scale
from certreg.problem.support import Cell, Loss, Verb, refusal
from certreg.registration.certification import PROVERS, prover_of

CELLS = [
    Cell(springs=springs, scale=scale, rotation_only=turns, loss=loss)
    for springs, scale, turns, loss in product((False, True), Scale, (False, True), Loss)
]
ACCEPTED = [cell for cell in CELLS if refusal(cell) is None and cell.loss is not Loss.BREAKING]
METHODS = (Verb.SPECTRAL, Verb.GROEBNER, Verb.HOMOTOPY)


def test_the_table_accepts_what_it_did():
    assert len(ACCEPTED) == 13


@pytest.mark.parametrize("cell", ACCEPTED, ids=str)
def test_one_prover_accepts_each_declared_problem(cell: Cell):
    found = PROVERS.get(cell.loss) or PROVERS[Structure.of(cell)]

    assert sum(load().accepts(cell) for load in found) == 1
    assert prover_of(cell).accepts(cell)


def test_each_prover_accepts_a_declared_problem():
    made = [load() for provers in PROVERS.values() for load in provers]

    assert all(any(prover_of(cell) is prover for cell in ACCEPTED) for prover in made)
    assert len(made) == 5


@pytest.mark.parametrize("verb", METHODS)
@pytest.mark.parametrize("cell", [cell for cell in ACCEPTED if cell.loss is Loss.SQUARES], ids=str)
def test_finders_are_those_of_the_methods_that_the_table_accepts(cell: Cell, verb: Verb):
    finder = FINDERS[Structure.of(cell)].get(verb.value)
    accepted = refusal(cell, verb) is None

    assert accepted == (finder is not None and finder.accepts(cell))


def test_each_finder_loads_its_function():
    for name, finder in (pair for finders in FINDERS.values() for pair in finders.items()):
        assert finder.verb.value == name
        assert callable(finder.method)
