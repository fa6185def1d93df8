"""The table of changed fields counts what is new, gone and other, and measures numbers."""

from __future__ import annotations

import json

import pytest
from comparison import Difference
from fields import changed_fields

POSE = {"pose": {"rotation": [[1.0, 0.0], [0.0, 4.0]], "status": "optimal"}, "pairs": 3}


def told(base, head):
    return [str(row) for row in changed_fields([Difference("case/pose.json.txt", base, head)])]


def document(**changes):
    return json.dumps({**POSE, **changes}, indent=2)


def test_the_same_fields_are_not_told():
    assert told(document(), document(pairs=3)) == []


@pytest.mark.parametrize(
    ("changes", "row"),
    [
        ({"pairs": 4}, "pairs: 1 other, in 1 files"),
        ({"pairs": 3.0}, "pairs: 1 other, in 1 files"),
        ({"pairs": True}, "pairs: 1 other, in 1 files"),
        ({"noise": None}, "noise: 1 new, in 1 files"),
        (
            {"pose": {"rotation": [[1.0, 2e-6], [0.0, 4.0]], "status": "optimal"}},
            "pose.rotation[][]: 1 moved by 2.0e-06, a share of 5.0e-07, at most, in 1 files",
        ),
        (
            {"pose": {"rotation": [[1.0, 0.0], [0.0, 4.0]], "status": "open"}},
            "pose.status: 1 other, in 1 files",
        ),
    ],
    ids=["integer", "type", "truth", "new", "float", "word"],
)
def test_a_change_of_a_field_is_told_by_its_kind(changes, row):
    assert told(document(), document(**changes)) == [row]
    assert told(document(**changes), document()) == [row.replace("new", "gone")]


def test_json_within_printed_text_is_read_and_the_rest_told_by_lines():
    text = "$ certreg certify\n{}\n--- stderr\nnote: {} pairs left out\n"

    assert told(text.format(document(), 12), text.format(document(pairs=5), 15)) == [
        (
            "numbers in text: note: # pairs left out: "
            "1 moved by 3.0e+00, a share of 2.0e-01, at most, in 1 files"
        ),
        "pairs: 1 other, in 1 files",
    ]
    assert told(text.format(document(), 12), text.format(document(), "no")) == [
        "numbers in text: note: # pairs left out: 1 gone, in 1 files",
        "text: note: # pairs left out: 1 gone, in 1 files",
        "text: note: no pairs left out: 1 new, in 1 files",
    ]


def test_documents_of_a_file_are_held_against_each_other_in_their_order():
    base = f"{document()}\n{document(noise=1.0)}\n"
    head = f"{document(noise=5.0)}\n{document(noise=1.0)}\n"

    assert told(base, head) == ["noise: 1 new, in 1 files"]


def test_a_file_on_one_side_only_is_all_new():
    assert told(None, '{"pairs": 3}') == ["pairs: 1 new, in 1 files"]


def test_what_begins_like_json_and_is_none_is_text():
    assert told("{broken 1", "{broken 2") == [
        "numbers in text: {broken #: 1 moved by 1.0e+00, a share of 5.0e-01, at most, in 1 files"
    ]
