"""A critical quaternion of a quartic to many bits: exact gradients, one Hessian in doubles.

With the Hessian H of the start and exact gradients g, a step -H^-1 g leaves about 2^-50 times the
condition of H of the error: three or four steps make 96 bits of what doubles found.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from certreg.geometry import body_frame, dot

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from certreg.exact import IntegerQuaternion
    from certreg.objective import LevelledExactly

POSE_BITS = 96  # of the quaternion: far below what is proved of its angle
GUARD_BITS = 32  # of the work beyond it
WORK_BITS = POSE_BITS + GUARD_BITS
TURN_BITS = 60  # of one step: more than a double has
STEPS = 12  # four are usual
FLAT = 1e-12  # of the largest curvature: along weaker axes doubles do not know the way


def refined(quartic: LevelledExactly, start: Sequence[float]) -> IntegerQuaternion:
    """The critical quaternion nearest to a start in doubles, of length near 2^POSE_BITS.

    The first entry that is not zero is positive. Where the Hessian is singular, or the start is
    not near, it is what the steps led to as long as the gradient fell.
    """
    q = _unit([round(math.ldexp(entry, WORK_BITS)) for entry in start], WORK_BITS)
    inverse = _inverse_hessian(quartic, q)
    gradient = _gradient(quartic, q)
    for _ in range(STEPS):
        turn = [-entry for entry in inverse @ np.array(gradient)]
        if not any(turn) or math.hypot(*turn) < math.ldexp(1.0, -POSE_BITS - 2):
            break
        moved = _turned(q, turn)
        after = _gradient(quartic, moved)
        if not math.hypot(*after) < math.hypot(*gradient):
            break
        q, gradient = moved, after
    return _canonical(_unit(q, POSE_BITS))


def _unit(q: Sequence[int], bits: int) -> list[int]:
    """The quaternion of length 2^bits, each entry rounded."""
    norm = math.isqrt(sum(entry * entry for entry in q))
    return [((entry << bits) + (norm >> 1)) // norm for entry in q]


def _gradient(quartic: LevelledExactly, q: list[int]) -> list[float]:
    """In rotation angle, at unit q: 1/2 E^T F'(q), over 2^bits of the largest coefficient."""
    full = quartic.gradient(q)
    columns = zip(*body_frame(tuple(q)), strict=True)
    over = quartic.bits + 4 * WORK_BITS + 1
    return [_quotient(dot(column, full), over) for column in columns]


def _inverse_hessian(quartic: LevelledExactly, q: list[int]) -> NDArray[np.float64]:
    """Of 1/4 (E^T F''(q) E - 4 F(q) I), in the units of the gradient; zero along flat axes."""
    rows = quartic.hessian(q)
    F2 = np.array(
        [[_quotient(entry, quartic.bits + 2 * WORK_BITS) for entry in row] for row in rows]
    )
    unit = np.array([math.ldexp(entry, -WORK_BITS) for entry in q])
    E = np.array(body_frame(tuple(unit)))
    curved = 0.25 * (E.T @ F2 @ E - (unit @ F2 @ unit) / 3.0 * np.eye(3))
    values, axes = np.linalg.eigh(curved)
    known = np.abs(values) > FLAT * np.abs(values).max()
    return (axes * np.where(known, 1.0 / np.where(known, values, 1.0), 0.0)) @ axes.T


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
