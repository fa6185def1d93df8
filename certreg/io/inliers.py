"""A file of labels: 0 or 1, outlier or inlier, for each row of the source, or a table of pairs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.io.labels import text_of_field
from certreg.io.streams import count, refused
from certreg.io.text import read_rows
from certreg.problem.inliers import INLIER_WORDS
from certreg.verify import shown

if TYPE_CHECKING:
    from pathlib import Path

    from certreg.io.pairing import Pair
    from certreg.io.streams import Place

    Rows = list[tuple[Place, list[str]]]

ROW, LABEL, PROVED = "row", "label", "proved"
PAIR_COLUMNS = (ROW, LABEL, "residual", "bound", PROVED)


def read_inliers(path: Path, pair: Pair) -> list[bool]:
    """Whether each of the pairs is labelled as an inlier.

    From text with one label a line, for each row of the source, or from the table that `certify`
    writes of pairs that may be wrong, fit.csv, a row for each pair.

    Raises InvalidFileError where the file cannot be read, holds other words, another number, or
    is the table of other pairs.
    """
    rows = read_rows(path)
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
            words = f"{len(fields)} columns, not {len(header)}: mend the row"
            raise line.refusal(words, value=len(fields), limit=len(header))
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
