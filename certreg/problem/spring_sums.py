"""The sums over points whose springs are matrices, exactly, by three methods that agree.

Python's own integers for few points; and two of compiled code, each other's test, that share no
step: by exponents (native/exact_springs.c), signed integers times powers of two, an accumulator for
each power; and by limbs (native/limbs.c), numbers cut into integers of 22 bits in doubles, whose
products add up in vectors without rounding.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from operator import mul
from typing import TYPE_CHECKING, ClassVar

from certreg.native.library import library_if_any, loaded_library
from certreg.native.sums import springs_by_exponent, springs_by_limbs
from certreg.problem.exact_sums import UPPER, Summation, SumMethod, Sums
from certreg.problem.lifting import lift

if TYPE_CHECKING:
    from collections.abc import Sequence

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
            *(_dot(columns[j], points[k]) for columns in weighted for j, k in UPPER),
            *map(sum, pulls),
            *(_dot(pull, column) for pull, column in product(pulls, points)),
            sum(map(_dot, pulls, ends)),
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


def _dot(a: Sequence[int], b: Sequence[int]) -> int:
    return sum(map(mul, a, b))


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
