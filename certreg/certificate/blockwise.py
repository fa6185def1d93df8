"""The checker on many points: its parser and its proofs, over points that come in blocks.

`certreg.verify.check` has all points in memory. Here they may stay in their files, and only the way
from the points to the checker is new: the digest is taken of the blocks, moments are added up.
A module of its own: it loads NumPy, and `checking`, which asks it, answers without.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import reduce
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING, Any, NamedTuple

from certreg.problem.arrays import row_blocks
from certreg.problem.exact_sums import UPPER, second_method, sums_by
from certreg.problem.support import PREFIXES
from certreg.verify import (
    SUMS,
    Limits,
    Outcome,
    RefusalError,
    bound_doubles,
    moments,
    parse,
    require,
    spring_moments,
    within,
)

if TYPE_CHECKING:
    from certreg.problem.problem import RegistrationProblem

Table = list[list[int]]
NO_MODEL = "neither --scale nor --rotation-only"


class Layout(NamedTuple):
    """Where the checker has its sums, by its own function that takes them.

    widths: of the rows of its table. places: of each sum of `certreg.problem` row, column and sign.
    weighed: whether a pair has one number behind its points.
    """

    widths: Sequence[int]
    places: dict[tuple[int, int], tuple[int, int]]
    weighed: bool


def check_in_blocks(
    certificate: bytes, problem: RegistrationProblem, limits: Limits | None = None
) -> Outcome:
    """The checker's answer, all in its own arithmetic; half an hour for a hundred million points.

    The certificate must be about exactly these points and weights.
    """
    return _checked(certificate, problem, _added_moments, limits or {})


def check_on_sums(certificate: bytes, problem: RegistrationProblem) -> Outcome:
    """The checker's proofs on exact sums by another method than a certificate's own.

    For certificates just made: a thousand times faster, and two methods would have to err alike.
    """
    return _checked(certificate, problem, _table_of_sums, {})


def _checked(
    certificate: bytes,
    problem: RegistrationProblem,
    table: Callable[[RegistrationProblem], tuple[Table, int]],
    limits: Limits,
) -> Outcome:
    try:
        return within(_proved(certificate, problem, table), limits)
    except (RefusalError, MemoryError) as error:
        return Outcome(verified=False, reason=str(error) or "not enough memory")


def _proved(
    certificate: bytes,
    problem: RegistrationProblem,
    table: Callable[[RegistrationProblem], tuple[Table, int]],
) -> Outcome:
    """What is proved. The digest is taken before and after: a file may be changed meanwhile."""
    stated = parse(certificate)
    same = stated.n == problem.n
    require(same, "the certificate is about another number of points or weights")
    same, said = problem.motion.options == stated.model, stated.model or NO_MODEL
    require(same, f"the certificate has {said}: give the same")
    if stated.data is not None:
        bound_doubles(stated, None)
    same = problem.digest() == stated.digest
    require(same, "the certificate is about other points or weights")
    m, e = table(problem)
    same = not problem.mapped or problem.digest() == stated.digest
    require(same, "the clouds were changed while they were read")
    weighed = LAYOUTS[_summed(problem)].weighed
    return stated.prove(m, e, equal=weighed and problem.equally_weighted)


def _summed(problem: RegistrationProblem) -> Callable[[bytes, int], tuple[Table, int]]:
    """What takes the sums of such a problem in the checker."""
    found: Any = SUMS.get(PREFIXES[problem.cell])
    return moments if found is None else found[1]


def _added_moments(problem: RegistrationProblem) -> tuple[Table, int]:
    """The checker's own moments, block by block."""
    summed = _summed(problem)

    def moments_of(rows: slice) -> tuple[Table, int]:
        arrays = problem.block(rows).arrays
        doubles = b"".join(array.astype("<f8").tobytes() for array in arrays)
        return summed(doubles, len(arrays[0]))

    return reduce(_added, map(moments_of, row_blocks(problem.n)))


def _added(one: tuple[Table, int], other: tuple[Table, int]) -> tuple[Table, int]:
    """The sum of two tables, over the lower power of two."""
    (left, e), (right, f) = one, other
    least = min(e, f)
    rows = zip(left, right, strict=True)
    total = [
        [(a << e - least) + (b << f - least) for a, b in zip(*row, strict=True)] for row in rows
    ]
    return total, least


def _table_of_sums(problem: RegistrationProblem) -> tuple[Table, int]:
    """The same from sums by a method that the problem's moments did not take."""
    sums, layout = sums_by(second_method(problem), problem), LAYOUTS[_summed(problem)]
    a, b, c = (e or 0 for e in (sums.source_exponent, sums.target_exponent, sums.weight_exponent))
    exponents = [c + x * a + y * b for x, y in sums.coordinates]
    least = min(exponents)
    total = [[0] * width for width in layout.widths]
    for (i, j), (place, sign) in layout.places.items():
        total[i][j] = sign * sums.integers[place] << exponents[place] - least
    return total, least


def _places_of_points() -> Iterator[tuple[int, int]]:
    """In the order of the sums: the checker's columns are 1, x, y."""
    yield from ((0, k) for k in range(7))
    yield from ((1 + j, 4 + i) for i in range(3) for j in range(3))
    yield from ((k + i, k + j) for k in (1, 4) for i, j in UPPER)


def _place_in_springs(i: int, j: int) -> tuple[int, int]:
    """Which sum is an entry of H, in (t, R by columns, 1), and its sign."""
    (x, left), (y, right) = divmod(i - 3, 3), divmod(j - 3, 3)
    spring = UPPER.index((min(left, right), max(left, right)))
    if j < 3:
        return spring, 1
    if j < 12:
        return (6 + 3 * spring + y if i < 3 else 24 + 6 * spring + UPPER.index((x, y))), 1
    return (72, 1) if i == 12 else (60 + left if i < 3 else 63 + 3 * left + x, -1)


LAYOUTS: dict[Any, Layout] = {
    moments: Layout(
        widths=[7] * 7,
        places={place: (k, 1) for k, place in enumerate(_places_of_points())},
        weighed=True,
    ),
    spring_moments: Layout(
        widths=range(13, 0, -1),  # from the diagonal on
        places={
            (i, j - i): _place_in_springs(i, j)
            for i, j in combinations_with_replacement(range(13), 2)
        },
        weighed=False,
    ),
}
