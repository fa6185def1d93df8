"""Lists of pairs with a free scale or without a translation: by options and by columns."""

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
MODELS = {
    ",": ("asymmetric", "no"),  # as the options say
    "symmetric,yes": ("symmetric", "yes"),
    "none,no": ("none", "no"),
    ",yes": ("asymmetric", "yes"),
}


@pytest.fixture(autouse=True)
def in_process(monkeypatch):
    """No worker processes: they would each load the solver for a second."""
    monkeypatch.setattr("certreg.cli.campaigns.workers_at", lambda _: InProcess(1))


@pytest.fixture(name="listed")
def _listed(tmp_path: Path) -> Path:
    rng = np.random.default_rng(4)
    source = rng.normal(size=(6, 3))
    np.savetxt(tmp_path / "a.csv", source, "%.17g", ",")
    target = 2.5 * source[:, [1, 2, 0]] + 0.01 * rng.normal(size=(6, 3)) + [1, 2, 3]
    np.savetxt(tmp_path / "b.csv", target, "%.17g", ",")
    return tmp_path


def written(folder: Path, *rows: str) -> Path:
    path = folder / "pairs.csv"
    lines = ["source,target,scale,rotation_only", *(f"a.csv,b.csv,{row}" for row in rows)]
    path.write_text("\n".join([*lines, ""]), "utf-8")
    return path


@pytest.mark.slow
def test_rows_say_their_model_and_the_options_what_the_others_have(listed: Path) -> None:
    out = listed / "out"
    run = certreg("batch", written(listed, *MODELS), "--scale", "asymmetric", "--out", out)
    entries = [strict_json(line) for line in (out / "results.jsonl").read_bytes().splitlines()]
    with (out / "summary.csv").open(encoding="utf-8") as stream:
        table = list(csv.DictReader(stream))
    clouds = [np.loadtxt(listed / name, delimiter=",") for name in ("a.csv", "b.csv")]

    assert run.code == 0
    assert json.loads((out / "campaign.json").read_text("utf-8"))["settings"].items() >= {
        ("scale", "asymmetric"),
        ("rotation_only", "no"),
    }
    valid = Draft202012Validator(json.loads(SCHEMA.read_text("utf-8"))).is_valid
    for (scale, alone), entry, row in zip(MODELS.values(), entries, table, strict=True):
        problem = package.RegistrationProblem(*clouds, scale=scale, rotation_only=alone == "yes")
        assert valid(entry)
        assert entry["digest"] == problem.digest()
        assert package.verify(out / entry["certificate"], problem).proved
        assert row["scale"] == (repr(entry["pose"]["scale"]) if scale != "none" else "")
        assert (row["tx"] == "0.0") == (alone == "yes")


@pytest.mark.slow
def test_a_scaled_pair_of_a_list_is_what_certify_makes_of_it(listed: Path) -> None:
    options = ("--scale", "symmetric", "--rotation-only")
    entry = strict_json(certreg("batch", written(listed, ","), *options).out)
    alone = certreg("certify", listed / "a.csv", listed / "b.csv", *options, "--json").document

    for own in ("name", "place", "exit_code", "inputs"):
        entry.pop(own)
    assert {**entry, "timings_ms": 0} == {**alone, "timings_ms": 0}


def test_another_model_needs_a_new_folder(listed: Path) -> None:
    path, out = written(listed, ","), listed / "out"
    certreg("batch", path, "--out", out)
    run = certreg("batch", path, "--out", out, "--scale", "symmetric")

    assert run.code == 2
    assert "settings.scale is none, here it is symmetric" in run.err
    run = certreg("batch", path, "--out", out, "--rotation-only")
    assert run.code == 2
    assert "settings.rotation_only is no, here it is yes" in run.err


@pytest.mark.parametrize(
    ("row", "words"),
    {
        "free,": "line 2: scale is 'free': write none, asymmetric or symmetric",
        ",true": "line 2: rotation_only is 'true': write yes or no",
    }.items(),
)
def test_words_that_name_no_model_are_an_error_of_that_pair(
    listed: Path, row: str, words: str
) -> None:
    entry = strict_json(certreg("batch", written(listed, row)).out)

    assert entry["exit_code"] == 2
    assert entry["error"]["message"].endswith(words)


def test_a_pair_on_general_springs_may_have_no_translation(listed: Path) -> None:
    np.save(listed / "n.npy", np.eye(3)[[0, 1, 2, 0, 1, 2]])
    path = listed / "pairs.csv"
    path.write_text("source,target,normals\na.csv,b.csv,n.npy\n", "utf-8")
    entry = strict_json(certreg("batch", path, "--rotation-only").out)

    assert entry["exit_code"] in {0, 3}, entry
    assert entry["pose"]["translation"] == [0.0, 0.0, 0.0]


def test_a_pair_on_general_springs_has_no_free_scale_yet(listed: Path) -> None:
    np.save(listed / "n.npy", np.eye(3)[[0, 1, 2, 0, 1, 2]])
    path = listed / "pairs.csv"
    path.write_text("source,target,normals\na.csv,b.csv,n.npy\n", "utf-8")
    entry = strict_json(certreg("batch", path, "--scale", "asymmetric").out)

    assert entry["exit_code"] == 2
    assert "not yet with a free scale" in entry["error"]["message"]
