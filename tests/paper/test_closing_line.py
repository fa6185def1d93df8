"""The last line of `certreg derive` counts what was proved, refuted and needed, and of how many."""

from __future__ import annotations

import re
from types import SimpleNamespace

import pytest

from certreg.paper.derivation import closing_line
from certreg.results import Ruling, Verdict


def outcome(proved: bool, refuted: str, needed: str) -> SimpleNamespace:  # noqa: FBT001
    """An outcome of a claim; a control is refuted, a hypothesis needed, where a letter is y."""
    ruling = Ruling.PROVED if proved else Ruling.INCONCLUSIVE
    return SimpleNamespace(
        verdict=Verdict(ruling=ruling, words="stands in"),
        controls=[SimpleNamespace(refuted=letter == "y") for letter in refuted],
        dropped=[SimpleNamespace(needed=letter == "y") for letter in needed],
        seconds=1.25,
        modulo="",
    )


@pytest.mark.parametrize(
    ("outcomes", "counts"),
    [
        ([], [0, 0, 0, 0, 0, 0]),
        ([outcome(True, "yyy", "y")], [1, 1, 3, 3, 1, 1]),
        ([outcome(True, "yny", "nny"), outcome(False, "yy", "y")], [1, 2, 4, 5, 2, 4]),
    ],
)
def test_a_control_that_was_not_refuted_and_a_hypothesis_not_needed_are_not_counted(
    outcomes: list[SimpleNamespace], counts: list[int]
):
    line = closing_line(outcomes, [])

    assert [int(word) for word in re.findall(r"\d+", line.partition(", in ")[0])] == counts
    assert line.endswith(f"in {1.25 * len(outcomes):.1f} s")


def test_claims_that_quote_a_theorem_are_counted_apart():
    quoting = outcome(True, "y", "y")
    quoting.modulo = ", modulo LaSalle's principle"

    assert "1 of 1 claims proved," in closing_line([outcome(True, "y", "y")], [])
    assert "2 of 2 claims proved (1 modulo a theorem that is quoted), " in closing_line(
        [outcome(True, "y", "y"), quoting], []
    )


def test_the_audited_claims_are_told_where_there_are_any():
    assert "claims of the paper" not in closing_line([], [])
    assert ", 7 claims of the paper audited, in" in closing_line([], range(7))
