"""All critical lines of a quartic on quaternions: 40 paths from a quartic whose lines are known.

A critical line is a complex q, up to a factor, with grad F(q) = l q. If there are finitely many,
there are (3^4 - 1) / 2 = 40, counted with multiplicity. Of G = a_1 q_1^4 + ... + a_4 q_4^4 they are
known: q_i = 0 or a_i q_i^2 = l / 4, so 4 + 12 + 16 + 8 lines by the number of entries that are not
zero. With random complex a_i the straight path from G to F meets no singularity before its end,
with probability one [Sommese2005]. Of each line the point on a plane chart . q = 1 is followed.

This is floating point: it proposes. What became of the paths is said.
"""

from __future__ import annotations

import enum
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from certreg.equilibrium.quartics import FloatingQuartic
from certreg.equilibrium.tracking import (
    DIVERGED,
    LOST,
    REGULAR,
    Arrivals,
    TrackedPaths,
    TrackerSettings,
    polished,
    track,
)
from certreg.native.paths import REACHED, PathEnds, PathRules, many_quartic_paths, quartic_paths
from certreg.objective.normalisation import levelled
from certreg.objective.quartics import MONOMIALS
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.equilibrium.tracking import Complexes, Indices, Reals


LINES = 40
# One start is enough for 995 of 1000 random quartics; paths that come near each other need short
# steps: least_step is for a square root at 1e-18 of the way.
SETTINGS = TrackerSettings(
    predictor_bound=0.05, predictor_aim=0.0125, corrector_bound=0.0025, least_step=1e-9
)
SEED = 20261  # any: with another the paths differ, and the ends do not
ATTEMPTS = 4  # sets of a_i and charts
SAME_LINE = 1e-6  # sine of an angle between lines: regular ends are right to 1e-10
REAL = 1e-8  # sine of the angle between a line and its conjugate: regular ends are right to 1e-10
POLISHED = 1e-12  # of Newton's change in C: squared, nothing is left
POLISHINGS = 5  # two are usual; where more are needed, roots meet or nearly so
CLEAR_CONDITION = 1e6  # where all digits but six are right, nothing is in doubt
AXES = np.arange(4)
CHART_MIXING = 0.3  # of random numbers to the axis in a path's chart, without compiled code
SIGNS = np.array(
    [signs for signs in product((0, 1, -1), repeat=4) if next(filter(None, signs), 0) == 1]
)  # (40, 4): the first that is not zero is positive
FOURTH_POWERS = [MONOMIALS.index((i,) * 4) for i in range(4)]


class PathsOutcome(enum.Enum):
    """What the ends of the 40 paths amount to; the value is the sentence for the user."""

    FOUND = "All 40 paths ended at isolated critical lines, no two at the same."
    SINGULAR = (
        "Paths ended where critical lines meet: in a multiple line, in a continuum, or nearly so."
    )
    CONSTANT = "The quartic is constant: every line is critical."
    INCOMPLETE = (
        "Some paths were lost or met, with every start that was tried: critical lines are missing."
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CriticalLines(Brief):
    """The ends of the 40 paths.

    points: (40, 4), complex, of norm 1, the largest entry positive; none where the quartic is
    constant. codes: (40,), what became of each path, places in `list(PathStatus)`. quaternions:
    (k, 4), the real ones of the regular ends, units, of ascending value. attempts: how many starts
    were tried.
    """

    points: Complexes
    codes: NDArray[np.int8]
    quaternions: Reals
    outcome: PathsOutcome
    attempts: int

    @property
    def real_ends(self) -> NDArray[np.bool_]:
        """(40,): which ends are regular and real."""
        return (self.codes == REGULAR) & (np.linalg.norm(self.points.imag, axis=1) < REAL)


class LineForm:
    """grad F(q) = l q and chart . q = 1 in (q, l), for paths with charts of their own."""

    def __init__(self, form: FloatingQuartic, charts: Complexes) -> None:
        """charts: (paths, 4)."""
        self._form, self._charts = form, charts

    def evaluate(self, which: Indices, x: Complexes) -> tuple[Complexes, Complexes]:
        """Values (m, 5) and Jacobians (m, 5, 5)."""
        q, charts = x[:, :4], self._charts[which]
        hessians = self._form.hessians(q)
        values = np.empty_like(x)
        values[:, :4] = (hessians @ q[..., None])[..., 0] / 3.0 - x[:, 4:] * q
        values[:, 4] = (charts * q).sum(axis=1) - 1.0
        jacobian = np.zeros((len(x), 5, 5), dtype=np.complex128)
        jacobian[:, :4, :4] = hessians
        jacobian[:, AXES, AXES] -= x[:, 4:]
        jacobian[:, :4, 4] = -q
        jacobian[:, 4, :4] = charts
        return values, jacobian


def critical_lines(
    coefficients: Sequence[float] | Reals, *, tracker: TrackerSettings | None = None
) -> CriticalLines:
    """The critical lines of a quartic of 35 finite coefficients, near 1.

    Where paths are lost or meet, all are tried again with another start and more care.
    """
    tracker = tracker or SETTINGS
    rng = np.random.default_rng(SEED)
    quartic = levelled(coefficients).rest
    form = FloatingQuartic.of(quartic)
    if not quartic.any():
        return CriticalLines(
            points=np.zeros((0, 4), dtype=np.complex128),
            codes=np.zeros(0, dtype=np.int8),
            quaternions=np.zeros((0, 4)),
            outcome=PathsOutcome.CONSTANT,
            attempts=0,
        )
    best: CriticalLines | None = None
    for attempt in range(1, ATTEMPTS + 1):
        found = _gathered(form, _followed(quartic, rng, tracker), attempt)
        if best is None or _lost(found) < _lost(best):
            best = found
        if found.outcome is not PathsOutcome.INCOMPLETE:
            return found
        tracker = tracker.careful()
    assert best is not None  # noqa: S101 - there is an attempt
    return best


def _followed(quartic: Reals, rng: np.random.Generator, tracker: TrackerSettings) -> TrackedPaths:
    """The paths from a start that is drawn anew, by C where there is compiled code."""
    form, a = FloatingQuartic.of(quartic), np.exp(2j * np.pi * rng.uniform(size=4))
    roots = _known_roots(a)
    ends = quartic_paths(quartic, a, roots, _rules(tracker))
    if ends is not None:
        return _sorted_out(form, roots, ends, tracker)
    coefficients = np.zeros(len(MONOMIALS), dtype=np.complex128)
    coefficients[FOURTH_POWERS] = a
    noise = rng.normal(size=(2, LINES, 4))
    charts = roots[:, :4].conj() + CHART_MIXING * (noise[0] + 1j * noise[1])
    over = 1.0 / (charts * roots[:, :4]).sum(axis=1, keepdims=True)
    start = roots * np.concatenate([np.repeat(over, 4, axis=1), over * over], axis=1)
    begun = LineForm(FloatingQuartic.of(coefficients), charts)
    return track(begun, LineForm(form, charts), start, 1.0, tracker)


def _rules(tracker: TrackerSettings) -> PathRules:
    """What C needs of the settings, and by what it polishes."""
    settings = {name: getattr(tracker, name) for name, *_ in PathRules._fields_}
    return PathRules(**{**settings, "polished": POLISHED, "polishings": POLISHINGS})


def _sorted_out(
    form: FloatingQuartic, roots: Complexes, ends: PathEnds, tracker: TrackerSettings
) -> TrackedPaths:
    """The ends as `track` gives them; those that C leaves in doubt are polished as there."""
    codes = np.where(ends.codes == REACHED, REGULAR, LOST).astype(np.int8)
    clear = (ends.changes <= POLISHED) & (ends.conditions <= CLEAR_CONDITION)
    points, conditions = ends.points, ends.conditions
    coranks = np.zeros(len(codes), dtype=np.int8)
    rows = np.flatnonzero((codes == REGULAR) & ~clear)
    if len(rows):
        arrivals = Arrivals(
            roots=roots[rows], points=points[rows], codes=codes[rows], rounds=ends.rounds[rows]
        )
        target = LineForm(form, points[rows, :4].conj())
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):  # ends as a status
            doubtful = polished(target, arrivals, tracker)
        points[rows], codes[rows] = doubtful.points, doubtful.codes
        conditions[rows], coranks[rows] = doubtful.conditions, doubtful.coranks
    return TrackedPaths(
        points=points, codes=codes, conditions=conditions, coranks=coranks, rounds=ends.rounds
    )


def _known_roots(a: Complexes) -> Complexes:
    """The critical lines of sum a_i q_i^4, (40, 5): units q with entries +-a_i^(-1/2) or 0, and l.

    One of q and -q each. Where all a_i q_i^2 are 1 or 0, l is 4.
    """
    q = SIGNS / np.sqrt(a)
    squares = (q.real**2 + q.imag**2).sum(axis=1, keepdims=True)
    return np.concatenate([q / np.sqrt(squares), 4.0 / squares], axis=1)


def _gathered(form: FloatingQuartic, tracked: TrackedPaths, attempt: int) -> CriticalLines:
    """The ends made units, the real ones sorted out, and what all amounts to."""
    ends = gathered(tracked.points[np.newaxis], tracked.codes[np.newaxis])
    real = ends.units[ends.real].real
    real /= np.linalg.norm(real, axis=1, keepdims=True)
    return CriticalLines(
        points=ends.units[0],
        codes=tracked.codes,
        quaternions=real[np.argsort(form.values(real), kind="stable")],
        outcome=ends.outcomes[0],
        attempts=attempt,
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GatheredEnds(Brief):
    """Ends of paths to many quartics.

    units: (count, 40, 4), the largest entry positive. codes: (count, 40), as in `CriticalLines`.
    real: (count, 40), regular and real.
    """

    units: Complexes
    codes: NDArray[np.int8]
    real: NDArray[np.bool_]
    outcomes: tuple[PathsOutcome, ...]


def gathered(points: Complexes, codes: NDArray[np.int8]) -> GatheredEnds:
    """Ends (count, 40, 5), of which no entry of l matters, and codes (count, 40), sorted out."""
    q = points[..., :4]
    largest = np.take_along_axis(q, np.abs(q).argmax(axis=2)[..., None], axis=2)
    q = q / largest
    q /= np.linalg.norm(q, axis=2, keepdims=True)
    regular = codes == REGULAR
    real = regular & (np.linalg.norm(q.imag, axis=2) < REAL)
    return GatheredEnds(units=q, codes=codes, real=real, outcomes=_outcomes(q, codes))


def _outcomes(units: Complexes, codes: NDArray[np.int8]) -> tuple[PathsOutcome, ...]:
    """FOUND if all ends are regular and no two the same."""
    regular = codes == REGULAR
    met = _sines(np.where(regular[..., None], units, 0.0))
    met[~(regular[:, :, None] & regular[:, None])] = 1.0
    met[:, np.arange(LINES), np.arange(LINES)] = 1.0
    lost = ((codes == LOST) | (codes == DIVERGED)).any(axis=1)
    incomplete = lost | (met < SAME_LINE).any(axis=(1, 2))
    whole = regular.all(axis=1)
    full = {False: PathsOutcome.SINGULAR, True: PathsOutcome.FOUND}
    return tuple(
        PathsOutcome.INCOMPLETE if bad else full[bool(good)]
        for bad, good in zip(incomplete, whole, strict=True)
    )


def _sines(units: Complexes) -> Reals:
    """Of the angles between all lines: |p - (q.p) q|, right where 1 - |q.p|^2 is not."""
    overlaps = units.conj() @ units.swapaxes(1, 2)
    apart = units[:, :, None] - overlaps.swapaxes(1, 2)[..., None] * units[:, None]
    return np.linalg.norm(apart, axis=3)


def _lost(found: CriticalLines) -> int:
    return int(((found.codes == LOST) | (found.codes == DIVERGED)).sum())


def many_critical_lines(quartics: Reals) -> GatheredEnds:
    """The critical lines of many levelled quartics (count, 35), none zero, all in one call of C.

    A problem of which paths are lost or meet is tried again by itself, as `critical_lines` does.
    """
    rng = np.random.default_rng(SEED)
    a = np.exp(2j * np.pi * rng.uniform(size=4))
    roots = _known_roots(a)
    ends = many_quartic_paths(quartics, a, roots, _rules(SETTINGS))
    clear = (ends.changes <= POLISHED) & (ends.conditions <= CLEAR_CONDITION)
    points = ends.points
    codes = np.where(ends.codes == REACHED, REGULAR, LOST).astype(np.int8)
    for k in np.flatnonzero(~clear.all(axis=1)).tolist():
        sorted_out = _sorted_out(FloatingQuartic.of(quartics[k]), roots, ends.of(k), SETTINGS)
        points[k], codes[k] = sorted_out.points, sorted_out.codes
    found = gathered(points, codes)
    again = [k for k, o in enumerate(found.outcomes) if o is PathsOutcome.INCOMPLETE]
    if not again:
        return found
    others = _one_by_one(quartics[again])
    outcomes = list(found.outcomes)
    for k, outcome in zip(again, others.outcomes, strict=True):
        outcomes[k] = outcome
    found.units[again], found.codes[again] = others.units, others.codes
    found.real[again] = others.real
    return replace(found, outcomes=tuple(outcomes))


def _one_by_one(quartics: Reals) -> GatheredEnds:
    lines = [critical_lines(quartic) for quartic in quartics]
    return GatheredEnds(
        units=np.array([one.points for one in lines]),
        codes=np.array([one.codes for one in lines]),
        real=np.array([one.real_ends for one in lines]),
        outcomes=tuple(one.outcome for one in lines),
    )
