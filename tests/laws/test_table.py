"""The table of what is supported, held against what happens in Python: every cell."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from laws.cells import (
    CELLS,
    DATA,
    MOTIONS,
    SOURCE,
    TURN,
    cell_of,
    certified,
    options_of,
    refused_sentence,
    target_of,
)
from laws.zoo import GENERIC, cells

import certreg
from certreg.equilibrium.methods import FINDERS
from certreg.objective.structure import Structure
from certreg.problem.support import TABLE, Cell, Loss, Verb, refusal, supported
from certreg.registration.certification import PROVERS, prover_of

if TYPE_CHECKING:
    from collections.abc import Callable

ACCEPTED = 18  # of 60; a cell that opens, or closes, changes this number knowingly


def test_the_table_accepts_as_many_cells_as_documented() -> None:
    assert len(CELLS) == 60
    assert sum(supported(cell_of(*key)) for key in CELLS) == ACCEPTED


@pytest.mark.slow
@pytest.mark.parametrize(
    ("data", "motion", "loss"), [key for key in CELLS if not supported(cell_of(*key))]
)
def test_other_cells_are_refused_with_remedies_that_work(
    data: str, motion: str, loss: Loss
) -> None:
    """Those that are accepted are the zoo's, and have its laws."""
    cell = cell_of(data, motion, loss)
    refused: Any = refusal(cell)
    assert refused_sentence(lambda: certified(cell, data)) == refused.sentence
    assert refused.remedies
    for remedy in refused.remedies:
        assert refused.sentence.count(remedy.words) == 1
        assert certreg.verify(certified(remedy.cell, data).certificate).proved


SQUARES = [(data, motion) for data, motion, loss in CELLS if loss is Loss.SQUARES]
VERBS: dict[Verb, Callable[[certreg.RegistrationProblem], object]] = {
    **{
        verb: lambda problem, verb=verb: certreg.equilibria(problem, verb.value)
        for verb in (Verb.SPECTRAL, Verb.HOMOTOPY)
    },
    **{
        verb: lambda problem, verb=verb: certreg.simulate(problem, verb.value)
        for verb in (Verb.MIDPOINT, Verb.SPLITTING, Verb.EULER)
    },
}


@pytest.mark.slow
@pytest.mark.parametrize(("data", "motion"), SQUARES)
def test_every_verb_answers_or_refuses_by_the_table(data: str, motion: str) -> None:
    cell = cell_of(data, motion, Loss.SQUARES)
    options = options_of(cell, data)
    if not supported(cell):
        sentence = refusal(cell).sentence  # type: ignore[union-attr]
        target = target_of(cell)
        assert refused_sentence(lambda: certreg.register(SOURCE, target, **options)) == sentence
        return
    target = target_of(cell)
    certreg.register(SOURCE, target, **options)
    problem = certreg.RegistrationProblem(SOURCE, target, **options)
    certreg.assess(problem, TURN, np.zeros(3))
    for verb, call in VERBS.items():
        refused = refusal(cell, verb)
        if refused is None:
            assert call(problem) is not None
            continue
        assert refused_sentence(lambda call=call: call(problem)) == refused.sentence
        for remedy in refused.remedies:
            other = certreg.RegistrationProblem(SOURCE, target, **options_of(remedy.cell, data))
            assert VERBS[remedy.verb](other) is not None


@pytest.mark.parametrize("verb", Verb)
def test_every_refusal_names_a_remedy_that_the_table_supports(verb: Verb) -> None:
    for cell in itertools.starmap(cell_of, CELLS):
        if refused := refusal(cell, verb):
            assert refused.remedies
            assert all(supported(one.cell, one.verb) for one in refused.remedies)


def test_no_rule_of_the_table_is_without_a_case() -> None:
    for rule in TABLE:
        verbs = rule.verbs or {Verb.CERTIFY}
        assert any(
            rule.applies(cell_of(*key)) and refusal(cell_of(*key), verb).reason == rule.reason  # type: ignore[union-attr]
            for key in [*CELLS, *itertools.product(DATA, MOTIONS, [Loss.BREAKING])]
            for verb in verbs
        )


ACCEPTED_CELLS = list(cells())
METHODS = (Verb.SPECTRAL, Verb.GROEBNER, Verb.HOMOTOPY)


def test_the_zoo_is_of_every_accepted_cell() -> None:
    assert len(ACCEPTED_CELLS) == 13
    assert {one.cell for one in GENERIC} == set(ACCEPTED_CELLS)


@pytest.mark.parametrize("cell", ACCEPTED_CELLS, ids=str)
def test_one_prover_accepts_each_declared_problem(cell: Cell) -> None:
    found = PROVERS.get(cell.loss) or PROVERS[Structure.of(cell)]

    assert sum(load().accepts(cell) for load in found) == 1
    assert prover_of(cell).accepts(cell)


def test_each_prover_accepts_a_declared_problem() -> None:
    made = [load() for provers in PROVERS.values() for load in provers]

    assert all(any(prover_of(cell) is prover for cell in ACCEPTED_CELLS) for prover in made)
    assert len(made) == 5


@pytest.mark.parametrize("verb", METHODS)
@pytest.mark.parametrize(
    "cell", [cell for cell in ACCEPTED_CELLS if cell.loss is Loss.SQUARES], ids=str
)
def test_finders_are_those_of_the_methods_that_the_table_accepts(cell: Cell, verb: Verb) -> None:
    finder = FINDERS[Structure.of(cell)].get(verb.value)
    accepted = refusal(cell, verb) is None

    assert accepted == (finder is not None and finder.accepts(cell))


def test_each_finder_loads_its_function() -> None:
    for name, finder in (pair for finders in FINDERS.values() for pair in finders.items()):
        assert finder.verb.value == name
        assert callable(finder.method)
