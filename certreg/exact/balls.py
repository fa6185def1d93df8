"""Ball arithmetic at the boundary of python-flint: exact numbers in, fixed point and signs out.

A ball is a midpoint and a radius; every operation encloses the true result, whatever the working
precision, so that a sign read off a ball is a proof [Johansson2017].
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from flint import arb, arb_mat, ctx, fmpz

from certreg.geometry.so3 import dot, rotation_matrix, squared_norm

BEYOND = 1 << 40


def exact_matrix(rows: Sequence[Sequence[int]], shift: int) -> arb_mat:
    """An integer matrix over 2^shift, in balls of radius 0, whatever the working precision."""
    return arb_mat([[arb((entry, -shift)) for entry in row] for row in rows])


def fixed_point(ball: arb, bits: int) -> int:
    """The midpoint of a ball in fixed point with so many fractional bits, rounded down."""
    mantissa, exponent = ball.mid().man_exp()
    return _shifted(mantissa, int(exponent) + bits)


def radius_bits(ball: arb) -> int:
    """An r such that the radius is below 2^r; beyond all bounds where it is 0 or infinite."""
    radius = ball.rad()
    if radius == 0 or not ball.is_finite():
        return -BEYOND if ball.is_finite() else BEYOND
    mantissa, exponent = radius.man_exp()
    return int(abs(mantissa)).bit_length() + int(exponent)


def orthonormal(vectors: Sequence[Sequence[arb]], count: int) -> tuple[tuple[arb, ...], ...]:
    """An orthonormal basis of the span of vectors, known to have that dimension.

    Gram and Schmidt, the longest remaining vector first. Balls that are too wide become infinite.
    """
    rest, basis = [list(v) for v in vectors], list[tuple[arb, ...]]()
    for _ in range(count):
        longest = max(rest, key=lambda v: squared_norm(v).mid())
        length = squared_norm(longest).sqrt()
        unit = tuple(entry / length for entry in longest)
        basis.append(unit)
        if len(basis) == count:
            break
        along = [dot(unit, v) for v in rest]
        rest = [
            [entry - a * e for entry, e in zip(v, unit, strict=True)]
            for v, a in zip(rest, along, strict=True)
        ]
    return tuple(basis)


def sign(ball: arb) -> int:
    """1, -1, or 0 where the ball does not tell."""
    return int(bool(ball > 0)) - int(bool(ball < 0))


def morse_bott_index(
    cross: Sequence[Sequence[int]], quaternion: Sequence[arb], dimension: int, *, bits: int
) -> int | None:
    """The number of negative eigenvalues of the energy's Hessian at an equilibrium, proved.

    Of G = 2 tr(R^T C) I - R^T C - C^T R, times |q|^2. dimension: of the component, so many
    eigenvalues are exactly zero. bits: working precision. None where the balls are too wide.
    """
    with ctx.workprec(bits):
        R = rotation_matrix(list(quaternion))
        A = arb_mat(R).transpose() * arb_mat([list(row) for row in cross])
        G = 2 * A.trace() * arb_mat(3, 3, 1) - A - A.transpose()
        return negative_eigenvalues(G, zeros=dimension)


def negative_eigenvalues(matrix: arb_mat, *, zeros: int = 0) -> int | None:
    """The number of negative eigenvalues of a symmetric 3x3 matrix, proved, at these bits.

    They are real, so that Descartes' rule is exact: with the elementary symmetric functions e1, e2,
    e3 of them, as many are negative as 1, e1, e2, e3 has changes of sign. zeros: so many are known
    to be zero, and so many of the last e drop out. A zero between two signs changes nothing: they
    are opposite where all eigenvalues are real. None where the balls are too wide.
    """
    minors = sum(
        (
            matrix[i, i] * matrix[j, j] - matrix[i, j] * matrix[j, i]
            for i, j in ((0, 1), (0, 2), (1, 2))
        ),
        arb(0),
    )
    functions = [arb(1), matrix.trace(), minors, matrix.det()]
    return _changes([sign(e) for e in functions[: 4 - zeros]])


def _changes(signs: Sequence[int]) -> int | None:
    """The changes of sign along a sequence whose 0 mean "not known"; None where it matters."""
    if signs[-1] == 0:
        return None
    for before, here, after in zip(signs, signs[1:], signs[2:], strict=False):
        if here == 0 and before * after != -1:
            return None
    known = [s for s in signs if s]
    return sum(a != b for a, b in pairwise(known))


def _shifted(value: fmpz, places: int) -> int:
    return int(value) << places if places >= 0 else int(value) >> -places
