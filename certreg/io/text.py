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
from collections.abc import Iterator
from dataclasses import replace
from itertools import chain, pairwise, repeat
from math import inf, isfinite
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from certreg._loading import late
from certreg.errors import InvalidFileError, InvalidProblemError
from certreg.exact.dyadic import weight_of_sigma
from certreg.io.columns import (
    Columns,
    DecimalCommas,
    Points,
    axes_of,
    columns_in_order,
    named_columns,
    noise_of_columns,
    notes_on,
    separated_by_semicolons,
)
from certreg.io.labels import (
    require_same_order,
    rows_by_label,
    text_of_field,
    unused_labels_note,
)
from certreg.io.streams import (
    COUNT,
    NO_NUMBER,
    NUMBER,
    Place,
    in_column,
    is_missing,
    lines,
    number,
    reading,
    refused,
)
from certreg.verify import Clouds, shown

if TYPE_CHECKING:
    from certreg.io import atoms, obj
else:  # each for files of one ending
    atoms = late("certreg.io.atoms")
    obj = late("certreg.io.obj")

TABLE_FORMATS = (".csv", ".txt")  # of numbers, too: weights, pairs
COLUMN_FORMATS = (*TABLE_FORMATS, ".xyz", ".asc", ".pts")  # rows of columns: normals, too
TEXT_FORMATS = (*COLUMN_FORMATS, ".obj", ".pdb")
BLANKS = re.compile(r"[ \t]+")
COMMENTS = ("#", "//")
TOO_FEW = (
    "give three columns of numbers, separated by commas, or a header that names one column each x, "
    "y and z (and label)"
)


def read_points(path: str | Path, *, noise: bool = True) -> Points:
    """Points of a file of TEXT_FORMATS; x, y, z are the columns named so, or the first three.

    noise: whether columns `sigma` and `weight` are read. Raises InvalidFileError, also where
    there is no header and the first three columns may be others than x, y, z.
    """
    file = _one_of(TEXT_FORMATS, path)
    with reading(file) as stream:
        return parse_points(stream, file, noise=noise)


def parse_points(stream: BinaryIO, file: Path, *, noise: bool = True) -> Points:
    """Points of a text cloud; `file` tells the format and the name."""
    suffix, content = file.suffix.lower(), lines(stream, file)
    if suffix == ".obj":
        return obj.parse_obj(content, file)
    if suffix == ".pdb":
        return atoms.parse_pdb(content, file)
    if suffix == ".xyz":
        declared, content = atoms.chemical(content)
        if declared is not None:
            return atoms.chemical_points(content, file, declared)
    if suffix == ".csv":
        first, content = _first_row(content)
        semicolons = separated_by_semicolons(first)
        rows = _rows(content, file, ";" if semicolons else ",")
        return _table(rows, file, noise=noise, commas=DecimalCommas() if semicolons else None)
    said, content = _leading_comment(content)
    rows = _rows(content, file)
    declared = None
    if suffix in {".pts", ".asc"}:
        declared, rows = _declared_count(rows)
    points = _table(rows, file, noise=noise, comment=said)
    if declared is not None:
        _require_count(points, declared)
    return points


def _table(
    rows: Iterator[tuple[Place, list[str]]],
    file: Path,
    *,
    noise: bool,
    comment: str = "",
    commas: DecimalCommas | None = None,
) -> Points:
    place, first = next(rows, (Place(file, 1), list[str]()))
    columns, headed = _columns(place, first, noise=noise, comment=comment, commas=commas)
    rows = rows if headed else chain([(place, first)], rows)
    value = number if commas is None else commas.number
    axes, called, width = columns.axes, columns.called, len(columns.names)
    coordinates, names = array("d"), list[str]()
    kept = {name: array("d") for name in columns.noise}
    for place, row in rows:
        if len(row) != width:
            words = f"{len(row)} columns, not {width}: mend the row"
            raise place.refusal(words, value=len(row), limit=width)
        try:
            coordinates.extend(value(place, row[axis]) for axis in axes)
            for name, column in columns.noise.items():
                kept[name].append(_noise(place, name, value(place, row[column])))
        except InvalidFileError as error:
            if error.column is not None:
                raise
            raise _in_its_column(error, place, row, columns) from error
        if called is not None:
            names.append(text_of_field(row[called].strip()))
    if not coordinates:
        raise place.refusal("no points: add rows", value=0, limit=1)
    if commas is not None:
        commas.require_decimal()
    if not headed and columns.label is None and width > 3:
        _require_no_count(coordinates[::3], file)
    identifiers = None if called is None else tuple(names)
    return Points(
        coordinates,
        None if columns.label is None else identifiers,
        columns.ignored,
        identifiers,
        kept.get("sigma"),
        kept.get("weight"),
        (*columns.notes, *(() if commas is None else commas.notes)),
    )


def _in_its_column(
    error: InvalidFileError, place: Place, row: list[str], columns: Columns
) -> InvalidFileError:
    """The refusal of a number of a row, with its column: the first one that is read and has it."""
    read = (*columns.axes, *columns.noise.values())
    fields = [_with_point(row[column]) for column in read]
    return in_column(error, place, columns.names[read[fields.index(_with_point(error.value))]])


def _with_point(field: object) -> str:
    """A field as a decimal comma may have been changed in it."""
    return str(field).strip().replace(",", ".")


def _columns(
    place: Place, first: list[str], *, noise: bool, comment: str, commas: DecimalCommas | None
) -> tuple[Columns, bool]:
    """What the columns are, and whether the first row is the header that says so."""
    spaced = place.file.suffix.lower() != ".csv"
    plain = [_is_number(field, commas) for field in first]
    titles = comment.replace(",", " ").split()
    if spaced and all(plain[:3]) and len(titles) == len(first) and axes_of(_lowered(titles)):
        return named_columns(place, titles, noise=noise), False
    if len(first) < 3:
        raise place.refusal(TOO_FEW, value=first)
    if (spaced and all(plain[:3])) or all(plain):
        _require_three(place, first)
        return columns_in_order(len(first)), False
    symbols = place.file.suffix.lower() == ".xyz"  # in front, without a count: no labels
    if _labelled(plain, more=spaced) and not symbols:
        return columns_in_order(len(first), labelled=True), False
    if any(plain):
        missing = next((field for field in first if field.strip() and is_missing(field)), None)
        if missing is not None:
            place = place.at(f"column {first.index(missing) + 1}")
            raise place.refusal(f"'{shown(missing)}' {NO_NUMBER}", value=missing)
        k = plain.index(False)
        words = f"'{shown(first[k])}' is not a number, and the row is no header of names"
        remedy = "write plain decimal numbers, or add a header such as label,x,y,z"
        raise place.refusal(f"{words}: {remedy}", value=first[k])
    return named_columns(place, first, noise=noise), True


def _labelled(plain: list[bool], *, more: bool) -> bool:
    """Whether a first row is a name and x, y, z; with `more`, other columns behind."""
    return len(plain) >= 4 and plain[:4] == [False, True, True, True] and (more or len(plain) == 4)


def _lowered(names: list[str]) -> list[str]:
    return [name.lower() for name in names]


def _is_number(field: str, commas: DecimalCommas | None) -> bool:
    text = field.strip()
    return NUMBER.fullmatch(text if commas is None else text.replace(",", ".", 1)) is not None


def _noise(place: Place, name: str, value: float) -> float:
    """A standard deviation > 0 whose weight is a double, or a weight >= 0."""
    if name == "weight" and not value >= 0:
        raise place.refusal(f"weight {value!r}: weights must be >= 0", column=name, value=value)
    if name == "sigma" and not (value > 0 and 0 < weight_of_sigma(value) < inf):
        words = f"sigma {value!r}: give a standard deviation > 0 whose 1/sigma^2 is a double"
        raise place.refusal(words, column=name, value=value)
    return value


def _declared_count(
    rows: Iterator[tuple[Place, list[str]]],
) -> tuple[tuple[Place, int] | None, Iterator[tuple[Place, list[str]]]]:
    """The count that may stand alone in the first row, and the rows below it."""
    place, first = next(rows, (None, list[str]()))
    if place is None:
        return None, rows
    if len(first) == 1 and COUNT.fullmatch(first[0]):
        return (place, int(first[0])), rows
    return None, chain([(place, first)], rows)


def _require_count(points: Points, declared: tuple[Place, int]) -> None:
    place, n = declared
    held = len(points.coordinates) // 3
    if held != n:
        words = f"declares {n} points, the file holds {held}: give the true count"
        raise place.refusal(words, value=held, limit=n)


def _first_row(content: Iterator[str]) -> tuple[str, Iterator[str]]:
    """The first line that is not blank, and all lines as they were."""
    for blank, text in enumerate(content):
        if text.strip():
            return text, chain(repeat("\n", blank), [text], content)
    return "", iter(())


def _leading_comment(content: Iterator[str]) -> tuple[str, Iterator[str]]:
    """The last comment before the first row, which may name the columns, and the other lines."""
    said = ""
    for left, text in enumerate(content):
        line = text.strip()
        if line and not line.startswith(COMMENTS):
            return said, chain(repeat("\n", left), [text], content)
        said = line.lstrip("#/").strip() or said
    return said, iter(())


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
        raise refused(
            file,
            f"column 1 counts the rows ({column[0]:.0f}, {column[1]:.0f}, ...): is "
            "it x, or does it number the points? Leave out that column or those behind z, or save "
            "a .csv file with a header such as label,x,y,z",
            column="1",
        )


def read_numbers(path: str | Path) -> array[float]:
    """Numbers of a .csv or .txt file that has one of them a line, without a header."""
    return array("d", (number(place, ",".join(row)) for place, row in read_rows(path)))


def read_rows(path: str | Path) -> Iterator[tuple[Place, list[str]]]:
    """Place and fields of each row of a .csv or .txt file, a header among them."""
    file = _one_of(TABLE_FORMATS, path)
    with reading(file) as stream:
        yield from parse_rows(stream, file)


def parse_rows(stream: BinaryIO, file: Path) -> Iterator[tuple[Place, list[str]]]:
    """Place and fields of each row of a .csv or .txt file."""
    return _rows(lines(stream, file), file)


def titled_rows(
    stream: BinaryIO, file: Path
) -> tuple[Place, list[str], Iterator[tuple[Place, list[str]]]]:
    """Where the header of a table stands, its names as they are written, and the rows below it.

    In .csv numbers have decimal points; else the header may be the last comment above the rows.
    """
    content = lines(stream, file)
    if file.suffix.lower() == ".csv":
        first, content = _first_row(content)
        said, separator = "", ";" if separated_by_semicolons(first) else ","
    else:
        said, content = _leading_comment(content)
        separator = ","
    rows = _rows(content, file, separator)
    place, titles = next(rows, (Place(file, 1), list[str]()))
    spoken = said.replace(",", " ").split()
    if len(spoken) == len(titles) and all(_is_number(field, None) for field in titles):
        return place, spoken, chain([(place, titles)], rows)
    return place, titles, rows


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
    return replace(
        target,
        coordinates=array("d", map(target.coordinates.__getitem__, moved)),
        labels=source.labels,
        identifiers=source.labels,
        sigma=_of_rows(target.sigma, rows),
        weights=_of_rows(target.weights, rows),
    )


def _of_rows(numbers: array[float] | None, rows: list[int]) -> array[float] | None:
    return None if numbers is None else array("d", map(numbers.__getitem__, rows))


def read_clouds(
    source: Path, target: Path, *, sigma: float | None = None, weights: Path | None = None
) -> tuple[Clouds, list[str]]:
    """Two text clouds, paired, with their weights if given, for the checker; and notes."""
    bare = sigma is None and weights is None
    first, second = (read_points(file, noise=bare) for file in (source, target))
    files = (source, target)
    notes = [
        note
        for file, points in zip(files, (first, second), strict=True)
        for note in notes_on(file, points.notes, points.ignored)
    ]
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
    if bare:
        noise = noise_of_columns(first, second, files)
        masses = noise.weights
        if noise.sigma is not None:
            masses = array("d", map(weight_of_sigma, noise.sigma))
        notes += noise.notes
    return Clouds(first.coordinates, second.coordinates, masses), notes


def _one_of(formats: tuple[str, ...], path: str | Path) -> Path:
    file = Path(path)
    if file.suffix.lower() not in formats:
        known = " or ".join((", ".join(formats[:-1]), formats[-1]))
        raise refused(
            file, f"not a known format: give a {known} file", value=file.suffix, limit=formats
        )
    return file


def _rows(
    content: Iterator[str], file: Path, separator: str = ","
) -> Iterator[tuple[Place, list[str]]]:
    """Place and fields of each row; only in .csv, blanks are no commas and # is no comment."""
    line, spaced = 0, file.suffix.lower() != ".csv"
    try:
        if spaced:
            content = (_commas(text.partition("#")[0].strip()) for text in content)
        quotes = csv.QUOTE_NONE if spaced else csv.QUOTE_MINIMAL
        reader = csv.reader(content, delimiter=separator, quoting=quotes, strict=True)
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
