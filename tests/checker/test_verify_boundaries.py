"""Every inequality of the checker, just inside and just outside; no wrong checker passes them."""

from __future__ import annotations

from importlib import import_module

import checker_boundaries as boundaries
import pytest
from checker_mutants import FILE, LISTS, MUTANTS, answers, failing
from consensus_boundaries import consensus_cases
from list_boundaries import early_list_cases, list_cases
from scaled_boundaries import scaled_cases
from similarity_boundaries import similarity_cases
from springs_boundaries import springs_cases
from sprung_boundaries import sprung_cases
from truncated_boundaries import truncated_cases

checker = import_module("certreg.verify")


@pytest.mark.slow
def test_the_checker_answers_rightly_on_either_side_of_each_of_its_inequalities():
    cases = boundaries.quick_cases()

    assert len(cases) > 800
    assert [case.name for case in cases if not case.passes(checker)] == []


@pytest.mark.slow
def test_the_checker_answers_rightly_of_general_springs():
    cases = springs_cases()

    assert len(cases) >= 60
    assert [case.name for case in cases if not case.passes(checker)] == []


@pytest.mark.slow
def test_the_checker_answers_rightly_of_a_free_scale():
    cases = similarity_cases()

    assert len(cases) >= 200
    assert [case.name for case in cases if not case.passes(checker)] == []


@pytest.mark.slow
@pytest.mark.parametrize("every", [3, pytest.param(1, marks=pytest.mark.long)])
def test_the_checker_answers_rightly_of_wrong_pairs(every: int):
    cases = consensus_cases()

    assert len(cases) >= 400
    assert [case.name for case in cases[::every] if not case.passes(checker)] == []


def test_the_checker_answers_rightly_of_wrong_pairs_on_general_springs():
    cases = sprung_cases()

    assert len(cases) >= 30
    assert [case.name for case in cases if not case.passes(checker)] == []


@pytest.mark.slow
@pytest.mark.parametrize("every", [24, pytest.param(1, marks=pytest.mark.long)])
def test_the_checker_answers_rightly_of_lists_of_equilibria(every: int):
    cases, early = list_cases(), early_list_cases()
    asked = [*early, *cases[len(early) :: every]]

    assert len(cases) >= 140
    assert [case.name for case in asked if not case.passes(checker)] == []


@pytest.mark.slow
@pytest.mark.parametrize("every", [3, pytest.param(1, marks=pytest.mark.long)])
def test_the_checker_answers_rightly_of_truncated_squares(every: int):
    cases = truncated_cases()

    assert len(cases) >= 120
    assert [case.name for case in cases[::every] if not case.passes(checker)] == []


@pytest.mark.slow
def test_the_checker_answers_rightly_of_wrong_pairs_with_a_free_scale():
    cases = scaled_cases()

    assert len(cases) >= 90
    assert [case.name for case in cases if not case.passes(checker)] == []


@pytest.mark.long
@pytest.mark.parametrize("part", ["point", "byte"])
def test_the_limits_of_size_are_those_of_files_of_a_hundred_megabytes(part: str):
    cases = [case for case in boundaries.large_cases() if part in case.name]

    assert len(cases) == 2
    for case in cases:
        assert case.passes(checker), case.name


def test_every_mutant_is_one_of_the_checker_as_it_is():
    """Of all, as only a part of them is asked in every run of the tests."""
    text = FILE.read_text(encoding="utf-8")

    assert [mutant.says for mutant in MUTANTS if text.count(mutant.old) != 1] == []


@pytest.mark.slow
@pytest.mark.parametrize("every", [128, pytest.param(1, marks=pytest.mark.long)])
def test_no_mutant_of_the_checker_answers_as_it_should(every: int):
    found = answers(every)

    assert len(found) * every >= len(MUTANTS) - len(LISTS) > 150
    assert [mutant for mutant, question in found.items() if question is None] == []
    assert not any(str(question).startswith("not even loaded") for question in found.values())


@pytest.mark.slow
def test_a_case_is_failed_by_an_answer_that_is_wrong_torn_or_none():
    text = FILE.read_text(encoding="utf-8")
    cases = boundaries.quick_cases()[:20]

    assert failing(text, cases) is None
    assert failing(text + "\ndel check\n", cases) == cases[0].name
    always = "\ndef check(content, clouds): return Outcome(True)\n"
    assert failing(text + always, cases) == cases[0].name
    assert failing("import certreg.nothing", cases) is not None
    assert failing("def (", cases) is not None
