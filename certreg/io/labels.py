"""Which row of the source pairs with which row of the target, told by labels."""

from __future__ import annotations

import enum
from collections import Counter
from itertools import chain

from certreg.errors import InvalidFileError
from certreg.verify import shown


class Match(enum.Enum):
    """What to do with labels that are in one cloud only: refuse them, or leave them out."""

    ALL = "all"
    COMMON = "common"


def rows_by_label(
    source: tuple[str, ...], target: tuple[str, ...], match: Match = Match.ALL
) -> tuple[list[int], list[int]]:
    """Rows of the source in their order, and the row of the target with the same label for each.

    COMMON leaves out what is in one cloud only, and there a label may be repeated; a label of both
    clouds must occur once in each. Raises InvalidFileError: the first label in the way.
    """
    sides = {"source": Counter(source), "target": Counter(target)}
    for label in chain(source, target):
        times = {side: counter[label] for side, counter in sides.items()}
        if match is Match.COMMON and 0 in times.values():
            continue
        for side, count in times.items():
            if count != 1:
                where = f"label '{shown(label)}' occurs {count} times in the {side}"
                remedy = "take --match common" if count == 0 else "rename it"
                message = f"{where}: each must occur once in both; drop it, or {remedy}"
                raise InvalidFileError(message)
    rows = {label: row for row, label in enumerate(target)}
    kept = [row for row, label in enumerate(source) if label in rows]
    if not kept:
        message = "the clouds have no label in common: check that they belong together"
        raise InvalidFileError(message)
    return kept, [rows[source[row]] for row in kept]
