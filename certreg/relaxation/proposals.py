"""Poses with ever more pairs within their bounds: a search that goes on only while it is asked.

It proposes and proves nothing: whoever can prove that no pose has more rows stops asking. It begins
with graduated non-convexity. Then come large cliques of rows that agree in their lengths, and all
cliques of one row more than the best set: mostly few, and when none of them fits, the search ends.
Where they are too many, triples of rows are drawn. Each pose is fitted to its rows anew, and
widened by rows on the edge of their bounds; rows that agree with too few others to be of a larger
set are left out.

Where the scale is free, two pairs that one motion meets have a range of scales: |y_j - y_i| is
s |x_j - x_i| but for their two bounds. Scales within most of these ranges are tried, after
graduated non-convexity [Yang2020]: at each of them rows that agree are cliques, as where the scale
is known. What is found is fitted with its scale.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from certreg.native.bitset_graph import BitRows, rows_of
from certreg.relaxation.cliques import CliqueSearch, consistency, core, greedy_cliques
from certreg.relaxation.edge_rows import Held, best_that_fits, exchanged, grown, held, widened
from certreg.relaxation.graduated_nonconvexity import Candidate, candidate_of, truncated_fit
from certreg.relaxation.paired_rows import (
    Poses,
    fitted,
    paired_rows,
    poses_of_triples,
    squared_ratios,
)
from certreg.relaxation.paired_scales import Similar, SimilarRows

if TYPE_CHECKING:
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
# Where the scale is free.
SCALES = 64  # that are tried at effort 1
CLIQUES_AT_SCALE = 4  # begun at each
DEEP = 8  # scales, at effort 1, where all that is known of rigid motions is tried
VOTERS = 1024  # rows whose pairs vote, drawn where there are more
SHARES = (0.25, 1.0)  # of the bounds by which pairs vote: most residuals are far below them
APART = 0.25  # of the usual half width of a range: so far are scales that are tried from each other
SMALL = 1e-3  # of a bound: what the source shrinks to where the targets alone are near each other
REFITS = 20  # three are usual
LEAST_ROWS = 3


def candidates(
    source: NDArray[np.float64],
    target: NDArray[np.float64],
    bounds: NDArray[np.float64],
    *,
    free_scale: bool = False,
    effort: float = 1.0,
    consistent: BitRows | None = None,
) -> Iterator[Candidate]:
    """Motions of strictly growing numbers of inliers, each computed when it is asked for.

    source, target: (N, 3). bounds: (N,), positive, in the unit of the target. free_scale: whether
    motions have a scale other than 1. effort: in proportion to the work after which the search
    ends. consistent: which two rows a rigid motion may have within their bounds both; None: told by
    their lengths.
    """
    rng = np.random.default_rng(0)  # the same problem has the same motions
    if free_scale:
        rows = SimilarRows.of(source, target, bounds)
        return _ScaledSearch(rows, effort, rng).candidates()
    pairs = paired_rows(source, target, bounds)
    return _Search(pairs, effort, rng).candidates(consistent)


@dataclass(slots=True, eq=False)
class _Search:
    """What is sought, and the best that was met."""

    pairs: PairedRows
    effort: float
    rng: np.random.Generator
    best: int = -1
    tried: set[bytes] = field(default_factory=set[bytes])

    def candidates(self, consistent: BitRows | None) -> Iterator[Candidate]:
        """Those with more rows than the one before."""
        count = -1
        for found in self.proposals(consistent):
            if found.count > count:
                count = found.count
                yield candidate_of(self.pairs, found.pose, squared_ratios(self.pairs, found.pose))

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


@dataclass(slots=True, eq=False)
class _ScaledSearch:
    """What is sought, and how many rows the best motion has."""

    rows: SimilarRows
    effort: float
    rng: np.random.Generator
    best: int = -1
    tried: set[bytes] = field(default_factory=set[bytes])

    def candidates(self) -> Iterator[Candidate]:
        """Those with more rows than the one before."""
        count = -1
        for found in self.proposals():
            within = self.rows.within(found)
            if within.sum() > count and found.scale > 0.0:
                count = int(within.sum())
                scale, translation = self.rows.outside(found)
                yield Candidate(found.rotation, translation, np.flatnonzero(within), scale)

    def proposals(self) -> Iterator[Similar]:
        """Motions, not yet sifted."""
        yield from self.followed(self.rows.truncated_fit())
        scales = voted_scales(self.rows, math.ceil(SCALES * self.effort), self.rng)
        least, most = self.rows.ranges(1.0)
        for scale in scales:
            agree = (least <= scale) & (most >= scale)
            np.fill_diagonal(agree, val=False)
            yield from self.of_cliques(BitRows.of_table(agree))
        for scale in scales[: math.ceil(DEEP * self.effort)]:
            yield from self.of_rigid_motions(scale)

    def followed(self, start: Similar) -> Iterator[Similar]:
        """The motion fitted anew as long as it gains rows, then widened at its scale."""
        found, within = start, self.rows.within(start)
        for _ in range(REFITS):
            if within.sum() < LEAST_ROWS:
                break
            again = self.rows.fitted(within * self.rows.precisions)
            now = self.rows.within(again)
            if now.sum() < within.sum():
                break
            gained = now.sum() > within.sum()
            found, within = again, now
            if not gained:
                break
        key = within.tobytes()
        if within.sum() < self.best or key in self.tried:
            return
        self.tried.add(key)
        self.best = max(self.best, int(within.sum()))
        yield found
        yield self.wider(found, within)

    def wider(self, found: Similar, within: NDArray[np.bool_]) -> Similar:
        """With rows on the edge of their bounds, at its scale."""
        pairs = self.rows.at(found.scale)
        if not within[pairs.rows].any():
            return found
        shift = found.rotation @ pairs.source_centre + found.translation - pairs.target_centre
        start = Held(Poses(found.rotation, shift / pairs.unit), within[pairs.rows])
        wide = widened(pairs, start)
        self.best = max(self.best, wide.count)
        return self.rows.of_pose(found.scale, pairs, wide.pose)

    def of_cliques(self, near: BitRows) -> Iterator[Similar]:
        """From large cliques of rows that agree."""
        alive = core(near, self.best)
        for clique in islice(greedy_cliques(near, alive), CLIQUES_AT_SCALE):
            if len(clique) >= max(LEAST_ROWS, self.best):
                weights = np.zeros(len(self.rows.bounds))
                weights[clique] = self.rows.precisions[clique]
                yield from self.followed(self.rows.fitted(weights))
            if alive.bit_count() <= self.best:
                return

    def of_rigid_motions(self, scale: float) -> Iterator[Similar]:
        """From all that the search of rigid motions finds at a scale."""
        rows = self.rows
        for one in candidates(
            scale * rows.source, rows.target, rows.bounds, effort=min(1.0, self.effort)
        ):
            yield from self.followed(Similar(scale, one.rotation, one.translation))


def voted_scales(rows: SimilarRows, most: int, rng: np.random.Generator) -> list[float]:
    """Scales that are in most of the ranges of pairs of rows, apart from each other.

    In turn by narrow ranges and by whole ones; then one so small that the targets alone count.
    """
    if len(rows.bounds) > VOTERS:
        some = np.sort(rng.choice(len(rows.bounds), VOTERS, replace=False))
    else:
        some = np.arange(len(rows.bounds))
    upper = np.triu_indices(len(some), 1)
    lists: list[list[float]] = []
    for share in SHARES:
        low, high = (ends[np.ix_(some, some)][upper] for ends in rows.ranges(share))
        lists.append(_peaks(low, high, -(-most // len(SHARES))))
    found = [scales[k] for k in range(most) for scales in lists if k < len(scales)]
    size = float(np.abs(rows.source).max())
    if size > 0.0:
        found.append(SMALL * float(rows.bounds.min()) / size)
    return list(dict.fromkeys(found))


def _peaks(least: Reals, most: Reals, count: int) -> list[float]:
    """Where most ranges overlap, the most first."""
    good = np.isfinite(most) & (least > 0.0)
    least, most = np.sort(least[good]), np.sort(most[good])
    if not len(least):
        return []
    votes = np.arange(1, len(least) + 1) - np.searchsorted(most, least, side="left")
    ends = most[np.minimum(np.searchsorted(most, least, side="left"), len(most) - 1)]
    width = APART * float(np.median(np.log(most / least)) / 2.0)
    places = 0.5 * (np.log(least) + np.log(np.maximum(ends, least)))
    found: list[float] = []
    order = np.argsort(-votes, kind="stable")
    free = np.ones(len(order), dtype=bool)
    for k in order.tolist():
        if len(found) >= count:
            break
        if free[k]:
            found.append(math.exp(places[k]))
            free &= np.abs(places - places[k]) > width
    return found
