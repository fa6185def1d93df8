"""Certificates of kind `isotropic`: the eight patterns of equal eigenvalues, and forgeries."""

from __future__ import annotations

import base64
import copy
import struct
from fractions import Fraction
from itertools import accumulate, chain
from math import lcm
from typing import Any

from envelope import ABOUT, FORMAT, Certificate, Points, Vectors, lower, of_another_digest, stated

from certreg.verify import (
    Statement,
    cross,
    davenport,
    definite,
    inertia,
    moments,
    multiplicities,
    proves_level,
)

BITS = 64  # of the quaternions
PREFIX = Statement.prefix

GENERIC: Points = [[0, 0, 0], [3, 1, 0], [1, 4, 1], [2, 2, 5], [-3, 1, 2], [0.5, -2, 0.25]]
MOVED: Points = [[7, 1, 2], [6, 4, 2], [3, 2, 3.5], [5, 3, 7], [6, -2, 4], [9, 1.5, 2]]
AXES: Points = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]
SQUARE: Points = [[1, 1, 0], [1, -1, 0], [-1, -1, 0], [-1, 1, 0]]
LINE: Points = [[0, 0, 0], [1, 2, 3], [2, 4, 6], [5, 10, 15]]
BENT: Points = [[0, 0, 0], [1, 2, 3], [2, 4, 7], [5, 9, 15]]


def stretched(x: float, y: float, z: float) -> Points:
    """The octahedron scaled along its axes."""
    return [[a * x, b * y, c * z] for a, b, c in AXES]


ACCEPTED: dict[str, tuple[Points, Points]] = {
    "pattern-1111": (GENERIC, MOVED),
    "pattern-1111-mirrored": (stretched(3, 2, 1), stretched(3, 2, -1)),
    "pattern-121": (SQUARE, SQUARE),
    "pattern-112": (stretched(2, 1, 1), stretched(2, 1, 1)),
    "pattern-13": (AXES, AXES),
    "pattern-211": (stretched(2, 1, 1), stretched(2, 1, -1)),
    "pattern-31": (AXES, stretched(1, 1, -1)),
    "pattern-22-collinear": (LINE, BENT),
    "pattern-4": (BENT, [[1, 2, 3]] * 4),
}


def data_bytes(source: Points, target: Points, weights: list[float]) -> bytes:
    """The bytes that the digest binds."""
    numbers = [*chain(*source), *chain(*target), *weights]
    return PREFIX + struct.pack(f"<Q{len(numbers)}d", len(weights), *map(float, numbers))


def dyadic_above(value: Fraction, bits: int = 32) -> list[int]:
    """The least [m, e] of about so many bits that is at least the value > 0."""
    exponent = value.numerator.bit_length() - value.denominator.bit_length() - bits
    return [-((-value) // Fraction(2) ** exponent), exponent]


def top_vector(K: list[list[int]]) -> list[int]:
    """An integer vector near the eigenvector of the largest eigenvalue: power iteration."""
    shift = max(sum(map(abs, row)) for row in K)
    q = [1 << BITS, 3 << BITS - 3, 5 << BITS - 4, 7 << BITS - 5]
    for _ in range(4000):
        old = q
        image = [sum(a * b for a, b in zip(row, q, strict=True)) for row in K]
        q = [a + shift * b for a, b in zip(image, q, strict=True)]
        cut = max(map(abs, q)).bit_length() - BITS
        q = [c >> cut if cut > 0 else c << -cut for c in q]
        if q == old:  # and so for ever
            break
    return [0 if abs(c) < 16 else c for c in q]  # what truncation left of a zero


def produced(source: Points, target: Points, weights: list[float] | None = None) -> Certificate:
    """A certificate that claims what it can about pose, uniqueness, equilibria, basin and dual."""
    n, weights = len(source), weights or [1.0] * len(source)
    content = data_bytes(source, target, weights)
    m, e = moments(content[len(PREFIX) + 8 :], n)
    C, J = cross(m), inertia(m)
    K, unit = davenport(C), Fraction(2) ** e / m[0][0]
    q, pattern = top_vector(K) if any(chain(*K)) else [1, 0, 0, 0], multiplicities(C)
    norm = sum(c * c for c in q)
    v = sum(q[i] * K[i][j] * q[j] for i in range(4) for j in range(4)) * unit / norm
    mu, delta = bounds(K, unit, q, v, unique=pattern[0] == 1)
    solid = definite(J)
    nu = dyadic_above(v + delta, 64)
    inside = bool(mu) and solid
    return {
        "about": ABOUT,
        "basin": {"angular_velocity": [1, -1, 2, -12], "quaternion": q} if inside else None,
        "claims": {
            "basin": True if inside else None,
            "gap": dyadic_above(2 * delta),
            "pattern": pattern,
            "sdp_gap": dyadic_above(2 * (nu[0] * Fraction(2) ** nu[1] - v)),
            "sin2_half_angle": dyadic_above(delta / mu) if mu else None,
            "unique": pattern[0] == 1,
            "unstable": [0, *accumulate(pattern[:-1])] if solid else None,
        },
        "format": FORMAT,
        "kind": "isotropic",
        "optimality": {"delta": dyadic_above(delta), "mu": dyadic_above(mu) if mu else [0, 0]},
        "pose": q,
        "problem": stated(content, n),
        "sdp": {"nu": nu},
    }


def proves(K: list[list[int]], unit: Fraction, q: list[int], level: Fraction, mu: Fraction) -> bool:
    """The checker's answer, of K over a unit: it takes integers."""
    level *= sum(c * c for c in q)
    common = lcm(unit.denominator, level.denominator, mu.denominator)
    return proves_level(K, int(unit * common), q, int(level * common), int(mu * common))


def bounds(
    K: list[list[int]], unit: Fraction, q: list[int], v: Fraction, *, unique: bool
) -> tuple[Fraction, Fraction]:
    """Powers of two mu and delta that prove the pose: mu near half of the spectral gap."""
    delta = Fraction(1, 2**80)
    while True:
        for k in range(12) if unique else ():
            mu = Fraction(2) ** (6 - k)
            if proves(K, unit, q, v + delta - mu, mu):
                return mu, delta
        if not unique and proves(K, unit, q, v + delta, Fraction(0)):
            return Fraction(0), delta
        delta *= 2


def vectors() -> Vectors:
    """Certificates of every pattern, and forgeries of the generic one."""
    made = {name: produced(*pair) for name, pair in ACCEPTED.items()}
    circle = made["pattern-211"]
    claims_too_much = circle | {"claims": circle["claims"] | {"unique": True}}
    return {
        **{f"accept-{name}.json": (good, "") for name, good in made.items()},
        **{f"refuse-{name}.json": pair for name, pair in refused(made["pattern-1111"]).items()},
        "refuse-unique-where-it-is-not.json": (claims_too_much, "claim"),
    }


def refused(good: Certificate) -> Vectors:
    """Forgeries of one certificate, each with the class of reason for which it is refused."""
    q, content = good["pose"], base64.b64decode(good["problem"]["data"])
    n, other = good["problem"]["n"], [-q[1], q[0], -q[3], q[2]]  # orthogonal to q: 180 degrees off

    def with_data(at: int, value: float) -> dict[str, Any]:
        raw = bytearray(content)
        start = len(PREFIX) + 8 + 8 * at
        raw[start : start + 8] = struct.pack("<d", value)
        return {"problem": stated(bytes(raw), n)}

    def claim(**parts: Any) -> dict[str, Any]:
        return {"claims": good["claims"] | parts}

    nu = good["sdp"]["nu"]
    changes: dict[str, tuple[str, dict[str, Any]]] = {
        "gap-one-unit-too-small": ("claim", claim(gap=lower(good["claims"]["gap"]))),
        "angle-one-unit-too-small": (
            "claim",
            claim(sin2_half_angle=lower(good["claims"]["sin2_half_angle"])),
        ),
        "pattern-not-the-true-one": ("claim", claim(pattern=[1, 2, 1])),
        "unstable-not-the-true-ones": ("claim", claim(unstable=[0, 1, 2, 2])),
        "pose-half-a-turn-off": ("optimality", {"pose": other}),
        "pose-zero": ("optimality", {"pose": [0, 0, 0, 0]}),
        "mu-too-large": ("optimality", {"optimality": good["optimality"] | {"mu": [1, 20]}}),
        "data-of-another-digest": ("data", of_another_digest(good)),
        "data-minus-zero": ("data", with_data(0, -0.0)),
        "data-not-finite": ("data", with_data(1, float("nan"))),
        "weight-negative": ("data", with_data(6 * n, -1.0)),
        "basin-at-a-spurious-pose": ("basin", {"basin": good["basin"] | {"quaternion": other}}),
        "basin-too-fast": ("basin", {"basin": good["basin"] | {"angular_velocity": [1, 1, 1, 9]}}),
        "sdp-multiplier-too-low": ("sdp", {"sdp": {"nu": [nu[0] * 9 // 10, nu[1]]}}),
        "sdp-gap-one-unit-too-small": ("sdp", claim(sdp_gap=lower(good["claims"]["sdp_gap"]))),
        "unknown-key": ("form", {"more": 1}),
        "number-with-a-fraction": ("form", claim(gap=[1.0, 0])),
    }
    return {
        name: (copy.deepcopy(good) | parts, reason) for name, (reason, parts) in changes.items()
    }
