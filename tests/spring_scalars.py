"""The factors of springs once more: one pair at a time, in single operations of Python's floats.

Beside `certreg/problem/factors.py`, which does the same for arrays, this is the list of
operations that another language must follow to get the same bits. And exact spring matrices, in
fractions, that say what the bits are worth.
"""

from __future__ import annotations

from fractions import Fraction
from math import sqrt
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    Matrix = list[list[Fraction]]

ZERO = 1e-12


def plane(a: float, b: float, c: float) -> list[float]:
    """L of a normal."""
    return [a, b, 0.0, c, 0.0, 0.0]


def line(a: float, b: float, c: float) -> list[float]:
    """L of a direction."""
    m = max(abs(b), abs(c))
    rho, p, q = 0.0, 1.0, 0.0
    if m > 0.0:
        beta, gamma = b / m, c / m
        rho = sqrt(beta * beta + gamma * gamma)
        p, q = beta / rho, gamma / rho
    big = max(abs(a), m)
    x, y, z = a / big, b / big, c / big
    length = big * sqrt((x * x + y * y) + z * z)
    return [m * rho, -(a * p), length * q, -(a * q), -(length * p), 0.0]


def cholesky(entries: Sequence[float]) -> list[float]:
    """L of a positive definite W."""
    xx, xy, xz, yy, yz, zz = entries
    l11 = sqrt(xx)
    l21 = xy / l11
    l31 = xz / l11
    l22 = sqrt(yy - l21 * l21)
    l32 = (yz - l21 * l31) / l22
    l33 = sqrt((zz - l31 * l31) - l32 * l32)
    return [l11, l21, l22, l31, l32, l33]


def information(entries: Sequence[float]) -> list[float] | None:
    """L of a W that is semidefinite to rounding; None of others."""
    xx, xy, xz, yy, yz, zz = entries
    w = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    least = ZERO * max(map(abs, entries))
    if least == 0.0:
        return [0.0] * 6
    i = max(range(3), key=lambda k: w[k][k])
    j, k = [other for other in range(3) if other != i]
    if w[i][i] < least or min(xx, yy, zz) <= -least:
        return None
    s_jj = w[j][j] - (w[i][j] / w[i][i]) * w[i][j]
    s_kk = w[k][k] - (w[i][k] / w[i][i]) * w[i][k]
    s_jk = w[j][k] - (w[i][j] / w[i][i]) * w[i][k]
    if s_kk > s_jj:
        j, k, s_jj, s_kk = k, j, s_kk, s_jj
    u = [w[i][row] / sqrt(w[i][i]) for row in range(3)]
    if s_jj < least:
        return None if s_kk <= -least or abs(s_jk) > least else plane(*u)
    third = s_kk - (s_jk / s_jj) * s_jk
    if third >= least:
        return cholesky(entries)
    v = [0.0] * 3
    v[j], v[k] = sqrt(s_jj), s_jk / sqrt(s_jj)
    return None if third <= -least else _turned(u, v)


def _turned(u: list[float], v: list[float]) -> list[float]:
    h = sqrt(u[0] * u[0] + v[0] * v[0])
    c, s = (u[0] / h, v[0] / h) if h > 0.0 else (1.0, 0.0)
    first = [c * u[row] + s * v[row] for row in (1, 2)]
    second = [c * v[row] - s * u[row] for row in (1, 2)]
    return [h, first[0], second[0], first[1], second[1], 0.0]


def covariance(entries: Sequence[float]) -> list[float]:
    """L of the inverse of a positive definite S."""
    xx, xy, xz, yy, yz, zz = entries
    u33 = sqrt(zz)
    u23 = yz / u33
    u13 = xz / u33
    u22 = sqrt(yy - u23 * u23)
    u12 = (xy - u13 * u23) / u22
    u11 = sqrt((xx - u13 * u13) - u12 * u12)
    l11 = 1.0 / u11
    l22 = 1.0 / u22
    l33 = 1.0 / u33
    l21 = -((u12 * l11) / u22)
    l31 = -((u13 * l11 + u23 * l21) / u33)
    l32 = -((u23 * l22) / u33)
    return [l11, l21, l22, l31, l32, l33]


def spring(factor: Sequence[float]) -> Matrix:
    """W = L L^T, exactly."""
    a, b, c, d, e, f = map(Fraction, factor)
    rows = [[a, Fraction(0), Fraction(0)], [b, c, Fraction(0)], [d, e, f]]
    return [
        [sum((p * q for p, q in zip(r, s, strict=True)), Fraction(0)) for s in rows] for r in rows
    ]


def symmetric(entries: Sequence[float]) -> Matrix:
    """The matrix of xx, xy, xz, yy, yz, zz, exactly."""
    xx, xy, xz, yy, yz, zz = map(Fraction, entries)
    return [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]


def determinant(m: Matrix) -> Fraction:
    """Of 3x3."""
    (a, b, c), (d, e, f), (g, h, i) = m
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def rank(m: Matrix) -> int:
    """The exact rank, by elimination."""
    rows, found = [list(row) for row in m], 0
    for column in range(3):
        pivot = next((row for row in rows if row[column]), None)
        if pivot is None:
            continue
        rows = [
            [x - row[column] / pivot[column] * y for x, y in zip(row, pivot, strict=True)]
            for row in rows
            if row is not pivot
        ]
        found += 1
    return found


def farthest(a: Matrix, b: Matrix) -> Fraction:
    """The largest difference of two entries."""
    return max(abs(x - y) for r, s in zip(a, b, strict=True) for x, y in zip(r, s, strict=True))
