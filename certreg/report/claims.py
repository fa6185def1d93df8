"""The executed claims and the audit of the paper as lines for a terminal."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

WIDTH = 24  # of a claim's name


def claim_line(outcome: Any) -> str:
    """One line about a claim (kernel.Outcome): name, verdict, what it rests on, time."""
    quoted = len(outcome.quoted)
    rests = f", {quoted} theorem{'s' * (quoted != 1)} quoted" if quoted else ""
    ruling = outcome.verdict.ruling.value.upper()
    line = (
        f"{outcome.claim.name:{WIDTH}} {ruling:9} {outcome.seconds:6.2f} s  {outcome.claim.title}"
    )
    return f"{line}\n{'':{WIDTH}} {outcome.verdict.words}{rests}"


def audit_lines(rows: Iterable[Any]) -> Iterator[str]:
    """The claims of the paper (audit.Row), each with its verdict, re-checked now."""
    for position, row in enumerate(rows):
        if position == 0:
            yield "\nThe claims of the paper [Yang2020]:"
        checked = row.recheck()
        told = "" if checked.proved else f"  NOT CONFIRMED: {checked.words}"
        yield f"{row.number:>4} {row.verdict.value:24} {_plain(row.says)}{told}"


def closing_line(outcomes: Sequence[Any], rows: Sequence[Any]) -> str:
    """How many claims were proved, how many mutated statements refuted, how long it took."""
    proved = sum(outcome.verdict.proved for outcome in outcomes)
    controls = [control for outcome in outcomes for control in outcome.controls]
    refuted = sum(not control.passed for control in controls)
    seconds = sum(outcome.seconds for outcome in outcomes)
    audited = f", {len(rows)} claims of the paper audited" if rows else ""
    return (
        f"\n{proved} of {len(outcomes)} claims proved, {refuted} of {len(controls)} mutated "
        f"statements refuted{audited}, in {seconds:.1f} s"
    )


def _plain(words: str) -> str:
    """Markdown without its marks, for a terminal."""
    return re.sub(r"[$`*]|\\(?:mathrm|operatorname)", "", words)
