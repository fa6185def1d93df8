"""Which row of the source pairs with which row of the target, by their labels."""

from __future__ import annotations

import enum
import re
from collections import Counter
from collections.abc import Sequence
from itertools import chain
from typing import TYPE_CHECKING

from certreg.errors import InvalidFileError
from certreg.io.streams import NUMBER
from certreg.verify import shown

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

LABEL_NODES = 20_000  # labels and the commas in them; the checker takes 50,000 in all
LABEL_CHARACTERS = 1_000_000  # twelve megabytes of escapes at worst; its limit is 100
SIDES = ("source", "target")
IDENTIFIERS = ("id", "name", "point", "number", "nr", "no", "num", "index", "point_id", "marker")
# A spreadsheet computes a cell that begins so; the last four are the wide forms of Chinese fonts.
FORMULA = re.compile(r"'*[=+\-@\t\r\uff1d\uff0b\uff0d\uff20]")
PLAIN = "'"  # before a text that would be a formula: spreadsheets take what follows as it is
CELL_ENDS = frozenset(',;|"\t\r\n')  # of a field, in one country or another


class Match(enum.Enum):
    """What to do with labels that are in one cloud only: refuse them, or leave them out."""

    ALL = "all"
    COMMON = "common"


def csv_field(text: str) -> str:
    """A text as a field of a .csv file, quoted where it must be, that is a formula nowhere.

    >>> csv_field("=1+1"), csv_field("-1.5"), csv_field("nose, left")
    ("'=1+1", '-1.5', '"nose, left"')
    """
    if FORMULA.match(text) and not NUMBER.fullmatch(text):
        text = PLAIN + text
    return '"' + text.replace('"', '""') + '"' if CELL_ENDS & set(text) else text


def text_of_field(field: str) -> str:
    """The text that `csv_field` wrote so, from the field without its quotes."""
    return field[1:] if field.startswith(PLAIN) and FORMULA.match(field) else field


def are_short(labels: Sequence[str]) -> bool:
    """Whether labels leave a certificate within what its checker reads."""
    nodes = sum(1 + sum(map(label.count, ",[{")) for label in labels)
    return nodes <= LABEL_NODES and sum(map(len, labels)) <= LABEL_CHARACTERS


def named_by_rows(source: NDArray[np.int64], target: NDArray[np.int64]) -> list[str] | None:
    """A name for each pair of rows without labels; None of more than a certificate may hold.

    >>> import numpy as np
    >>> named_by_rows(np.array([6, 0]), np.array([6, 2]))
    ['source row 6 and target row 6', 'source row 0 and target row 2']
    """
    if len(source) > LABEL_NODES:
        return None
    pairs = zip(source.tolist(), target.tolist(), strict=True)
    return [f"source row {first} and target row {second}" for first, second in pairs]


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
        place = SIDES[k] if names[k] == SIDES[k] else f"{SIDES[k]} {names[k]}"  # no file: an array
        where = f"label '{shown(label)}' occurs {times[k]} times in the {place}"
        remedy = "rename it"
        if times[k] == 0:
            missing, others = len(counters[1 - k].keys() - counters[k].keys()), len(counters[1 - k])
            where += f", which lacks {missing} of the {others} labels of {names[1 - k]}"
            remedy = "take --match common"
        raise InvalidFileError(
            f"{where}: each must occur once in both; drop it, or {remedy}",
            path=files[k],
            column="label",
            value=label,
            limit=1,
        )
    rows = {label: row for row, label in enumerate(target)}
    kept = [row for row, label in enumerate(source) if label in rows]
    if not kept:
        raise InvalidFileError(
            "the clouds have no label in common: check that they belong together",
            path=files[1],
            column="label",
        )
    return kept, [rows[source[row]] for row in kept]


def require_same_order(
    source: tuple[str, ...] | None, target: tuple[str, ...] | None, files: tuple[Path, Path]
) -> None:
    """That rows which are to pair in order do not name the same points in another order.

    source, target: what a column called as one of IDENTIFIERS, or `label`, says of each row; None
    without such a column. Raises InvalidFileError.
    """
    if source is None or target is None or source == target or sorted(source) != sorted(target):
        return
    row = next(k for k, (a, b) in enumerate(zip(source, target, strict=True)) if a != b)
    names = [shown(file) for file in files]
    raise InvalidFileError(
        f"{names[0]} and {names[1]} name the same points in another order: point {row} (counting "
        f"from 0) is '{shown(source[row])}' and '{shown(target[row])}': rename the column that "
        "names them to label in both files, or give pairs",
        path=files[1],
        row=row,
        value=target[row],
        limit=source[row],
    )


def classes_note(
    files: tuple[Path, Path], source: tuple[str, ...] | None, target: tuple[str, ...] | None
) -> tuple[str, ...]:
    """What the user should know where `label` is a number for many points of two .ply files.

    Then it is what segmentation calls a label, a class, and pairs nothing.
    """
    meshes = all(file.suffix.lower() == ".ply" for file in files)
    if not meshes or source is None or target is None:
        return ()
    if len(set(source)) == len(source) or len(set(target)) == len(target):
        return ()
    names = " and ".join(map(shown, files))
    return (f"{names}: labels repeat in both: classes, not names: they pair no rows",)


def unused_labels_note(labelled: tuple[bool, bool], files: tuple[Path, Path]) -> list[str]:
    """What the user should know where rows pair in order though one file has labels."""
    if labelled[0] == labelled[1]:
        return []
    names = [shown(file) for file in files]
    bare, full = names if labelled[1] else names[::-1]
    return [f"{full}: labels not used, as {bare} has none: row i pairs with row i"]
