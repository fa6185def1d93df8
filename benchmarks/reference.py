"""The optimal rotation to 60 digits, by a method that shares no code with certreg.

For a unit quaternion q and pure quaternions x, y: y . (q x q*) = (y q) . (q x). So the sum of
w y . R(q) x is the quadratic form in q with the entries sum of C[a][b] (e_a e_i) . (e_j e_b).
"""

from __future__ import annotations

from itertools import product
from operator import mul
from typing import TYPE_CHECKING, Any

import mpmath

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

DIGITS = 70  # ten more than are asked for: they pay for eigenvalues that are close
Quaternion = tuple[int, int, int, int]
UNITS: tuple[Quaternion, ...] = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))


def optimal_quaternion(
    source: NDArray[np.float64], target: NDArray[np.float64], weights: NDArray[np.float64]
) -> list[Any]:
    """The unit quaternion (w, x, y, z), up to its sign, of the rotation that fits best.

    source, target: (N, 3). The moments are exact; 60 digits are right where the optimum is unique
    and not within 1e-10 of being ambiguous, relative to the size of the clouds.
    """
    form = _form(_cross_covariance(source, target, weights))
    largest = max(abs(entry) for row in form for entry in row)
    with mpmath.workdps(DIGITS):
        matrix = mpmath.matrix([[mpmath.mpf(entry) / largest for entry in row] for row in form])
        vectors = mpmath.eigsy(matrix)[1]  # by ascending eigenvalue
        return [vectors[i, 3] for i in range(4)]


def angle(quaternion: Sequence[float], reference: Sequence[Any]) -> float:
    """The angle in radians between two rotations, the quaternion of doubles need not be unit."""
    with mpmath.workdps(DIGITS):
        q = [mpmath.mpf(float(entry)) for entry in quaternion]
        along = mpmath.fdot(q, reference)
        across = [a - along * b for a, b in zip(q, reference, strict=True)]
        return float(2 * mpmath.atan2(mpmath.norm(across), abs(along)))


def angle_of_matrix(found: NDArray[np.float64], reference: Sequence[Any]) -> float:
    """The angle in radians between a rotation matrix (3, 3) of doubles and a unit quaternion."""
    with mpmath.workdps(DIGITS):
        turned = mpmath.matrix(found.tolist()) * _matrix(reference).T
        axial = [turned[k, j] - turned[j, k] for j, k in ((1, 2), (2, 0), (0, 1))]
        trace = mpmath.fsum(turned[k, k] for k in range(3))
        return float(mpmath.atan2(mpmath.norm(axial) / 2, (trace - 1) / 2))


def _matrix(q: Sequence[Any]) -> Any:
    """The images q e q* of the axes e, as columns."""
    turned = (_multiplied(_multiplied(q, e), (q[0], -q[1], -q[2], -q[3])) for e in UNITS[1:])
    return mpmath.matrix([list(image[1:]) for image in turned]).T


def _cross_covariance(
    source: NDArray[np.float64], target: NDArray[np.float64], weights: NDArray[np.float64]
) -> list[list[int]]:
    """A positive multiple of C = sum w (y - mean)(x - mean)^T, exactly."""
    x, y = _columns(source), _columns(target)
    (w,) = _columns(weights[:, None])
    wx = [list(map(mul, w, column)) for column in x]
    wy = [list(map(mul, w, column)) for column in y]
    return [
        [sum(w) * sum(map(mul, wy[a], x[b])) - sum(wy[a]) * sum(wx[b]) for b in range(3)]
        for a in range(3)
    ]


def _columns(values: NDArray[np.float64]) -> list[list[int]]:
    """The columns, times the least power of two that makes all entries integers."""
    ratios = [[entry.as_integer_ratio() for entry in column] for column in values.T.tolist()]
    common = max(denominator for column in ratios for _, denominator in column)
    return [[n * (common // d) for n, d in column] for column in ratios]


def _form(C: list[list[int]]) -> list[list[int]]:
    def entry(i: Quaternion, j: Quaternion) -> int:
        return sum(
            C[a][b] * _dot(_multiplied(UNITS[a + 1], i), _multiplied(j, UNITS[b + 1]))
            for a, b in product(range(3), repeat=2)
        )

    return [[entry(i, j) for j in UNITS] for i in UNITS]


def _multiplied(p: Sequence[Any], q: Sequence[Any]) -> Any:
    (a, b, c, d), (w, x, y, z) = p, q
    return (
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    )


def _dot(p: Quaternion, q: Quaternion) -> int:
    return sum(map(mul, p, q))
