"""The pose on the first screen of a page: rotation, scale, centre, translation, and how sure."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from certreg._loading import late
from certreg.report.parts import listed
from certreg.report.pose_words import motion_words, turn_of
from certreg.report.scale import BIAS, SCALE_ZERO, scale_of
from certreg.report.uncertainty import (
    centre_words,
    rotation_words,
    scale_words,
    shift_sigmas,
    shift_words,
    sigma_words,
    told_covariance,
    told_to,
    turn_sigmas,
    two_digits,
    uncertainty_rows,
)
from certreg.results import Absent, present

if TYPE_CHECKING:
    from collections.abc import Iterator

    from certreg.geometry.pose import Pose
    from certreg.geometry.similarity import Similarity
    from certreg.registration import scaled_poses
    from certreg.registration.covariance import PoseCovariance
    from certreg.registration.result import Registration
else:
    # of which few results have a free scale
    scaled_poses = late("certreg.registration.scaled_poses")

WIDE = 1e9  # larger translations are written with an exponent
BASIS = "± is"  # the row that says where the deviations come from
WHOSE_TURN = "Rotation: about the source's axes."
WHOSE = f"{WHOSE_TURN} Centre: where the source's mean goes."
LEAST_SURE = f"{WHOSE_TURN} Centre: the source's mean, along its least sure axis."
SAME = "not known, as that of the rotation"
NO_PROOF = "Statistics, not proved."


@dataclass(frozen=True, slots=True, kw_only=True)
class Fact:
    """A figure with its name, and what it is a figure of."""

    name: str
    value: str
    words: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class PoseFacts:
    """A pose for readers. rows: the 4×4, rounded; matrix, quaternion, scale: all digits, to copy.

    scale: None where it is not free.

    uncertainty: how the deviations in `facts` are known, or why there are none.
    """

    rows: tuple[str, ...]
    facts: tuple[Fact, ...]
    uncertainty: str
    matrix: str
    quaternion: str
    scale: str | None
    motion: str


def pose_of(registration: Registration) -> PoseFacts:
    """The pose, rounded beside its deviations, and with all digits."""
    pose, bias = registration.pose, BIAS.get(registration.problem.scale)
    exact, scale = pose.T_target_source.tolist(), present(scale_of(pose))
    about_scale = [] if bias is None else [f"Of the scale: {bias}."]
    return PoseFacts(
        rows=aligned(exact, scaled=scale is not None),
        facts=(*_scale_facts(registration), *_place_facts(registration)),
        uncertainty=" ".join([_basis_words(registration), *about_scale]),
        matrix="\n".join(" ".join(map(repr, row)) for row in exact),
        quaternion=" ".join(map(repr, pose.quaternion_wxyz.tolist())),
        scale=None if scale is None else repr(scale),
        motion=motion_words(registration),
    )


def _basis_words(registration: Registration) -> str:
    """What the deviations are of, and of which places; or why there are none."""
    sure = dict(uncertainty_rows(registration))
    if BASIS not in sure:
        return f"Uncertainty {sure['uncertainty']}."
    whose = WHOSE_TURN
    if registration.problem.motion.translations:
        whose = WHOSE if registration.problem.springs is None else LEAST_SURE
    return f"± is {sure[BASIS]}. {whose} {NO_PROOF}"


def _scale_facts(registration: Registration) -> Iterator[Fact]:
    scale, own = present(scale_of(registration.pose)), listed(registration)
    if scale is None or own is None:
        return
    kind = f"{registration.problem.scale.value}: target over source"
    yield Fact(name="Scale", value=f"{scale:.9g}", words=kind)
    if scale == 0.0:
        yield Fact(name="", value="", words=SCALE_ZERO)
    if (unit := scaled_poses.unit_of(own)) is not None:
        yield Fact(name="Unit", value="", words=unit)


def _place_facts(registration: Registration) -> Iterator[Fact]:
    """Rotation, centre and translation; each deviation that is known in the next line."""
    pose, moves = registration.pose, registration.problem.motion.translations
    covariance = present(told_covariance(registration))
    yield rotation_fact(pose, covariance)
    yield from axis_facts(pose)
    if covariance is None:
        yield from [translation_fact(pose, None)] * bool(moves)
        return
    turn, shift = rotation_words(covariance, ""), shift_words(covariance, "")
    yield Fact(name="Rotation ±", value="", words=turn)
    if covariance.scale_sigma is not None:
        yield Fact(name="Scale ±", value="", words=scale_words(pose, covariance.scale_sigma))
    if moves:
        yield from _centre_facts(registration, covariance)
        yield translation_fact(pose, covariance)
        yield Fact(name="Translation ±", value="", words=SAME if shift == turn else shift)


def _centre_facts(registration: Registration, covariance: PoseCovariance) -> Iterator[Fact]:
    own = listed(registration)
    if own is None:  # as sure as along its least sure axis
        yield Fact(name="Centre ±", value="", words=two_digits([covariance.centre_sigma]))
        return
    yield Fact(name="Centre", value=f"({', '.join(centre_words(own, covariance))})")
    yield Fact(name="Centre ±", value="", words=sigma_words(covariance))


def aligned(matrix: list[list[float]], *, scaled: bool = False) -> tuple[str, ...]:
    """The rows in few digits, in columns. scaled: whether entries may be of any size."""
    told = ("{:.6g}" if scaled else "{:.6f}").format
    cells = [[*map(told, row[:3]), _short(row[3])] for row in matrix[:3]]
    cells.append(["0", "0", "0", "1"])
    widths = [max(len(row[k]) for row in cells) for k in range(4)]
    return tuple(
        "  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True))
        for row in cells
    )


def _short(value: float) -> str:
    """A length in so few characters that the matrix fits its place."""
    return f"{value:.9g}" if 1e-4 <= abs(value) < WIDE or not value else f"{value:.5e}"


def rotation_fact(pose: Pose | Similarity, covariance: PoseCovariance | None) -> Fact:
    """The angle that the pose turns by, as its deviation allows."""
    degrees, axis = turn_of(pose)
    told = covariance is not None and not isinstance(turn_sigmas(covariance), Absent)
    sigma = math.degrees(covariance.loosest_sigma) if covariance is not None and told else 0.0
    about = "" if axis is None else "about the axis"
    return Fact(name="Rotation", value=f"{told_to(degrees, sigma)}°", words=about)


def axis_facts(pose: Pose | Similarity) -> list[Fact]:
    """On a line of its own, which holds it; none where nothing is turned."""
    _, axis = turn_of(pose)
    if axis is None:
        return []
    return [Fact(name="Axis", value=f"({', '.join(f'{entry:.4f}' for entry in axis)})")]


def translation_fact(pose: Pose | Similarity, covariance: PoseCovariance | None) -> Fact:
    """The translation of the pose, as its deviation allows."""
    told = Absent("") if covariance is None else shift_sigmas(covariance)
    sigmas = [0.0] * 3 if isinstance(told, Absent) else told.tolist()
    shift = pose.translation.tolist()
    values = ", ".join(told_to(t, s) for t, s in zip(shift, sigmas, strict=True))
    return Fact(name="Translation", value=f"({values})")
