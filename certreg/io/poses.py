"""Poses from files, as tools write them: text, .npy, JSON. They are read here, judged elsewhere."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from certreg.errors import InvalidFileError
from certreg.geometry.orthogonality import ROTATION_TOLERANCE
from certreg.io.npy import parse_array
from certreg.io.pose_documents import pose_of_certificate, pose_of_json
from certreg.io.pose_values import PoseSource, of_array, of_matrix, of_quaternion
from certreg.io.streams import lines, reading
from certreg.verify import FILE_MAX, shown

if TYPE_CHECKING:
    import os

    from certreg.geometry.given import GivenPose

MAX_POSE_BYTES = 1 << 20  # a result without its points is a few kilobytes
RESULT = "result.json"
BESIDE = "pose.json", "pose.txt"  # that certify writes, without a word on the pairs
NPY = b"\x93NUMPY"
FORMS = {  # by how many numbers there are in a line
    7: "w x y z tx ty tz",
    8: "TUM: time tx ty tz x y z w",
    12: "KITTI: the rows of [R | t]",
}


def read_result_pose(path: str | os.PathLike[str], line: int | None = None) -> GivenPose:
    """The pose in a result of certreg (the file or its folder), or in a pose file."""
    file = Path(path)
    if file.is_dir():
        return read_pose(file / RESULT, line)
    pose = read_pose(file, line)
    return replace(pose, of_some=True) if file.name in BESIDE and _of_some(file, pose) else pose


def _of_some(file: Path, pose: GivenPose) -> bool:
    """Whether the result beside a pose file is of the same pose, and says so of it."""
    try:
        other = read_pose(file.with_name(RESULT))
    except InvalidFileError:
        return False
    ours, theirs = pose.translation, other.translation
    if not other.of_some or ours is None or theirs is None or not np.array_equal(ours, theirs):
        return False
    apart = np.abs(pose.rotation - other.scaled_within().rotation).max()
    return bool(apart <= ROTATION_TOLERANCE)


def read_pose(path: str | os.PathLike[str], line: int | None = None) -> GivenPose:
    """The pose in a file.

    Text: a matrix 4x4 or 3x4, or a line `w x y z tx ty tz`, TUM or KITTI; numbers with spaces or
    commas between them. .npy: 4x4 or 3x4. JSON: a result of certreg, {"rotation": 3x3,
    "translation": 3}, {"quaternion_wxyz": 4, "translation": 3}, {"T_target_source": 4x4}, a 4x4
    list; or a certificate, which holds a rotation alone.
    line: of a text file with a pose on each line, the one to read, counted from 1.
    Raises InvalidFileError.
    """
    file = Path(path)
    with reading(file) as stream:
        return parse_pose(stream, file) if line is None else parse_line(stream, file, line)


def parse_pose(stream: BinaryIO, file: Path) -> GivenPose:
    """As `read_result_pose`, from a stream; `file` is the name in errors."""
    content = stream.read(MAX_POSE_BYTES + 1)
    source = PoseSource(file)
    if len(content) > MAX_POSE_BYTES:
        if content.lstrip().startswith(b"{"):  # a certificate carries its points
            return pose_of_certificate(source, content + stream.read(FILE_MAX + 1 - len(content)))
        raise source.refusal(
            f"larger than {MAX_POSE_BYTES} bytes: this is not a pose file; of a trajectory, "
            "choose a line with --line N",
            limit=MAX_POSE_BYTES,
        )
    if content.startswith(NPY):
        return of_array(source, parse_array(io.BytesIO(content), file))
    text = content.decode("utf-8-sig", errors="replace")
    if text.lstrip().startswith(("{", "[")):
        return pose_of_json(source, content, text)
    return _pose_of_text(source, text)


def parse_line(stream: BinaryIO, file: Path, line: int) -> GivenPose:
    """The pose on one line of a text file, counted from 1; what follows it is not read."""
    last = 0
    for last, text in enumerate(lines(stream, file), 1):
        if last == line:
            return _pose_of_line(PoseSource(file, line), _words(text))
    message = f"{shown(file)} has {last} lines: --line {line} is none of them"
    raise InvalidFileError(message, path=file, line=line, limit=last)


def _pose_of_text(source: PoseSource, text: str) -> GivenPose:
    places = {n: row for n, line in enumerate(text.splitlines(), 1) if (row := _words(line))}
    rows, sizes = list(places.values()), {len(row) for row in places.values()}
    if len(rows) == 1 and sizes <= set(FORMS):
        return _pose_of_line(source, rows[0])
    if len(sizes) == 1 and sizes <= set(FORMS):
        first, last = min(places), max(places)
        raise source.refusal(
            f"holds {len(rows)} poses, one a line ({FORMS[sizes.pop()]}): choose one with "
            f"--line N, from {first} to {last}",
            value=len(rows),
            limit=1,
        )
    numbers = [_numbers(source, row) for row in rows]
    if [len(row) for row in numbers] == [3, 3, 3]:
        message = "holds a 3x3 matrix: give 3x4 or 4x4, with the translation"
        raise source.refusal(message, value=(3, 3), limit=(4, 4))
    return of_matrix(source, numbers)


def _pose_of_line(source: PoseSource, words: list[str]) -> GivenPose:
    numbers = _numbers(source, words)
    if len(numbers) == 7:
        return of_quaternion(source, numbers[:4], numbers[4:])
    if len(numbers) == 8:
        _, *shift, x, y, z, w = numbers
        return of_quaternion(source, [w, x, y, z], shift)
    if len(numbers) == 12:
        return of_matrix(source, [numbers[:4], numbers[4:8], numbers[8:]])
    forms = ", ".join(f"{size} ({form})" for size, form in FORMS.items())
    message = f"holds {len(numbers)} numbers: a line that is a pose holds {forms}"
    raise source.refusal(message, value=len(numbers), limit=tuple(FORMS))


def _words(line: str) -> list[str]:
    """The words of a line, commas apart; none of a comment."""
    return [] if line.lstrip().startswith("#") else line.replace(",", " ").split()


def _numbers(source: PoseSource, words: list[str]) -> list[float]:
    numbers = list[float]()
    for word in words:
        try:
            numbers.append(float(word))
        except ValueError as error:
            message = f"'{shown(word)}' is not a number: write a 4x4 matrix, or w x y z tx ty tz"
            raise source.refusal(message, value=word) from error
    return numbers
