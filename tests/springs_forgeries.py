"""Certificates of general springs, spoilt: how a sceptic who cheats would try.

`holds` says by other means whether a certificate of springs is true: the objective in floating
point, descended from many starts, and exact fractions at the pose.
"""

from __future__ import annotations

import copy
import json
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.equilibrium.quartics import FloatingQuartic, descended
from certreg.objective.levelling import levelled

if TYPE_CHECKING:
    import random
    from collections.abc import Iterator

    from springs_certified import Certified

NEAR = 1e-7  # of the range: what descents in doubles tell


def number(pair: list[int]) -> Fraction:
    """Of a mantissa and an exponent."""
    return pair[0] * Fraction(2) ** pair[1]


def minimum_of(case: Certified) -> tuple[Fraction, np.ndarray]:
    """The least objective that descents from many starts meet, and its quaternion."""
    quartic, _ = case.objective.floating_quartic()
    starts = np.random.default_rng(0).standard_normal((60, 4))
    starts /= np.linalg.norm(starts, axis=1, keepdims=True)
    ends = descended(FloatingQuartic.of(levelled(quartic).rest), starts).points
    energies = [case.objective.energy([round(float(c) * 2.0**60) for c in q]) for q in ends]
    best = int(np.argmin([float(e) for e in energies]))
    return energies[best], ends[best]


def holds(document: dict[str, Any], case: Certified, best: tuple[Fraction, np.ndarray]) -> bool:
    """Whether what is claimed is true, as far as doubles tell; of the data of the case."""
    claims, q = document["claims"], document["proof"]["pose"]
    minimum, optimum = best
    above = case.objective.energy(q) - minimum
    scale = case.objective.oscillation
    true = number(claims["gap"]) > above - Fraction(NEAR) ** 2 * scale
    if claims["sin2_half_angle"] is not None:
        unit = np.array([float(c) for c in q]) / float(sum(c * c for c in q)) ** 0.5
        sine = 1 - (unit @ optimum) ** 2
        true = true and float(number(claims["sin2_half_angle"])) > sine - NEAR**1.5
    return true and claims["unique"] is not False


def mutations(document: dict[str, Any], rng: random.Random) -> Iterator[dict[str, Any]]:
    """Without end: one or two entries changed a little, much, or swapped."""
    paths = list(_paths(document))
    while True:
        forged = copy.deepcopy(document)
        for *steps, last in rng.sample(paths, rng.choice((1, 1, 2))):
            part: Any = forged
            for step in steps:
                part = part[step]
            if isinstance(part, dict) or (isinstance(part, list) and last < len(part)):
                part[last] = _other(part[last], rng)
        if forged != document:
            yield forged


def _paths(document: dict[str, Any]) -> Iterator[tuple[Any, ...]]:
    for name in ("claims", "proof"):
        for key, value in document[name].items():
            yield (name, key)
            if isinstance(value, list):
                yield from ((name, key, k) for k in range(len(value)))


def _other(value: Any, rng: random.Random) -> Any:
    if isinstance(value, bool) or value is None:
        return rng.choice([True, False, None, 0, [1, 0], [1, 2, 3, 4, 5, 6]])
    if isinstance(value, int):
        bits = max(value.bit_length(), 1)
        return rng.choice(
            [
                value + rng.choice((-1, 1)) * (1 << rng.randrange(bits + 2)),
                -value,
                0,
                value ^ 1 << rng.randrange(bits),
                value * 2,
                value // 2,
                value + (value >> rng.randrange(1, 40)),
            ]
        )
    if isinstance(value, list):
        other = [*value]
        rng.shuffle(other)
        return rng.choice([other, value[:-1], [*value, 0], [-k for k in value], None])
    return value


def dumped(document: dict[str, Any]) -> bytes:
    """As a file."""
    return json.dumps(document).encode()


def spurious_minima(case: Certified) -> list[tuple[int, int, int, int]]:
    """Stable poses that are not the optimum, as integers of 60 bits."""
    quartic, _ = case.objective.floating_quartic()
    form = FloatingQuartic.of(levelled(quartic).rest)
    starts = np.random.default_rng(1).standard_normal((40, 4))
    starts /= np.linalg.norm(starts, axis=1, keepdims=True)
    ends = descended(form, starts).points
    found: list[tuple[int, int, int, int]] = []
    energies = [case.objective.energy([round(float(c) * 2.0**60) for c in q]) for q in ends]
    least = min(energies)
    for q, energy in zip(ends, energies, strict=True):
        w, x, y, z = (round(float(c) * 2.0**60) for c in q)
        old = np.array(found, dtype=float).reshape(-1, 4) / 2.0**60
        new = bool(np.all(np.abs(old @ q) < 1 - NEAR))
        if energy - least > Fraction(NEAR) * case.objective.oscillation and new:
            found.append((w, x, y, z))
    return found
