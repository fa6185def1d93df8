"""Moments of springs that are matrices: all that their energy depends on.

f(R, t) = sum (y - R x - t)^T W (y - R x - t) with W = L L^T for each correspondence. A polynomial
of degree two in x and y with signed weights W_ab: the sums of `SpringMoments`, 73 numbers, are
enough whatever the number of points is.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from certreg.problem.spring_sums import SPRUNG
from certreg.results import Brief

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.geometry.so3 import Matrix3, Vector3
    from certreg.problem.exact_sums import Sums
    from certreg.problem.problem import RegistrationProblem


Six = tuple[int, int, int, int, int, int]
FIRST_OF_SOURCE, FIRST_OF_TARGET = slice(6, 24), slice(60, 63)  # sums of first order, of 73


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


def spring_moments(problem: RegistrationProblem) -> SpringMoments:
    """The moments of a problem of general springs, in integers: no rounding anywhere."""
    still = not problem.motion.translations
    return spring_moments_of(SPRUNG.of(problem), problem.n, about_origin=still)


def spring_moments_of(sums: Sums, n: int, *, about_origin: bool = False) -> SpringMoments:
    """The moments that exact sums over n points make.

    about_origin: with the sums of first order taken for 0, as where there is no translation.
    """
    numbers = list(sums.integers)
    if about_origin:
        numbers[FIRST_OF_SOURCE], numbers[FIRST_OF_TARGET] = [0] * 18, [0] * 3
    sixes = [_six(numbers[k : k + 6]) for k in range(24, 60, 6)]
    return SpringMoments(
        n=n,
        source_exponent=sums.source_exponent or 0,
        target_exponent=sums.target_exponent or 0,
        weight_exponent=sums.weight_exponent or 0,
        stiffness=_six(numbers[:6]),
        source=tuple(_three(numbers[k : k + 3]) for k in range(6, 24, 3)),
        scatter=tuple(sixes),
        target=_three(numbers[60:63]),
        cross=(_three(numbers[63:66]), _three(numbers[66:69]), _three(numbers[69:72])),
        spread=numbers[72],
    )


def _three(entries: Sequence[int]) -> Vector3[int]:
    x, y, z = entries
    return (x, y, z)


def _six(entries: Sequence[int]) -> Six:
    a, b, c, d, e, f = entries
    return (a, b, c, d, e, f)
