"""Trajectories of TUM and KITTI files are clouds of positions, paired by time or by row."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

import certreg
from certreg.errors import InvalidFileError
from certreg.io.trajectories import MOST_APART, rows_by_time

if TYPE_CHECKING:
    from pathlib import Path

IDENTITY = "0 0 0 1"


def tum(path: Path, times: np.ndarray, positions: np.ndarray) -> Path:
    lines = [
        f"{t:.6f} {x!r} {y!r} {z!r} {IDENTITY}"
        for t, (x, y, z) in zip(times.tolist(), positions.tolist(), strict=True)
    ]
    path.write_text("# timestamp tx ty tz qx qy qz qw\n" + "\n".join(lines), encoding="utf-8")
    return path


def test_two_trajectories_pair_by_the_nearest_time_and_say_what_is_left_out(tmp_path):
    rng = np.random.default_rng(1)
    path = rng.normal(size=(40, 3))
    times = 1305031098.0 + np.arange(40) / 30
    estimate = tum(tmp_path / "estimate.tum", times[5::2] + 0.004, path[5::2])
    truth = tum(tmp_path / "truth.tum", times, path)
    pair = certreg.pair(estimate, truth)

    assert np.array_equal(pair.source.points, pair.target.points)
    assert np.array_equal(pair.source.points, path[5::2])
    assert pair.notes[-1] == "rows are paired by time, at most 0.00401 s apart"
    assert any("18 pairs; left out: 0 of" in note and "22 of" in note for note in pair.notes)
    assert pair.source.times is not None
    assert pair.target.times is not None
    assert np.allclose(pair.source.times - pair.target.times, 0.004, atol=1e-6)


def brute(a: np.ndarray, b: np.ndarray) -> list[tuple[int, int]]:
    apart = np.abs(a[:, None] - b)
    return [
        (i, j)
        for i in range(len(a))
        for j in range(len(b))
        if apart[i, j] <= MOST_APART and apart[i].argmin() == j and apart[:, j].argmin() == i
    ]


@pytest.mark.parametrize("seed", range(40))
def test_a_pair_is_each_the_nearest_of_the_other_and_no_row_is_in_two(tmp_path, seed: int):
    rng = np.random.default_rng(seed)
    a, b = (np.sort(rng.uniform(0, 0.2, rng.integers(1, 30))) for _ in range(2))
    names = (tmp_path / "a.tum", tmp_path / "b.tum")
    expected = brute(a, b)
    if not expected:
        with pytest.raises(InvalidFileError, match="do both count from one moment"):
            rows_by_time(a, b, names)
        return
    found = rows_by_time(a, b, names)

    assert list(zip(found.source.tolist(), found.target.tolist(), strict=True)) == expected
    assert len(set(found.source.tolist())) == len(set(found.target.tolist())) == len(expected)


def test_times_pair_up_to_a_hundredth_of_a_second(tmp_path):
    names = (tmp_path / "a.tum", tmp_path / "b.tum")
    times = np.array([0.0, 1.0])

    assert rows_by_time(times, np.array([MOST_APART, 5.0]), names).target.tolist() == [0]
    with pytest.raises(InvalidFileError, match=r"the nearest are 0\.010001 s apart"):
        rows_by_time(times, np.array([1.0001 * MOST_APART, 5.0]), names)


def test_positions_of_kitti_lines_are_their_last_columns(tmp_path):
    poses = np.random.default_rng(2).normal(size=(5, 3, 4))
    file = tmp_path / "00.kitti"
    np.savetxt(file, poses.reshape(5, 12), fmt="%.17e")
    cloud = certreg.load(file)

    assert np.array_equal(cloud.points, poses[:, :, 3])
    assert cloud.times is None


BROKEN = {
    "seven numbers": ("t.tum", "1 2 3 4 0 0 0\n", "line 1: 7 columns, not 8"),
    "no rotation": ("t.tum", "1 2 3 4 0 0 0 0.9\n", "line 1: the quaternion has norm 0.9, not 1"),
    "times fall": ("t.tum", f"2 0 0 0 {IDENTITY}\n1 0 0 0 {IDENTITY}", "line 2: time 1.0 is not"),
    "a time twice": ("t.tum", f"2 0 0 0 {IDENTITY}\n2 0 0 0 {IDENTITY}", "drop repeated ones"),
    "a word": ("t.tum", f"now 0 0 0 {IDENTITY}\n", "line 1"),
    "comments alone": ("t.tum", "# none\n", "no poses: add lines"),
    "TUM in KITTI": ("t.kitti", f"1 2 3 4 {IDENTITY}\n", "line 1: 8 columns, not 12"),
    "nothing": ("t.kitti", "", "no poses: add lines"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_what_is_no_trajectory_is_refused_with_the_line(tmp_path, name: str):
    file, content, words = BROKEN[name]
    path = tmp_path / file
    path.write_text(content, encoding="utf-8")
    with pytest.raises(InvalidFileError, match=words):
        certreg.load(path)
