"""What commands say and end with where there is no result, a library is missing, options clash."""

from __future__ import annotations

import json
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import certreg, write_csv
from jsonschema import Draft202012Validator

from certreg import __version__, _loading
from certreg.campaign.pairs import PairCampaign, Tally
from certreg.cli import campaigns, dynamics, judging, memory, progress
from certreg.cli import main as program
from certreg.errors import ContradictionError, MissingToolError, UndecidedError

if TYPE_CHECKING:
    from pathlib import Path


POINTS = np.random.default_rng(5).standard_normal((5, 3)).tolist()


@pytest.mark.parametrize("name", ["scipy", "clarabel", "numpy"])
def test_a_library_that_a_command_misses_is_named_and_the_command_was_misused(
    monkeypatch: pytest.MonkeyPatch, name: str
):
    error = ModuleNotFoundError(f"No module named '{name}'", name=name)
    monkeypatch.setattr(_loading, "_installed", lambda _: False)

    def miss(**_: Any) -> None:
        raise error

    monkeypatch.setattr(program, "cli", type("Cli", (), {"main": staticmethod(miss)}))
    run = certreg("certify")

    assert (run.code, run.out) == (2, "")
    assert run.err == f"certreg: {_loading.refusal(name, error, 'this command')}\n"
    assert f"this command needs {name}, which is not installed: pip install {name}" in run.err


def test_a_library_of_nobody_is_a_defect(monkeypatch: pytest.MonkeyPatch):
    def miss(**_: Any) -> None:
        raise ModuleNotFoundError("No module named 'certreg.lost'", name="certreg.lost")

    monkeypatch.setattr(program, "cli", type("Cli", (), {"main": staticmethod(miss)}))
    with pytest.raises(ModuleNotFoundError, match=r"certreg\.lost"):
        certreg("certify")


@pytest.fixture
def clouds(tmp_path: Path) -> tuple[Path, Path]:
    names = [f"P{k}" for k in range(5)]
    a = write_csv(tmp_path / "a.csv", POINTS, names)
    return a, write_csv(tmp_path / "b.csv", POINTS[::-1], names[::-1])


@pytest.mark.parametrize("match", ["all", "common"])
def test_one_to_one_goes_with_pairs_alone(clouds: tuple[Path, Path], match: str):
    run = certreg("certify", *clouds, "--one-to-one", "--match", match)

    assert run.code == 2
    assert "--one-to-one goes with --pairs" in run.err


def test_a_certificate_says_what_made_it_and_of_which_clouds(
    clouds: tuple[Path, Path], tmp_path: Path
):
    out = tmp_path / "out"
    assert certreg("certify", *clouds, "--out", out, "--no-relaxation", "--no-simulation").code == 0
    about = json.loads((out / "certificate.json").read_bytes())["about"]

    assert {name: about[name] for name in ("certreg", "source", "target", "labels")} == {
        "certreg": __version__,
        "source": "a.csv",
        "target": "b.csv",
        "labels": [f"P{k}" for k in range(5)],
    }


def test_every_demand_that_is_not_met_is_told(tmp_path: Path):
    a = write_csv(tmp_path / "a.csv", POINTS)
    b = write_csv(tmp_path / "b.csv", (2.0 * np.array(POINTS)).tolist())
    options = ("--require-fit", "--max-rmse", "0.001", "--no-relaxation", "--no-simulation")
    run = certreg("certify", a, b, *options)

    assert run.code == 4
    told = [line for line in run.err.splitlines() if line.endswith(": exit code 4")]
    assert told[0] == "certreg: the fit has warnings: exit code 4"
    assert told[1].startswith("certreg: the RMSE is ")
    assert len(told) == 2


@pytest.mark.parametrize(
    ("name", "header"),
    [("c.csv", " (header: x,y,z)"), ("C.CSV", " (header: x,y,z)"), ("c.txt", "")],
)
def test_the_header_of_what_was_moved_is_told_where_it_has_one(
    tmp_path: Path, name: str, header: str
):
    a = write_csv(tmp_path / "a.csv", POINTS)
    (tmp_path / "pose.txt").write_text("1 0 0 1\n0 1 0 2\n0 0 1 3\n", "utf-8")
    run = certreg("apply", tmp_path / "pose.txt", a, "--out", tmp_path / name)

    assert run.out.splitlines()[0] == f"5 points written to {tmp_path / name}{header}"


@pytest.mark.parametrize("count", [0, 1, 2])
def test_what_was_there_already_is_told_and_counts_for_no_rate(
    capsys: pytest.CaptureFixture[str], count: int
):
    bar = progress.Progress(5, items="pairs")
    bar.observer().begun(count)

    told = capsys.readouterr().err
    assert told == (f"note: {count} of 5 pairs were there already\n" if count else "")
    assert bar._todo == 5 - count
    bar.observer().advanced(2)
    assert bar.made == 2


def test_a_pose_is_judged_with_the_labels_of_the_rows(tmp_path: Path):
    rng = np.random.default_rng(8)
    source = rng.standard_normal((12, 3))
    target = source + 0.01 * rng.standard_normal((12, 3))
    target[4] += [0.0, 3.0, 0.0]
    names = [f"P{k}" for k in range(12)]
    a = write_csv(tmp_path / "a.csv", source.tolist(), names)
    b = write_csv(tmp_path / "b.csv", target.tolist(), names)
    (tmp_path / "pose.txt").write_text("1 0 0 0\n0 1 0 0\n0 0 1 0\n", "utf-8")

    assert (
        "row 4 (P4), counting from 0, does"
        in certreg("assess", a, b, "--pose", tmp_path / "pose.txt").out
    )


@pytest.mark.parametrize(("limit", "left"), [(1 << 29, (1 << 29) - memory.RESERVE), (1 << 20, 0)])
def test_what_loads_first_is_given_the_limit_less_what_a_command_needs(
    monkeypatch: pytest.MonkeyPatch, limit: int, left: int
):
    commands: list[list[str]] = []

    def succeeds(command: list[str]) -> bool:
        commands.append(command)
        return False

    monkeypatch.setattr(memory, "memory_limit", lambda: limit)
    monkeypatch.setattr(memory, "_succeeds", succeeds)
    with pytest.raises(MissingToolError, match=f"the {limit >> 20} MB of memory"):
        memory.require_loadable("pass")

    ((*_, code),) = commands
    assert code == memory.LIMITED.format(left) + "pass"


def test_each_limit_of_a_batch_is_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    write_csv(tmp_path / "a.csv", POINTS)
    (tmp_path / "list.csv").write_text("source,target\na.csv,a.csv\n", "utf-8")
    asked: list[PairCampaign] = []

    def keep(campaign: PairCampaign, _scheduler: str | None) -> Tally:
        asked.append(campaign)
        return Tally()

    monkeypatch.setattr(campaigns, "_streamed", keep)
    options = ("--max-gap", "1e-7", "--max-angle", "1e-5", "--max-rmse", "2")
    assert certreg("batch", tmp_path / "list.csv", *options).code == 0

    (campaign,) = asked
    assert (campaign.limits.max_gap, campaign.limits.max_angle) == (1e-7, 1e-5)
    assert (campaign.demands.max_rmse, campaign.certificates) == (2.0, False)


@pytest.mark.parametrize(
    ("option", "typed", "pointed"),
    [
        ("--sigma", "0,5", "0.5"),
        ("--damping", ",5", ".5"),
        ("--max-rmse", "1,25e-3", "1.25e-3"),
        ("--max-gap", "0,1", "0.1"),
    ],
)
def test_a_decimal_comma_is_answered_by_the_number_to_type(
    tmp_path: Path, option: str, typed: str, pointed: str
):
    cloud = write_csv(tmp_path / "a.csv", POINTS)
    run = certreg("certify", cloud, cloud, option, typed)
    words = (
        f"Invalid value for '{option}': '{typed}' has a comma: with a decimal point type {pointed}"
    )

    assert (run.code, run.out) == (2, "")
    assert words in run.err
    assert "is not a valid float" in certreg("certify", cloud, cloud, option, "1,2,3").err


SCHEMA = files("certreg.report") / "schemas" / "certreg-error-1.json"
KINDS = {4: UndecidedError, 1: ContradictionError}
TURNS = ("--rotation-only", "--objective", "truncated")
CORNERS = np.random.default_rng(4).uniform(-1.0, 1.0, (12, 3))


@pytest.fixture(name="two_units")
def _clouds(tmp_path: Path) -> list[Path]:
    """Two of one body in two units."""
    return [
        write_csv(tmp_path / f"{unit}.csv", (unit * CORNERS).tolist()) for unit in (1.0, 1000.0)
    ]


def error_object(code: int, line: str) -> dict[str, Any]:
    """What `--json` prints where a command ends with a code and one line."""
    message = line.removeprefix("certreg: ").rstrip()
    error = {"kind": KINDS[code].__name__, "message": message}
    document = {"schema": "certreg-error/1", "exit_code": code, "error": error}
    Draft202012Validator(json.loads(SCHEMA.read_text("utf-8"))).validate(document)
    return document


@pytest.mark.parametrize(
    ("options", "begun"),
    [
        ((), "no rigid motion brings 3 pairs within their bounds: no three of them keep"),
        (TURNS, "no rotation brings a pair within its bound: the two points of each are at"),
    ],
)
def test_where_no_motion_meets_enough_pairs(two_units, options, begun):
    asked = ("certify", *two_units, "--max-residual", "0.01", *options)
    told, plain = certreg(*asked, "--json"), certreg(*asked)

    assert (told.code, plain.code, plain.out, told.err) == (4, 4, "", plain.err)
    assert told.document == error_object(4, plain.err)
    assert told.document["error"]["message"].startswith(begun)


@pytest.mark.parametrize("code", [4, 1])
@pytest.mark.parametrize(
    ("command", "module", "step"),
    [
        (("assess", "--pose"), judging, "judged"),
        (("equilibria",), dynamics, "listed"),
        (("simulate",), dynamics, "run"),
    ],
)
def test_of_every_command_with_that_option(two_units, monkeypatch, command, module, step, code):
    def fail(*_: Any, **__: Any) -> None:
        raise KINDS[code]("two paths met")

    (two_units[0].parent / "pose.txt").write_text("1 0 0 0 0 0 0", "utf-8")
    pose = [two_units[0].parent / "pose.txt"] * (len(command) - 1)
    monkeypatch.setattr(module, step, fail)
    asked = (command[0], *two_units, *command[1:], *pose)
    told, plain = certreg(*asked, "--json"), certreg(*asked)

    assert (told.code, plain.code, plain.out, told.err) == (code, code, "", plain.err)
    assert told.document == error_object(code, plain.err)
    assert told.document["error"]["message"].startswith("two paths met")


@pytest.mark.parametrize("bound", ["-1", "1e9", "wide"])
def test_of_bad_usage_there_is_a_line_on_standard_error_alone(two_units, bound):
    run = certreg("certify", *two_units, "--max-residual", bound, "--json")

    assert (run.code, run.out) == (2, "")
