"""Files of clouds built by hand, from what their formats say; no reader or writer of certreg."""

from __future__ import annotations

import io
import struct
import zipfile
from typing import Any

import numpy as np

Row = list[Any]  # a number for a scalar, a list of numbers for a list

PLY_TYPES = (
    "char int8 b, uchar uint8 B, short int16 h, ushort uint16 H, int int32 i, uint uint32 I, "
    "float float32 f, double float64 d"
)
PLY_CODES = {
    name: names.split()[-1] for names in PLY_TYPES.split(", ") for name in names.split()[:2]
}
PCD_TYPES = "I1b U1B I2h U2H I4i U4I I8q U8Q F4f F8d"
PCD_CODES = {(letter, int(size)): code for letter, size, code in PCD_TYPES.split()}
Element = tuple[str, list[tuple[str, ...]], list[Row]]  # name, properties (types and name), rows


def ply(elements: list[Element], kind: str = "binary_little_endian", newline: str = "\n") -> bytes:
    """A .ply file of any elements; a property is (type, name) or (count type, type, name)."""
    head = ["ply", f"format {kind} 1.0", "comment by hand"]
    body = b""
    for name, properties, rows in elements:
        head.append(f"element {name} {len(rows)}")
        for *types, title in properties:
            listed = "list " if len(types) == 2 else ""
            head.append(f"property {listed}{' '.join(types)} {title}")
        for row in rows:
            body += _ply_row(properties, row, kind, newline)
    return newline.join([*head, "end_header", ""]).encode() + body


def _ply_row(properties: list[tuple[str, ...]], row: Row, kind: str, newline: str) -> bytes:
    if kind == "ascii":
        words = [
            f"{len(v)} {' '.join(map(repr, v))}".strip() if isinstance(v, list) else repr(v)
            for v in row
        ]
        return (" ".join(words) + newline).encode()
    order = "<" if kind == "binary_little_endian" else ">"
    out = b""
    for (*types, _), value in zip(properties, row, strict=True):
        if len(types) == 2:
            out += struct.pack(order + PLY_CODES[types[0]], len(value))
            out += struct.pack(order + PLY_CODES[types[1]] * len(value), *value)
        else:
            out += struct.pack(order + PLY_CODES[types[0]], value)
    return out


def xyz_ply(points: list[Row], kind: str = "binary_little_endian", type_: str = "double") -> bytes:
    """A .ply file of vertices alone."""
    return ply([("vertex", [(type_, axis) for axis in "xyz"], points)], kind)


Field = tuple[str, str, int, int]  # name, type letter, size, count


def pcd(
    fields: list[Field], rows: list[Row], data: str = "binary", *, height: int = 1, **changed: str
) -> bytes:
    """A .pcd file; a row holds all numbers of all fields; `changed` replaces entries."""
    entries = {
        "VERSION": "0.7",
        "FIELDS": " ".join(f[0] for f in fields),
        "SIZE": " ".join(str(f[2]) for f in fields),
        "TYPE": " ".join(f[1] for f in fields),
        "COUNT": " ".join(str(f[3]) for f in fields),
        "WIDTH": str(len(rows) // height),
        "HEIGHT": str(height),
        "VIEWPOINT": "0 0 0 1 0 0 0",
        "POINTS": str(len(rows)),
        "DATA": data,
        **changed,
    }
    head = "".join(f"{key} {value}\n" for key, value in entries.items() if value)
    return b"# .PCD v0.7 - by hand\n" + head.encode() + pcd_body(fields, rows, data)


def pcd_body(fields: list[Field], rows: list[Row], data: str) -> bytes:
    if data == "ascii":
        return "".join(" ".join(map(repr, row)) + "\n" for row in rows).encode()
    codes = [PCD_CODES[letter, size] * count for _, letter, size, count in fields]
    if data == "binary":
        return b"".join(struct.pack("<" + "".join(codes), *row) for row in rows)
    raw, start = b"", 0
    for code in codes:
        raw += b"".join(struct.pack("<" + code, *row[start : start + len(code)]) for row in rows)
        start += len(code)
    packed = lzf(raw)
    return struct.pack("<2I", len(packed), len(raw)) + packed


def lzf(raw: bytes) -> bytes:
    """LZF, greedily and slowly: the longest copy of at least 3 bytes, else a new byte."""
    out, new, at = b"", b"", 0
    while at < len(raw):
        length, distance = longest_copy(raw, at)
        if length >= 3:
            out, new = out + literal(new), b""
            size = length - 2
            far = (distance - 1) >> 8
            first = bytes([size << 5 | far]) if size < 7 else bytes([7 << 5 | far, size - 7])
            out += first + bytes([(distance - 1) & 255])
            at += length
        else:
            new, at = new + raw[at : at + 1], at + 1
    return out + literal(new)


def literal(new: bytes) -> bytes:
    parts = (new[k : k + 32] for k in range(0, len(new), 32))
    return b"".join(bytes([len(part) - 1]) + part for part in parts)


def longest_copy(raw: bytes, at: int) -> tuple[int, int]:
    """Length, at most 264, and distance, at most 8192; a copy may run into itself."""
    best = (0, 0)
    for start in range(max(0, at - 8192), at):
        length = 0
        while at + length < len(raw) and length < 264 and raw[start + length] == raw[at + length]:
            length += 1
        best = max(best, (length, at - start))
    return best


def npy(array: Any, **options: Any) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, np.asarray(array), **options)
    return buffer.getvalue()


def archive(members: dict[str, bytes], method: int = zipfile.ZIP_STORED) -> bytes:
    """A zip archive of any members."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", method) as file:
        for name, content in members.items():
            file.writestr(zipfile.ZipInfo(name), content, method)
    return buffer.getvalue()


def npz(arrays: dict[str, Any], method: int = zipfile.ZIP_STORED) -> bytes:
    return archive({f"{name}.npy": npy(array) for name, array in arrays.items()}, method)
