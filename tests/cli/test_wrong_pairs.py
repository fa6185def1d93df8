"""What a long search says on a terminal."""

from __future__ import annotations

import logging
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from commands import certreg as run

import certreg
from certreg.cli import wrong_pairs
from certreg.cli.main import main

if TYPE_CHECKING:
    from pathlib import Path as Folder

TOLD = "8 of 8 pairs within their bounds, at most 8 (proved); searching on ..."


def clouds(folder: Folder) -> list[str]:
    """Two files of the same points."""
    names = [str(folder / name) for name in ("a.csv", "b.csv")]
    points = np.random.default_rng(0).uniform(size=(8, 3))
    for name in names:
        Path(name).write_text(
            "\n".join(",".join(map(repr, row)) for row in points.tolist()), encoding="utf-8"
        )
    return names


@pytest.mark.usefixtures("compiled")
@pytest.mark.parametrize(
    ("terminal", "patience", "told"), [(1, -1.0, 1), (0, -1.0, 0), (1, 9.0, 0)]
)
def test_a_search_that_takes_long_says_how_far_it_is(
    tmp_path, monkeypatch, capsys, terminal, patience, told
):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: bool(terminal))
    monkeypatch.setattr(wrong_pairs, "PATIENCE", patience)
    monkeypatch.setattr(
        sys, "argv", ["certreg", "certify", *clouds(tmp_path), "--max-residual", ".1"]
    )
    with pytest.raises(SystemExit) as stop:
        main()
    assert not stop.value.code
    assert (TOLD in capsys.readouterr().err) == bool(told)
    assert not logging.getLogger(wrong_pairs.SEARCH).handlers


def test_options_of_the_least_squares_act_on_them(tmp_path):
    source, target = clouds(tmp_path)
    lines = Path(target).read_text("utf-8").splitlines()
    Path(target).write_text("\n".join(lines[-1:] + lines[1:]), "utf-8")  # one wrong pair
    asked = "certify", source, target, "--max-residual", "0.1", "--json"
    plain = run(*asked, "--no-relaxation", "--no-simulation").document
    best = run(*asked, "--damping", "optimal").document
    told = run(
        *asked, "--damping", "3", "--integrator", "euler", "--robustness-angle", "2"
    ).document

    assert best["damping"] == plain["damping"] != 3.0
    assert told["damping"] == 3.0
    assert told["simulation"]["integrator"] == "euler"
    assert told["robustness"]["angle_deg"] == 2.0
    assert plain["robustness"]["angle_deg"] == 5.0
    assert plain["reasons"]["simulation"].endswith("--integrator NAME (simulation)")


@pytest.mark.parametrize(
    ("bounds", "more", "said"),
    [
        ("0.1\n" * 7, (), "bounds.txt: holds 7 bounds, the source has 8 rows: give one bound for"),
        ("0.1\n" * 9, (), "bounds.txt: holds 9 bounds, the source has 8 rows: give one bound for"),
        ("0.1\n" * 3, ("--pairs", "pairs.csv"), "holds 3 bounds, the source has 8 rows"),
        ("0.1\n0\n" * 4, (), "bounds.txt: bound 1 (counting from 0) is 0.0: a bound must be fin"),
        ("7\n" * 8, (), "bounds.txt is 7, not below half the diameter of the smaller cloud, "),
        ("7\n9\n" * 4, (), "bounds.txt is 7 at least, not below half the diameter of the smaller"),
        ("0.1\n" * 8, ("--rotation-only",), "inliers are counted for motions with a translation"),
    ],
)
def test_bounds_in_a_file_are_refused_by_its_name(tmp_path, bounds, more, said):
    (tmp_path / "bounds.txt").write_text(bounds, "utf-8")
    (tmp_path / "pairs.csv").write_text("0,0\n5,5\n2,2\n", "utf-8")
    given = [tmp_path / one if one.endswith("csv") else one for one in more]
    asked = "certify", *clouds(tmp_path), "--max-residual", tmp_path / "bounds.txt", *given
    refused = run(*asked)

    assert refused.code == 2
    assert said in refused.err
    assert "max_residual" not in refused.err
    lines = [line for line in refused.err.splitlines() if not line.startswith("note: ")]
    assert len(lines) == 1


@pytest.mark.parametrize(
    ("bound", "more", "said"),
    [
        ("7", (), "--max-residual is 7, not below half the diameter of the smaller cloud, "),
        ("0", (), "--max-residual is 0.0: a bound must be finite and > 0"),
        ("0,1", (), "--max-residual 0,1: '0,1' has a comma: with a decimal point type 0.1"),
        ("wide", (), "--max-residual wide: neither a number nor a file"),
        ("0.1", ("--effort", "0"), "--effort is 0.0: give a number above 0, at most 1000000"),
        ("0.1", ("--rotation-only",), "or add --objective truncated (objective='truncated')"),
    ],
)
def test_a_bound_is_refused_by_the_name_of_the_option(tmp_path, bound, more, said):
    refused = run("certify", *clouds(tmp_path), "--max-residual", bound, *more)
    assert refused.code == 2
    assert said in refused.err.splitlines()[-1]


def test_bounds_go_with_their_rows(tmp_path):
    (tmp_path / "bounds.txt").write_text("0.1\n0.2\n" * 4, "utf-8")
    (tmp_path / "pairs.csv").write_text("0,0\n5,5\n2,2\n7,7\n", "utf-8")
    asked = "certify", *clouds(tmp_path), "--max-residual", tmp_path / "bounds.txt"
    run(*asked, "--pairs", tmp_path / "pairs.csv", "--out", tmp_path / "o")
    table = (tmp_path / "o" / "fit.csv").read_text("utf-8").splitlines()[1:]
    assert [line.split(",")[3] for line in table] == ["0.1", "0.2", "0.1", "0.2"]


def test_the_log_tells_it_too(monkeypatch):
    told: list[str] = []
    log = logging.getLogger(wrong_pairs.SEARCH)
    monkeypatch.setattr(log, "info", lambda words, *numbers: told.append(words % numbers))
    points = np.random.default_rng(0).uniform(size=(8, 3))
    certreg.certify(points, points, max_residual=0.1)
    assert told[-1] == TOLD


def test_how_far_a_proof_is_is_said_now_and_then(monkeypatch, capsys):
    monkeypatch.setattr(wrong_pairs, "PATIENCE", -1.0)
    handler, words = wrong_pairs._Patient(), ["3 ranges", "5 ranges", "found"]
    names = (wrong_pairs.PROOF, wrong_pairs.PROOF, wrong_pairs.SEARCH)
    for text, name in zip(words, names, strict=True):
        handler.emit(logging.LogRecord(name, logging.INFO, "", 0, text, (), None))

    assert capsys.readouterr().err == "3 ranges\nfound\n"
    monkeypatch.setattr(wrong_pairs, "AGAIN", 0.0)
    handler.emit(logging.LogRecord(wrong_pairs.PROOF, logging.INFO, "", 0, "7 ranges", (), None))
    assert capsys.readouterr().err == "7 ranges\n"


def test_a_proof_of_a_free_scale_says_how_many_ranges_are_open(monkeypatch):
    told: list[str] = []
    log = logging.getLogger(wrong_pairs.PROOF)
    monkeypatch.setattr(log, "info", lambda words, *numbers: told.append(words % numbers))
    points = np.random.default_rng(0).uniform(-1.0, 1.0, (2, 14, 3))
    certreg.certify(*points, max_residual=0.06, scale="asymmetric")

    assert any(words.endswith("still open; proving on ...") for words in told)


def test_a_remedy_is_named_once_for_all_that_was_typed(tmp_path):
    typed = ("--max-residual", "0.1", "--rotation-only", "--objective", "truncated")
    refused = run("certify", *clouds(tmp_path), *typed, "--normals", tmp_path / "none.npy")

    assert refused.code == 2
    remedy = "leave out --rotation-only (rotation_only=) and --objective (objective=)\n"
    assert refused.err.endswith(remedy)
