"""The springs of one body beside its inertia, in plain floats: NumPy takes thrice as long for one.

At the optimum a small turn phi has the energy phi^T G phi / 2, G = 2 tr(A) I - A - A^T, A = R^T C.
The eigenvalues of the pencil (G, J) are those of L^-1 G L^-T, J = L L^T.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from certreg.geometry import dot, rotation_matrix

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Rows = Sequence[Sequence[float]]


def spring_ratios_of_one(
    q: Sequence[float], cross: Sequence[float], inertia: Sequence[float]
) -> NDArray[np.float64]:
    """The eigenvalues of the pencil (G, J), ascending, (3,).

    q: the unit quaternion of the optimum; cross: C row by row; inertia: the upper triangle of J.
    Raises ValueError or ZeroDivisionError where rounding leaves J without a root.
    """
    triangle = _root(inertia)
    half = _solved(triangle, _hessian(q, cross))
    whitened = _solved(triangle, list(zip(*half, strict=True)))
    return np.linalg.eigvalsh(np.array(whitened)).astype(np.float64)


def _hessian(q: Sequence[float], cross: Sequence[float]) -> Rows:
    columns = [cross[k::3] for k in range(3)]
    aligned = [
        [dot(turned, column) for column in columns]
        for turned in zip(*rotation_matrix(q), strict=True)
    ]
    (a, b, c), (d, e, f), (g, h, i) = aligned
    xy, xz, yz = -(b + d), -(c + g), -(f + h)
    return ((2.0 * (e + i), xy, xz), (xy, 2.0 * (a + i), yz), (xz, yz, 2.0 * (a + e)))


def _root(inertia: Sequence[float]) -> Sequence[float]:
    """L with L L^T = J, row by row."""
    xx, xy, xz, yy, yz, zz = inertia
    a = math.sqrt(xx)
    b, d = xy / a, xz / a
    c = math.sqrt(yy - b * b)
    e = (yz - d * b) / c
    return a, b, c, d, e, math.sqrt(zz - d * d - e * e)


def _solved(triangle: Sequence[float], rows: Rows) -> Rows:
    """L^-1 times a matrix."""
    a, b, c, d, e, f = triangle
    first = [x / a for x in rows[0]]
    second = [(y - b * x) / c for x, y in zip(first, rows[1], strict=True)]
    third = [(z - d * x - e * y) / f for x, y, z in zip(first, second, rows[2], strict=True)]
    return first, second, third
