"""Four paths to the eigenvectors of symmetric 4x4 matrices, in doubles, from diagonal ones.

The square form of the equilibrium quadratics, K q = l q and a . q = 1 (see `torques`), is
tracked from D q = l q with a diagonal D, whose four solutions are the axes. Of four equations of
degree one both in q and in l, and one of degree one in q, the bilinear Bezout number is four: four
paths. D has its entries in the order of K's diagonal, which keeps the paths short. Each path has a
chart a of its own, its axis mixed with complex random numbers, so that none of its points is at
infinity, with probability one.

This is floating point: it proposes.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass, fields
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from certreg.equilibrium.tracking import REGULAR, SINGULAR, TrackerSettings, track

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.equilibrium.tracking import (
        Complexes,
        Indices,
        Reals,
        TrackedPaths,
    )

SEED = 20260  # any: with another the paths differ, and the ends do not
ATTEMPTS = 4  # gammas; one is enough for 999 problems of 1000
LEAST_TURN = 0.3  # radians, of gamma: away from 0, where real paths would meet
MOST_TURN = 1.5  # and short of pi, where start and target would cancel out
CHART_MIXING = 0.3  # of random numbers to the axis in a path's chart
SAME_ROOT = 1e-3  # radians between quaternions: regular ends are right to 1e-5
SAME_VALUE = 1e-9  # of the size of K: singular ends are right to the root of an ulp
PATHS = 4
AXES = np.arange(PATHS)
SPREAD = np.array([3.0, 1.0, -1.0, -3.0]) / np.sqrt(20.0)  # D's entries, of norm 1 as K is made


class HomotopyStatus(enum.Enum):
    """What the ends of the four paths amount to; the value is the sentence for the user."""

    FOUND = "All four paths ended at isolated roots, no two at the same."
    CONTINUUM = (
        "The solutions form a continuum, or come so near to it that double precision cannot tell: "
        "the exact roads decide."
    )
    INCOMPLETE = "Some paths were lost or met, with every gamma that was tried: roots are missing."


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FourEnds:
    """The ends of the four paths of some instances, by descending value.

    quaternions: (instances, 4, 4), real unit rows. values: (instances, 4), critical values l in
    units of K's Frobenius norm. codes, coranks, conditions: (instances, 4), as in `TrackedPaths`.
    """

    quaternions: Reals
    values: Reals
    codes: NDArray[np.int8]
    coranks: NDArray[np.int8]
    conditions: Reals


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Continuation(FourEnds):
    """These, and what they amount to.

    patterns: for each instance how many ends share a value, largest value first; empty where
        ends are missing.
    attempts: (instances,), gammas that were used.
    """

    patterns: tuple[tuple[int, ...], ...]
    attempts: NDArray[np.int64]

    @property
    def outcomes(self) -> tuple[HomotopyStatus, ...]:
        """What each instance came to."""
        outcomes = {0: HomotopyStatus.INCOMPLETE, PATHS: HomotopyStatus.FOUND}
        return tuple(outcomes.get(len(p), HomotopyStatus.CONTINUUM) for p in self.patterns)


class MultiplierForm:
    """K q = l q and a . q = 1 in (q, l), for many paths at once."""

    def __init__(self, matrices: Complexes | Reals, charts: Complexes) -> None:
        """matrices: (paths, 4, 4). charts: (paths, 4), the a of each path."""
        self._jacobian = np.zeros((len(matrices), 5, 5), dtype=np.complex128)
        self._jacobian[:, :4, :4] = matrices
        self._jacobian[:, 4, :4] = charts

    def evaluate(self, which: Indices, x: Complexes) -> tuple[Complexes, Complexes]:
        """Values (m, 5) and Jacobians (m, 5, 5)."""
        jacobian, q = self._jacobian[which], x[:, :4]
        jacobian[:, AXES, AXES] -= x[:, 4:]
        values = (jacobian[:, :, :4] @ q[..., None])[..., 0]
        values[:, 4] -= 1.0
        jacobian[:, :4, 4] = -q
        return values, jacobian


def continuation(davenports: Reals, *, tracker: TrackerSettings | None = None) -> Continuation:
    """The ends of four paths for each of several symmetric matrices K (instances, 4, 4).

    Where paths are lost or end at the same root, all four are tried again, with another gamma and
    more care.
    """
    tracker = tracker or TrackerSettings()
    rng = np.random.default_rng(SEED)
    sizes = np.linalg.norm(davenports, axis=(1, 2), keepdims=True)
    scaled = davenports / np.where(sizes == 0.0, 1.0, sizes)
    instances = len(scaled)
    found, names = _followed(scaled, rng, tracker), [field.name for field in fields(FourEnds)]
    attempts = np.ones(instances, dtype=np.int64)
    patterns = _patterns(found)
    for attempt in range(2, ATTEMPTS + 1):
        again = np.array([k for k, pattern in enumerate(patterns) if pattern is None], dtype=int)
        if not len(again):
            break
        tracker = tracker.careful()
        retried = _followed(scaled[again], rng, tracker)
        for name in names:
            getattr(found, name)[again] = getattr(retried, name)
        attempts[again] = attempt
        for k, pattern in zip(again.tolist(), _patterns(retried), strict=True):
            patterns[k] = pattern
    return Continuation(
        **{name: getattr(found, name) for name in names},
        patterns=tuple(pattern or () for pattern in patterns),
        attempts=attempts,
    )


def _followed(
    scaled: Reals,
    rng: np.random.Generator,
    tracker: TrackerSettings,
) -> FourEnds:
    """The paths of some instances, tracked with charts and a gamma drawn anew."""
    instances = len(scaled)
    noise = rng.normal(size=(2, PATHS, 4))
    charts = np.eye(4) + CHART_MIXING * (noise[0] + 1j * noise[1])
    gamma = np.exp(1j * rng.uniform(LEAST_TURN, MOST_TURN))
    order = np.argsort(np.argsort(-np.diagonal(scaled, axis1=1, axis2=2), axis=1), axis=1)
    entries = SPREAD[order]
    diagonals = np.zeros((instances, 4, 4))
    diagonals[:, AXES, AXES] = entries
    roots = np.zeros((instances, PATHS, 5), dtype=np.complex128)
    roots[:, AXES, AXES] = 1.0 / charts[AXES, AXES]
    roots[:, :, 4] = entries
    every = np.tile(charts, (instances, 1))
    start = MultiplierForm(np.repeat(diagonals, PATHS, axis=0), every)
    target = MultiplierForm(np.repeat(scaled, PATHS, axis=0), every)
    return _by_value(track(start, target, roots.reshape(-1, 5), gamma, tracker))


def _by_value(tracked: TrackedPaths) -> FourEnds:
    """The ends of four paths each, sorted by descending value; quaternions made real units."""
    points = tracked.points.reshape(-1, PATHS, 5)
    q, values = points[..., :4], points[..., 4].real
    largest = np.take_along_axis(q, np.abs(q).argmax(axis=-1)[..., None], axis=-1)
    real = (q / largest).real
    real /= np.linalg.norm(real, axis=-1, keepdims=True)
    order = np.argsort(-values, axis=1)
    shape = order.shape
    return FourEnds(
        quaternions=np.take_along_axis(real, order[..., None], axis=1),
        values=np.take_along_axis(values, order, axis=1),
        codes=np.take_along_axis(tracked.codes.reshape(shape), order, axis=1),
        coranks=np.take_along_axis(tracked.coranks.reshape(shape), order, axis=1),
        conditions=np.take_along_axis(tracked.conditions.reshape(shape), order, axis=1),
    )


def _patterns(ends: FourEnds) -> list[tuple[int, ...] | None]:
    """How many ends share a value, for each instance; None where ends are missing."""
    cosines = np.abs(ends.quaternions @ ends.quaternions.transpose(0, 2, 1))
    cosines[:, AXES, AXES] = 0.0
    apart = (cosines < np.cos(SAME_ROOT)).all(axis=(1, 2))
    regular = (ends.codes == REGULAR).all(axis=1)
    usual: tuple[int, ...] = (1,) * PATHS
    return [
        usual if good else _shared(ends, k) for k, good in enumerate((regular & apart).tolist())
    ]


def _shared(ends: FourEnds, k: int) -> tuple[int, ...] | None:
    """The pattern of one instance with singular ends, if they are what a continuum makes.

    m ends at one value belong to a space of m dimensions; the Jacobian there has corank m - 1.
    """
    if not np.isin(ends.codes[k], (REGULAR, SINGULAR)).all():
        return None
    values, coranks, singular = ends.values[k], ends.coranks[k], ends.codes[k] == SINGULAR
    starts = [0, *(1 + np.flatnonzero(-np.diff(values) > SAME_VALUE)).tolist(), PATHS]
    groups = [range(a, b) for a, b in pairwise(starts)]
    good = all(coranks[i] == len(group) - 1 for group in groups for i in group)
    good = good and bool(((coranks > 0) == singular).all()) and len(groups) < PATHS
    return tuple(len(group) for group in groups) if good else None
