"""What the rows of general springs say of a pose: how far each pair is off, along its springs.

The spring of a pair is W = L L^T. With r = y - R x - t, and w the largest eigenvalue of W, a row is
off by sqrt(r^T W r / w): the distance to the plane or the line where W is one, |r| where W is w I;
where its springs differ, distances along the softer ones count less. RMSE is the root of
sum r^T W r / sum w, in the unit of length as well, and for springs alike in every way the RMSE of
weights w.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from certreg.problem.arrays import lengths, row_blocks
from certreg.problem.factors import lower_triangles
from certreg.registration.covariance import Residual, largest
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.geometry.pose import Pose
    from certreg.problem.problem import RegistrationProblem
    from certreg.problem.terms import Pairs

SAMPLED = 4096  # rows of which the median is taken, where there are more


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SpringRows(Brief):
    """Some rows at a pose.

    along: (k,), how far each pair is off along its springs; NaN where it has none.
    strained: (k,), sqrt(r^T W r), in standard deviations where W says the noise.
    stiffness: (k,), w.
    """

    along: NDArray[np.float64]
    strained: NDArray[np.float64]
    stiffness: NDArray[np.float64]


def rows_at(block: Pairs, pose: Pose) -> SpringRows:
    """The rows of a block at a pose; of numbers beyond the doubles not finite ones."""
    with np.errstate(all="ignore"):
        residuals = block.target - pose.apply(block.source)
        size = np.abs(block.springs).max(axis=1)
        lower = lower_triangles(block.springs / np.where(size > 0, size, 1.0)[:, np.newaxis])
        pulled = np.linalg.norm(np.einsum("kij,ki->kj", lower, residuals), axis=1)
        stiffest = _largest_singular(lower)
        return SpringRows(
            along=pulled / np.where(size > 0, stiffest, math.nan),
            strained=size * pulled,
            stiffness=(size * stiffest) ** 2,
        )


def _largest_singular(lower: NDArray[np.float64]) -> NDArray[np.float64]:
    """(k,): the largest singular value of each L; of a single column its length."""
    found = np.linalg.norm(lower[:, :, 0], axis=1)
    wide = lower[:, :, 1:].any(axis=(1, 2))
    if wide.any():
        found[wide] = np.linalg.norm(lower[wide], ord=2, axis=(1, 2))
    return found


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SpringAxes(Brief):
    """Along which axes springs pull.

    axes: (k, 3, 3), orthonormal columns, those that are held first. ranks: (k,), how many are.
    """

    axes: NDArray[np.float64]
    ranks: NDArray[np.int64]

    @classmethod
    def of(cls, factors: NDArray[np.float64]) -> SpringAxes:
        """The range of W: the singular vectors of L, (k, 6), that are not zero."""
        axes, sizes, _ = np.linalg.svd(lower_triangles(factors))
        return cls(axes=axes, ranks=(sizes > np.finfo(float).eps * sizes[:, :1]).sum(axis=1))

    def pulled_to(
        self, moved: NDArray[np.float64], target: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """(k, 3): the point of each plane or line nearest to the moved source; else the target."""
        held = np.arange(3) < self.ranks[:, np.newaxis]
        shares = np.einsum("kia,ki->ka", self.axes, target - moved) * held
        return moved + np.einsum("kia,ka->ki", self.axes, shares)


def blocks_at(problem: RegistrationProblem, pose: Pose) -> Iterator[tuple[slice, SpringRows]]:
    """All rows at a pose, block by block."""
    for rows in row_blocks(problem.n):
        yield rows, rows_at(problem.block(rows), pose)


def source_centre(problem: RegistrationProblem) -> tuple[Fraction, ...]:
    """The mean of the source as doubles have it; the origin where they do not."""
    blocks = (problem.block(rows) for rows in row_blocks(problem.n))
    with np.errstate(all="ignore"):
        sums = [block.source.mean(axis=0) * len(block.source) for block in blocks]
        mean = np.sum(sums, axis=0) / problem.n
    return tuple(map(Fraction, np.where(np.isfinite(mean), mean, 0.0).tolist()))


@dataclass(frozen=True, slots=True, kw_only=True)
class ResidualSums(Brief):
    """What one look at all rows says of a pose.

    stiffness: the sum of w. effective_rows: (sum w)^2 / sum w^2. rows: how many have a spring.
    worst: the rows that are farthest off, the farthest first. median: of how far rows are off.
    """

    stiffness: float
    effective_rows: float
    rows: int
    worst: tuple[Residual, ...]
    median: float

    @classmethod
    def of(cls, problem: RegistrationProblem, pose: Pose, count: int) -> ResidualSums:
        """Of the pose of a problem; count: of the worst rows."""
        total = norm = 0.0
        counted, worst = 0, list[Residual]()
        sample: list[NDArray[np.float64]] = []
        step = -(-problem.n // SAMPLED)
        for rows, at in blocks_at(problem, pose):
            told = np.flatnonzero(np.isfinite(at.along))
            total += float(at.stiffness.sum())
            norm = math.hypot(norm, *lengths(at.stiffness[np.newaxis]))
            counted += int(np.count_nonzero(at.stiffness))
            worst = largest(worst, rows.start + told, at.along[told], count)
            sample.append(at.along[::step][np.isfinite(at.along[::step])])
        seen = np.concatenate(sample)
        return cls(
            stiffness=total,
            effective_rows=(total / norm) ** 2 if norm else 0.0,
            rows=counted,
            worst=tuple(worst),
            median=float(np.median(seen)) if len(seen) else 0.0,
        )
