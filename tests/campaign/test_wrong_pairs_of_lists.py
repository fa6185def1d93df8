"""Lists of pairs whose rows may be wrong: bounds by options, by columns and in files."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from campaign_work import InProcess
from commands import certreg, strict_json
from jsonschema import Draft202012Validator

import certreg as package

SCHEMA = Path(package.__file__).parent / "report" / "schemas" / "certreg-result-1.json"
N, WRONG, BOUND = 14, 4, 0.05
RNG = np.random.default_rng(5)
X = RNG.uniform(-1.0, 1.0, (N, 3))
Y = X[:, [1, 2, 0]] + RNG.uniform(-0.02, 0.02, (N, 3))
Y[:WRONG] *= -1.0
COLUMNS = "source,target,max_residual,objective,rotation_only,effort,scale,damping,normals"
ROWS = {  # and what certify is told
    "0.05,,,,,,": ("--max-residual", "0.05"),
    "bounds.txt,,,2,,optimal,": ("--max-residual", "bounds.txt", "--effort", "2"),
    "0.05,truncated,yes,,,,": [
        "--max-residual",
        "0.05",
        "--objective",
        "truncated",
        "--rotation-only",
    ],
    "0.05,,,,asymmetric,,": ("--max-residual", "0.05", "--scale", "asymmetric"),
    "0.05,,,,,,n.npy": ("--max-residual", "0.05", "--normals", "n.npy"),
    ",,,,,,": (),
}


@pytest.fixture(autouse=True)
def in_process(monkeypatch):
    """No worker processes: they would each load the solver for a second."""
    monkeypatch.setattr("certreg.cli.campaigns.workers_at", lambda _: InProcess(1))


@pytest.fixture(name="listed")
def _listed(tmp_path: Path) -> Path:
    np.savetxt(tmp_path / "a.csv", X, "%.17g", ",")
    np.savetxt(tmp_path / "b.csv", Y, "%.17g", ",")
    np.savetxt(tmp_path / "bounds.txt", np.linspace(0.04, 0.06, N), "%.17g")
    np.save(tmp_path / "n.npy", np.eye(3)[np.arange(N) % 3])
    return tmp_path


def written(folder: Path, *rows: str) -> Path:
    path = folder / "pairs.csv"
    lines = [COLUMNS, *(f"a.csv,b.csv,{row}" for row in rows)]
    path.write_text("\n".join([*lines, ""]), "utf-8")
    return path


@pytest.mark.slow
def test_a_row_with_bounds_is_what_certify_makes_of_it(listed: Path, monkeypatch):
    monkeypatch.chdir(listed)
    out = listed / "out"
    run = certreg("batch", written(listed, *ROWS), "--out", out)
    entries = [strict_json(line) for line in (out / "results.jsonl").read_bytes().splitlines()]
    with (out / "summary.csv").open(encoding="utf-8") as stream:
        table = list(csv.DictReader(stream))

    valid = Draft202012Validator(json.loads(SCHEMA.read_text("utf-8"))).is_valid
    assert "columns not read" not in run.err
    for options, entry, row in zip(ROWS.values(), entries, table, strict=True):
        alone = certreg("certify", "a.csv", "b.csv", *options, "--json")
        told = alone.document
        same = told.keys() - {"certificate", "reasons", "timings_ms"}
        assert valid(entry)
        assert {name: entry[name] for name in same} == {name: told[name] for name in same}
        assert (entry["exit_code"], row["exit_code"]) == (alone.code, str(alone.code))
        labels = (told["consensus"] or told.get("truncated", {"labels": []}))["labels"]
        counts = [labels.count(word) for word in ("inlier", "outlier", "undecided")]
        shown = [row[name] for name in ("inliers", "outliers", "undecided")]
        assert shown == (list(map(str, counts)) if options else [""] * 3)
        most = told["consensus"]["upper"] if told["consensus"] else ""
        assert row["most_within"] == str(most)
        model = [one for one in options if one not in {"--effort", "2"}]
        path = out / entry["certificate"]
        assert certreg("verify", path, "a.csv", "b.csv", *model).out.endswith("VERIFIED\n")
    assert entries[0]["consensus"]["labels"] == ["outlier"] * WRONG + ["inlier"] * (N - WRONG)


def test_the_option_is_for_rows_that_say_nothing(listed: Path):
    path, out = written(listed, ",,,,,,", "bounds.txt,,,,,,"), listed / "out"
    run = certreg("batch", path, "--max-residual", "0.05", "--effort", "0.5", "--out", out)
    entries = [strict_json(line) for line in (out / "results.jsonl").read_bytes().splitlines()]

    assert run.code == 0
    assert [entry["consensus"]["lower"] for entry in entries] == [N - WRONG] * 2
    assert [sorted(entry["inputs"]) for entry in entries] == [
        ["a.csv", "b.csv"],
        ["a.csv", "b.csv", "bounds.txt"],
    ]
    settings = json.loads((out / "campaign.json").read_text("utf-8"))["settings"]
    assert (settings["max_residual"], settings["effort"]) == ("0.05", "0.5")
    again = certreg("batch", path, "--max-residual", "0.06", "--effort", "0.5", "--out", out)
    assert again.code == 2
    assert "settings.max_residual is 0.05, here it is 0.06" in again.err


def test_other_bounds_in_a_file_are_seen(listed: Path):
    path, out = written(listed, "bounds.txt,,,,,,"), listed / "out"
    certreg("batch", path, "--out", out)
    np.savetxt(listed / "bounds.txt", np.full(N, 0.03))
    again = certreg("batch", path, "--out", out)
    assert "bounds.txt" in again.err
    (entry,) = [strict_json(line) for line in (out / "results.jsonl").read_bytes().splitlines()]
    assert entry["consensus"]["headline"].count("within 0.03")


@pytest.mark.parametrize(
    ("row", "words"),
    {
        "0,,,,,,": "max_residual is 0.0: a bound must be finite and > 0, in the unit of the clouds",
        "x.txt,,,,,,": "line 2, max_residual: 'x.txt' is neither a number nor a file: give one",
        "short.txt,,,,,,": "short.txt: holds 3 bounds, the source has 14 rows: give one bound for "
        "each of them",
        "0.05,least,,,,,": "line 2: objective is 'least': write consensus or truncated",
        "0.05,,,much,,,": "line 2, effort: 'much' is not a number: write plain decimal numbers",
        ",truncated,,,,,": "line 2: objective goes with max_residual: give that, too",
        ",,,2,,,": "line 2: effort goes with max_residual: give that, too",
    }.items(),
)
def test_what_bounds_nothing_is_an_error_of_that_pair(listed: Path, row: str, words: str):
    np.savetxt(listed / "short.txt", np.full(3, 0.05))
    entry = strict_json(certreg("batch", written(listed, row)).out)

    assert entry["exit_code"] == 2
    assert entry["error"]["message"].endswith(words)


@pytest.mark.parametrize(
    ("options", "words"),
    {
        ("--max-residual", "bounds.txt"): "give a number; files of bounds go in a column max_resid",
        ("--max-residual", "0"): "--max-residual is 0.0: a bound must be finite and > 0",
        ("--max-residual", "1", "--effort", "0"): "--effort is 0.0: give a number above 0",
        ("--objective", "truncated"): "--objective and --effort go with --max-residual",
    }.items(),
)
def test_an_option_that_bounds_nothing_is_refused_at_once(
    listed: Path, options: tuple[str, ...], words: str
):
    run = certreg("batch", written(listed, ",,,,,,"), *options)

    assert (run.code, run.out) == (2, "")
    assert words in run.err


@pytest.mark.slow
def test_rows_that_are_not_fully_proved_are_told_and_named_so(listed: Path):
    twice = np.vstack([X[:6], X[:6]])  # two motions, each with as many pairs
    np.savetxt(listed / "a.csv", twice, "%.17g", ",")
    np.savetxt(listed / "b.csv", np.vstack([X[:6], X[:6, [1, 2, 0]] + 9.0]), "%.17g", ",")
    out = listed / "out"
    run = certreg("batch", written(listed, "0.001,,,,,,"), "--out", out)
    with (out / "summary.csv").open(encoding="utf-8") as stream:
        (row,) = csv.DictReader(stream)

    assert (run.code, row["exit_code"], row["status"]) == (3, "3", "labels-not-proved")
    told = "certreg: 1 of 1 pairs is registered with the most pairs proved, but not each label: "
    assert run.err.endswith(f"{told}{row['name']}\n")
