"""Which rows a motion may meet that meets two: nearly a turn about the line through these.

The rule is that of `certreg.verify.turned`, here in doubles; what they leave open is not told.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from certreg.native.bit_rows import mask_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from certreg.certificate.refuting import PointRows

# The checker's turns and frames: cosines and sines of 2 arctan(k / QUARTER) in each quarter.
QUARTER = 32
AXIS = np.array([17.0, 29.0, 43.0])
_TANGENTS = np.arange(QUARTER) / QUARTER
_COS = (1.0 - _TANGENTS**2) / (1.0 + _TANGENTS**2)
_SIN = 2.0 * _TANGENTS / (1.0 + _TANGENTS**2)
TURNS = np.array([np.r_[_COS, -_SIN, -_COS, _SIN], np.r_[_SIN, _COS, -_SIN, -_COS]])
# Differences of doubles err by 2^-53 of themselves; a frame by 2^-51 of 1 / LEAST_ACROSS.
LEAST_ACROSS = 2.0**-8
ERROR = 2.0**-40  # of squares, sums and products of what is of the size of |p|, |q|
TINY = 2.0**-400  # of the size of all: squares of what is smaller lose digits
TILT_ERROR = 2.0**-44  # of 4 sin^2(delta/2), where both lengths are above eps: 2^-49 of it


def turned(points: PointRows, e: int, f: int, rows: Sequence[int]) -> NDArray[np.bool_] | None:
    """(T, m): for each turn which of the rows a motion may meet with e and f.

    None where doubles cannot tell of every one, and where rows e and f are too near each other.
    """
    x, y, bounds = points.source, points.target, points.bounds
    a, b, reach = x[f] - x[e], y[f] - y[e], bounds[e] + bounds[f]
    long, wide = float(np.linalg.norm(a)), float(np.linalg.norm(b))
    if min(long, wide) <= max(reach, TINY):
        return None
    frames = _frame(a, long), _frame(b, wide)
    if frames[0] is None or frames[1] is None:
        return None
    tilt = (reach + long - wide) * (reach - long + wide) / (long * wide)
    others = list(rows)
    p, q = x[others] - x[e], y[others] - y[e]
    squares = (p * p).sum(axis=1), (q * q).sum(axis=1)
    short, all_squares = np.sqrt(np.minimum(*squares)), squares[0] + squares[1]
    own = bounds[others] + bounds[e]
    p, q = p @ frames[0].T, q @ frames[1].T
    left = p[:, 0] * q[:, 0] + p[:, 1] * q[:, 1]
    right = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
    values = np.stack([left, right], axis=1) @ TURNS
    allowed: list[NDArray[np.bool_]] = []
    for sign in (-1.0, 1.0):
        far = own + (np.sqrt(max(0.0, tilt + sign * TILT_ERROR)) + 1.0 / QUARTER) * short
        level = (all_squares - far * far) / 2.0 - p[:, 2] * q[:, 2]
        slack = sign * (ERROR * (all_squares + far * far) + TINY**2)
        allowed.append(values >= (level - slack)[:, None])
    return allowed[1].T if np.array_equal(allowed[0], allowed[1]) else None


def _frame(a: NDArray[np.float64], size: float) -> NDArray[np.float64] | None:
    """Three axes, one across the other, the last along a; None where the first is in doubt."""
    across = np.cross(a, AXIS)
    width = float(np.linalg.norm(across))
    if width <= LEAST_ACROSS * size * float(np.linalg.norm(AXIS)):
        return None
    beside = np.cross(a, across)
    return np.array([across / width, beside / np.linalg.norm(beside), a / size])


def sets_of(turns: NDArray[np.bool_], rows: Sequence[int], least: int) -> set[int]:
    """The different sets of at least so many rows, as bits."""
    different = np.unique(turns[turns.sum(axis=1) >= least], axis=0)
    return {mask_of([rows[k] for k in np.flatnonzero(one).tolist()]) for one in different}
