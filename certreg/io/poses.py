"""Poses from files, as tools write them: text, .npy, JSON. They are read here, judged elsewhere."""

from __future__ import annotations

import io
import json
import math
import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from certreg.errors import InvalidFileError
from certreg.geometry.given import GivenPose
from certreg.geometry.pose_matrix import ROTATION_TOLERANCE, last_row_fault
from certreg.io.npy import parse_array
from certreg.io.streams import Place, lines, reading
from certreg.verify import FILE_MAX, FORMAT, RefusalError, parse, shown

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.results import Json

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
    source = Place(file)
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
            return _pose_of_line(Place(file, line), _words(text))
    raise InvalidFileError(
        f"{shown(file)} has {last} lines: --line {line} is none of them",
        path=file,
        line=line,
        limit=last,
    )


def _pose_of_text(source: Place, text: str) -> GivenPose:
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
        raise source.refusal(
            "holds a 3x3 matrix: give 3x4 or 4x4, with the translation", value=(3, 3), limit=(4, 4)
        )
    return of_matrix(source, numbers)


def _pose_of_line(source: Place, words: list[str]) -> GivenPose:
    numbers = _numbers(source, words)
    if len(numbers) == 7:
        return of_quaternion(source, numbers[:4], numbers[4:])
    if len(numbers) == 8:
        _, *shift, x, y, z, w = numbers
        return of_quaternion(source, [w, x, y, z], shift)
    if len(numbers) == 12:
        return of_matrix(source, [numbers[:4], numbers[4:8], numbers[8:]])
    forms = ", ".join(f"{size} ({form})" for size, form in FORMS.items())
    raise source.refusal(
        f"holds {len(numbers)} numbers: a line that is a pose holds {forms}",
        value=len(numbers),
        limit=tuple(FORMS),
    )


def _words(line: str) -> list[str]:
    """The words of a line, commas apart; none of a comment."""
    return [] if line.lstrip().startswith("#") else line.replace(",", " ").split()


def _numbers(source: Place, words: list[str]) -> list[float]:
    numbers = list[float]()
    for word in words:
        try:
            numbers.append(float(word))
        except ValueError as error:
            raise source.refusal(
                f"'{shown(word)}' is not a number: write a 4x4 matrix, or w x y z tx ty tz",
                value=word,
            ) from error
    return numbers


QUATERNION = 4  # entries
BOUNDED = "consensus", "truncated"  # what only results of pairs with bounds hold
SCALE = 64  # bits: the root of the norm is then right beyond a double


def pose_of_json(source: Place, content: bytes, text: str) -> GivenPose:
    """The pose in a document; content: the bytes of the text, of which certificates are parsed."""
    try:
        document: list[Any] | dict[str, Any] = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise source.refusal(
            f"is not JSON ({shown(error)}): give a pose file or a certreg result"
        ) from error
    if isinstance(document, list):
        return of_matrix(source, document)
    fields = document
    if fields.get("format") == FORMAT:
        return pose_of_certificate(source, content)
    some = any(isinstance(fields.get(name), dict) for name in BOUNDED)
    if isinstance(fields.get("pose"), dict):
        fields = fields["pose"]
    if "T_target_source" in fields:
        return replace(of_matrix(source, fields["T_target_source"]), of_some=some)
    if not {"rotation", "quaternion_wxyz"} & set(fields) or "translation" not in fields:
        raise source.refusal("holds no pose (T_target_source, or rotation and translation)")
    return replace(_pose_of_fields(source, fields), of_some=some)


def pose_of_certificate(source: Place, content: bytes) -> GivenPose:
    """The rotation that a certificate is about, rounded to doubles; nothing in it is believed.

    The file holds no translation: it is the best one for the points that it is about.
    """
    try:
        statement = parse(content)
    except RefusalError as error:
        raise source.refusal(
            f"is neither a pose file nor a well-formed certificate ({shown(error)})"
        ) from error
    q = getattr(statement, "pose", None) or _pose_of_fit(getattr(statement, "fit", None))
    if not any(q):  # that of a count holds none
        raise source.refusal("is a certificate that holds no pose: give a pose or a result")
    norm = math.isqrt(sum(entry * entry for entry in q) << 2 * SCALE)
    turn = np.array([(entry << SCALE) / norm for entry in q])
    some = statement.model.endswith(("--max-residual", "--objective truncated"))
    return GivenPose(turn=turn, translation=None, of_some=some)


def _pose_of_fit(fit: Json) -> tuple[int, ...]:
    """Of the least squares that a certificate of wrong pairs holds, as nobody has checked it."""
    proof: Json = fit.get("proof", fit) if isinstance(fit, dict) else None
    pose: Json = proof.get("pose") if isinstance(proof, dict) else None
    entries = pose if isinstance(pose, list) else []
    right = len(entries) == QUATERNION and all(type(entry) is int for entry in entries)
    return tuple(entries) if right else (0,)


def _pose_of_fields(source: Place, fields: dict[str, Any]) -> GivenPose:
    """Rotation, quaternion or both, which must agree, and a translation."""
    translation = finite_array(source, fields["translation"], (3,), "translation")
    matrix = None
    if "rotation" in fields:
        matrix = finite_array(source, fields["rotation"], (3, 3), "rotation")
    scale = _scale(source, fields.get("scale"))
    if matrix is not None and "quaternion_wxyz" not in fields:
        return GivenPose(turn=matrix, translation=translation, scale=scale)
    quaternion = finite_array(source, fields["quaternion_wxyz"], (4,), "quaternion_wxyz")
    pose = of_quaternion(source, quaternion, translation)
    apart = 0.0 if matrix is None else float(np.abs(matrix - pose.rotation).max())
    if apart > ROTATION_TOLERANCE:
        raise source.refusal(
            "rotation and quaternion_wxyz are two different rotations: keep one",
            column="quaternion_wxyz",
            value=apart,
            limit=ROTATION_TOLERANCE,
        )
    return replace(pose, scale=scale)


def _scale(source: Place, value: Any) -> float | None:
    """Of y = s R x + t; None where there is none, as in the result of a rigid problem."""
    if value is None:
        return None
    scale = float(finite_array(source, value, (), "scale"))
    if scale <= 0.0:
        raise source.refusal(
            f"scale is {scale!r}: that of a similarity is > 0",
            column="scale",
            value=scale,
            limit=0.0,
        )
    return scale


def finite_array(
    source: Place, values: Any, shape: tuple[int, ...], name: str
) -> NDArray[np.float64]:
    """The values as finite doubles of a shape. Raises InvalidFileError."""
    try:
        array = np.asarray(values, dtype=np.float64)
    except (ValueError, TypeError, OverflowError) as error:
        raise source.refusal(f"{name} is not an array of numbers", column=name) from error
    if array.shape != shape or not np.isfinite(array).all():
        raise source.refusal(
            f"{name} must be {shape} finite numbers, found shape {array.shape}",
            column=name,
            value=array.shape,
            limit=shape,
        )
    return array


def of_quaternion(source: Place, quaternion: Any, translation: Any) -> GivenPose:
    """The pose of w x y z, which must be a unit quaternion, and a translation."""
    shift = finite_array(source, translation, (3,), "translation")
    q = np.array(quaternion, dtype=np.float64)
    norm = math.hypot(*q.tolist())  # infinite beyond the doubles, without a warning
    if not abs(norm - 1.0) <= ROTATION_TOLERANCE:
        raise source.refusal(
            f"the quaternion has norm {norm:.6g}, not 1: write unit w x y z, scalar first",
            column="quaternion_wxyz",
            value=norm,
            limit=1.0,
        )
    return GivenPose(turn=q, translation=shift)


def of_array(source: Place, array: NDArray[np.float64]) -> GivenPose:
    """The pose of an array (4, 4) or (3, 4)."""
    if array.shape not in {(4, 4), (3, 4)}:
        stack = array.ndim == 3 and array.shape[1:] in {(4, 4), (3, 4)}
        remedy = f"a stack of {len(array)}: save one of them" if stack else "save [R | t]"
        raise source.refusal(
            f"holds an array {array.shape}, a pose is (4, 4) or (3, 4): {remedy}",
            value=array.shape,
            limit=(4, 4),
        )
    return of_matrix(source, array.tolist())


def of_matrix(source: Place, rows: Json) -> GivenPose:
    """The pose of a matrix 4x4 or 3x4; the rotation is not checked."""
    if isinstance(rows, list) and len(rows) == 3:
        rows = [*rows, [0.0, 0.0, 0.0, 1.0]]
    matrix = finite_array(source, rows, (4, 4), "the pose matrix")
    if matrix[3].tolist() != [0.0, 0.0, 0.0, 1.0]:
        raise source.refusal(last_row_fault(matrix), row=3, value=matrix[3].tolist())
    return GivenPose(turn=matrix[:3, :3], translation=matrix[:3, 3])
