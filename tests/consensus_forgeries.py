"""What a witness of wrong pairs meets, in fractions; what forgers do to stages."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import random

Document = dict[str, Any]
Stages = list[Any]


def rotation(q: Any) -> Any:
    """The rotation matrix of a quaternion of any length."""
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def met_by(witness: Document, points: tuple[Any, Any, Any]) -> frozenset[int]:
    """Which pairs: y - s q x q* / |q|^2 - t is within the bound, s = 1 where there is no factor."""
    w, *v = (Fraction(k) for k in witness["quaternion"])
    *t, e = witness["shift"]
    number, exponent = witness.get("factor", (1, 0))
    factor = number * Fraction(2) ** exponent
    norm, t = w * w + sum(k * k for k in v), [Fraction(k) * Fraction(2) ** e for k in t]
    met = set[int]()
    for i, (x, y, b) in enumerate(zip(*points, strict=True)):
        a = [factor * Fraction(float(k)) for k in x]
        u = [c + w * k for c, k in zip(cross(v, a), a, strict=True)]
        turned = [k + 2 * c / norm for k, c in zip(a, cross(v, u), strict=True)]
        off = [Fraction(float(k)) - p - s for k, p, s in zip(y, turned, t, strict=True)]
        if sum(k * k for k in off) <= Fraction(float(b)) ** 2:
            met.add(i)
    return frozenset(met)


def cross(a: Any, b: Any) -> list[Fraction]:
    """The cross product."""
    return [a[k - 2] * b[k - 1] - a[k - 1] * b[k - 2] for k in range(3)]


def staged(stages: Stages, n: int, rng: random.Random) -> None:
    """Other stages, of n rows, in other places."""
    K = stages[0][0] if stages else 3
    stage = [K + rng.choice((0, 0, 1, -1)), rng.choice((n, rng.randrange(n))), []]
    way = rng.randrange(5)
    if way == 0 or not stages:
        stages.insert(rng.randint(0, len(stages)), stage)
    elif way == 1:
        rng.shuffle(stages)
    elif way == 2:
        rng.choice(stages)[0] += rng.choice((-1, 1))
    elif way == 3:
        rng.choice(stages)[1] = rng.randrange(n + 1)
    else:
        for one in stages:
            one[0] += 1


def stepped(stages: Stages, n: int, rng: random.Random) -> None:
    """Other steps, groups or weights."""
    if not stages:
        return
    steps: list[Any] = rng.choice(stages)[2]
    groups = [group for step in steps for group in step[1:]]
    way = rng.randrange(6)
    if way == 0:
        steps.insert(rng.randint(0, len(steps)), [rng.randrange(n)])
    elif way == 1:
        T = rng.sample(range(n), rng.randint(1, 4))
        group: Any = [T, [rng.choice((0, 1, 3, 255)) for _ in range(len(T) + 1)]]
        rng.choice(steps or [[0]]).append(group)
    elif way == 2 and steps:
        steps.pop(rng.randrange(len(steps)))
    elif way == 3 and steps:
        rng.choice(steps)[0] = rng.randrange(n)
    elif way == 4 and groups:
        rng.choice(groups)[1][0] += rng.choice((-1, 1, 100))
    elif groups:
        T = rng.choice(groups)[0]
        T[rng.randrange(len(T))] = rng.randrange(n)
