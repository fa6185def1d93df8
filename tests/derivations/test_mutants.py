"""No mutant of a shipped formula survives the derivations."""

from __future__ import annotations

import os

import pytest
from mutants import MUTANTS, ROOT, SO3, UNCHANGED, Mutant, changed_functions, noticed_apart

from derivations import book

# A fork in a process with threads (those of BLAS) is safe here: the child runs Python alone.
pytestmark = [
    pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork here"),
    pytest.mark.filterwarnings("ignore:.*use of fork:DeprecationWarning"),
]


@pytest.fixture(scope="module", autouse=True)
def loaded():
    """All claims, imported before the forks."""
    book.claims()


@pytest.mark.slow
@pytest.mark.one_in(36)
@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda mutant: mutant.says)
def test_every_mutant_of_a_shipped_formula_is_noticed(mutant):
    assert noticed_apart(mutant) is not None


def test_there_are_mutants_enough():
    assert len({mutant.says for mutant in MUTANTS}) == len(MUTANTS) >= 30


def test_every_mutant_is_one_of_the_code_as_it_is():
    """Of all, as only a part of them is asked in every run of the tests."""
    stand = {m.says: (ROOT / m.file).read_text("utf-8").count(m.old) for m in MUTANTS}

    assert [says for says, count in stand.items() if count != 1] == []


@pytest.mark.slow
def test_the_unmutated_formula_is_not_noticed():
    assert UNCHANGED.claims == ("davenport",)
    assert noticed_apart(UNCHANGED) is None


def test_a_mutant_that_changes_no_function_is_a_mistake():
    with pytest.raises(ValueError, match="changes no function"):
        changed_functions("A = 1\n", "A = 2\n")


def test_a_mutant_whose_text_does_not_stand_once_is_a_mistake(capfd):
    nowhere = Mutant("nowhere", SO3, "no such text", "", ("davenport",))

    with pytest.raises(RuntimeError, match="nowhere"):
        noticed_apart(nowhere)
    assert "the text stands 0 times" in capfd.readouterr().err
