"""Certificates of consensus with the least squares of general springs, and forgeries."""

from __future__ import annotations

import struct
from itertools import chain
from typing import Any

import consensus
from envelope import ABOUT, FORMAT, Certificate, Points, Vectors, stated
from planes import ANOTHER_NORMAL, GENERAL, certificate
from squares import KIND, OF_PLANES

from certreg.verify import SPRUNG, sprung_rows

TURN, SHIFT = [1, 0, 0, 1], [7, 1, 2, 0]  # a quarter turn about z, a shift: off by 1/8 an axis
WRONG: Points = [[9, 9, 9], [-8, 6, 4], [5, -7, -9]]
ELSEWHERE: Points = [[0, 0, 0], [30, -20, 10], [-40, 5, 60]]
BOUND = 0.25  # above sqrt(3)/8
MET, N = 9, 12
NORMALS: Points = [*GENERAL.normals, [1, 0, 0], [0, 1, 0], [3, 1, 2]]
LABELS = "i" * MET + "o" * (N - MET)


def content() -> bytes:
    """The bytes that the digest binds."""
    source, target = GENERAL.source + WRONG, GENERAL.target + ELSEWHERE
    factors = [[a, b, 0, c, 0, 0] for a, b, c in NORMALS]
    numbers = [*chain(*source), *chain(*target), *[BOUND] * N, *chain(*factors)]
    return SPRUNG + struct.pack(f"<Q{len(numbers)}d", N, *map(float, numbers))


def produced() -> Certificate:
    """Nine pairs of twelve, and the planes through their targets."""
    fit = certificate(KIND, GENERAL, OF_PLANES)
    fit["problem"]["data"] = None
    rows, _ = sprung_rows(content()[len(SPRUNG) + 8 :], N)
    return {
        "about": ABOUT,
        "claims": {"labels": LABELS, "upper": MET},
        "fit": fit,
        "format": FORMAT,
        "kind": "consensus",
        "problem": stated(content(), N),
        "reach": consensus.reach(rows[:MET], fit["proof"]["pose"]),
        "springs": True,
        "stages": [[MET, N, []]],
        "witness": {"quaternion": TURN, "shift": SHIFT},
    }


def vectors() -> Vectors:
    """True ones, and forgeries."""
    good = produced()
    bare = {key: value for key, value in good.items() if key != "reach"} | {"fit": None}
    m, e = good["reach"]["sin2_half_angle"]
    other = certificate(KIND, ANOTHER_NORMAL, OF_PLANES)
    other["problem"]["data"] = None
    mixed = consensus.produced(consensus.MIXED, consensus.MIXED_STAGES, "iiiiiioooooo", 6)
    turned = good["reach"] | {"sin2_half_angle": [m, e - 1]}
    forged: dict[str, tuple[Any, str]] = {
        "fit-of-one-weight": (good | {"fit": mixed["fit"]}, "consensus"),
        "fit-of-other-planes": (good | {"fit": other}, "consensus"),
        "reach-too-small": (good | {"reach": turned}, "consensus"),
        "not-said": (bare | {"springs": False}, "data"),
        "said-by-a-number": (bare | {"springs": 1}, "form"),
    }
    return {
        "accept-consensus-springs.json": (good, ""),
        "accept-consensus-springs-without-a-fit.json": (bare, ""),
        **{f"refuse-consensus-springs-{name}.json": pair for name, pair in forged.items()},
    }
