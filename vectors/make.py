"""Makes the test vectors for checkers of `certreg-certificate/1`: integers only, the same anywhere.

    python vectors/make.py [FOLDER]

Each file is a certificate that a checker must accept or refuse; `manifest.json` says which, and
why. Nothing here depends on floating-point libraries: eigenvectors come from integer iteration.
"""

from __future__ import annotations

import base64
import copy
import hashlib
import json
import struct
import sys
from fractions import Fraction
from itertools import accumulate, chain, product
from math import lcm
from pathlib import Path
from typing import Any

from certreg.verify import (
    IsotropicStatement,
    cross,
    davenport,
    definite,
    inertia,
    moments,
    multiplicities,
    proves_level,
)

Points = list[list[float]]
Certificate = dict[str, Any]
BITS = 64  # of the quaternions
PREFIX = IsotropicStatement.prefix

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


def stated(content: bytes, n: int) -> dict[str, Any]:
    """The `problem` of a certificate."""
    text = base64.b64encode(content).decode()
    return {"data": text, "digest": hashlib.sha256(content).hexdigest(), "n": n}


def dyadic_above(value: Fraction, bits: int = 32) -> list[int]:
    """The least [m, e] of about so many bits that is at least the value > 0."""
    exponent = value.numerator.bit_length() - value.denominator.bit_length() - bits
    return [-((-value) // Fraction(2) ** exponent), exponent]


def top_vector(K: list[list[int]]) -> list[int]:
    """An integer vector near the eigenvector of the largest eigenvalue: power iteration."""
    shift = max(sum(map(abs, row)) for row in K)
    q = [1 << BITS, 3 << BITS - 3, 5 << BITS - 4, 7 << BITS - 5]
    for _ in range(4000):
        image = [sum(a * b for a, b in zip(row, q, strict=True)) for row in K]
        q = [a + shift * b for a, b in zip(image, q, strict=True)]
        cut = max(map(abs, q)).bit_length() - BITS
        q = [c >> cut if cut > 0 else c << -cut for c in q]
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
        "about": {"made by": "vectors/make.py"},
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
        "format": "certreg-certificate/1",
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


def refused(good: Certificate) -> dict[str, tuple[Certificate, str]]:
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

    def lower(pair: list[int]) -> list[int]:
        return [pair[0] - 1, pair[1]]

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
        "data-of-another-digest": (
            "data",
            {"problem": good["problem"] | {"digest": "0" * 64}},
        ),
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


def counted(certificate: Certificate, chart: list[int], modulus: int = 2**61 - 1) -> Certificate:
    """A certificate of the count, of the same data."""
    return {
        "about": certificate["about"],
        "claims": {"at_most": 4},
        "format": certificate["format"],
        "kind": "count",
        "problem": certificate["problem"],
        "proof": {"chart": chart, "modulus": modulus},
    }


def counts() -> dict[str, tuple[Certificate, str]]:
    """Certificates of the count, and forgeries, each with the class of reason."""
    first = [1, 0, 0, 0]
    good = counted(produced(*ACCEPTED["pattern-1111"]), first)
    half_turn = produced(stretched(3, 2, 1), stretched(-3, -2, -1))
    circle = produced(*ACCEPTED["pattern-121"])
    return {
        "accept-count.json": (good, ""),
        "accept-count-claims-less.json": (good | {"claims": {"at_most": 9}}, ""),
        "accept-count-modulus-not-prime.json": (
            counted(good, first, (2**31 - 1) * (2**31 - 19)),
            "",
        ),
        "accept-count-half-turn.json": (counted(half_turn, [1, 1, 1, 1]), ""),
        "refuse-count-half-turn-at-infinity.json": (counted(half_turn, first), "count"),
        "refuse-count-claims-three.json": (good | {"claims": {"at_most": 3}}, "claim"),
        "refuse-count-of-a-continuum.json": (counted(circle, [1, 1, 1, 1]), "count"),
        "refuse-count-chart-zero.json": (counted(good, [0, 0, 0, 0]), "count"),
        "refuse-count-modulus-one.json": (counted(good, first, 1), "count"),
        "refuse-count-modulus-too-large.json": (counted(good, first, 2**64), "count"),
        "refuse-count-modulus-null.json": (
            good | {"proof": {"chart": first, "modulus": None}},
            "form",
        ),
        "refuse-count-with-a-pose.json": (good | {"pose": first}, "form"),
        "refuse-count-data-of-another-digest.json": (
            good | {"problem": good["problem"] | {"digest": "0" * 64}},
            "data",
        ),
    }


SPRINGS_PREFIX = b"certreg-springs/1\0"
PLANES: Points = [[0, 0, 0], [3, 1, 0], [1, 4, 1], [2, 2, 5], [-3, 1, 2]]
PLANES += [[1.0, -2, 3], [4, 0, -1], [-1, 3, -2], [2, -3, 1]]
NORMALS: Points = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [0, 1, 2]]
NORMALS += [[2.0, 0, 1], [1, -1, 1], [1, 2, -1], [-1, 1, 2]]
ERRORS: Points = [[1, -1, 0], [0, 1, 1], [-1, 0, 1], [1, 1, -1], [0, -1, 0]]
ERRORS += [[1.0, 0, 1], [-1, 1, 0], [0, 0, 1], [1, -1, -1]]
TURNED: Points = [  # by a quarter turn about z, and a shift; off by up to 1/8
    [7 - y + a / 8, x + 1 + b / 8, z + 2 + c / 8]
    for (x, y, z), (a, b, c) in zip(PLANES, ERRORS, strict=True)
]
# What certreg found once, with a solver: of planes in general position, and of planes all parallel.
GENERAL: dict[str, Any] = {
    "claims": {
        "gap": [2205355663, -120],
        "sin2_half_angle": [1834837094, -123],
        "unique": True,
    },
    "proof": {
        "gram": [
            *(4005630311360905, -44344306320826, -1577503030733836, 6519920298018290),
            *(2971695871727029, -1177302086677434, -736742296157968, -387339885892141),
            *(2602310563760151, -336299755938355, 906200884594510, 1555385594851224),
            *(-465101769402506, 463456242043943, 3378179327285240, 3249647832640826),
            *(3685343170898476, -91674552630399, -1711720969856039, 4917319840272030, 59),
        ],
        "level": 100460988330470909566998103911,
        "mu": 48756292349941722115310098579456,
        "pose": [398094154348274381, 14708830154647102, 11214660839124018, 416516416144317683],
        "symmetry": None,
        "unit": -102,
    },
}
WALL: dict[str, Any] = {
    "claims": {"gap": [1339390824, -49], "sin2_half_angle": None, "unique": False},
    "proof": {
        "gram": [
            *(5375985239963490, -832525438396608, -5668698521175186, 6339201339812834),
            *(-1764924067368919, 545550428178562, 1228730843560079, -547047363672657),
            *(3925234975445238, -437784424088540, 1934806811125897, 4450733085995033),
            *(-3947961275644954, 95949535701648, 5066752627937934, 78522076184602),
            *(4056906023888002, -4923998861118398, -2057173962991119, 5185475778827995, 58),
        ],
        "level": 608517483946628524789047036498,
        "mu": 0,
        "pose": [165481536545313904, -396509028995307290, -138461910666068051, -358513248330840990],
        "symmetry": [1, 2, 2, 0, 0, 0],
        "unit": -100,
    },
}


def squares(found: dict[str, Any], normals: Points, **entries: Any) -> Certificate:
    """A certificate of planes by a sum of squares, with other entries of claims and proof."""
    content = spring_bytes(PLANES, TURNED, normals)
    parts = {
        part: {name: entries.get(name, value) for name, value in found[part].items()}
        for part in ("claims", "proof")
    }
    head = {"about": {"made by": "vectors/make.py"}, "format": "certreg-certificate/1"}
    return {**head, "kind": "springs-sos", "problem": stated(content, len(PLANES)), **parts}


def springs() -> dict[str, tuple[Certificate, str]]:
    """Certificates of general springs, and forgeries, each with the class of reason."""
    proof, claims = GENERAL["proof"], GENERAL["claims"]
    good, one_wall = squares(GENERAL, NORMALS), [[1.0, 2.0, 2.0]] * 9
    w, x, y, z = proof["pose"]

    def lower(pair: list[int]) -> list[int]:
        return [pair[0] - 1, pair[1]]

    def planes(**entries: Any) -> Certificate:
        return squares(GENERAL, NORMALS, **entries)

    wrong_sign = [[-1, 1, 1], *NORMALS[1:]]
    others = {"digest": "0" * 64}
    return {
        "accept-springs-sos.json": (good, ""),
        "accept-springs-sos-claims-less.json": (planes(sin2_half_angle=None, unique=None), ""),
        "accept-springs-sos-longer-pose.json": (planes(pose=[3 * k for k in (w, x, y, z)]), ""),
        "accept-springs-sos-wall.json": (squares(WALL, one_wall), ""),
        "refuse-springs-gap-too-small.json": (planes(gap=lower(claims["gap"])), "claim"),
        "refuse-springs-angle-too-small.json": (
            planes(sin2_half_angle=lower(claims["sin2_half_angle"])),
            "claim",
        ),
        "refuse-springs-unique-of-a-wall.json": (squares(WALL, one_wall, unique=True), "claim"),
        "refuse-springs-no-symmetry.json": (
            squares(WALL, one_wall, symmetry=[1, 2, 3, 0, 0, 0]),
            "claim",
        ),
        "refuse-springs-level-too-high.json": (planes(level=2 * proof["level"]), "optimality"),
        "refuse-springs-mu-too-large.json": (planes(mu=64 * proof["mu"]), "optimality"),
        "refuse-springs-pose-half-a-turn-off.json": (planes(pose=[-x, w, -z, y]), "optimality"),
        "refuse-springs-pose-zero.json": (planes(pose=[0] * 4), "optimality"),
        "refuse-springs-gram-other.json": (
            planes(gram=[0, *proof["gram"][1:]]),
            "optimality",
        ),
        "refuse-springs-gram-too-short.json": (planes(gram=proof["gram"][1:]), "form"),
        "refuse-springs-of-another-normal.json": (squares(GENERAL, wrong_sign), "optimality"),
        "refuse-springs-digest.json": (good | {"problem": good["problem"] | others}, "data"),
    }


Plane = tuple[float, tuple[float, ...], tuple[float, ...], float]
# l, n, x, s: the energy l^2 (n.R x - s)^2, with its mirror image, so that the best shift is 0.
X, Y, Z = (1.0, 0, 0), (0, 1.0, 0), (0, 0, 1.0)
DIAGONALS = [(0.0, 1, 1), (0.0, 1, -1), (1.0, 0, 1), (1.0, 0, -1), (1.0, 1, 0), (1.0, -1, 0)]
CHOI_LAM: list[Plane] = [  # 64 (w^4 + x^2 y^2 + y^2 z^2 + z^2 x^2 - 4 wxyz) + 15
    *[(k, n, x, 0.0) for n, x in ((X, Y), (Y, Z)) for k in (2.0, 1.0, 1.0)],
    *[(2.0, Z, X, 0.0), (1.0, Y, Y, 0.0), (1.0, Y, Y, 0.0)],
    *[(1.0, n, n, -0.5) for n in DIAGONALS],
]
TWO_OPTIMA: list[Plane] = [  # 64 (1 - w^4 - x^4) + 1: the identity and the half turn about x
    *[(2.0, X, X, 0.75), (2.0, X, X, 0.75), (4.0, X, Y, 0.0), (4.0, X, Z, 0.0)],
    *[(2.0, Y, Z, 0.0), (2.0, Z, Y, 0.0)],
    *[(1.0, n, X, 0.0) for n in (Y, Z) for _ in range(2)],
    *[(1.0, a, b, 0.0) for a, b in (DIAGONALS[:2], DIAGONALS[1::-1])],
]
ALONG = [398094154348274381, 14708830154647102, 11214660839124018, 416516416144317683]
CONES: dict[str, dict[str, Any]] = {  # what is claimed and proved of each
    "general": {
        "claims": {"gap": [1, -100], "sin2_half_angle": [1, -104], "unique": True},
        "proof": {"caps": [*ALONG, 46, 0], "mu": [23, 0], "pose": ALONG, "symmetry": None},
    },
    "wall": {
        "claims": {"gap": [1, -10], "sin2_half_angle": None, "unique": False},
        "proof": {
            "caps": [],
            "mu": [0, 0],
            "pose": WALL["proof"]["pose"],
            "symmetry": WALL["proof"]["symmetry"],
        },
    },
    "choi-lam": {
        "claims": {"gap": [1, -20], "sin2_half_angle": None, "unique": None},
        "proof": {
            "caps": [
                *(1, 1, 1, 1, 15, 0, 1, 1, -1, -1, 15, 0),
                *(1, -1, 1, -1, 15, 0, 1, -1, -1, 1, 15, 0),
            ],
            "mu": [0, 0],
            "pose": [1, 1, 1, 1],
            "symmetry": None,
        },
    },
    "tie": {
        "claims": {"gap": [1, -100], "sin2_half_angle": None, "unique": False},
        "proof": {
            "caps": [1, 0, 0, 0, 60, 0, 0, 1, 0, 0, 60, 0],
            "mu": [0, 0],
            "pose": [1, 0, 0, 0],
            "symmetry": None,
        },
    },
}


def spring_bytes(source: Points, target: Points, normals: Points) -> bytes:
    """The bytes that the digest binds, of planes."""
    factors = [[a, b, 0, c, 0, 0] for a, b, c in normals]
    numbers = [*chain(*source), *chain(*target), *chain(*factors)]
    return SPRINGS_PREFIX + struct.pack(f"<Q{len(numbers)}d", len(source), *map(float, numbers))


def mirrored(planes: list[Plane]) -> tuple[Points, Points, Points]:
    """Source, target and normals."""
    both = [(sign, *plane) for plane in planes for sign in (1.0, -1.0)]
    return (
        [[sign * c + 0.0 for c in x] for sign, _, _, x, _ in both],
        [[sign * s * c / sum(k * k for k in n) + 0.0 for c in n] for sign, _, n, _, s in both],
        [[k * c + 0.0 for c in n] for _, k, n, _, _ in both],
    )


def cones_of(name: str, **entries: Any) -> Certificate:
    """A certificate by cones and caps, with other entries of claims and proof, or other planes."""
    planes = {
        "general": (PLANES, TURNED, NORMALS),
        "wall": (PLANES, TURNED, [[1.0, 2.0, 2.0]] * 9),
        "choi-lam": mirrored(CHOI_LAM),
        "tie": mirrored(TWO_OPTIMA),
    }
    source, target, normals = entries.get("planes", planes[name])
    parts = {
        part: {key: entries.get(key, value) for key, value in CONES[name][part].items()}
        for part in ("claims", "proof")
    }
    head = {"about": {"made by": "vectors/make.py"}, "format": "certreg-certificate/1"}
    problem = stated(spring_bytes(source, target, normals), len(source))
    return {**head, "kind": "springs-cones", "problem": problem, **parts}


def cones() -> dict[str, tuple[Certificate, str]]:
    """Certificates by cones, and forgeries, each with the class of reason."""
    good, caps = cones_of("general"), CONES["tie"]["proof"]["caps"]
    w, x, y, z = ALONG
    lower = [*TWO_OPTIMA, (2.0**-10, Y, Y, 1.0)]  # at the identity than at the half turn
    others = {"digest": "0" * 64}
    accepted = {
        "": good,
        "-claims-less": cones_of("general", gap=[1, 0], sin2_half_angle=None, unique=None),
        "-without-caps": cones_of("general", caps=[]),
        "-wall": cones_of("wall"),
        "-choi-lam": cones_of("choi-lam"),
        "-tie": cones_of("tie"),
    }
    refused = {
        "angle-too-small": (cones_of("general", sin2_half_angle=[1, -105]), "claim"),
        "unique-of-choi-lam": (cones_of("choi-lam", unique=True), "claim"),
        "unique-of-a-wall": (cones_of("wall", unique=True), "claim"),
        "unique-of-a-tie": (cones_of("tie", unique=True), "claim"),
        "no-symmetry": (cones_of("choi-lam", unique=False, symmetry=[1, 0, 0, 0, 0, 0]), "claim"),
        "no-tie": (cones_of("tie", planes=mirrored(lower)), "claim"),
        "tie-with-growth": (cones_of("tie", mu=[1, -60]), "optimality"),
        "tie-of-one-cap": (cones_of("tie", caps=caps[:6]), "cones"),
        "gap-zero": (cones_of("general", gap=[0, 0]), "optimality"),
        "mu-negative": (cones_of("general", mu=[-1, 0]), "optimality"),
        "mu-too-large": (cones_of("general", mu=[40, 0]), "cones"),
        "pose-zero": (cones_of("general", pose=[0] * 4), "optimality"),
        "pose-half-a-turn-off": (cones_of("general", pose=[-x, w, -z, y]), "cones"),
        "pose-of-the-greatest-energy": (cones_of("choi-lam", pose=[1, 0, 0, 0]), "cones"),
        "curvature-too-large": (cones_of("general", caps=[*ALONG, 47, 0]), "cones"),
        "curvature-zero": (cones_of("general", caps=[*ALONG, 0, 0]), "cones"),
        "cap-without-centre": (cones_of("general", caps=[*ALONG, 46, 0, *[0] * 4, 1, 0]), "cones"),
        "thirteen-caps": (cones_of("general", caps=[*ALONG, 46, 0] * 13), "form"),
        "half-a-cap": (cones_of("general", caps=ALONG), "form"),
        "of-another-normal": (
            cones_of("general", planes=(PLANES, TURNED, [[-1, 1, 1], *NORMALS[1:]])),
            "cones",
        ),
        "digest": (good | {"problem": good["problem"] | others}, "data"),
    }
    return {
        **{f"accept-springs-cones{name}.json": (each, "") for name, each in accepted.items()},
        **{f"refuse-springs-cones-{name}.json": pair for name, pair in refused.items()},
    }


REAL_LINES = [  # of the planes in general position, as certreg found them; x, y, z over 2^40
    (-6730701457, -1979938336074, 712290049079),
    (1296540500142, 593186566569, 1364008539356),
    (4126821457054, -724657492632, 4200057890873),
    (-418284763625, 623093715684, -542198197559),
    (-328508068267, -17107328549, -282002101720),
    (-2164816984891, -722889005758, -1405600329418),
    (-1444477283821, -171620133917, -1048108227944),
    (849372535676, -275195365868, 325587054377),
    (3167789690862, 2246176795939, -346082429066),
    (-4394072363618, 2322527874949, 1838347900664),
]
PAIRS_OF_LINES = [  # x + i x', ..., of two conjugate ones one
    (182993455361, 267669013371, -144717126670, -201750638223, 1980773242014, 212538395200),
    (128166818483, 177132666376, 415565912056, 23315305770, -56589426918, 161289618132),
    (803289063649, 449919862719, 385811687269, -439920755603, -191208281565, -534203566412),
    (146365228807, 117049013683, -1861354581711, -1281720708702, 348825261236, 1430215388834),
    (-704752387263, 487902332002, -2193926366260, 176415588811, 1346943427942, -608467860784),
    (334135104874, 603109519355, 356347320462, -1932027493, -59998058017, 284203694325),
    (-49570936600, 134136519350, -171081883584, -61314262231, 578730629846, 14513349314),
    (1589585814028, 996513728949, 4304345329916, -2144863191027, 198669974206, -1915261794422),
    (-424662421056, 729686197595, -1494102435420, -85606225282, 292831970882, -226418048881),
    (971639645259, 205235367919, 1009018237901, -52512751340, -872355094730, 35082297455),
    (-607036689297, 955262825893, -1165977032166, -1651064423664, -23080509141, 1470961875825),
    (363864425664, 1092196120651, 648255495800, 4232958082, 714007523037, 432491426680),
    (-1873050266342, 287265722619, 1212817075847, -4178644600806, -32183183293, -3089477299303),
    (706524150999, 529743547133, -1955042483856, -892210643156, -3629109504026, -862921277236),
    (312341833878, 255420290305, -119776873333, -10498087017, -125294184724, 50544124560),
]

LISTED: dict[str, Any] = {
    "claims": {
        "gap": [2023748552, -91],
        "indices": [0, 0, 1, 1, 1, 1, 2, 2, 2, 3],
        "second": [2531873681, -25],
        "sin2_half_angle": [1381791418, -111],
        "unique": True,
    },
    "proof": {
        "bits": 40,
        "chart": [-7, 8, -8, -2],
        "lines": [
            *[k for line in REAL_LINES for entry in line for k in (entry, 0)],
            *[k for line in PAIRS_OF_LINES for k in line],
        ],
        "modulus": 2**31 - 1,
        "pose": [-22057662373210, -814989132373, -621383659408, -23078405899353],
    },
}


def forty_real() -> Certificate:
    """Of +-e_j on the plane through 0 with the normal e_j, where f = 8 sum q_i^4/|q|^4 - 2.

    All 40 critical lines are real, their entries are 0, 1, -1; with k entries that are not 0 the
    index is 4 - k, and f is 8/k - 2. None is orthogonal to the chart a = (1, 2, 4, 8).
    """
    bits, (a, b, c, d) = 64, (1, 2, 4, 8)
    known = [q for q in product((0, 1, -1), repeat=4) if next(filter(None, q), 0) == 1]
    known.sort(key=lambda q: -sum(map(abs, q)))
    lines = list[int]()
    for w, x, y, z in known:  # p = conj(a) q over its first entry, rounded
        first = a * w + b * x + c * y + d * z
        others = (a * x - b * w - c * z + d * y, a * y + b * z - c * w - d * x)
        others = (*others, a * z - b * y + c * x - d * w)
        lines += [k for p in others for k in (((p << bits + 1) // first + 1) // 2, 0)]
    x, y, z = lines[:6:2]
    w = 1 << bits
    pose = [a * w - b * x - c * y - d * z, b * w + a * x - d * y + c * z]
    pose += [c * w + d * x + a * y - b * z, d * w - c * x + b * y + a * z]
    axes: Points = [[s * float(k == j) + 0.0 for k in range(3)] for j in range(3) for s in (1, -1)]
    normals = [[abs(k) for k in point] for point in axes]
    return {
        "about": {"made by": "vectors/make.py"},
        "claims": {
            "gap": [1, -100],
            "indices": [4 - sum(map(abs, q)) for q in known],
            "second": [-1, -100],
            "sin2_half_angle": None,
            "unique": None,
        },
        "format": "certreg-certificate/1",
        "kind": "springs-list",
        "problem": stated(spring_bytes(axes, [[0.0] * 3] * 6, normals), 6),
        "proof": {
            "bits": bits,
            "chart": [a, b, c, d],
            "lines": lines,
            "modulus": 2**31 - 1,
            "pose": pose,
        },
    }


def changed(good: Certificate, **entries: Any) -> Certificate:
    """With other entries of claims and proof."""
    parts = {
        part: {key: entries.get(key, value) for key, value in good[part].items()}
        for part in ("claims", "proof")
    }
    return {**good, **parts}


def lists() -> dict[str, tuple[Certificate, str]]:
    """Certificates of all equilibria, and forgeries, each with the class of reason."""
    problem = stated(spring_bytes(PLANES, TURNED, NORMALS), len(PLANES))
    head = {"about": {"made by": "vectors/make.py"}, "format": "certreg-certificate/1"}
    good = {**head, **LISTED, "kind": "springs-list", "problem": problem}
    claims, proof, forty = LISTED["claims"], LISTED["proof"], forty_real()
    lines, pose = proof["lines"], proof["pose"]
    real, pair = lines[:6], lines[60:66]
    mirrored = [(-1) ** k * entry for k, entry in enumerate(pair)]
    normals = [[-1, 1, 1], *NORMALS[1:]]
    less = {"gap": [1, 0], "second": [-1, 0], "sin2_half_angle": None, "unique": None}
    accepted = {
        "": good,
        "-claims-less": changed(good, **less),
        "-longer-pose": changed(good, pose=[-3 * k for k in pose]),
        "-modulus-not-prime": changed(good, modulus=10007 * 10009),
        "-forty-real": forty,
    }
    refused = {
        "gap-too-small": (changed(good, gap=[1, -63]), "claim"),
        "angle-too-small": (changed(good, sin2_half_angle=[1381791417, -111]), "claim"),
        "second-too-large": (changed(good, second=[2531873682, -25]), "claim"),
        "index-other": (changed(good, indices=[0, 1, *claims["indices"][2:]]), "claim"),
        "an-index-less": (changed(good, indices=claims["indices"][1:]), "claim"),
        "not-unique": (changed(good, unique=False), "claim"),
        "unique-of-eight": (changed(forty, unique=True), "claim"),
        "angle-of-eight": (changed(forty, sin2_half_angle=[1, 0]), "claim"),
        "line-left-out": (changed(good, lines=lines[6:]), "list"),
        "line-twice": (changed(good, lines=[*real, *real, *lines[12:]]), "list"),
        "pair-twice": (changed(good, lines=[*lines[:66], *pair, *lines[72:]]), "list"),
        "pair-and-mirror-image": (
            changed(good, lines=[*lines[:66], *mirrored, *lines[72:]]),
            "list",
        ),
        "box-off": (changed(good, lines=[real[0] + 2, *lines[1:]]), "list"),
        "bits-other": (changed(good, bits=41), "list"),
        "chart-other": (changed(good, chart=[-7, 8, -8, -1]), "list"),
        "chart-of-a-plane-through-lines": (changed(forty, chart=[1, 1, 0, 0]), "list"),
        "chart-zero": (changed(good, chart=[0] * 4), "list"),
        "modulus-one": (changed(good, modulus=1), "list"),
        "modulus-two": (changed(good, modulus=2), "list"),
        "pose-of-another": (changed(good, pose=[*pose[:3], pose[3] + 1]), "list"),
        "pose-zero": (changed(good, pose=[0] * 4), "list"),
        "half-a-line": (changed(good, lines=lines[:-3]), "form"),
        "of-another-normal": (
            {**good, "problem": stated(spring_bytes(PLANES, TURNED, normals), 9)},
            "list",
        ),
        "digest": ({**good, "problem": problem | {"digest": "0" * 64}}, "data"),
    }
    return {
        **{f"accept-springs-list{name}.json": (each, "") for name, each in accepted.items()},
        **{f"refuse-springs-list-{name}.json": entry for name, entry in refused.items()},
    }


def vectors() -> dict[str, tuple[bytes, str]]:
    """Content and class by file name; the class of an accepted one is empty."""
    found = {
        f"accept-{name}.json": (dumped(produced(*pair)), "") for name, pair in ACCEPTED.items()
    }
    good = produced(*ACCEPTED["pattern-1111"])
    for name, (certificate, reason) in refused(good).items():
        found[f"refuse-{name}.json"] = dumped(certificate), reason
    circle = produced(*ACCEPTED["pattern-211"])
    circle["claims"]["unique"] = True
    found["refuse-unique-where-it-is-not.json"] = dumped(circle), "claim"
    twice = dumped(good).replace(
        b'"kind": "isotropic"', b'"kind": "isotropic", "kind": "isotropic"'
    )
    found["refuse-key-twice.json"] = twice, "form"
    for name, (certificate, reason) in (counts() | springs() | cones() | lists()).items():
        found[name] = dumped(certificate), reason
    return found


def dumped(certificate: Certificate) -> bytes:
    """The file's content."""
    return json.dumps(certificate, sort_keys=True).encode() + b"\n"


def manifest(found: dict[str, tuple[bytes, str]]) -> bytes:
    """What a checker must say of each file."""
    entries = [
        {
            "file": name,
            "reason": reason or None,
            "sha256": hashlib.sha256(content).hexdigest(),
            "verdict": "REFUSED" if reason else "VERIFIED",
        }
        for name, (content, reason) in sorted(found.items())
    ]
    return (json.dumps({"schema": "certreg-vectors/1", "vectors": entries}, indent=1)).encode()


def write(folder: Path) -> None:
    """All files, into a folder."""
    found = vectors()
    for name, (content, _) in found.items():
        (folder / name).write_bytes(content)
    (folder / "manifest.json").write_bytes(manifest(found) + b"\n")


if __name__ == "__main__":
    write(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
