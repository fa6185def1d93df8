"""A pose as any other tool returned it: read here without importing the tool, judged elsewhere."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from certreg.errors import InvalidProblemError
from certreg.geometry.pose import Pose
from certreg.geometry.pose_matrix import doubles_of, split_matrix
from certreg.geometry.similarity import Similarity, split_scale
from certreg.geometry.so3 import rotation_matrix
from certreg.verify import shown

if TYPE_CHECKING:
    from numpy.typing import NDArray

ATTRIBUTES = (  # a method or an array, in this order
    "T_target_source",
    "transformation",  # Open3D's result
    "as_matrix",  # SciPy, jaxlie
    "matrix",  # Sophus, GTSAM, pycolmap
    "params",  # scikit-image
)
NUMBERS = ("__array__", "__array_interface__", "__len__", "__float__")  # one of them, if any
ROTATIONS = {(3, 3), (4,)}
VECTORS = {(3,), (3, 1), (1, 3)}  # a column, as OpenCV has it
FORMS = (
    "give a matrix (4, 4) or (3, 4), (R, t), (R, t, s), a rotation (3, 3), a quaternion (4,) with "
    "the scalar first, or an object with .as_matrix() or with .rotation and .translation"
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GivenPose:
    """A pose as some tool wrote it, unchecked.

    turn: the rotation as it was written: a matrix (3, 3), or a quaternion (4,), scalar first.
    translation: (3,); None where only a rotation was given.
    scale: of y = s R x + t, > 0, where it was written apart; None where it was not: a matrix may
        hold it.
    of_some: whether the file says that the pose was fitted to some of the pairs only, the others
        being wrong.
    """

    turn: NDArray[np.float64]
    translation: NDArray[np.float64] | None
    scale: float | None = None
    of_some: bool = False

    @property
    def is_matrix(self) -> bool:
        """Whether the rotation was written as a matrix."""
        return self.turn.shape == (3, 3)

    @property
    def rotation(self) -> NDArray[np.float64]:
        """The matrix (3, 3), as it was written or of the quaternion, normalised."""
        if self.is_matrix:
            return self.turn
        q = self.turn / math.hypot(*self.turn.tolist())
        return np.array(rotation_matrix(q.tolist()))

    def apply(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """The moved points (N, 3); infinite or NaN where they leave the doubles."""
        shift = np.zeros(3) if self.translation is None else self.translation
        with np.errstate(over="ignore", invalid="ignore"):
            moved = points @ self.rotation.T
            return (moved if self.scale is None else self.scale * moved) + shift

    def scaled_apart(self) -> GivenPose:
        """The same motion with its scale apart from a matrix near s R, which is not checked."""
        if not self.is_matrix:
            return self if self.scale is not None else replace(self, scale=1.0)
        held, turn = split_scale(self.turn)
        return replace(self, turn=turn, scale=held * (1.0 if self.scale is None else self.scale))

    def scaled_within(self) -> GivenPose:
        """The same motion as one matrix s R, where a scale other than 1 was written apart."""
        if self.scale is None or self.scale == 1.0:
            return replace(self, scale=None)
        with np.errstate(over="ignore"):
            return replace(self, turn=self.scale * self.rotation, scale=None)


def given_pose(pose: Any, translation: Any = None) -> GivenPose:
    """What a tool returned, as arrays; its rotation need not be one.

    pose: a matrix (4, 4) or (3, 4); a rotation, as a matrix (3, 3) or a quaternion (4,) with the
        scalar first; a pair (R, t), or (R, t, s) of y = s R x + t, as evo has it; a `Pose` or
        `Similarity`, or what has one as `.pose`; anything with `.T_target_source`,
        `.transformation`, `.as_matrix`, `.matrix` or `.params`, a method or an array; or with
        `.rotation` and `.translation`, as KISS-Matcher has it.
    translation: (3,), a column or a row, beside a rotation alone.
    Raises InvalidProblemError for anything else, and for values that are not finite.
    """
    held = (pose, getattr(pose, "pose", None))
    own = next((one for one in held if isinstance(one, Pose | Similarity)), None)
    if own is not None:
        scale = None if isinstance(own, Pose) else own.scale
        given = GivenPose(turn=own.quaternion_wxyz, translation=own.translation, scale=scale)
    elif len(parts := _parts(pose)) == 2:
        given = given_pose(*parts)
    elif len(parts) == 3 and np.ndim(parts[0]) > 0 and np.ndim(parts[2]) == 0:  # else 3 rows
        given = replace(given_pose(*parts[:2]), scale=_scale(parts[2]))
    elif (own_parts := _attributed(pose)) is not None:
        given = given_pose(*own_parts)
    else:
        given = _from_array(pose)
    if translation is None:
        return given
    if given.translation is not None:
        raise InvalidProblemError(
            "the pose has a translation of its own: give no other beside it", array="translation"
        )
    return replace(given, translation=_vector(translation))


def _from_array(pose: Any) -> GivenPose:
    if isinstance(pose, str | bytes | Path):
        raise InvalidProblemError(
            f"pose is a path or a text, {shown(pose)}: give what is in the file, of a matrix in "
            "text np.loadtxt(path); the command reads pose files itself: certreg assess --pose",
            array="pose",
            value=pose,
        )
    name, values = _values(pose)
    if isinstance(values, type) or not any(hasattr(values, each) for each in NUMBERS):
        raise InvalidProblemError(
            f"{name} is of type {shown(type(values).__name__)}: {FORMS}", array=name, value=values
        )
    array = doubles_of(values, name)
    if array.shape in ROTATIONS:
        return GivenPose(turn=_finite(array, "rotation"), translation=None)
    if array.ndim == 2 and array.shape[1] == 4 and len(array) in {3, 4}:
        rotation, shift = split_matrix(array, name)
        return GivenPose(turn=rotation, translation=shift)
    stack = array.ndim == 3 and array.shape[1:] in {(4, 4), (3, 4), (3, 3)}
    remedy = f"a stack of {len(array)} poses: give one of them" if stack else FORMS
    raise InvalidProblemError(
        f"{name} has shape {array.shape}: {remedy}", array=name, value=array.shape
    )


def _values(pose: Any) -> tuple[str, Any]:
    """The numbers of a pose, and what to call them in an error."""
    for name in () if _is_plain(pose) else ATTRIBUTES:
        value = getattr(pose, name, None)
        if value is not None:
            return f"pose.{name}", value() if callable(value) else value
    return "pose", pose


def _attributed(pose: object) -> tuple[Any, Any] | None:
    """Rotation and translation of an object that has them as attributes and no whole matrix."""
    if _is_plain(pose) or any(getattr(pose, name, None) is not None for name in ATTRIBUTES):
        return None
    parts = getattr(pose, "rotation", None), getattr(pose, "translation", None)
    return None if any(part is None or callable(part) for part in parts) else parts


def _parts(pose: object) -> Sequence[Any]:
    """Of a tuple or a list what is in it; of all else nothing."""
    return cast("Sequence[Any]", pose) if isinstance(pose, tuple | list) else ()


def _scale(value: Any) -> float:
    scale = float(doubles_of(value, "scale"))
    if not (math.isfinite(scale) and scale > 0.0):
        raise InvalidProblemError(
            f"scale is {scale!r}: that of a similarity is finite and > 0",
            array="scale",
            value=scale,
            limit=0.0,
        )
    return scale


def _is_plain(pose: object) -> bool:
    """Whether its attributes say nothing: an array, or a class in place of a pose."""
    return isinstance(pose, np.ndarray | type)


def _vector(values: Any) -> NDArray[np.float64]:
    array = doubles_of(values, "translation")
    if array.shape not in VECTORS:
        raise InvalidProblemError(
            f"translation must be (3,) finite numbers, found shape {array.shape}",
            array="translation",
            value=array.shape,
            limit=(3,),
        )
    return _finite(array.ravel(), "translation")


def _finite(array: NDArray[np.float64], name: str) -> NDArray[np.float64]:
    if not np.isfinite(array).all():
        raise InvalidProblemError(
            f"{name} must be finite numbers, found {array.tolist()}",
            array=name,
            value=array.tolist(),
        )
    return array
