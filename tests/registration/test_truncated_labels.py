"""Labels of rotations: every set of few pairs is judged as an exhaustive search judges it."""

from __future__ import annotations

import json
from dataclasses import replace
from importlib.resources import files
from itertools import product
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import pytest
from commands import certreg as command
from commands import write_csv
from jsonschema import Draft202012Validator
from rotated_pairs import BOUND, RotatedPairs, rotated_pairs

import certreg
from certreg.errors import InvalidProblemError
from certreg.registration.label_assessment import TruncatedLabels
from certreg.registration.labelled import TruncatedRegistration

if TYPE_CHECKING:
    from pathlib import Path

N = 7
TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
MODEL: dict[str, Any] = {"rotation_only": True, "objective": "truncated"}


def judged(source, target, labels, bound: Any = BOUND, **options: Any) -> TruncatedLabels:
    kept = certreg.assess(source, target, labels=labels, max_residual=bound, **MODEL, **options)
    return cast("TruncatedLabels", kept)


def least_costs(given: RotatedPairs) -> dict[tuple[int, ...], tuple[float, set[int]]]:
    """Of each set of pairs: the least of its squares and the others' 1, and which are within there.

    By singular values: nothing of it is in quaternions.
    """
    n, weights = len(given.source), 1.0 / given.bounds**2
    found: dict[tuple[int, ...], tuple[float, set[int]]] = {}
    for kept in product((False, True), repeat=n):
        rows = np.flatnonzero(kept)
        x, y, w = given.source[rows], given.target[rows], weights[rows]
        U, _, V = np.linalg.svd((w[:, np.newaxis] * y).T @ x)
        R = U @ np.diag([1.0, 1.0, np.linalg.det(U @ V)]) @ V
        ratios = weights * ((given.target - given.source @ R.T) ** 2).sum(axis=1)
        cost = float(ratios[rows].sum()) + n - len(rows)
        found[tuple(rows.tolist())] = cost, set(np.flatnonzero(ratios <= 1.0).tolist())
    return found


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, pytest.param(range(1, 21), marks=pytest.mark.long)])
def test_every_set_is_judged_as_an_exhaustive_search_judges_it(seed: int | range):
    for one in [seed] if isinstance(seed, int) else seed:
        rng = np.random.default_rng(one)
        given = rotated_pairs(rng, N, rng.choice([0.2, 0.4, 0.6]))
        given = replace(given, bounds=np.where(rng.random(N) < 0.5, BOUND, 6.0 * BOUND))
        optimum = certreg.certify(given.source, given.target, max_residual=given.bounds, **MODEL)
        assert isinstance(optimum, TruncatedRegistration)
        costs = least_costs(given)
        least = min(cost for cost, _ in costs.values())
        for rows, (cost, within) in costs.items():
            kept = TruncatedLabels.of(optimum, rows)
            best = cost < least + 1e-9
            assert kept.verdict.value == ("consistent" if best else "refuted")
            assert kept.disproved is not best
            if best:
                assert set(rows) == within


@pytest.fixture(scope="module")
def given() -> RotatedPairs:
    return rotated_pairs(np.random.default_rng(3), 12, 0.5)


@pytest.fixture(scope="module")
def right(given: RotatedPairs) -> TruncatedLabels:
    return judged(given.source, given.target, given.true)


@pytest.mark.slow
def test_the_labels_of_the_optimum_are_consistent(right: TruncatedLabels):
    assert right.headline == (
        "CONSISTENT: at every optimum of the truncated cost these 6 pairs are within 0.0554, and "
        "only these: proved."
    )
    assert (right.exit_code, right.disproved, right.differing) == (0, False, ())
    assert repr(right) == "<TruncatedLabels: 6 of 12 pairs; consistent>"
    assert "  labelled inliers  6\n  truncated cost    6.75231045\n" in str(right)
    assert "proved labels     6 inliers, 6 outliers, 0 undecided" in str(right)
    assert "CONSISTENT" in right._repr_html_()


@pytest.mark.slow
def test_wrong_labels_are_refuted_by_one_matrix_and_named(right: TruncatedLabels):
    kept = TruncatedLabels.of(right.optimum, (0, 1, 2, 4, 6, 8, 11))
    assert kept.headline == (
        "REFUTED: no optimum of the truncated cost has just these 7 pairs within 0.0554, by one "
        "4x4 matrix. At every optimum row 0 (from 0) has the other label: proved."
    )
    assert (kept.exit_code, kept.differing) == (1, (0,))
    fewer = TruncatedLabels.of(right.optimum, (0, 1, 2, 4))
    assert (
        "At every optimum rows 0, 6, 8, 11 (from 0) have the other label: proved." in fewer.headline
    )


@pytest.mark.slow
def test_the_matrix_disproves_where_nothing_is_proved_of_the_optimum(right: TruncatedLabels):
    nothing = replace(right.optimum, certificate=None, labels=("undecided",) * 12)
    kept = TruncatedLabels.of(nothing, (0, 1, 2))
    assert kept.headline.endswith(
        "by one 4x4 matrix. Which labels are wrong is not proved. Of the 12 pairs 12 are undecided "
        "(rows 0, 1, 2, 3, 4, 5, 6, 7 and 4 others, counting from 0)."
    )
    assert kept.exit_code == 1
    document = kept.to_dict()
    assert document["reasons"] == {"optimum.gap": right.optimum.verdict.words}
    assert errors(document) == []


@pytest.mark.slow
def test_a_proved_label_refutes_without_the_matrix(right: TruncatedLabels):
    kept = replace(right, rows=(0, *right.rows))
    assert kept.headline == (
        "REFUTED: no optimum of the truncated cost has just these 7 pairs within 0.0554. At every "
        "optimum row 0 (from 0) has the other label: proved."
    )


@pytest.mark.slow
@pytest.mark.parametrize("row", range(12))
def test_labels_of_which_one_is_not_proved_are_not_decided(right: TruncatedLabels, row: int):
    """However unique the rotation is."""
    labels = tuple("undecided" if k == row else w for k, w in enumerate(right.optimum.labels))
    kept = replace(right, optimum=replace(right.optimum, labels=labels))

    assert right.optimum.unique
    assert (kept.exit_code, kept.verdict.value, kept.differing) == (4, "undecided", ())


@pytest.mark.slow
def test_one_of_two_optima_is_not_decided():
    source, target = np.vstack([np.eye(3)] * 2), np.vstack([TURN.T, TURN])
    kept = judged(source, target, [1, 1, 1, 0, 0, 1], 0.25)
    assert kept.headline == (
        "UNDECIDED: it is not proved that an optimum of the truncated cost has just these 4 pairs "
        "within 0.25, nor that none has. Of the 6 pairs 4 are undecided (rows "
        "0, 1, 3, 4, counting from 0)."
    )
    assert kept.exit_code == 4
    few = TruncatedLabels.of(kept.optimum, (0, 1))
    assert few.headline.endswith(
        "At every optimum rows 2, 5 (from 0) have the other label: proved. Of the 6 pairs 4 are "
        "undecided (rows 0, 1, 3, 4, counting from 0)."
    )
    single = replace(
        kept.optimum, labels=("undecided", *["inlier"] * 2, *["outlier"] * 2, "inlier")
    )
    assert (
        "Of the 6 pairs 1 is undecided (row 0, counting from 0)."
        in replace(kept, optimum=single).headline
    )


def errors(document: Any) -> list[str]:
    text = files("certreg.report") / "schemas" / "certreg-truncated-labels-1.json"
    validator = Draft202012Validator(json.loads(text.read_text("utf-8")))
    return [error.message for error in validator.iter_errors(document)]


@pytest.mark.parametrize(
    ("labels", "options", "words"),
    [
        ([1] * 5, {}, r"labels has shape \(5,\): give \(6,\), one for each pair"),
        ([1] + [0] * 5, {}, "labels name 1 inlier: give at least 2, as a single pair of equal l"),
        ([1] * 6, {"rotation_only": False}, "truncated squares go without a translation for now"),
        ([1] * 6, {"objective": "least"}, "objective is 'least': give 'consensus' or 'truncated'"),
        ([1] * 6, {"effort": 0.0}, "effort is 0.0: give a number above 0"),
        ([1] * 6, {"max_residual": None}, "go together, without a pose: give max_residual"),
        (None, {}, "labels and max_residual go together, without a pose: give labels"),
        (None, {"max_residual": None}, "labels and max_residual go together, without a pose: give"),
    ],
)
def test_what_is_refused_is_refused_in_one_line(labels, options, words: str):
    cloud = np.vstack([np.eye(3), -np.eye(3)])
    stated: dict[str, Any] = {"labels": labels, "max_residual": 0.1, **MODEL, **options}
    with pytest.raises(InvalidProblemError, match=words):
        certreg.assess(cloud, cloud, **stated)


@pytest.mark.slow
def test_the_command(given: RotatedPairs, tmp_path: Path):
    source = write_csv(tmp_path / "a.csv", given.source.tolist())
    target = write_csv(tmp_path / "b.csv", given.target.tolist())
    options = ("--max-residual", str(BOUND), "--objective", "truncated", "--rotation-only")
    right, wrong = tmp_path / "right.txt", tmp_path / "wrong.txt"
    right.write_text("\n".join(str(int(one)) for one in given.true) + "\n", "utf-8")
    wrong.write_text("1\n" * 12, "utf-8")

    found = command("assess", source, target, "--labels", right, *options, "--json")
    assert (found.code, errors(found.document)) == (0, [])
    assert found.document["labels"]["inliers"] == np.flatnonzero(given.true).tolist()
    refuted = command("assess", source, target, "--labels", wrong, *options)
    assert refuted.code == 1
    assert refuted.out.startswith("REFUTED: no optimum of the truncated cost has just these 12")
    refused = command("assess", source, target, "--labels", wrong, *options[:-1])
    assert refused.code == 2
    assert "give --rotation-only" in refused.err
