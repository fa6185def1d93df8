"""Sums of w, w a and w a b over the points, exactly, by four methods that give the same integers.

Python's own integers for few points; two of compiled code for many; and NumPy, which cuts
coordinates into limbs so short that a product of matrices of doubles adds them up without rounding
[Ozaki2012].

The two of compiled code are each other's test, and share no step. By exponents (native/exact.c), a
double stays an integer with sign times a power of two, and the sum of the exponents tells which of
1534 accumulators takes a product. In fixed point (native/fixed.c) the numbers of a block lie over
one power of two, are shifted until none is negative, and cut into digits of 52 bits; exponents and
signs are gone, and what the shift adds to a sum is taken off here.
"""

from __future__ import annotations

import enum
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from operator import mul
from typing import TYPE_CHECKING, ClassVar, Self

import numpy as np

from certreg._loading import found_late
from certreg.geometry.so3 import dot
from certreg.native.kernels import MissingLibraryError
from certreg.native.library import Library, loaded_library
from certreg.native.sums import (
    IntegerSums,
    fixed_point_fits,
    joined,
    sums_by_exponent,
    sums_in_fixed_point,
)
from certreg.problem.arrays import row_blocks
from certreg.problem.lifting import lift

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.problem.problem import RegistrationProblem
    from certreg.problem.terms import Pairs


FIXED_POINTS = 512  # from here on fixed point: below, its own set-up takes longer
FEW_POINTS = 16  # below, Python's own integers take no longer than a call of compiled code
MANY_POINTS = 2048  # from here on limbs, where nothing is compiled: 25 ms of integers
THREADS = 2  # so many blocks at once, by compiled code and by NumPy
LIMB_BITS = 20  # products of two limbs are below 2^40, and 2^13 of them add up within 2^53
LIMB_POINTS = 1 << 12  # half of that: so many fit into the cache, and take half the time
PRODUCT_POINTS = 512  # of one product of matrices: for more, BLAS would start threads
MOST_LIMBS = 12  # of a coordinate: beyond a range of 2^187, Python's integers are faster
# Of each sum, how many factors are coordinates of the source and of the target; w is always one.
FACTORS = ((0, 0), *[(1, 0)] * 3, *[(0, 1)] * 3, *[(1, 1)] * 9, *[(2, 0)] * 6, *[(0, 2)] * 6)
UPPER = tuple((i, j) for i in range(3) for j in range(i, 3))
# Of which two of the columns x, y the sums of products are.
PRODUCTS = (
    *((3 + i, j) for i in range(3) for j in range(3)),
    *UPPER,
    *((3 + i, 3 + j) for i, j in UPPER),
)


class SumMethod(enum.Enum):
    """How the sums are taken."""

    INTEGERS = "Python's integers"
    BY_EXPONENT = "compiled code, by exponents"
    FIXED_POINT = "compiled code, in fixed point"
    LIMBS = "matrix products of limbs"


@dataclass(frozen=True, slots=True, kw_only=True)
class Sums:
    """Exact sums over points: w; w x, w y; w y x^T by rows; w x x^T, w y y^T from the diagonal on.

    With source = X 2^a, target = Y 2^b, weights = W 2^c in integers, a, b, c as large as can be,
    `integers` are the 28 sums of W, W X, ... None for a, b or c: all numbers are zero.
    """

    coordinates: ClassVar[tuple[tuple[int, int], ...]] = FACTORS  # of each sum, see there

    source_exponent: int | None
    target_exponent: int | None
    weight_exponent: int | None
    integers: tuple[int, ...]

    def __add__(self, other: Self) -> Self:
        """The sums over the points of both."""
        a = _least(self.source_exponent, other.source_exponent)
        b = _least(self.target_exponent, other.target_exponent)
        c = _least(self.weight_exponent, other.weight_exponent)
        both = zip(self._over(a, b, c), other._over(a, b, c), strict=True)
        return type(self)(
            source_exponent=a,
            target_exponent=b,
            weight_exponent=c,
            integers=tuple(one + another for one, another in both),
        )

    def _over(self, a: int | None, b: int | None, c: int | None) -> Iterable[int]:
        """The integers for exponents that are not larger."""
        x = _difference(self.source_exponent, a)
        y = _difference(self.target_exponent, b)
        w = _difference(self.weight_exponent, c)
        if not (x or y or w):
            return self.integers
        pairs = zip(self.integers, self.coordinates, strict=True)
        return [k << (w + of_source * x + of_target * y) for k, (of_source, of_target) in pairs]

    @classmethod
    def stated(
        cls, integers: Sequence[int], units: Sequence[int], lowest: Sequence[int | None]
    ) -> Self:
        """Sums given over units of source, target, weights, over those of their lowest bits."""
        if units != lowest:
            x, y, w = (
                0 if low is None else unit - low for unit, low in zip(units, lowest, strict=True)
            )
            shifts = [w + of_source * x + of_target * y for of_source, of_target in cls.coordinates]
            integers = [
                k << shift if shift >= 0 else k >> -shift
                for k, shift in zip(integers, shifts, strict=True)
            ]
        return cls(
            source_exponent=lowest[0],
            target_exponent=lowest[1],
            weight_exponent=lowest[2],
            integers=tuple(integers),
        )


EMPTY = Sums(
    source_exponent=None, target_exponent=None, weight_exponent=None, integers=(0,) * len(FACTORS)
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Summation:
    """How the sums over pairs with one kind of springs are taken.

    methods: each makes the sums of some pairs. fastest: of them, on this machine. opinions: two
    that share no step, each a second opinion on the other. empty: the sums over no pairs.
    """

    methods: Mapping[SumMethod, Callable[[Pairs], Sums]]
    fastest: Callable[[RegistrationProblem], SumMethod]
    opinions: tuple[SumMethod, SumMethod]
    empty: Sums

    def by(self, method: SumMethod, problem: RegistrationProblem, threads: int) -> Sums:
        """The sums over all pairs by one method; Python's integers are added by one thread."""
        summed, count = self.methods[method], 1 if method is SumMethod.INTEGERS else threads
        return over_blocks(lambda rows: summed(problem.block(rows)), problem.n, count, self.empty)

    def of(self, problem: RegistrationProblem) -> Sums:
        """The sums over all pairs, by the fastest method here."""
        return self.by(self.fastest(problem), problem, THREADS)


def summation_of(problem: RegistrationProblem) -> Summation:
    """How the sums are taken of such springs."""
    return SUMMATIONS[problem.cell.springs]()


def fastest_method(problem: RegistrationProblem) -> SumMethod:
    """The fastest method on this machine for such pairs."""
    return summation_of(problem).fastest(problem)


def second_method(problem: RegistrationProblem) -> SumMethod:
    """Another method than the fastest one, for a second opinion; the two share no step."""
    one, other = summation_of(problem).opinions
    return {one: other, other: one}.get(fastest_method(problem), SumMethod.INTEGERS)


def sums_by(method: SumMethod, problem: RegistrationProblem, *, threads: int = THREADS) -> Sums:
    """The sums over all pairs by one method. Raises MissingLibraryError.

    Blocks with numbers of too many sizes for it go by limbs or integers, never by exponents.
    """
    return summation_of(problem).by(method, problem, threads)


def over_blocks(summed: Callable[[slice], Sums], n: int, threads: int, empty: Sums) -> Sums:
    """The sums over n rows, on so many threads; where one block fails, no other is begun."""
    blocks = list(row_blocks(n))
    if len(blocks) == 1:
        return summed(blocks[0])
    if threads == 1:
        return sum(map(summed, blocks), start=empty)
    with ThreadPoolExecutor(threads) as pool:
        return sum(pool.map(summed, blocks), start=empty)


@cache
def _compiled() -> Library | None:
    """The compiled library; None where there is none, or it has no integers of 128 bits."""
    try:
        compiled = loaded_library()
        sums_by_exponent(compiled, np.ones((1, 3)), np.ones((1, 3)), np.ones(1))
    except MissingLibraryError:
        return None
    return compiled


def _fits(compiled: Library, problem: RegistrationProblem) -> bool:
    """Whether the first block fits into fixed point."""
    block = problem.block(next(iter(row_blocks(problem.n))))
    return fixed_point_fits(compiled, block.source, block.target, _unequal(block.weights))


def _unequal(weights: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """The weights; None where they are all the same."""
    return None if (weights == weights[0]).all() else weights


def _by_exponent(compiled: Library, block: Pairs) -> Sums:
    raw = sums_by_exponent(compiled, block.source, block.target, block.weights)
    return Sums.stated(raw.integers, raw.units, raw.lowest)


def _by_fixed_point(compiled: Library, block: Pairs) -> Sums:
    weights = _unequal(block.weights)
    raw = sums_in_fixed_point(compiled, block.source, block.target, weights)
    if raw is None:
        return _by_limbs(block)
    integers = _without_biases(raw)
    if weights is not None:
        return Sums.stated(integers, raw.units, raw.lowest)
    one = lift(block.weights[:1])
    (weight,), unit = one.integers, one.exponent
    many = (len(block.weights), *integers[1:])
    lowest = (*raw.lowest[:2], unit if weight else None)
    return Sums.stated([weight * k for k in many], (*raw.units[:2], unit), lowest)


def _without_biases(raw: IntegerSums) -> list[int]:
    """Sums of W, W X, ... from those of W, W (X + p), ...

    With P = 2^p and Q = 2^q, sum W X = sum W (X + P) - P sum W, and for the products
    sum W Y X = sum W (Y + Q)(X + P) - P sum W Y - Q sum W X - P Q sum W.
    """
    mass, *others = raw.integers
    p, q = raw.biases
    biases = (p, p, p, q, q, q)
    single = [k - (mass << bias) for k, bias in zip(others, biases, strict=False)]
    products = [
        k - (single[i] << biases[j]) - (single[j] << biases[i]) - (mass << biases[i] + biases[j])
        for k, (i, j) in zip(others[6:], PRODUCTS, strict=True)
    ]
    return [mass, *single, *products]


def _by_integers(block: Pairs) -> Sums:
    source, target = lift(block.source.ravel()), lift(block.target.ravel())
    one = len(block.weights) if (block.weights == block.weights[0]).all() else 1
    weights = lift(block.weights[::one])
    x = [source.integers[k::3] for k in range(3)]
    y = [target.integers[k::3] for k in range(3)]
    w = weights.integers * one
    wx, wy = ([list(map(mul, w, column)) for column in side] for side in (x, y))
    return Sums(
        source_exponent=source.exponent if any(source.integers) else None,
        target_exponent=target.exponent if any(target.integers) else None,
        weight_exponent=weights.exponent if any(w) else None,
        integers=(
            sum(w),
            *map(sum, wx),
            *map(sum, wy),
            *(dot(left, right) for left in wy for right in x),
            *(dot(wx[i], x[j]) for i, j in UPPER),
            *(dot(wy[i], y[j]) for i, j in UPPER),
        ),
    )


def _by_limbs(block: Pairs) -> Sums:
    starts = range(0, len(block.weights), LIMB_POINTS)
    parts = (slice(first, first + LIMB_POINTS) for first in starts)
    return sum((_by_few_limbs(block.rows(rows)) for rows in parts), start=EMPTY)


def _by_few_limbs(block: Pairs) -> Sums:
    """The sums of at most 2^13 points; by integers where they take too many limbs."""
    weights = block.weights[:1] if (block.weights == block.weights[0]).all() else block.weights
    sides = (block.source, block.target, weights[:, None])
    cut = [_limbs(np.ascontiguousarray(side.T)) for side in sides]
    if None in cut:
        return _by_integers(block)
    x, y, w = (limbs for limbs in cut if limbs is not None)
    sums_of = _products(x, y, w)
    units = (x.unit, y.unit, w.unit)
    return Sums.stated(sums_of, units, (x.lowest, y.lowest, w.lowest))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Limbs:
    """Rows of numbers, (rows, limbs, count), each the sum over its limbs k of limb_k 2^(B (L-1-k)).

    That times 2^unit; B bits a limb, L limbs, all integers, the first at most 2^B in size, others
    2^(B-1). lowest: exponent of the lowest bit set anywhere; None: all are zero.
    """

    limbs: NDArray[np.float64]
    unit: int
    lowest: int | None


def _limbs(rows: NDArray[np.float64]) -> _Limbs | None:
    """Finite numbers cut into limbs; None if they take too many."""
    limbs: list[NDArray[np.float64]] = []
    exponent = int(np.frexp(np.abs(rows).max())[1])
    rest = np.ldexp(rows, -exponent)
    if not np.array_equal(np.ldexp(rest, exponent), rows):
        return None
    while rest.any():
        if len(limbs) == MOST_LIMBS:
            return None
        rest *= 2.0**LIMB_BITS
        limbs.append(np.rint(rest))
        rest -= limbs[-1]  # exact: of fewer bits
    if not limbs:
        return _Limbs(limbs=np.zeros((len(rows), 1, rows.shape[1])), unit=0, lowest=None)
    unit = exponent - LIMB_BITS * len(limbs)
    last = int(np.bitwise_or.reduce(limbs[-1].astype(np.int64), axis=None))
    lowest = unit + (last & -last).bit_length() - 1
    return _Limbs(limbs=np.stack(limbs, axis=1), unit=unit, lowest=lowest)


def _products(x: _Limbs, y: _Limbs, w: _Limbs) -> tuple[int, ...]:
    """The 28 sums, each over the units of its factors multiplied; one weight counts for all."""
    count = x.limbs.shape[2]
    if w.limbs.shape[2] == count:
        return _products_of(_total(w.limbs), _weighted(w, x), _weighted(w, y), x, y)
    (one,) = _total(w.limbs)
    return tuple(one * k for k in _products_of([count], x.limbs, y.limbs, x, y))


def _products_of(
    mass: list[int], wx: NDArray[np.float64], wy: NDArray[np.float64], x: _Limbs, y: _Limbs
) -> tuple[int, ...]:
    """The same, of coordinates that are times their weights already."""
    xx, yx, yy = _table(wx, x), _table(wy, x), _table(wy, y)
    return (
        *mass,
        *_total(wx),
        *_total(wy),
        *(yx[i][j] for i in range(3) for j in range(3)),
        *(xx[i][j] for i, j in UPPER),
        *(yy[i][j] for i, j in UPPER),
    )


def _weighted(w: _Limbs, side: _Limbs) -> NDArray[np.float64]:
    """(3, limbs, count): the rows times the weights, in limbs again, as many as of both together.

    Products of limbs are below 2^40 and are added up, at most twelve of them, before they carry.
    """
    base = 2.0**LIMB_BITS
    left, right = w.limbs.shape[1], side.limbs.shape[1]
    product = np.zeros((len(side.limbs), left + right, side.limbs.shape[2]))
    for k in range(left):
        product[:, k + 1 : k + 1 + right] += w.limbs[:, k, None] * side.limbs
    for k in range(left + right - 1, 0, -1):
        carry = np.rint(product[:, k] / base)
        product[:, k] -= carry * base
        product[:, k - 1] += carry
    return product


def _table(left: NDArray[np.float64], right: _Limbs) -> list[list[int]]:
    """3x3: the sums of the products of rows of both; no product of matrices rounds (2^53)."""
    rows, many, count = left.shape
    few = right.limbs.shape[1]
    one, other = left.reshape(-1, count), right.limbs.reshape(-1, count).T
    product = np.zeros((len(one), other.shape[1]))
    for k in range(0, count, PRODUCT_POINTS):
        product += one[:, k : k + PRODUCT_POINTS] @ other[k : k + PRODUCT_POINTS]
    parts = product.astype(np.int64).reshape(rows, many, -1, few)
    by_place = np.zeros((rows, parts.shape[2], many + few - 1), dtype=np.int64)
    for k in range(few):
        by_place[:, :, k : k + many] += parts[:, :, :, k].swapaxes(1, 2)
    return [[joined(places, LIMB_BITS) for places in row] for row in by_place.tolist()]


def _total(rows: NDArray[np.float64]) -> list[int]:
    """The sum of each row."""
    return [joined(places, LIMB_BITS) for places in rows.sum(axis=2).astype(np.int64).tolist()]


def _least(one: int | None, other: int | None) -> int | None:
    if one is None or other is None:
        return one if other is None else other
    return min(one, other)


def _difference(exponent: int | None, least: int | None) -> int:
    return 0 if exponent is None or least is None else exponent - least


def _fastest(problem: RegistrationProblem) -> SumMethod:
    compiled = _compiled() if problem.n >= FEW_POINTS else None
    if compiled is None:
        return SumMethod.INTEGERS if problem.n < MANY_POINTS else SumMethod.LIMBS
    fixed = problem.n >= FIXED_POINTS and compiled.multiplies_digits and _fits(compiled, problem)
    return SumMethod.FIXED_POINT if fixed else SumMethod.BY_EXPONENT


WEIGHTED = Summation(
    methods={
        SumMethod.INTEGERS: _by_integers,
        SumMethod.LIMBS: _by_limbs,
        SumMethod.BY_EXPONENT: lambda pairs: _by_exponent(loaded_library(), pairs),
        SumMethod.FIXED_POINT: lambda pairs: _by_fixed_point(loaded_library(), pairs),
    },
    fastest=_fastest,
    opinions=(SumMethod.FIXED_POINT, SumMethod.BY_EXPONENT),
    empty=EMPTY,
)
SUMMATIONS = {  # by whether springs are matrices
    False: lambda: WEIGHTED,
    True: found_late("certreg.problem.stiffness", "SPRUNG"),
}
