"""Pairs of points with a bound each, and the motions with a scale that fit some of them.

Each cloud is shifted to its median and scaled by a power of two of its own. Of the scale there are
two fits: that of least squares, and sqrt(Y/X) of the spreads X and Y, which wrong pairs do not
shrink [Horn1987].
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.relaxation.graduated_nonconvexity import graduated
from certreg.relaxation.paired_rows import FAR, PairedRows, Poses, fitted, paired_rows

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Reals = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Similar:
    """A motion y = s R x + t of rows about their medians, in their units.

    scale: s >= 0. rotation: (3, 3), proper. translation: (3,).
    """

    scale: float
    rotation: Reals
    translation: Reals


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SimilarRows:
    """Points (N, 3) about their medians, and bounds (N,), in the unit of the target.

    source_centre, target_centre: (3,), in the units of the clouds. source_unit, target_unit: theirs
    in those.
    """

    source: Reals
    target: Reals
    bounds: Reals
    source_centre: Reals
    target_centre: Reals
    source_unit: float
    target_unit: float

    @classmethod
    def of(cls, source: Reals, target: Reals, bounds: Reals) -> SimilarRows:
        """Clouds in whatever units."""
        centres = [np.median(points, axis=0) for points in (source, target)]
        x, y = source - centres[0], target - centres[1]
        units = [_unit(points) for points in (x, y)]
        return cls(
            source=np.clip(x / units[0], -FAR, FAR),
            target=np.clip(y / units[1], -FAR, FAR),
            bounds=np.clip(bounds / units[1], 1.0 / FAR, FAR),
            source_centre=centres[0],
            target_centre=centres[1],
            source_unit=units[0],
            target_unit=units[1],
        )

    @property
    def precisions(self) -> Reals:
        """The weights (N,) that count distances in bounds."""
        return 1.0 / (self.bounds * self.bounds)

    def at(self, scale: float) -> PairedRows:
        """The rows with the source scaled, as rigid motions take them."""
        return paired_rows(scale * self.source, self.target, self.bounds)

    def outside(self, found: Similar) -> tuple[float, Reals]:
        """Scale and translation in the units of the clouds."""
        scale = found.scale * (self.target_unit / self.source_unit)
        moved = scale * (found.rotation @ self.source_centre)
        return scale, found.translation * self.target_unit + self.target_centre - moved

    def ratios(self, found: Similar) -> Reals:
        """(|s R x + t - y| / bound)^2 of each row, (N,): at most 1 within the bound."""
        off = found.scale * (self.source @ found.rotation.T) + found.translation - self.target
        return (off * off).sum(axis=1) * self.precisions

    def within(self, found: Similar) -> NDArray[np.bool_]:
        """(N,), which rows are."""
        return self.ratios(found) <= 1.0

    def fitted(self, weights: Reals, *, symmetric: bool = False) -> Similar:
        """The motion of least squares of weights (N,), not all 0; symmetric: with sqrt(Y/X)."""
        share = weights / weights.sum()
        means = [share @ points for points in (self.source, self.target)]
        x, y = self.source - means[0], self.target - means[1]
        here, there = (float(share @ (p * p).sum(axis=1)) for p in (x, y))
        pairs = self.at(1.0)
        pose = fitted(pairs, weights[pairs.rows])
        level = float(share @ (y * (x @ pose.rotations.T)).sum(axis=1))
        scale = max(level, 0.0) / here if here > 0.0 else 1.0
        if symmetric and here > 0.0:
            scale = math.sqrt(there / here)
        shift = means[1] - scale * (pose.rotations @ means[0])
        return Similar(scale, pose.rotations, shift)

    def truncated_fit(self) -> Similar:
        """By graduated non-convexity, as of rigid motions."""
        precisions = self.precisions
        return graduated(
            lambda shares: self.fitted(shares * precisions, symmetric=True),
            self.ratios,
            len(precisions),
        )

    def ranges(self, share: float) -> tuple[Reals, Reals]:
        """(N, N): between which scales two rows agree, with such a share of their bounds."""
        lengths = lengths_between(self.source), lengths_between(self.target)
        return scale_ranges(*lengths, share * np.add.outer(self.bounds, self.bounds))

    def of_pose(self, scale: float, pairs: PairedRows, pose: Poses) -> Similar:
        """A pose of the scaled rows as a motion of these."""
        shift = pose.translations * pairs.unit + pairs.target_centre
        return Similar(scale, pose.rotations, shift - pose.rotations @ pairs.source_centre)


def scale_ranges(a: Reals, b: Reals, room: Reals) -> tuple[Reals, Reals]:
    """With which scales least and most lengths a become lengths b, but for so much room."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        return np.maximum(b - room, 0.0) / a, (b + room) / a


def lengths_between(points: Reals) -> Reals:
    """(N, N): distances of each point from each other."""
    square = np.zeros((len(points), len(points)))
    for axis in points.T:
        difference = np.subtract.outer(axis, axis)
        difference *= difference
        square += difference
    return np.sqrt(square, out=square)


def _unit(points: Reals) -> float:
    """A power of two near the usual distance from the centre, or the largest where that is 0."""
    sizes = np.abs(points).max(axis=1)
    size = float(np.median(sizes)) or float(sizes.max()) or 1.0
    return math.ldexp(1.0, math.frexp(size)[1])
