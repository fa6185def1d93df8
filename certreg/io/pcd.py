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

from certreg.io.cloud import Cloud
from certreg.io.npy import points_of_columns
from certreg.io.streams import (
    MAX_UNPACKED_BYTES,
    NUMBER,
    HeaderLine,
    count,
    header,
    held_bytes,
    refused,
    require_held,
    rows_of_words,
    typed_numbers,
)
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
    kept: tuple[str, ...]  # the names of what is read: x, y, z first

    @property
    def size(self) -> int:
        """Bytes of all rows, unpacked."""
        return self.points * sum(field.size for field in self.fields)


def parse_pcd(stream: BinaryIO, file: Path, further: frozenset[str] = frozenset()) -> Cloud:
    """The points of a .pcd file, and the names of the fields beside x, y, z.

    further: fields of COUNT 1 that are read, too, where there are such.
    """
    top = header(stream, file, "DATA")
    declared = _declared(file, top, further)
    if declared.data == "ascii":
        columns = _from_text(stream, file, declared, len(top) + 1)
    elif declared.data == "binary":
        require_held(file, declared.size, held_bytes(stream, file))
        columns = _of_rows(stream.read(declared.size), declared)
    else:
        columns = _of_blocks(_unpacked(stream, file, declared), declared)
    others = (f.name for f in declared.fields if f.name not in {"x", "y", "z", "_"})
    return Cloud(
        path=file,
        points=points_of_columns(file, [columns[axis] for axis in "xyz"]),
        ignored=tuple(others),
        further={name: columns[name] for name in declared.kept[3:]},
    )


def _declared(file: Path, top: list[HeaderLine], further: frozenset[str]) -> Header:
    entries: dict[str, HeaderLine] = {}
    for line in top[:-1]:
        if line.key.startswith("#") or not line.key:
            continue
        if line.key not in KEYS or line.key in entries or not line.words:
            raise line.place.refusal(
                f"'{shown(line.key)}' is unknown, empty or here again: mend it", column=line.key
            )
        entries[line.key] = line
    missing = sorted(KEYS - OPTIONAL - set(entries))
    if missing:
        raise refused(
            file, f"the header has no {missing[0]}: is it a .pcd file?", column=missing[0]
        )
    _require_plain(entries)
    width, height, points = (_one_count(entries[key]) for key in ("WIDTH", "HEIGHT", "POINTS"))
    if width * height != points or points == 0:
        words = (
            f"{points} points, but width {width} times height {height}: "
            "give at least one, and the true numbers"
        )
        place = entries["POINTS"].place
        raise place.refusal(words, column="POINTS", value=points, limit=width * height)
    last = top[-1]
    if last.words not in (["ascii"], ["binary"], ["binary_compressed"]):
        raise last.place.refusal(
            "unknown data: save it as ascii, binary or binary_compressed",
            column="DATA",
            value=" ".join(last.words),
        )
    fields = _fields(entries)
    single = [field.name for field in fields if field.count == 1]
    kept = (*"xyz", *(name for name in single if name in further and single.count(name) == 1))
    return Header(fields, points, last.words[0], kept)


def _require_plain(entries: dict[str, HeaderLine]) -> None:
    """That version and viewpoint, where they are given, are what they should be."""
    version = entries.get("VERSION")
    if version and (len(version.words) != 1 or version.words[0] not in VERSIONS):
        raise version.place.refusal(
            "unknown version: save it as version 0.7",
            column="VERSION",
            value=" ".join(version.words),
        )
    stand = entries.get("VIEWPOINT")
    if stand and (len(stand.words) != 7 or not all(map(NUMBER.fullmatch, stand.words))):
        raise stand.place.refusal(
            "the viewpoint is not 7 numbers: write 0 0 0 1 0 0 0",
            column="VIEWPOINT",
            value=" ".join(stand.words),
        )


def _one_count(line: HeaderLine) -> int:
    return count(line.place, " ".join(line.words))


def _fields(entries: dict[str, HeaderLine]) -> list[Field]:
    names = entries["FIELDS"].words
    ones = HeaderLine(entries["FIELDS"].place, "COUNT", ["1"] * len(names))
    lines = [entries["SIZE"], entries["TYPE"], entries.get("COUNT", ones)]
    for line in lines:
        if len(line.words) != len(names):
            raise line.place.refusal(
                f"{len(line.words)} entries for {len(names)} fields: mend it",
                column=line.key,
                value=len(line.words),
                limit=len(names),
            )
    fields: list[Field] = []
    for title, size, letter, times in zip(names, *(line.words for line in lines), strict=True):
        kind = letter.lower() + size
        if kind not in TYPES or not letter.isupper():
            raise lines[1].place.refusal(
                f"field '{shown(title)}' has no known TYPE and SIZE: use F 4",
                column=title,
                value=f"{letter} {size}",
            )
        fields.append(Field(title, kind, count(lines[2].place, times)))
        if fields[-1].count == 0:
            raise lines[2].place.refusal(
                f"field '{shown(title)}' has COUNT 0: leave it out", column=title, value=0, limit=1
            )
    single = [field.name for field in fields if field.count == 1]
    if [(single.count(axis), names.count(axis)) for axis in "xyz"] != [(1, 1)] * 3:
        raise entries["FIELDS"].place.refusal(
            "give one field each x, y and z, of COUNT 1", column="FIELDS", value=" ".join(names)
        )
    return fields


def _from_text(
    stream: BinaryIO, file: Path, declared: Header, line: int
) -> dict[str, NDArray[Any]]:
    width, slots, at = sum(field.count for field in declared.fields), dict[str, int](), 0
    for field in declared.fields:
        slots[field.name], at = at, at + field.count
    types = {field.name: field.type for field in declared.fields}
    wanted = [(slots[name], types[name], name) for name in declared.kept]
    numbers, held = array("d"), 0
    for held, (place, words) in enumerate(rows_of_words(stream, file, line), 1):
        if held > declared.points:
            raise place.refusal(
                f"row {held}, the header declares {declared.points} rows: mend the header",
                value=held,
                limit=declared.points,
            )
        if len(words) != width:
            raise place.refusal(
                f"{len(words)} numbers, the header declares {width}: mend the row or the header",
                value=len(words),
                limit=width,
            )
        numbers.extend(typed_numbers(place, words, wanted))
    if held != declared.points:
        raise refused(
            file,
            f"the header declares {declared.points} points, the file holds {held}: "
            "it is truncated or corrupt; save it again",
            value=held,
            limit=declared.points,
        )
    columns = np.array(numbers).reshape(held, len(wanted))
    return {name: columns[:, k] for k, name in enumerate(declared.kept)}


def _of_rows(data: bytes, declared: Header) -> dict[str, NDArray[Any]]:
    """The columns that are read, of rows one behind the other."""
    fields: list[Any] = [
        (str(k), f"<{field.type}", (field.count,)) for k, field in enumerate(declared.fields)
    ]
    rows = np.frombuffer(data, np.dtype(fields))
    names = [field.name if field.count == 1 else "" for field in declared.fields]
    return {name: rows[str(names.index(name))][:, 0] for name in declared.kept}


def _of_blocks(data: bytes, declared: Header) -> dict[str, NDArray[Any]]:
    """The columns that are read, where all of a field stands before all of the next."""
    columns: dict[str, NDArray[Any]] = {}
    at = 0
    for field in declared.fields:
        if field.name in declared.kept:
            columns[field.name] = np.frombuffer(data, f"<{field.type}", declared.points, at)
        at += declared.points * field.size
    return columns


def _unpacked(stream: BinaryIO, file: Path, declared: Header) -> bytes:
    """Compressed data, unpacked only if the sizes before them are those of file and header."""
    held = held_bytes(stream, file)
    sizes = stream.read(SIZES.size)
    packed, unpacked = SIZES.unpack(sizes) if len(sizes) == SIZES.size else (0, 0)
    require_held(file, packed + SIZES.size, held)
    require_held(file, declared.size, unpacked)
    small = unpacked <= MAX_UNPACKED_BYTES
    data = decompress(stream.read(packed), unpacked) if small else None
    if data is None:
        raise refused(
            file,
            "the compressed data are corrupt or too large: save it as binary",
            value=unpacked,
            limit=MAX_UNPACKED_BYTES,
        )
    return data


def decompress(packed: bytes, size: int) -> bytes | None:
    r"""The unpacked bytes, if they are exactly `size`; None for anything else.

    LZF: runs of new bytes, and copies of what was there before.

    >>> decompress(bytes([1, 7, 8, 0x60, 1]), 7)
    b'\x07\x08\x07\x08\x07\x08\x07'
    >>> decompress(bytes([1, 7, 8, 0x60, 2]), 7) is None  # a copy from before the beginning
    True
    """
    out, at = bytearray(), 0
    try:
        while at < len(packed):
            control, at = packed[at], at + 1
            if control < 32:  # 000lllll: l + 1 new bytes follow
                out += packed[at : at + control + 1]
                at += control + 1
            else:  # llldddddd..: copy l + 2 bytes; l = 7 continues in a byte of its own
                length = control >> 5
                if length == 7:
                    length, at = 7 + packed[at], at + 1
                distance = ((control & 31) << 8 | packed[at]) + 1
                at += 1
                chunk = out[-distance:] if distance <= len(out) else b""
                copies = -(-(length + 2) // len(chunk))
                out += (chunk * copies)[: length + 2]
            if len(out) > size:
                return None
    except (IndexError, ZeroDivisionError):
        return None
    return bytes(out) if len(out) == size and at == len(packed) else None
