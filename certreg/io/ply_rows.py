"""The rows of an element of a .ply file: columns x, y, z are kept, the rest is stepped over."""

from __future__ import annotations

import mmap
import struct
from array import array
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.errors import InvalidFileError
from certreg.io.streams import COUNT, number
from certreg.problem import let_go
from certreg.verify import shown

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

Bytes = bytes | mmap.mmap
CODES = {"i1": "b", "u1": "B", "i2": "h", "u2": "H", "i4": "i", "u4": "I", "f4": "f", "f8": "d"}


@dataclass(frozen=True, slots=True)
class Property:
    """A number, or a list of numbers with its length before it; types as NumPy spells them."""

    name: str
    type: str
    count: str | None  # type of a list's length; None: no list

    @property
    def kept(self) -> bool:
        """Whether its values are asked for."""
        return self.count is None and self.name in {"x", "y", "z"}


@dataclass(frozen=True, slots=True)
class Element:
    """Rows of the same properties."""

    name: str
    count: int
    properties: list[Property]


def ascii_columns(
    rows: Iterator[tuple[str, list[str]]], element: Element, name: str
) -> list[NDArray[Any]]:
    """Columns x, y, z, where the element has them, of as many rows as it declares."""
    columns = {p.name: array("d") for p in element.properties if p.kept}
    plain = all(p.count is None for p in element.properties)
    slots = [(k, p.type, columns[p.name]) for k, p in enumerate(element.properties) if p.kept]
    for k in range(element.count):
        place, words = next(rows, ("", list[str]()))
        if not place:
            raise _truncated(name, element, k)
        numbers = words if plain else _without_lists(place, words, element)
        if len(numbers) != len(element.properties):
            message = f"{place}: {len(words)} numbers do not fit element '{shown(element.name)}'"
            raise InvalidFileError(f"{message}: mend the row")
        for slot, kind, column in slots:
            column.append(typed_number(place, numbers[slot], kind))
    return [np.array(columns[axis]) for axis in "xyz" if axis in columns]


def typed_number(place: str, text: str, kind: str) -> float:
    """A plain number, whole, within its type and held by a double where the type is an integer's.

    >>> typed_number("line 7", "-1", "i1")
    -1.0
    """
    value = number(place, text)
    if kind[0] in "iu":
        info = np.iinfo(kind)
        whole = text.lstrip("+-").isdigit() and len(text) <= 20  # those of -2^63
        if not whole or not info.min <= int(text) <= info.max or int(text) != value:
            message = f"{place}: '{shown(text)}' is not of the integer type declared: mend it"
            raise InvalidFileError(message)
    return value


def binary_columns(
    data: Bytes, offset: int, element: Element, order: str, name: str
) -> tuple[list[NDArray[Any]], int]:
    """Columns x, y, z, where the element has them, and where the data behind its rows begin."""
    if not element.count:
        return [], offset
    steps = [_step(order, p) for p in element.properties]
    lengths: list[int] = []
    if any(p.count is not None for p in element.properties):
        try:
            _, lengths, _ = _row(data, offset, steps)
        except struct.error as error:
            raise _truncated(name, element, 0) from error
    rows = _uniform(data, offset, element, order, lengths)
    if rows is not None:
        slots = {p.name: str(k) for k, p in enumerate(element.properties) if p.kept}
        return [rows[slots[axis]] for axis in "xyz" if axis in slots], offset + rows.nbytes
    if not lengths:
        row = _row_type(element, order, lengths).itemsize
        raise _truncated(name, element, (len(data) - offset) // row)
    return _walked(data, offset, element, steps, name)


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
                message = "a list of negative length"
                raise struct.error(message)
            lengths.append(value)
            offset += value * entry
        elif kept:
            values.append(value)
    if offset > len(data):
        message = "a row beyond the data"
        raise struct.error(message)
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
    if listed:
        let_go(rows)
    return rows


def _walked(
    data: Bytes,
    offset: int,
    element: Element,
    steps: list[tuple[struct.Struct, int, bool]],
    name: str,
) -> tuple[list[NDArray[Any]], int]:
    """As `binary_columns`, row by row: lists may be of any lengths."""
    found = array("d")
    for k in range(element.count):
        try:
            values, _, offset = _row(data, offset, steps)
        except struct.error as error:
            raise _truncated(name, element, k) from error
        found.extend(values)
    names = [p.name for p in element.properties if p.kept]
    columns = np.array(found).reshape(element.count, len(names))
    return [columns[:, names.index(axis)] for axis in "xyz" if axis in names], offset


def _without_lists(place: str, words: list[str], element: Element) -> list[str]:
    """One word for each property of a row: that of a list is its length."""
    kept, at = list[str](), 0
    for item in element.properties:
        if at >= len(words) or (item.count is not None and not COUNT.fullmatch(words[at])):
            message = f"{place}: a list without its length, or too few numbers: mend the row"
            raise InvalidFileError(message)
        kept.append(words[at])
        at += 1 if item.count is None else 1 + int(words[at])
    return kept if at == len(words) else []


def _truncated(name: str, element: Element, rows: int) -> InvalidFileError:
    what = f"declares {element.count} rows of element '{shown(element.name)}'"
    return InvalidFileError(
        f"{name}: the header {what}, the data end or break off in row {rows} (counting from 0): "
        "it is truncated or corrupt; save it again"
    )
