"""The checker on many points: its parser and its proofs, over points that come in blocks.

`certreg.verify.check` has all points in memory. Here they may stay in their files, and only the way
from certreg.problem.exact_sums import Sums
from the points to the checker is new: the digest is taken of the blocks, moments are added up.
A module of its own: it loads NumPy, and `checking`, which asks it, answers without.
"""

from __future__ import annotations

from itertools import combinations_with_replacement
from typing import TYPE_CHECKING

from certreg.problem.arrays import row_blocks
from certreg.problem.exact_sums import FACTORS, UPPER, second_method, sums_by
from certreg.verify import (
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
    from collections.abc import Callable, Sequence

    from certreg.problem.exact_sums import Sums
    from certreg.problem.problem import RegistrationProblem
    from certreg.verify import Limits

Table = list[list[int]]
NO_MODEL = "neither --scale nor --rotation-only"
# Where the sums of `certreg.problem` stand in the checker's table: its columns are 1, x, y.
PLACES = (
    (0, 0),
    *((0, 1 + i) for i in range(6)),
    *((1 + j, 4 + i) for i in range(3) for j in range(3)),
    *((1 + i, 1 + j) for i, j in UPPER),
    *((4 + i, 4 + j) for i, j in UPPER),
)


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
    return stated.prove(m, e, equal=problem.factors is None and problem.equally_weighted)


def _added_moments(problem: RegistrationProblem) -> tuple[Table, int]:
    """The checker's own moments, block by block."""
    total, exponent = [[0] * k for k in _widths(problem)], 0
    for rows in row_blocks(problem.n):
        table, e = _block_moments(problem, rows)
        least = min(e, exponent)
        total = [
            [(old << exponent - least) + (new << e - least) for old, new in zip(*pair, strict=True)]
            for pair in zip(total, table, strict=True)
        ]
        exponent = least
    return total, exponent


def _widths(problem: RegistrationProblem) -> Sequence[int]:
    """Of the rows of the checker's table: 7x7, of general springs 13x13 from the diagonal on."""
    return [7] * 7 if problem.factors is None else range(13, 0, -1)


def _block_moments(problem: RegistrationProblem, rows: slice) -> tuple[Table, int]:
    arrays = problem.block(rows).arrays
    summed = moments if problem.factors is None else spring_moments
    return summed(b"".join(array.astype("<f8").tobytes() for array in arrays), len(arrays[0]))


def _table_of_sums(problem: RegistrationProblem) -> tuple[Table, int]:
    """The same from sums by a method that the problem's moments did not take."""
    sums = sums_by(second_method(problem), problem)
    if problem.factors is not None:
        return _table_of_springs(sums)
    a, b, c = (e or 0 for e in (sums.source_exponent, sums.target_exponent, sums.weight_exponent))
    exponents = [c + x * a + y * b for x, y in FACTORS]
    least = min(exponents)
    total = [[0] * 7 for _ in range(7)]
    for (i, j), k, exponent in zip(PLACES, sums.integers, exponents, strict=True):
        total[i][j] = k << exponent - least
    return total, least


def _table_of_springs(sums: Sums) -> tuple[Table, int]:
    """H, 13x13 from the diagonal on, in (t, R by columns, 1)."""
    numbers = sums.integers
    a, b, c = (e or 0 for e in (sums.source_exponent, sums.target_exponent, sums.weight_exponent))
    least = c + min(0, 2 * a, 2 * b)  # 0 of a shift, a of an entry of R, b of the 1: twice each
    total = [[0] * k for k in range(13, 0, -1)]
    for i, j in combinations_with_replacement(range(13), 2):
        (x, left), (y, right) = divmod(i - 3, 3), divmod(j - 3, 3)
        spring = UPPER.index((min(left, right), max(left, right)))
        if j < 3:
            entry, exponent = numbers[spring], c
        elif j < 12:
            of_points = 6 + 3 * spring + y if i < 3 else 24 + 6 * spring + UPPER.index((x, y))
            entry, exponent = numbers[of_points], c + a * (1 + (i >= 3))
        elif i < 12:
            at = 60 + left if i < 3 else 63 + 3 * left + x
            entry, exponent = -numbers[at], c + b + a * (i >= 3)
        else:
            entry, exponent = numbers[72], c + 2 * b
        total[i][j - i] = entry << exponent - least
    return total, least
