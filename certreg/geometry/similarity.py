"""Similarity: a motion with a scale, y = s R x + t. `@` composes it, with poses too."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, overload

import numpy as np

from certreg.errors import InvalidProblemError, OutOfRangeError
from certreg.geometry.pose import Pose
from certreg.geometry.pose_matrix import doubles_of, split_matrix, why_no_rotation
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

NO_ENTRY = "every entry of its 3x3 part is 0: scale 0 has no rotation to read"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Similarity(Brief):
    """The motion that takes the source to the target and scales it: `y = scale * R x + t`.

    Similarities compose as their 4x4 matrices do, with each other and with poses, whose scale is 1,
    and move points. One of scale 0 puts every point at `translation` and has no inverse.

    Parameters
    ----------
    rotation
        (3, 3), R, a rotation matrix up to the rounding of its entries, without the scale.
    translation
        (3,), t, in the target's unit.
    quaternion_wxyz
        (4,), of the rotation: unit, scalar first, first nonzero entry positive.
    scale
        s >= 0: target units per source unit.

    Examples
    --------
    >>> import numpy as np
    >>> to_metres = Similarity.from_matrix([[0, -0.5, 0, 5], [0.5, 0, 0, 0], [0, 0, 0.5, 0]])
    >>> to_metres.scale
    0.5
    >>> to_metres @ [4.0, 0.0, 0.0]
    array([5., 2., 0.])
    >>> np.allclose((to_metres.inverse() @ to_metres).as_matrix(), np.eye(4))
    True
    """

    rotation: NDArray[np.float64]
    translation: NDArray[np.float64]
    quaternion_wxyz: NDArray[np.float64]
    scale: float

    __array_ufunc__: ClassVar[None] = None  # `array @ similarity` is a TypeError, as of a pose

    def __repr__(self) -> str:
        numbers = (self.quaternion_wxyz, self.translation)
        turn, shift = (", ".join(f"{x:.6g}" for x in each.tolist()) for each in numbers)
        return (
            f"<Similarity: scale {self.scale:.10g}, quaternion_wxyz ({turn}), "
            f"translation ({shift})>"
        )

    @classmethod
    def from_matrix(cls, matrix: ArrayLike) -> Similarity:
        """The similarity of a homogeneous matrix.

        Parameters
        ----------
        matrix
            (4, 4) with last row 0 0 0 1, or (3, 4): [s R | t]. The scale is the one that is nearest
            to the 3x3 part, tr(R^T M) / 3; what is left may be off a rotation by what five printed
            decimals lose.

        Returns
        -------
        Similarity
            With the translation as it stands.

        Raises
        ------
        InvalidProblemError
            For anything else, a reflection and scale 0 among them.
        """
        stretched, translation = split_matrix(doubles_of(matrix, "matrix"), "matrix")
        scale, turn = split_scale(stretched)
        fault = NO_ENTRY if scale == 0.0 else why_no_rotation(turn)
        if fault is not None:
            raise InvalidProblemError(f"matrix: {fault}", array="matrix", value=stretched.tolist())
        pose = Pose.from_matrix(np.column_stack([turn, translation]))
        return _scaled(pose, scale)

    @classmethod
    def of_pose(cls, pose: Pose, scale: float = 1.0) -> Similarity:
        """A rigid motion as a similarity: y = scale * R x + t.

        Parameters
        ----------
        pose
            R and t.
        scale
            Finite and >= 0.

        Returns
        -------
        Similarity
            With the rotation and the translation as they stand: t is not scaled.

        Raises
        ------
        InvalidProblemError
            For a scale that is negative or not finite.
        """
        if not (math.isfinite(scale) and scale >= 0.0):
            raise InvalidProblemError(
                f"scale is {scale!r}: a similarity has a finite one, >= 0",
                array="scale",
                value=scale,
                limit=0.0,
            )
        return _scaled(pose, float(scale))

    def as_matrix(self) -> NDArray[np.float64]:
        """The homogeneous matrix (4, 4), [s R | t] above 0 0 0 1."""
        matrix = _rigid(self).as_matrix()
        matrix[:3, :3] *= self.scale
        return matrix

    @property
    def T_target_source(self) -> NDArray[np.float64]:
        """The matrix (4, 4) of `as_matrix`: it takes source coordinates to target coordinates."""
        return self.as_matrix()

    def inverse(self) -> Similarity:
        """The similarity x = R^T (y - t) / s, which takes the target back to the source.

        Returns
        -------
        Similarity
            Of scale 1 / s.

        Raises
        ------
        OutOfRangeError
            For a scale of 0, and where a number leaves the doubles.
        """
        if self.scale == 0.0:
            raise OutOfRangeError(
                "a similarity of scale 0 has no inverse: it puts every point at one place",
                value=self.scale,
            )
        back = _rigid(self).inverse()
        with np.errstate(over="ignore"):
            scale, shift = 1.0 / np.float64(self.scale), back.translation / self.scale + 0.0
        turn = Pose(rotation=back.rotation, translation=shift, quaternion_wxyz=back.quaternion_wxyz)
        return _in_range(turn, float(scale))

    def apply(self, points: ArrayLike) -> NDArray[np.float64]:
        """The points moved: each row x becomes s R x + t.

        Parameters
        ----------
        points
            (N, 3), or one point, (3,), in the source's unit.

        Returns
        -------
        NDArray[np.float64]
            Of the same shape; infinite or NaN where they leave the doubles.

        Raises
        ------
        InvalidProblemError
            For other shapes.
        """
        turn = Pose(
            rotation=self.rotation, translation=np.zeros(3), quaternion_wxyz=self.quaternion_wxyz
        )
        with np.errstate(over="ignore", invalid="ignore"):
            return self.scale * turn.apply(points) + self.translation

    @overload
    def __matmul__(self, other: Similarity | Pose) -> Similarity: ...
    @overload
    def __matmul__(self, other: ArrayLike) -> NDArray[np.float64]: ...
    def __matmul__(self, other: Similarity | Pose | ArrayLike) -> Similarity | NDArray[np.float64]:
        """Of a similarity or a pose: the motion that does `other` first. Of points: `apply`."""
        first = _scaled(other, 1.0) if isinstance(other, Pose) else other
        return _product(self, first) if isinstance(first, Similarity) else self.apply(first)

    def __rmatmul__(self, other: Pose) -> Similarity:
        """Of a pose on the left: the similarity first, then the pose."""
        if not isinstance(other, Pose):  # pyright: ignore[reportUnnecessaryIsInstance]
            return NotImplemented  # points stand on the right
        return _product(_scaled(other, 1.0), self)

    def as_scipy(self) -> Any:
        """The rotation alone, as SciPy has it.

        Returns
        -------
        scipy.spatial.transform.Rotation
            Of the same quaternion.

        Raises
        ------
        MissingToolError
            Where SciPy is not installed.
        """
        return _rigid(self).as_scipy()


def split_scale(matrix: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
    """The scale s >= 0 of a matrix (3, 3) near s R, and the matrix over it, which is to be checked.

    With M = U D V^T, D >= 0, and R = U V^T, the mean of D minimises |M - s R| over s: it is
    tr(R^T M) / 3. Zeros have scale 0 and are returned; a scale beyond the doubles is infinite.
    """
    largest = float(np.abs(matrix).max())
    if largest == 0.0:
        return 0.0, matrix
    _, exponent = math.frexp(largest)  # so that nothing overflows or is lost
    near = np.ldexp(np.ldexp(matrix, -(exponent // 2)), -(exponent - exponent // 2))
    mean = float(np.linalg.svd(near, compute_uv=False).mean())
    with np.errstate(over="ignore"):
        scale = float(np.ldexp(mean, exponent))
    return scale, near / mean


def _product(second: Similarity, first: Similarity) -> Similarity:
    """The rotations as poses multiply them: s2 R2 (s1 R1 x + t1) + t2."""
    with np.errstate(over="ignore", invalid="ignore"):
        shift = second.scale * first.translation
        scale = float(np.multiply(second.scale, first.scale))
    moved = Pose(rotation=first.rotation, translation=shift, quaternion_wxyz=first.quaternion_wxyz)
    if scale == 0.0 < min(second.scale, first.scale):
        raise OutOfRangeError(_beyond("scale"), value=scale)
    return _in_range(_rigid(second) @ moved, scale)


def _in_range(pose: Pose, scale: float) -> Similarity:
    if not math.isfinite(scale):
        raise OutOfRangeError(_beyond("scale"), value=scale)
    if not np.isfinite(pose.translation).all():
        raise OutOfRangeError(_beyond("translation"), value=pose.translation.tolist())
    return _scaled(pose, scale)


def _beyond(name: str) -> str:
    return f"the {name} of the similarity exceeds the range of doubles: change the unit"


def _scaled(pose: Pose, scale: float) -> Similarity:
    return Similarity(
        rotation=pose.rotation,
        translation=pose.translation,
        quaternion_wxyz=pose.quaternion_wxyz,
        scale=scale,
    )


def _rigid(motion: Similarity) -> Pose:
    """Its rotation and its translation, without the scale."""
    return Pose(
        rotation=motion.rotation,
        translation=motion.translation,
        quaternion_wxyz=motion.quaternion_wxyz,
    )
