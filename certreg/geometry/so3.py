"""Rotations and quaternions. Quaternions are (w, x, y, z); R(q) takes body coordinates to world.

Functions without a NumPy type in their signature use only + - * and so run over integers,
fractions, floats and symbols alike. Source: [Horn1987].
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from operator import mul
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


FEW = 8  # quaternions, or 3x3 matrices: that many in Python take as long as thirty calls of NumPy


class Number(Protocol):
    """A ring element: int, Fraction, float, a SymPy or a CasADi expression."""

    def __add__(self, other: Any, /) -> Any: ...
    def __radd__(self, other: Any, /) -> Any: ...
    def __sub__(self, other: Any, /) -> Any: ...
    def __mul__(self, other: Any, /) -> Any: ...
    def __rmul__(self, other: Any, /) -> Any: ...
    def __neg__(self) -> Any: ...


T = TypeVar("T", bound=Number)
Vector3 = tuple[T, T, T]
Vector4 = tuple[T, T, T, T]
Matrix3 = tuple[Vector3[T], Vector3[T], Vector3[T]]
Matrix4 = tuple[Vector4[T], Vector4[T], Vector4[T], Vector4[T]]


def rotation_matrix(q: Sequence[T]) -> Matrix3[T]:
    """The 3x3 matrix |q|^2 R(q): a rotation if |q| = 1, homogeneous of degree 2 in q otherwise.

    >>> rotation_matrix((0, 0, 0, 2))
    ((-4, 0, 0), (0, -4, 0), (0, 0, 4))
    """
    w, x, y, z = q
    ww, xx, yy, zz = w * w, x * x, y * y, z * z
    return (
        (ww + xx - yy - zz, 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), ww - xx + yy - zz, 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), ww - xx - yy + zz),
    )


def rotation_matrices(quaternions: NDArray[np.float64]) -> NDArray[np.float64]:
    """The matrices (n, 3, 3) of quaternions (n, 4), to the bit as one at a time."""
    if len(quaternions) < FEW:
        return np.array([rotation_matrix(q) for q in quaternions.tolist()]).reshape(-1, 3, 3)
    entries: Any = quaternions.T
    return np.moveaxis(np.array(rotation_matrix(list(entries))), -1, 0)


def is_reflection(matrix: NDArray[np.float64]) -> bool:
    """Whether a 3x3 matrix that is orthogonal up to rounding has the determinant -1, and not 1."""
    (a, b, c), (d, e, f), (g, h, i) = matrix.tolist()
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g) < 0.0


def body_frame(q: Sequence[T]) -> tuple[Vector3[T], Vector3[T], Vector3[T], Vector3[T]]:
    """The 4x3 matrix L(q) with L(q) a = q * (0, a): L^T q = 0 and L^T L = |q|^2 I.

    A rotation of the body by a small angle vector phi (body frame) moves q by L(q) phi / 2.
    """
    w, x, y, z = q
    return ((-x, -y, -z), (w, -z, y), (z, w, -x), (-y, x, w))


def davenport_matrix(C: Sequence[Sequence[T]]) -> Matrix4[T]:
    """The symmetric 4x4 matrix K with q^T K q = |q|^2 tr(R(q)^T C) for every quaternion q.

    Homogeneous of degree 1 in the 3x3 matrix C; tr K = 0. Source: [Horn1987], [Davenport1968].

    >>> davenport_matrix(((1, 0, 0), (0, 2, 0), (0, 0, 3)))
    ((6, 0, 0, 0), (0, -4, 0, 0), (0, 0, -2, 0), (0, 0, 0, 0))
    """
    (a, b, c), (d, e, f), (g, h, i) = C
    return (
        (a + e + i, h - f, c - g, d - b),
        (h - f, a - e - i, b + d, c + g),
        (c - g, b + d, e - a - i, f + h),
        (d - b, c + g, f + h, i - a - e),
    )


def davenport_matrices(C: NDArray[np.float64]) -> NDArray[np.float64]:
    """The matrices (n, 4, 4) of 3x3 matrices (n, 3, 3), to the bit as one at a time."""
    if len(C) < FEW:
        return np.array([davenport_matrix(one) for one in C.tolist()]).reshape(-1, 4, 4)
    entries: Any = np.moveaxis(C, 0, -1)
    return np.moveaxis(np.array(davenport_matrix(entries)), -1, 0)


def quadratic_form(K: Sequence[Sequence[T]], q: Sequence[T]) -> T:
    """q^T K q."""
    return dot(q, [dot(row, q) for row in K])


def dot(a: Sequence[T], b: Sequence[T]) -> T:
    """The sum of products of the entries of two vectors of equal length."""
    total: Any = sum(map(mul, a, b))
    return total


def squared_norm(v: Sequence[T]) -> T:
    """The sum of squares of the entries of v."""
    return dot(v, v)


def canonical(q: NDArray[np.float64]) -> NDArray[np.float64]:
    """The one of q and -q whose first nonzero entry is positive; no zero of it is negative."""
    for entry in q.tolist():
        if entry != 0.0:
            return (q if entry > 0.0 else -q) + 0.0
    return np.zeros_like(q)


def quaternion_from_matrix(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    """The unit quaternion (4,) of a rotation matrix (3, 3), canonical sign.

    The top eigenvector of the Davenport matrix of `rotation`: for a matrix that is only nearly a
    rotation it is the quaternion of the nearest rotation in the Frobenius norm.
    """
    return canonical(np.linalg.eigh(np.array(davenport_matrix(rotation.tolist())))[1][:, -1])


def quaternion_of_rotation(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same of a matrix that is a rotation up to rounding, without an eigenvalue problem.

    The Davenport matrix is 4 q q^T - I then: its k-th column, with 1 more on the diagonal, is
    4 q_k q. The longest of the four is taken: its length is at least 2.
    """
    columns = davenport_matrix(rotation.tolist())
    k = max(range(4), key=lambda i: columns[i][i])
    q = [entry + (i == k) for i, entry in enumerate(columns[k])]
    length = math.hypot(*q)
    return canonical(np.array([entry / length for entry in q]))


def quaternions_from_matrices(rotations: NDArray[np.float64]) -> NDArray[np.float64]:
    """The quaternions (n, 4) of rotation matrices (n, 3, 3), to the bit as one at a time."""
    entries: Any = np.moveaxis(rotations, 0, -1)
    forms: NDArray[np.float64] = np.array(davenport_matrix(entries))  # (4, 4, n)
    q: NDArray[np.float64] = np.linalg.eigh(np.moveaxis(forms, -1, 0))[1][:, :, -1]
    first = np.take_along_axis(q, (q != 0.0).argmax(axis=1)[:, None], axis=1)
    return np.where(first > 0.0, q, -q) + 0.0


def angle_between(p: NDArray[np.float64], q: NDArray[np.float64]) -> float:
    """The angle in radians, 0 to pi, of the rotation that takes R(p) to R(q), for unit p and q.

    Accurate at both ends: arccos of a trace loses half the digits near 0 and pi.
    """
    along = abs(float(np.dot(p, q)))
    across = float(np.linalg.norm(np.array(body_frame(tuple(p))).T @ q))
    return 2.0 * math.atan2(across, along)
