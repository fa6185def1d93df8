"""Where compiled code is kept between runs: folders of the user's own, from which code is loaded.

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
import stat
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from certreg.errors import CertregError

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator


class CacheError(CertregError):
    """A folder cannot be used to keep compiled code; the message says why."""


def find(name: str) -> Path | None:
    """The library of that name, whole, from the first folder that has it."""
    for opened in _folders():
        with contextlib.suppress(CacheError), opened as folder:
            library = folder / f"{name}.so"
            if is_intact(library):
                return library
    return None


def store(name: str, content: bytes) -> Path:
    """Keep a library in the first folder that takes it. Raises CacheError where none does."""
    reasons: list[str] = []
    for opened in _folders():
        try:
            with opened as folder:
                return _written(folder, name, content)
        except CacheError as error:
            reasons.append(str(error))
    raise CacheError("; ".join(reasons))


def is_intact(library: Path) -> bool:
    """Whether a library is there with exactly the bytes that were compiled."""
    try:
        return _seal(library).read_text() == digest(library.read_bytes())
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
    with _refusals(folder):
        folder = folder.expanduser()
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        _require_own(folder, folder.stat())
        yield folder


@contextlib.contextmanager
def _opened_temporary() -> Generator[Path]:
    user = os.getuid() if hasattr(os, "getuid") else "user"
    with _refusals(Path("the folder for temporary files")):
        folder = Path(tempfile.gettempdir()) / f"certreg-{user}"
    with _refusals(folder):
        folder.mkdir(exist_ok=True, mode=0o700)
        status = folder.lstat()
        if not stat.S_ISDIR(status.st_mode):
            raise CacheError(f"{folder} is no folder")
        _require_own(folder, status)
        yield folder


@contextlib.contextmanager
def _refusals(folder: Path) -> Generator[None]:
    try:
        yield
    except (OSError, RuntimeError) as error:  # RuntimeError: there is no home
        reason = getattr(error, "strerror", None) or error
        raise CacheError(f"{folder} cannot be written ({reason})") from error


def _require_own(folder: Path, status: os.stat_result) -> None:
    """Raises CacheError for a folder in which others could put code."""
    if hasattr(os, "getuid") and status.st_uid not in {os.getuid(), 0}:
        raise CacheError(f"{folder} belongs to another user")
    if status.st_mode & stat.S_IWOTH:
        raise CacheError(f"others may write to {folder}")


def _written(folder: Path, name: str, content: bytes) -> Path:
    library = folder / f"{name}.so"
    with tempfile.TemporaryDirectory(dir=folder, prefix=".writing-") as place:
        fresh = Path(place) / "library.so"
        fresh.write_bytes(content)
        _seal(fresh).write_text(digest(content))
        if not is_intact(fresh):
            raise CacheError(f"{folder} does not keep what is written to it")
        fresh.replace(library)
        _seal(fresh).replace(_seal(library))
    return library
