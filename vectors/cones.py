"""Certificates of kind `springs-cones`, and forgeries."""

from __future__ import annotations

from typing import Any

from envelope import Certificate, Vectors, of_another_digest
from planes import ANOTHER_NORMAL, GENERAL, WALL, Planes, certificate, changed
from squares import OF_A_WALL

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
            "pose": OF_A_WALL["proof"]["pose"],
            "symmetry": OF_A_WALL["proof"]["symmetry"],
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


def mirrored(planes: list[Plane]) -> Planes:
    """Each of the planes, and its mirror image."""
    both = [(sign, *plane) for plane in planes for sign in (1.0, -1.0)]
    return Planes(
        [[sign * c + 0.0 for c in x] for sign, _, _, x, _ in both],
        [[sign * s * c / sum(k * k for k in n) + 0.0 for c in n] for sign, _, n, _, s in both],
        [[k * c + 0.0 for c in n] for _, k, n, _, _ in both],
    )


def of(name: str, planes: Planes) -> Certificate:
    """A certificate by cones and caps, as it was found of planes by that name."""
    return certificate("springs-cones", planes, CONES[name])


def vectors() -> Vectors:
    """Certificates by cones, and forgeries."""
    good, wall = of("general", GENERAL), of("wall", WALL)
    choi_lam, tie = of("choi-lam", mirrored(CHOI_LAM)), of("tie", mirrored(TWO_OPTIMA))
    w, x, y, z = ALONG
    lower = [*TWO_OPTIMA, (2.0**-10, Y, Y, 1.0)]  # at the identity than at the half turn
    accepted = {
        "": good,
        "-claims-less": changed(good, gap=[1, 0], sin2_half_angle=None, unique=None),
        "-without-caps": changed(good, caps=[]),
        "-wall": wall,
        "-choi-lam": choi_lam,
        "-tie": tie,
    }
    refused = {
        "angle-too-small": (changed(good, sin2_half_angle=[1, -105]), "claim"),
        "unique-of-choi-lam": (changed(choi_lam, unique=True), "claim"),
        "unique-of-a-wall": (changed(wall, unique=True), "claim"),
        "unique-of-a-tie": (changed(tie, unique=True), "claim"),
        "no-symmetry": (changed(choi_lam, unique=False, symmetry=[1, 0, 0, 0, 0, 0]), "claim"),
        "no-tie": (of("tie", mirrored(lower)), "claim"),
        "tie-with-growth": (changed(tie, mu=[1, -60]), "optimality"),
        "tie-of-one-cap": (changed(tie, caps=tie["proof"]["caps"][:6]), "cones"),
        "gap-zero": (changed(good, gap=[0, 0]), "optimality"),
        "mu-negative": (changed(good, mu=[-1, 0]), "optimality"),
        "mu-too-large": (changed(good, mu=[40, 0]), "cones"),
        "pose-zero": (changed(good, pose=[0] * 4), "optimality"),
        "pose-half-a-turn-off": (changed(good, pose=[-x, w, -z, y]), "cones"),
        "pose-of-the-greatest-energy": (changed(choi_lam, pose=[1, 0, 0, 0]), "cones"),
        "curvature-too-large": (changed(good, caps=[*ALONG, 47, 0]), "cones"),
        "curvature-zero": (changed(good, caps=[*ALONG, 0, 0]), "cones"),
        "cap-without-centre": (changed(good, caps=[*ALONG, 46, 0, *[0] * 4, 1, 0]), "cones"),
        "thirteen-caps": (changed(good, caps=[*ALONG, 46, 0] * 13), "form"),
        "half-a-cap": (changed(good, caps=ALONG), "form"),
        "of-another-normal": (
            of("general", ANOTHER_NORMAL),
            "cones",
        ),
        "digest": (of_another_digest(good), "data"),
    }
    return {
        **{f"accept-springs-cones{name}.json": (each, "") for name, each in accepted.items()},
        **{f"refuse-springs-cones-{name}.json": pair for name, pair in refused.items()},
    }
