"""`--json` where there is no result: one object that says why, as `batch` gives it for a pair."""

from __future__ import annotations

import json
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import certreg, write_csv
from jsonschema import Draft202012Validator

from certreg.cli import dynamics, judging
from certreg.errors import ContradictionError, UndecidedError

if TYPE_CHECKING:
    from pathlib import Path

SCHEMA = files("certreg.report") / "schemas" / "certreg-error-1.json"
KINDS = {4: UndecidedError, 1: ContradictionError}
TURNS = ("--rotation-only", "--objective", "truncated")
POINTS = np.random.default_rng(4).uniform(-1.0, 1.0, (12, 3))


@pytest.fixture(name="clouds")
def _clouds(tmp_path: Path) -> list[Path]:
    """Two of one body in two units."""
    return [write_csv(tmp_path / f"{unit}.csv", (unit * POINTS).tolist()) for unit in (1.0, 1000.0)]


def require_told(asked: tuple[Any, ...], code: int, begun: str) -> None:
    """That the object says what the one line does, and is printed for `--json` alone."""
    told, plain = certreg(*asked, "--json"), certreg(*asked)

    assert (told.code, plain.code) == (code, code)
    assert plain.out == ""
    assert told.err == plain.err
    assert told.document == {
        "schema": "certreg-error/1",
        "exit_code": code,
        "error": {
            "kind": KINDS[code].__name__,
            "message": told.err.removeprefix("certreg: ").rstrip(),
        },
    }
    assert told.document["error"]["message"].startswith(begun)
    Draft202012Validator(json.loads(SCHEMA.read_text("utf-8"))).validate(told.document)


@pytest.mark.parametrize(
    ("options", "begun"),
    [
        ((), "no rigid motion brings 3 pairs within their bounds: no three of them keep"),
        (TURNS, "no rotation brings a pair within its bound: the two points of each are at"),
    ],
)
def test_where_no_motion_meets_enough_pairs(clouds, options, begun):
    require_told(("certify", *clouds, "--max-residual", "0.01", *options), 4, begun)


@pytest.mark.parametrize("code", [4, 1])
@pytest.mark.parametrize(
    ("command", "module", "step"),
    [
        (("assess", "--pose"), judging, "judged"),
        (("equilibria",), dynamics, "listed"),
        (("simulate",), dynamics, "run"),
    ],
)
def test_of_every_command_with_that_option(clouds, monkeypatch, command, module, step, code):
    def fail(*_: Any, **__: Any) -> None:
        raise KINDS[code]("two paths met")

    (clouds[0].parent / "pose.txt").write_text("1 0 0 0 0 0 0", "utf-8")
    pose = [clouds[0].parent / "pose.txt"] * (len(command) - 1)
    monkeypatch.setattr(module, step, fail)
    require_told((command[0], *clouds, *command[1:], *pose), code, "two paths met")


@pytest.mark.parametrize("bound", ["-1", "1e9", "wide"])
def test_of_bad_usage_there_is_a_line_on_standard_error_alone(clouds, bound):
    run = certreg("certify", *clouds, "--max-residual", bound, "--json")

    assert (run.code, run.out) == (2, "")
