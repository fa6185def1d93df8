"""Rows that fit far worse than the others, and pairings that fit better: what sums cannot tell.

The points are read once, beside a sample of them. Poses and rows are proposed by plain floating
point, from the sample; what is concluded from them (`certreg.registration.fit`) holds for every
pose and every set of rows, however they were found.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from certreg.equilibrium.equilibrium_set import rotation_double
from certreg.exact.dyadic import nearest_or_zero, power_of_two
from certreg.problem.arrays import row_blocks
from certreg.registration.covariance import (
    Residual,
    effective_rows,
    largest,
    residual_distances,
)
from certreg.registration.motions import RigidMotion, WeightedPairs

if TYPE_CHECKING:
    from fractions import Fraction

    from numpy.typing import NDArray

    from certreg.geometry.pose import Pose
    from certreg.geometry.similarity import Similarity
    from certreg.objective.isotropic import Isotropic
    from certreg.problem.motion import Motion
    from certreg.problem.problem import RegistrationProblem
    from certreg.problem.terms import Pairs

SAMPLE_ROWS = 4096  # medians to two per cent; all rows where there are no more
LISTED = 10  # rows named one by one
FAR = 6.0  # medians: 1e-17 of Gaussian residuals; those of packaged and LiDAR pairs stay below 3.2
ROUNDING = 1e-12  # of the clouds' size: smaller residuals are not told from zero
PAIRINGS = 3  # that are compared: one row on, one row back, the other way round
FACTORS = 1000  # exponents of powers of two that are doubles: products round as `ldexp` does
NEAR = 2  # times as many rows of a sample far from another pose: of all rows it may be as many
STEPS = 10  # of each search: both settle within a few


@dataclass(frozen=True, slots=True, kw_only=True)
class OtherPairing:
    """A pairing that fits better than the given one: its name, and by how much.

    rows: compared; left: its objective over that of the given one, of the same targets or of the
        same sources, whichever is less, each at its own best pose: a slip leaves out a row, which
        may be the one that is wrong; first: how many rows were read, where there are more.
    """

    words: str
    rows: int
    left: float
    first: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RowFit:
    """What the rows with weight say of a fit.

    rows: how many have weight. effective_rows: (sum w)^2 / sum w^2; independent_rows: those that
        carry the objective, `rows` where their noise was given, else `effective_rows`.
    motion: that was fitted. worst: the largest residuals at the optimum, largest first.
    largest_over_median: of the residuals at the optimum; None where the median is zero.
    far: rows more than FAR medians away from a pose that most rows agree on, the worst first, at
        most LISTED; far_rows: how many there are. tied: whether as many rows agree on another pose,
        within as many medians: counts do not tell which are wrong.
    left: the objective of the other rows at that pose, over the least objective of all rows.
    second_moments: (3,) of source and of target, along the principal axes in rising order, without
        weights and over the trace of the source's.
    """

    rows: int
    effective_rows: float
    independent_rows: float
    motion: Motion
    worst: tuple[Residual, ...]
    largest_over_median: float | None
    far: tuple[int, ...]
    far_rows: int
    tied: bool
    left: float
    other_pairing: OtherPairing | None
    second_moments: tuple[NDArray[np.float64], NDArray[np.float64]]

    def degrees(self, more: int = 0) -> float:
        """Of freedom, with so many more parameters, or observations left out."""
        return self.motion.degrees(3 * self.independent_rows) - more


def row_fit(
    problem: RegistrationProblem, objective: Isotropic, pose: Pose | Similarity
) -> RowFit | None:
    """What the rows say of a fit; None where numbers leave the range of doubles."""
    try:
        with np.errstate(all="ignore"):
            return _row_fit(problem, objective, pose)
    except np.linalg.LinAlgError:  # weights or lengths so far apart that shares are not finite
        return None


def independent_rows(problem: RegistrationProblem) -> float:
    """How many rows carry the objective: those with weight where the noise of each was given.

    Else weights may be relative, and the noise of all rows alike: the effective number.
    """
    if problem.noise_given:
        return problem.observations / 3
    return effective_rows(problem)


def _row_fit(
    problem: RegistrationProblem, objective: Isotropic, pose: Pose | Similarity
) -> RowFit | None:
    frame = _Frame.of(objective)
    picked = _picked(problem)
    sample = frame.pairs(picked)
    if not (sample.finite and np.isfinite(residual_distances(picked, pose)).all()):
        return None
    counts = [_Count(limits) for limits in _agreed(sample)]
    for rows in row_blocks(problem.n):
        points = problem.block(rows)
        for one in counts:
            one.add(rows.start, points, frame)
    count = min(counts, key=lambda one: one.far_rows)
    least = frame.energy(objective.energy(objective.optimum))
    median = _median(sample.distances(frame.optimum))
    return RowFit(
        rows=count.rows,
        effective_rows=effective_rows(problem),
        independent_rows=independent_rows(problem),
        motion=problem.motion,
        worst=_residuals(problem, pose, count.worst),
        largest_over_median=count.worst[0].distance / median if median > 0.0 else None,
        far=tuple(one.row for one in count.far),
        far_rows=count.far_rows,
        tied=[one.far_rows for one in counts].count(count.far_rows) > 1,
        left=count.left / least if least > 0.0 else 1.0,
        other_pairing=_other_pairing(frame, problem),
        second_moments=sample.second_moments(),
    )


def _residuals(
    problem: RegistrationProblem, pose: Pose | Similarity, rows: list[Residual]
) -> tuple[Residual, ...]:
    """The residuals of these rows at the pose as it is reported, in the unit of length."""
    numbers = np.array([one.row for one in rows])
    distances = residual_distances(problem.pairs.rows(numbers), pose).tolist()
    found = [Residual(row=r, distance=d) for r, d in zip(numbers.tolist(), distances, strict=True)]
    return tuple(sorted(found, key=lambda one: (-one.distance, one.row)))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Frame:
    """Lengths over 2^length about the means, weights over 2^weight: no square overflows."""

    length: int
    weight: int
    source_mean: NDArray[np.float64]
    target_mean: NDArray[np.float64]
    optimum: RigidMotion

    @classmethod
    def of(cls, objective: Isotropic) -> _Frame:
        moments = objective.moments
        length = _exponent(moments.spread / moments.total_weight) // 2
        unit = power_of_two(-length)
        here, there = (
            np.array([nearest_or_zero(entry * unit) for entry in mean])
            for mean in (moments.source_centroid, moments.target_centroid)
        )
        weight = _exponent(moments.total_weight / moments.n)
        rotation = rotation_double(objective.optimum)
        return cls(
            length=length,
            weight=weight,
            source_mean=here,
            target_mean=there,
            optimum=RigidMotion(rotation=rotation, translation=np.zeros(3)),
        )

    def pairs(self, points: Pairs) -> WeightedPairs:
        """Points of the problem in this frame."""
        return WeightedPairs(
            source=self._moved(points.source, self.source_mean),
            target=self._moved(points.target, self.target_mean),
            weights=np.ldexp(points.weights, -self.weight),
        )

    def _moved(self, cloud: NDArray[np.float64], mean: NDArray[np.float64]) -> NDArray[np.float64]:
        if abs(self.length) < FACTORS:
            moved = np.multiply(cloud.T, 2.0**-self.length, order="C")
        else:
            moved = np.ldexp(cloud.T, -self.length, order="C")
        moved -= mean[:, np.newaxis]
        return moved

    def energy(self, energy: Fraction) -> float:
        """An energy in this frame."""
        return nearest_or_zero(energy * power_of_two(-2 * self.length - self.weight))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Limits:
    """A pose that most rows agree on, and how far from it a row is far: in length, and weighted."""

    motion: RigidMotion
    distance: float
    weighted: float

    def far(self, pairs: WeightedPairs, distances: NDArray[np.float64]) -> NDArray[np.bool_]:
        """(k,), which rows are far: both in length and in standard deviations.

        In one of them alone a few rows of great weight, or of little, would be.
        """
        weighted = np.sqrt(pairs.weights) * distances
        return (distances > self.distance) & (weighted > self.weighted)


def _limits(sample: WeightedPairs) -> _Limits:
    """By least absolute deviations, least squares of the better half, then of all near rows."""
    motion = sample.best_motion(sample.weights)
    roots = np.sqrt(sample.weights)
    for _ in range(STEPS):
        weighted = roots * sample.distances(motion)
        motion = sample.best_motion(sample.weights / np.maximum(weighted, ROUNDING))
    half, before = len(roots) // 2 + 1, None
    for _ in range(STEPS):
        weighted = roots * sample.distances(motion)
        inner = weighted <= np.partition(weighted, half - 1)[half - 1]
        if before is not None and (inner == before).all():
            break
        motion, before = sample.best_motion(np.where(inner, sample.weights, 0.0)), inner
    limits = _limits_at(sample, motion)
    for _ in range(2):
        far = limits.far(sample, sample.distances(motion))
        motion = sample.best_motion(np.where(far, 0.0, sample.weights))
        limits = _limits_at(sample, motion)
    return limits


def _agreed(sample: WeightedPairs) -> tuple[_Limits, ...]:
    """A pose that most rows agree on; and another, if all rows might agree on it as well."""
    limits = _limits(sample)
    count = _count(sample, limits)
    for _ in range(STEPS):
        best = min(_rivals(sample, limits), key=lambda rival: _count(sample, rival), default=None)
        if best is None:
            break
        fewer = _count(sample, best)
        if fewer >= count:
            return (limits, best) if fewer <= NEAR * count else (limits,)
        limits, count = best, fewer
    return (limits,)


def _rivals(sample: WeightedPairs, limits: _Limits) -> Iterator[_Limits]:
    """Other poses, found from the far rows: all of them, and each beside two that are not."""
    known = limits.far(sample, sample.distances(limits.motion))
    rows, others = np.flatnonzero(known), np.flatnonzero(~known)
    if len(rows) == 0:
        return
    rows_of = enumerate(np.resize(rows, LISTED).tolist())
    for begun in (rows, *(np.append(others[2 * k : 2 * k + 2], row) for k, row in rows_of)):
        far, motion = np.ones(len(known), dtype=bool), limits.motion
        far[begun] = False
        for _ in range(STEPS):
            motion = sample.best_motion(np.where(far, 0.0, sample.weights))
            before, far = far, limits.far(sample, sample.distances(motion))
            if (far == before).all() or far.all():
                break
        if (far != known).any():
            yield replace(limits, motion=motion)


def _count(sample: WeightedPairs, limits: _Limits) -> int:
    """How many rows are far."""
    return int(np.count_nonzero(limits.far(sample, sample.distances(limits.motion))))


def _limits_at(sample: WeightedPairs, motion: RigidMotion) -> _Limits:
    distances = sample.distances(motion)
    roots = np.sqrt(sample.weights)
    least = FAR * ROUNDING
    return _Limits(
        motion=motion,
        distance=max(least, FAR * _median(distances)),
        weighted=max(least * _median(roots), FAR * _median(roots * distances)),
    )


def _median(values: NDArray[np.float64]) -> float:
    """As `np.median`, of numbers that are none of them missing, without its ten calls."""
    half = len(values) // 2
    if len(values) % 2:
        return float(np.partition(values, half)[half])
    lower, upper = np.partition(values, (half - 1, half))[half - 1 : half + 1].tolist()
    return (lower + upper) / 2.0


@dataclass(slots=True)
class _Count:
    """Sums over all rows with weight, block by block; far from a pose that most agree on."""

    limits: _Limits
    rows: int = 0
    left: float = 0.0
    far_rows: int = 0
    far: list[Residual] = field(default_factory=list[Residual])
    worst: list[Residual] = field(default_factory=list[Residual])

    def add(self, first: int, points: Pairs, frame: _Frame) -> None:
        """Count a block, whose first row has this number."""
        present = np.flatnonzero(points.weights)
        if len(present) < len(points.weights):
            points = points.rows(present)
        if len(present) == 0:
            return
        pairs = frame.pairs(points)
        self.rows += len(present)
        numbers = first + present
        self.worst = largest(self.worst, numbers, pairs.distances(frame.optimum), LISTED)
        distances = pairs.distances(self.limits.motion)
        far = self.limits.far(pairs, distances)
        self.far_rows += int(np.count_nonzero(far))
        self.far = largest(self.far, numbers[far], distances[far], LISTED)
        self.left += float(pairs.weights[~far] @ distances[~far] ** 2)


def _picked(problem: RegistrationProblem) -> Pairs:
    """The rows with weight: all, or of many rows a sample at random, always the same."""
    if problem.n <= SAMPLE_ROWS:
        points = problem.block(slice(0, problem.n))
    else:
        rng = np.random.default_rng(0)
        rows = rng.choice(problem.n, SAMPLE_ROWS, replace=False, shuffle=False)
        points = problem.pairs.rows(np.sort(rows))
    return points if points.weights.all() else points.rows(np.flatnonzero(points.weights))


def _other_pairing(frame: _Frame, problem: RegistrationProblem) -> OtherPairing | None:
    """The best of three pairings that a slip makes: one row on, one row back, the other way round.

    Among the first rows. Weights go with the target, whose noise they state.
    """
    n = min(problem.n, SAMPLE_ROWS)
    points = frame.pairs(problem.block(slice(0, n)))
    but_first, but_last, back = slice(1, None), slice(0, -1), slice(None, None, -1)
    kept = min(points.paired(rows, rows).least_energy() for rows in (but_first, but_last))
    slips = [
        ("one row later", but_last, but_first, kept),
        ("one row earlier", but_first, but_last, kept),
    ]
    if n == problem.n:
        slips.append(("in reversed order", back, slice(None), points.least_energy()))
    found: list[OtherPairing] = []
    for words, here, there, given in slips:
        if given > 0.0:
            other = points.paired(here, there)
            rows = int(np.count_nonzero(other.weights))
            left = other.least_energy() / given
            first = n if n < problem.n else None
            found.append(OtherPairing(words=words, rows=rows, first=first, left=left))
    return min(found, key=lambda one: one.left, default=None)


def _exponent(value: Fraction) -> int:
    """The exponent of a power of two near a value >= 0."""
    if value == 0:
        return 0
    return value.numerator.bit_length() - value.denominator.bit_length()
