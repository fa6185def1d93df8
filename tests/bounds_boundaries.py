"""What the checker must say of bounds: how large they are, and where they hold every pair anyhow.

Cases as those of `checker_boundaries`: what is right is seen from points on the axes.
"""

from __future__ import annotations

import base64
import hashlib
import struct
from fractions import Fraction
from functools import cache
from itertools import chain, product
from typing import TYPE_CHECKING, Any

from checker_boundaries import Case, axes, counted, limited, outcome_of

if TYPE_CHECKING:
    from collections.abc import Iterator

Points = list[list[float]]
Certificate = dict[str, Any]
UP = 80  # above the binary exponent of any scale that is asked about
HOLD = r"\nThese bounds hold every pair at any rotation: they tell none from another\.\n"
SMALL = (
    r"\nThese bounds hold .* rotation, if the scale is small enough: they tell none from another"
)
POINTS: Points = [  # their box has its middle at 0
    *([3.0, 0.0, 0.0], [-3.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]),
    *([0.0, 0.0, 2.0], [0.0, 0.0, -2.0]),
]
ORIGIN: Points = [[0.0, 0.0, 0.0]] * 6
HALVES: Points = [[k / 2 for k in point] for point in POINTS]
AWAY: Points = [[k + 5.0 for k in point] for point in POINTS]
CUBE: Points = [[float(i), float(j), float(k)] for i, j, k in product((0, 1), repeat=3)]
LENGTHS = [6.0, 6.0, 2.0, 2.0, 4.0, 4.0]  # twice those of POINTS
LESS = [6.0, 6.0, 2.0, 2.0, 4.0 - 2.0**-50, 4.0]
PREFIXES = {
    "consensus": b"certreg-consensus/1\0",
    "consensus-similarity": b"certreg-consensus-similarity/1\0",
    "truncated-rotation": b"certreg-truncated-rotation/1\0",
}


def of_bounds(certificate: Certificate) -> Certificate:
    """What is true of pairs with bounds that hold all of them, at the pose or the witness, too."""
    n = certificate["problem"]["n"]
    if certificate["kind"] == "truncated-rotation":
        claims = {"gap": [1, 0], "labels": "1" * n, "sin2_half_angle": None, "unique": False}
        return certificate | {"claims": claims, "optimality": {"mu": [0, 0]}}
    all_ = {"labels": "i" * n, "upper": n}
    whole = {name: part for name, part in certificate.items() if name != "reach"} | {"fit": None}
    if certificate["kind"] == "consensus":
        return whole | {"claims": all_, "stages": [[n, n, []]]}
    scales = {"scale_lower": [0, 0], "scale_upper": [1, UP], "states": "="}
    return whole | {"claims": all_ | scales, "pieces": [[None, [[n, n, []]]]]}


def held(kind: str, source: Points, target: Points, bounds: list[float]) -> Certificate:
    """Of pairs that all are within their bounds at the identity, or with a scale of 2^-9."""
    n = len(source)
    doubles = [*chain(*source, *target), *[1.0] * n, *bounds]
    content = PREFIXES[kind] + struct.pack(f"<Q{len(doubles)}d", n, *doubles)
    text, digest = base64.b64encode(content).decode(), hashlib.sha256(content).hexdigest()
    stated = {"about": {}, "format": "certreg-certificate/1", "kind": kind}
    stated |= {"problem": {"data": text, "digest": digest, "n": n}}
    if kind == "truncated-rotation":
        return of_bounds(stated | {"pose": [1, 0, 0, 0]})
    witness = {"quaternion": [1, 0, 0, 0], "shift": [0, 0, 0, 0]}
    if kind == "consensus":
        return of_bounds(stated | {"witness": witness})
    return of_bounds(stated | {"scale": "asymmetric", "witness": witness | {"factor": [1, -9]}})


def holding_cases() -> Iterator[Case]:
    """Of a rotation alone the middles are 0. The last but one: where b = |x| - |y|."""
    rigid, scaled, turned = PREFIXES
    for name, kind, source, target, bounds, told in (
        ("targets at one point", rigid, POINTS, ORIGIN, [1e12] * 6, HOLD),
        ("just as large", rigid, POINTS, ORIGIN, [3.0] * 6, HOLD),
        ("each its own", rigid, POINTS, POINTS, LENGTHS, HOLD),
        ("one less", rigid, POINTS, POINTS, LESS, ""),
        ("all but one less", rigid, POINTS, POINTS, [0.5] * 5 + [4.0], ""),
        ("differences", rigid, POINTS, HALVES, [1.5, 1.5, 0.5, 0.5, 1.0, 1.0], ""),
        ("elsewhere", rigid, POINTS, AWAY, [9.0] * 6, HOLD),
        ("of targets", scaled, POINTS, POINTS, [3.0 + 2.0**-51, 4.0, 2.0, 2.0, 3.0, 3.0], SMALL),
        ("of targets, one not", scaled, POINTS, POINTS, [3.0, 4.0, 2.0, 2.0, 3.0, 3.0], ""),
        ("turned", turned, POINTS, POINTS, LENGTHS, HOLD),
        ("turned, one less", turned, POINTS, POINTS, LESS, ""),
        ("turned, elsewhere", turned, POINTS, AWAY, [14.0] * 6, HOLD),
        ("turned, not about the middle", turned, AWAY, AWAY, [9.0] * 6, ""),
    ):
        words = f"(?s)VERIFIED.*{told}" if told else r"(?s)VERIFIED(?!.*These bounds hold)"
        yield Case(f"bounds: {name}", outcome_of(held(kind, source, target, bounds)), words)


def number_cases() -> Iterator[Case]:
    """Of the cube sqrt(3)/2 = 0.8660..., or sqrt(3) from the origin; half as much of its target."""
    half: Points = [[k / 2 for k in point] for point in CUBE]
    told = {
        "consensus": r"Bounds: least 0\.9, greatest 1\.5, as given\.\nThe clouds reach at least "
        r"0\.866 \(source\) and 0\.433 \(target\) from the middles of their boxes\.\nOne",
        "truncated-rotation": r"Bounds: least 3, greatest 3, as given\.\nThe clouds reach at least "
        r"1\.73 \(source\) and 0\.866 \(target\) from the origin\.\nThese",
        "consensus-similarity": r"Bounds: least 1000000000000, greatest 2e\+22, as given\.\n",
    }
    bounds = [0.9] * 7 + [1.5], [3.0] * 8, [1e12] * 7 + [2e22]
    for (kind, words), own in zip(told.items(), bounds, strict=True):
        yield Case(
            f"sizes: {kind}", outcome_of(held(kind, CUBE, half, own)), rf"VERIFIED\n.*\n{words}"
        )


def undecided_cases() -> Iterator[Case]:
    """Two of six have no proved label; a certificate of a pose has none."""
    rigid, scaled, turned = (held(kind, POINTS, POINTS, LENGTHS) for kind in PREFIXES)
    for good, labels in ((rigid, "i?ii?i"), (scaled, "??iiii"), (turned, "1111??")):
        some = good | {"claims": good["claims"] | {"labels": labels}}
        name, refused = good["kind"], "REFUSED: undecided pairs: {}; asked for: {}$"
        for most in (2, 3):
            asked = limited(some, undecided=Fraction(most))
            yield Case(f"undecided, {name}: {most}", asked, "VERIFIED")
        asked = limited(some, undecided=Fraction(1))
        yield Case(f"undecided, {name}: 1", asked, refused.format(2, 1))
        yield Case(f"undecided, {name}: 0", limited(good, undecided=Fraction(0)), "VERIFIED")
    asked = limited(counted(axes(), [1, 2, 4, 8], 2**61 - 1), undecided=Fraction(9))
    yield Case("undecided, count", asked, "REFUSED: undecided pairs: no labels; asked for: 9$")


@cache
def bounds_cases() -> list[Case]:
    """All of them."""
    return [*holding_cases(), *number_cases(), *undecided_cases()]
