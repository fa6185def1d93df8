"""Text clouds and weights, by the standard library alone: `certreg verify` loads no NumPy.

Strict: a number is what a person would call one, every row has the columns of the first, and an
error names the file, the line and the remedy. An .xyz file is read as .txt unless its first line
is a count alone: then it is chemical.

Without a header, which columns are x, y, z? Of three, these. A .csv file with more is refused: the
first may number the points. In .txt and .xyz others stand behind z by convention (intensity,
colour); there more than three are refused only where the first counts the rows: 0, 1, 2, ...
"""

from __future__ import annotations

import csv
import re
from array import array
from dataclasses import dataclass
from itertools import chain, pairwise
from math import inf, isfinite
from pathlib import Path
from typing import TYPE_CHECKING

from certreg.errors import InvalidFileError, InvalidProblemError
from certreg.exact import weight_of_sigma
from certreg.io.labels import (
    IDENTIFIERS,
    require_same_order,
    rows_by_label,
    text_of_field,
    unused_labels_note,
)
from certreg.io.streams import NUMBER, Place, lines, number, reading
from certreg.io.xyz import chemical, chemical_points
from certreg.verify import Clouds, shown

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import BinaryIO

TABLE_FORMATS = (".csv", ".txt")  # of numbers, too: weights, pairs
TEXT_FORMATS = (*TABLE_FORMATS, ".xyz")
BLANKS = re.compile(r"[ \t]+")


@dataclass(frozen=True, slots=True)
class Points:
    """A cloud from a text file: 3n coordinates row by row, the rows' labels, columns left out.

    identifiers: the labels, or else what a column left out calls the points, if there is one.
    """

    coordinates: array[float]
    labels: tuple[str, ...] | None
    ignored: tuple[str, ...]
    identifiers: tuple[str, ...] | None = None


def read_points(path: str | Path) -> Points:
    """Points of a .csv, .txt or .xyz file; x, y, z are the columns named so, or the first three.

    Only a .csv may have a header, and with it a column `label`. Raises InvalidFileError, also where
    there is no header and the first three columns may be others than x, y, z.
    """
    file = _one_of(TEXT_FORMATS, path)
    with reading(file) as stream:
        return parse_points(stream, file)


def parse_points(stream: BinaryIO, file: Path) -> Points:
    """Points of a text cloud; `file` tells the format and the name."""
    content = lines(stream, file)
    if file.suffix.lower() == ".xyz":
        declared, content = chemical(content)
        if declared is not None:
            coordinates, width = chemical_points(content, file, declared)
            return Points(coordinates, None, tuple(f"column {k}" for k in range(5, width + 1)))
    return _table(_rows(content, file), file)


def _table(rows: Iterator[tuple[Place, list[str]]], file: Path) -> Points:
    place, first = next(rows, (Place(file, 1), list[str]()))
    names = [name.strip().lower() for name in first]
    bare = file.suffix.lower() != ".csv" or all(map(NUMBER.fullmatch, names))
    if bare:
        _require_three(place, names)
        names = ["x", "y", "z", *(f"column {k}" for k in range(4, len(first) + 1))][: len(first)]
        rows = chain([(place, first)], rows)
    if [names.count(name) for name in "xyz"] != [1, 1, 1] or names.count("label") > 1:
        words = (
            "give three columns of numbers, separated by commas, or a header that names "
            "one column each x, y and z (and label)"
        )
        raise place.refusal(words, value=names)
    axes, coordinates, called = [names.index(name) for name in "xyz"], array("d"), list[str]()
    calling = next((names.index(name) for name in ("label", *IDENTIFIERS) if name in names), None)
    for place, row in rows:
        if len(row) != len(names):
            words = f"{len(row)} columns, not {len(names)}: mend the row"
            raise place.refusal(words, value=len(row), limit=len(names))
        coordinates.extend(number(place, row[axis]) for axis in axes)
        called += [] if calling is None else [text_of_field(row[calling].strip())]
    if not coordinates:
        raise place.refusal("no points: add rows", value=0, limit=1)
    if bare and len(names) > 3:
        _require_no_count(coordinates[::3], file)
    ignored = tuple(name for name in names if name not in {"x", "y", "z", "label"})
    identifiers = None if calling is None else tuple(called)
    return Points(coordinates, identifiers if "label" in names else None, ignored, identifiers)


def _require_three(place: Place, fields: list[str]) -> None:
    """That a .csv file without a header leaves no doubt which columns are x, y, z."""
    if place.file.suffix.lower() == ".csv" and len(fields) > 3:
        words = (
            f"{len(fields)} columns and no header: which are x, y, z? Add a header such "
            "as label,x,y,z"
        )
        raise place.refusal(words, value=len(fields), limit=3)


def _require_no_count(column: array[float], file: Path) -> None:
    """That the first of more than three columns without a header does not count the rows."""
    if len(column) > 1 and column[0].is_integer() and all(b - a == 1 for a, b in pairwise(column)):
        message = (
            f"{shown(file)}: column 1 counts the rows ({column[0]:.0f}, {column[1]:.0f}, ...): is "
            "it x, or does it number the points? Leave out that column or those behind z, or save "
            "a .csv file with a header such as label,x,y,z"
        )
        raise InvalidFileError(message, path=file, column="1")


def read_numbers(path: str | Path) -> array[float]:
    """Numbers of a .csv or .txt file that has one of them a line, without a header."""
    file = _one_of(TABLE_FORMATS, path)
    with reading(file) as stream:
        return parse_numbers(stream, file)


def parse_numbers(stream: BinaryIO, file: Path) -> array[float]:
    """One number a line; `file` tells the format and the name."""
    return array("d", (number(place, ",".join(row)) for place, row in parse_rows(stream, file)))


def parse_rows(stream: BinaryIO, file: Path) -> Iterator[tuple[Place, list[str]]]:
    """Place and fields of each row of a .csv or .txt file."""
    return _rows(lines(stream, file), file)


def pair_by_label(source: Points, target: Points, files: tuple[Path, Path]) -> Points:
    """Target in the source's order where both have labels; otherwise as it is, of the same n.

    files: of source and target, for errors.
    """
    n, other = len(source.coordinates) // 3, len(target.coordinates) // 3
    if source.labels is None or target.labels is None:
        if n != other:
            message = f"{n} source but {other} target points: pair the rows, or add labels"
            raise InvalidFileError(message, path=files[1], value=other, limit=n)
        require_same_order(source.identifiers, target.identifiers, files)
        return target
    _, rows = rows_by_label(source.labels, target.labels, files=files)
    moved = (3 * row + axis for row in rows for axis in range(3))
    coordinates = array("d", map(target.coordinates.__getitem__, moved))
    return Points(coordinates, source.labels, target.ignored, source.labels)


def ignored_note(path: Path, ignored: tuple[str, ...]) -> str | None:
    """What the user should know about columns that were not read."""
    if not ignored:
        return None
    hint = " (only `label` pairs rows)" if path.suffix.lower() == ".csv" else ""
    return f"{shown(path)}: not used: {shown(', '.join(ignored))}{hint}"


def read_clouds(
    source: Path, target: Path, *, sigma: float | None = None, weights: Path | None = None
) -> tuple[Clouds, list[str]]:
    """Two text clouds, paired, with their weights if given, for the checker; and notes."""
    first, second = read_points(source), read_points(target)
    files = (source, target)
    notes = [ignored_note(source, first.ignored), ignored_note(target, second.ignored)]
    notes += unused_labels_note((first.labels is not None, second.labels is not None), files)
    second = pair_by_label(first, second, files)
    masses = None if weights is None else read_numbers(weights)
    if sigma is not None:
        if not (isfinite(sigma) and sigma > 0 and 0 < weight_of_sigma(sigma) < inf):
            message = (
                f"sigma is {sigma!r}: give a standard deviation > 0 whose 1/sigma^2 is a double"
            )
            raise InvalidProblemError(message, array="sigma", value=sigma)
        masses = array("d", [weight_of_sigma(sigma)]) * (len(first.coordinates) // 3)
    clouds = Clouds(first.coordinates, second.coordinates, masses)
    return clouds, [note for note in notes if note is not None]


def _one_of(formats: tuple[str, ...], path: str | Path) -> Path:
    file = Path(path)
    if file.suffix.lower() not in formats:
        known = " or ".join((", ".join(formats[:-1]), formats[-1]))
        message = f"{shown(file)}: not a known format: give a {known} file"
        raise InvalidFileError(message, path=file, value=file.suffix, limit=formats)
    return file


def _rows(content: Iterator[str], file: Path) -> Iterator[tuple[Place, list[str]]]:
    """Place and fields of each row; only in .csv, blanks are no commas and # is no comment."""
    line, spaced = 0, file.suffix.lower() != ".csv"
    try:
        if spaced:
            content = (_commas(text.partition("#")[0].strip()) for text in content)
        quotes = csv.QUOTE_NONE if spaced else csv.QUOTE_MINIMAL
        reader = csv.reader(content, quoting=quotes, strict=True)
        for row in filter(None, reader):
            line = reader.line_num
            yield Place(file, line), row
    except (ValueError, csv.Error) as error:
        raise Place(file, line + 1).refusal(f"{shown(error)}: mend the text") from error


def _commas(line: str) -> str:
    """A line of .txt with commas between its fields; blanks within a field are left, to be refused.

    So `1,5 2,5 3,5`, with decimal commas, is not taken for six numbers.
    """
    return line if "," in line else BLANKS.sub(",", line)
