"""A pose near another one with more rows within their bounds: those on the edge of their bounds.

The pose of least squares is not the one with the most rows. Whether some rows fit together is a
question of the least largest ratio of distance to bound: Lawson's iteration finds it by fits whose
weights grow with the ratios, and the weighted mean of the squared ratios is a lower bound of the
largest: above 1 the rows do not fit. Source: [Lawson1961].
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from certreg.native.lawson import lawson_columns
from certreg.relaxation.paired_rows import Poses, fitted, squared_ratios

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from certreg.relaxation.paired_rows import PairedRows, Reals

    Sets = NDArray[np.bool_]

MOST_REFITS = 20  # three are usual
# 5 to 20 decide most sets; what is left is within 2 percent of its bounds. In native/lawson.c, too.
LAWSON_STEPS = 80
REACH = 16.0  # squared ratio of rows that may still come within their bounds
MOST_NEAR = 12  # rows that are tried, the nearest ones
MOST_JOINED = 6  # of them in twos
SUPPORTS = 4  # rows of largest weight, each left out in turn


@dataclass(frozen=True, slots=True, eq=False)
class Held:
    """A pose and which rows are within their bounds there, (N,)."""

    pose: Poses
    within: Sets

    @property
    def count(self) -> int:
        """How many rows are within their bounds."""
        return int(self.within.sum())


def held(pairs: PairedRows, pose: Poses) -> Held:
    """One pose with its rows."""
    return Held(pose, squared_ratios(pairs, pose) <= 1.0)


def grown(pairs: PairedRows, start: Held) -> Held:
    """The rows after they have been fitted anew as long as their number grows.

    Where none is within its bound it begins with the nearest.
    """
    precisions = pairs.precisions
    if not start.count:
        nearest = squared_ratios(pairs, start.pose).argmin()
        return held(pairs, fitted(pairs, precisions * (np.arange(len(pairs)) == nearest)))
    for _ in range(MOST_REFITS):
        refit = held(pairs, fitted(pairs, start.within * precisions))
        if refit.count <= start.count:
            break
        start = refit
    return start


def widened(pairs: PairedRows, start: Held) -> Held:
    """The rows with others near them, one at a time, as long as all fit together."""
    for _ in range(len(pairs)):
        sets = start.within | _one_hot(_near(pairs, start), len(pairs))
        better = best_that_fits(pairs, sets, start.count)
        if better is None:
            break
        start = better
    return start


def exchanged(pairs: PairedRows, start: Held) -> Held:
    """The rows with two others instead of one of their own, if that fits; then widened."""
    size = len(pairs)
    near = _near(pairs, start)[:MOST_JOINED]
    twos = [start.within | _one_hot(two, size).any(axis=0) for two in combinations(near, 2)]
    if not twos:
        return start
    joined = np.array(twos)
    weights = lawson_fits(pairs, joined).weights
    heavy = np.argsort(-weights, axis=1, kind="stable")[:, :SUPPORTS]
    sets = joined[:, np.newaxis] & ~_one_hot(heavy.ravel(), size).reshape(*heavy.shape, size)
    better = best_that_fits(pairs, sets.reshape(-1, size), start.count)
    return start if better is None else widened(pairs, better)


def _near(pairs: PairedRows, start: Held) -> NDArray[np.int64]:
    """Rows outside their bounds that may come within them, the nearest first."""
    ratios = squared_ratios(pairs, fitted(pairs, start.within * pairs.precisions))
    ratios = np.where(start.within, np.inf, ratios)
    order = np.argsort(ratios, kind="stable")[:MOST_NEAR]
    return order[ratios[order] <= REACH]


def _one_hot(rows: Iterable[int], size: int) -> Sets:
    return np.array(list(rows), dtype=np.int64)[:, np.newaxis] == np.arange(size)


def best_that_fits(pairs: PairedRows, sets: Sets, count: int) -> Held | None:
    """Of sets that fit, the pose with most rows, the more the better, if more than `count`."""
    if not len(sets):
        return None
    lawson = lawson_fits(pairs, sets)
    order = np.argsort(lawson.largest, kind="stable")
    order = order[lawson.largest[order] <= 1.0]
    if not len(order):
        return None
    within = squared_ratios(pairs, lawson.poses[order]) <= 1.0
    best = int(within.sum(axis=1).argmax())
    found = Held(lawson.poses[int(order[best])], within[best])
    return found if found.count > count else None


@dataclass(frozen=True, slots=True, eq=False)
class LawsonFits:
    """Of each of B sets: the pose, the largest squared ratio of its rows there, and the weights.

    poses: B. largest: (B,), the least that was met. weights: (B, N), of the last step.
    """

    poses: Poses
    largest: Reals
    weights: Reals


def lawson_fits(pairs: PairedRows, sets: Sets) -> LawsonFits:
    """Lawson's iteration on sets (B, N), each until it fits, cannot fit, or steps are used up."""
    used = np.flatnonzero(sets.any(axis=0))
    some, inside = pairs.of(used), sets[:, used]
    columns = lawson_columns(some.source, some.target, some.bounds)
    if columns is None:
        poses, weights = _lawson_fits(some, inside)
    else:
        fits = columns.fits(inside)
        poses, weights = Poses(fits.rotations, fits.translations), fits.weights
    largest = np.where(inside, squared_ratios(some, poses), 0.0).max(axis=1)
    full = np.zeros(sets.shape)
    full[:, used] = weights
    return LawsonFits(poses, largest, full)


def _lawson_fits(pairs: PairedRows, inside: Sets) -> tuple[Poses, Reals]:
    """The poses of least largest ratio that were met, and the last weights: in NumPy."""
    weights = inside / inside.sum(axis=1, keepdims=True)
    largest = np.full(len(inside), np.inf)
    rotations, translations = np.zeros((len(inside), 3, 3)), np.zeros((len(inside), 3))
    open_sets = np.arange(len(inside))
    for _ in range(LAWSON_STEPS):
        now = weights[open_sets]
        poses = fitted(pairs, now * pairs.precisions)
        ratios = squared_ratios(pairs, poses)
        tops = np.where(inside[open_sets], ratios, 0.0).max(axis=1)
        better = tops < largest[open_sets]
        place = open_sets[better]
        largest[place] = tops[better]
        rotations[place], translations[place] = poses.rotations[better], poses.translations[better]
        lower = (now * ratios).sum(axis=1)
        now *= np.sqrt(ratios)
        totals = now.sum(axis=1)
        go_on = (tops > 1.0) & (lower <= 1.0) & (totals > 0.0)
        open_sets = open_sets[go_on]
        if not len(open_sets):
            break
        weights[open_sets] = now[go_on] / totals[go_on, np.newaxis]
    return Poses(rotations, translations), weights
