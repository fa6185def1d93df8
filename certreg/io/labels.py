"""Which row of the source pairs with which row of the target, told by labels."""

from __future__ import annotations

import enum
from collections import Counter
from itertools import chain
from typing import TYPE_CHECKING

from certreg.errors import InvalidFileError
from certreg.verify import shown

if TYPE_CHECKING:
    from pathlib import Path

SIDES = ("source", "target")


class Match(enum.Enum):
    """What to do with labels that are in one cloud only: refuse them, or leave them out."""

    ALL = "all"
    COMMON = "common"


def rows_by_label(
    source: tuple[str, ...],
    target: tuple[str, ...],
    match: Match = Match.ALL,
    *,
    files: tuple[Path, Path],
) -> tuple[list[int], list[int]]:
    """Rows of the source in their order, and the row of the target with the same label for each.

    COMMON leaves out what is in one cloud only, and there a label may be repeated; a label of both
    clouds must occur once in each. Raises InvalidFileError: the first label in the way, in which of
    the `files` of source and target, and how many are missing there.
    """
    counters, names = (Counter(source), Counter(target)), tuple(map(shown, files))
    for label in chain(source, target):
        times = [counter[label] for counter in counters]
        if times == [1, 1] or (match is Match.COMMON and 0 in times):
            continue
        k = int(times[0] == 1)
        where = f"label '{shown(label)}' occurs {times[k]} times in the {SIDES[k]} {names[k]}"
        remedy = "rename it"
        if times[k] == 0:
            missing, others = len(counters[1 - k].keys() - counters[k].keys()), len(counters[1 - k])
            where += f", which lacks {missing} of the {others} labels of {names[1 - k]}"
            remedy = "take --match common"
        message = f"{where}: each must occur once in both; drop it, or {remedy}"
        raise InvalidFileError(message)
    rows = {label: row for row, label in enumerate(target)}
    kept = [row for row, label in enumerate(source) if label in rows]
    if not kept:
        message = "the clouds have no label in common: check that they belong together"
        raise InvalidFileError(message)
    return kept, [rows[source[row]] for row in kept]
