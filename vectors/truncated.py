"""Certificates of truncated squares over rotations, with forgeries.

With the source in integers and a quarter turn the residuals are those of small numbers, and the
best fit of pairs that are off by opposite vectors at opposite points is that turn itself.
"""

from __future__ import annotations

import base64
import copy
import struct
from itertools import chain
from typing import Any

from envelope import ABOUT, FORMAT, Certificate, Points, Vectors, of_another_digest, stated

PREFIX = b"certreg-truncated-rotation/1\0"
TURN = [1, 0, 0, 1]  # (x, y, z) to (-y, x, z)
SOURCE: Points = [[2, 0, 0], [-2, 0, 0], [0, 2, 1], [0, -2, -1], [1, 1, 2], [3, 1, 0], [0, 1, 3]]
OFF = 0.125
TARGET: Points = [
    [0, 2, OFF],
    [0, -2, OFF],  # the torques of two that are off alike at opposite points cancel each other
    [-2, 0, 1],
    [2, 0, -1],
    [-1, 1, 2],
    [4, 1, 2],  # wrong
    [1, -3, 0],  # wrong
]
LABELS = "1111100"


def content(
    source: Points, target: Points, bounds: list[float], weight: float = 1.0, prefix: bytes = PREFIX
) -> bytes:
    """The bytes that the digest binds."""
    numbers = [*chain(*source), *chain(*target), *[weight] * len(source), *bounds]
    return prefix + struct.pack(f"<Q{len(numbers)}d", len(source), *map(float, numbers))


def produced(source: Points, target: Points, bounds: list[float], **claims: Any) -> Certificate:
    """A certificate of the quarter turn."""
    made = {"gap": [1, -30], "sin2_half_angle": [1, -40], "unique": True} | claims
    return {
        "about": ABOUT,
        "claims": made,
        "format": FORMAT,
        "kind": "truncated-rotation",
        "optimality": {"mu": [1, 0]},
        "pose": TURN,
        "problem": stated(content(source, target, bounds), len(source)),
    }


def vectors() -> Vectors:
    """Labels that are proved, in part and not at all; forgeries."""
    n, open_ = len(SOURCE), {"sin2_half_angle": None, "unique": False}
    good = produced(SOURCE, TARGET, [0.5] * n, labels=LABELS)
    two: Points = [[2, 0, 0], [0, 1, 0], [0, 0, 3]]
    turned = [[-y, x, z] for x, y, z in two]
    tied = (two * 2, turned + [[y, -x, z] for x, y, z in two], [0.5] * 6)
    line: Points = [[0, 0, 1], [0, 0, 2], [0, 0, -3]]
    accepted = {
        "accept-truncated": good,
        "accept-truncated-longer-pose": good | {"pose": [-3, 0, 0, -3]},
        "accept-truncated-claims-less": _claim(good, labels="?" * n, **open_),
        "accept-truncated-other-bounds": produced(
            SOURCE, TARGET, [0.25, 0.25, 0.5, 1, 0.125, 0.5, 0.75], labels=LABELS
        ),
        "accept-truncated-tie": produced(*tied, labels="??1??1", **open_),
        "accept-truncated-circle": produced(line, line, [0.5] * 3, labels="111", **open_),
    }
    refused = _refused(good) | {
        "tie-labelled": ("labels", produced(*tied, labels="111001", **open_)),
        "circle-unique": ("claim", produced(line, line, [0.5] * 3, labels="111")),
    }
    return {
        **{f"{name}.json": (made, "") for name, made in accepted.items()},
        **{f"refuse-truncated-{name}.json": (made, why) for name, (why, made) in refused.items()},
    }


def _claim(good: Certificate, **parts: Any) -> Certificate:
    return copy.deepcopy(good) | {"claims": good["claims"] | parts}


def _refused(good: Certificate) -> dict[str, tuple[str, Certificate]]:
    """Forgeries of a certificate, and the classes of reasons."""
    n, data = len(SOURCE), base64.b64decode(good["problem"]["data"])
    rotation = b"certreg-rotation/1\0" + data[len(PREFIX) : -8 * n]

    def about(problem: bytes) -> Certificate:
        return good | {"problem": stated(problem, n)}

    return {
        "gap-too-small": ("labels", _claim(good, gap=[1, -70])),
        "gap-zero": ("optimality", _claim(good, gap=[0, 0])),
        "an-outlier-within": ("labels", _claim(good, labels="1111110")),
        "an-inlier-beyond": ("labels", _claim(good, labels="1111000")),
        "labels-too-few": ("labels", _claim(good, labels=LABELS[:-1])),
        "labels-of-another-kind": ("labels", _claim(good, labels="1111102")),
        "labels-no-text": ("form", _claim(good, labels=[1, 1, 1, 1, 1, 0, 0])),
        "angle-too-small": ("claim", _claim(good, sin2_half_angle=[1, -70])),
        "angle-of-open-labels": ("claim", _claim(good, labels="?111100", unique=False)),
        "unique-without-angle": ("claim", _claim(good, sin2_half_angle=None)),
        "mu-too-large": ("claim", good | {"optimality": {"mu": [1, 20]}}),
        "mu-negative": ("claim", good | {"optimality": {"mu": [-1, 0]}}),
        "pose-half-a-turn-off": ("labels", good | {"pose": [0, 1, -1, 0]}),
        "pose-a-little-off": ("labels", good | {"pose": [1000, 1, 0, 1000]}),
        "pose-zero": ("optimality", good | {"pose": [0, 0, 0, 0]}),
        "digest": ("data", of_another_digest(good)),
        "data-without-bounds": ("data", about(rotation)),
        "bound-zero": ("data", about(content(SOURCE, TARGET, [0.5] * (n - 1) + [0]))),
        "bound-negative": ("data", about(content(SOURCE, TARGET, [-0.5] * n))),
        "weight-two": ("data", about(content(SOURCE, TARGET, [0.5] * n, 2.0))),
    }
