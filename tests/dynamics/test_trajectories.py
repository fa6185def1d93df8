"""A trajectory file says whose it is, and gives back what was written or is refused."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from certreg.dynamics.trajectories import Record, read_record
from certreg.errors import InvalidFileError
from certreg.registration.certification import simulate
from certreg.registration.examples import STORIES, stated

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture(scope="module")
def record() -> Record:
    problem = stated(STORIES[0])
    return Record.of(problem, simulate(problem, "splitting"))


def test_a_trajectory_comes_back_as_it_was_written(record: Record, tmp_path: Path):
    file = tmp_path / "trajectory.npz"
    file.write_bytes(record.to_bytes())
    back = read_record(file)

    for name in ("times", "states", "potential", "kinetic"):
        assert np.array_equal(getattr(back, name), getattr(record, name))
    assert (back.length_exponent, back.damping) == (record.length_exponent, record.damping)
    assert back.digest == stated(STORIES[0]).digest() != stated(STORIES[1]).digest()


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("states", np.zeros((3, 17))),
        ("times", np.zeros((2, 2))),
        ("kinetic", np.zeros(1)),
        ("digest", np.zeros(31)),
        ("damping", np.array([np.nan])),
        ("length_exponent", np.array(1e300)),
        ("potential", None),
        ("times", np.array(["a"])),
    ],
)
def test_what_is_no_trajectory_is_refused(record: Record, tmp_path: Path, name: str, value: Any):
    file = tmp_path / "trajectory.npz"
    file.write_bytes(record.to_bytes())
    with np.load(file) as arrays:
        held = dict(arrays)
    held[name] = value
    np.savez(file, **{key: array for key, array in held.items() if array is not None})

    with pytest.raises(InvalidFileError, match=r"trajectory\.npz"):
        read_record(file)


def test_a_truncated_file_is_refused(record: Record, tmp_path: Path):
    file = tmp_path / "trajectory.npz"
    content = record.to_bytes()
    for size in (0, 10, len(content) // 2, len(content) - 1):
        file.write_bytes(content[:size])
        with pytest.raises(InvalidFileError):
            read_record(file)
