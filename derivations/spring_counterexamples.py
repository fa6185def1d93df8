"""Exact counterexamples to the paper's conjecture where springs are planes, in small integers."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import product
from typing import Any

import sympy

from certreg.geometry.so3 import body_frame, squared_norm
from certreg.objective.springs import Springs

from .claims.forty_real import POINTS as CORNERS
from .claims.stable_spurious import HALF_TURNS, PLANES
from .counterexamples import IDENTITY, Counterexample
from .rationals import ExactPlanes, rotation_of


def _stable(planes: ExactPlanes) -> list[Any]:
    """Energies at I and at the half turns about the axes; at these: a rest, and a minimum."""
    f = planes.objective
    found: list[Any] = [planes.energy(IDENTITY)]
    for q in HALF_TURNS:
        level = planes.energy(rotation_of(q))
        found += [level, level == f.energy(q), *_resting(f, q)]
    return found


def _forty(planes: ExactPlanes) -> list[Any]:
    """How many sign vectors are equilibria, how many of them minima, and at which energies."""
    f = planes.objective
    lines = [q for q in product((0, 1, -1), repeat=4) if next((e for e in q if e), 0) == 1]
    seen = [_resting(f, q) for q in lines]
    levels = [planes.energy(rotation_of(q)) for q in lines]
    best = {level for level, (_, held) in zip(levels, seen, strict=True) if held}
    counts = [sum(column) for column in zip(*seen, strict=True)]
    return [*counts, len(best), min(best, default=None), max(levels)]


def _resting(f: Springs, q: Sequence[int]) -> tuple[bool, bool]:
    """Whether R(q) is an equilibrium, and whether the Hessian there is positive definite."""
    level, norm = 4 * f.value(q), squared_norm(q)
    still = all(norm * g == level * e for g, e in zip(f.gradient(q), q, strict=True))
    frame = sympy.Matrix(body_frame(tuple(q)))
    H: Any = norm * frame.T * sympy.Matrix(f.hessian(q)) * frame - level * norm * sympy.eye(3)
    return still, all(bool(H[:k, :k].det() > 0) for k in (1, 2, 3))


STABLE = Counterexample(
    words="the points ±eⱼ on the planes with normal eⱼ, and ±3eⱼ on the other two coordinate "
    "planes, 18 pairs, each point its own target: the energy is 0 at R = I and nowhere else; at "
    "the half turn about each axis it is 16, and a strict minimum",
    clouds=(
        ExactPlanes(
            source=tuple(point for point, _ in PLANES),
            target=tuple(point for point, _ in PLANES),
            normals=tuple(normal for _, normal in PLANES),
        ),
    ),
    found=_stable,
    expected=(Fraction(0), *(Fraction(16), True, True, True) * 3),
)
FORTY = Counterexample(
    words="the points ±eⱼ on the planes through the origin with normal eⱼ, six pairs: all vectors "
    "with entries 0, 1, −1 are equilibria, 40 rotations, eight of them minima, with the energy 0; "
    "the largest is 6",
    clouds=(
        ExactPlanes(
            source=CORNERS,
            target=((0, 0, 0),) * 6,
            normals=tuple(tuple(map(abs, point)) for point in CORNERS),
        ),
    ),
    found=_forty,
    expected=(40, 8, 1, Fraction(0), Fraction(6)),
)
