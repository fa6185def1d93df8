"""A critical quaternion of a quartic to many bits: exact gradients, Hessians in doubles.

In doubles first, by C where there is compiled code. Then Newton's method with exact gradients, its
Hessian renewed until a step is so short that the last one is right to half of a double's digits:
each step of the same Hessian adds as many. One or two make 96 bits of what doubles found.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.geometry.so3 import Matrix3, Vector3, body_frame, dot
from certreg.native.paths import critical_point_near

if TYPE_CHECKING:
    from certreg.exact.spaces import IntegerQuaternion
    from certreg.objective.normalisation import LevelledExactly

POSE_BITS = 96  # of the quaternion: far below what is proved of its angle
GUARD_BITS = 32  # of the work beyond it
WORK_BITS = POSE_BITS + GUARD_BITS
COEFFICIENT_BITS = 2 * POSE_BITS  # a gradient right to 2^-192 leaves 2^-96 at a condition of 2^96
TURN_BITS = 60  # of one step: more than a double has
STEPS = 16  # five are usual
KEPT = 1e-8  # radians of a step: the Hessian of before is right to as much, relative to its size
LONGEST = 0.5  # radians of a step: beyond, it leads elsewhere
SINGULAR = 1e12  # condition of a Hessian: beyond, doubles do not know the way
NO_WAY: Matrix3[float] = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


@dataclass(frozen=True, slots=True)
class Refined:
    """What Newton's method reached.

    quaternion: of length near 2^POSE_BITS; the first entry that is not zero is positive. slope: the
    size of the gradient in rotation angle before it was rounded, over 2^bits of the largest
    coefficient.
    """

    quaternion: IntegerQuaternion
    slope: float


def refined(quartic: LevelledExactly, start: Sequence[float]) -> IntegerQuaternion:
    """The critical quaternion nearest to a start in doubles, as `newton` finds it."""
    return newton(quartic, start).quaternion


def newton(quartic: LevelledExactly, start: Sequence[float]) -> Refined:
    """The critical quaternion nearest to a start in doubles, and what is left of the gradient.

    Where the Hessian is singular, or the start is not near, it is what the steps led to as long as
    the gradient fell: the slope tells.
    """
    near = critical_point_near(quartic.rest, start)
    quartic = quartic.shortened(COEFFICIENT_BITS)
    given = start if near is None else near.quaternion
    q = _unit([round(math.ldexp(entry, WORK_BITS)) for entry in given], WORK_BITS)
    inverse = _inverse_hessian(quartic, q) if near is None else near.inverse
    gradient = _gradient(quartic, q)
    for _ in range(STEPS):
        turn = [-dot(row, gradient) for row in inverse]
        length = math.hypot(*turn)
        if not math.ldexp(1.0, -POSE_BITS - 2) < length < LONGEST:
            break
        moved = _turned(q, turn)
        after = _gradient(quartic, moved)
        if not math.hypot(*after) < math.hypot(*gradient):
            break
        q, gradient = moved, after
        if length > KEPT:
            inverse = _inverse_hessian(quartic, q)
    return Refined(_canonical(_unit(q, POSE_BITS)), math.hypot(*gradient))


def _unit(q: Sequence[int], bits: int) -> list[int]:
    """The quaternion of length 2^bits, each entry rounded."""
    norm = math.isqrt(sum([entry * entry for entry in q]))
    return [((entry << bits) + (norm >> 1)) // norm for entry in q]


def _gradient(quartic: LevelledExactly, q: list[int]) -> Vector3[float]:
    """In rotation angle, at unit q: 1/2 E^T F'(q), over 2^bits of the largest coefficient."""
    full = quartic.gradient(q)
    over = quartic.bits + 4 * WORK_BITS + 1
    a, b, c = zip(*body_frame(tuple(q)), strict=True)
    return (
        _quotient(dot(a, full), over),
        _quotient(dot(b, full), over),
        _quotient(dot(c, full), over),
    )


def _inverse_hessian(quartic: LevelledExactly, q: list[int]) -> Matrix3[float]:
    """Of 1/4 (E^T F''(q) E - 4 F(q) I), in the units of the gradient; zero where it is singular."""
    over = quartic.bits + 2 * WORK_BITS
    F2 = [[_quotient(entry, over) for entry in row] for row in quartic.hessian(q)]
    unit = [math.ldexp(entry, -WORK_BITS) for entry in q]
    columns = list(zip(*body_frame(tuple(unit)), strict=True))
    images = [[dot(row, column) for row in F2] for column in columns]
    value = dot(unit, [dot(row, unit) for row in F2]) / 12.0
    curved = np.array([[0.25 * dot(column, image) for column in columns] for image in images])
    curved -= value * np.eye(3)
    try:
        inverse = np.linalg.inv(curved)
    except np.linalg.LinAlgError:
        return NO_WAY
    if not np.abs(curved).max() * np.abs(inverse).max() < SINGULAR:
        return NO_WAY
    rows: Any = inverse.tolist()
    return rows


def _quotient(value: int, bits: int) -> float:
    """The double nearest to value / 2^bits, whatever the lengths are; 0 below the doubles."""
    surplus = max(0, value.bit_length() - TURN_BITS)
    return math.ldexp(float(value >> surplus), surplus - bits)


def _turned(q: list[int], turn: Sequence[float]) -> list[int]:
    """The unit along q + E turn / 2."""
    shift = TURN_BITS - math.frexp(max(map(abs, turn)))[1]
    steps = [round(math.ldexp(entry, shift)) for entry in turn]
    moved = [
        entry + (dot(row, steps) >> (shift + 1))
        for entry, row in zip(q, body_frame(tuple(q)), strict=True)
    ]
    return _unit(moved, WORK_BITS)


def _canonical(q: list[int]) -> IntegerQuaternion:
    sign = next((1 if entry > 0 else -1 for entry in q if entry), 1)
    w, x, y, z = (sign * entry for entry in q)
    return (w, x, y, z)
