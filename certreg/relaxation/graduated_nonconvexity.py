"""The pose of least truncated squares, by graduated non-convexity, and its inliers.

min over poses of sum min(r^2, 1), r = |R x + t - y| / bound. A family of functions leads there from
the convex sum of squares: at each step a weighted fit, then weights in closed form, then a
function nearer to the truncated one. It finds a local minimum, mostly the least one where fewer
than four of five pairs are wrong. Source: [Yang2020GNC].
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from certreg.relaxation.paired_rows import fitted, squared_ratios

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.relaxation.paired_rows import PairedRows, Poses, Reals

Motion = TypeVar("Motion")
GROWTH = 1.4  # of the control parameter in each step, as [Yang2020GNC] has it
MOST_STEPS = 2000  # 40 are usual; the largest residuals, of 1e120 bounds, take 1650


@dataclass(frozen=True, eq=False)
class Candidate:
    """A pose and the rows within their bounds there, by floating point: a proposal.

    rotation: (3, 3), proper. translation: (3,), in the unit of the target; y = s R x + t.
    inliers: the rows within their bounds, ascending. scale: s > 0.
    """

    rotation: NDArray[np.float64]
    translation: NDArray[np.float64]
    inliers: NDArray[np.int64]
    scale: float = 1.0


def candidate_of(pairs: PairedRows, pose: Poses, ratios: Reals) -> Candidate:
    """A pose in the unit of the clouds, with the rows whose squared ratios are at most 1."""
    R, t = pose.rotations, pose.translations * pairs.unit
    translation = t + pairs.target_centre - R @ pairs.source_centre
    return Candidate(R, translation, pairs.rows[ratios <= 1.0])


def truncated_fit(pairs: PairedRows) -> Poses:
    """One pose: of least squares of the rows that have not been given up in the end."""
    precisions = pairs.precisions
    return graduated(
        lambda shares: fitted(pairs, shares * precisions),
        lambda pose: squared_ratios(pairs, pose),
        len(pairs),
    )


def graduated(fit: Callable[[Reals], Motion], ratios: Callable[[Motion], Reals], n: int) -> Motion:
    """The motion that graduated non-convexity finds for n rows.

    fit: the motion of least squares, of shares (n,) of the weights. ratios: (|r| / bound)^2 of each
    row there, (n,). Shares fall from 1 to 0 between r^2 = m / (m + 1) and (m + 1) / m, and m grows.
    """
    found = fit(np.ones(n))
    squares = ratios(found)
    largest = float(squares.max())
    if largest <= 1.0:
        return found
    m = 1.0 / (2.0 * largest - 1.0)
    for _ in range(MOST_STEPS):
        shares = np.sqrt(m * (m + 1.0) / np.maximum(squares, m / (m + 1.0))) - m
        np.clip(shares, 0.0, 1.0, out=shares)
        if not shares.any():  # no row is near: the motion of before is all there is
            return found
        found = fit(shares)
        if not ((shares > 0.0) & (shares < 1.0)).any():
            return found
        squares = ratios(found)
        m *= GROWTH
    return found
