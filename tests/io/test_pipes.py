"""Input that may never end is refused; what the shell pipes in is read."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from certreg.certificate.envelope import certificate_bytes
from certreg.errors import InvalidFileError
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
