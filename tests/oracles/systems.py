"""The equilibria as polynomial systems in the quaternion, and in the nine entries of R.

In the entries of R the torques are joined by the 21 quadratics of a rotation: orthogonality of rows
and columns, and handedness.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.equilibrium.torques import COLUMNS, TURNS, skew, torque_table
from certreg.geometry.constraints import rotation_polynomials
from certreg.objective.quartics import MONOMIALS

from .polynomials import (
    QUATERNION,
    Monomial,
    Polynomial,
    PolynomialSystem,
    collected,
    exponents,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

ROTATION = ("r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33")


def quaternion_system(C: Sequence[Sequence[int]], *, chart: bool = False) -> PolynomialSystem:
    """The six torque quadratics in q = (w, x, y, z), homogeneous; with w = 1 in the chart.

    The chart misses the half turns, w = 0.
    """
    first = 1 if chart else 0
    polynomials = [
        collected((exponents(pair, 4)[first:], c) for pair, c in zip(COLUMNS, row, strict=True))
        for row in torque_table(C)
    ]
    return PolynomialSystem(variables=QUATERNION[first:], polynomials=tuple(polynomials))


def line_system(quartic: Sequence[int]) -> PolynomialSystem:
    """The critical lines of a quartic in the chart w = 1: F_i - F_w q_i in x, y, z.

    Three equations of degree 4, of which 40 of the 64 solutions are finite.
    """
    of_w, *others = (_derivative(quartic, k) for k in range(4))
    polynomials = [
        collected(
            [
                *((exponents(rest, 4)[1:], c) for rest, c in own),
                *((exponents((*rest, i), 4)[1:], -c) for rest, c in of_w),
            ]
        )
        for i, own in enumerate(others, start=1)
    ]
    return PolynomialSystem(variables=QUATERNION[1:], polynomials=tuple(polynomials))


def _derivative(quartic: Sequence[int], variable: int) -> list[tuple[tuple[int, ...], int]]:
    """Of a quartic by a variable: factors that are left, and coefficients."""
    found: list[tuple[tuple[int, ...], int]] = []
    for monomial, coefficient in zip(MONOMIALS, quartic, strict=True):
        if variable in monomial:
            place = monomial.index(variable)
            rest = (*monomial[:place], *monomial[place + 1 :])
            found.append((rest, monomial.count(variable) * coefficient))
    return found


def rotation_system(C: Sequence[Sequence[int]]) -> PolynomialSystem:
    """All equations in the nine entries of R, row by row: torques, and the 21 quadratics."""
    polynomials = [*_torques(C), *map(_in_rows, rotation_polynomials())]
    return PolynomialSystem(variables=ROTATION, polynomials=tuple(p for p in polynomials if p))


def _in_rows(quadratic: dict[tuple[int, int], int]) -> Polynomial:
    """A quadratic in r = (1, vec R), R by columns, in the entries of R row by row."""
    return collected(
        (exponents([_row_by_row(k) for k in pair if k], 9), c) for pair, c in quadratic.items()
    )


def _row_by_row(place: int) -> int:
    column, row = divmod(place - 1, 3)
    return 3 * row + column


def _torques(C: Sequence[Sequence[int]]) -> Iterator[Polynomial]:
    for i, j in TURNS:
        body = [(_entry((k, a)), s * C[k][b]) for k in range(3) for a, b, s in skew(i, j)]
        world = [(_entry((b, k)), s * C[a][k]) for k in range(3) for a, b, s in skew(i, j)]
        yield collected(body)
        yield collected(world)


def _entry(*places: tuple[int, int]) -> Monomial:
    """The product of entries of R as a monomial in the nine."""
    return exponents([3 * i + j for i, j in places], 9)
