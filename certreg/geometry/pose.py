"""Pose: a rigid motion y = R x + t. Poses form a group: `@` composes them, `inverse` undoes one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, overload

import numpy as np

from certreg._loading import library
from certreg.errors import InvalidProblemError, OutOfRangeError
from certreg.geometry.pose_matrix import (
    UNNOTED_DEFECT,
    doubles_of,
    rotation_defect,
    split_matrix,
    why_no_rotation,
)
from certreg.geometry.so3 import body_frame, canonical, quaternion_from_matrix, rotation_matrix
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pose(Brief):
    """The motion that takes the source to the target: `y = rotation @ x + translation`.

    Poses compose as their 4x4 matrices do, and move points.

    Parameters
    ----------
    rotation
        (3, 3), a rotation matrix up to the rounding of its entries.
    translation
        (3,), in the user's unit.
    quaternion_wxyz
        (4,), unit, scalar first, first nonzero entry positive.

    Examples
    --------
    >>> import numpy as np
    >>> turn = Pose.from_matrix([[0, -1, 0, 5], [1, 0, 0, 0], [0, 0, 1, 0]])
    >>> turn @ [1.0, 0.0, 0.0]
    array([5., 1., 0.])
    >>> np.array_equal((turn.inverse() @ turn).as_matrix(), np.eye(4))
    True
    """

    rotation: NDArray[np.float64]
    translation: NDArray[np.float64]
    quaternion_wxyz: NDArray[np.float64]

    scale: ClassVar[float] = 1.0  # target units per source unit, as of a `Similarity`

    __array_ufunc__: ClassVar[None] = None  # `array @ pose` is a TypeError, no array of objects

    def __repr__(self) -> str:
        numbers = (self.quaternion_wxyz, self.translation)
        turn, shift = (", ".join(f"{x:.6g}" for x in each.tolist()) for each in numbers)
        return f"<Pose: quaternion_wxyz ({turn}), translation ({shift})>"

    @classmethod
    def from_matrix(cls, matrix: ArrayLike) -> Pose:
        """The pose of a homogeneous matrix.

        Parameters
        ----------
        matrix
            (4, 4) with last row 0 0 0 1, or (3, 4): [R | t]. R may be off a rotation by what five
            printed decimals lose; off by more than the rounding of doubles, the nearest rotation is
            taken.

        Returns
        -------
        Pose
            With the translation as it stands.

        Raises
        ------
        InvalidProblemError
            For anything else.
        """
        rotation, translation = split_matrix(doubles_of(matrix, "matrix"), "matrix")
        fault = why_no_rotation(rotation)
        if fault is not None:
            raise InvalidProblemError(f"matrix: {fault}", array="matrix", value=rotation.tolist())
        quaternion = quaternion_from_matrix(rotation)
        if rotation_defect(rotation) > UNNOTED_DEFECT:
            return _posed(quaternion, translation)
        return cls(rotation=rotation, translation=translation, quaternion_wxyz=quaternion)

    def as_matrix(self) -> NDArray[np.float64]:
        """The homogeneous matrix (4, 4), [R | t] above 0 0 0 1."""
        matrix = np.eye(4)
        matrix[:3, :3] = self.rotation
        matrix[:3, 3] = self.translation
        return matrix

    @property
    def T_target_source(self) -> NDArray[np.float64]:
        """The matrix (4, 4) of `as_matrix`: it takes source coordinates to target coordinates."""
        return self.as_matrix()

    def inverse(self) -> Pose:
        """The pose x = R^T (y - t), which takes the target back to the source."""
        w, *axial = self.quaternion_wxyz.tolist()
        with np.errstate(over="ignore", invalid="ignore"):
            shift = -(self.rotation.T @ self.translation)
        return Pose(
            rotation=self.rotation.T.copy(),
            translation=_finite(shift),
            quaternion_wxyz=canonical(np.array([w, *(-entry for entry in axial)])),
        )

    def apply(self, points: ArrayLike) -> NDArray[np.float64]:
        """The points moved: each row x becomes R x + t.

        Parameters
        ----------
        points
            (N, 3), or one point, (3,).

        Returns
        -------
        NDArray[np.float64]
            Of the same shape; infinite or NaN where they leave the doubles.

        Raises
        ------
        InvalidProblemError
            For other shapes.
        """
        given = doubles_of(points, "points")
        if given.ndim not in {1, 2} or given.shape[-1] != 3:
            raise InvalidProblemError(
                f"points must be (N, 3), or (3,) for one point, found shape {given.shape}",
                array="points",
                value=given.shape,
                limit=(3,),
            )
        with np.errstate(over="ignore", invalid="ignore"):
            return given @ self.rotation.T + self.translation

    @overload
    def __matmul__(self, other: Pose) -> Pose: ...
    @overload
    def __matmul__(self, other: ArrayLike) -> NDArray[np.float64]: ...
    def __matmul__(self, other: Pose | ArrayLike) -> Pose | NDArray[np.float64]:
        """Of a pose: the motion that does `other` first. Of points (N, 3) or (3,): `apply`.

        The rotation of the product is made from the unit quaternion, so that it does not drift from
        the rotations, however many are multiplied.
        """
        if not isinstance(other, Pose):
            # a record is no array of points: a Similarity multiplies from the right by itself
            return NotImplemented if isinstance(other, Brief) else self.apply(other)
        q, (w, *axial) = self.quaternion_wxyz, other.quaternion_wxyz.tolist()
        product = w * q + np.array(body_frame(q.tolist())) @ np.array(axial)
        with np.errstate(over="ignore", invalid="ignore"):
            shift = self.rotation @ other.translation + self.translation
        return _posed(product / np.linalg.norm(product), _finite(shift))

    def as_scipy(self) -> Any:
        """The rotation, as SciPy has it.

        Returns
        -------
        scipy.spatial.transform.Rotation
            Of the same quaternion.

        Raises
        ------
        MissingToolError
            Where SciPy is not installed.
        """
        Rotation = library("scipy.spatial.transform", "as_scipy").Rotation

        return Rotation.from_quat(self.quaternion_wxyz, scalar_first=True)


def _posed(quaternion: NDArray[np.float64], translation: NDArray[np.float64]) -> Pose:
    q = canonical(quaternion)
    rotation = np.array(rotation_matrix(q.tolist()))
    return Pose(rotation=rotation, translation=translation, quaternion_wxyz=q)


def _finite(translation: NDArray[np.float64]) -> NDArray[np.float64]:
    if not np.isfinite(translation).all():
        raise OutOfRangeError(
            "the translation of the pose exceeds the range of doubles: change the unit",
            value=translation.tolist(),
        )
    return translation + 0.0  # no -0.0
