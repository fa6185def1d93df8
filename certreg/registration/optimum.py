"""The optimal pose in doubles."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import TYPE_CHECKING, overload

import numpy as np

from certreg.certificate.bounds import ExactPose
from certreg.equilibrium.equilibrium_set import rotation_double, unit_double
from certreg.errors import OutOfRangeError
from certreg.exact.dyadic import nearest_double
from certreg.geometry.pose import Pose
from certreg.geometry.similarity import Similarity

if TYPE_CHECKING:
    from certreg.exact.spaces import IntegerQuaternion
    from certreg.objective.isotropic import Isotropic
    from certreg.objective.springs import Springs


def optimal_pose(objective: Isotropic) -> Pose | Similarity:
    """The representative of the optimal component, every number rounded once."""
    return pose_at(objective, objective.optimum)


@overload
def pose_at(objective: Springs, q: IntegerQuaternion) -> Pose: ...


@overload
def pose_at(objective: Isotropic | Springs, q: IntegerQuaternion) -> Pose | Similarity: ...


def pose_at(objective: Isotropic | Springs, q: IntegerQuaternion) -> Pose | Similarity:
    """The pose of a rotation with its best translation, every number rounded once.

    Where the scale is free, with its best scale, and the best translation for that as rounded.
    """
    scale = nearest_double(objective.best_scale(q))
    if scale is None or (scale == 0.0 and objective.best_scale(q)):
        raise OutOfRangeError(
            "the scale exceeds the range of doubles: change the unit of length of one cloud",
            value=objective.best_scale(q),
        )
    translation = objective.rounded_translation(q, 1 if scale == 1.0 else Fraction(scale))
    if not all(map(math.isfinite, translation)):
        raise OutOfRangeError(
            "the translation of a pose exceeds the range of doubles: "
            "change the unit of length of both clouds",
            value=objective.best_translation(q),
        )
    pose = Pose(
        rotation=rotation_double(q),
        translation=np.array(translation),
        quaternion_wxyz=unit_double(q),
    )
    return pose if objective.scaling is None else Similarity.of_pose(pose, scale)


def exact_pose(pose: Pose | Similarity) -> ExactPose:
    """The pose with exactly the doubles that it shows."""
    return ExactPose.of_doubles(pose.quaternion_wxyz, pose.translation, pose.scale)
