"""The numbers of a pose in a file, checked: finite, of the right shape, the last row of a 4x4."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from certreg.errors import InvalidFileError
from certreg.geometry.given import GivenPose
from certreg.geometry.orthogonality import ROTATION_TOLERANCE
from certreg.geometry.pose_matrix import last_row_fault
from certreg.verify import shown

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray


class PoseSource(NamedTuple):
    """The file, and the line of it, from 1, where a pose is not the whole file."""

    file: Path
    line: int | None = None

    def refusal(self, words: str, **evidence: Any) -> InvalidFileError:
        """The error that says what is wrong here."""
        line = "" if self.line is None else f", line {self.line}"
        message = f"{shown(self.file)}{line}: {words}"
        return InvalidFileError(message, path=self.file, line=self.line, **evidence)


def finite_array(
    source: PoseSource, values: Any, shape: tuple[int, ...], name: str
) -> NDArray[np.float64]:
    """The values as finite doubles of a shape. Raises InvalidFileError."""
    try:
        array = np.asarray(values, dtype=np.float64)
    except (ValueError, TypeError, OverflowError) as error:
        raise source.refusal(f"{name} is not an array of numbers", column=name) from error
    if array.shape != shape or not np.isfinite(array).all():
        message = f"{name} must be {shape} finite numbers, found shape {array.shape}"
        raise source.refusal(message, column=name, value=array.shape, limit=shape)
    return array


def of_quaternion(source: PoseSource, quaternion: Any, translation: Any) -> GivenPose:
    """The pose of w x y z, which must be a unit quaternion, and a translation."""
    shift = finite_array(source, translation, (3,), "translation")
    q = np.array(quaternion, dtype=np.float64)
    norm = math.hypot(*q.tolist())  # infinite beyond the doubles, without a warning
    if not abs(norm - 1.0) <= ROTATION_TOLERANCE:
        message = f"the quaternion has norm {norm:.6g}, not 1: write unit w x y z, scalar first"
        raise source.refusal(message, column="quaternion_wxyz", value=norm, limit=1.0)
    return GivenPose(turn=q, translation=shift)


def of_array(source: PoseSource, array: NDArray[np.float64]) -> GivenPose:
    """The pose of an array (4, 4) or (3, 4)."""
    if array.shape not in {(4, 4), (3, 4)}:
        stack = array.ndim == 3 and array.shape[1:] in {(4, 4), (3, 4)}
        remedy = f"a stack of {len(array)}: save one of them" if stack else "save [R | t]"
        message = f"holds an array {array.shape}, a pose is (4, 4) or (3, 4): {remedy}"
        raise source.refusal(message, value=array.shape, limit=(4, 4))
    return of_matrix(source, array.tolist())


def of_matrix(source: PoseSource, rows: Any) -> GivenPose:
    """The pose of a matrix 4x4 or 3x4; the rotation is not checked."""
    if isinstance(rows, list) and len(cast("list[Any]", rows)) == 3:
        rows = [*rows, [0.0, 0.0, 0.0, 1.0]]
    matrix = finite_array(source, rows, (4, 4), "the pose matrix")
    if matrix[3].tolist() != [0.0, 0.0, 0.0, 1.0]:
        raise source.refusal(last_row_fault(matrix), row=3, value=matrix[3].tolist())
    return GivenPose(turn=matrix[:3, :3], translation=matrix[:3, 3])
