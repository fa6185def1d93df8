"""Every claim of the book is proved, every mutated statement refuted; the kernel can say no."""

from __future__ import annotations

import dataclasses
import importlib
import sys
from pathlib import Path

import pytest
import sympy
from claim_outcomes import outcome

from certreg.results import Ruling
from derivations import algebra, book, latex
from derivations.claims import davenport
from derivations.kernel import Claim, Kind, prove
from derivations.notation import scalar, vector

ROOT = Path(__file__).parents[2]
X, Y = scalar("x"), scalar("y")


@pytest.mark.slow
@pytest.mark.parametrize("name", book.names())
def test_the_claim_is_proved_and_its_mutations_are_not(name):
    found = outcome(name)

    assert found.verdict.ruling is Ruling.PROVED, found.verdict.words
    assert all(control.refuted_at is not None for control in found.controls)
    assert len(found.controls) >= 2
    assert found.claim.name == name


@pytest.mark.parametrize("name", book.names())
def test_the_claim_names_what_it_needs_and_the_code_that_relies_on_it(name):
    claim = book.claim(name)

    assert set(claim.needs) <= set(book.names())
    for dotted in claim.used_by:
        assert resolves(dotted), dotted
    texts = (claim.statement, claim.not_claimed, claim.source)
    for text in (*texts, *claim.assumptions, *claim.standard):
        assert text.strip() == text != ""
        assert text.count("$") % 2 == 0, text


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


def resolves(dotted: str) -> bool:
    """Whether a dotted name is a module, or an attribute of a class or a module."""
    parts = dotted.split(".")
    for k in range(len(parts), 0, -1):
        try:
            found = importlib.import_module(".".join(parts[:k]))
        except ModuleNotFoundError:
            continue
        for part in parts[k:]:
            found = getattr(found, part, None)
        return found is not None
    return False


# The kernel --------------------------------------------------------------------------------------


def test_a_wrong_identity_is_refuted_with_what_is_left():
    step = algebra.identity("wrong", (X + Y) ** 2, X**2 + Y**2)

    assert step.verdict.ruling is Ruling.REFUTED
    assert "2*x*y" in step.verdict.words


def test_an_identity_of_lists_of_unequal_length_is_a_mistake():
    with pytest.raises(ValueError, match="2 entries against 1"):
        algebra.identity("lengths", [X, Y], [X])


@pytest.mark.parametrize("bad", [0.1 * X, sympy.sqrt(X), 1 / X, sympy.sin(X), X**Y])
def test_only_polynomials_with_rational_coefficients_are_compared(bad):
    with pytest.raises(TypeError):
        algebra.identity("not a polynomial", bad, bad)
    with pytest.raises(TypeError):
        algebra.identity("not a polynomial", X, bad)


def test_a_relation_is_used_and_not_more_than_it_says():
    relation = algebra.Relation(X, 2, 1 + Y)

    assert algebra.modulo("used", X**4, (1 + Y) ** 2, [relation]).verdict.proved
    refuted = algebra.modulo("not more", X, 1 + Y, [relation])
    assert refuted.verdict.ruling is Ruling.REFUTED


def test_cofactors_are_multiplied_out():
    good = algebra.combination("in the ideal", X**2 - Y**2, [(X + Y, X - Y)])
    bad = algebra.combination("wrong cofactor", X**2 - Y**2, [(X - Y, X - Y)])

    assert good.verdict.proved
    assert bad.verdict.ruling is Ruling.REFUTED


def test_positivity_asks_for_a_reason_of_every_factor():
    good = algebra.nonnegative("a square", X**2 + 2 * Y, [[1, algebra.Square(X)], [2, given(Y)]])
    bad = algebra.nonnegative("another", X**2 - Y, [[algebra.Square(X)], [given(Y)]])

    assert good.verdict.proved
    assert "y is a length" in good.verdict.words
    assert bad.verdict.ruling is Ruling.REFUTED
    for factor in (-1, X, sympy.Rational(-1, 2)):
        with pytest.raises(TypeError, match="nobody said why"):
            algebra.nonnegative("no reason", X, [[factor]])


def given(value):
    return algebra.Given(value, "y is a length")


def test_facts_are_exact_and_not_empty():
    assert algebra.facts("same", [1, "a"], [1, "a"]).verdict.proved
    assert algebra.facts("other", [1], [2]).verdict.ruling is Ruling.REFUTED
    with pytest.raises(TypeError, match="floating-point"):
        algebra.facts("float", [0.5], [0.5])
    with pytest.raises(ValueError, match="0 facts"):
        algebra.facts("nothing", [], [])


def test_a_claim_without_a_control_is_no_claim():
    with pytest.raises(ValueError, match="no negative control"):
        dataclasses.replace(davenport.CLAIM, controls={})


def test_a_control_that_passes_spoils_the_claim():
    spoilt = dataclasses.replace(davenport.CLAIM, controls={"nothing mutated": davenport.proof})

    verdict = prove(spoilt).verdict

    assert verdict.ruling is Ruling.INCONCLUSIVE
    assert "nothing mutated" in verdict.words


def test_a_proof_stops_at_the_first_step_that_fails():
    def steps():
        yield algebra.identity("fine", X, X)
        yield algebra.identity("wrong", X, Y)
        yield algebra.identity("never seen", X, X)

    found = prove(claim_of(steps))

    assert found.verdict.ruling is Ruling.REFUTED
    assert found.verdict.words.startswith("step 2:")
    assert len(found.steps) == 2


def test_quoting_alone_proves_nothing():
    def steps():
        yield algebra.quoted("All is well.", source="[Leibniz1710]")

    found = prove(claim_of(steps))

    assert found.verdict.ruling is Ruling.INCONCLUSIVE
    assert [step.kind for step in found.quoted] == [Kind.QUOTED]


def claim_of(proof) -> Claim:
    def wrong():
        yield algebra.identity("wrong", X, Y)

    return dataclasses.replace(davenport.CLAIM, proof=proof, controls={"wrong": wrong})


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
