"""All equilibria by continuation in floating point: four paths from a diagonal start system.

The square form of the equilibrium quadratics, K q = l q and a . q = 1 (see `torques`), is
tracked from D q = l q with a diagonal D, whose four solutions are the axes. Of four equations of
degree one both in q and in l, and one of degree one in q, the bilinear Bezout number is four: four
paths. D has its entries in the order of K's diagonal, which keeps the paths short. Each path has a
chart a of its own, its axis mixed with complex random numbers, so that none of its points is at
infinity, with probability one.

What comes out is a proposal: Krawczyk's test proves roots, with K exact and a near the quaternion
itself, and four disjoint boxes with the count of at most four make the list complete.
"""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from flint import acb_mat, arb_mat, ctx

from certreg.equilibrium.counting import at_most_four
from certreg.equilibrium.critical_set import Completeness, CriticalSet, spaces_as_components
from certreg.equilibrium.krawczyk import (
    START_BITS,
    Balls,
    RootBox,
    are_distinct,
    kind_of,
    proved_root,
    tightened,
)
from certreg.equilibrium.tracking import REGULAR, SINGULAR, TrackerSettings, statuses_of, track
from certreg.errors import UndecidedError
from certreg.exact.balls import exact_matrix, fixed_point, morse_bott_index, orthonormal
from certreg.exact.spaces import Resolution, Space, resolved
from certreg.results import Guarantee

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from certreg.equilibrium.tracking import (
        Complexes,
        Indices,
        PathStatus,
        Reals,
        TrackedPaths,
    )
    from certreg.objective.isotropic import Isotropic

HOMOTOPY = "homotopy"
SEED = 20260  # any: with another the paths differ, and the ends do not
ATTEMPTS = 4  # gammas; one is enough for 999 problems of 1000
LEAST_TURN = 0.3  # radians, of gamma: away from 0, where real paths would meet
MOST_TURN = 1.5  # and short of pi, where start and target would cancel out
CHART_MIXING = 0.3  # of random numbers to the axis in a path's chart
SAME_ROOT = 1e-3  # radians between quaternions: regular ends are right to 1e-5
SAME_VALUE = 1e-9  # of the size of K: singular ends are right to the root of an ulp
DOUBLE_BITS = 53  # fractional bits of a double near 1
ENDS_BITS = 64  # of the ends in fixed point
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


class EigenBalls:
    """K q = l q and a . q = 1 in (q, l), for balls of either kind."""

    def __init__(self, K: arb_mat, chart: Sequence[float]) -> None:
        """K: 4x4. chart: the vector a."""
        base = arb_mat(5, 5)
        for i, a in enumerate(chart):
            base[4, i] = a
            for j in range(4):
                base[i, j] = K[i, j]
        self._base = base

    def start(self, q: Sequence[float]) -> arb_mat:
        """The point (q, l) along q with a . q = 1 and the best l for it, q^T K q / |q|^2."""
        with ctx.workprec(START_BITS):
            x = arb_mat(5, 1, [*q, 0])
            image, along = self._base * x, x.transpose() * x
            value = (x.transpose() * image)[0, 0] / along[0, 0]
            x = x / image[4, 0]
            x[4, 0] = value
            return x.mid()

    def values(self, x: Balls) -> Balls:
        """An enclosure of (K q - l q, a . q - 1)."""
        image, value = self._base_for(x) * x, x[4, 0]
        for i in range(4):
            image[i, 0] -= value * x[i, 0]
        image[4, 0] -= 1
        return image

    def jacobian(self, x: Balls) -> Balls:
        """An enclosure of [[K - l I, -q], [a, 0]]."""
        image, value = kind_of(x)(self._base_for(x)), x[4, 0]
        for i in range(4):
            image[i, i] -= value
            image[i, 4] = -x[i, 0]
        return image

    def _base_for(self, x: Balls) -> Balls:
        return self._base if kind_of(x) is arb_mat else acb_mat(self._base)


def by_continuation(objective: Isotropic) -> CriticalSet:
    """Four paths; their ends proved, and a count of at most four, make the list complete.

    Without these the ends in doubles, in doubt, where they look like a continuum; UndecidedError
    where they are no list at all.
    """
    unit = 1 << objective.shift
    scaled = np.array([[entry / unit for entry in row] for row in objective.davenport])
    ends = continuation(scaled[None])
    counted = at_most_four(objective.moments.cross)
    proved = None if counted is None else _proved(objective, ends.quaternions[0].tolist())
    if proved is not None:
        return proved
    outcome = ends.outcomes[0]
    if outcome is not HomotopyStatus.CONTINUUM:
        raise UndecidedError(f"homotopy: {outcome.value}", method=HOMOTOPY)
    spaces = _ends_in_doubles(ends, float(np.linalg.norm(scaled)))
    return CriticalSet(
        method=HOMOTOPY,
        components=spaces_as_components(
            Resolution(spaces=spaces, bits=ENDS_BITS, pose_bits=DOUBLE_BITS),
            objective.energy_of_eigenvalue,
            (None,) * len(spaces),
            Guarantee.NUMERICAL,
        ),
        bits=ENDS_BITS,
        completeness=None,
        doubt=f"homotopy: {outcome.value}",
    )


def _proved(objective: Isotropic, ends: list[list[float]]) -> CriticalSet | None:
    """The ends in disjoint boxes with one root each; None where that is not proved."""
    balls = exact_matrix(objective.davenport, objective.shift)
    boxed: list[tuple[EigenBalls, RootBox]] = []
    for q in ends:
        system = EigenBalls(balls, q)
        box = proved_root(system, system.start(q))
        if box is None:
            return None
        boxed.append((system, box))
    if not are_distinct([box for _, box in boxed]):
        return None
    boxed.sort(key=lambda pair: pair[1].coordinates[4].mid(), reverse=True)
    resolution = resolved(lambda bits: tuple(_space(*pair, bits) for pair in boxed))
    bits = resolution.bits
    cross = objective.moments.cross
    indices = [
        morse_bott_index(cross, tightened(*pair, bits).coordinates[:4], 0, bits=2 * bits)
        for pair in boxed
    ]
    return CriticalSet(
        method=HOMOTOPY,
        components=spaces_as_components(
            resolution, objective.energy_of_eigenvalue, indices, Guarantee.ENCLOSED
        ),
        bits=bits,
        completeness=Completeness.COUNT,
    )


def _space(system: EigenBalls, box: RootBox, bits: int) -> Space:
    """The unit quaternion and the value of a proved root, its box made small enough."""
    *q, value = tightened(system, box, bits).coordinates
    with ctx.workprec(2 * bits):
        (unit,) = orthonormal([q], 1)
    return Space(
        values=(fixed_point(value, bits),), vectors=(tuple(fixed_point(c, bits) for c in unit),)
    )


def _ends_in_doubles(ends: Continuation, size: float) -> tuple[Space, ...]:
    """What the ends suggest: an orthonormal frame for each value. size: norm of K, scaled."""
    spaces, start = list[Space](), 0
    for multiplicity in ends.patterns[0]:
        group = slice(start, start + multiplicity)
        frame = np.linalg.svd(ends.quaternions[0][group])[2][:multiplicity]
        value = _fixed(float(ends.values[0][group].mean() * size))
        start += multiplicity
        vectors = tuple(tuple(_fixed(entry) for entry in row) for row in frame.tolist())
        spaces.append(Space(values=(value,) * multiplicity, vectors=vectors))
    return tuple(spaces)


def _fixed(value: float) -> int:
    """A double in fixed point."""
    return round(math.ldexp(value, DOUBLE_BITS)) << (ENDS_BITS - DOUBLE_BITS)


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
    found = _followed(scaled, rng, tracker)
    attempts = np.ones(instances, dtype=np.int64)
    patterns = _patterns(found)
    for attempt in range(2, ATTEMPTS + 1):
        again = np.array([k for k, pattern in enumerate(patterns) if pattern is None], dtype=int)
        if not len(again):
            break
        tracker = tracker.careful()
        retried = _followed(scaled[again], rng, tracker)
        for whole, part in zip(found.arrays, retried.arrays, strict=True):
            whole[again] = part
        attempts[again] = attempt
        for k, pattern in zip(again.tolist(), _patterns(retried), strict=True):
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
    tracker: TrackerSettings,
) -> _Ends:
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


def _patterns(ends: _Ends) -> list[tuple[int, ...] | None]:
    """How many ends share a value, for each instance; None where ends are missing."""
    cosines = np.abs(ends.quaternions @ ends.quaternions.transpose(0, 2, 1))
    cosines[:, AXES, AXES] = 0.0
    apart = (cosines < np.cos(SAME_ROOT)).all(axis=(1, 2))
    regular = (ends.codes == REGULAR).all(axis=1)
    usual: tuple[int, ...] = (1,) * PATHS
    return [
        usual if good else _shared(ends, k) for k, good in enumerate((regular & apart).tolist())
    ]


def _shared(ends: _Ends, k: int) -> tuple[int, ...] | None:
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


def _outcome(pattern: tuple[int, ...] | None) -> HomotopyStatus:
    if pattern is None:
        return HomotopyStatus.INCOMPLETE
    return HomotopyStatus.FOUND if len(pattern) == PATHS else HomotopyStatus.CONTINUUM
