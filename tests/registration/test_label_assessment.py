"""Labels of other methods: met by one motion, refuted in integers, and beside the most."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import pytest
from commands import certreg as command
from commands import write_csv
from test_consensus import BOUND, twins, wrong_pairs

import certreg
from certreg.certificate.joint_feasibility import CommonMotion, is_refuted
from certreg.errors import InvalidProblemError
from certreg.native.bitset_graph import colours

if TYPE_CHECKING:
    from certreg.registration.label_assessment import KeptPairs

RIGHT = [1] * 14 + [0] * 6


def judged(source, target, labels, bound: Any = BOUND) -> KeptPairs:
    kept = certreg.assess(source, target, labels=labels, max_residual=bound)
    return cast("KeptPairs", kept)


def test_labels_that_are_the_most_are_said_to_be():
    kept = judged(*wrong_pairs(1), RIGHT)
    assert kept.headline == (
        "CONSISTENT: one rigid motion brings all 14 labelled inliers within 0.05; no motion brings "
        "more than 14, and only these 14: proved."
    )
    assert (kept.exit_code, kept.unique, kept.lower, kept.upper) == (0, True, 14, 14)
    assert repr(kept) == "<KeptPairs: 14 of 20 pairs; consistent>"
    assert "  a motion: wxyz    0.9193" in str(kept)
    assert "  labelled inliers  14\n  the most          14 found, at most 14 (proved)" in str(kept)
    assert "CONSISTENT" in kept._repr_html_()


def test_fewer_labels_than_the_most():
    kept = judged(*wrong_pairs(1), ["inlier"] * 12 + ["outlier"] * 8)
    assert kept.headline.endswith(
        "within 0.05; the most is 14, proved; these are 12. Every motion that brings "
        "14 within has rows 12, 13 (from 0), too: proved."
    )
    most = kept.most
    assert most is not None
    less = replace(kept, most=replace(most, upper=16), sets=20)
    assert less.headline.endswith("the most is 14 to 16, proved; these are 12.")


def test_only_proved_inliers_are_said_to_be_in_every_motion_that_brings_as_many():
    kept = judged(*wrong_pairs(1), ["inlier"] * 12 + ["outlier"] * 8)
    most = kept.most
    assert most is not None
    for letters, said in (("ii", "rows 12, 13"), ("i?", "row 12"), ("?i", "row 13"), ("??", "")):
        told = replace(kept, most=replace(most, labels="i" * 12 + letters + "o" * 6)).headline
        end = f"Every motion that brings 14 within has {said} (from 0), too: proved."
        assert told.endswith(f"these are 12. {end}" if said else "these are 12.")

    twin = judged(*twins(), [1] * 5 + [0] * 7, 1e-3)  # another six are met, too
    assert twin.headline.endswith("the most is 6, proved; these are 5.")


def test_a_wrong_label_is_refuted_by_lengths():
    kept = judged(*wrong_pairs(1), [True] * 14 + [False] * 5 + [True])
    assert kept.headline == (
        "REFUTED: no rigid motion brings all 15 labelled inliers within 0.05, not even rows 0, 19 "
        "(from 0) together. The most pairs that one motion brings within are 14, proved."
    )
    assert kept.exit_code == 1
    assert kept.witness is None


def test_mirrored_pairs_are_refuted_by_weights():
    source = np.random.default_rng(0).uniform(size=(8, 3))
    kept = judged(source, source * [1.0, 1.0, -1.0], [1] * 8, 0.02)
    assert kept.verdict.value == "refuted"
    assert len(kept.motion.refuted) > 2


def test_the_exact_test_says_no_on_the_bound():
    # Two points 2000 apart, two 4000 apart: each must be off by 1000, and by no more.
    def rows(bound):
        return [(-1000, 0, 0, -2000, 0, 0, bound), (1000, 0, 0, 2000, 0, 0, bound)]

    assert not is_refuted(rows(1000), (1, 1))
    assert is_refuted(rows(999), (1, 1))
    assert not is_refuted(rows(1001), (1, 1))


def test_another_set_as_large_is_not_ruled_out():
    kept = judged(*twins(), [1] * 6 + [0] * 6, 1e-3)
    assert kept.headline == (
        "CONSISTENT: one rigid motion brings all 6 labelled inliers within 0.001; no motion brings "
        "more than 6, proved; another 6 are not ruled out."
    )


def test_what_is_not_decided_is_said():
    kept = replace(judged(*wrong_pairs(1), RIGHT), motion=CommonMotion())
    assert kept.headline == (
        "UNDECIDED: no rigid motion was found that brings all 14 labelled inliers within 0.05, and "
        "no proof that there is none. The most pairs that one motion brings within are 14, proved."
    )
    assert kept.exit_code == 4
    assert replace(kept, most=None).headline.endswith(
        "No motion was found that brings three pairs within."
    )
    most = kept.most
    assert most is not None
    assert replace(kept, most=replace(most, upper=15), sets=20).headline.endswith(
        "The most pairs that one motion brings within are 14 to 15, proved."
    )
    assert kept.to_dict()["reasons"] == {
        "labels.witness": "no motion was found that meets all of them"
    }


@pytest.mark.parametrize(
    ("labels", "options", "words"),
    [
        ([1] * 19, {}, r"labels has shape \(19,\): give \(20,\), one for each pair"),
        ([2] * 20, {}, r"labels\[0\] is 2: give 0 or 1, outlier or inlier"),
        ([1, 1] + [0] * 18, {}, "labels name 2 inliers: give at least 3, as two of equal lengths"),
        (RIGHT, {"max_residual": None}, "labels and max_residual go together, without a pose: gi"),
        (RIGHT, {"translation": [0, 0, 0]}, "without a pose: leave the pose out"),
        (
            RIGHT,
            {"rotation_only": True},
            "inliers are counted for motions with a translation: leave out --rotation-only",
        ),
    ],
)
def test_what_is_refused_is_refused_in_one_line(labels, options, words):
    stated: dict[str, Any] = {"labels": labels, "max_residual": BOUND, **options}
    with pytest.raises(InvalidProblemError, match=words):
        certreg.assess(*wrong_pairs(1), **stated)


def test_the_command(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    source, target = wrong_pairs(1)
    write_csv(tmp_path / "a.csv", source.tolist())
    write_csv(tmp_path / "b.csv", target.tolist())
    files = {
        "right.txt": "1\n" * 14 + "0\n" * 6,
        "wrong.csv": "inlier\n" * 15 + "outlier\n" * 5,
        "few.txt": "1\n" * 3,
        "letters.txt": "1\n" * 3 + "yes\n",
    }
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")

    def asked(name, *options):
        return command("assess", "a.csv", "b.csv", "--labels", name, *options)

    found = asked("right.txt", "--max-residual", "0.05", "--json")
    assert found.code == 0
    assert json.loads(found.out)["labels"]["inliers"] == list(range(14))
    refuted = asked("wrong.csv", "--max-residual", "0.05")
    assert refuted.code == 1
    assert refuted.out.startswith("REFUTED: ")
    truncated = ("--max-residual", "0.05", "--objective", "truncated")
    for name, options, words in (
        ("right.txt", truncated, "give --rotation-only"),
        ("few.txt", ("--max-residual", "0.05"), "few.txt: holds 3 labels, the source has 20"),
        (
            "letters.txt",
            ("--max-residual", "0.05"),
            "letters.txt, line 4: 'yes' is no label",
        ),
        (
            "right.txt",
            (),
            "give --pose, or --labels and --max-residual: a pose or",
        ),
    ):
        refused = asked(name, *options)
        assert refused.code == 2
        assert words in refused.err


def test_rows_that_exclude_each_other_are_counted_once():
    """No motion was found, and none meets two rows of a set that agree with no other of it."""
    source = np.random.default_rng(0).uniform(-1.0, 1.0, (40, 3))
    kept = judged(source, 100.0 * source, [1] * 40, 1e-3)

    assert kept.most is None
    assert (kept.lower, kept.upper) == (0, 1)
    assert "  the most          0 found, at most 1 (proved)" in str(kept)


def test_no_more_are_met_than_all_but_one_where_some_exclude_each_other():
    kept = judged(*wrong_pairs(1), [1] * 20)

    assert kept.motion.refuted
    assert replace(kept, most=None, sets=20).upper == 19
    assert replace(kept, most=None, sets=20, motion=CommonMotion()).upper == 20
    assert replace(kept, most=None).upper == kept.sets < 20
    assert kept.upper == 14 <= kept.sets


@pytest.mark.parametrize("share", [0.2, 0.5, 0.8])
def test_colours_are_no_fewer_than_the_largest_set_that_agrees(share: float):
    rng = np.random.default_rng(3)
    for _ in range(20):
        table = np.triu(rng.random((9, 9)) < share, 1)
        near = [sum(1 << j for j in range(9) if (table | table.T)[i, j]) for i in range(9)]
        sets = [
            some
            for some in range(1 << 9)
            if all(some & ~near[i] == 1 << i for i in range(9) if some >> i & 1)
        ]
        largest = max(some.bit_count() for some in sets)

        assert largest <= colours((1 << 9) - 1, near, 9) <= 9
    assert colours((1 << 9) - 1, [0] * 9, 9) == 1
    assert colours((1 << 9) - 1, [(1 << 9) - 1 - (1 << i) for i in range(9)], 9) == 9


def test_labels_of_pairs_that_fit_exactly_are_consistent():
    X = np.array([[-1.0, -4, 4], [6, 10, -3], [5, 8, -2]])

    found = certreg.assess(X, np.add(X, [1.0, -1, -1]), labels=[1, 1, 1], max_residual=0.1)

    assert found.verdict.value == "consistent"
