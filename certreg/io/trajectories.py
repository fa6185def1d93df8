"""Trajectories as clouds: the positions of .tum and .kitti files, paired by time or by row.

TUM: `time tx ty tz x y z w` a line, the time in seconds. KITTI: the rows of [R | t], twelve numbers
a line. Two programs seldom note the same times: each time is paired with the nearest of the other.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from certreg.errors import InvalidFileError
from certreg.exact.decimals import as_given, at_most
from certreg.io.cloud import Cloud
from certreg.io.streams import number, refused
from certreg.io.text import parse_rows
from certreg.verify import shown

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

MOST_APART = 0.01  # seconds between two times of one pair: of cameras at 50 Hz half a frame
TUM_COLUMNS, KITTI_COLUMNS = 8, 12
KITTI_TRANSLATION = (3, 7, 11)
UNIT_SLACK = 0.01  # off 1, of a quaternion printed with two decimals or more


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TimedRows:
    """Which rows of two trajectories belong together, and what to say of them."""

    source: NDArray[np.int64]
    target: NDArray[np.int64]
    note: str


def parse_tum(stream: BinaryIO, file: Path) -> Cloud:
    """Positions and times of a file of TUM lines; the orientations are not read."""
    positions, times = list[list[float]](), list[float]()
    for place, fields in parse_rows(stream, file):
        row = [number(place, field) for field in fields]
        if len(row) != TUM_COLUMNS:
            raise place.refusal(
                f"{len(row)} columns, not 8: a TUM line is time tx ty tz x y z w",
                value=len(row),
                limit=TUM_COLUMNS,
            )
        if not abs(math.hypot(*row[4:]) - 1.0) <= UNIT_SLACK:
            raise place.refusal(
                f"the quaternion has norm {math.hypot(*row[4:]):.6g}, not 1: is it a TUM file?",
                value=row[4:],
                limit=1.0,
            )
        if times and row[0] <= times[-1]:
            raise place.refusal(
                f"time {row[0]!r} is not after {times[-1]!r}: sort the lines, drop repeated ones",
                value=row[0],
                limit=times[-1],
            )
        times.append(row[0])
        positions.append(row[1:4])
    return _trajectory(positions, file, np.array(times))


def parse_kitti(stream: BinaryIO, file: Path) -> Cloud:
    """Positions of a file of KITTI lines: the last column of each [R | t]."""
    positions = list[list[float]]()
    for place, fields in parse_rows(stream, file):
        row = [number(place, field) for field in fields]
        if len(row) != KITTI_COLUMNS:
            raise place.refusal(
                f"{len(row)} columns, not 12: a KITTI line is the rows of [R | t]",
                value=len(row),
                limit=KITTI_COLUMNS,
            )
        positions.append([row[k] for k in KITTI_TRANSLATION])
    return _trajectory(positions, file, None)


def rows_by_time(
    source: NDArray[np.float64], target: NDArray[np.float64], files: tuple[Path, Path]
) -> TimedRows:
    """The rows whose times are each the nearest of the other's, at most MOST_APART apart.

    source, target: seconds, ascending. Raises InvalidFileError where no two are so near.
    """
    there = _nearest(source, target)
    back = _nearest(target, source)
    here = np.arange(len(source))
    kept = (back[there] == here) & (np.abs(target[there] - source) <= MOST_APART)
    if not kept.any():
        least = float(np.abs(target[there] - source).min())
        raise InvalidFileError(
            f"no times of {shown(files[0])} and {shown(files[1])} are within "
            f"{as_given(MOST_APART)} s of each other, the nearest are {least:.6g} s apart: "
            "do both count from one moment?",
            path=files[1],
            value=least,
            limit=MOST_APART,
        )
    rows, others = here[kept], there[kept]
    most = float(np.abs(target[others] - source[rows]).max())
    note = f"rows are paired by time, at most {at_most(most)} s apart"
    return TimedRows(source=rows, target=others, note=note)


def _nearest(times: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.int64]:
    """For each time the row of the nearest of the others, which ascend; of two the earlier."""
    after = np.clip(np.searchsorted(others, times), 1, max(len(others) - 1, 1))
    before = after - 1
    after = np.minimum(after, len(others) - 1)
    later = others[after] - times < times - others[before]
    return np.where(later, after, before)


def _trajectory(
    positions: list[list[float]], file: Path, times: NDArray[np.float64] | None
) -> Cloud:
    if not positions:
        raise refused(file, "no poses: add lines", value=0, limit=1)
    left = ("the orientations",)
    return Cloud(path=file, points=np.array(positions), ignored=left, times=times)
