"""Moments of springs that are matrices: all that their energy depends on.

f(R, t) = sum (y - R x - t)^T W (y - R x - t) with W = L L^T for each correspondence. A polynomial
of degree two in x and y with signed weights W_ab: the sums of `SpringMoments`, 73 numbers, are
enough whatever the number of points is.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from operator import mul
from typing import TYPE_CHECKING, Any

from certreg.problem.exact_sums import UPPER
from certreg.problem.problem import lift
from certreg.results import Brief

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from certreg.geometry import Matrix3, Vector3

Six = tuple[int, int, int, int, int, int]
SIDES = ((0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2))  # row and column of the entries of L


@dataclass(frozen=True, kw_only=True)
class SpringMoments(Brief):
    """Sums over the points in integers, each times a power of two.

    With source = X 2^a, target = Y 2^b and W 2^c in integers, summed over the points:

    stiffness: sum W, six entries                                times 2^c
    source: sum W_ab X, three for each entry of W                times 2^(c+a)
    scatter: sum W_ab X X^T, six for each entry of W             times 2^(c+2a)
    target: sum W Y                                              times 2^(c+b)
    cross: sum W Y X^T                                           times 2^(c+a+b)
    spread: sum Y^T W Y                                          times 2^(c+2b)

    The six of a symmetric matrix stand in the order 11 12 13 22 23 33.
    """

    n: int
    source_exponent: int
    target_exponent: int
    weight_exponent: int
    stiffness: Six
    source: tuple[Vector3[int], ...]
    scatter: tuple[Six, ...]
    target: Vector3[int]
    cross: Matrix3[int]
    spread: int


def spring_moments(problem: Any) -> SpringMoments:
    """The moments of a problem whose springs are matrices, in integers: no rounding anywhere."""
    return spring_moments_of(problem.source, problem.target, problem.factors)


def spring_moments_of(
    source: NDArray[np.float64], target: NDArray[np.float64], factors: NDArray[np.float64]
) -> SpringMoments:
    """The moments of points (N, 3) with the factors (N, 6) of their springs."""
    x, y, rows = (lift(array.reshape(-1)) for array in (source, target, factors))
    points = [x.integers[k::3] for k in range(3)]
    ends = [y.integers[k::3] for k in range(3)]
    springs = _springs([rows.integers[k::6] for k in range(6)])
    by_source = [[list(map(mul, spring, column)) for column in points] for spring in springs]
    full = [springs[_place(a, b)] for a, b in product(range(3), repeat=2)]
    pulls = [_combined(full[3 * a : 3 * a + 3], ends) for a in range(3)]
    return SpringMoments(
        n=len(source),
        source_exponent=x.exponent,
        target_exponent=y.exponent,
        weight_exponent=2 * rows.exponent,
        stiffness=_six([sum(spring) for spring in springs]),
        source=tuple(_three([sum(column) for column in columns]) for columns in by_source),
        scatter=tuple(_six([_dot(c[j], points[k]) for j, k in UPPER]) for c in by_source),
        target=_three([sum(pull) for pull in pulls]),
        cross=_nine([_dot(pull, column) for pull, column in product(pulls, points)]),
        spread=sum(_dot(pull, end) for pull, end in zip(pulls, ends, strict=True)),
    )


def _springs(factors: Sequence[Sequence[int]]) -> list[list[int]]:
    """The six entries of L L^T, each over all points, from the six of L."""
    of = dict(zip(SIDES, factors, strict=True))
    return [
        [
            sum(pair)
            for pair in zip(*(map(mul, of[a, k], of[b, k]) for k in range(a + 1)), strict=True)
        ]
        for a, b in UPPER
    ]


def _place(a: int, b: int) -> int:
    return UPPER.index((min(a, b), max(a, b)))


def _combined(rows: Sequence[Sequence[int]], columns: Sequence[Sequence[int]]) -> list[int]:
    """The sum of the products of rows and columns, entry by entry."""
    products = (map(mul, row, column) for row, column in zip(rows, columns, strict=True))
    return [sum(entries) for entries in zip(*products, strict=True)]


def _dot(a: Sequence[int], b: Sequence[int]) -> int:
    return sum(map(mul, a, b))


def _three(entries: Sequence[int]) -> Vector3[int]:
    x, y, z = entries
    return (x, y, z)


def _six(entries: Sequence[int]) -> Six:
    a, b, c, d, e, f = entries
    return (a, b, c, d, e, f)


def _nine(entries: Sequence[int]) -> Matrix3[int]:
    return (_three(entries[:3]), _three(entries[3:6]), _three(entries[6:]))
