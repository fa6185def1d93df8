"""What is asked of checkers is what is stated: limits as written, Coq's words number by number."""

from __future__ import annotations

import json
import re
import subprocess
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import checked

from certreg.certificate import checking, coq
from certreg.certificate.checking import verify_with_coq
from certreg.certificate.count import AT_MOST, CountBody
from certreg.certificate.envelope import KINDS, certificate_bytes
from certreg.certificate.isotropic import RotationState
from certreg.errors import InvalidFileError, InvalidProblemError, MissingToolError
from certreg.problem.problem import RegistrationProblem
from certreg.registration.certification import certify
from certreg.results import Ruling
from certreg.verify import KINDS as CHECKED
from certreg.verify import check

VECTORS = Path(__file__).parents[2] / "vectors"
# What Coq does not decide.
OTHERS = re.compile("consensus|scaled|count|rotation-only|similarity|springs|truncated")
GOOD = sorted(path for path in VECTORS.glob("accept-*.json") if not OTHERS.search(path.name))
AXES = np.vstack([np.diag([3.0, 2.0, 1.0]), -np.diag([3.0, 2.0, 1.0])])


def test_a_body_is_found_by_the_kind_that_it_has_itself():
    assert {kind: find().KIND for kind, find in KINDS.items()} == {kind: kind for kind in CHECKED}


@pytest.mark.parametrize("limit", [1, 0.5, np.float64(0.5), np.float32(0.5), Fraction(1, 2)])
def test_a_limit_is_the_number_that_it_is_written_as(limit: Any):
    (found,) = checking._limits(share=limit).values()

    assert type(found) is Fraction
    assert found == Fraction(str(float(limit)))
    assert checking._limits(share=np.float64(0.1))["share"] == Fraction(1, 10)


@pytest.mark.parametrize("wrong", ["x", float("nan"), float("inf"), -1e-9, None.__class__])
def test_what_is_no_limit_is_refused(wrong: Any):
    with pytest.raises(InvalidProblemError, match="the limit of the share is "):
        checking._limits(share=wrong)
    assert checking._limits(share=None) == {}
    assert checking._limits(share=0, angle=None) == {"share": 0}


def test_a_certificate_in_a_file_may_be_as_long_as_the_checker_takes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    path = tmp_path / "a.json"
    path.write_bytes(b"0123456789")
    monkeypatch.setattr("certreg.certificate.envelope.FILE_MAX", 10)
    assert certificate_bytes(path) == b"0123456789"
    path.write_bytes(b"0123456789abc")
    assert certificate_bytes(path) == b"0123456789a"  # one more than allowed: the checker refuses


def test_own_certificates_of_few_points_are_checked_as_a_stranger_would(
    monkeypatch: pytest.MonkeyPatch,
):
    problem = RegistrationProblem(AXES, AXES)
    certificate = checked(certify(problem, relaxation=False, simulation=False).certificate)
    asked = list[int]()

    def seen(*given: Any) -> Any:
        asked.append(len(given))
        return check(*given)

    monkeypatch.setattr(checking, "check", seen)
    for points, times in ((6, 1), (5, 1)):
        monkeypatch.setattr(checking, "PYTHON_POINTS", points)
        assert checking.check_own(certificate, problem).proved
        assert len(asked) == times


def test_an_own_certificate_of_few_points_is_refused_for_others():
    problem, other = RegistrationProblem(AXES, AXES), RegistrationProblem(AXES, AXES + 1.0)
    certificate = checked(certify(problem, relaxation=False, simulation=False).certificate)

    assert checking.check_own(certificate, problem).proved
    for given, why in (
        (certificate, "the certificate is about other points"),
        (replace(certificate, digest=other.digest()), "the digest is not theirs"),
    ):
        verdict = checking.check_own(given, other)
        assert verdict.ruling is Ruling.REFUTED
        assert verdict.words.startswith(why)


def test_a_body_of_the_count_is_read_as_it_is_written():
    body = CountBody(chart=(1, 2, 3, 4), modulus=101)

    assert AT_MOST == body.at_most == 4
    assert CountBody.from_fields(body.to_fields()) == body
    fields: Any = {"claims": {"at_most": 7}, "proof": {"chart": [5, 6, 7, 8], "modulus": 13}}
    assert CountBody.from_fields(fields).to_fields() == fields


@pytest.mark.parametrize(("exponent", "unit"), [(0, 1), (3, 8), (-2, Fraction(1, 4))])
def test_a_spin_is_in_its_unit(exponent: int, unit: Fraction):
    state = RotationState(quaternion=(1, 0, 0, 0), angular_velocity=(3, -4, 0, exponent))

    assert list(state.spin) == [3 * unit, -4 * unit, 0]


# Coq ---------------------------------------------------------------------------------------------


def words_of(path: Path) -> tuple[dict[str, Any], coq.CoqProblem]:
    return json.loads(path.read_bytes()), coq.export(path.read_bytes())


def integer(word: str) -> int:
    return int(word.strip("()"), 16)


def dyadic(text: str) -> Fraction:
    m, e = map(integer, re.findall(r"\(?-?0x[0-9a-f]+\)?", text))
    return m * Fraction(2) ** e


@pytest.mark.parametrize("path", GOOD, ids=lambda path: path.stem)
def test_the_statement_for_coq_is_that_of_the_certificate(path: Path):
    given, problem = words_of(path)
    claims, basin = given["claims"], given["basin"]
    entries = dict(re.findall(r"(\w+) := (.*?)(?=;\n| \|\})", problem.definitions))

    def pair(value: Any) -> Fraction:
        return value[0] * Fraction(2) ** value[1]

    def listed(text: str) -> list[int]:
        return [integer(word) for word in re.findall(r"\(?-?0x[0-9a-f]+\)?", text)]

    assert listed(entries["pose"]) == given["pose"]
    for name in ("delta", "mu"):
        assert dyadic(entries[name]) == pair(given["optimality"][name])
    assert dyadic(entries["gap"]) == pair(claims["gap"])
    assert listed(entries["multiplicities"]) == claims["pattern"]
    for name in ("unique", "basin"):
        assert entries[name] == str(bool(claims[name])).lower()
    for name, value in (("sin2", claims["sin2_half_angle"]), ("sdp_gap", claims["sdp_gap"])):
        assert (entries[name] == "None") == (value is None)
        assert value is None or dyadic(entries[name]) == pair(value)
    unstable = claims["unstable"]
    assert (entries["unstable"] == "None") == (unstable is None)
    assert unstable is None or listed(entries["unstable"]) == unstable
    velocity = None if basin is None else basin.get("angular_velocity")
    assert (entries["spinning"] == "None") == (velocity is None)
    if velocity is not None:
        assert listed(entries["spinning"]) == velocity
    assert (entries["turned"] == "None") == (basin is None)
    if basin is not None:
        assert listed(entries["turned"]) == basin["quaternion"]


def test_files_for_coq_hold_the_definitions_under_their_tags():
    _, problem = words_of(GOOD[0])
    theorem, refusal, decision = problem.theorem(), problem.refusal(), problem.decision("_7")
    plain = problem.definitions.replace("@", "")

    assert theorem.endswith(plain + coq.THEOREM)
    assert refusal.endswith(plain + coq.DECISION.format(tag=""))
    assert theorem.removesuffix(coq.THEOREM) == refusal.removesuffix(coq.DECISION.format(tag=""))
    assert problem.digest in theorem
    tagged = problem.definitions.replace("@", "_7")
    assert decision == tagged + coq.DECISION.format(tag="_7")
    assert "Definition statement_7 := " in decision


@pytest.mark.parametrize(
    ("number", "word"), [(0, "0x0"), (10, "0xa"), (-1, "(-0x1)"), (-255, "(-0xff)")]
)
def test_integers_in_coqs_words(number: int, word: str):
    assert coq._integer(number) == word
    assert (coq._truth(1), coq._truth(None)) == ("true", "false")


@pytest.mark.parametrize(
    "numbers", [[0.0, 0.0], [1.0, 3.0], [4.0, -12.0], [0.1, 7.0], [5e-324, 1.0], [1e300, 2.0]]
)
def test_doubles_are_integers_over_one_power_of_two_none_of_them_spare(numbers: list[float]):
    integers, exponent = coq._integers(numbers)

    assert [k * Fraction(2) ** exponent for k in integers] == list(map(Fraction, numbers))
    assert not any(numbers) or any(k % 2 for k in integers)


class Coq:
    """Answers as coqc would, each call with the next answer."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *answers: tuple[int, str, str]) -> None:
        self.answers, self.asked = list(answers), list[str]()
        monkeypatch.setattr(coq, "find_coqc", lambda: "coqc")
        monkeypatch.setattr(coq, "compiled_proofs", lambda *_, **__: Path())
        monkeypatch.setattr(coq, "axioms", lambda *_: ("an_axiom",))
        monkeypatch.setattr(coq, "run_coqc", self.run)

    def run(self, _: str, __: Path, source: str, *, seconds: float) -> Any:
        self.asked.append(source)
        code, out, err = self.answers.pop(0)
        assert seconds == coq.SECONDS
        return subprocess.CompletedProcess([], code, out, err)


def test_what_coq_accepts_is_proved_and_what_it_refuses_is_told_with_its_reasons(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
):
    content, problem = GOOD[0].read_bytes(), words_of(GOOD[0])[1]
    Coq(monkeypatch, (0, "", ""))
    verdict, source = coq.decide(content)
    assert (verdict.ruling, source) == (Ruling.PROVED, problem.theorem())
    assert verdict.words == "Coq accepted the theorem"
    assert f"n = {problem.n} pairs" in verdict.theorems[0]
    assert "an_axiom" in " ".join(verdict.theorems)

    said = "refused = gap_too_small :: not_unique :: nil : list reason"
    asked = Coq(monkeypatch, (1, "", "Error: x"), (0, said, ""))
    verdict, source = coq.decide(content)
    assert (verdict.ruling, source) == (Ruling.REFUTED, problem.theorem())
    assert verdict.words == "gap too small; not unique"
    assert asked.asked == [problem.theorem(), problem.refusal()]

    for wrong in ((1, "refused = gap_too_small : list", "Error: disk"), (0, "nothing", "")):
        Coq(monkeypatch, (1, "", ""), wrong)
        with pytest.raises(MissingToolError, match="coqc failed: "):
            coq.decide(content)

    place = tmp_path / "kept.v"
    Coq(monkeypatch, (0, "", ""), (0, "", ""))
    assert verify_with_coq(content, out=place).proved
    assert place.read_text("utf-8") == problem.theorem()
    assert verify_with_coq(content).proved
    place.unlink()
    assert not verify_with_coq(b"{}", out=place).proved
    assert not place.exists()


def test_coq_is_given_the_file_in_a_folder_of_its_own(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
):
    def run(command: list[str], *, cwd: str, timeout: float, **_: Any) -> Any:
        assert Path(command[-1]).read_text("utf-8") == "a source"
        assert Path(command[-1]).parent == Path(cwd)
        assert command[0] == "coqc"
        assert command[-5:-1] == [*coq.QUIET[-1:], "-R", str(tmp_path), "Certreg"]
        return timeout

    monkeypatch.setattr(coq.subprocess, "run", run)
    assert coq.run_coqc("coqc", tmp_path, "a source", seconds=2.5) == 2.5  # pyright: ignore[reportGeneralTypeIssues]


def test_the_first_error_is_the_one_that_is_told():
    said = "File a.v, line 3:\nWarning: odd\nError: first\nError: second\n"

    assert "first" in coq._first_error(said)
    assert "second" not in coq._first_error(said)
    assert coq._first_error("just words\nand more\n") == "just words"
    assert coq._first_error("") == "no message"


def test_where_there_are_no_proofs_coq_is_not_asked(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
):
    assert (coq.proofs_folder() / "Checker.v").is_file()
    monkeypatch.setattr(coq, "files", lambda _: tmp_path / "certreg")
    with pytest.raises(MissingToolError, match="are not beside certreg"):
        coq.proofs_folder()
    bundled = tmp_path / "certreg" / "_derivations" / "coq"
    bundled.mkdir(parents=True)
    (bundled / "Checker.v").write_text("", "utf-8")
    assert coq.proofs_folder() == bundled


def test_coq_hears_of_work_on_stderr(capsys: pytest.CaptureFixture[str]):
    checking._on_stderr("compiling")

    assert capsys.readouterr() == ("", "compiling\n")


def test_a_certificate_of_another_kind_is_named():
    path = next(VECTORS.glob("accept-*count*.json"))
    with pytest.raises(InvalidFileError, match="Coq decides on kind isotropic alone"):
        coq.export(path.read_bytes())
