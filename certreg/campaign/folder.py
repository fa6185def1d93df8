"""The folder of a campaign: one campaign, one process at a time, nothing else in it."""

from __future__ import annotations

import os
from contextlib import contextmanager
from typing import TYPE_CHECKING

from certreg.campaign.manifest import require_same
from certreg.errors import CampaignError, InvalidFileError
from certreg.io import TEMPORARY, write_atomically
from certreg.verify import shown

if TYPE_CHECKING:
    from collections.abc import Generator
    from pathlib import Path

    from certreg.campaign.manifest import Manifest

MANIFEST = "campaign.json"


@contextmanager
def occupied(folder: Path, manifest: Manifest, *subfolders: str) -> Generator[None]:
    """The folder, made or gone on with, ours alone until the end of the block.

    Raises InvalidFileError where it holds another campaign or anything else, CampaignError where
    another process is at work in it.
    """
    with _complaints(folder):
        folder.mkdir(parents=True, exist_ok=True)
    with _locked(folder):
        with _complaints(folder):
            _prepare(folder, manifest, subfolders)
        yield


def _prepare(folder: Path, manifest: Manifest, subfolders: tuple[str, ...]) -> None:
    names = {entry.name for entry in folder.iterdir()}
    if MANIFEST in names:
        require_same(folder / MANIFEST, manifest)
    elif any(not name.startswith(TEMPORARY) for name in names):
        message = f"{shown(folder)}: holds other files: choose a new folder, or empty it"
        raise InvalidFileError(message)
    for place in (folder, *(folder / name for name in subfolders)):
        place.mkdir(exist_ok=True)
        for left_over in place.glob(f"{TEMPORARY}*"):
            left_over.unlink()
    if MANIFEST not in names:
        write_atomically(folder / MANIFEST, manifest.to_json())


@contextmanager
def _complaints(folder: Path) -> Generator[None]:
    """What the system refuses, as an InvalidFileError."""
    try:
        yield
    except OSError as error:
        place = shown(error.filename or folder)
        message = f"{place}: cannot be used ({error.strerror}): choose another folder"
        raise InvalidFileError(message) from error


@contextmanager
def _locked(folder: Path) -> Generator[None]:
    """The folder locked against other processes; the lock ends with this process, however it ends.

    Without such locks (Windows, some network disks) there is none: two runs do the same work then,
    and every file is still whole.
    """
    try:
        import fcntl
    except ImportError:
        yield
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            message = f"{shown(folder)}: another process is at work there: wait for it, or stop it"
            raise CampaignError(message) from error
        except OSError:
            pass  # this disk has no locks
        yield
    finally:
        os.close(handle)
