"""A pose in words: a turn about an axis, a scale where it is free, and a shift."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from certreg.exact.decimals import at_most
from certreg.report.scale import scale_of
from certreg.results import Absent, Optimality

if TYPE_CHECKING:
    from fractions import Fraction

    from certreg.geometry.pose import Pose
    from certreg.geometry.similarity import Similarity
    from certreg.problem.motion import Motion
    from certreg.registration.result import Registration


def motion_words(registration: Registration) -> str:
    """The pose as a turn about an axis, a scale where it is free, and a shift if there is one."""
    pose, unique = registration.pose, registration.unique
    which = "The pose below" if registration.status is Optimality.BOUNDED else "The best motion"
    which = which if unique or unique is None else "That pose"
    shift = ", ".join(f"{entry:.6g}" for entry in pose.translation.tolist())
    degrees, direction = turn_of(pose)
    done, whom = ["turns nothing"], "the source"
    if direction is not None:
        axis = ", ".join(f"{entry:.3f}" for entry in direction)
        done, whom = [f"turns the source by {degrees:.4g}° about the axis ({axis})"], "it"
    if not isinstance(scale := scale_of(pose), Absent):
        done, whom = [*done, f"scales {whom} by {scale:.6g}"], "it"
    if registration.problem.motion.translations:
        done.append(f"shifts {whom} by ({shift})")
    *first, last = done
    return f"{which} {', '.join(first)} and {last}." if first else f"{which} {last}."


def gap_words(motion: Motion, what: str, gap: Fraction) -> str:
    """That what is minimised, at the pose, is no more than this above its minimum."""
    moves = motion.translations > 0
    over = ["rotations", *["translations"] * moves, *["scales"] * motion.scales]
    by = ["its quaternion", *["its translation"] * moves, *["its scale"] * motion.scales]
    place = "" if moves else ", about the origin"
    return (
        f"Over all {_listed(over)}{place}: {what} at the pose given below with all digits, by "
        f"{_listed(by)}, exceeds the minimum by at most {at_most(gap)}."
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
