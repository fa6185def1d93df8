"""The optimal pose in doubles."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from certreg.equilibrium import rotation_double, unit_double
from certreg.errors import OutOfRangeError
from certreg.geometry import Pose

if TYPE_CHECKING:
    from certreg.exact import IntegerQuaternion
    from certreg.objective import Isotropic


def optimal_pose(objective: Isotropic) -> Pose:
    """The representative of the optimal component, every number rounded once."""
    return pose_at(objective, objective.quaternions[0])


def pose_at(objective: Isotropic, q: IntegerQuaternion) -> Pose:
    """The pose of a rotation with its best translation, every number rounded once."""
    translation = objective.rounded_translation(q)
    if not all(map(math.isfinite, translation)):
        message = (
            "the translation of a pose exceeds the range of doubles: "
            "change the unit of length of both clouds"
        )
        raise OutOfRangeError(message, value=objective.best_translation(q))
    return Pose(
        rotation=rotation_double(q),
        translation=np.array(translation),
        quaternion_wxyz=unit_double(q),
    )
