"""Certificates of kind `count`, and forgeries."""

from __future__ import annotations

from envelope import Certificate, Vectors, of_another_digest
from isotropic import ACCEPTED, produced, stretched


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


def vectors() -> Vectors:
    """Certificates of the count, and forgeries."""
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
        "refuse-count-data-of-another-digest.json": (of_another_digest(good), "data"),
    }
