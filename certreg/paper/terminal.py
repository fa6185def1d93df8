"""The executed claims and the audit of the paper as lines for a terminal."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from certreg.results import Verdict

WIDTH = 24  # of a claim's name


def claim_line(outcome: Any) -> str:
    """One line about a claim (kernel.Outcome): name, verdict, what it rests on, time."""
    used = len(outcome.claim.standard)
    rests = f", {used} standard fact{'s' * (used != 1)} used" if used else ""
    ruling = outcome.verdict.ruling.value.upper() + outcome.modulo
    name, title = outcome.claim.name, plain(outcome.claim.title)
    line = f"{name:{WIDTH}} {ruling:9} {outcome.seconds:6.2f} s  {title}"
    return f"{line}\n{'':{WIDTH}} {outcome.verdict.words}{rests}"


def chapters_text(chapters: Iterable[Any]) -> str:
    """The names of the claims, by chapter (book.Chapter)."""
    return "\n\n".join(
        "\n".join((chapter.title, *(f"  {name}" for name in chapter.names))) for chapter in chapters
    )


def audit_lines(audited: Iterable[tuple[Any, Verdict]]) -> Iterator[str]:
    """The claims of the paper (audit.Row), each with its finding and whether that stands."""
    for position, (row, verdict) in enumerate(audited):
        if position == 0:
            yield "\nThe claims of the paper [Yang2020]:"
        doubt = "" if verdict.proved else f"  finding NOT CONFIRMED: {verdict.words}"
        yield f"{row.number:>4}  {row.finding.value:23} {plain(row.claim)}{doubt}"


def closing_line(outcomes: Sequence[Any], audited: Sequence[Any]) -> str:
    """How many claims were proved, what had to fail and did, how long it took."""
    proved = sum(outcome.verdict.proved for outcome in outcomes)
    quoting = sum(bool(outcome.modulo) for outcome in outcomes)
    modulo = f" ({quoting} modulo a theorem that is quoted)" if quoting else ""
    controls = [control for outcome in outcomes for control in outcome.controls]
    refuted = sum(control.refuted for control in controls)
    dropped = [drop for outcome in outcomes for drop in outcome.dropped]
    needed = sum(drop.needed for drop in dropped)
    seconds = sum(outcome.seconds for outcome in outcomes)
    paper = f", {len(audited)} claims of the paper audited" if audited else ""
    return (
        f"\n{proved} of {len(outcomes)} claims proved{modulo}, "
        f"{refuted} of {len(controls)} mutated statements refuted, "
        f"{needed} of {len(dropped)} hypotheses needed{paper}, in {seconds:.1f} s"
    )


def plain(words: str) -> str:
    """Markdown with LaTeX made readable in a terminal."""
    for pattern, text in _PLAIN:
        words = re.sub(pattern, text, words)
    return words


_PLAIN = (
    (r"\\(?:mathrm|operatorname|mathsf|text)\{([^}]*)\}", r"\1"),
    (r"\\dot\{?(\w)\}?", r"\1'"),
    (r"\\(?:l|r)?Vert|\\\|", "|"),
    (r"\\le\b", "<="),
    (r"\\ge\b", ">="),
    (r"\\to\b", "->"),
    (r"\\times\b", "x"),
    (r"\\circ\b", "°"),
    (r"\\[,;! ]", " "),
    (r"[$`*{}]", ""),
    (r"\\(\w+)", r"\1"),
)
