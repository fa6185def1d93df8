"""Poses from files, as other tools write them. They are read here and judged elsewhere."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, cast

import numpy as np

from certreg.errors import InvalidFileError
from certreg.geometry import rotation_matrix
from certreg.io.streams import reading
from certreg.verify import shown

if TYPE_CHECKING:
    import os

    from numpy.typing import NDArray

MAX_POSE_BYTES = 1 << 20  # a result without its points is a few kilobytes
ROTATION_TOLERANCE = 1e-4  # |R^T R - I|: admits 4x4 matrices printed with five decimals


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GivenPose:
    """A pose as some tool wrote it: rotation (3, 3), unchecked, and translation (3,).

    quaternion: (4,), where the file has one; then `rotation` is made from it.
    """

    rotation: NDArray[np.float64]
    translation: NDArray[np.float64]
    quaternion: NDArray[np.float64] | None = None

    @property
    def turn(self) -> NDArray[np.float64]:
        """What to judge: the quaternion where there is one, as no digit of it is lost, else R."""
        return self.rotation if self.quaternion is None else self.quaternion

    def apply(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """The moved points (N, 3); infinite or NaN where they leave the doubles."""
        with np.errstate(over="ignore", invalid="ignore"):
            return points @ self.rotation.T + self.translation


def read_pose(path: str | os.PathLike[str]) -> GivenPose:
    """A pose from text (4x4 or 3x4 matrix, or w x y z tx ty tz) or JSON.

    JSON: a result of certreg, {"rotation": 3x3, "translation": 3}, {"quaternion_wxyz": 4,
    "translation": 3}, {"T_target_source": 4x4} or a 4x4 list. Raises InvalidFileError.
    """
    file = Path(path)
    with reading(file) as stream:
        return parse_pose(stream, file)


def parse_pose(stream: BinaryIO, file: Path) -> GivenPose:
    """As `read_pose`, from a stream; `file` is the name in errors."""
    text = _bounded(stream, file).decode("utf-8-sig", errors="replace").strip()
    if text.startswith(("{", "[")):
        return _pose_from_json(file, text)
    lines = [line for line in text.splitlines() if not line.lstrip().startswith("#")]
    rows = [line.replace(",", " ").split() for line in lines]
    try:
        numbers = [[float(entry) for entry in row] for row in rows if row]
    except ValueError as error:
        message = f"{file}: {shown(error)}: write a 4x4 matrix, or w x y z tx ty tz"
        raise InvalidFileError(message, path=file) from error
    if [len(row) for row in numbers] == [3, 3, 3]:
        message = f"{file}: holds a 3x3 matrix: give 3x4 or 4x4, with the translation"
        raise InvalidFileError(message, path=file, value=(3, 3), limit=(4, 4))
    if [len(row) for row in numbers] == [7]:
        return _from_quaternion(file, np.array(numbers[0][:4]), np.array(numbers[0][4:]))
    return _from_matrix(file, numbers)


def read_result_pose(path: str | os.PathLike[str]) -> GivenPose:
    """The pose in a result of certreg (the file or its folder), or in a pose file."""
    file = Path(path)
    return read_pose(file / "result.json" if file.is_dir() else file)


def _bounded(stream: BinaryIO, file: Path) -> bytes:
    content = stream.read(MAX_POSE_BYTES + 1)
    if len(content) > MAX_POSE_BYTES:
        message = f"{file}: larger than {MAX_POSE_BYTES} bytes: this is not a pose file"
        raise InvalidFileError(message, path=file, limit=MAX_POSE_BYTES)
    return content


def _pose_from_json(file: Path, text: str) -> GivenPose:
    try:
        document: Any = json.loads(text)
    except (ValueError, RecursionError) as error:
        message = f"{file}: is not JSON ({shown(error)}): give a pose file or a certreg result"
        raise InvalidFileError(message, path=file) from error
    if isinstance(document, list):
        return _from_matrix(file, document)
    fields = cast("dict[str, Any]", document)
    if isinstance(fields.get("pose"), dict):
        fields = fields["pose"]
    if "T_target_source" in fields:
        return _from_matrix(file, fields["T_target_source"])
    if not {"rotation", "quaternion_wxyz"} & set(fields) or "translation" not in fields:
        message = f"{file}: holds no pose (T_target_source, or rotation and translation)"
        raise InvalidFileError(message, path=file)
    translation = _array(file, fields["translation"], (3,), "translation")
    given = None
    if "rotation" in fields:
        rotation = _array(file, fields["rotation"], (3, 3), "rotation")
        given = GivenPose(rotation=rotation, translation=translation)
    if "quaternion_wxyz" not in fields:
        return cast("GivenPose", given)
    quaternion = _array(file, fields["quaternion_wxyz"], (4,), "quaternion_wxyz")
    pose = _from_quaternion(file, quaternion, translation)
    apart = 0.0 if given is None else float(np.abs(given.rotation - pose.rotation).max())
    if apart > ROTATION_TOLERANCE:
        message = f"{file}: rotation and quaternion_wxyz are two different rotations: keep one"
        raise InvalidFileError(
            message, path=file, column="quaternion_wxyz", value=apart, limit=ROTATION_TOLERANCE
        )
    return pose


def _array(file: Path, values: Any, shape: tuple[int, ...], name: str) -> NDArray[np.float64]:
    try:
        array = np.asarray(values, dtype=np.float64)
    except (ValueError, TypeError, OverflowError) as error:
        message = f"{file}: {name} is not an array of numbers"
        raise InvalidFileError(message, path=file, column=name) from error
    if array.shape != shape or not np.isfinite(array).all():
        message = f"{file}: {name} must be {shape} finite numbers, found shape {array.shape}"
        raise InvalidFileError(message, path=file, column=name, value=array.shape, limit=shape)
    return array


def _from_quaternion(
    file: Path, quaternion: NDArray[np.float64], translation: NDArray[np.float64]
) -> GivenPose:
    norm = math.hypot(*quaternion.tolist())  # infinite beyond the doubles, without a warning
    if not abs(norm - 1.0) <= ROTATION_TOLERANCE:
        message = (
            f"{file}: the quaternion has norm {norm:.6g}, not 1: write unit w x y z, scalar first"
        )
        raise InvalidFileError(message, path=file, column="quaternion_wxyz", value=norm, limit=1.0)
    rotation = np.array(rotation_matrix((quaternion / norm).tolist()))
    shift = _array(file, translation, (3,), "translation")
    return GivenPose(rotation=rotation, translation=shift, quaternion=quaternion)


def _from_matrix(file: Path, rows: Any) -> GivenPose:
    if isinstance(rows, list) and len(cast("list[Any]", rows)) == 3:
        rows = [*rows, [0.0, 0.0, 0.0, 1.0]]
    matrix = _array(file, rows, (4, 4), "the pose matrix")
    if not np.array_equal(matrix[3], [0.0, 0.0, 0.0, 1.0]):
        row = " ".join(f"{entry:.6g}" for entry in matrix[3].tolist())
        transposed = np.array_equal(matrix[:, 3], [0.0, 0.0, 0.0, 1.0])
        remedy = "transpose it" if transposed else "give the 3x4 matrix [R | t], or mend that row"
        message = f"{file}: the last row of the pose matrix must be 0 0 0 1, found {row}: {remedy}"
        raise InvalidFileError(message, path=file, row=3, value=matrix[3].tolist())
    return GivenPose(rotation=matrix[:3, :3], translation=matrix[:3, 3])
