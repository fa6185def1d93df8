"""A cloud from standard input, `-`: what it is, is told from how it begins."""

from __future__ import annotations

import io
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from certreg.errors import InvalidFileError
from certreg.io.streams import COUNT, MAX_TEXT_BYTES

if TYPE_CHECKING:
    from typing import BinaryIO

DASH = "-"
NAME = "stdin"  # with the format behind it, in errors and notes
BEGINNINGS = (
    (re.compile(rb"\x93NUMPY"), ".npy"),
    (re.compile(rb"PK\x03\x04"), ".npz"),
    (re.compile(rb"ply\r?\n"), ".ply"),
    (re.compile(rb"# \.PCD|VERSION "), ".pcd"),
    (re.compile(rb"LASF"), ".las"),
    (re.compile(rb"data_"), ".cif"),
    (re.compile(rb"solid[ \r\n]"), ".stl"),
    (re.compile(rb"(HEADER|NUMMDL|ATOM  |HETATM|REMARK|MODEL |CRYST1|TITLE )"), ".pdb"),
    (re.compile(rb"(#[^\n]*\n|\s)*(v|vn|vt|o|g|mtllib) "), ".obj"),
)
COMMENT = re.compile(r"\s*(#|//|$)")
LOOKED_AT = 1 << 16


def is_standard_input(path: object) -> bool:
    """Whether a path means standard input; a file of that name is `./-`."""
    return str(path) == DASH


def standard_input() -> tuple[BinaryIO, Path]:
    """What stands on standard input, of bounded length, and a name that tells its format."""
    content = sys.stdin.buffer.read(MAX_TEXT_BYTES + 1)
    if len(content) > MAX_TEXT_BYTES:
        message = f"standard input: more than {MAX_TEXT_BYTES} bytes: give a file"
        raise InvalidFileError(message, path=Path(DASH), limit=MAX_TEXT_BYTES)
    return io.BytesIO(content), Path(NAME + format_of(content[:LOOKED_AT]))


def format_of(beginning: bytes) -> str:
    """The format of what begins so; text that is nothing else is a table.

    >>> format_of(b"x,y,z"), format_of(b"1 2 3"), format_of(b"12"), format_of(b"ATOM  ")
    ('.csv', '.txt', '.xyz', '.pdb')
    """
    for pattern, suffix in BEGINNINGS:
        if pattern.match(beginning):
            return suffix
    lines = beginning.decode("utf-8", errors="replace").splitlines() or [""]
    if COUNT.fullmatch(lines[0].strip()):
        return ".xyz"
    first = next((line for line in lines if not COMMENT.match(line)), "")
    return ".csv" if "," in first or ";" in first else ".txt"
