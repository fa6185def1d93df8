"""Input that may never end is refused; what the shell pipes in is read."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest
from commands import certreg

from certreg.campaign.listing import read_listing
from certreg.campaign.store import MANIFEST, Manifest, require_same
from certreg.certificate.envelope import certificate_bytes
from certreg.certificate.refusals import why_no_certificates
from certreg.errors import InvalidFileError
from certreg.io.clouds import read_cloud
from certreg.io.streams import reading

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
@pytest.mark.parametrize("device", [False, True])
def test_a_named_pipe_and_a_device_are_refused(tmp_path: Path, *, device: bool):
    path = tmp_path / "a.csv"
    if device:
        path.symlink_to("/dev/zero")
    else:
        os.mkfifo(path)
    with pytest.raises(InvalidFileError, match="a named pipe or a device"), reading(path):
        pass
    with pytest.raises(InvalidFileError, match="a named pipe or a device"):
        certificate_bytes(path)


def test_a_pipe_of_the_shell_is_read():
    end, writing = os.pipe()
    os.write(writing, b"1 2 3")
    os.close(writing)
    with reading(f"/dev/fd/{end}") as stream:
        assert stream.read() == b"1 2 3"
    os.close(end)


def test_a_cloud_piped_without_a_name_of_its_format_is_told_to_come_on_standard_input():
    with pytest.raises(InvalidFileError, match=r"/dev/fd/63: the format \(none\) .*: .* give -"):
        read_cloud("/dev/fd/63")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
@pytest.mark.parametrize("name", ["a.jsonl", "a.json"])
def test_a_named_pipe_of_certificates_is_refused(tmp_path: Path, name: str):
    os.mkfifo(tmp_path / name)
    run = certreg("verify", tmp_path / name)

    assert run.code == 2
    assert "a named pipe or a device" in run.err


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_a_named_pipe_as_list_or_manifest_is_refused(tmp_path: Path):
    listed, manifest = tmp_path / "pairs.csv", tmp_path / MANIFEST
    for path in (listed, manifest):
        os.mkfifo(path)
    with pytest.raises(InvalidFileError, match="a named pipe"):
        read_listing(listed)
    wanted = Manifest(kind="pairs", count=1, shard_size=1, settings={}, versions={})
    with pytest.raises(InvalidFileError, match="a named pipe"):
        require_same(manifest, wanted)


def test_certificates_that_the_shell_pipes_in_are_all_checked():
    end, writing = os.pipe()
    os.write(writing, b"{}\n{}\n")
    os.close(writing)
    assert why_no_certificates(f"/dev/fd/{end}") is None
    assert os.read(end, 10) == b"{}\n{}\n"
    os.close(end)
