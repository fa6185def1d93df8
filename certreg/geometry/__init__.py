"""Rotations, poses and the quadratic constraints that make a matrix a rotation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._faces import lazy_face

if TYPE_CHECKING:
    from certreg.geometry.pose import Pose as Pose
    from certreg.geometry.so3 import Matrix3 as Matrix3
    from certreg.geometry.so3 import T as T
    from certreg.geometry.so3 import Vector3 as Vector3
    from certreg.geometry.so3 import body_frame as body_frame
    from certreg.geometry.so3 import canonical as canonical
    from certreg.geometry.so3 import davenport_matrix as davenport_matrix
    from certreg.geometry.so3 import dot as dot
    from certreg.geometry.so3 import quadratic_form as quadratic_form
    from certreg.geometry.so3 import quaternion_from_matrix as quaternion_from_matrix
    from certreg.geometry.so3 import rotation_matrix as rotation_matrix
    from certreg.geometry.so3 import squared_norm as squared_norm

__getattr__ = lazy_face(
    __name__,
    {
        "pose": ("Pose",),
        "so3": (
            "Matrix3",
            "T",
            "Vector3",
            "body_frame",
            "canonical",
            "davenport_matrix",
            "dot",
            "quadratic_form",
            "quaternion_from_matrix",
            "rotation_matrix",
            "squared_norm",
        ),
    },
)
