"""Pairs that are given more than once: they count each time, and it is said."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import certreg as run
from commands import write_csv

import certreg
from certreg.report.pages import html_page, report_on

if TYPE_CHECKING:
    from pathlib import Path

TURNS: dict[str, Any] = {"rotation_only": True, "objective": "truncated"}
KINDS: list[dict[str, Any]] = [{}, {"scale": "asymmetric"}, TURNS]
RNG = np.random.default_rng(2)
X = RNG.standard_normal((12, 3))
X /= np.linalg.norm(X, axis=1)[:, np.newaxis]
Y = X + RNG.uniform(-0.01, 0.01, X.shape)
Y[8:] = X[8:] @ np.diag([-1.0, -1.0, 1.0]) + RNG.uniform(-0.3, 0.3, (4, 3))  # wrong
EACH = (
    " and count each time: among the pairs within, and as independent measurements in the least "
    "squares"
)
TWO = f"pairs are repeated (rows 12, 13, counting from 0, have the points of earlier ones),{EACH}"
ONE = f"pairs are repeated (row 12, counting from 0, has the points of an earlier one),{EACH}"


def certified(rows: list[int], **model: Any) -> Any:
    """Of all pairs, and of these again."""
    every = [*range(12), *rows]
    return certreg.certify(X[every], Y[every], max_residual=0.05, **model)


@pytest.mark.parametrize("model", KINDS)
@pytest.mark.parametrize(("rows", "said"), [([], None), ([3], ONE), ([3, 0], TWO), ([9], None)])
def test_repeated_pairs_within_are_told(model, rows, said):
    found = certified(rows, **model)
    page = html_page(report_on(found)).decode()

    assert [label == "inlier" for label in found.labels[:12]] == [True] * 8 + [False] * 4
    assert found.notes == (() if said is None else (said,))
    assert ("repeated" in page) == ("repeated" in str(found)) == (said is not None)
    assert said is None or f"\n  warning           {said}" in str(found)
    assert said is None or f"P{said[1:]}." in page
    assert [one for one in found.to_dict()["notes"] if "repeated" in one] == list(found.notes)


def test_pairs_that_share_one_point_are_not_repeated():
    source, target = np.vstack([X, X[:2]]), np.vstack([Y, Y[:2]])
    target[12, 0] += 1e-9
    found: Any = certreg.certify(source, target, max_residual=0.05)

    assert found.lower == 10
    assert "(row 13, counting from 0, has" in found.notes[0]


def test_zeros_of_either_sign_are_one_number():
    source = np.vstack([X, [[0.0, 0.0, 0.0], [-0.0, 0.0, -0.0]]])
    target = np.vstack([Y, [[0.0, 0.0, 0.0], [0.0, -0.0, 0.0]]])
    found: Any = certreg.certify(source, target, max_residual=0.05)

    assert "(row 13, counting from 0, has" in found.notes[0]


def test_few_pairs_are_no_more_by_being_repeated():
    three = [0, 1, 2]
    rng = np.random.default_rng(5)
    others = rng.uniform(-3.0, 3.0, (2, 9, 3))
    source, target = (
        np.vstack([points[three * 4], more]) for points, more in zip((X, Y), others, strict=True)
    )
    found: Any = certreg.certify(source, target, max_residual=0.05)

    assert found.lower == 12
    assert [one.text for one in found.warnings] == [
        "so few different pairs, 3 of 12, may agree by chance, even where all pairs are wrong"
    ]
    assert certified([3]).warnings == ()


def test_a_file_of_pairs_says_it_beside_the_note_of_the_reader(tmp_path: Path):
    clouds = [
        write_csv(tmp_path / name, one.tolist()) for name, one in (("a.csv", X), ("b.csv", Y))
    ]
    (tmp_path / "p.csv").write_text("".join(f"{k},{k}\n" for k in [*range(12), 3]), "utf-8")
    asked = "certify", *clouds, "--pairs", tmp_path / "p.csv", "--max-residual", "0.05"
    told = run(*asked, "--json").document["notes"]

    assert "not one to one: 1 row of the source and 1 of the target are in" in told[0]
    assert told[1] == ONE.replace("row 12", "row 12 (source row 3 and target row 3)")
