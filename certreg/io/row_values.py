"""Files with a value for each row of the source: bounds on residuals, labels of inliers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from certreg._loading import late
from certreg.io.labels import text_of_field
from certreg.io.streams import Place, count, refused
from certreg.io.text import read_numbers, read_rows
from certreg.problem.arrays import first_row
from certreg.problem.bounds import INLIER_WORDS
from certreg.verify import shown

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from certreg.io import npy
    from certreg.io.pairing import Pair

    Rows = list[tuple[Place, list[str]]]
else:  # for arrays in files
    npy = late("certreg.io.npy")


def numbers_of(path: Path) -> NDArray[np.float64]:
    """What a file holds: an array in .npy, or text with one number a line."""
    if path.suffix.lower() == ".npy":
        return npy.read_array(path)
    return np.array(read_numbers(path), dtype=np.float64)


def read_bounds(path: Path, pair: Pair) -> NDArray[np.float64]:
    """The bounds of the pairs, from .npy or from text with one number a line.

    Raises InvalidFileError where the file cannot be read, holds another number of them or one that
    bounds nothing.
    """
    numbers, n = numbers_of(path), pair.sizes[0]
    if numbers.shape != (n,):
        held = f"{len(numbers)} bounds" if numbers.ndim == 1 else f"an array {numbers.shape}"
        raise refused(
            path,
            f"holds {held}, the source has {n} rows: give one bound for each of them",
            value=numbers.shape,
            limit=n,
        )
    row = first_row(numbers, lambda block: ~((block > 0) & np.isfinite(block)))
    if row is not None:
        value = numbers[row].item()
        raise refused(
            path,
            f"bound {row} (counting from 0) is {value}: a bound must be finite and "
            "> 0, in the unit of the clouds",
            row=row,
            value=value,
            limit=0.0,
        )
    return numbers if pair.source_rows is None else numbers[pair.source_rows]


ROW, LABEL, PROVED = "row", "label", "proved"
PAIR_COLUMNS = (ROW, LABEL, "residual", "bound", PROVED)


def read_inliers(path: Path, pair: Pair) -> list[bool]:
    """Whether each of the pairs is labelled as an inlier.

    From text with one label a line, for each row of the source, or from the table that `certify`
    writes of pairs that may be wrong, fit.csv, a row for each pair.

    Raises InvalidFileError where the file cannot be read, holds other words, another number, or
    is the table of other pairs.
    """
    rows = list(read_rows(path))
    if rows and rows[0][1][0].strip() == ROW:
        return _of_table(rows, path, pair)
    labels = [_is_inlier(place, ",".join(fields).strip()) for place, fields in rows]
    chosen, n = pair.source_rows, pair.sizes[0]
    _require_count(len(labels), n, f"the source has {n} rows", path)
    return labels if chosen is None else [labels[row] for row in chosen.tolist()]


def _of_table(rows: Rows, path: Path, pair: Pair) -> list[bool]:
    """From a table with a header, in any order of its rows."""
    (place, header), *rest = rows
    if tuple(name.strip() for name in header) != PAIR_COLUMNS:
        words = f"a table whose columns are not {', '.join(PAIR_COLUMNS)}: give one label a line"
        raise place.refusal(f"{words}, or fit.csv of certify --max-residual", value=header)
    n = len(pair.source.points)
    _require_count(len(rest), n, f"there are {n} pairs", path)
    names = pair.about.get("labels")
    labels: dict[int, bool] = {}
    for line, fields in rest:
        if len(fields) != len(header):
            raise line.refusal(
                f"{len(fields)} columns, not {len(header)}: mend the row",
                value=len(fields),
                limit=len(header),
            )
        row, name = count(line.at(ROW), fields[0].strip()), text_of_field(fields[1])
        if row >= n or row in labels:
            words = f"row {row} {'comes twice' if row in labels else f'of {n} pairs, from 0'}"
            raise line.refusal(f"{words}: give each pair one row", column=ROW, value=row)
        if names is not None and name and name != names[row]:
            words = f"row {row} is called '{shown(name)}', that of the clouds '{shown(names[row])}'"
            raise line.refusal(f"{words}: give the table of these pairs", column=LABEL, value=name)
        labels[row] = _is_inlier(line.at(PROVED), fields[-1].strip())
    return [labels[row] for row in range(n)]


def _is_inlier(place: Place, word: str) -> bool:
    if word not in INLIER_WORDS:
        what = f"'{shown(word)}' is no label"
        raise place.refusal(f"{what}: write 0 or 1, outlier or inlier", value=word)
    return INLIER_WORDS[word]


def _require_count(held: int, n: int, there: str, path: Path) -> None:
    if held != n:
        raise refused(
            path, f"holds {held} labels, {there}: give one for each of them", value=held, limit=n
        )
