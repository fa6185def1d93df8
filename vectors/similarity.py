"""Certificates of a free scale, and of rotations alone, with forgeries of each."""

from __future__ import annotations

import base64
import copy
import struct
from fractions import Fraction
from itertools import chain
from math import isqrt
from typing import Any

from envelope import ABOUT, FORMAT, Certificate, Points, Vectors, lower, of_another_digest, stated
from isotropic import AXES, BENT, GENERIC, LINE, MOVED, bounds, dyadic_above, stretched, top_vector

from certreg.verify import PREFIXES, cross, davenport, moments, multiplicities, spreads

ROTATION = b"certreg-rotation/1\0"
BITS = 80  # of the bounds of a scale
UNIT = Fraction(1, 2**BITS)

ACCEPTED: dict[str, tuple[Points, Points, str, bool]] = {
    "asymmetric": (GENERIC, MOVED, "asymmetric", False),
    "asymmetric-circle": (stretched(2, 1, 1), stretched(4, 2, -2), "asymmetric", False),
    "asymmetric-collinear": (LINE, BENT, "asymmetric", False),
    "asymmetric-scale-0": (BENT, [[1, 2, 3]] * 4, "asymmetric", False),
    "asymmetric-rotation-only": (GENERIC, MOVED, "asymmetric", True),
    "symmetric": (GENERIC, MOVED, "symmetric", False),
    "symmetric-mirrored": (stretched(3, 2, 1), stretched(6, 4, -2), "symmetric", False),
    "symmetric-rotation-only": (GENERIC, MOVED, "symmetric", True),
}
ROTATIONS: dict[str, tuple[Points, Points]] = {
    "rotation-only": (GENERIC, MOVED),
    "rotation-only-one-pair": ([[0, 0, 1]], [[0, 2, 0]]),
    "rotation-only-all-rotations": (AXES, [[1, 2, 3]] * 6),
}


def data_bytes(prefix: bytes, source: Points, target: Points) -> bytes:
    """The bytes that the digest binds, of weights that are 1."""
    numbers = [*chain(*source), *chain(*target), *[1.0] * len(source)]
    return prefix + struct.pack(f"<Q{len(numbers)}d", len(source), *map(float, numbers))


def dyadic_between(value: Fraction, *, above: bool) -> list[int]:
    """The nearest multiple of 2^-BITS below or above."""
    return [-((-value) // UNIT) if above else value // UNIT, -BITS]


def produced(
    source: Points, target: Points, prefix: bytes, scale: str | None, *, alone: bool
) -> Certificate:
    """A certificate that claims the least gap and the narrowest interval of that width."""
    content = data_bytes(prefix, source, target)
    m, e = moments(content[len(prefix) + 8 :], len(source))
    m = [[m[0][0], *[0] * 6], *m[1:]] if alone else m
    C, (x, y) = cross(m), spreads(m)
    K, unit = davenport(C), Fraction(2) ** e / m[0][0]
    q, pattern = top_vector(K) if any(chain(*K)) else [1, 0, 0, 0], multiplicities(C)
    norm = sum(c * c for c in q)
    v = sum(q[i] * K[i][j] * q[j] for i in range(4) for j in range(4)) * unit / norm
    mu, delta = bounds(K, unit, q, v, unique=pattern[0] == 1)
    claims = {
        "pattern": pattern,
        "sin2_half_angle": dyadic_above(delta / mu) if mu else None,
        "unique": pattern[0] == 1,
    }
    made = {
        "about": ABOUT,
        "format": FORMAT,
        "optimality": {"delta": dyadic_above(delta), "mu": dyadic_above(mu) if mu else [0, 0]},
        "pose": q,
        "problem": stated(content, len(source)),
        **({"rotation_only": True} if alone else {}),
    }
    if scale is None:
        none = {"basin": None, "gap": dyadic_above(2 * delta), "sdp_gap": None, "unstable": None}
        more = {"basin": None, "claims": claims | none, "kind": "isotropic", "sdp": None}
        return made | more
    least, most, gap = v / (x * unit), (v + delta) / (x * unit), delta * (2 * v + delta)
    gap /= x * unit
    if scale == "symmetric":
        root = Fraction(isqrt((y << 4 * BITS) // x), 1 << 2 * BITS)
        least, most, gap = root, root + Fraction(1, 1 << 2 * BITS), 2 * delta
    ends = {
        "gap": dyadic_above(gap),
        "scale_lower": dyadic_between(least, above=False),
        "scale_upper": dyadic_between(most, above=True),
    }
    return made | {"claims": claims | ends, "kind": "similarity", "scale": scale}


def vectors() -> Vectors:
    """Both scales and none, with and without a translation; forgeries."""
    scaled = {
        name: produced(source, target, PREFIXES[scale, alone], scale, alone=alone)
        for name, (source, target, scale, alone) in ACCEPTED.items()
    }
    turned = {name: produced(*pair, ROTATION, None, alone=True) for name, pair in ROTATIONS.items()}
    return {
        **{f"accept-similarity-{name}.json": (good, "") for name, good in scaled.items()},
        **{f"accept-{name}.json": (good, "") for name, good in turned.items()},
        **_refused("asymmetric", scaled["asymmetric"]),
        **_refused("symmetric", scaled["symmetric"]),
        **_refused_rotations(turned["rotation-only"]),
        "refuse-similarity-unique-circle.json": (
            _claim(scaled["asymmetric-circle"], unique=True),
            "claim",
        ),
        "refuse-similarity-source-at-one-point.json": (
            _with_points(scaled["asymmetric-scale-0"], [[1, 2, 3]] * 4, BENT, "asymmetric"),
            "scale",
        ),
        "refuse-similarity-target-at-one-point.json": (
            _with_points(scaled["asymmetric-scale-0"], BENT, [[1, 2, 3]] * 4, "symmetric"),
            "scale",
        ),
        "refuse-similarity-no-scale-by-delta.json": (_negative(), "scale"),
    }


def _claim(good: Certificate, **parts: Any) -> Certificate:
    return copy.deepcopy(good) | {"claims": good["claims"] | parts}


def _with_points(good: Certificate, source: Points, target: Points, scale: str) -> Certificate:
    """The same claims of other points."""
    content = data_bytes(PREFIXES[scale, False], source, target)
    return copy.deepcopy(good) | {"problem": stated(content, len(source)), "scale": scale}


def _negative() -> Certificate:
    """A rotation with tr(R^T C) = -24, and delta = 53 > 48: the gap's formula is positive there."""
    axes = stretched(3, 2, 1)
    good = produced(axes, axes, PREFIXES["asymmetric", False], "asymmetric", alone=False)
    claims = {"gap": [1, 0], "scale_lower": [-1, 0], "scale_upper": [2, 0]}
    forged = _claim(good, **claims, sin2_half_angle=None)
    return forged | {"pose": [0, 0, 0, 1], "optimality": {"delta": [53, 0], "mu": [0, 0]}}


def _refused(scale: str, good: Certificate) -> Vectors:
    """Forgeries of a certificate of a scale."""
    q, claims, content = good["pose"], good["claims"], base64.b64decode(good["problem"]["data"])
    other = "symmetric" if scale == "asymmetric" else "asymmetric"
    low, high = claims["scale_lower"], claims["scale_upper"]
    plain = b"certreg-problem/1\0" + content[len(PREFIXES[scale, False]) :]
    changes: dict[str, tuple[str, Certificate]] = {
        "gap-one-unit-too-small": ("claim", _claim(good, gap=lower(claims["gap"]))),
        "scale-lower-too-large": ("scale", _claim(good, scale_lower=[low[0] + 1, low[1]])),
        "scale-upper-too-small": ("scale", _claim(good, scale_upper=lower(high))),
        "pattern-not-the-true-one": ("claim", _claim(good, pattern=[1, 2, 1])),
        "angle-one-unit-too-small": (
            "claim",
            _claim(good, sin2_half_angle=lower(claims["sin2_half_angle"])),
        ),
        "pose-half-a-turn-off": ("optimality", good | {"pose": [-q[1], q[0], -q[3], q[2]]}),
        "pose-zero": ("optimality", good | {"pose": [0, 0, 0, 0]}),
        "mu-too-large": (
            "optimality",
            good | {"optimality": good["optimality"] | {"mu": [1, 20]}},
        ),
        "digest": ("data", of_another_digest(good)),
        "data-without-a-scale": (
            "data",
            good | {"problem": stated(plain, good["problem"]["n"])},
        ),
        "the-other-scale": ("data", good | {"scale": other}),
        "without-a-translation": ("data", good | {"rotation_only": True}),
        "no-such-scale": ("data", good | {"scale": "both"}),
    }
    return {f"refuse-similarity-{scale}-{n}.json": (made, r) for n, (r, made) in changes.items()}


def _refused_rotations(good: Certificate) -> Vectors:
    """Forgeries of a certificate of a rotation alone."""
    shifted = {name: value for name, value in good.items() if name != "rotation_only"}
    gap = good["claims"]["gap"]
    return {
        "refuse-rotation-only-left-out.json": (shifted, "data"),
        "refuse-rotation-only-false.json": (good | {"rotation_only": False}, "data"),
        "refuse-rotation-only-a-number.json": (good | {"rotation_only": 1}, "form"),
        "refuse-rotation-only-gap-one-unit-too-small.json": (
            _claim(good, gap=lower(gap)),
            "claim",
        ),
    }
