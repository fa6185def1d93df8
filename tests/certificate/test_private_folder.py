"""Folders to which others may write, or that others may replace, hold no compiled proofs."""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import Any

import pytest

from certreg.certificate import private_folder
from certreg.certificate.private_folder import STALE, UnusableFolderError, opened_folder, sweep


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "above").mkdir(mode=0o700)
    (tmp_path / "above" / "mine").mkdir(mode=0o700)
    return tmp_path / "above" / "mine"


def refusal(folder: Path) -> str:
    with pytest.raises(UnusableFolderError) as told, opened_folder(folder):
        pytest.fail("opened")
    assert "\n" not in str(told.value)
    return str(told.value)


@pytest.mark.parametrize("mode", [0o777, 0o1777, 0o770, 0o720])
def test_a_folder_that_others_may_write_to_is_not_trusted(folder, mode):
    folder.chmod(mode)

    assert refusal(folder) == f"others may write to {folder} (remedy: chmod go-w)"


@pytest.mark.parametrize(("mode", "trusted"), [(0o775, False), (0o1777, True), (0o755, True)])
def test_a_folder_that_others_could_replace_is_not_trusted(folder, mode, trusted):
    """Who may write to the folder above renames; in a sticky one only the owner does."""
    folder.parent.chmod(mode)

    if trusted:
        with opened_folder(folder) as opened:
            assert opened == folder
    else:
        assert refusal(folder).startswith(f"others may write to {folder.parent}, above {folder}")


def test_a_link_is_judged_by_what_it_names(folder, tmp_path):
    (tmp_path / "link").symlink_to(folder)

    with opened_folder(tmp_path / "link") as opened:
        assert opened == folder


@pytest.mark.parametrize("place", ["file", "file/below"])
def test_a_folder_that_cannot_be_made_is_a_message(place, folder):
    (folder / "file").write_text("in the way", "utf-8")

    assert str(folder / place) in refusal(folder / place)


def test_a_user_without_a_home_is_told(folder, monkeypatch):
    def homeless(_: Path) -> Path:
        raise RuntimeError("no home")

    monkeypatch.setattr(Path, "expanduser", homeless)

    assert refusal(folder) == f"{folder} cannot be written (no home)"


def test_a_folder_is_made_for_the_user_alone_whatever_the_mask(folder):
    former = os.umask(0o002)
    try:
        with opened_folder(folder / "a" / "b") as opened:
            assert [each.stat().st_mode & 0o777 for each in (opened, opened.parent)] == [0o700] * 2
    finally:
        os.umask(former)


def test_a_folder_of_another_user_is_not_trusted(folder):
    status = list(folder.stat())
    status[4] = os.getuid() + 1  # st_uid

    with pytest.raises(UnusableFolderError, match="belongs to another user"):
        private_folder._require_own(folder, os.stat_result(status))


def test_what_the_system_owns_is_trusted_as_ones_own_is(folder, monkeypatch):
    status = list(folder.stat())
    monkeypatch.setattr(os, "getuid", lambda: 1000)
    for owner in (0, 1000):
        status[4] = owner
        private_folder._require_own(folder, os.stat_result(status))
    status[4] = 1001
    with pytest.raises(UnusableFolderError, match="belongs to another user"):
        private_folder._require_own(folder, os.stat_result(status))


def test_a_folder_below_one_of_another_user_is_not_trusted(folder, monkeypatch):
    honest = Path.stat

    def foreign(self: Path, **options: Any) -> os.stat_result:
        status = list(honest(self, **options))
        status[4] += 1 if self == folder.parent else 0
        return os.stat_result(status)

    monkeypatch.setattr(Path, "stat", foreign)

    with pytest.raises(UnusableFolderError, match=r"above .* belongs to another user"):
        private_folder._require_fixed(folder)


def test_folders_of_killed_compilations_are_swept_and_no_others(folder, monkeypatch):
    left = folder / ".coq-abcd_123"
    kept = [folder / ".coq-mine", folder / "coq-abcd_123", folder / ".coq-fresh___"]
    for place in (left, *kept):
        place.mkdir()
        if "fresh" not in place.name:
            os.utime(place, (0.0, time.time() - STALE - 60.0))
    (folder / ".coq-linklink").symlink_to(kept[0])
    sweep(folder, ".coq-")

    assert not left.exists()
    assert all(place.exists() for place in kept)

    monkeypatch.setattr(os, "getuid", lambda: folder.stat().st_uid + 1)
    os.utime(kept[-1], (0.0, 0.0))
    sweep(folder, ".coq-")
    assert kept[-1].exists()
