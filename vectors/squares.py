"""Certificates of kind `springs-sos`, and forgeries."""

from __future__ import annotations

from typing import Any

from envelope import Vectors, lower, of_another_digest
from planes import ANOTHER_NORMAL, GENERAL, WALL, certificate, changed

KIND = "springs-sos"
# What certreg found once, with a solver: of planes in general position, and of planes all parallel.
OF_PLANES: dict[str, Any] = {
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
OF_A_WALL: dict[str, Any] = {
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


def vectors() -> Vectors:
    """Certificates by a sum of squares, and forgeries."""
    good = certificate(KIND, GENERAL, OF_PLANES)
    wall = certificate(KIND, WALL, OF_A_WALL)
    claims, proof = good["claims"], good["proof"]
    w, x, y, z = proof["pose"]
    accepted = {
        "": good,
        "-claims-less": changed(good, sin2_half_angle=None, unique=None),
        "-longer-pose": changed(good, pose=[3 * k for k in (w, x, y, z)]),
        "-wall": wall,
    }
    lower_angle = lower(claims["sin2_half_angle"])
    refused = {
        "gap-too-small": (changed(good, gap=lower(claims["gap"])), "claim"),
        "angle-too-small": (changed(good, sin2_half_angle=lower_angle), "claim"),
        "unique-of-a-wall": (changed(wall, unique=True), "claim"),
        "no-symmetry": (changed(wall, symmetry=[1, 2, 3, 0, 0, 0]), "claim"),
        "level-too-high": (changed(good, level=2 * proof["level"]), "optimality"),
        "mu-too-large": (changed(good, mu=64 * proof["mu"]), "optimality"),
        "pose-half-a-turn-off": (changed(good, pose=[-x, w, -z, y]), "optimality"),
        "pose-zero": (changed(good, pose=[0] * 4), "optimality"),
        "gram-other": (changed(good, gram=[0, *proof["gram"][1:]]), "optimality"),
        "gram-too-short": (changed(good, gram=proof["gram"][1:]), "form"),
        "of-another-normal": (certificate(KIND, ANOTHER_NORMAL, OF_PLANES), "optimality"),
        "digest": (of_another_digest(good), "data"),
    }
    return {
        **{f"accept-springs-sos{name}.json": (each, "") for name, each in accepted.items()},
        **{f"refuse-springs-{name}.json": pair for name, pair in refused.items()},
    }
