"""The layout of records of doubles that C and Python share: written once, for both.

A record is a row of doubles whose parts have names: numbers, arrays, or other records. C gets
offsets (layout.h), Python what it makes NumPy's structured types of (layout.json).
A module of its own: it is about data, `emit` about functions.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import prod
from typing import Any

PREFIX = "CERTREG"

_HEADER = """\
/* Where the parts of a record stand, in doubles from its beginning, and how many a record has:
 * generated, do not edit. Arrays stand row by row, of symmetric matrices the upper triangle. */
#ifndef {guard}
#define {guard}
"""
_FOOTER = """
#endif
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordLayout:
    """A row of doubles; `parts` are shapes, or records, by name and in order."""

    name: str
    parts: Mapping[str, tuple[int, ...] | RecordLayout]

    @property
    def size(self) -> int:
        """How many doubles it has."""
        return sum(map(_size, self.parts.values()))

    @property
    def offsets(self) -> dict[str, int]:
        """Where each part begins, in doubles."""
        offsets: dict[str, int] = {}
        place = 0
        for name, part in self.parts.items():
            offsets[name] = place
            place += _size(part)
        return offsets


def record_of(name: str, entries: Mapping[str, Any]) -> RecordLayout:
    """The record of matrices, columns, sequences and numbers, by name."""
    return RecordLayout(name=name, parts={part: _shape(value) for part, value in entries.items()})


def layout_files(records: Sequence[RecordLayout], name: str = "layout") -> dict[str, bytes]:
    """The contents of the header and of the .json; a record stands after those it holds."""
    return {
        f"{name}.h": _layout_header(records, f"{PREFIX}_{name.upper()}_H").encode(),
        f"{name}.json": _layout(records).encode(),
    }


def _layout_header(records: Sequence[RecordLayout], guard: str) -> str:
    return _HEADER.replace("{guard}", guard) + "".join(map(_offsets, records)) + _FOOTER


def _offsets(record: RecordLayout) -> str:
    own = f"{PREFIX}_{record.name.upper()}"
    lines = [f"    {own}_{part.upper()} = {at}," for part, at in record.offsets.items()]
    return "\n".join(["", "enum {", *lines, f"    {own} = {record.size}", "};", ""])


def _layout(records: Sequence[RecordLayout]) -> str:
    document = {
        record.name: {
            name: part.name if isinstance(part, RecordLayout) else list(part)
            for name, part in record.parts.items()
        }
        for record in records
    }
    return json.dumps(document, indent=1) + "\n"


def _shape(value: Any) -> tuple[int, ...]:
    """Of a column (k,), of another matrix its own, of a sequence (k,), of a number ()."""
    if hasattr(value, "shape"):
        rows, columns = value.shape
        return (rows,) if columns == 1 else (rows, columns)
    return (len(value),) if hasattr(value, "__len__") else ()


def _size(part: tuple[int, ...] | RecordLayout) -> int:
    return part.size if isinstance(part, RecordLayout) else prod(part)
