"""Clouds in .ply files: x, y, z of the element `vertex`, whatever else is declared around them.

A property `label` names the points, as in a table; `sigma` and `weight` say how sure they are.
Every declared row must be there, and nothing behind the last. In ascii files the number that is
written counts, also where its type is `float`: it is read as the nearest double.
"""

from __future__ import annotations

import mmap
import struct
from array import array
from collections.abc import Container, Iterable, Iterator
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from certreg.errors import InvalidFileError
from certreg.io.atomic import write_atomically
from certreg.io.cloud import Cloud, RowNumbers
from certreg.io.columns import LABEL, NOISE
from certreg.io.labels import IDENTIFIERS
from certreg.io.npy import points_of_columns, side_by_side
from certreg.io.streams import (
    COUNT,
    MAX_BINARY_BYTES,
    HeaderLine,
    Place,
    count,
    header,
    held_bytes,
    large_file,
    refused,
    rows_of_words,
    typed_numbers,
)
from certreg.verify import shown

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

Bytes = bytes | mmap.mmap
ORDERS = {"ascii": None, "binary_little_endian": "<", "binary_big_endian": ">"}
NAMES = {  # of types, by those of NumPy: as in the first files, and as later writers say
    "i1": ("char", "int8"),
    "u1": ("uchar", "uint8"),
    "i2": ("short", "int16"),
    "u2": ("ushort", "uint16"),
    "i4": ("int", "int32"),
    "u4": ("uint", "uint32"),
    "f4": ("float", "float32"),
    "f8": ("double", "float64"),
}
CODES = {"i1": "b", "u1": "B", "i2": "h", "u2": "H", "i4": "i", "u4": "I", "f4": "f", "f8": "d"}
KEPT = frozenset({*"xyz", *NOISE, LABEL, *IDENTIFIERS})
TYPES = {name: code for code, names in NAMES.items() for name in names}


@dataclass(frozen=True, slots=True)
class Property:
    """A number, or a list of numbers with its length before it; types as NumPy spells them."""

    name: str
    type: str
    count: str | None  # type of a list's length; None: no list
    kept: bool  # whether its values are asked for


@dataclass(frozen=True, slots=True)
class Element:
    """Rows of the same properties."""

    name: str
    count: int
    properties: list[Property]


@dataclass(frozen=True, slots=True)
class Header:
    """What a header declares."""

    order: str | None  # of bytes; None: ascii
    elements: list[Element]


def parse_ply(stream: BinaryIO, file: Path, further: frozenset[str] = frozenset()) -> Cloud:
    """The vertices of a .ply file, their labels and noise, the names of what else is in it.

    further: properties of vertices that are read, too, where there are such.
    """
    top = header(stream, file, "end_header")
    declared = _declared(file, top, KEPT | further)
    vertex = _vertex(file, declared.elements)
    columns: dict[str, NDArray[Any]] = {}
    mapped = None
    if declared.order is None:
        rows = rows_of_words(stream, file, len(top) + 1)
        for element in declared.elements:
            read = _ascii_columns(rows, element, file)
            columns = read if element is vertex else columns
        for place, _ in rows:
            raise place.refusal("more rows than the header declares: mend the header")
    else:
        start = stream.tell()
        mapped = large_file(stream, file)
        data = stream.read(held_bytes(stream, file)) if mapped is None else mapped
        first = offset = 0 if mapped is None else start
        for element in declared.elements:
            read, offset = _binary_columns(data, offset, element, declared.order, file)
            columns = read if element is vertex else columns
        if offset != len(data):
            held, size = len(data) - first, offset - first
            raise refused(
                file,
                f"the header declares {size} bytes of data, the file holds "
                f"{held}: it is corrupt; save it again",
                value=held,
                limit=size,
            )
        too_large = mapped is not None and len(mapped) > MAX_BINARY_BYTES
        if too_large and side_by_side([columns[axis] for axis in "xyz"]) is None:
            raise refused(
                file,
                f"{len(data)} bytes are too many: save x, y, z of one type, double "
                "or float, one behind the other",
                value=len(data),
                limit=MAX_BINARY_BYTES,
            )
    names = {} if mapped is not None else _names(columns)  # a text each is more than the file
    read = {*"xyz", *NOISE, *({LABEL} & names.keys())}
    others = [p.name for p in vertex.properties if p.name not in read or p.count is not None]
    others += [e.name for e in declared.elements if e is not vertex]
    return Cloud(
        path=file,
        points=points_of_columns(file, [columns[axis] for axis in "xyz"]),
        ignored=tuple(others),
        labels=names.get(LABEL),
        identifiers=next((names[name] for name in (LABEL, *IDENTIFIERS) if name in names), None),
        numbers=None if mapped is None else _numbers(columns),
        sigma=columns.get("sigma"),
        weights=columns.get("weight"),
        further={name: column for name, column in columns.items() if name in further},
    )


def _numbers(columns: dict[str, NDArray[Any]]) -> RowNumbers | None:
    """What names the rows of a large file, left where it is."""
    named = [columns[name] for name in (LABEL, *IDENTIFIERS) if name in columns]
    return RowNumbers(column=named[0]) if named else None


def _names(columns: dict[str, NDArray[Any]]) -> dict[str, tuple[str, ...]]:
    """What columns other than numbers call the points; 7.0 is 7."""
    kept = (name for name in (LABEL, *IDENTIFIERS) if name in columns)
    return {
        name: tuple(
            str(int(value)) if float(value).is_integer() else repr(value)
            for value in columns[name].tolist()
        )
        for name in kept
    }


def write_ply(file: Path, pieces: Iterable[NDArray[np.float64]], n: int) -> None:
    """Write n points that come in pieces, binary, doubles, little-endian, whole or not at all."""
    top = ["ply", "format binary_little_endian 1.0", f"element vertex {n}"]
    top += [f"property double {axis}" for axis in "xyz"]
    content = "\n".join([*top, "end_header\n"]).encode()
    doubles = (piece.astype("<f8", copy=False).tobytes() for piece in pieces)
    write_atomically(file, chain([content], doubles))


def _declared(file: Path, top: list[HeaderLine], kept: Container[str]) -> Header:
    if top[0].key != "ply" or len(top) < 2 or top[1].key != "format":
        raise Place(file, 1).refusal(
            "does not begin with 'ply' and 'format': is it a .ply file?", value=top[0].key
        )
    kind, *version = top[1].words or [""]
    if kind not in ORDERS or version != ["1.0"]:
        stated = " ".join(top[1].words)
        words = f"unknown format '{shown(stated)}': use one of "
        words += ", ".join(f"{known} 1.0" for known in ORDERS)
        raise top[1].place.refusal(words, column="format", value=stated)
    elements: list[Element] = []
    for line in top[2:-1]:
        if line.key == "element":
            elements.append(_element(line, elements))
        elif line.key == "property" and elements:
            elements[-1].properties.append(_property(line, elements[-1], kept))
        elif line.key not in {"", "comment", "obj_info"}:
            raise line.place.refusal(
                f"'{shown(line.key)}' is not expected here: mend the header", column=line.key
            )
    return Header(ORDERS[kind], elements)


def _element(line: HeaderLine, others: list[Element]) -> Element:
    if len(line.words) != 2 or line.words[0] in {other.name for other in others}:
        stated = " ".join(line.words)
        raise line.place.refusal(
            "write 'element NAME COUNT', each name once", column=line.key, value=stated
        )
    return Element(line.words[0], count(line.place, line.words[1]), [])


def _property(line: HeaderLine, element: Element, kept: Container[str]) -> Property:
    listed = line.words[:1] == ["list"]
    *types, title = line.words[listed:] or [""]
    kinds = [TYPES.get(word, "") for word in types]
    taken = title in {other.name for other in element.properties}
    whole = kinds[0][:1] in {"i", "u"} if listed and kinds else True
    if len(kinds) != 1 + listed or not all(kinds) or not whole or taken:
        raise line.place.refusal(
            "write 'property TYPE NAME' or 'property list COUNT_TYPE TYPE NAME', "
            "with types such as float or uint8, each name once",
            column=line.key,
            value=" ".join(line.words),
        )
    return Property(title, kinds[-1], kinds[0] if listed else None, not listed and title in kept)


def _vertex(file: Path, elements: list[Element]) -> Element:
    for element in elements:
        if element.count and not element.properties:
            what = f"element '{shown(element.name)}' has no properties"
            raise refused(file, f"{what}: mend the header", column=element.name)
    for element in elements:
        if element.name == "vertex":
            scalars = {p.name for p in element.properties if p.count is None}
            if element.count and scalars >= {"x", "y", "z"}:
                return element
    raise refused(
        file, "declares no vertices with numbers x, y and z: is it a point cloud?", column="vertex"
    )


def _ascii_columns(
    rows: Iterator[tuple[Place, list[str]]], element: Element, file: Path
) -> dict[str, NDArray[Any]]:
    """The columns that are kept, where the element has them, of as many rows as it declares."""
    numbers, plain = array("d"), all(p.count is None for p in element.properties)
    wanted = [(k, p.type, p.name) for k, p in enumerate(element.properties) if p.kept]
    for k in range(element.count):
        place, words = next(rows, (None, list[str]()))
        if place is None:
            raise _truncated(file, element, k)
        row = words if plain else _without_lists(place, words, element)
        if len(row) != len(element.properties):
            what = f"{len(words)} numbers do not fit element '{shown(element.name)}'"
            raise place.refusal(
                f"{what}: mend the row", value=len(words), limit=len(element.properties)
            )
        numbers.extend(typed_numbers(place, row, wanted))
    return _by_name(element, numbers)


def _by_name(element: Element, numbers: array[float]) -> dict[str, NDArray[Any]]:
    """The columns that are kept, of their numbers row by row."""
    names = [p.name for p in element.properties if p.kept]
    columns = np.array(numbers).reshape(element.count, len(names))
    return {name: columns[:, k] for k, name in enumerate(names)}


def _binary_columns(
    data: Bytes, offset: int, element: Element, order: str, file: Path
) -> tuple[dict[str, NDArray[Any]], int]:
    """The columns that are kept, by name, and where the data behind the element's rows begin."""
    if not element.count:
        return {}, offset
    steps = [_step(order, p) for p in element.properties]
    lengths: list[int] = []
    if any(p.count is not None for p in element.properties):
        try:
            _, lengths, _ = _row(data, offset, steps)
        except struct.error as error:
            raise _truncated(file, element, 0) from error
    rows = _uniform(data, offset, element, order, lengths)
    if rows is not None:
        slots = {p.name: str(k) for k, p in enumerate(element.properties) if p.kept}
        return {name: rows[slot] for name, slot in slots.items()}, offset + rows.nbytes
    if not lengths:
        row = _row_type(element, order, lengths).itemsize
        raise _truncated(file, element, (len(data) - offset) // row)
    return _walked(data, offset, element, steps, file)


def _step(order: str, item: Property) -> tuple[struct.Struct, int, bool]:
    """What to unpack of a property, the size of a list's entries or 0, whether it is kept."""
    code = struct.Struct(order + CODES[item.count or item.type])
    return code, 0 if item.count is None else int(item.type[1]), item.kept


def _row(
    data: Bytes, offset: int, steps: list[tuple[struct.Struct, int, bool]]
) -> tuple[list[float], list[int], int]:
    """The kept numbers of a row, the lengths of its lists, its end. Raises struct.error."""
    values: list[float] = []
    lengths: list[int] = []
    for code, entry, kept in steps:
        (value,) = code.unpack_from(data, offset)
        offset += code.size
        if entry:
            if value < 0:
                raise struct.error("a list of negative length")
            lengths.append(value)
            offset += value * entry
        elif kept:
            values.append(value)
    if offset > len(data):
        raise struct.error("a row beyond the data")
    return values, lengths, offset


def _row_type(element: Element, order: str, lengths: list[int]) -> np.dtype[Any]:
    """A row as NumPy sees it, if its lists have the given lengths."""
    fields: list[Any] = []
    left = iter(lengths)
    for k, p in enumerate(element.properties):
        if p.count is None:
            fields.append((str(k), order + p.type))
        else:
            length = next(left)
            fields += [(f"length {k}", order + p.count), (str(k), order + p.type, (length,))]
    return np.dtype(fields)


def _uniform(
    data: Bytes, offset: int, element: Element, order: str, lengths: list[int]
) -> NDArray[Any] | None:
    """All rows at once if every row's lists have these lengths; otherwise None."""
    row = _row_type(element, order, lengths)
    if row.itemsize * element.count > len(data) - offset:
        return None
    rows = np.frombuffer(data, row, element.count, offset)
    listed = [k for k, p in enumerate(element.properties) if p.count is not None]
    for k, length in zip(listed, lengths, strict=True):
        if (rows[f"length {k}"] != length).any():
            return None
    return rows


def _walked(
    data: Bytes,
    offset: int,
    element: Element,
    steps: list[tuple[struct.Struct, int, bool]],
    file: Path,
) -> tuple[dict[str, NDArray[Any]], int]:
    """As `_binary_columns`, row by row: lists may be of any lengths."""
    numbers = array("d")
    for k in range(element.count):
        try:
            values, _, offset = _row(data, offset, steps)
        except struct.error as error:
            raise _truncated(file, element, k) from error
        numbers.extend(values)
    return _by_name(element, numbers), offset


def _without_lists(place: Place, words: list[str], element: Element) -> list[str]:
    """One word for each property of a row: that of a list is its length."""
    kept, at = list[str](), 0
    for item in element.properties:
        if at >= len(words) or (item.count is not None and not COUNT.fullmatch(words[at])):
            raise place.refusal(
                "a list without its length, or too few numbers: mend the row", column=item.name
            )
        kept.append(words[at])
        at += 1 if item.count is None else 1 + int(words[at])
    return kept if at == len(words) else []


def _truncated(file: Path, element: Element, rows: int) -> InvalidFileError:
    what = f"declares {element.count} rows of element '{shown(element.name)}'"
    return InvalidFileError(
        f"{shown(file)}: the header {what}, the data end or break off in row {rows} (counting from "
        "0): it is truncated or corrupt; save it again",
        path=file,
        row=rows,
        column=element.name,
        limit=element.count,
    )
