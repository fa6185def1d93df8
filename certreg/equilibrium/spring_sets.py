"""All sets of springs that may hold at one pose, with proofs that the others do not.

Where springs i and j both hold, |r_i| < b_i and |r_j| < b_j, the difference of their residuals is
shorter than b_i + b_j, and the lengths |x_j - x_i| and |y_j - y_i| differ by less. So a set that
holds is a clique in the graph of the pairs that pass this test, decided in integers; a set of at
least k has its springs where each has k - 1 neighbours; and a set that never holds, for its least
energy is too large, is part of none that does.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from certreg.equilibrium.breaking import SpringSet
from certreg.errors import UndecidedError
from certreg.geometry.so3 import squared_norm
from certreg.problem.lifting import exact_springs

if TYPE_CHECKING:
    from collections.abc import Iterator

    from certreg.problem.lifting import ExactSprings
    from certreg.problem.problem import RegistrationProblem

LEAST_SPRINGS = 3  # two hold the body in no pose: it turns about their line
LARGEST_TRIED = 12  # springs of a set that is tried with all larger ones: more seldom refute
BRANCHES_A_SET = 16  # of the search, each quicker than a set: those without an end are given up


def consistent_springs(problem: RegistrationProblem) -> list[int]:
    """For each spring those that may hold at one pose with it, as bits of an integer."""
    near, rows = [0] * problem.n, exact_springs(problem)
    for j in range(problem.n):
        for i in range(j):
            if _agree(rows, i, j):
                near[i] |= 1 << j
                near[j] |= 1 << i
    return near


def label_sets(problem: RegistrationProblem, least: int, most_sets: int) -> Iterator[SpringSet]:
    """All sets of at least `least` >= 3 springs that may hold: cliques that are not refuted.

    Raises UndecidedError where more than `most_sets` sets would have to be looked at.
    """
    yield from _Sets(problem, least, most_sets).all()


@dataclass(frozen=True, slots=True)
class _Branch:
    """The sets of all of `taken` and some of `free`; last: of `taken`, where it was looked at."""

    taken: tuple[int, ...]
    free: int
    last: SpringSet | None


class _Sets:
    """A search through the cliques: each spring in turn is taken, or left out."""

    def __init__(self, problem: RegistrationProblem, least: int, most_sets: int) -> None:
        self._problem, self._least = problem, least
        self._most = self._left = most_sets
        self._branches_left = BRANCHES_A_SET * most_sets + problem.n
        self._near = consistent_springs(problem)

    def all(self) -> Iterator[SpringSet]:
        branches = [_Branch((), (1 << self._problem.n) - 1, None)]
        while branches:
            branch = branches.pop()
            self._count_branch()
            taken, free = branch.taken, self._linked(branch)
            if len(taken) + free.bit_count() < self._least:
                continue
            if not free:
                yield branch.last or self._looked_at(taken)
                continue
            first = free & -free
            row = first.bit_length() - 1
            branches.append(_Branch(taken, free ^ first, branch.last))
            more = (*taken, row)
            grown = self._looked_at(more) if LEAST_SPRINGS <= len(more) <= LARGEST_TRIED else None
            if grown is None or not grown.never_holds:
                branches.append(_Branch(more, free & self._near[row], grown))

    def _linked(self, branch: _Branch) -> int:
        """The free springs, less those with too few neighbours for a set that is large enough."""
        free, needed = branch.free, self._least - len(branch.taken) - 1
        while needed > 0:
            few = [i for i in rows_of(free) if (self._near[i] & free).bit_count() < needed]
            if not few:
                break
            free &= ~sum(1 << i for i in few)
        return free

    def _count_branch(self) -> None:
        if not self._branches_left:
            raise self._too_many
        self._branches_left -= 1

    def _looked_at(self, rows: tuple[int, ...]) -> SpringSet:
        if not self._left:
            raise self._too_many
        self._left -= 1
        return SpringSet(self._problem, rows)

    @property
    def _too_many(self) -> UndecidedError:
        message = (
            f"more than {self._most} sets of springs may hold together: give narrower bounds, "
            "ask for more unbroken springs (`least`), or for more sets (`most_sets`)"
        )
        return UndecidedError(message, method="label sets")


def rows_of(mask: int) -> Iterator[int]:
    """The places of the ones, ascending."""
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low


def _agree(rows: ExactSprings, i: int, j: int) -> bool:
    """Whether | |x_j - x_i| - |y_j - y_i| | < b_i + b_j = d, in integers and without a root.

    With A >= B the squared lengths it is so iff A - B - d^2 < 2 d sqrt(B).
    """
    x, y = (
        squared_norm([q - p for p, q in zip(points[i], points[j], strict=True)])
        for points in (rows.sources, rows.targets)
    )
    A, B, d = max(x, y), min(x, y), rows.bounds[i] + rows.bounds[j]
    excess = A - B - d * d
    return excess < 0 or excess * excess < 4 * d * d * B
