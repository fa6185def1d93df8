"""What is written stays after a power failure; what cannot be written says what to do."""

from __future__ import annotations

import errno
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from certreg.errors import InvalidFileError
from certreg.io.atomic import write_atomically, write_together
from certreg.io.streams import reading

if TYPE_CHECKING:
    from collections.abc import Callable


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The order of what makes files durable: "sync" of a file or a folder, "rename"."""
    told: list[str] = []
    honest, rename = os.fsync, Path.replace

    def fsync(handle: int) -> None:
        place = Path(f"/proc/self/fd/{handle}").readlink()
        told.append("sync folder" if place.is_dir() else f"sync {place.read_bytes().decode()}")
        honest(handle)

    def replace(self: Path, target: Path) -> Path:
        told.append(f"rename {target.name}")
        return rename(self, target)

    monkeypatch.setattr(os, "fsync", fsync)
    monkeypatch.setattr(Path, "replace", replace)
    return told


needs_proc = pytest.mark.skipif(not Path("/proc/self/fd").is_dir(), reason="no names of handles")


@needs_proc
def test_a_file_is_synced_before_it_is_renamed_and_its_folder_thereafter(
    tmp_path: Path, calls: list[str]
):
    write_atomically(tmp_path / "a", b"content")

    assert calls == ["sync content", "rename a", "sync folder"]


@needs_proc
def test_files_that_belong_together_are_all_synced_before_one_is_renamed(
    tmp_path: Path, calls: list[str]
):
    write_together({tmp_path / "a": b"1", tmp_path / "b": [b"2"]}, obsolete=())

    assert sorted(calls[:2]) == ["sync 1", "sync 2"]
    assert calls[2:] == ["rename b", "rename a", "sync folder"]


@needs_proc
def test_a_file_is_left_to_the_system_where_that_is_asked(tmp_path: Path, calls: list[str]):
    write_atomically(tmp_path / "a", b"content", sync=False)

    assert calls == ["rename a"]


def refusing(number: int) -> Callable[..., Any]:
    def refuse(*_: object, **__: object) -> None:
        raise OSError(number, os.strerror(number))

    return refuse


@pytest.mark.parametrize(
    ("number", "remedy"),
    [
        (errno.EMFILE, "close files, or raise the limit (ulimit -n)"),
        (errno.ENFILE, "close files, or raise the limit (ulimit -n)"),
        (errno.ENOSPC, "free space, or choose another place"),
        (errno.EDQUOT, "free space, or choose another place"),
        (errno.EACCES, "choose another place"),
        (errno.EROFS, "choose another place"),
    ],
)
def test_the_remedy_is_that_of_the_fault(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int, remedy: str
):
    monkeypatch.setattr(os, "open", refusing(number))
    with pytest.raises(InvalidFileError) as caught:
        write_atomically(tmp_path / "a", b"")

    assert str(caught.value).endswith(f"cannot be written ({os.strerror(number)}): {remedy}")


def test_a_disk_that_fails_when_synced_leaves_the_former_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    write_atomically(tmp_path / "a", b"former")
    monkeypatch.setattr(os, "fsync", refusing(errno.ENOSPC))
    with pytest.raises(InvalidFileError, match="No space left"):
        write_atomically(tmp_path / "a", b"new")

    assert [path.read_bytes() for path in tmp_path.iterdir()] == [b"former"]


def test_a_file_that_cannot_be_read_for_too_many_are_open_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(Path, "open", refusing(errno.EMFILE))
    with pytest.raises(InvalidFileError, match=r"ulimit -n\)$"), reading(tmp_path / "a"):
        pass
