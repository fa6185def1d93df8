"""Clouds in .pcd files of PCL: fields x, y, z, whatever else is declared beside them.

The entries of the header must agree with each other and with the data. An organised cloud
(HEIGHT > 1) is read row by row of the image; its missing points, NaN, are refused: they have no
partner. The VIEWPOINT is where the sensor stood; it moves no point.
"""

from __future__ import annotations

import struct
from array import array
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from certreg.errors import InvalidFileError
from certreg.io.lzf import decompress
from certreg.io.npy import points_of_columns
from certreg.io.ply_rows import typed_number
from certreg.io.streams import NUMBER, HeaderLine, count, header, held_bytes, rows_of_words
from certreg.settings import FileSettings
from certreg.verify import shown

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

KEYS = {"VERSION", "FIELDS", "SIZE", "TYPE", "COUNT", "WIDTH", "HEIGHT", "VIEWPOINT", "POINTS"}
OPTIONAL = {"VERSION", "COUNT", "VIEWPOINT"}
VERSIONS = {".5", ".6", ".7", "0.5", "0.6", "0.7"}
TYPES = {f"{letter}{size}" for letter in "iu" for size in (1, 2, 4, 8)} | {"f4", "f8"}
SIZES = struct.Struct("<2I")  # before compressed data: packed, unpacked


@dataclass(frozen=True, slots=True)
class Field:
    """Numbers of one type in each row; types as NumPy spells them."""

    name: str
    type: str
    count: int

    @property
    def size(self) -> int:
        """Bytes in a row."""
        return self.count * int(self.type[1])


@dataclass(frozen=True, slots=True)
class Header:
    """A header that agrees with itself."""

    fields: list[Field]
    points: int
    data: str

    @property
    def size(self) -> int:
        """Bytes of all rows, unpacked."""
        return self.points * sum(field.size for field in self.fields)


def parse_pcd(stream: BinaryIO, file: Path) -> tuple[NDArray[np.float64], tuple[str, ...]]:
    """The points of a .pcd file, and the names of the fields beside x, y, z."""
    name = shown(file)
    top = header(stream, name, "DATA")
    declared = _declared(name, top)
    if declared.data == "ascii":
        columns = _from_text(stream, name, declared, len(top) + 1)
    elif declared.data == "binary":
        _require_size(name, declared.size, held_bytes(stream, file))
        columns = _of_rows(stream.read(declared.size), declared)
    else:
        columns = _of_blocks(_unpacked(stream, file, declared), declared)
    others = (f.name for f in declared.fields if f.name not in {"x", "y", "z", "_"})
    return points_of_columns(file, columns), tuple(others)


def _declared(name: str, top: list[HeaderLine]) -> Header:
    entries: dict[str, HeaderLine] = {}
    for line in top[:-1]:
        if line.key.startswith("#") or not line.key:
            continue
        if line.key not in KEYS or line.key in entries or not line.words:
            message = f"{line.place}: '{shown(line.key)}' is unknown, empty or here again: mend it"
            raise InvalidFileError(message)
        entries[line.key] = line
    missing = sorted(KEYS - OPTIONAL - set(entries))
    if missing:
        message = f"{name}: the header has no {missing[0]}: is it a .pcd file?"
        raise InvalidFileError(message)
    _require_plain(entries)
    width, height, points = (_one_count(entries[key]) for key in ("WIDTH", "HEIGHT", "POINTS"))
    if width * height != points or points == 0:
        message = (
            f"{entries['POINTS'].place}: {points} points, but width {width} times height {height}: "
            "give at least one, and the true numbers"
        )
        raise InvalidFileError(message)
    last = top[-1]
    if last.words not in (["ascii"], ["binary"], ["binary_compressed"]):
        message = f"{last.place}: unknown data: save it as ascii, binary or binary_compressed"
        raise InvalidFileError(message)
    return Header(_fields(entries), points, last.words[0])


def _require_plain(entries: dict[str, HeaderLine]) -> None:
    """That version and viewpoint, where they are given, are what they should be."""
    version = entries.get("VERSION")
    if version and (len(version.words) != 1 or version.words[0] not in VERSIONS):
        message = f"{version.place}: unknown version: save it as version 0.7"
        raise InvalidFileError(message)
    stand = entries.get("VIEWPOINT")
    if stand and (len(stand.words) != 7 or not all(map(NUMBER.fullmatch, stand.words))):
        message = f"{stand.place}: the viewpoint is not 7 numbers: write 0 0 0 1 0 0 0"
        raise InvalidFileError(message)


def _one_count(line: HeaderLine) -> int:
    return count(line.place, " ".join(line.words))


def _fields(entries: dict[str, HeaderLine]) -> list[Field]:
    names = entries["FIELDS"].words
    ones = HeaderLine(entries["FIELDS"].place, "COUNT", ["1"] * len(names))
    lines = [entries["SIZE"], entries["TYPE"], entries.get("COUNT", ones)]
    for line in lines:
        if len(line.words) != len(names):
            message = f"{line.place}: {len(line.words)} entries for {len(names)} fields: mend it"
            raise InvalidFileError(message)
    fields: list[Field] = []
    for title, size, letter, times in zip(names, *(line.words for line in lines), strict=True):
        kind = letter.lower() + size
        if kind not in TYPES or not letter.isupper():
            message = (
                f"{lines[1].place}: field '{shown(title)}' has no known TYPE and SIZE: use F 4"
            )
            raise InvalidFileError(message)
        fields.append(Field(title, kind, count(lines[2].place, times)))
        if fields[-1].count == 0:
            message = f"{lines[2].place}: field '{shown(title)}' has COUNT 0: leave it out"
            raise InvalidFileError(message)
    single = [field.name for field in fields if field.count == 1]
    if [(single.count(axis), names.count(axis)) for axis in "xyz"] != [(1, 1)] * 3:
        message = f"{entries['FIELDS'].place}: give one field each x, y and z, of COUNT 1"
        raise InvalidFileError(message)
    return fields


def _from_text(stream: BinaryIO, name: str, declared: Header, line: int) -> list[NDArray[Any]]:
    width, slots, at = sum(field.count for field in declared.fields), dict[str, int](), 0
    for field in declared.fields:
        slots[field.name], at = at, at + field.count
    types = {field.name: field.type for field in declared.fields}
    columns = {axis: array("d") for axis in "xyz"}
    found = 0
    for place, words in rows_of_words(stream, name, line):
        found += 1
        if len(words) != width or found > declared.points:
            what = f"{len(words)} numbers, the header declares {width}"
            message = f"{place}: {what}, in {declared.points} rows: mend the row or the header"
            raise InvalidFileError(message)
        for axis, column in columns.items():
            column.append(typed_number(place, words[slots[axis]], types[axis]))
    if found != declared.points:
        message = (
            f"{name}: the header declares {declared.points} points, the file holds {found}: "
            "it is truncated or corrupt; save it again"
        )
        raise InvalidFileError(message)
    return [np.array(column) for column in columns.values()]


def _require_size(name: str, declared: int, held: int) -> None:
    if declared != held:
        message = (
            f"{name}: the header declares {declared} bytes of data, the file holds {held}: "
            "it is truncated or corrupt; save it again"
        )
        raise InvalidFileError(message)


def _of_rows(data: bytes, declared: Header) -> list[NDArray[Any]]:
    """Columns x, y, z of rows one behind the other."""
    starts, at = dict[str, int](), 0
    for field in declared.fields:
        starts[field.name], at = at, at + field.size
    types = {field.name: f"<{field.type}" for field in declared.fields}
    rows = np.frombuffer(data, np.uint8).reshape(declared.points, at)
    return [
        rows[:, starts[axis] : starts[axis] + int(types[axis][2])].copy().view(types[axis])[:, 0]
        for axis in "xyz"
    ]


def _of_blocks(data: bytes, declared: Header) -> list[NDArray[Any]]:
    """Columns x, y, z where all of a field stands before all of the next."""
    columns: dict[str, NDArray[Any]] = {}
    at = 0
    for field in declared.fields:
        if field.name in {"x", "y", "z"}:
            columns[field.name] = np.frombuffer(data, f"<{field.type}", declared.points, at)
        at += declared.points * field.size
    return [columns[axis] for axis in "xyz"]


def _unpacked(stream: BinaryIO, file: Path, declared: Header) -> bytes:
    """Compressed data, unpacked only if the sizes before them are those of file and header."""
    held, name = held_bytes(stream, file), shown(file)
    sizes = stream.read(SIZES.size)
    packed, unpacked = SIZES.unpack(sizes) if len(sizes) == SIZES.size else (0, 0)
    _require_size(name, packed + SIZES.size, held)
    _require_size(name, declared.size, unpacked)
    limit = FileSettings().max_unpacked_bytes
    data = decompress(stream.read(packed), unpacked) if unpacked <= limit else None
    if data is None:
        message = f"{name}: the compressed data are corrupt or too large: save it as binary"
        raise InvalidFileError(message)
    return data
