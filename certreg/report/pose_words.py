"""A pose in words: a turn about an axis, a scale where it is free, and a shift."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from certreg.exact.decimals import at_most
from certreg.problem.motion import ROTATION, SCALE, TRANSLATION
from certreg.results import Optimality

if TYPE_CHECKING:
    from fractions import Fraction

    from certreg.geometry.pose import Pose
    from certreg.geometry.similarity import Similarity
    from certreg.problem.motion import Motion
    from certreg.registration.result import Registration

PLACE = ((TRANSLATION, "about the origin"),)  # of a rotation, where no translation is found
GIVEN_BY = (
    (ROTATION, "its quaternion"),
    (TRANSLATION, "its translation"),
    (SCALE, "its scale"),
)


def motion_words(registration: Registration) -> str:
    """The pose as a turn about an axis, a scale where it is free, and a shift if there is one."""
    pose, unique = registration.pose, registration.unique
    which = "The pose below" if registration.status is Optimality.BOUNDED else "The best motion"
    which = which if unique or unique is None else "That pose"
    shift = ", ".join(f"{entry:.6g}" for entry in pose.translation.tolist())
    degrees, direction = turn_of(pose)
    turned, whom = "turns nothing", ["the source"]
    if direction is not None:
        axis = ", ".join(f"{entry:.3f}" for entry in direction)
        turned, whom = f"turns the source by {degrees:.4g}° about the axis ({axis})", []
    done = ((SCALE, f"scales {{}} by {pose.scale:.6g}"), (TRANSLATION, f"shifts {{}} by ({shift})"))
    moved = registration.problem.motion.entries(done)
    told = [words.format(of) for words, of in zip(moved, [*whom, "it", "it"], strict=False)]
    return f"{which} {_listed([turned, *told])}."


def gap_words(motion: Motion, what: str, gap: Fraction) -> str:
    """That what is minimised, at the pose, is no more than this above its minimum."""
    over = _listed([unknown.plural for unknown in motion.unknowns])
    return (
        f"Over all {', '.join([over, *motion.lacking(PLACE)])}: {what} at the pose given below "
        f"with all digits, by {_listed(motion.entries(GIVEN_BY))}, exceeds the minimum by at most "
        f"{at_most(gap)}."
    )


def _listed(words: list[str]) -> str:
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last


def turn_of(pose: Pose | Similarity) -> tuple[float, tuple[float, ...] | None]:
    """Degrees from 0 to 360, and the unit axis; None where nothing is turned."""
    w, *axial = pose.quaternion_wxyz.tolist()
    length = math.hypot(*axial)
    if length == 0.0:
        return 0.0, None
    degrees = math.degrees(2.0 * math.atan2(length, w))
    return degrees, tuple(entry / length for entry in axial)
