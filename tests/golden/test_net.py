"""What users see of small cases is what it was: `make record` renews what is meant to differ.

Laws say what is right; this says what has changed. A number beside the wrong unit, the second
branch of a sentence, a label, a column: none of them breaks a law that is written down.
"""

from __future__ import annotations

import json

import pytest
from net import RECORDS, SHOWN, canonical, difference, record_of, recorded, without_ends
from net_cases import CASES, NetCase
from net_shown import Short

import certreg

MEANT = (
    "What users see has changed (- the record, + now). If that is meant, `make record`, look at "
    "the difference of tests/golden/records, and commit it with the change."
)
SHOWN_SLOWLY = {f"shown-{name}" for name in ("rows", "scales", "noise", "ties", "patterns")}
SLOW = {"batch", "certify-out", "certify-units", "python-formats", "python-pages", "weak"}
SLOW |= {"altered", "equilibria-of-rows", "judged", "springs-free", "springs-planes"}
SLOW |= SHOWN_SLOWLY


def marked(case: NetCase):
    """Of those that are slow one in six is asked in every run of the tests."""
    marks = [pytest.mark.slow] if case.name in SLOW else []
    marks += [pytest.mark.long] if case.name in SLOW - {*sorted(SLOW)[2::6]} else []
    return pytest.param(case, id=case.name, marks=marks)


@pytest.mark.slow
@pytest.mark.parametrize("case", [marked(case) for case in CASES])
def test_what_is_seen_is_what_is_recorded(case):
    kept = record_of(case.name)
    old = kept.read_text("utf-8") if kept.exists() else ""
    lines = difference(old, recorded(case))

    assert not lines, "\n".join((f"{kept.name}: {MEANT}", *lines))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("RMSE  0.5  (unit)", "RMSE  0.5000004  (unit)"),
        ("RMSE  0.5  (unit)", "RMSE   0.5  (unit)"),  # a wider number beside it
        ("gap <= 3.2e-30", "gap <= 8e-31"),
        ("-0.0 1e-17", "0.0 -3e-16"),
        ("relaxation (SDP)  rank 1, gap 0.002", "relaxation (SDP)  rank 1, gap 0.003"),
    ],
)
def test_rounding_is_no_difference(old: str, new: str):
    assert difference(old, new) == []


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("RMSE 0.5", "RMSE 0.500001"),
        ("0.5 degrees", "0.5 radians"),
        ("gap 3.2e-30", "gap 3.2e-3"),
        ("at most 2", "at least 2"),
        ("exit code 0", "exit code 1"),
        ("  indented", "indented"),
        ("a", "a\nb"),
        ("a\nb", "b"),
        ("index-3", "index-2"),
        ("row 2", "row 2.5.1"),
        ("0a1", "0a2"),
        ("relaxation (SDP)  rank 1", "relaxation (SDP)  rank 2"),
        ("[1, 2]", "[1, 2, 3]"),
    ],
)
def test_whatever_else_changes_is_a_difference(old: str, new: str):
    lines = difference(f"above\n{old}\nbelow", f"above\n{new}\nbelow")

    assert {line[0] for line in lines} >= {"-", "+"} or old == "a" or new == "b"
    assert any(line[0] in "-+" for line in lines)
    assert all(line[1:] in f"above\n{old}\n{new}\nbelow".splitlines() for line in lines)


def test_a_long_difference_is_cut():
    lines = difference("", "\n".join(f"line {'x' * k}" for k in range(100)))

    assert len(lines) == SHOWN + 1
    assert lines[-1] == "... and 60 more lines"


def test_every_slow_case_is_a_case():
    assert {case.name for case in CASES} >= SLOW


def test_every_record_is_of_a_case_and_none_is_long():
    kept = {path.stem: path.stat().st_size for path in RECORDS.glob("*")}

    assert set(kept) == {case.name for case in CASES}
    assert sum(kept.values()) <= 850 * 1024
    assert len(CASES) == len(kept)


def test_a_line_that_was_there_is_its_place_and_its_numbers():
    text = "Row 3 of 12\nIn all\nWell\n{\n12"
    long = " ".join(map(str, range(20)))
    told = list(Short(text).lines(f"Row 4 of 12\nIn all\nWell\nAll {long}\nAll {long}\nOther"))

    assert told[:2] == ["@0 4 12", "@1-@2"]
    assert told[2].startswith("All # # #")
    assert told[3:] == ["@3 20: 190 2660", "Other"]


@pytest.mark.parametrize(
    "other",
    [
        "Row 5 of 12\nWell",
        "Row 4 in 12\nWell",
        "Row 4 of 12",
        "Well\nRow 4 of 12",
        "Row 4 of 12\nWel",
    ],
)
def test_no_line_changes_unseen_for_having_been_there(other: str):
    told = [
        "\n".join(Short("Well\nRow 1 of 2\n").lines(text)) for text in ("Row 4 of 12\nWell", other)
    ]

    assert difference(*told) != []


def test_nothing_of_this_machine_is_recorded():
    for path in RECORDS.glob("*.txt"):
        text = path.read_text("utf-8")
        assert "/tmp" not in text, path.name  # noqa: S108 (what must not be there)
        assert certreg.__version__ not in text, path.name


def test_a_basis_of_many_equilibria_is_recorded_as_the_space_that_it_spans():
    turned = [[0.6, -0.8], [0.8, 0.6], [0, 0], [0, 0]]
    told = [
        canonical(json.dumps({"dimension": 1, "basis": basis, "witness": [1.0]}, indent=1))
        for basis in ([[1, 0], [0, 1], [0, 0], [0, 0]], turned, [[1, 0], [0, 0], [0, 1], [0, 0]])
    ]

    assert difference(told[0], told[1]) == []
    assert difference(told[0], told[2]) != []


@pytest.mark.parametrize(
    ("name", "line", "kept"),
    [
        ("springs-planes", '   "mu": 33335.4655,', '   "mu": *,'),
        ("springs-planes", 'chi2": {"value": 7.04, "dof": 6}', 'chi2": {"value": 7.04, "dof": 6}'),
        (
            "springs-planes",
            "  rotation (wxyz)   1.0 0.0 0.0 0.0",
            "  rotation (wxyz)   1.0 0.0 0.0 0.0",
        ),
        ("springs-free", "  rotation (wxyz)   1.0 0.0 0.0 0.0", "  rotation (wxyz)   * * * *"),
        ("springs-free", "  RMSE              0.018141", "  RMSE              0.018141"),
        ("certify", '   "mu": 33335.4655,', '   "mu": 33335.4655,'),
    ],
)
def test_of_general_springs_no_number_is_kept_that_a_solver_ends_at(
    name: str, line: str, kept: str
):
    assert without_ends(name, line) == kept
