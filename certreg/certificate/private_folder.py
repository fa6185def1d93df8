"""Folders of the user's own, in which compiled proofs are kept between runs.

Whoever can write to such a folder, or put another in its place, decides what Coq is told. So it is
used only where nobody else can: it belongs to the user, no folder above it lets others rename, and
neither group nor others may write. A module of its own: which folders are trusted is judged here.
"""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import stat
import time
from collections.abc import Callable, Generator
from pathlib import Path

from certreg.errors import CertregError

STALE = 86400.0  # seconds: nothing is compiled for a day
WRITE_BITS = stat.S_IWGRP | stat.S_IWOTH


class UnusableFolderError(CertregError):
    """A folder cannot be used to keep compiled proofs; the message says why."""


def sweep(folder: Path, prefix: str, abandoned: Callable[[Path], bool] | None = None) -> None:
    """Remove folders for a time only that a killed process left, a day old or older.

    prefix: of the names that `tempfile` completes with eight characters. Folders of other users
    and of other names are left alone, and so is what cannot be removed.
    abandoned: asked last of a folder; where it raises OSError the folder stays. None: any is.
    """
    name = re.compile(rf"{re.escape(prefix)}[a-z0-9_]{{8}}")
    with contextlib.suppress(OSError):
        for entry in [each for each in os.scandir(folder) if name.fullmatch(each.name)]:
            with contextlib.suppress(OSError):
                status = entry.stat(follow_symlinks=False)
                old = time.time() - status.st_mtime > STALE
                own = stat.S_ISDIR(status.st_mode) and status.st_uid == _user(status)
                if old and own and (abandoned is None or abandoned(Path(entry.path))):
                    shutil.rmtree(entry.path, ignore_errors=True)


@contextlib.contextmanager
def opened_folder(folder: Path) -> Generator[Path]:
    """A folder that only this user fills, made if it is missing, by its name without links.

    Raises UnusableFolderError.
    """
    try:
        folder = folder.expanduser().resolve()
        for missing in [each for each in (*folder.parents[::-1], folder) if not each.exists()]:
            missing.mkdir(mode=0o700, exist_ok=True)  # `parents=True` would leave it to the mask
        if not folder.is_dir():
            raise UnusableFolderError(f"{folder} is no folder")
        _require_own(folder, folder.stat())
        _require_fixed(folder)
        yield folder
    except (OSError, RuntimeError) as error:  # RuntimeError: there is no home
        reason = getattr(error, "strerror", None) or error
        raise UnusableFolderError(f"{folder} cannot be written ({reason})") from error


def _require_own(folder: Path, status: os.stat_result) -> None:
    """Raises UnusableFolderError for a folder in which others could put something."""
    if status.st_uid not in {_user(status), 0}:
        raise UnusableFolderError(f"{folder} belongs to another user")
    if os.name == "posix" and status.st_mode & WRITE_BITS:
        raise UnusableFolderError(f"others may write to {folder} (remedy: chmod go-w)")


def _require_fixed(folder: Path) -> None:
    """Raises UnusableFolderError where others could put another folder in the place of this one.

    That is in their power where they own a folder above it, or may write to one without the sticky
    bit. Whoever owns the root of the file system is the system.
    """
    for above in folder.parents:
        status = above.stat()
        sticky = status.st_mode & stat.S_ISVTX
        if status.st_uid not in {_user(status), 0, Path(above.anchor).stat().st_uid}:
            raise UnusableFolderError(f"{above}, above {folder}, belongs to another user")
        if os.name == "posix" and status.st_mode & WRITE_BITS and not sticky:
            raise UnusableFolderError(
                f"others may write to {above}, above {folder} (remedy: chmod go-w)"
            )


def _user(status: os.stat_result) -> int:
    """This user; where there are no users, the owner of whatever is looked at."""
    return os.getuid() if hasattr(os, "getuid") else status.st_uid
