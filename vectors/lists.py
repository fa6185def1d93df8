"""Certificates of kind `springs-list`, of all equilibria, and forgeries."""

from __future__ import annotations

from itertools import product
from typing import Any

from envelope import Certificate, Points, Vectors, of_another_digest
from planes import ANOTHER_NORMAL, GENERAL, Planes, certificate, changed

KIND = "springs-list"
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
    found = {
        "claims": {
            "gap": [1, -100],
            "indices": [4 - sum(map(abs, q)) for q in known],
            "second": [-1, -100],
            "sin2_half_angle": None,
            "unique": None,
        },
        "proof": {
            "bits": bits,
            "chart": [a, b, c, d],
            "lines": lines,
            "modulus": 2**31 - 1,
            "pose": pose,
        },
    }
    return certificate(KIND, Planes(axes, [[0.0] * 3] * 6, normals), found)


def vectors() -> Vectors:
    """Certificates of all equilibria, and forgeries."""
    good, forty = certificate(KIND, GENERAL, LISTED), forty_real()
    claims, proof = LISTED["claims"], LISTED["proof"]
    lines, pose = proof["lines"], proof["pose"]
    real, pair = lines[:6], lines[60:66]
    mirrored = [(-1) ** k * entry for k, entry in enumerate(pair)]
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
        "of-another-normal": (certificate(KIND, ANOTHER_NORMAL, LISTED), "list"),
        "digest": (of_another_digest(good), "data"),
    }
    return {
        **{f"accept-springs-list{name}.json": (each, "") for name, each in accepted.items()},
        **{f"refuse-springs-list-{name}.json": entry for name, entry in refused.items()},
    }
