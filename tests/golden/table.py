"""The table of what changed between two records: a page, whatever the number of files."""

from __future__ import annotations

import textwrap
from collections import Counter, defaultdict
from typing import TYPE_CHECKING

from same.fields import BEYOND, Field

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from wording import Kind

WIDTH = 110


def table(
    rows: Sequence[Field], gone: Mapping[str | None, Sequence[str]], kinds: Sequence[Kind]
) -> str:
    """All fields by their verdicts, the files that are gone, then what differs in words."""
    found = defaultdict[str, list[Field]](list)
    for row in rows:
        found[row.verdict].append(row)
    lines = [
        *_beyond(found[BEYOND], gone.get(None, ())),
        *_stated("CHANGED AS STATED", found["changed as stated"]),
        *_stated("WITHIN ITS BOUND", found["within its bound"]),
        *_gone(gone),
        *_names("NEW", found["new"]),
        *_names("IN OTHER WORDS", found["other words"]),
        *(["", "WORDS, BY KINDS OF FILES (numbers masked)"] if kinds else []),
        *(f"  {line}" for kind in kinds for line in str(kind).split("\n")),
        "",
        summary(rows, gone),
    ]
    return "\n".join(lines).lstrip("\n") + "\n"


def summary(rows: Sequence[Field], gone: Mapping[str | None, Sequence[str]]) -> str:
    """One line: how many fields have which verdict."""
    counts = Counter(row.verdict for row in rows)
    lost = len(gone.get(None, ()))
    beyond = counts[BEYOND] + lost
    told = [f"{counts[name]} {name}" for name in ("changed as stated", "within its bound", "new")]
    return (
        f"{len(rows)} fields differ: {beyond} beyond their bounds or gone, {', '.join(told)}, "
        f"{counts['other words']} in other words."
    )


def _beyond(rows: Sequence[Field], lost: Sequence[str]) -> Iterator[str]:
    if rows or lost:
        yield f"\n{BEYOND}, OR NOT STATED"
    for row in rows:
        yield f"  {row}"
        yield f"      {row.beyond} values; stated: {row.stated or 'nothing'}; {row.example}"
    for path in lost:
        yield f"  gone, a file or a document in it: {path}"


def _stated(title: str, rows: Sequence[Field]) -> Iterator[str]:
    """Rows under what is stated of them, with the reason."""
    under = defaultdict[object, list[Field]](list)
    for row in rows:
        under[row.stated].append(row)
    if rows:
        yield f"\n{title}"
    for stated, those in under.items():
        yield from (f"  {row}" for row in those)
        reason = getattr(stated, "reason", "")
        yield textwrap.fill(
            f"{stated}. {reason}", WIDTH, initial_indent=" " * 6, subsequent_indent=" " * 6
        )


def _gone(gone: Mapping[str | None, Sequence[str]]) -> Iterator[str]:
    if any(gone):
        yield "\nGONE AS STATED"
    for reason, paths in gone.items():
        if reason is not None:
            yield f"  {len(paths)} files, as {paths[0]}: {reason}"


def _names(title: str, rows: Sequence[Field]) -> Iterator[str]:
    """Only the names."""
    if rows:
        yield f"\n{title} ({len(rows)} fields)"
        names = ", ".join(dict.fromkeys(row.name for row in rows))
        yield textwrap.fill(
            names,
            WIDTH,
            initial_indent="  ",
            subsequent_indent="  ",
            break_long_words=False,
            break_on_hyphens=False,
        )
