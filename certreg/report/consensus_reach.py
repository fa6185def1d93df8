"""How far motions that meet the same pairs may turn from the pose, or why that is not bounded.

A certificate bounds the turn from the pose in its `fit`. The pose shown is another: it is rounded
to doubles and, in a report of a certificate, computed anew. What lies between the two is added.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from certreg.certificate.bounds import ExactPose, angle_from
from certreg.exact.decimals import as_given, at_most
from certreg.exact.dyadic import degrees_above

if TYPE_CHECKING:
    from collections.abc import Sequence
    from fractions import Fraction

    from certreg.geometry.pose import Pose
    from certreg.geometry.similarity import Similarity
    from certreg.registration.labelled import ConsensusRegistration

DIGITS = 7  # of the angle, rounded up
ON_LINE = 1e-9  # of the size of a cloud: nearer to a line its points are said to be on it


def reach_degrees(result: ConsensusRegistration) -> str | None:
    """A bound on the angle from the pose to all motions that meet these pairs; None: none."""
    body, pose = result.certificate.body, result.pose
    if body.reach is None or body.fit is None:
        return None
    certified = body.fit.get("proof", body.fit)["pose"]
    return degrees_from(pose, certified, body.reach.sin2_half_angle.value, digits=DIGITS)


def degrees_from(
    pose: Pose | Similarity, certified: Sequence[int], sin2: Fraction, *, digits: int
) -> str | None:
    """A bound on the angle from a pose to rotations near a certified one; None: 180 degrees.

    certified: its quaternion, of any length. sin2: above sin^2 of half of their angle to that.
    """
    own = ExactPose.of_doubles(pose.quaternion_wxyz, pose.translation).quaternion
    angle = angle_from(certified, own, sin2)
    return None if angle >= math.pi else at_most(degrees_above(angle), digits)


def why_unbounded(result: ConsensusRegistration) -> str:
    """Why no such bound is proved: mostly the pairs are too near to a line for their bounds."""
    rows = result.inliers
    points = result.problem.points.target[rows]
    sizes = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    width, widest = math.hypot(*sizes[1:]) / math.sqrt(len(rows)), result.problem.bounds[rows].max()
    if width <= ON_LINE * sizes[0]:
        return "these pairs lie on a line, and turns about it are not ruled out"
    if width <= widest:
        return (
            f"these pairs lie {width:.2g} from a line (root mean square), beside bounds of "
            f"{as_given(widest)}: turns about it are not ruled out"
        )
    return "for bounds as wide as these no angle below 180 degrees is proved"


def reach_line(result: ConsensusRegistration) -> str:
    """In the terminal."""
    degrees = reach_degrees(result)
    if degrees is None:
        return f"  proved angle      not bounded: {why_unbounded(result)}"
    return (
        f"  proved angle      at most {degrees} degrees from this rotation to that of any motion "
        f"that meets these {result.lower}"
    )
