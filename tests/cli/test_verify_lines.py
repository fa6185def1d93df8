"""`certreg verify` of a file with a certificate a line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from commands import certreg

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
