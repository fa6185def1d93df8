"""Arrays in .npz archives; of a cloud, `points` or the only one of shape (N, 3). No pickles.

An archive as numpy writes it: the directory stands at the end, whole and short, and every size is
compared before anything is unpacked.
"""

from __future__ import annotations

import io
import math
import struct
import zipfile
import zlib
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, BinaryIO

from certreg.errors import InvalidFileError
from certreg.io.cloud import Cloud
from certreg.io.npy import NOT_NPY, parse_array, read_header
from certreg.io.streams import MAX_HEADER_BYTES, MAX_UNPACKED_BYTES, held_bytes, refused
from certreg.verify import shown

if TYPE_CHECKING:
    from pathlib import Path


END = struct.Struct("<4s4H2IH")  # end of central directory: signature, .., size, offset, comment
ZIP64_LOCATOR = b"PK\x06\x07"
MAX_ARRAYS = 64  # in one archive: points and what goes with them
METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)  # numpy's; both unpack in bounded steps
NOT_ZIP = (  # what the standard library raises for archives that it cannot read
    EOFError,
    OverflowError,
    RuntimeError,  # of a password, and of methods that it does not know
    ValueError,
    struct.error,
    zipfile.BadZipFile,
    zlib.error,
)


@dataclass(frozen=True, slots=True)
class Member:
    """An array in an archive; shape None where it is no array of real numbers."""

    info: zipfile.ZipInfo
    shape: tuple[int, ...] | None
    size: int  # of the whole .npy file, by its header

    @property
    def name(self) -> str:
        """The name that numpy gives it."""
        return self.info.filename.removesuffix(".npy")


def parse_npz(stream: BinaryIO, file: Path) -> Cloud:
    """The points of an archive, and the names of what else is in it."""
    with _opened(stream, file) as (archive, members):
        chosen = _chosen(members, file)
        content = _unpacked(archive, chosen, file)
    others = tuple(member.name for member in members if member is not chosen)
    return Cloud(path=file, points=parse_array(io.BytesIO(content), file), ignored=others)


@contextmanager
def _opened(stream: BinaryIO, file: Path) -> Generator[tuple[zipfile.ZipFile, list[Member]]]:
    """An archive and what its directory says of its members; refused if it is none."""
    _require_plain_directory(stream, file)
    try:
        with zipfile.ZipFile(stream) as archive:
            count = len(archive.infolist())
            if count > MAX_ARRAYS:
                raise refused(
                    file, "too many arrays: save only the points", value=count, limit=MAX_ARRAYS
                )
            yield archive, [_member(archive, info, file) for info in archive.infolist()]
    except NOT_ZIP as error:
        raise refused(
            file, f"is not an .npz file ({shown(error)}): save it with numpy.savez"
        ) from error


def _require_plain_directory(stream: BinaryIO, file: Path) -> None:
    """That the file ends with a directory of bounded size, and begins where that says."""
    size = held_bytes(stream, file)
    tail_size = min(size, 20 + END.size)  # 20: a locator of ZIP64 stands right before the end
    stream.seek(size - tail_size)
    tail = stream.read(tail_size)
    stream.seek(0)
    if len(tail) >= END.size:
        mark, _, _, _, _, length, offset, comment = END.unpack(tail[-END.size :])
        plain = mark == b"PK\x05\x06" and comment == 0 and not tail.startswith(ZIP64_LOCATOR)
        short = length <= MAX_HEADER_BYTES
        if plain and short and offset + length + END.size == size:
            return
    raise refused(file, "is not an .npz file, or truncated: save it with numpy.savez")


def _member(archive: zipfile.ZipFile, info: zipfile.ZipInfo, file: Path) -> Member:
    if info.compress_type not in METHODS:
        what = f"'{shown(info.filename)}' is packed in a way that numpy does not use"
        raise refused(file, f"{what}: save it with numpy.savez", column=info.filename)
    if not info.filename.endswith(".npy"):
        return Member(info, None, 0)
    with archive.open(info) as packed:
        head = io.BytesIO(packed.read(MAX_HEADER_BYTES))
    try:
        shape, _, dtype = read_header(head, file)
    except (InvalidFileError, *NOT_NPY):
        return Member(info, None, 0)
    return Member(info, shape, head.tell() + math.prod(shape) * dtype.itemsize)


def _chosen(members: list[Member], file: Path) -> Member:
    named = [member for member in members if member.name == "points"]
    fitting = [m for m in members if m.shape and len(m.shape) == 2 and m.shape[1] == 3]
    candidates = named or fitting
    if len(candidates) != 1 or candidates[0] not in fitting or candidates[0].shape == (0, 3):
        held = ", ".join(f"{m.name} {m.shape or 'no real numbers'}" for m in members)
        raise refused(
            file,
            f"holds {shown(held) or 'nothing'}: save one array of shape (N, 3), "
            "N >= 1, or name it points",
            column="points",
            value=held,
        )
    return candidates[0]


def _unpacked(archive: zipfile.ZipFile, member: Member, file: Path) -> bytes:
    """The .npy file of a member, unpacked only if archive and header declare the same size."""
    declared = member.info.file_size
    if declared != member.size or declared > MAX_UNPACKED_BYTES:
        raise refused(
            file,
            f"'{shown(member.name)}' is said to be {declared} bytes long, by its "
            f"header {member.size}: it is corrupt or too large; save it again",
            column=member.name,
            value=declared,
            limit=min(member.size, MAX_UNPACKED_BYTES),
        )
    with archive.open(member.info) as packed:
        return packed.read()
