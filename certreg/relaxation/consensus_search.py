"""Poses with ever more pairs within their bounds: a search that goes on only while it is asked.

It proposes and proves nothing: whoever can prove that no pose has more rows stops asking. It begins
with graduated non-convexity. Then come large cliques of rows that agree in their lengths, and all
cliques of one row more than the best set: mostly few, and when none of them fits, the search ends.
Where they are too many, triples of rows are drawn. Each pose is fitted to its rows anew, and
widened by rows on the edge of their bounds; rows that agree with too few others to be of a larger
set are left out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from certreg.native.bit_rows import rows_of
from certreg.relaxation.cliques import CliqueSearch, consistency, core, greedy_cliques
from certreg.relaxation.edge_rows import best_that_fits, exchanged, grown, held, widened
from certreg.relaxation.paired_rows import fitted, paired_rows, poses_of_triples, squared_ratios
from certreg.relaxation.truncated_squares import Candidate, candidate_of, truncated_fit

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from certreg.native.bit_rows import BitRows
    from certreg.relaxation.edge_rows import Held
    from certreg.relaxation.paired_rows import PairedRows, Reals, Rows

    Graph = NDArray[np.bool_]

CLIQUES = 32  # that are tried at effort 1: a hundred wrong ones of a thousand rows take a second
TRIPLES = 1 << 22  # rows that are held against poses of triples at effort 1
STEPS = 1 << 16  # of the enumeration of cliques at effort 1: a tenth of a second
ENTRIES = 1 << 10  # rows of the cliques that are fitted at a time
BATCH = 256  # triples at a time
LOOSE = 4.0  # squared ratio that counts at the pose of a triple: it is not yet fitted
KEPT = 4  # triples of a batch that are fitted
NEARLY = 1  # row fewer than the best set has: a pose that is worth widening


def candidates(
    source: NDArray[np.float64],
    target: NDArray[np.float64],
    bounds: NDArray[np.float64],
    *,
    seed: int = 0,
    effort: float = 1.0,
    consistent: BitRows | None = None,
) -> Iterator[Candidate]:
    """Poses of strictly growing numbers of inliers, each computed when it is asked for.

    source, target: (N, 3). bounds: (N,), positive. seed: of what is drawn; the same one gives the
    same poses. effort: in proportion to the work after which the search ends. consistent: which two
    rows a pose may have within their bounds both; None: told by their lengths.
    """
    pairs = paired_rows(source, target, bounds)
    search = _Search(pairs, effort, np.random.default_rng(seed))
    count = -1
    for found in search.proposals(consistent):
        if found.count > count:
            count = found.count
            yield candidate_of(pairs, found.pose, squared_ratios(pairs, found.pose))


@dataclass(slots=True, eq=False)
class _Search:
    """What is sought, and the best that was met."""

    pairs: PairedRows
    effort: float
    rng: np.random.Generator
    best: int = -1
    tried: set[bytes] = field(default_factory=set[bytes])

    def proposals(self, consistent: BitRows | None) -> Iterator[Held]:
        """Sets of rows, not yet sifted: those of each source of poses in turn."""
        yield from self.followed(held(self.pairs, truncated_fit(self.pairs)))
        if consistent is None:
            near = consistency(self.pairs)
        else:
            near = consistent.of_rows(self.pairs.rows)
        yield from self.of_greedy_cliques(near)
        enumeration = CliqueSearch(math.ceil(STEPS * self.effort))
        yield from self.of_all_cliques(near, enumeration)
        if enumeration.steps < 0:
            yield from self.of_triples(near)

    def followed(self, start: Held) -> Iterator[Held]:
        """What a pose leads to."""
        found = grown(self.pairs, start)
        key = found.within.tobytes()
        if found.count < self.best - NEARLY or key in self.tried:
            return
        self.tried.add(key)
        yield self.counted(found)
        if not found.count:  # a bound below the rounding of the points
            return
        found = self.counted(widened(self.pairs, found))
        yield found
        yield self.counted(exchanged(self.pairs, found))

    def counted(self, found: Held) -> Held:
        self.best = max(self.best, found.count)
        return found

    def of_greedy_cliques(self, near: BitRows) -> Iterator[Held]:
        """From large cliques."""
        alive = core(near, self.best)
        for clique in islice(greedy_cliques(near, alive), math.ceil(CLIQUES * self.effort)):
            yield from self.followed(self.fit_of(clique))
            if alive.bit_count() <= self.best:
                return

    def of_all_cliques(self, near: BitRows, enumeration: CliqueSearch) -> Iterator[Held]:
        """From every clique of one row more than the best set, until none fits."""
        gained = True
        while gained:
            gained = False
            size = max(self.best, 0) + 1
            alive = core(near, size - 1)
            for found in enumeration.of_size(near, alive, size, max(1, ENTRIES // size)):
                sets = np.zeros((len(found), len(self.pairs)), dtype=bool)
                np.put_along_axis(sets, found, values=True, axis=1)
                better = best_that_fits(self.pairs, sets, self.best)
                if better is not None:
                    gained = True
                    yield from self.followed(better)
                    break

    def fit_of(self, rows: Rows) -> Held:
        weights = np.zeros(len(self.pairs))
        weights[rows] = self.pairs.precisions[rows]
        return held(self.pairs, fitted(self.pairs, weights))

    def of_triples(self, near: BitRows) -> Iterator[Held]:
        """From triples of rows that agree, drawn at random, those with most rows near them."""
        left = TRIPLES * self.effort
        while left > 0:
            rows = np.array(list(rows_of(core(near, self.best))), dtype=np.int64)
            if len(rows) <= max(self.best, 2):
                return
            left -= BATCH * len(rows)
            some = self.pairs.of(rows)
            triples = drawn_triples(near.table[np.ix_(rows, rows)], BATCH, self.rng)
            if not len(triples):
                return
            poses = poses_of_triples(some, triples)
            counts = (squared_ratios(some, poses) <= LOOSE).sum(axis=1)
            for index in np.argsort(-counts, kind="stable")[:KEPT]:
                yield from self.followed(held(self.pairs, poses[int(index)]))


def drawn_triples(graph: Graph, count: int, rng: np.random.Generator) -> Rows:
    """Triangles of the graph, (up to `count`, 3): a random edge and a random common neighbour."""
    first, second = np.nonzero(graph)
    if not len(first):
        return np.empty((0, 3), dtype=np.int64)
    chosen = rng.integers(len(first), size=count)
    i, j = first[chosen], second[chosen]
    common = graph[i] & graph[j]
    i, j, common = i[some := common.any(axis=1)], j[some], common[some]
    lots: Reals = rng.random(common.shape)
    return np.stack([i, j, np.where(common, lots, -1.0).argmax(axis=1)], axis=1)
