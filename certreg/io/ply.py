"""Clouds in .ply files: x, y, z of the element `vertex`, whatever else is declared around them.

Every declared row must be there, and nothing behind the last. In ascii files the number that is
written counts, also where its type is `float`: it is read as the nearest double.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING, Any, BinaryIO

from certreg.errors import InvalidFileError
from certreg.io.atomic import write_atomically
from certreg.io.npy import points_of_columns, side_by_side
from certreg.io.ply_rows import Element, Property, ascii_columns, binary_columns
from certreg.io.streams import HeaderLine, count, header, held_bytes, large_file, rows_of_words
from certreg.settings import FileSettings
from certreg.verify import shown

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

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
TYPES = {name: code for code, names in NAMES.items() for name in names}


@dataclass(frozen=True, slots=True)
class Header:
    """What a header declares."""

    order: str | None  # of bytes; None: ascii
    elements: list[Element]


def parse_ply(stream: BinaryIO, file: Path) -> tuple[NDArray[np.float64], tuple[str, ...]]:
    """The vertices of a .ply file, and the names of what else is in it."""
    name = shown(file)
    top = header(stream, name, "end_header")
    declared = _declared(name, top)
    vertex = _vertex(name, declared.elements)
    columns: list[NDArray[Any]] = []
    if declared.order is None:
        rows = rows_of_words(stream, name, len(top) + 1)
        for element in declared.elements:
            found = ascii_columns(rows, element, name)
            columns = found if element is vertex else columns
        for place, _ in rows:
            message = f"{place}: more rows than the header declares: mend the header"
            raise InvalidFileError(message)
    else:
        start = stream.tell()
        mapped = large_file(stream, file)
        data = stream.read(held_bytes(stream, file)) if mapped is None else mapped
        first = offset = 0 if mapped is None else start
        for element in declared.elements:
            found, offset = binary_columns(data, offset, element, declared.order, name)
            columns = found if element is vertex else columns
        if offset != len(data):
            message = (
                f"{name}: the header declares {offset - first} bytes of data, the file holds "
                f"{len(data) - first}: it is corrupt; save it again"
            )
            raise InvalidFileError(message)
        too_large = mapped is not None and len(mapped) > FileSettings().max_binary_bytes
        if too_large and side_by_side(columns) is None:
            message = (
                f"{name}: {len(data)} bytes are too many: save x, y, z of one type, double or "
                "float, one behind the other"
            )
            raise InvalidFileError(message)
    others = [p.name for p in vertex.properties if p.name not in {"x", "y", "z"}]
    others += [e.name for e in declared.elements if e is not vertex]
    return points_of_columns(file, columns), tuple(others)


def write_ply(file: Path, pieces: Iterable[NDArray[np.float64]], n: int) -> None:
    """Write n points that come in pieces, binary, doubles, little-endian, whole or not at all."""
    top = ["ply", "format binary_little_endian 1.0", f"element vertex {n}"]
    top += [f"property double {axis}" for axis in "xyz"]
    content = "\n".join([*top, "end_header\n"]).encode()
    doubles = (piece.astype("<f8", copy=False).tobytes() for piece in pieces)
    write_atomically(file, chain([content], doubles))


def _declared(name: str, top: list[HeaderLine]) -> Header:
    if top[0].key != "ply" or len(top) < 2 or top[1].key != "format":
        message = f"{name}, line 1: does not begin with 'ply' and 'format': is it a .ply file?"
        raise InvalidFileError(message)
    kind, *version = top[1].words or [""]
    if kind not in ORDERS or version != ["1.0"]:
        message = f"{top[1].place}: unknown format '{shown(' '.join(top[1].words))}': use one of "
        raise InvalidFileError(message + ", ".join(f"{known} 1.0" for known in ORDERS))
    elements: list[Element] = []
    for line in top[2:-1]:
        if line.key == "element":
            elements.append(_element(line, elements))
        elif line.key == "property" and elements:
            elements[-1].properties.append(_property(line, elements[-1]))
        elif line.key not in {"", "comment", "obj_info"}:
            message = f"{line.place}: '{shown(line.key)}' is not expected here: mend the header"
            raise InvalidFileError(message)
    return Header(ORDERS[kind], elements)


def _element(line: HeaderLine, others: list[Element]) -> Element:
    if len(line.words) != 2 or line.words[0] in {other.name for other in others}:
        message = f"{line.place}: write 'element NAME COUNT', each name once"
        raise InvalidFileError(message)
    return Element(line.words[0], count(line.place, line.words[1]), [])


def _property(line: HeaderLine, element: Element) -> Property:
    listed = line.words[:1] == ["list"]
    *types, title = line.words[listed:] or [""]
    kinds = [TYPES.get(word, "") for word in types]
    taken = title in {other.name for other in element.properties}
    whole = kinds[0][:1] in {"i", "u"} if listed and kinds else True
    if len(kinds) != 1 + listed or not all(kinds) or not whole or taken:
        message = (
            f"{line.place}: write 'property TYPE NAME' or 'property list COUNT_TYPE TYPE NAME', "
            "with types such as float or uint8, each name once"
        )
        raise InvalidFileError(message)
    return Property(title, kinds[-1], kinds[0] if listed else None)


def _vertex(name: str, elements: list[Element]) -> Element:
    for element in elements:
        if element.count and not element.properties:
            message = f"{name}: element '{shown(element.name)}' has no properties: mend the header"
            raise InvalidFileError(message)
    for element in elements:
        if element.name == "vertex":
            scalars = {p.name for p in element.properties if p.count is None}
            if element.count and scalars >= {"x", "y", "z"}:
                return element
    message = f"{name}: declares no vertices with numbers x, y and z: is it a point cloud?"
    raise InvalidFileError(message)
