"""Moments of springs that are matrices: all that their energy depends on, exactly.

f(R, t) = sum (y - R x - t)^T W (y - R x - t) with W = L L^T for each correspondence. A polynomial
of degree two in x and y with signed weights W_ab: the sums of `SpringMoments`, 73 numbers, are
enough whatever the number of points is. They are taken by three methods that agree.

Python's own integers for few points; and two of compiled code, each other's test, that share no
step: by exponents (native/exact_springs.c), signed integers times powers of two, an accumulator for
each power; and by limbs (native/limbs.c), numbers cut into integers of 22 bits in doubles, whose
products add up in vectors without rounding.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from operator import mul
from typing import TYPE_CHECKING, ClassVar

from certreg._loading import cached_property
from certreg.geometry.so3 import Matrix3, Vector3, dot
from certreg.native.library import library_if_any, loaded_library
from certreg.native.sums import springs_by_exponent, springs_by_limbs
from certreg.problem.exact_sums import UPPER, Summation, SumMethod, Sums
from certreg.problem.lifting import lift
from certreg.results import Brief

if TYPE_CHECKING:
    from certreg.problem.motion import Motion
    from certreg.problem.problem import RegistrationProblem
    from certreg.problem.terms import Pairs


LIMB_POINTS = 1024  # from here on limbs: below, they take longer than exponents
PIECE = 256  # points of one attempt where the numbers of a block are of too many sizes for limbs
FEW_POINTS = 6  # below, Python's own integers take no longer than a call of compiled code
SIDES = ((0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2))  # row and column of the entries of L
# Of each sum, how many factors are coordinates of the source and of the target; W is always one.
COORDINATES = (
    *[(0, 0)] * 6,
    *[(1, 0)] * 18,
    *[(2, 0)] * 36,
    *[(0, 1)] * 3,
    *[(1, 1)] * 9,
    (0, 2),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringSums(Sums):
    """Exact sums over points: W; W_ab x; W_ab x x^T; W y; W y x^T by rows; y^T W y.

    Of symmetric matrices from the diagonal on. With source = X 2^a, target = Y 2^b, L = K 2^c in
    integers, a, b, c as large as can be, W is over 2^(2c), the weight exponent.
    """

    coordinates: ClassVar[tuple[tuple[int, int], ...]] = COORDINATES


EMPTY = SpringSums(
    source_exponent=None,
    target_exponent=None,
    weight_exponent=None,
    integers=(0,) * len(COORDINATES),
)


def _by_exponent(block: Pairs) -> SpringSums:
    library = loaded_library()
    raw = springs_by_exponent(library, block.source, block.target, block.springs)
    return SpringSums.stated(raw.integers, raw.units, raw.lowest)


def _by_limbs(block: Pairs) -> SpringSums:
    raw = springs_by_limbs(loaded_library(), block.source, block.target, block.springs)
    if raw is not None:
        return SpringSums.stated(raw.integers, raw.units, raw.lowest)
    count = len(block.source)
    if count <= PIECE:
        return _by_integers(block)
    pieces = (slice(k, k + PIECE) for k in range(0, count, PIECE))
    return sum((_by_limbs(block.rows(rows)) for rows in pieces), start=EMPTY)


def _fits(block: Pairs) -> bool:
    library = loaded_library()
    return springs_by_limbs(library, block.source, block.target, block.springs) is not None


def _by_integers(block: Pairs) -> SpringSums:
    x, y, rows = (lift(array.ravel()) for array in (block.source, block.target, block.springs))
    points = [x.integers[k::3] for k in range(3)]
    ends = [y.integers[k::3] for k in range(3)]
    springs = _springs([rows.integers[k::6] for k in range(6)])
    weighted = [[list(map(mul, spring, column)) for column in points] for spring in springs]
    full = [springs[UPPER.index((min(a, b), max(a, b)))] for a, b in product(range(3), repeat=2)]
    pulls = [_combined(full[3 * a : 3 * a + 3], ends) for a in range(3)]
    return SpringSums(
        source_exponent=x.exponent if any(x.integers) else None,
        target_exponent=y.exponent if any(y.integers) else None,
        weight_exponent=2 * rows.exponent if any(rows.integers) else None,
        integers=(
            *map(sum, springs),
            *(sum(column) for columns in weighted for column in columns),
            *(dot(columns[j], points[k]) for columns in weighted for j, k in UPPER),
            *map(sum, pulls),
            *(dot(pull, column) for pull, column in product(pulls, points)),
            sum(map(dot, pulls, ends)),
        ),
    )


def _springs(factors: Sequence[Sequence[int]]) -> list[list[int]]:
    """The six entries of L L^T, each over all points, from the six of L."""
    of = dict(zip(SIDES, factors, strict=True))
    return [
        _combined([of[a, k] for k in range(a + 1)], [of[b, k] for k in range(a + 1)])
        for a, b in UPPER
    ]


def _combined(rows: Sequence[Sequence[int]], columns: Sequence[Sequence[int]]) -> list[int]:
    """The sum of the products of rows and columns, entry by entry."""
    products = (map(mul, row, column) for row, column in zip(rows, columns, strict=True))
    return [sum(entries) for entries in zip(*products, strict=True)]


def _fastest(problem: RegistrationProblem) -> SumMethod:
    if library_if_any() is None or problem.n < FEW_POINTS:
        return SumMethod.INTEGERS
    limbs = problem.n >= LIMB_POINTS and _fits(problem.block(slice(0, PIECE)))
    return SumMethod.LIMBS if limbs else SumMethod.BY_EXPONENT


SPRUNG = Summation(
    methods={
        SumMethod.INTEGERS: _by_integers,
        SumMethod.BY_EXPONENT: _by_exponent,
        SumMethod.LIMBS: _by_limbs,
    },
    fastest=_fastest,
    opinions=(SumMethod.LIMBS, SumMethod.BY_EXPONENT),
    empty=EMPTY,
)

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

    @cached_property
    def traces(self) -> tuple[int, list[int], list[int]]:
        """Sums of m, of m X and of m X X^T, six, with the masses m = tr W."""
        diagonal = [UPPER.index((a, a)) for a in range(3)]
        return (
            sum(self.stiffness[k] for k in diagonal),
            [sum(self.source[k][j] for k in diagonal) for j in range(3)],
            [sum(self.scatter[k][j] for k in diagonal) for j in range(6)],
        )


def spring_moments(problem: RegistrationProblem) -> SpringMoments:
    """The moments of a problem of general springs, in integers: no rounding anywhere."""
    return spring_moments_of(SPRUNG.of(problem), problem.n, problem.motion)


def spring_moments_of(sums: Sums, n: int, motion: Motion) -> SpringMoments:
    """The moments that exact sums over n points make."""
    numbers = motion.centred(sums.integers, FIRST_OF_SOURCE, FIRST_OF_TARGET)
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
