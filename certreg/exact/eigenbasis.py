"""An orthonormal eigenbasis of a symmetric integer matrix, to any number of bits.

Jacobi rotations in fixed-point integer arithmetic, started from the double-precision basis. Jacobi
converges quadratically and keeps its basis orthonormal whether eigenvalues are far apart, close or
equal, which is where double precision returns an arbitrary answer. What it returns is still a
proposal: proofs are made from it elsewhere, by exact arithmetic.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from math import isqrt

import numpy as np

from certreg.geometry.so3 import dot

FixedMatrix = list[list[int]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Eigenbasis:
    """Eigenvalues, largest first, and orthonormal eigenvectors in fixed point.

    The k-th eigenvalue is values[k] * 2**(shift - bits) in units of the given matrix, the k-th unit
    eigenvector vectors[k] / 2**bits, each right to a few units in the last place where its
    eigenvalue is isolated.
    """

    values: tuple[int, ...]
    vectors: tuple[tuple[int, ...], ...]
    bits: int
    shift: int


def integer_eigenbasis(matrix: Sequence[Sequence[int]], bits: int) -> Eigenbasis:
    """The eigenbasis of a symmetric integer matrix in fixed point with `bits` fractional bits."""
    n = len(matrix)
    shift = max(abs(entry) for row in matrix for entry in row).bit_length()
    up, down = max(bits - shift, 0), max(shift - bits, 0)
    scaled = [[entry << up >> down for entry in row] for row in matrix]
    basis = _double_precision_start(scaled, bits)
    rotated = _congruence(scaled, basis, bits)
    tolerance = 1 << 8  # a few hundred units in the last place: the rounding of one sweep
    pairs = list(combinations(range(n), 2))
    while any(abs(rotated[p][q]) > tolerance for p, q in pairs):
        for p, q in pairs:
            _rotate(rotated, basis, p, q, bits)
    order = sorted(range(n), key=lambda k: rotated[k][k], reverse=True)
    return Eigenbasis(
        values=tuple(rotated[k][k] for k in order),
        vectors=tuple(tuple(basis[k]) for k in order),
        bits=bits,
        shift=shift,
    )


def _double_precision_start(scaled: FixedMatrix, bits: int) -> FixedMatrix:
    """Rows: eigenvectors in double precision, then made orthonormal in fixed point."""
    doubles = np.array([[entry / (1 << bits) for entry in row] for row in scaled])
    vectors = np.linalg.eigh(doubles)[1].T
    basis: FixedMatrix = []
    for vector in vectors.tolist():
        row = [int(entry * (1 << 60)) << (bits - 60) for entry in vector]
        for other in basis:
            along = dot(row, other) >> bits
            row = [a - ((along * b) >> bits) for a, b in zip(row, other, strict=True)]
        norm = isqrt(dot(row, row))
        basis.append([(entry << bits) // norm for entry in row])
    return basis


def _congruence(matrix: FixedMatrix, basis: FixedMatrix, bits: int) -> FixedMatrix:
    images = [[dot(row, vector) >> bits for row in matrix] for vector in basis]
    return [[dot(vector, image) >> bits for image in images] for vector in basis]


def _rotate(matrix: FixedMatrix, basis: FixedMatrix, p: int, q: int, bits: int) -> None:
    """One Jacobi rotation: makes entry (p, q) zero, by the smaller of the two angles."""
    upper, lower = matrix[p], matrix[q]
    coupling, one = upper[q], 1 << (2 * bits)
    if coupling == 0:
        return
    difference = lower[q] - upper[p]
    hypotenuse = isqrt(difference * difference + 4 * coupling * coupling)
    tangent = (2 * coupling << bits) // (abs(difference) + hypotenuse)
    if difference < 0:
        tangent = -tangent
    secant = isqrt(one + tangent * tangent)
    cosine, sine = one // secant, (tangent << bits) // secant
    exchanged = (tangent * coupling) >> bits
    upper[p] -= exchanged
    lower[q] += exchanged
    upper[q] = lower[p] = 0
    for k, row in enumerate(matrix):
        if k not in (p, q):
            a, b = row[p], row[q]
            row[p] = upper[k] = (cosine * a - sine * b) >> bits
            row[q] = lower[k] = (sine * a + cosine * b) >> bits
    first, second = basis[p], basis[q]
    for k, (a, b) in enumerate(zip(first, second, strict=True)):
        first[k] = (cosine * a - sine * b) >> bits
        second[k] = (sine * a + cosine * b) >> bits
