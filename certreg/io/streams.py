"""What every reader stands on: files opened and measured, bounded lines, headers, plain numbers.

The standard library alone. A reader takes a stream of bytes and the name to use in an error; what
it refuses is an InvalidFileError of one line: file, place, remedy.
"""

from __future__ import annotations

import errno
import io
import mmap
import os
import re
import sys
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from functools import partial
from math import inf, isfinite
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

from certreg.errors import InvalidFileError
from certreg.io.atomic import remedy_of
from certreg.verify import PIPES, shown

NUMBER = re.compile(r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]+)?")
MISSING = {"", "nan", "na", "n/a", "#n/a", "null", "none", "inf", "infinity"}
NO_NUMBER = "is not a number: remove the row, from both clouds, or write a plain decimal number"
COUNT = re.compile(r"[0-9]{1,18}")  # 10^18 < 2^63: any count that a file can keep
MAX_TEXT_BYTES = 1 << 30  # ten million points
MAX_LINE_BYTES = 1 << 16  # a row of a cloud with many extra columns
MAX_HEADER_BYTES = 1 << 16  # of .ply and .pcd, directory of .npz: a hundred lines suffice
MAX_BINARY_BYTES = 1 << 32  # a hundred million points in doubles, with some colour
MAX_UNPACKED_BYTES = 1 << 30  # forty million points: a megabyte can unpack to a gigabyte
MAPPED_BYTES = 1 << 26  # from here on floats of .npy and binary .ply stay in their file
MAX_MAPPED_BYTES = 1 << 44  # of such a file: nothing but its own pages is ever in memory


class Place(NamedTuple):
    """Where something stands in a file: the line, from 1, and what that calls it, if it does.

    Its text begins every message about it. Without a line it is about the whole file.
    """

    file: Path
    line: int | None = None
    column: str | None = None

    def __str__(self) -> str:
        line = "" if self.line is None else f", line {self.line}"
        column = "" if self.column is None else f", {self.column}"
        return f"{shown(self.file)}{line}{column}"

    def at(self, column: str) -> Place:
        """The same line, what `column` calls."""
        return self._replace(column=column)

    def refusal(self, words: str, **evidence: Any) -> InvalidFileError:
        """The error that says what is wrong here; evidence: row, column, value, limit."""
        evidence = {"column": self.column, **evidence}
        return InvalidFileError(f"{self}: {words}", path=self.file, line=self.line, **evidence)


def refused(file: Path, words: str, **evidence: Any) -> InvalidFileError:
    """The error that says what is wrong with a file; evidence: row, column, value, limit."""
    return Place(file).refusal(words, **evidence)


class HeaderLine(NamedTuple):
    """A line of a header: where it stands, its first word, the words behind."""

    place: Place
    key: str
    words: list[str]


def require_ending(path: str | os.PathLike[str]) -> None:
    """Raise OSError for a named pipe or a device, which may never end; the shell's pipes do."""
    place = Path(path)
    if place.exists() and not (place.is_file() or place.is_dir() or str(path).startswith(PIPES)):
        raise OSError(errno.EINVAL, "a named pipe or a device")


@contextmanager
def reading(path: str | os.PathLike[str]) -> Generator[BinaryIO]:
    """The file, open; whatever the system refuses is an InvalidFileError."""
    try:
        if "\0" in str(path):
            raise FileNotFoundError(errno.ENOENT, "no file has a zero byte in its name")
        require_ending(path)
        with Path(path).open("rb") as stream:
            yield stream
    except OSError as error:
        what = f"cannot be read ({error.strerror or error})"
        raise InvalidFileError(
            f"{shown(path)}: {what}: {remedy_of(error, 'give a readable file')}", path=Path(path)
        ) from error


def large_file(stream: BinaryIO, file: Path) -> mmap.mmap | None:
    """The whole of a large file, mapped for reading; None for what is to be read.

    Whoever shortens the file meanwhile ends this process: replace files, do not overwrite them.
    """
    start = stream.tell()
    size = stream.seek(0, 2)
    stream.seek(start)
    if size < MAPPED_BYTES:
        return None
    _require_size(file, size, MAX_MAPPED_BYTES)
    try:
        return mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ)
    except (OSError, ValueError):  # a stream without a file, a system without maps
        return None


def held_bytes(stream: BinaryIO, file: Path) -> int:
    """How much the stream holds from where it stands, where it is left."""
    start = stream.tell()
    held = stream.seek(0, 2) - start
    stream.seek(start)
    _require_size(file, held, MAX_BINARY_BYTES)
    return held


def _require_size(file: Path, size: int, limit: int) -> None:
    if size > limit:
        raise refused(file, f"{size} bytes are too many: is it a cloud?", value=size, limit=limit)


def require_held(file: Path, declared: int, held: int) -> None:
    """That a file holds as many bytes of data as its header declares."""
    if declared != held:
        raise refused(
            file,
            f"the header declares {declared} bytes of data, the file holds {held}: "
            "it is truncated or corrupt; save it again",
            value=held,
            limit=declared,
        )


def lines(stream: BinaryIO, file: Path, first: int = 1) -> Iterator[str]:
    """The lines of UTF-8 text, each and all of bounded length; the first is line `first`."""
    size = 0
    for number, raw in enumerate(iter(partial(stream.readline, MAX_LINE_BYTES), b""), first):
        size += len(raw)
        if len(raw) == MAX_LINE_BYTES or size > MAX_TEXT_BYTES:
            raise Place(file, number).refusal(
                "the line or the file is too long: is it a cloud?",
                value=max(len(raw), size),
                limit=MAX_LINE_BYTES if len(raw) == MAX_LINE_BYTES else MAX_TEXT_BYTES,
            )
        try:
            text = raw.decode("utf-8-sig" if number == 1 else "utf-8")
        except UnicodeDecodeError as error:
            raise Place(file, number).refusal(f"{shown(error)}: save the file as UTF-8") from error
        yield text


def rows_of_words(stream: BinaryIO, file: Path, first: int) -> Iterator[tuple[Place, list[str]]]:
    """Place and words of each line that is not blank, from the line with the number `first` on."""
    for number, line in enumerate(lines(stream, file, first), first):
        words = line.split()
        if words:
            yield Place(file, number), words


def header(stream: BinaryIO, file: Path, last: str) -> list[HeaderLine]:
    """All lines of a header, of bounded length, to the one with the key `last`."""
    left, top = MAX_HEADER_BYTES, list[HeaderLine]()
    for number in range(1, MAX_HEADER_BYTES):
        raw = stream.readline(left)
        left -= len(raw)
        if not raw.endswith(b"\n"):
            break
        key, *words = raw.decode("latin1").split() or [""]
        top.append(HeaderLine(Place(file, number), key, words))
        if key == last:
            return top
    raise refused(
        file,
        f"the header has no line '{last}', or is too long: is it truncated?",
        column=last,
        limit=MAX_HEADER_BYTES,
    )


def number(place: Place, text: str) -> float:
    """The double nearest to a plain decimal number."""
    match = NUMBER.fullmatch(text.strip(" \t"))
    value = float(text) if match else inf
    if not isfinite(value):
        what = f"'{shown(text)}' is not a {'finite ' if match else ''}number"
        raise place.refusal(f"{what}: write plain decimal numbers", value=text)
    return value


def in_column(error: InvalidFileError, place: Place, column: str) -> InvalidFileError:
    """The refusal of a number of a point, with its column; of one that is missing, the remedy."""
    words = str(error).removeprefix(f"{place}: ")
    if is_missing(str(error.value)):
        words = f"'{shown(error.value)}' {NO_NUMBER}"
    return place.at(shown(column)).refusal(words, value=error.value, limit=error.limit)


def is_missing(text: str) -> bool:
    """Whether a field is what programs write where they have no number."""
    return text.strip().lstrip("+-").lower() in MISSING


def count(place: Place, text: str) -> int:
    """A count written in plain digits."""
    if not COUNT.fullmatch(text):
        what = f"'{shown(text)}' is not a count"
        raise place.refusal(f"{what}: write a whole number >= 0", value=text)
    return int(text)


def typed_number(place: Place, text: str, kind: str) -> float:
    """A plain number; of an integer type it is whole, within the type and held by a double.

    kind: as NumPy spells it.

    >>> typed_number(Place(Path("a.ply"), 7), "-1", "i1")
    -1.0
    """
    value = number(place, text)
    if kind[0] in "iu":
        bits, signed = 8 * int(kind[1:]), kind[0] == "i"
        least, most = (-1 << bits - 1, (1 << bits - 1) - 1) if signed else (0, (1 << bits) - 1)
        whole = text.lstrip("+-").isdigit() and len(text) <= 20  # those of -2^63
        if not whole or not least <= int(text) <= most or int(text) != value:
            raise place.refusal(
                f"'{shown(text)}' is not of the integer type declared: mend it",
                value=text,
                limit=kind,
            )
    return value


def typed_numbers(
    place: Place, words: list[str], wanted: list[tuple[int, str, str]]
) -> Iterator[float]:
    """The numbers of a row that are wanted; of each the number of its word, its type, its name."""
    for slot, kind, name in wanted:
        try:
            yield typed_number(place, words[slot], kind)
        except InvalidFileError as error:
            raise in_column(error, place, name) from error


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
        raise InvalidFileError(
            f"standard input: more than {MAX_TEXT_BYTES} bytes: give a file",
            path=Path(DASH),
            limit=MAX_TEXT_BYTES,
        )
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
