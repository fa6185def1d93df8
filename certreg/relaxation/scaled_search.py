"""Motions whose scale is free, with ever more pairs within their bounds; proposals, as all here.

Two pairs that one motion meets have a range of scales: |y_j - y_i| is s |x_j - x_i| but for their
two bounds. Scales within most of these ranges are tried, after graduated non-convexity
[Yang2020]: at each of them rows that agree are cliques, as where the scale is known. What is found
is fitted with its scale.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from certreg.native.bit_rows import BitRows
from certreg.relaxation.cliques import core, greedy_cliques
from certreg.relaxation.consensus_search import candidates
from certreg.relaxation.edge_rows import Held, widened
from certreg.relaxation.paired_rows import Poses
from certreg.relaxation.similarity_fit import Similar, SimilarRows

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    Reals = NDArray[np.float64]

SCALES = 64  # that are tried at effort 1
CLIQUES = 4  # begun at each
DEEP = 8  # scales, at effort 1, where all that is known of rigid motions is tried
VOTERS = 1024  # rows whose pairs vote, drawn where there are more
SHARES = (0.25, 1.0)  # of the bounds by which pairs vote: most residuals are far below them
APART = 0.25  # of the usual half width of a range: so far are scales that are tried from each other
SMALL = 1e-3  # of a bound: what the source shrinks to where the targets alone are near each other
REFITS = 20  # three are usual
LEAST_ROWS = 3


@dataclass(frozen=True, slots=True, eq=False)
class ScaledCandidate:
    """A motion y = s R x + t and the rows within their bounds there, by floating point.

    scale: s > 0. rotation: (3, 3), proper. translation: (3,), in the unit of the target.
    inliers: the rows within their bounds, ascending.
    """

    scale: float
    rotation: NDArray[np.float64]
    translation: NDArray[np.float64]
    inliers: NDArray[np.int64]


def scaled_candidates(
    source: NDArray[np.float64],
    target: NDArray[np.float64],
    bounds: NDArray[np.float64],
    *,
    seed: int = 0,
    effort: float = 1.0,
) -> Iterator[ScaledCandidate]:
    """Motions of strictly growing numbers of inliers, each computed when it is asked for.

    source, target: (N, 3). bounds: (N,), positive, in the unit of the target. seed: of what is
    drawn. effort: in proportion to the work after which the search ends.
    """
    rows = SimilarRows.of(source, target, bounds)
    search = _Search(rows, effort, np.random.default_rng(seed))
    count = -1
    for found in search.proposals():
        within = rows.within(found)
        if within.sum() > count and found.scale > 0.0:
            count = int(within.sum())
            scale, translation = rows.outside(found)
            yield ScaledCandidate(scale, found.rotation, translation, np.flatnonzero(within))


@dataclass(slots=True, eq=False)
class _Search:
    """What is sought, and how many rows the best motion has."""

    rows: SimilarRows
    effort: float
    rng: np.random.Generator
    best: int = -1
    tried: set[bytes] = field(default_factory=set[bytes])

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
        for clique in islice(greedy_cliques(near, alive), CLIQUES):
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
