"""Files of pairs: two columns of rows, counted from 0, of the source and of the target.

A row may come in several pairs, as nearest neighbours do; then it counts in each, and a note says
so. Where the pairs are to be one to one, a row that comes again is refused.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from certreg.io.npy import parse_npy
from certreg.io.streams import Place, count, reading, refused
from certreg.io.text import TABLE_FORMATS, parse_rows
from certreg.verify import shown

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray


HEADER = ["source", "target"]
WHOLE = re.compile(r"[0-9]\.[0-9]{18}e\+(0[0-9]|1[0-5])")  # up to 10^16; its doubles are integers


def read_pairs(
    path: Path, sizes: tuple[int, int], *, one_to_one: bool = False
) -> NDArray[np.int64]:
    """Rows of source and target, (M, 2), of clouds of the given sizes. From .csv, .txt or .npy."""
    with reading(path) as stream:
        return parse_pairs(stream, path, sizes, one_to_one=one_to_one)


def parse_pairs(
    stream: BinaryIO, file: Path, sizes: tuple[int, int], *, one_to_one: bool = False
) -> NDArray[np.int64]:
    """As `read_pairs`; `file` tells the format and the name."""
    suffix = file.suffix.lower()
    if suffix == ".npy":
        pairs = _from_npy(stream, file)
    elif suffix in TABLE_FORMATS:
        pairs = _from_text(stream, file)
    else:
        raise refused(
            file, "the format is not known: give pairs as .csv, .txt or .npy", value=suffix
        )
    if len(pairs) == 0:
        raise refused(
            file,
            "no pairs: write a row of the source and one of the target a line",
            value=0,
            limit=1,
        )
    for column, side, size in zip(pairs.T, HEADER, sizes, strict=True):
        _require_rows(file, column, side, size)
        if one_to_one:
            _require_once(file, column, side)
    return pairs


def repeated_rows_note(file: Path, pairs: NDArray[np.int64]) -> tuple[str, ...]:
    """What the user should know where rows come in several pairs."""
    repeated = [int((np.unique(side, return_counts=True)[1] > 1).sum()) for side in pairs.T]
    if not any(repeated):
        return ()
    note = (
        f"{shown(file)}: not one to one: {repeated[0]} row{'s' * (repeated[0] != 1)} of the source "
        f"and {repeated[1]} of the target are in several pairs, and count in each (--one-to-one "
        "refuses that)"
    )
    return (note,)


def _from_npy(stream: BinaryIO, file: Path) -> NDArray[np.int64]:
    array = parse_npy(stream, file)
    integers = array.dtype.kind in "iu" and array.ndim == 2 and array.shape[1] == 2
    if not integers or (array.size and int(array.max()) >= 1 << 63):
        raise refused(
            file,
            f"holds {array.dtype} of shape {array.shape}: save row numbers as integers, (M, 2)",
            value=array.shape,
        )
    return array.astype(np.int64)


def _from_text(stream: BinaryIO, file: Path) -> NDArray[np.int64]:
    pairs: list[list[int]] = []
    for k, (place, row) in enumerate(parse_rows(stream, file)):
        words = [word.strip() for word in row]
        if k == 0 and [word.lower() for word in words] == HEADER:
            continue
        if len(words) != 2:
            columns = "1 column" if len(words) == 1 else f"{len(words)} columns"
            raise place.refusal(
                f"{columns}: write a row of source and one of target", value=len(words), limit=2
            )
        pairs.append([_row_number(place, word) for word in words])
    return np.array(pairs, dtype=np.int64).reshape(-1, 2)


def _row_number(place: Place, text: str) -> int:
    """A count in plain digits, or as numpy.savetxt writes it: 1.7e+01 with many zeros."""
    if WHOLE.fullmatch(text) and float(text).is_integer():
        return int(float(text))
    return count(place, text)


def _require_rows(file: Path, column: NDArray[np.int64], side: str, size: int) -> None:
    outside = (column < 0) | (column >= size)
    if outside.any():
        k = int(np.argmax(outside))
        raise refused(
            file,
            f"pair {k} (counting from 0) names row {column[k]} of the {side}: its "
            f"rows are 0 to {size - 1}",
            row=k,
            column=side,
            value=int(column[k]),
            limit=size - 1,
        )


def _require_once(file: Path, column: NDArray[np.int64], side: str) -> None:
    first = np.unique(column, return_index=True)[1]
    if len(first) != len(column):
        again = np.ones(len(column), dtype=bool)
        again[first] = False
        k = int(np.argmax(again))
        raise refused(
            file,
            f"pair {k} (counting from 0) names row {column[k]} of the {side} again: "
            "give each row one pair",
            row=k,
            column=side,
            value=int(column[k]),
        )
