"""Writing files so that none is ever half-written."""

from __future__ import annotations

import contextlib
import errno
import os
import re
import secrets
import stat
import time
from collections.abc import Generator, Iterable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import BinaryIO

from certreg.errors import InvalidFileError

BINARY: int = getattr(os, "O_BINARY", 0)  # Windows alone tells text from bytes
TEMPORARY = ".certreg-"  # how names of files begin that are not yet whole
UNFINISHED = re.compile(re.escape(TEMPORARY) + "[0-9a-f]{16}")
STALE = 86400.0  # seconds without a write: whoever wrote was killed
TOO_MANY = "close files, or raise the limit (ulimit -n)"
REMEDIES = {errno.EMFILE: TOO_MANY, errno.ENFILE: TOO_MANY}
FULL = {errno.ENOSPC, getattr(errno, "EDQUOT", errno.ENOSPC)}  # Windows has no quota
SWEPT_FOLDERS = 256  # that a process remembers; one that it forgets is looked at again


def remedy_of(error: OSError, otherwise: str = "choose another place") -> str:
    """What to do about what the system refuses, to end a message."""
    if error.errno in FULL:
        return f"free space, or {otherwise}"
    return REMEDIES.get(error.errno or 0, otherwise)


def write_atomically(
    path: str | os.PathLike[str], content: bytes | Iterable[bytes], *, sync: bool = True
) -> None:
    """Write a file, whole or in pieces, under a temporary name beside it, then rename.

    A symbolic link stays one: the file that it names is written. Raises InvalidFileError.
    sync: whether it is on the disk thereafter; else a power failure may leave it empty.
    """
    with written_atomically(path, sync=sync) as stream:
        stream.writelines([content] if isinstance(content, bytes) else content)


def write_files(folder: Path, contents: Mapping[str, bytes]) -> None:
    """Write files, by name, into a folder, made if it is missing; each whole or not at all.

    Raises InvalidFileError where a file cannot be written, OSError where the folder cannot be made.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in contents.items():
        write_atomically(folder / name, content)


def require_vacant(folder: Path) -> None:
    """Raise InvalidFileError where a folder holds files, but for unfinished ones of a killed run.

    A folder that does not exist is vacant.
    """
    names = {entry.name for entry in folder.iterdir()} if folder.exists() else set[str]()
    if any(not name.startswith(TEMPORARY) for name in names):
        raise InvalidFileError(
            f"{folder}: holds other files: choose a new folder, or empty it", path=folder
        )


def write_together(
    contents: Mapping[Path, bytes | Iterable[bytes]], obsolete: Iterable[Path]
) -> None:
    """Write files that belong together: all under temporary names, then rename, the first one last.

    Before anything is renamed, the `obsolete` ones are removed, then what stands there. So when the
    disk fills all is as it was, and when a renaming fails nothing is left of what was there before.
    A link in the place of a file is refused: who put it there would choose what is overwritten.
    Raises InvalidFileError.
    """
    former = [*obsolete, *contents]
    for path in former:
        if path.is_symlink():
            raise InvalidFileError(
                f"{path}: is a link where a file is to be: remove it, or choose another place",
                path=path,
            )
        if path.is_dir():
            raise InvalidFileError(
                f"{path}: is a folder where a file is to be: move it, or choose another place",
                path=path,
            )
    with contextlib.ExitStack() as stack:  # which renames in the opposite order
        handles: list[int] = []
        for path, content in contents.items():
            stream = stack.enter_context(written_atomically(path, follow=False, sync=False))
            stream.writelines([content] if isinstance(content, bytes) else content)
            stream.flush()
            handles.append(stream.fileno())
        _sync_handles(handles)
        for path in former:
            path.unlink(missing_ok=True)
    _sync_folders({path.parent for path in contents})


def _sync_handles(handles: list[int]) -> None:
    if len(handles) == 1:
        os.fsync(handles[0])
    elif handles:
        from concurrent.futures import ThreadPoolExecutor  # loads for 5 ms

        with ThreadPoolExecutor(len(handles)) as threads:
            list(threads.map(os.fsync, handles))


def _sync_folders(folders: Iterable[Path]) -> None:
    """Have the disk keep the names in folders, where the system can: Windows opens no folder."""
    for folder in folders:
        with contextlib.suppress(OSError):
            handle = os.open(folder, os.O_RDONLY)
            try:
                os.fsync(handle)
            finally:
                os.close(handle)


@contextlib.contextmanager
def written_atomically(
    path: str | os.PathLike[str], *, follow: bool = True, sync: bool = True
) -> Generator[BinaryIO]:
    """As `write_atomically`, for what is written bit by bit; nothing stands there if it fails.

    follow: whether a symbolic link stays one, and the file that it names is written.
    sync: whether the disk keeps it thereafter: the file before it is renamed, then its folder.
    """
    target = Path(os.path.realpath(path)) if follow else Path(path)
    _sweep(target.parent)
    # Named before it is made: wherever Ctrl-C comes, it is known what to remove.
    temporary = target.parent / f"{TEMPORARY}{secrets.token_hex(8)}"
    try:
        handle = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | BINARY, 0o666)
        with os.fdopen(handle, "wb") as stream:
            yield stream
            if sync:
                stream.flush()
                os.fsync(stream.fileno())
        temporary.replace(target)
        if sync:
            _sync_folders([target.parent])
    except OSError as error:
        raise InvalidFileError(
            f"{target}: cannot be written ({error.strerror}): {remedy_of(error)}", path=target
        ) from error
    finally:
        with contextlib.suppress(OSError):  # gone, or held by another program: swept some day
            temporary.unlink()


@lru_cache(SWEPT_FOLDERS)  # a folder of a million files is looked through once
def _sweep(folder: Path) -> None:
    """Remove this user's unfinished files of a process that was killed, a day old or older."""
    with contextlib.suppress(OSError):
        for entry in [each for each in os.scandir(folder) if UNFINISHED.fullmatch(each.name)]:
            with contextlib.suppress(OSError):
                status = entry.stat(follow_symlinks=False)
                own = not hasattr(os, "getuid") or status.st_uid == os.getuid()
                old = time.time() - status.st_mtime > STALE
                if own and old and stat.S_ISREG(status.st_mode):
                    Path(entry.path).unlink()
