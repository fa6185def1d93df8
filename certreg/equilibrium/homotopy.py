"""All equilibria by continuation in floating point: four paths from a diagonal start system.

The square form of the equilibrium quadratics, K q = l q and a . q = 1 (see `quadratics`), is
tracked from D q = l q with a diagonal D, whose four solutions are the axes. Of four equations of
degree one both in q and in l, and one of degree one in q, the bilinear Bezout number is four: four
paths. D has its entries in the order of K's diagonal, which keeps the paths short. Each path has a
chart a of its own, its axis mixed with complex random numbers, so that none of its points is at
infinity, with probability one.

What comes out is a proposal: `krawczyk` proves roots, and a count makes the list complete.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.equilibrium.tracking import REGULAR, SINGULAR, statuses_of, track
from certreg.settings import HomotopySettings, TrackerSettings

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.equilibrium.tracking import (
        Complexes,
        Indices,
        PathStatus,
        Reals,
        TrackedPaths,
    )

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
class Continuation:
    """The ends of the paths of many instances; each has four.

    quaternions: (instances, 4, 4), real unit rows, sorted by descending value.
    values: (instances, 4), critical values l in units of K's Frobenius norm.
    codes, conditions: (instances, 4), of the paths, as in `TrackedPaths`.
    patterns: for each instance how many ends share a value, largest value first; empty where
        ends are missing.
    outcomes: what each instance came to. attempts: (instances,), gammas that were used.
    """

    quaternions: Reals
    values: Reals
    codes: NDArray[np.int8]
    conditions: Reals
    patterns: tuple[tuple[int, ...], ...]
    outcomes: tuple[HomotopyStatus, ...]
    attempts: NDArray[np.int64]

    def paths(self, instance: int) -> tuple[PathStatus, ...]:
        """What became of each path of an instance."""
        return statuses_of(self.codes[instance])


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


def continuation(
    davenports: Reals,
    *,
    settings: HomotopySettings | None = None,
    tracker: TrackerSettings | None = None,
) -> Continuation:
    """The ends of four paths for each of several symmetric matrices K (instances, 4, 4).

    Where paths are lost or end at the same root, all four are tried again, with another gamma and
    more care.
    """
    settings, tracker = settings or HomotopySettings(), tracker or TrackerSettings()
    rng = np.random.default_rng(settings.seed)
    sizes = np.linalg.norm(davenports, axis=(1, 2), keepdims=True)
    scaled = davenports / np.where(sizes == 0.0, 1.0, sizes)
    instances = len(scaled)
    found = _followed(scaled, rng, settings, tracker)
    attempts = np.ones(instances, dtype=np.int64)
    patterns = _patterns(found, settings)
    for attempt in range(2, settings.attempts + 1):
        again = np.array([k for k, pattern in enumerate(patterns) if pattern is None], dtype=int)
        if not len(again):
            break
        tracker = tracker.careful()
        retried = _followed(scaled[again], rng, settings, tracker)
        for whole, part in zip(found.arrays, retried.arrays, strict=True):
            whole[again] = part
        attempts[again] = attempt
        for k, pattern in zip(again.tolist(), _patterns(retried, settings), strict=True):
            patterns[k] = pattern
    return Continuation(
        quaternions=found.quaternions,
        values=found.values,
        codes=found.codes,
        conditions=found.conditions,
        patterns=tuple(pattern or () for pattern in patterns),
        outcomes=tuple(map(_outcome, patterns)),
        attempts=attempts,
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Ends:
    """The ends of four paths of some instances, by descending value."""

    quaternions: Reals
    values: Reals
    codes: NDArray[np.int8]
    coranks: NDArray[np.int8]
    conditions: Reals

    @property
    def arrays(self) -> tuple[NDArray[Any], ...]:
        return (self.quaternions, self.values, self.codes, self.coranks, self.conditions)


def _followed(
    scaled: Reals,
    rng: np.random.Generator,
    settings: HomotopySettings,
    tracker: TrackerSettings,
) -> _Ends:
    """The paths of some instances, tracked with charts and a gamma drawn anew."""
    instances = len(scaled)
    noise = rng.normal(size=(2, PATHS, 4))
    charts = np.eye(4) + settings.chart_mixing * (noise[0] + 1j * noise[1])
    gamma = np.exp(1j * rng.uniform(settings.least_turn, settings.most_turn))
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


def _by_value(tracked: TrackedPaths) -> _Ends:
    """The ends of four paths each, sorted by descending value; quaternions made real units."""
    points = tracked.points.reshape(-1, PATHS, 5)
    q, values = points[..., :4], points[..., 4].real
    largest = np.take_along_axis(q, np.abs(q).argmax(axis=-1)[..., None], axis=-1)
    real = (q / largest).real
    real /= np.linalg.norm(real, axis=-1, keepdims=True)
    order = np.argsort(-values, axis=1)
    shape = order.shape
    return _Ends(
        quaternions=np.take_along_axis(real, order[..., None], axis=1),
        values=np.take_along_axis(values, order, axis=1),
        codes=np.take_along_axis(tracked.codes.reshape(shape), order, axis=1),
        coranks=np.take_along_axis(tracked.coranks.reshape(shape), order, axis=1),
        conditions=np.take_along_axis(tracked.conditions.reshape(shape), order, axis=1),
    )


def _patterns(ends: _Ends, settings: HomotopySettings) -> list[tuple[int, ...] | None]:
    """How many ends share a value, for each instance; None where ends are missing."""
    cosines = np.abs(ends.quaternions @ ends.quaternions.transpose(0, 2, 1))
    cosines[:, AXES, AXES] = 0.0
    apart = (cosines < np.cos(settings.same_root)).all(axis=(1, 2))
    regular = (ends.codes == REGULAR).all(axis=1)
    usual: tuple[int, ...] = (1,) * PATHS
    return [
        usual if good else _shared(ends, k, settings)
        for k, good in enumerate((regular & apart).tolist())
    ]


def _shared(ends: _Ends, k: int, settings: HomotopySettings) -> tuple[int, ...] | None:
    """The pattern of one instance with singular ends, if they are what a continuum makes.

    m ends at one value belong to a space of m dimensions; the Jacobian there has corank m - 1.
    """
    if not np.isin(ends.codes[k], (REGULAR, SINGULAR)).all():
        return None
    values, coranks, singular = ends.values[k], ends.coranks[k], ends.codes[k] == SINGULAR
    starts = [0, *(1 + np.flatnonzero(-np.diff(values) > settings.same_value)).tolist(), PATHS]
    groups = [range(a, b) for a, b in pairwise(starts)]
    good = all(coranks[i] == len(group) - 1 for group in groups for i in group)
    good = good and bool(((coranks > 0) == singular).all()) and len(groups) < PATHS
    return tuple(len(group) for group in groups) if good else None


def _outcome(pattern: tuple[int, ...] | None) -> HomotopyStatus:
    if pattern is None:
        return HomotopyStatus.INCOMPLETE
    return HomotopyStatus.FOUND if len(pattern) == PATHS else HomotopyStatus.CONTINUUM
