"""What every reader stands on: files opened and measured, bounded lines, headers, plain numbers.

The standard library alone. A reader takes a stream of bytes and the name to use in an error; what
it refuses is an InvalidFileError of one line: file, place, remedy.
"""

from __future__ import annotations

import errno
import mmap
import re
from contextlib import contextmanager
from functools import partial
from math import inf, isfinite
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from certreg.errors import InvalidFileError
from certreg.settings import FileSettings
from certreg.verify import shown

if TYPE_CHECKING:
    import os
    from collections.abc import Generator, Iterator
    from typing import BinaryIO

NUMBER = re.compile(r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]+)?")
COUNT = re.compile(r"[0-9]{1,18}")  # 10^18 < 2^63: any count that a file can keep


class HeaderLine(NamedTuple):
    """A line of a header: where it stands, its first word, the words behind."""

    place: str
    key: str
    words: list[str]


@contextmanager
def reading(path: str | os.PathLike[str]) -> Generator[BinaryIO]:
    """The file, open; whatever the system refuses is an InvalidFileError."""
    try:
        if "\0" in str(path):
            raise FileNotFoundError(errno.ENOENT, "no file has a zero byte in its name")
        with Path(path).open("rb") as stream:
            yield stream
    except OSError as error:
        what = f"cannot be read ({error.strerror or error})"
        message = f"{shown(path)}: {what}: give a readable file"
        raise InvalidFileError(message) from error


def large_file(stream: BinaryIO, file: Path) -> mmap.mmap | None:
    """The whole of a large file, mapped for reading; None for what is to be read.

    Whoever shortens the file meanwhile ends this process: replace files, do not overwrite them.
    """
    settings, start = FileSettings(), stream.tell()
    size = stream.seek(0, 2)
    stream.seek(start)
    if size < settings.mapped_bytes:
        return None
    if size > settings.max_mapped_bytes:
        message = f"{shown(file)}: {size} bytes are too many: is it a cloud?"
        raise InvalidFileError(message)
    try:
        return mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ)
    except (OSError, ValueError):  # a stream without a file, a system without maps
        return None


def held_bytes(stream: BinaryIO, file: Path) -> int:
    """How much the stream holds from where it stands, where it is left."""
    start = stream.tell()
    held = stream.seek(0, 2) - start
    stream.seek(start)
    if held > FileSettings().max_binary_bytes:
        message = f"{shown(file)}: {held} bytes are too many: is it a cloud?"
        raise InvalidFileError(message)
    return held


def lines(stream: BinaryIO, name: str, first: int = 1) -> Iterator[str]:
    """The lines of UTF-8 text, each and all of bounded length; the first is line `first`."""
    settings, size = FileSettings(), 0
    for number, raw in enumerate(
        iter(partial(stream.readline, settings.max_line_bytes), b""), first
    ):
        size += len(raw)
        if len(raw) == settings.max_line_bytes or size > settings.max_text_bytes:
            message = f"{name}, line {number}: the line or the file is too long: is it a cloud?"
            raise InvalidFileError(message)
        try:
            text = raw.decode("utf-8-sig" if number == 1 else "utf-8")
        except UnicodeDecodeError as error:
            message = f"{name}, line {number}: {shown(error)}: save the file as UTF-8"
            raise InvalidFileError(message) from error
        yield text


def rows_of_words(stream: BinaryIO, name: str, first: int) -> Iterator[tuple[str, list[str]]]:
    """Place and words of each line that is not blank, from the line with the number `first` on."""
    for number, line in enumerate(lines(stream, name, first), first):
        words = line.split()
        if words:
            yield f"{name}, line {number}", words


def header(stream: BinaryIO, name: str, last: str) -> list[HeaderLine]:
    """All lines of a header, of bounded length, to the one with the key `last`."""
    limit, found = FileSettings().max_header_bytes, list[HeaderLine]()
    for number in range(1, limit):
        raw = stream.readline(limit)
        limit -= len(raw)
        if not raw.endswith(b"\n"):
            break
        key, *words = raw.decode("latin1").split() or [""]
        found.append(HeaderLine(f"{name}, line {number}", key, words))
        if key == last:
            return found
    message = f"{name}: the header has no line '{last}', or is too long: is it truncated?"
    raise InvalidFileError(message)


def number(place: str, text: str) -> float:
    """The double nearest to a plain decimal number."""
    match = NUMBER.fullmatch(text.strip(" \t"))
    value = float(text) if match else inf
    if not isfinite(value):
        what = f"'{shown(text)}' is not a {'finite ' if match else ''}number"
        message = f"{place}: {what}: write plain decimal numbers"
        raise InvalidFileError(message)
    return value


def count(place: str, text: str) -> int:
    """A count written in plain digits."""
    if not COUNT.fullmatch(text):
        message = f"{place}: '{shown(text)}' is not a count: write a whole number >= 0"
        raise InvalidFileError(message)
    return int(text)
