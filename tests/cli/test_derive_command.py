"""`certreg derive` and `certreg codegen` as a user runs them."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest
from claim_outcomes import TAKEN, outcome, taken_as_proved
from commands import certreg

from certreg.cli import derivations
from certreg.native.kernels import GENERATED
from certreg.paper import derivation
from derivations import book


def test_named_claims_are_proved_and_told():
    run = certreg("derive", "davenport")

    assert (run.code, run.err) == (0, "")
    assert run.out.startswith("davenport ")
    assert "PROVED" in run.out
    assert (
        "1 of 1 claims proved, 2 of 2 mutated statements refuted, 0 of 0 hypotheses needed"
        in run.out
    )


def test_an_unknown_claim_is_bad_usage_before_anything_is_run():
    run = certreg("derive", "davenport", "perpetual_motion")

    assert (run.code, run.out) == (2, "")
    assert "there is no claim 'perpetual_motion'" in run.err


def test_an_unknown_claim_is_told_what_may_be_meant_and_where_the_names_are():
    near = certreg("derive", "davenprot")
    far = certreg("derive", "zzz")

    assert "there is no claim 'davenprot': did you mean 'davenport'?" in near.err
    assert "did you mean" not in far.err
    for run in (near, far):
        assert (run.code, run.out) == (2, "")
        assert "`certreg derive --list`" in run.err


def test_the_names_are_listed_and_nothing_is_run(monkeypatch):
    monkeypatch.setattr(derivation, "outcomes", lambda _names: pytest.fail("a claim is run"))
    run = certreg("derive", "--list")

    assert (run.code, run.err) == (0, "")
    assert run.out.split("\n\n")[0].splitlines()[0] == book.CHAPTERS[0].title
    listed = [line.split()[0] for line in run.out.splitlines() if line.startswith("  ")]
    assert listed == list(book.names())


def test_a_list_goes_with_no_names():
    run = certreg("derive", "--list", "davenport")

    assert (run.code, run.out) == (2, "")
    assert "--list" in run.err


@pytest.mark.slow
@pytest.mark.parametrize("anew", [False, pytest.param(True, marks=pytest.mark.long)])
def test_out_takes_the_latex_and_the_code(anew, tmp_path: Path, monkeypatch):
    """That what is generated anew is what is committed, tests/native asks as well."""
    committed = (GENERATED / "dynamics.c").read_bytes()
    if not anew:
        generated = "certreg.native.codegen.emit.generated_files"
        monkeypatch.setattr(generated, lambda *_: {"dynamics.c": committed})
        monkeypatch.setattr(derivation._module("emit"), "definitions", tuple)

    run = certreg("derive", "davenport", "--out", tmp_path / "proofs")

    assert run.code == 0
    assert r"\section{Davenport's matrix}" in (tmp_path / "proofs/claims.tex").read_text("utf-8")
    assert (tmp_path / "proofs/generated/dynamics.c").read_bytes() == committed


def test_a_claim_that_does_not_hold_is_exit_code_1(monkeypatch):
    module = derivation._module("claims.davenport")
    wrong = module.CLAIM.controls["K of the transpose of C"].proof
    monkeypatch.setattr(module, "CLAIM", dataclasses.replace(module.CLAIM, proof=wrong))

    run = certreg("derive", "davenport")

    assert run.code == 1
    assert "REFUTED" in run.out
    assert "0 of 1 claims proved" in run.out


def test_the_sources_are_written_whole(tmp_path: Path):
    run = certreg("codegen", "--out", tmp_path / "embedded")

    assert run.code == 0
    assert [Path(line).name for line in run.out.splitlines()] == sorted(
        ["dynamics.c", "dynamics.h", "example.c", "survey.txt"]
    )


def test_a_file_in_the_way_is_told(tmp_path: Path):
    (tmp_path / "file").write_text("", "utf-8")

    run = certreg("codegen", "--out", tmp_path / "file" / "folder")

    assert run.code == 2
    assert "cannot be made a folder" in run.err


@pytest.mark.slow
@pytest.mark.parametrize("proved", [TAKEN, pytest.param(book.names(), marks=pytest.mark.long)])
def test_all_claims_are_proved_by_the_command(proved, monkeypatch):
    """Each proof is run once in a session: tests/derivations reads the same outcomes."""
    found = [(outcome if name in proved else taken_as_proved)(name) for name in book.names()]
    monkeypatch.setattr(derivations, "outcomes", lambda _names: found)

    run = certreg("derive")
    count = len(found)

    assert run.code == 0
    assert f"{count} of {count} claims proved" in run.out
