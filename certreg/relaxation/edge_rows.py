"""A pose near another one with more rows within their bounds: those on the edge of their bounds.

The pose of least squares is not the one with the most rows. Whether some rows fit together is a
question of the least largest ratio of distance to bound: Lawson's iteration finds it by fits whose
weights grow with the ratios, and the weighted mean of the squared ratios is a lower bound of the
largest: above 1 the rows do not fit. Source: [Lawson1961].
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from certreg.native.lawson import LawsonColumns
from certreg.relaxation.paired_rows import Poses, fitted, squared_ratios

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.relaxation.paired_rows import PairedRows, Reals

    Sets = NDArray[np.bool_]

MOST_REFITS = 20  # three are usual
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
    fits = LawsonColumns(some.source, some.target, some.bounds).fits(inside)
    poses = Poses(fits.rotations, fits.translations)
    largest = np.where(inside, squared_ratios(some, poses), 0.0).max(axis=1)
    full = np.zeros(sets.shape)
    full[:, used] = fits.weights
    return LawsonFits(poses, largest, full)
