"""The standard streams of a command, so that its exit code is that of its work.

A reader of the output that leaves (`| head`) is no fault: the work goes on to its end. Output that
cannot be written is one: the command ends with one line. Notes on stderr that nobody can read are
left out.
"""

from __future__ import annotations

import errno
import io
import os
import sys
from typing import TYPE_CHECKING, TextIO

from certreg.errors import CertregError

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer

# A pipe whose reader has left; Windows calls it an invalid argument.
LEFT = {errno.EPIPE, errno.EINVAL} if os.name == "nt" else {errno.EPIPE}
STDERR = 2  # its descriptor


class UnwritableOutputError(CertregError):
    """Standard output is closed, or its device is full."""

    def __init__(self, reason: str | None) -> None:
        super().__init__(f"the output cannot be written ({reason})")


class _Stream(io.FileIO):
    """A descriptor to write to, up to its first fault: what comes later is dropped.

    So nothing is left in memory that Python would try to write at its end, with code 120.
    """

    _lost = False

    def write(self, content: ReadableBuffer, /) -> int | None:
        """Bytes written or dropped. Raises UnwritableOutputError, once, on stdout."""
        size = memoryview(content).nbytes
        if self._lost:
            return size
        try:
            written = super().write(content)
        except OSError as error:
            self._lost = True
            if self.fileno() != STDERR and error.errno not in LEFT:
                raise UnwritableOutputError(error.strerror) from error
            return size
        return size if written is None and self.fileno() == STDERR else written


def shelter_streams() -> None:
    """Put such streams in place of those that Python opened; what others put there stays.

    Raises UnwritableOutputError where stdout is closed.
    """
    while (handle := os.open(os.devnull, os.O_RDWR)) <= STDERR:
        pass  # in place of one that is closed: else a file that is opened later would get its place
    os.close(handle)
    if sys.stdin is None:
        sys.stdin = open(os.devnull, encoding="utf-8")  # noqa: SIM115, PTH123 - to the end
    if sys.stderr is sys.__stderr__:
        sys.stderr = _sheltered(sys.stderr, STDERR)
    if sys.stdout is None:
        raise UnwritableOutputError("standard output is closed")
    if sys.stdout is sys.__stdout__:
        sys.stdout = _sheltered(sys.stdout, 1)
    reconfigure = getattr(sys.stdout, "reconfigure", None)
    if reconfigure is not None:  # not of a stream that a notebook or a test put there
        reconfigure(errors="backslashreplace")  # as Python does on stderr: consoles lack letters


def _sheltered(stream: TextIO | None, number: int) -> TextIO:
    """The same stream, sheltered; consoles of Windows, which take text, as they are."""
    if stream is not None and os.name == "nt" and stream.isatty():
        return stream
    return io.TextIOWrapper(
        io.BufferedWriter(_Stream(number, "wb", closefd=False)),
        encoding="utf-8" if stream is None else stream.encoding,
        errors="backslashreplace",
        line_buffering=True,  # so nothing is left to be written after the command
    )
