"""`certreg verify` of a file with a certificate a line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from commands import certreg

from certreg.verify import shown

ROOT = Path(__file__).resolve().parents[2]
GOOD = (
    json.dumps(json.loads((ROOT / "vectors" / "accept-pattern-1111.json").read_text("utf-8")))
    + "\n"
)


@pytest.fixture
def many(tmp_path):
    path = tmp_path / "many.jsonl"
    path.write_text(GOOD + GOOD.replace('"unique": true', '"unique": 1') + GOOD, encoding="utf-8")
    return path


def test_refused_lines_are_told_by_their_number_and_the_others_counted(many):
    run = certreg("verify", many)

    told = "line 2: REFUSED: unique is of a wrong type\n2 of 3 certificates VERIFIED\n"
    assert (run.code, run.out) == (1, told)


def test_lines_are_held_to_what_is_asked_of_them(many):
    many.write_text(GOOD, encoding="utf-8")

    assert certreg("verify", many, "--max-angle", "1e-5", "--max-gap", "1e-6").code == 0
    run = certreg("verify", many, "--max-angle", "1e-60")
    assert run.code == 1
    assert "line 1: REFUSED: proved bound on the angle" in run.out


def test_lines_name_their_own_points_and_no_others(many, tmp_path):
    cloud = tmp_path / "cloud.csv"
    cloud.write_text("0,0,0\n1,0,0\n0,2,0\n", encoding="utf-8")

    for more in ((cloud, cloud), ("--coq",)):
        run = certreg("verify", many, *more)
        assert run.code == 2
        assert "a file of many certificates goes without SOURCE TARGET and --coq" in run.err


def test_a_file_that_is_not_there_is_one_line():
    run = certreg("verify", "nowhere.jsonl")

    assert run.code == 2
    assert run.err.count("\n") == 1


RESULT = '{"schema": "certreg-result/1", "n": 3}\n'


def test_results_of_a_list_are_no_certificates_and_it_is_said_where_those_are(tmp_path):
    path = tmp_path / "results.jsonl"
    path.write_text(2 * RESULT, encoding="utf-8")
    told = (
        "REFUSED: these are results (certreg-result/1), not certificates: give one of the files in "
        "{}, one for each pair\n"
    )

    run = certreg("verify", path)
    assert (run.code, run.err) == (1, "")
    assert run.out == told.format("the folder certificates that batch wrote")

    (tmp_path / "certificates").mkdir()
    run = certreg("verify", path)
    assert (run.code, run.out) == (1, told.format(shown(tmp_path / "certificates")))


def test_one_result_is_no_certificate(tmp_path):
    path = tmp_path / "result.json"
    path.write_text(RESULT.replace("{", "{\n "), encoding="utf-8")
    run = certreg("verify", path)

    assert run.code == 1
    assert run.out == (
        "REFUSED: this is a result (certreg-result/1), not a certificate: give the "
        "certificate.json that certify --out wrote beside it\n"
    )


def test_a_certificate_that_tells_of_a_result_stays_one(many):
    """What it says about itself does not make it a result."""
    many.write_text(
        GOOD.replace('"about": {', '"about": {"schema": "certreg-result/1", ', 1), "utf-8"
    )

    assert certreg("verify", many).out.endswith("1 of 1 certificates VERIFIED\n")
