"""The pose on the first screen of a page: rotation, scale, centre, translation, and how sure."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING

from certreg._loading import late
from certreg.problem.motion import ROTATION, SCALE, TRANSLATION
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
    from certreg.registration import gap_parts
    from certreg.registration.covariance import PoseCovariance
    from certreg.registration.result import Registration
else:
    # of which few results have a free scale
    gap_parts = late("certreg.registration.gap_parts")

WIDE = 1e9  # larger translations are written with an exponent
BASIS = "± is"  # the row that says where the deviations come from
WHOSE_TURN = "Rotation: about the source's axes."
WHOSE = "Centre: where the source's mean goes."
LEAST_SURE = "Centre: the source's mean, along its least sure axis."
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
    covariance, motion = present(told_covariance(registration)), registration.problem.motion
    return PoseFacts(
        rows=aligned(exact, scaled=scale is not None),
        facts=tuple(chain(*(facts(registration, covariance) for facts in motion.entries(FACTS)))),
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
    centre = WHOSE if registration.problem.springs is None else LEAST_SURE
    whose = registration.problem.motion.entries(((ROTATION, WHOSE_TURN), (TRANSLATION, centre)))
    return f"± is {sure[BASIS]}. {' '.join(whose)} {NO_PROOF}"


def _scale_facts(registration: Registration, _: PoseCovariance | None) -> Iterator[Fact]:
    scale = registration.pose.scale
    kind = f"{registration.problem.scale.value}: target over source"
    yield Fact(name="Scale", value=f"{scale:.9g}", words=kind)
    if scale == 0.0:
        yield Fact(name="", value="", words=SCALE_ZERO)
    if (unit := gap_parts.unit_of(registration)) is not None:
        yield Fact(name="Unit", value="", words=unit)


def _turn_facts(registration: Registration, covariance: PoseCovariance | None) -> Iterator[Fact]:
    """Rotation and scale, as their deviations allow; these in the next lines, where known."""
    pose, sigma = registration.pose, 0.0
    degrees, axis = turn_of(pose)
    if covariance is not None and not isinstance(turn_sigmas(covariance), Absent):
        sigma = math.degrees(covariance.loosest_sigma)
    about = "" if axis is None else "about the axis"
    yield Fact(name="Rotation", value=f"{told_to(degrees, sigma)}°", words=about)
    if axis is not None:  # on a line of its own, which holds it
        yield Fact(name="Axis", value=f"({', '.join(f'{entry:.4f}' for entry in axis)})")
    if covariance is None:
        return
    yield Fact(name="Rotation ±", value="", words=rotation_words(covariance, ""))
    if covariance.scale_sigma is not None:
        yield Fact(name="Scale ±", value="", words=scale_words(pose, covariance.scale_sigma))


def _shift_facts(registration: Registration, covariance: PoseCovariance | None) -> Iterator[Fact]:
    """Centre and translation, likewise."""
    own, shift = listed(registration), registration.pose.translation.tolist()
    sigmas = None if covariance is None else present(shift_sigmas(covariance))
    told = map(told_to, shift, [0.0] * 3 if sigmas is None else sigmas.tolist())
    translation = Fact(name="Translation", value=f"({', '.join(told)})")
    if covariance is None:
        yield translation
        return
    if own is None:  # as sure as along its least sure axis
        yield Fact(name="Centre ±", value="", words=two_digits([covariance.stated("centre_sigma")]))
    else:
        yield Fact(name="Centre", value=f"({', '.join(centre_words(own, covariance))})")
        yield Fact(name="Centre ±", value="", words=sigma_words(covariance))
    yield translation
    turn, moved = rotation_words(covariance, ""), shift_words(covariance, "")
    yield Fact(name="Translation ±", value="", words=SAME if moved == turn else moved)


FACTS = ((SCALE, _scale_facts), (ROTATION, _turn_facts), (TRANSLATION, _shift_facts))


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
