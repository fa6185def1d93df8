"""Labels from the table that certify itself writes of pairs that may be wrong: fit.csv."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import certreg as run
from commands import write_csv

from certreg.io.labels import csv_field
from certreg.io.pairing import Pairing
from certreg.io.problems import read_problem
from certreg.io.row_values import PAIR_COLUMNS, read_inliers

if TYPE_CHECKING:
    from pathlib import Path

N, WRONG = 12, 4
NAMES = [*"abcdefghi", "k, l", 'm "n"', "=1+1"]
RNG = np.random.default_rng(4)
X = RNG.uniform(-1.0, 1.0, (N, 3))
Y = X[:, [1, 2, 0]] + RNG.uniform(-0.02, 0.02, X.shape)
Y[:WRONG] *= -1.0
BOUND = ("--max-residual", "0.05")
TURNED = (*BOUND, "--rotation-only", "--objective", "truncated")


@pytest.fixture(name="clouds")
def _clouds(tmp_path: Path) -> list[Path]:
    """With labels."""
    clouds, fields = (("a.csv", X), ("b.csv", Y)), [csv_field(name) for name in NAMES]
    return [write_csv(tmp_path / name, points.tolist(), fields) for name, points in clouds]


@pytest.fixture(name="table")
def _table(clouds: list[Path]) -> Path:
    out = clouds[0].parent / "o"
    run("certify", *clouds, *BOUND, "--out", out)
    return out / "fit.csv"


def changed(table: Path, change: Any) -> Path:
    """The same with other rows."""
    rows = list(csv.reader(io.StringIO(table.read_text("utf-8"))))
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(change(rows))
    path = table.with_name("changed.csv")
    path.write_text(text.getvalue(), "utf-8")
    return path


@pytest.mark.parametrize("options", [BOUND, TURNED])
def test_what_certify_writes_is_judged_as_it_found(clouds, tmp_path, options):
    run("certify", *clouds, *options, "--out", tmp_path / "o")
    told = run("assess", *clouds, "--labels", tmp_path / "o" / "fit.csv", *options)

    assert told.out.startswith("CONSISTENT: ")
    assert told.code == 0


@pytest.mark.parametrize(
    "change",
    [
        lambda rows: rows,
        lambda rows: [rows[0], *rows[:0:-1]],
        lambda rows: [rows[0], *([*one[:4], "01"[one[4] == "inlier"]] for one in rows[1:])],
    ],
)
def test_it_is_read_in_any_order_of_its_rows_and_with_digits(clouds, table, change):
    _, pair = read_problem(*clouds)

    assert read_inliers(changed(table, change), pair) == [False] * WRONG + [True] * (N - WRONG)


def test_its_rows_are_pairs_and_not_rows_of_the_source(tmp_path):
    clouds = [write_csv(tmp_path / n, p.tolist()) for n, p in (("c.csv", X), ("d.csv", Y))]
    file = tmp_path / "p.csv"
    file.write_text("".join(f"{k},{k}\n" for k in (11, 0, 5, 6, 7)), "utf-8")
    given = "--pairs", file, *BOUND
    run("certify", *clouds, *given, "--out", tmp_path / "o")
    _, pair = read_problem(*clouds, pairing=Pairing(pairs=file))

    labels = read_inliers(tmp_path / "o" / "fit.csv", pair)
    assert labels == [True, False, True, True, True]
    (tmp_path / "all.txt").write_text("0\n" * WRONG + "1\n" * (N - WRONG), "utf-8")
    assert read_inliers(tmp_path / "all.txt", pair) == labels


def with_field(row: int, column: str, text: str) -> Any:
    """A change of one field."""

    def change(rows: list[list[str]]) -> list[list[str]]:
        rows[row][PAIR_COLUMNS.index(column)] = text
        return rows

    return change


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda rows: rows[:-1], "holds 11 labels, there are 12 pairs: give one for each of them"),
        (lambda rows: [*rows, rows[1]], "holds 13 labels, there are 12 pairs: give one for each"),
        (with_field(2, "row", "0"), "line 3: row 0 comes twice: give each pair one row"),
        (with_field(2, "row", "12"), "line 3: row 12 of 12 pairs, from 0: give each pair one row"),
        (with_field(2, "row", "one"), "line 3, row: "),
        (with_field(2, "proved", "undecided"), "line 3, proved: 'undecided' is no label: write 0 "),
        (
            with_field(2, "label", "q"),
            "row 1 is called 'q', that of the clouds 'b': give the table",
        ),
        (
            lambda rows: [*rows[:3], rows[3][:4], *rows[4:]],
            "line 4: 4 columns, not 5: mend the row",
        ),
        (with_field(0, "proved", "said"), "a table whose columns are not row, label, residual, bo"),
    ],
)
def test_another_table_is_refused_in_one_line(clouds, table, change, said):
    refused = run("assess", *clouds, "--labels", changed(table, change), *BOUND)

    assert (refused.code, refused.out) == (2, "")
    assert f"changed.csv{', ' if said.startswith('line') else ''}" in refused.err
    assert said in refused.err
    assert refused.err.count("\n") == 1


def test_the_table_of_a_plain_fit_says_what_to_give(clouds, tmp_path):
    run("certify", *clouds, "--no-relaxation", "--no-simulation", "--out", tmp_path / "o")
    refused = run("assess", *clouds, "--labels", tmp_path / "o" / "fit.csv", *BOUND)

    assert refused.code == 2
    assert "fit.csv, line 1: a table whose columns are not row, label, res" in refused.err
    assert "give one label a line, or fit.csv of certify --max-residual" in refused.err
