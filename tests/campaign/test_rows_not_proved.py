"""Rows of a list that are registered and not fully proved: how they are called, counted, told."""

from __future__ import annotations

import itertools
from typing import Any

import pytest

from certreg.campaign.pairs import STATUSES, Tally, Told, _status
from certreg.cli.campaigns import SHORT_OF, _tell, _tell_short

CERTIFIED, TIED, BOUNDED, OPEN = "certified", "certified-not-unique", "bounded", "not-certified"


def consensus(lower: int, upper: int, *, decided: bool) -> dict[str, Any]:
    return {"consensus": {"lower": lower, "upper": upper, "labels_unique": decided}}


DECIDED = consensus(5, 5, decided=True)


def truncated(*, decided: bool, unique: bool) -> dict[str, Any]:
    return {"consensus": None, "truncated": {"labels_unique": decided, "unique": unique}}


def entry(status: str, code: int, name: str = "a", **more: Any) -> dict[str, Any]:
    """What is read of a line of results."""
    head = {"schema": "certreg-result/1", "name": name, "exit_code": code}
    warnings = [{"text": words} for words in more.pop("warnings", ())]
    return {**head, "fit": {"warnings": warnings}, "optimality": {"status": status}, **more}


@pytest.mark.parametrize(
    ("status", "told", "called"),
    [
        *itertools.chain(
            *(
                [(one, {}, one), (one, {"consensus": None}, one), (one, DECIDED, one)]
                for one in (CERTIFIED, TIED, BOUNDED, OPEN)
            )
        ),
        (CERTIFIED, consensus(5, 5, decided=False), "labels-not-proved"),
        (TIED, consensus(5, 5, decided=False), "labels-not-proved"),
        (CERTIFIED, consensus(5, 6, decided=False), "partly-proved"),
        (CERTIFIED, truncated(decided=True, unique=True), CERTIFIED),
        (CERTIFIED, truncated(decided=True, unique=False), TIED),
        (BOUNDED, truncated(decided=True, unique=False), BOUNDED),
        (TIED, truncated(decided=True, unique=False), TIED),
        (CERTIFIED, truncated(decided=False, unique=False), "partly-proved"),
        (CERTIFIED, truncated(decided=False, unique=True), "partly-proved"),
    ],
)
def test_a_status_says_what_is_proved_of_all_pairs_and_of_the_fit(status, told, called):
    assert _status(entry(status, 0, **told)) == called
    assert called in STATUSES
    assert called in SHORT_OF


def test_rows_are_told_by_kind_with_the_first_names(capsys: pytest.CaptureFixture[str]):
    tally = Tally()
    for k in range(6):
        tally.add(entry(CERTIFIED, 3, f"m{k}", **consensus(5, 5, decided=False)))
    for k in range(5):
        tally.add(entry(CERTIFIED, 4, f"p{k}", **consensus(5, 7, decided=False)))
    tally.add(entry(CERTIFIED, 4, "rough"))
    tally.add(entry(TIED, 3, "tied\n"))
    tally.add(entry(CERTIFIED, 0, "good"))
    _tell_short(tally, 15)

    assert capsys.readouterr().err.splitlines() == [
        (
            "certreg: 6 of 15 pairs are registered with the most pairs proved, but not each label: "
            "m0, m1, m2, m3, m4, ..."
        ),
        (
            "certreg: 5 of 15 pairs are registered, but neither the optimum nor each label is "
            "proved: p0, p1, p2, p3, p4"
        ),
        "certreg: 1 of 15 pairs is certified, but not as good as was asked: rough",
        r"certreg: 1 of 15 pairs is certified, but not unique: tied\n",
    ]


@pytest.mark.parametrize(
    ("status", "words"),
    [(BOUNDED, "not certified: bounded"), (OPEN, "not certified")],
)
def test_what_is_not_certified_is_called_so(status, words, capsys: pytest.CaptureFixture[str]):
    tally = Tally()
    tally.add(entry(status, 4))
    _tell_short(tally, 2)

    assert capsys.readouterr().err == f"certreg: 1 of 2 pairs is {words}: a\n"


def test_a_row_that_is_short_and_warned_of_is_told_for_both(capsys: pytest.CaptureFixture[str]):
    tally = Tally()
    tally.add(entry(TIED, 3, "a", warnings=["the bound is wide"]))
    tally.add(entry(CERTIFIED, 0, "b", warnings=["few"]))
    tally.add(
        {"schema": "certreg-error/1", "exit_code": 4, "name": "c", "error": {"message": "no"}}
    )
    _tell(tally, 3, kept=True)
    _tell_short(tally, 3)

    assert capsys.readouterr().err.splitlines() == [
        "error: c: no",
        'certreg: 1 of 3 pairs could not be registered: look for "error" in the results',
        "warning: a: the bound is wide",
        "warning: b: few",
        (
            'certreg: 2 of 3 pairs have a warning: look for "warning" in the results; "remedy" '
            "beside it says what to do"
        ),
        "certreg: 1 of 3 pairs is certified, but not unique: a",
    ]
    tally.poor = Told(count=1, first=["a: the bound is wide"])
    _tell(tally, 3, kept=False)
    assert "1 of 3 pairs has a warning: " in capsys.readouterr().err
