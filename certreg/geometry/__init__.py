"""Rotations, poses and the quadratic constraints that make a matrix a rotation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._loading import lazy_face

if TYPE_CHECKING:
    from certreg.geometry.constraints import ROTATION_SIZE as ROTATION_SIZE
    from certreg.geometry.constraints import SquareMatrix as SquareMatrix
    from certreg.geometry.constraints import homogeneous as homogeneous
    from certreg.geometry.constraints import rotation_quadratics as rotation_quadratics
    from certreg.geometry.constraints import symmetric as symmetric
    from certreg.geometry.given import GivenPose as GivenPose
    from certreg.geometry.given import given_pose as given_pose
    from certreg.geometry.orthogonality import ROTATION_TOLERANCE as ROTATION_TOLERANCE
    from certreg.geometry.orthogonality import UNNOTED_DEFECT as UNNOTED_DEFECT
    from certreg.geometry.orthogonality import rotation_defect as rotation_defect
    from certreg.geometry.orthogonality import why_no_rotation as why_no_rotation
    from certreg.geometry.pose import Pose as Pose
    from certreg.geometry.pose_matrix import last_row_fault as last_row_fault
    from certreg.geometry.similarity import Similarity as Similarity
    from certreg.geometry.similarity import split_scale as split_scale
    from certreg.geometry.so3 import Matrix3 as Matrix3
    from certreg.geometry.so3 import Matrix4 as Matrix4
    from certreg.geometry.so3 import T as T
    from certreg.geometry.so3 import Vector3 as Vector3
    from certreg.geometry.so3 import Vector4 as Vector4
    from certreg.geometry.so3 import angle_between as angle_between
    from certreg.geometry.so3 import body_frame as body_frame
    from certreg.geometry.so3 import canonical as canonical
    from certreg.geometry.so3 import davenport_matrices as davenport_matrices
    from certreg.geometry.so3 import davenport_matrix as davenport_matrix
    from certreg.geometry.so3 import dot as dot
    from certreg.geometry.so3 import is_reflection as is_reflection
    from certreg.geometry.so3 import quadratic_form as quadratic_form
    from certreg.geometry.so3 import quaternion_from_matrix as quaternion_from_matrix
    from certreg.geometry.so3 import quaternion_of_rotation as quaternion_of_rotation
    from certreg.geometry.so3 import quaternions_from_matrices as quaternions_from_matrices
    from certreg.geometry.so3 import rotation_matrices as rotation_matrices
    from certreg.geometry.so3 import rotation_matrix as rotation_matrix
    from certreg.geometry.so3 import squared_norm as squared_norm

__getattr__ = lazy_face(
    __name__,
    {
        "constraints": (
            "ROTATION_SIZE",
            "SquareMatrix",
            "homogeneous",
            "rotation_quadratics",
            "symmetric",
        ),
        "given": (
            "GivenPose",
            "given_pose",
        ),
        "orthogonality": (
            "ROTATION_TOLERANCE",
            "UNNOTED_DEFECT",
            "rotation_defect",
            "why_no_rotation",
        ),
        "pose": ("Pose",),
        "pose_matrix": ("last_row_fault",),
        "similarity": (
            "Similarity",
            "split_scale",
        ),
        "so3": (
            "Matrix3",
            "Matrix4",
            "T",
            "Vector3",
            "Vector4",
            "angle_between",
            "body_frame",
            "canonical",
            "davenport_matrices",
            "davenport_matrix",
            "dot",
            "is_reflection",
            "quadratic_form",
            "quaternion_from_matrix",
            "quaternion_of_rotation",
            "quaternions_from_matrices",
            "rotation_matrices",
            "rotation_matrix",
            "squared_norm",
        ),
    },
)
