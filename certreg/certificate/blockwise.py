"""The checker on many points: its parser and its proofs, over points that come in blocks.

`certreg.verify.check` has all points in memory. Here they may stay in their files, and only the way
from the points to the checker is new: the digest is taken of the blocks, moments are added up.
A module of its own: it loads NumPy, and `checking`, which asks it, answers without.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.problem import (
    FACTORS,
    UPPER,
    row_blocks,
    second_method,
    sums_by,
)
from certreg.verify import Outcome, RefusalError, bound_doubles, moments, parse, require, within

if TYPE_CHECKING:
    from collections.abc import Callable

    from certreg.problem import RegistrationProblem
    from certreg.verify import Limits

Table = list[list[int]]
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
        return Outcome(verified=False, theorems=(), reason=str(error) or "not enough memory")


def _proved(
    certificate: bytes,
    problem: RegistrationProblem,
    table: Callable[[RegistrationProblem], tuple[Table, int]],
) -> Outcome:
    """What is proved. The digest is taken before and after: a file may be changed meanwhile."""
    stated = parse(certificate)
    same = stated.n == problem.n
    require(same, "the certificate is about another number of points or weights")
    if stated.data is not None:
        bound_doubles(stated, None)
    same = problem.digest() == stated.digest
    require(same, "the certificate is about other points or weights")
    m, e = table(problem)
    same = not problem.mapped or problem.digest() == stated.digest
    require(same, "the clouds were changed while they were read")
    return stated.prove(m, e, equal=problem.equally_weighted)


def _added_moments(problem: RegistrationProblem) -> tuple[Table, int]:
    """The checker's own moments, block by block."""
    total, exponent = [[0] * 7 for _ in range(7)], 0
    for rows in row_blocks(problem.n):
        block = problem.block(rows)
        arrays = (block.source, block.target, block.weights)
        content = b"".join(array.astype("<f8").tobytes() for array in arrays)
        table, e = moments(content, len(block.weights))
        least = min(e, exponent)
        total = [
            [(old << exponent - least) + (new << e - least) for old, new in zip(*pair, strict=True)]
            for pair in zip(total, table, strict=True)
        ]
        exponent = least
    return total, exponent


def _table_of_sums(problem: RegistrationProblem) -> tuple[Table, int]:
    """The same from sums by a method that the problem's moments did not take."""
    sums = sums_by(second_method(problem), problem)
    a, b, c = (e or 0 for e in (sums.source_exponent, sums.target_exponent, sums.weight_exponent))
    exponents = [c + x * a + y * b for x, y in FACTORS]
    least = min(exponents)
    total = [[0] * 7 for _ in range(7)]
    for (i, j), k, exponent in zip(PLACES, sums.integers, exponents, strict=True):
        total[i][j] = k << exponent - least
    return total, least
