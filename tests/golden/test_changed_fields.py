"""Fields of two records are held to what is stated of them: each verdict, and the table."""

from __future__ import annotations

import json
from typing import Any

import pytest
from comparison import Difference
from documents import BOUNDS, changed_fields, gone_files
from same.fields import BEYOND, Bounds, Stated, read_bounds
from table import summary, table
from wording import changed_words

POSE = {"pose": {"rotation": [[1.0, 0.0], [0.0, 4.0]], "status": "optimal"}, "pairs": 3}
PATH = "case/result.json.txt"


def differences(base, head, path=PATH):
    return [Difference(path, base, head)]


def told(base, head):
    return [str(row) for row in changed_fields(differences(base, head))]


def document(**changes):
    return json.dumps({**POSE, **changes}, indent=2)


def verdicts(base, head, bounds, path=PATH):
    found = differences(json.dumps(base, indent=1), json.dumps(head, indent=1), path)
    rows = changed_fields(found, bounds)
    return {row.name: row.verdict for row in rows}


def bounds(*names: str, **stated: Any) -> Bounds:
    return Bounds((Stated(names=names, reason="a reason", **stated),))


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


@pytest.mark.parametrize(
    ("old", "new", "verdict"),
    [
        (3.7, 3.7 + 4e-15, BEYOND),
        (3.7, 3.7 * (1 + 1e-6), BEYOND),
        (3.7, 3.7 + 4.5e-16, "within its bound"),
        (0.0, 1e-300, BEYOND),
        (1e-300, 1.000001e-300, BEYOND),
        (3.7, float("nan"), BEYOND),
        (3.7, float("inf"), BEYOND),
        (3.7, None, BEYOND),
        (3.7, 4, BEYOND),
    ],
)
def test_an_objective_that_moves_by_more_than_its_rounding_is_beyond_its_bound(old, new, verdict):
    base, head = {"objective": old}, {"objective": new}

    assert verdicts(base, head, read_bounds(BOUNDS)) == {"objective": verdict}
    assert verdicts(head, base, read_bounds(BOUNDS)) == {"objective": verdict}


def test_a_field_of_which_nothing_is_stated_may_neither_move_nor_go():
    for head in ({"radius": 1.0 + 2**-52}, {"radius": None}, {}):
        assert verdicts({"radius": 1.0}, head, Bounds()) == {"radius": BEYOND}
    assert verdicts({}, {"radius": 1.0}, Bounds()) == {"radius": "new"}
    assert verdicts({"radius": 0.0}, {"radius": -0.0}, Bounds()) == {}


def test_a_field_that_may_change_is_told_as_stated():
    stated = bounds("basin.*", changes=True)
    for head in ({"basin": {"q": [1, 2]}}, {"basin": {"q": [2.5]}}, {"basin": {}}):
        assert verdicts({"basin": {"q": [1, 3]}}, head, stated) == {
            "basin.q[]": "changed as stated"
        }


def test_what_is_stated_of_some_files_or_where_another_field_differs_holds_there_alone():
    base, head = {"damping": 1.0, "rate": 2.0}, {"damping": 1.0, "rate": 3.0}
    elsewhere = bounds("rate", changes=True, paths=("other/*",))
    where = bounds("rate", changes=True, where=("damping",))

    assert verdicts(base, head, elsewhere) == {"rate": BEYOND}
    assert verdicts(base, head, elsewhere, "other/a.txt") == {"rate": "changed as stated"}
    assert verdicts(base, head, where) == {"rate": BEYOND}
    assert verdicts(base, {**head, "damping": 2.0}, where)["rate"] == "changed as stated"


def test_a_share_may_be_one_of_another_field():
    stated = bounds("gap", share=1e-15, of=("objective",))
    base = {"gap": 1e-30, "objective": 5.0}

    assert verdicts(base, {"gap": 4e-15, "objective": 5.0}, stated) == {"gap": "within its bound"}
    assert verdicts(base, {"gap": 6e-15, "objective": 5.0}, stated) == {"gap": BEYOND}
    assert verdicts({"gap": 1e-30}, {"gap": 2e-30}, stated) == {"gap": BEYOND}


def test_a_vector_known_up_to_its_sign_may_turn_round_and_no_more():
    stated = bounds("witness[]", share=1e-12, either_sign=True)
    base = {"witness": [0.6, -0.8]}

    assert verdicts(base, {"witness": [-0.6, 0.8]}, stated) == {"witness[]": "within its bound"}
    assert verdicts(base, {"witness": [0.8, -0.6]}, stated) == {"witness[]": BEYOND}


def test_sentences_are_words_and_nothing_is_judged_of_them():
    base = {"headline": "It is so.", "reasons": {"gap": "null"}, "verdict": "optimal"}
    head = {"headline": "It is not.", "reasons": {}, "verdict": "spurious"}

    assert verdicts(base, head, Bounds()) == {
        "headline": "other words",
        "reasons.gap": "other words",
        "verdict": BEYOND,
    }


def test_an_exit_code_is_a_field():
    text = "$ certreg certify\nexit code {}\n--- stdout\n--- stderr\n"
    (row,) = changed_fields(differences(text.format(0), text.format(4), "case/step-00.txt"))

    assert (row.name, row.verdict) == ("exit code", BEYOND)


def test_what_a_call_from_python_tells_is_judged_by_its_places():
    text = "$ python register\nexit code 0\n--- stdout\n13: [[[1.0, {}]], [7.0, 1e6]]\n--- stderr\n"
    stated = bounds("register()*", share=1e-15)
    for moved, verdict in ((0.5 + 1e-16, "within its bound"), (0.5 + 1e-14, BEYOND)):
        sides = text.format(0.5), text.format(moved)
        rows = changed_fields(differences(*sides, "public-calls/step-03.txt"), stated)
        assert [row.verdict for row in rows] == [verdict] * (moved != 0.5)
        assert all(row.name == "register()[0][][]" for row in rows)


def test_rows_of_numbers_are_judged_in_files_that_hold_nothing_else():
    (row,) = changed_fields(differences("1 2\n3 4\n", "1 2\n3 4.5\n", "case/files/moved.xyz.txt"))

    assert (row.name, row.verdict) == ("rows of numbers[]", BEYOND)


def test_documents_of_a_file_are_held_against_each_other_in_their_order():
    base = f"{document()}\n{document(noise=1.0)}\n"
    head = f"{document(noise=5.0)}\n{document(noise=1.0)}\n"

    assert told(base, head) == ["noise: 1 new, in 1 files"]


def test_a_file_or_a_document_that_is_gone_is_told_unless_it_is_stated():
    stated = Bounds(gone={"old/*": "no longer written"})
    files = [
        Difference("old/pose.json.txt", document(), None),
        Difference("case/a.txt", document(), None),
        Difference("case/b.txt", document(), "{}"[:0]),
        Difference("case/new.txt", None, document()),
        Difference("case/c.txt", document(), document(pairs=4)),
    ]

    assert gone_files(files, stated) == {
        "no longer written": ["old/pose.json.txt"],
        None: ["case/a.txt", "case/b.txt"],
    }


def test_words_are_told_by_kinds_with_numbers_masked():
    step = "$ certreg {} a.csv\nexit code 0\n--- stdout\n{}\n--- stderr\n"
    found = [
        Difference(
            "a/step-00.txt", step.format("certify", "gap 1"), step.format("certify", "gap 2")
        ),
        Difference(
            "b/step-00.txt", step.format("certify", "gap 1"), step.format("certify", "hole 1")
        ),
        Difference("b/files/x.html.txt", "<p>one</p>", "<p>two</p>"),
        Difference("b/files/y.html.txt", None, "<p>two</p>"),
    ]

    assert [str(kind) for kind in changed_words(found)] == [
        (
            "files .html: 1 files differ, 1 files are new\n"
            "  - 1 kinds of lines, most often (1 files): <p>one</p>\n"
            "  + 1 kinds of lines, most often (1 files): <p>two</p>"
        ),
        (
            "printed by certreg certify: 2 files differ, 1 of them in numbers or digests alone\n"
            "  - 1 kinds of lines, most often (1 files): gap #\n"
            "  + 1 kinds of lines, most often (1 files): hole #"
        ),
    ]


def test_the_table_tells_every_verdict_with_its_bound_and_its_reason():
    stated = Bounds(
        (
            Stated(("mu",), "a solver's", changes=True),
            Stated(("rmse",), "four ulps", share=8.9e-16),
            Stated(("gap",), "as the objective", absolute=1e-13),
        )
    )
    base = {"mu": 1, "rmse": 0.3, "gap": 1.0}
    head = {"mu": 2, "rmse": 0.3 + 6e-17, "gap": 1.5, "fit": 1, "words": "It is new."}
    sides = (json.dumps(side, indent=1) for side in (base, head))
    rows = changed_fields(differences(*sides), stated)
    page = table(rows, {None: ["case/gone.txt"], "unused": ["case/old.txt"]}, ())

    for line in (
        "  gap: 1 moved by 5.0e-01, a share of 3.3e-01, at most, in 1 files",
        f"      1 values; stated: at most 1.0e-13; {PATH}: 1.0 was, 1.5 is",
        "  gone, a file or a document in it: case/gone.txt",
        "      may change. a solver's",
        "      at most 8.9e-16 of its size. four ulps",
        "  1 files, as case/old.txt: unused",
        "  fit, words",
        (
            "5 fields differ: 2 beyond their bounds or gone, 1 changed as stated, "
            "1 within its bound, 2 new, 0 in other words."
        ),
    ):
        assert line in page.split("\n")
    assert page.endswith(f"{summary(rows, {None: ['case/gone.txt']})}\n")


def test_all_that_is_stated_has_its_reason_and_says_one_thing():
    stated = read_bounds(BOUNDS)

    assert all(stated.gone.values())
    for entry in stated.fields:
        assert entry.reason
        assert entry.names
        assert entry.changes != bool(entry.share or entry.absolute)
        assert not (entry.of and not entry.share)


@pytest.mark.parametrize("text", ["{broken 1", "{", "$ python register\n"])
def test_what_begins_like_a_document_and_is_none_has_no_fields(text: str):
    assert changed_fields(differences(text, f"{text}2")) == ()
