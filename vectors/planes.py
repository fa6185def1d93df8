"""Certificates of planes, and the data of most: planes in general position, and one wall."""

from __future__ import annotations

import struct
from itertools import chain
from typing import Any, NamedTuple

from envelope import ABOUT, FORMAT, Certificate, Points, stated

PREFIX, ALONE = b"certreg-springs/1\0", b"certreg-springs-rotation/1\0"


class Planes(NamedTuple):
    """Points of the source, and planes through those of the target."""

    source: Points
    target: Points
    normals: Points


SOURCE: Points = [[0, 0, 0], [3, 1, 0], [1, 4, 1], [2, 2, 5], [-3, 1, 2]]
SOURCE += [[1.0, -2, 3], [4, 0, -1], [-1, 3, -2], [2, -3, 1]]
NORMALS: Points = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [0, 1, 2]]
NORMALS += [[2.0, 0, 1], [1, -1, 1], [1, 2, -1], [-1, 1, 2]]
ERRORS: Points = [[1, -1, 0], [0, 1, 1], [-1, 0, 1], [1, 1, -1], [0, -1, 0]]
ERRORS += [[1.0, 0, 1], [-1, 1, 0], [0, 0, 1], [1, -1, -1]]
TARGET: Points = [  # the source by a quarter turn about z, and a shift; off by up to 1/8
    [7 - y + a / 8, x + 1 + b / 8, z + 2 + c / 8]
    for (x, y, z), (a, b, c) in zip(SOURCE, ERRORS, strict=True)
]
GENERAL = Planes(SOURCE, TARGET, NORMALS)
ANOTHER_NORMAL = Planes(SOURCE, TARGET, [[-1, 1, 1], *NORMALS[1:]])
STILL = Planes(  # the same without the shift
    SOURCE, [[x - 7, y - 1, z - 2] for x, y, z in TARGET], NORMALS
)
WALL = Planes(SOURCE, TARGET, [[1.0, 2.0, 2.0]] * 9)


def certificate(
    kind: str, planes: Planes, found: dict[str, Any], *, alone: bool = False
) -> Certificate:
    """A certificate of a kind, of what was found: its claims and its proof.

    alone: without a translation.
    """
    content = data_bytes(planes, ALONE if alone else PREFIX)
    problem = stated(content, len(planes.source))
    made = {"about": ABOUT, "format": FORMAT, "kind": kind, "problem": problem, **found}
    return {**made, **({"rotation_only": True} if alone else {})}


def data_bytes(planes: Planes, prefix: bytes = PREFIX) -> bytes:
    """The bytes that the digest binds."""
    factors = [[a, b, 0, c, 0, 0] for a, b, c in planes.normals]
    numbers = [*chain(*planes.source), *chain(*planes.target), *chain(*factors)]
    return prefix + struct.pack(f"<Q{len(numbers)}d", len(planes.source), *map(float, numbers))


def changed(good: Certificate, **entries: Any) -> Certificate:
    """With other entries of claims and proof."""
    parts = {
        part: {key: entries.get(key, value) for key, value in good[part].items()}
        for part in ("claims", "proof")
    }
    return {**good, **parts}
