"""Text clouds and weights, by the standard library alone: `certreg verify` loads no NumPy.

Strict: a number is what a person would call one, every row has the columns of the first, and an
error names the file, the line and the remedy.
"""

from __future__ import annotations

import csv
import re
from array import array
from collections import Counter
from dataclasses import dataclass
from functools import partial
from itertools import chain
from math import inf, isfinite
from pathlib import Path
from typing import TYPE_CHECKING

from certreg.dyadic import weight_of_sigma
from certreg.errors import InvalidFileError, InvalidProblemError
from certreg.settings import FileSettings
from certreg.verify import Clouds, shown

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import BinaryIO

TEXT_FORMATS = (".csv", ".txt")
BLANKS = re.compile(r"[ \t]+")
NUMBER = re.compile(r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]+)?")


@dataclass(frozen=True, slots=True)
class Points:
    """A cloud from a text file: 3n coordinates row by row, the rows' labels, columns left out."""

    coordinates: array[float]
    labels: tuple[str, ...] | None
    ignored: tuple[str, ...]


def read_points(path: str | Path) -> Points:
    """Points of a .csv or .txt file; x, y, z are the columns named so, or else the first three.

    Only a .csv may have a header, and with it a column `label`.
    """
    file = Path(path)
    rows = _rows(file)
    place, first = next(rows, (f"{shown(file)}, line 1", list[str]()))
    names = [name.strip().lower() for name in first]
    if file.suffix.lower() == ".txt" or all(map(NUMBER.fullmatch, names)):
        names = ["x", "y", "z", *(f"column {k}" for k in range(4, len(first) + 1))][: len(first)]
        rows = chain([(place, first)], rows)
    if [names.count(name) for name in "xyz"] != [1, 1, 1] or names.count("label") > 1:
        message = (
            f"{place}: give three columns of numbers, separated by commas, or a header that names "
            "one column each x, y and z (and label)"
        )
        raise InvalidFileError(message)
    axes, coordinates, labels = [names.index(name) for name in "xyz"], array("d"), list[str]()
    for place, row in rows:
        if len(row) != len(names):
            message = f"{place}: {len(row)} columns, not {len(names)}: mend the row"
            raise InvalidFileError(message)
        coordinates.extend(_number(place, row[axis]) for axis in axes)
        labels += [row[names.index("label")].strip()] if "label" in names else []
    if not coordinates:
        message = f"{place}: no points: add rows"
        raise InvalidFileError(message)
    ignored = tuple(name for name in names if name not in {"x", "y", "z", "label"})
    return Points(coordinates, tuple(labels) if "label" in names else None, ignored)


def read_numbers(path: str | Path) -> array[float]:
    """Numbers of a .csv or .txt file that has one of them a line, without a header."""
    return array("d", (_number(place, ",".join(row)) for place, row in _rows(Path(path))))


def pair_by_label(source: Points, target: Points) -> Points:
    """Target in the source's order where both have labels; otherwise as it is, of the same n."""
    n, other = len(source.coordinates) // 3, len(target.coordinates) // 3
    if source.labels is None or target.labels is None:
        if n != other:
            message = f"{n} source but {other} target points: pair the rows, or add labels"
            raise InvalidFileError(message)
        return target
    sides = {"source": Counter(source.labels), "target": Counter(target.labels)}
    for label in chain(source.labels, target.labels):
        for side, count in ((side, counter[label]) for side, counter in sides.items()):
            if count != 1:
                what = f"label '{shown(label)}' occurs {count} times in the {side}"
                message = f"{what}: each must occur once in both; drop it, or rename it"
                raise InvalidFileError(message)
    rows = {label: 3 * k for k, label in enumerate(target.labels)}
    moved = (rows[label] + axis for label in source.labels for axis in range(3))
    coordinates = array("d", map(target.coordinates.__getitem__, moved))
    return Points(coordinates, source.labels, target.ignored)


def ignored_note(path: Path, ignored: tuple[str, ...]) -> str | None:
    """What the user should know about columns that were not read."""
    what = f"columns not used: {shown(', '.join(ignored))}"
    return f"{shown(path)}: {what} (only `label` pairs rows)" if ignored else None


def read_clouds(
    source: Path, target: Path, *, sigma: float | None = None, weights: Path | None = None
) -> tuple[Clouds, list[str]]:
    """Two text clouds, paired, with their weights if told, for the checker; and notes."""
    first, second = read_points(source), read_points(target)
    notes = (ignored_note(source, first.ignored), ignored_note(target, second.ignored))
    second = pair_by_label(first, second)
    masses = None if weights is None else read_numbers(weights)
    if sigma is not None:
        if not (isfinite(sigma) and sigma > 0 and 0 < weight_of_sigma(sigma) < inf):
            message = (
                f"sigma is {sigma!r}: give a standard deviation > 0 whose 1/sigma^2 is a double"
            )
            raise InvalidProblemError(message)
        masses = array("d", [weight_of_sigma(sigma)]) * (len(first.coordinates) // 3)
    clouds = Clouds(first.coordinates, second.coordinates, masses)
    return clouds, [note for note in notes if note is not None]


def _rows(path: Path) -> Iterator[tuple[str, list[str]]]:
    """Place and fields of each row; in .txt blanks do for commas and # begins a comment."""
    name, line, spaced = shown(path), 0, path.suffix.lower() == ".txt"
    if path.suffix.lower() not in TEXT_FORMATS:
        message = f"{name}: not a known format: give a .csv or .txt file"
        raise InvalidFileError(message)
    try:
        with path.open("rb") as file:
            lines = _lines(file, name)
            if spaced:
                lines = (_commas(line.partition("#")[0].strip()) for line in lines)
            quotes = csv.QUOTE_NONE if spaced else csv.QUOTE_MINIMAL
            reader = csv.reader(lines, quoting=quotes, strict=True)
            for row in filter(None, reader):
                line = reader.line_num
                yield f"{name}, line {line}", row
    except OSError as error:
        message = f"{name}: {error.strerror}: give a readable file"
        raise InvalidFileError(message) from error
    except (ValueError, csv.Error) as error:
        remedy = "save the file as UTF-8" if isinstance(error, UnicodeError) else "mend the text"
        message = f"{name}, line {line + 1}: {shown(error)}: {remedy}"
        raise InvalidFileError(message) from error


def _commas(line: str) -> str:
    """A line of .txt with commas between its fields; blanks within a field are left, to be refused.

    So `1,5 2,5 3,5`, with decimal commas, is not taken for six numbers.
    """
    return line if "," in line else BLANKS.sub(",", line)


def _lines(file: BinaryIO, name: str) -> Iterator[str]:
    """The lines of UTF-8 text, each and all of bounded length."""
    settings, size = FileSettings(), 0
    for number, raw in enumerate(iter(partial(file.readline, settings.max_line_bytes), b""), 1):
        size += len(raw)
        if len(raw) == settings.max_line_bytes or size > settings.max_text_bytes:
            message = f"{name}, line {number}: the line or the file is too long: is it a cloud?"
            raise InvalidFileError(message)
        yield raw.decode("utf-8-sig" if number == 1 else "utf-8")


def _number(place: str, text: str) -> float:
    match = NUMBER.fullmatch(text.strip(" \t"))
    if not match or not isfinite(float(text)):
        what = f"'{shown(text)}' is not a {'finite ' if match else ''}number"
        message = f"{place}: {what}: write plain decimal numbers"
        raise InvalidFileError(message)
    return float(text)
