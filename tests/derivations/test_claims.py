"""Every claim of the book is proved, each hypothesis needed, each mutated statement refuted."""

from __future__ import annotations

import importlib
import inspect
import sys
from pathlib import Path
from typing import Any

import pytest
from claim_outcomes import TAKEN, outcome

from certreg.results import Ruling
from derivations import book, latex
from derivations.kernel import until_refuted
from derivations.notation import vector
from derivations.steps import Kind

ROOT = Path(__file__).parents[2]


SAMPLE = [pytest.param(k, marks=() if k in TAKEN else pytest.mark.long) for k in book.names()]
RUN = [case for case in SAMPLE if book.claim(str(*case.values)).runs]


@pytest.mark.slow
@pytest.mark.parametrize("name", SAMPLE)
def test_the_claim_is_proved_and_its_mutations_are_not(name):
    found = outcome(name)

    assert found.verdict.ruling is Ruling.PROVED, found.verdict.words
    assert all(control.refuted and control.words for control in found.controls)
    assert all(drop.needed and drop.words for drop in found.dropped)
    assert [drop.hypothesis for drop in found.dropped] == list(found.claim.hypotheses)
    assert len(found.controls) >= 2
    assert found.claim.name == name


@pytest.mark.parametrize("name", book.names())
def test_the_claim_names_what_it_needs_and_the_code_that_relies_on_it(name):
    claim = book.claim(name)

    assert set(claim.needs) <= set(book.names())
    assert not set(claim.runs) & set(claim.used_by)
    for dotted in (*claim.runs, *claim.used_by):
        assert named(dotted) is not None, dotted
    texts = (claim.statement, claim.not_claimed, claim.source)
    premises = (sentence for _, sentences in claim.premises for sentence in sentences)
    for text in (*texts, *premises, *claim.standard):
        assert text.strip() == text != ""
        assert text.count("$") % 2 == 0, text


def sabotaged(*_arguments, **_named):
    raise RuntimeError("gone")


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize("name", RUN)
def test_the_proof_runs_the_code_that_it_is_said_to_run(name, monkeypatch):
    """With any one of these functions gone, the proof breaks off."""
    claim = book.claim(name)
    for dotted in claim.runs:
        owner, _, attribute = dotted.rpartition(".")
        function: Any = vars(named(owner))[attribute]
        function = function.fget if isinstance(function, property) else function
        function = inspect.unwrap(getattr(function, "__func__", function))
        with monkeypatch.context() as patch:
            patch.setattr(function, "__code__", sabotaged.__code__)
            last = until_refuted(claim.proof)[-1]
        assert last.kind is Kind.BROKEN, dotted


def test_no_claim_needs_one_that_comes_to_need_it():
    seen: set[str] = set()

    def visit(name, path):
        assert name not in path, f"{name} needs itself, by way of {path}"
        if name not in seen:
            for other in book.claim(name).needs:
                visit(other, (*path, name))
            seen.add(name)

    for name in book.names():
        visit(name, ())


def test_every_file_of_claims_is_in_the_book_once():
    files = {path.stem for path in (ROOT / "derivations/claims").glob("*.py")} - {"__init__"}

    assert sorted(book.names()) == sorted(files)


def named(dotted: str) -> Any:
    """A module, or an attribute of a class or a module; None if there is none of that name."""
    parts = dotted.split(".")
    for k in range(len(parts), 0, -1):
        try:
            found = importlib.import_module(".".join(parts[:k]))
        except ModuleNotFoundError:
            continue
        for part in parts[k:]:
            found = getattr(found, part, None)
        return found
    return None


def test_an_unknown_claim_is_a_key_error():
    with pytest.raises(KeyError, match="nowhere"):
        book.claim("nowhere")


def test_the_latex_keeps_formulas_and_escapes_the_rest():
    assert latex.text("a_b at 5 % with $a_b^2$") == r"a\_b at 5 \% with $a_b^2$"
    assert latex.text("`so3.hat` is **bold**") == r"\texttt{so3.hat} is \textbf{bold}"
    assert latex.document([outcome("davenport")]).count(r"\item") >= 5


def test_vectors_of_symbols_have_the_names_of_the_page():
    assert [symbol.name for symbol in vector("v")] == ["v_1", "v_2", "v_3"]
    assert "sympy" in sys.modules
