"""What data add to the energy of a motion: pairs of points, each with its spring."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Self

import numpy as np

from certreg._loading import cached_property
from certreg.errors import InvalidProblemError
from certreg.problem.arrays import contiguous, row_blocks
from certreg.problem.factors import ranks_of
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Reals = NDArray[np.float64]
    Named = tuple[str, Reals]

KINDS = {1: "plane", 2: "line", 3: "full"}  # by rank, where all pairs have the same
NO_WEIGHTS = (
    "this problem has general springs, a matrix for every pair and not a weight: what was asked is "
    "for weights only"
)


@dataclass(frozen=True, kw_only=True, eq=False)
class Pairs(Brief):
    """Pairs of points, one weight each: the energy is the sum of w |y - s R x - t|^2.

    What depends on whether springs are weights or matrices is answered here, and in `SprungPairs`.

    source, target: (k, 3). springs: (k,), the weights. In memory, or mapped from a file.
    """

    source: Reals
    target: Reals
    springs: Reals
    matrices: ClassVar[bool] = False
    name: ClassVar[str] = "weights"  # of the springs, as users know them
    least: ClassVar[float] = 0.0  # a spring has no number below it

    @property
    def weights(self) -> Reals:
        """(k,). Raises InvalidProblemError where the springs are matrices."""
        return self.springs

    @property
    def masses(self) -> Reals:
        """What counts a pair: its weight; (1,), of all the same where the springs are matrices."""
        return self.springs

    @cached_property
    def summary(self) -> SpringSummary | None:
        """What kinds of matrices there are."""
        return None

    @property
    def observations(self) -> int:
        """Three of each pair with weight."""
        blocks = (contiguous(self.springs, rows) for rows in row_blocks(len(self.springs)))
        return 3 * sum(int(np.count_nonzero(block)) for block in blocks)

    @property
    def arrays(self) -> tuple[Reals, Reals, Reals]:
        """Source, target, springs: what states the energy."""
        return self.source, self.target, self.springs

    def rows(self, which: slice | Sequence[int] | NDArray[np.int64]) -> Self:
        """Some of these pairs, in doubles."""
        source, target, springs = (a[which].astype(np.float64, copy=False) for a in self.arrays)
        return type(self)(source=source, target=target, springs=springs)

    def block(self, rows: slice) -> Self:
        """Some of the pairs in doubles, contiguous.

        Raises InvalidProblemError where a file holds no proper points any more.
        """
        return type(self)(
            source=contiguous(self.source, rows, "source"),
            target=contiguous(self.target, rows, "target"),
            springs=contiguous(self.springs, rows, self.name, self.least),
        )

    def data(self, *beside: Named) -> tuple[Named, ...]:
        """What a digest binds, in its order; beside: what it binds of the loss."""
        return ("source", self.source), ("target", self.target), (self.name, self.springs), *beside


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringSummary(Brief):
    """What kind of springs a problem has.

    kind: "plane", "line" or "full" where all that count have the rank 1, 2 or 3, else "mixed".
    ranks: how many springs have the rank 0, 1, 2, 3; those of rank 0 do not count.
    notes: what the user should know.
    """

    kind: str
    ranks: tuple[int, int, int, int]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True, eq=False)
class SprungPairs(Pairs):
    """Pairs with a matrix each: the energy is the sum of (y - R x - t)^T W (y - R x - t).

    springs: (k, 6), the factors, W = L L^T. noted: what the user should know of them.
    """

    noted: tuple[str, ...] = ()
    matrices: ClassVar[bool] = True
    name: ClassVar[str] = "factors"
    least: ClassVar[float] = -np.inf

    @property
    def weights(self) -> Reals:
        """None: raises InvalidProblemError."""
        raise InvalidProblemError(NO_WEIGHTS, array="weights")

    @property
    def masses(self) -> Reals:
        """(1,), 1: one for all."""
        return np.ones(1)

    @cached_property
    def summary(self) -> SpringSummary:
        """What kinds of matrices there are, by the exact ranks of their factors.

        Raises InvalidProblemError where none counts.
        """
        counts = np.zeros(4, dtype=np.int64)
        for part in row_blocks(len(self.springs)):
            counts += np.bincount(ranks_of(self.springs[part]), minlength=4)
        present = [rank for rank in KINDS if counts[rank]]
        if not present:
            raise InvalidProblemError(
                "all springs are zero: no correspondence counts, so every pose is as good",
                array="factors",
                value=0.0,
            )
        zero, one, two, three = counts.tolist()
        kind = KINDS[present[0]] if len(present) == 1 else "mixed"
        return SpringSummary(kind=kind, ranks=(zero, one, two, three), notes=self.noted)

    @property
    def observations(self) -> int:
        """The rank of each spring."""
        return sum(rank * count for rank, count in enumerate(self.summary.ranks))

    def data(self, *beside: Named) -> tuple[Named, ...]:
        """The same, with the matrices behind what a digest binds of the loss."""
        source, target, springs = super().data()
        return source, target, *beside, springs
