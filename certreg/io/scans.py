"""Scans in .las, .laz (laspy) and .e57 (pye57): libraries of the extra `files`, checked around.

What a header declares is held against the size of the file before anything of that size is made,
and the points that come are counted.
"""

from __future__ import annotations

import io
import struct
import subprocess
import sys
from collections.abc import Generator
from contextlib import closing, contextmanager, suppress
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from certreg.errors import InvalidFileError
from certreg.io.cloud import Cloud
from certreg.io.npy import points_of_columns
from certreg.io.optional import CLOUDCOMPARE, PDAL, optional_library
from certreg.io.streams import MAX_BINARY_BYTES, MAX_UNPACKED_BYTES, held_bytes, refused
from certreg.verify import shown

if TYPE_CHECKING:
    from numpy.typing import NDArray

CHUNK = 1 << 20  # points at a time
LEAST_HEADER = 227  # bytes, of LAS 1.0 to 1.2
COUNTS = struct.Struct("<HII")  # at 94: bytes of the header, where the points begin, records
RECORDS = 54  # bytes before the data of a variable record: each has at least these
COORDINATES = 24  # bytes of a point in doubles
SIGNATURE = b"LASF"
WORKING_BYTES = 1 << 28  # for what unpacking needs beside the points


def parse_las(stream: BinaryIO, file: Path) -> Cloud:
    """The points of a .las or .laz file, scaled and shifted as its header says."""
    laspy = optional_library("laspy", file, PDAL)
    held = held_bytes(stream, file)
    top = stream.read(LEAST_HEADER)
    stream.seek(0)
    if len(top) < LEAST_HEADER or not top.startswith(SIGNATURE):
        raise _not_read(file, "no header of LAS")
    size, start, records = COUNTS.unpack_from(top, 94)
    if not LEAST_HEADER <= size <= start <= held or records * RECORDS > start - size:
        raise _not_read(file, "its header and its size differ")
    with _refusing(file), laspy.open(stream, closefd=False, read_evlrs=False) as reader:
        header = reader.header
        declared, kind = header.point_count, header.point_format
        packed = bool(header.are_points_compressed)
        limit = MAX_UNPACKED_BYTES if packed else held - start
        if not 0 < declared * kind.size <= limit:
            what = f"{declared} points, {declared * kind.size} bytes of at most {limit}"
            raise _not_read(file, f"declares {what}")
        others = [name for name in kind.dimension_names if name not in {"X", "Y", "Z"}]
        columns = None if packed else _columns(reader)
    if columns is None:
        stream.seek(0)
        columns = _columns_of_packed(stream.read(held), file)
    if columns.shape[1] != declared:
        raise _not_read(file, f"declares {declared} points, holds {columns.shape[1]}")
    return Cloud(path=file, points=points_of_columns(file, list(columns)), ignored=tuple(others))


def parse_e57(stream: BinaryIO, file: Path) -> Cloud:
    """The valid points of a .e57 file with one scan, moved to where its pose puts them."""
    pye57 = optional_library("pye57", file, CLOUDCOMPARE)
    held_bytes(stream, file)
    with _refusing(file), closing(pye57.E57(str(file))) as scans:
        count = scans.scan_count
        declared = scans.get_header(0).point_count if count else 0
        if count != 1 or not 0 < declared * COORDINATES <= MAX_BINARY_BYTES:
            what = f"holds {count} scans, {declared} points in the first: save one scan alone"
            raise InvalidFileError(f"{shown(file)}: {what}", path=file, value=count, limit=1)
        data: dict[str, Any] = scans.read_scan(0, ignore_missing_fields=True)
    columns = [data[f"cartesian{axis}"] for axis in "XYZ"]
    valid = len(columns[0])
    if valid == 0:
        raise _not_read(file, "no valid points")
    note = f"{declared - valid} of {declared} points are not valid, and left out"
    return Cloud(
        path=file,
        points=points_of_columns(file, columns),
        notes=(note,) if valid < declared else (),
    )


def _columns(reader: Any) -> NDArray[np.float64]:
    """Columns x, y, z of all points."""
    chunks = [np.stack([c.x, c.y, c.z]) for c in reader.chunk_iterator(CHUNK)]
    return np.concatenate(chunks, axis=1)


def _columns_of_packed(content: bytes, file: Path) -> NDArray[np.float64]:
    """Columns x, y, z of a .laz file, unpacked by another process.

    What lazrs reserves is what the packed data say, and where there is not so much memory it ends
    its process: here, one that has nothing else to do.
    """
    child = [sys.executable, "-c", "from certreg.io.scans import unpack; unpack()"]
    done = subprocess.run(  # noqa: S603 - this Python, a constant
        child, input=content, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False
    )
    if done.returncode != 0 or len(done.stdout) % COORDINATES:
        raise _not_read(file, "its packed data are broken")
    return np.frombuffer(done.stdout).reshape(3, -1)


def unpack() -> None:
    """In a process of its own: a .laz file on standard input, its columns on standard output."""
    laspy = import_module("laspy")
    content = sys.stdin.buffer.read()
    with laspy.open(io.BytesIO(content), read_evlrs=False) as reader:
        header = reader.header
        room = header.point_count * (header.point_format.size + 2 * COORDINATES)
        _limit_memory(WORKING_BYTES + 2 * len(content) + room)
        sys.stdout.buffer.write(_columns(reader).tobytes())


def _limit_memory(further: int) -> None:
    """Let this process have so many bytes more, where the system can be told so: on Linux."""
    with suppress(ImportError, OSError, ValueError):
        resource: Any = import_module("resource")
        pages = int(Path("/proc/self/statm").read_text("ascii").split()[0])
        most = pages * resource.getpagesize() + further
        resource.setrlimit(resource.RLIMIT_AS, (most, most))


@contextmanager
def _refusing(file: Path) -> Generator[None]:
    """Whatever a library raises on a broken file is a refusal."""
    try:
        yield
    except (InvalidFileError, MemoryError):
        raise
    except Exception as error:
        raise _not_read(file, shown(str(error)[:80])) from error


def _not_read(file: Path, what: str) -> InvalidFileError:
    return refused(file, f"cannot be read ({what}): is it truncated? Save it again")
