"""The springs of one body beside its inertia: by C, or in plain floats where nothing is compiled.

At the optimum a small turn phi has the energy phi^T G phi / 2, G = 2 tr(A) I - A - A^T, A = R^T C.
The eigenvalues of the pencil (G, J) are those of L^-1 G L^-T, J = L L^T.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from certreg.geometry.so3 import rotation_matrix
from certreg.native.library import library_if_any

if TYPE_CHECKING:
    from collections.abc import Sequence

    Rows = Sequence[Sequence[float]]


def spring_ratios_of_one(
    q: Sequence[float], cross: Sequence[float], inertia: Sequence[float]
) -> list[float]:
    """The eigenvalues of the pencil (G, J), ascending, three.

    q: the unit quaternion of the optimum; cross: C row by row; inertia: the upper triangle of J.
    Raises ValueError or ZeroDivisionError where rounding leaves J without a root.
    """
    compiled = library_if_any()
    if compiled is not None:
        return compiled.spring_ratios(q, cross, inertia)
    triangle = _root(inertia)
    whitened = _solved(triangle, _solved(triangle, _hessian(q, cross)))
    return np.linalg.eigvalsh(np.array(whitened).T).tolist()


def _hessian(q: Sequence[float], cross: Sequence[float]) -> Rows:
    rows, (a, b, c, d, e, f, g, h, i) = rotation_matrix(q), cross
    (x, y, z), (s, t, u), (v, w, r) = zip(*rows, strict=True)
    xx, xy, xz = x * a + y * d + z * g, x * b + y * e + z * h, x * c + y * f + z * i
    yx, yy, yz = s * a + t * d + u * g, s * b + t * e + u * h, s * c + t * f + u * i
    zx, zy, zz = v * a + w * d + r * g, v * b + w * e + r * h, v * c + w * f + r * i
    across, along, beside = -(xy + yx), -(xz + zx), -(yz + zy)
    return (
        (2.0 * (yy + zz), across, along),
        (across, 2.0 * (xx + zz), beside),
        (along, beside, 2.0 * (xx + yy)),
    )


def _root(inertia: Sequence[float]) -> Sequence[float]:
    """L with L L^T = J, row by row."""
    xx, xy, xz, yy, yz, zz = inertia
    a = math.sqrt(xx)
    b, d = xy / a, xz / a
    c = math.sqrt(yy - b * b)
    e = (yz - d * b) / c
    return a, b, c, d, e, math.sqrt(zz - d * d - e * e)


def _solved(triangle: Sequence[float], rows: Rows) -> Rows:
    """L^-1 times a matrix, transposed."""
    a, b, c, d, e, f = triangle
    (p, q, r), (s, t, u), (v, w, x) = rows
    p, q, r = p / a, q / a, r / a
    s, t, u = (s - b * p) / c, (t - b * q) / c, (u - b * r) / c
    v, w, x = (v - d * p - e * s) / f, (w - d * q - e * t) / f, (x - d * r - e * u) / f
    return (p, s, v), (q, t, w), (r, u, x)
