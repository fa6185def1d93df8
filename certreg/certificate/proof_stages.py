"""Stages of a proof of consensus: with so many pairs to be met, what is left, and what follows.

The first is of K pairs, as many as the witness meets. Where more than these are left, K + 1 is
tried, and whether the others are enough without each met pair.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from certreg.certificate.clique_refutation import Assuming
from certreg.certificate.consensus import (
    INLIER,
    NONE,
    OPEN,
    OUTLIER,
    SAME,
    UNDECIDED,
    ScaleRange,
    Stage,
    Strike,
)
from certreg.certificate.edge_elimination import Parting
from certreg.certificate.vertex_elimination import Graph, GraphThinning
from certreg.native.bitset_graph import mask_of

MOST_LEFT_OUT = 64  # pairs tried as inliers one by one, at effort 1: each is a stage of its own
MOST = 40_000  # commas and brackets of all stages; a certificate may have 50,000


@dataclass(frozen=True, slots=True, eq=False)
class Stager:
    """Makes the stages of one graph, for a witness that meets these rows.

    whole: False: no two rows are struck together where more are open than are met. That takes
    seconds of hundreds of rows, and decides little of a witness that another one will replace.
    most: of the length of all stages.
    """

    graph: Graph
    met: Sequence[int]
    whole: bool = True
    most: int = MOST

    @property
    def count(self) -> int:
        """Of all rows."""
        return len(self.graph.points.bounds)

    def first(
        self, stages: list[Stage], alive: int, clique: int | None = None
    ) -> tuple[int, Stager]:
        """The rows left by the first stage, of as many as are met; who makes the later ones.

        In these, too, no two rows are neighbours that it strikes together. clique: that of the
        thinning; None: the rows that are met.
        """
        thinning = self._thinned(
            alive, len(self.met), mask_of(self.met) if clique is None else clique
        )
        stages.append(self._kept(thinning))
        return thinning.left.alive, replace(
            self, graph=replace(self.graph, near=thinning.left.near)
        )

    def stage(
        self,
        stages: list[Stage],
        alive: int,
        least: int,
        clique: int,
        without: int | None = None,
    ) -> int:
        """The rows left by a later stage, which is kept where they are too few.

        All of them where that would make the certificate too long.
        """
        thinning = self._thinned(alive, least, clique)
        if length_of(stages) + sum(map(_length, thinning.strikes)) > self.most:
            return alive
        if thinning.left.alive.bit_count() < least:
            stages.append(self._kept(thinning, without))
        return thinning.left.alive

    def _kept(self, thinning: GraphThinning, without: int | None = None) -> Stage:
        left_out = self.count if without is None else without
        return Stage(least=thinning.least, without=left_out, strikes=tuple(thinning.strikes))

    def _thinned(self, alive: int, least: int, clique: int) -> GraphThinning:
        thinning = GraphThinning(self.graph, alive, least, clique)
        thinning.run()
        assuming, parting = Assuming(thinning), Parting(thinning)
        if self.whole or (thinning.left.alive & ~thinning.clique).bit_count() <= len(self.met):
            while assuming.run() or parting.run(assuming.given_up):
                thinning.run()
        return thinning

    def upper(self, stages: list[Stage], alive: int, *, whole: bool) -> int:
        """No motion meets more: the least number found of which too few rows are left.

        K itself is tried, and only if whole others are, by halving.
        """
        K, within = len(self.met), mask_of(self.met)
        low, high = K, alive.bit_count()
        middle, last = low, list[Stage]()
        while low < high:
            tried = [*stages]
            if self.stage(tried, alive, middle + 1, within).bit_count() <= middle:
                high, last = middle, tried[len(stages) :]
            else:
                low = middle + 1
            if not whole:
                break
            middle = (low + high) // 2
        stages += last
        return high

    def inliers(self, stages: list[Stage], first: int) -> int:
        """The met rows without which the others are not enough."""
        met, sure, within = self.met, 0, mask_of(self.met)
        if first.bit_count() - len(met) > len(met):
            return 0  # far from decided: no single row will be
        for row in met[: round(MOST_LEFT_OUT * self.graph.effort)]:
            others = ~(1 << row)
            left = self.stage(stages, first & others, len(met), within & others, row)
            sure |= (left.bit_count() < len(met)) << row
        return sure


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Part:
    """Motions whose scale is in a range, after their first stage: the rows left, and its stager."""

    stages: list[Stage]
    left: int
    stager: Stager
    scales: ScaleRange

    @classmethod
    def of(cls, stager: Stager, clique: int, scales: ScaleRange) -> Part:
        """After the first stage. clique: of `Stager.first`."""
        stages = list[Stage]()
        left, later = stager.first(stages, (1 << stager.count) - 1, clique)
        return cls(stages=stages, left=left, stager=later, scales=scales)

    @property
    def length(self) -> int:
        """Of its stages in a certificate."""
        return length_of(self.stages)

    @property
    def state(self) -> str:
        """NONE where no motion meets as many rows as the witness, SAME where all meet the same."""
        within = mask_of(self.stager.met)
        if self.left.bit_count() < within.bit_count():
            return NONE
        return SAME if self.left == within else OPEN


def settled(
    parts: Sequence[Part], *, whole: bool, progress: Callable[[], object] = tuple
) -> tuple[str, int]:
    """Labels of all rows, and how many a motion meets at most, of the motions of all parts.

    What holds in each part holds of all. Later stages are added to those that are open, until the
    certificate is full; whole: False: no more than the bound is tried. progress: called for each.
    """
    stager = parts[0].stager
    within, everything = mask_of(stager.met), (1 << stager.count) - 1
    upper, sure, union = len(stager.met), everything, 0
    spare = stager.most - sum(part.length for part in parts)
    for part in parts:
        own, length = within, part.length
        if part.state == OPEN:
            progress()
            stager = replace(part.stager, most=length + spare)
            upper = max(upper, stager.upper(part.stages, part.left, whole=whole))
            own = stager.inliers(part.stages, part.left) if whole else 0
            spare -= part.length - length
        if part.state != NONE:
            sure, union = sure & own, union | part.left
    labels = (
        INLIER if sure >> i & 1 else UNDECIDED if union >> i & 1 else OUTLIER
        for i in range(stager.count)
    )
    return "".join(labels), upper


def length_of(stages: Sequence[Stage]) -> int:
    """Of stages in a file: their commas and brackets, or a few more."""
    return sum(_length(strike) for stage in stages for strike in stage.strikes)


def _length(strike: Strike) -> int:
    """Its commas and brackets in a file, or a few more."""
    return 4 + sum(5 + len(group.rows) + len(group.weights) for group in strike.groups)
