"""Where compiled code is kept between runs: folders of the user's own, from which code is loaded.

Whoever can write to such a folder, or put another in its place, runs code as this user. So it is
used only where nobody else can: it and what is in it belong to the user, no folder above it lets
others rename, and neither group nor others may write.

Beside each library stands the digest of its bytes, so that a damaged file is seen before it is
loaded. Both are written under temporary names and renamed: several processes may write at once, the
last one wins, and all are equal. A process that reads between the two renames sees a digest that
does not fit, and compiles for itself.

A module of its own: which folders, and which files in them, are trusted is judged here alone.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import shutil
import stat
import tempfile
import time
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

from certreg.errors import CertregError, SlowSimulationWarning

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator


STALE = 86400.0  # seconds: nothing is compiled for a day
WRITING = ".writing-"  # how folders begin in which a library is being written
WRITE_BITS = stat.S_IWGRP | stat.S_IWOTH


class CacheError(CertregError):
    """A folder cannot be used to keep compiled code; the message says why."""


class UntrustedFolderError(CacheError):
    """Others could put code into a folder; the message says what to mend."""


def find(name: str) -> Path | None:
    """The library of that name, whole, from the first folder that has it."""
    for opened in _folders():
        with contextlib.suppress(CacheError), opened as folder:
            library = folder / f"{name}.so"
            if is_intact(library) and _is_own(library):
                return library
    return None


def store(name: str, content: bytes) -> Path:
    """Keep a library in the first folder that takes it; a warning where one before is not trusted.

    Raises CacheError where none takes it.
    """
    reasons: list[CacheError] = []
    for opened in _folders():
        try:
            with opened as folder:
                library = _written(folder, name, content)
        except CacheError as error:
            reasons.append(error)
            continue
        untrusted = "; ".join(str(e) for e in reasons if isinstance(e, UntrustedFolderError))
        if untrusted:
            message = f"{untrusted}: compiled code is kept in {library.parent} instead"
            warnings.warn(message, SlowSimulationWarning, stacklevel=5)
        return library
    raise CacheError("; ".join(map(str, reasons)))


def sweep(folder: Path, prefix: str) -> None:
    """Remove folders for the time of a compilation that a killed process left, a day old or older.

    prefix: of the names that `tempfile` completes with eight characters. Folders of other users
    and of other names are left alone, and so is what cannot be removed.
    """
    name = re.compile(rf"{re.escape(prefix)}[a-z0-9_]{{8}}")
    with contextlib.suppress(OSError):
        for entry in [each for each in os.scandir(folder) if name.fullmatch(each.name)]:
            with contextlib.suppress(OSError):
                status = entry.stat(follow_symlinks=False)
                old = time.time() - status.st_mtime > STALE
                if old and stat.S_ISDIR(status.st_mode) and status.st_uid == _user(status):
                    shutil.rmtree(entry.path, ignore_errors=True)


@contextlib.contextmanager
def opened_folder(folder: Path) -> Generator[Path]:
    """A folder that only this user fills, made if it is missing, by its name without links.

    Raises CacheError.
    """
    with _refusals(folder):
        folder = folder.expanduser().resolve()
        for missing in [each for each in (*folder.parents[::-1], folder) if not each.exists()]:
            missing.mkdir(mode=0o700, exist_ok=True)  # `parents=True` would leave it to the mask
        if not folder.is_dir():
            raise CacheError(f"{folder} is no folder")
        _require_own(folder, folder.stat())
        _require_fixed(folder)
        yield folder


def is_intact(library: Path) -> bool:
    """Whether a library is there with exactly the bytes that were compiled."""
    try:
        return _seal(library).read_text("utf-8") == digest(library.read_bytes())
    except (OSError, UnicodeDecodeError):
        return False


def digest(content: bytes) -> str:
    """The digest in hexadecimal."""
    return hashlib.sha256(content).hexdigest()


def _seal(library: Path) -> Path:
    return library.with_suffix(".sha256")


def _folders() -> Iterator[contextlib.AbstractContextManager[Path]]:
    """The user's cache; then, for those whose cache does not work, one among temporary files.

    $CERTREG_CACHE_DIR, else $XDG_CACHE_HOME/certreg, else ~/.cache/certreg; then certreg-USER in
    $TMPDIR, where anyone may have put something of that name: it must be a folder, and one's own.
    """
    yield _opened_cache()
    yield _opened_temporary()


@contextlib.contextmanager
def _opened_cache() -> Generator[Path]:
    named = os.environ.get("CERTREG_CACHE_DIR")
    base = os.environ.get("XDG_CACHE_HOME") or "~/.cache"
    folder = Path(named) if named else Path(base) / "certreg"
    with opened_folder(folder) as opened:
        yield opened


@contextlib.contextmanager
def _opened_temporary() -> Generator[Path]:
    user = os.getuid() if hasattr(os, "getuid") else "user"
    with _refusals(Path("the folder for temporary files")):
        folder = Path(tempfile.gettempdir()).resolve() / f"certreg-{user}"
    with _refusals(folder):
        folder.mkdir(exist_ok=True, mode=0o700)
        status = folder.lstat()
        if not stat.S_ISDIR(status.st_mode):
            raise CacheError(f"{folder} is no folder")
        _require_own(folder, status)
        _require_fixed(folder)
        yield folder


@contextlib.contextmanager
def _refusals(folder: Path) -> Generator[None]:
    try:
        yield
    except (OSError, RuntimeError) as error:  # RuntimeError: there is no home
        reason = getattr(error, "strerror", None) or error
        raise CacheError(f"{folder} cannot be written ({reason})") from error


def _require_own(folder: Path, status: os.stat_result) -> None:
    """Raises UntrustedFolderError for a folder in which others could put code."""
    if status.st_uid not in {_user(status), 0}:
        message = f"{folder} belongs to another user"
        raise UntrustedFolderError(message)
    if os.name == "posix" and status.st_mode & WRITE_BITS:
        message = f"others may write to {folder} (remedy: chmod go-w)"
        raise UntrustedFolderError(message)


def _require_fixed(folder: Path) -> None:
    """Raises UntrustedFolderError where others could put another folder in the place of this one.

    That is in their power where they own a folder above it, or may write to one without the sticky
    bit. Whoever owns the root of the file system is the system.
    """
    for above in folder.parents:
        status = above.stat()
        sticky = status.st_mode & stat.S_ISVTX
        if status.st_uid not in {_user(status), 0, Path(above.anchor).stat().st_uid}:
            message = f"{above}, above {folder}, belongs to another user"
            raise UntrustedFolderError(message)
        if os.name == "posix" and status.st_mode & WRITE_BITS and not sticky:
            message = f"others may write to {above}, above {folder} (remedy: chmod go-w)"
            raise UntrustedFolderError(message)


def _is_own(library: Path) -> bool:
    """Whether a file itself, no link, is the user's, and others may not write to it."""
    try:
        status = library.lstat()
    except OSError:
        return False
    own = stat.S_ISREG(status.st_mode) and status.st_uid in {_user(status), 0}
    return own and not (os.name == "posix" and status.st_mode & WRITE_BITS)


def _user(status: os.stat_result) -> int:
    """This user; where there are no users, the owner of whatever is looked at."""
    return os.getuid() if hasattr(os, "getuid") else status.st_uid


def _written(folder: Path, name: str, content: bytes) -> Path:
    library = folder / f"{name}.so"
    sweep(folder, WRITING)
    with tempfile.TemporaryDirectory(dir=folder, prefix=WRITING) as place:
        fresh = Path(place) / "library.so"
        fresh.write_bytes(content)
        fresh.chmod(0o644)  # whatever the user's mask: what others may write to is not loaded
        _seal(fresh).write_text(digest(content), "utf-8")
        if not is_intact(fresh):
            raise CacheError(f"{folder} does not keep what is written to it")
        fresh.replace(library)
        _seal(fresh).replace(_seal(library))
    return library
