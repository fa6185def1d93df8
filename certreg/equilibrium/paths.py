"""All critical lines of a quartic on quaternions: 40 paths from a quartic whose lines are known.

A critical line is a complex q, up to a factor, with grad F(q) = l q. If there are finitely many,
there are (3^4 - 1) / 2 = 40, counted with multiplicity. Of G = a_1 q_1^4 + ... + a_4 q_4^4 they are
known: q_i = 0 or a_i q_i^2 = l / 4, so 4 + 12 + 16 + 8 lines by the number of entries that are not
zero. With random complex a_i the straight path from G to F meets no singularity before its end,
with probability one [Sommese2005]. Each line has one point on a random complex plane chart . q = 1.

This is floating point: it proposes. What became of the paths is said.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass
from itertools import combinations, product
from typing import TYPE_CHECKING

import numpy as np

from certreg.equilibrium.quartics import FloatingQuartic
from certreg.equilibrium.tracking import (
    DIVERGED,
    LOST,
    REGULAR,
    PathStatus,
    TrackerSettings,
    statuses_of,
    track,
)
from certreg.objective import MONOMIALS, levelled
from certreg.results import Brief

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from certreg.equilibrium.tracking import Complexes, Indices, Reals, TrackedPaths

LINES = 40
SEED = 20261  # any: with another the paths differ, and the ends do not
ATTEMPTS = 4  # sets of a_i and charts
SAME_LINE = 1e-6  # sine of an angle between lines: regular ends are right to 1e-10
REAL = 1e-8  # sine of the angle between a line and its conjugate: regular ends are right to 1e-10
AXES = np.arange(4)


class PathsOutcome(enum.Enum):
    """What the ends of the 40 paths amount to; the value is the sentence for the user."""

    FOUND = "All 40 paths ended at isolated critical lines, no two at the same."
    SINGULAR = (
        "Paths ended where critical lines meet: in a multiple line, in a continuum, or nearly so."
    )
    INCOMPLETE = (
        "Some paths were lost or met, with every start that was tried: critical lines are missing."
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CriticalLines(Brief):
    """The ends of the 40 paths.

    points: (40, 4), complex, of norm 1, the largest entry positive. codes: (40,), what became of
    each path, places in `list(PathStatus)`. quaternions: (k, 4), the real ones of the regular ends,
    units, of ascending value. attempts: how many starts were tried.
    """

    points: Complexes
    codes: NDArray[np.int8]
    quaternions: Reals
    outcome: PathsOutcome
    attempts: int

    @property
    def statuses(self) -> tuple[PathStatus, ...]:
        """What became of each path."""
        return statuses_of(self.codes)


class LineForm:
    """grad F(q) = l q and chart . q = 1 in (q, l), for paths that share both."""

    def __init__(self, form: FloatingQuartic, chart: Complexes) -> None:
        """chart: (4,)."""
        self._form, self._chart = form, chart

    def evaluate(self, which: Indices, x: Complexes) -> tuple[Complexes, Complexes]:
        """Values (m, 5) and Jacobians (m, 5, 5)."""
        del which
        q = x[:, :4]
        hessians = self._form.hessians(q)
        values = np.empty_like(x)
        values[:, :4] = (hessians @ q[..., None])[..., 0] / 3.0 - x[:, 4:] * q
        values[:, 4] = q @ self._chart - 1.0
        jacobian = np.zeros((len(x), 5, 5), dtype=np.complex128)
        jacobian[:, :4, :4] = hessians
        jacobian[:, AXES, AXES] -= x[:, 4:]
        jacobian[:, :4, 4] = -q
        jacobian[:, 4, :4] = self._chart
        return values, jacobian


def critical_lines(
    coefficients: Sequence[float] | Reals, *, tracker: TrackerSettings | None = None
) -> CriticalLines:
    """The critical lines of a quartic of 35 finite coefficients, near 1.

    Where paths are lost or meet, all are tried again with another start and more care.
    """
    tracker = tracker or TrackerSettings()
    rng = np.random.default_rng(SEED)
    form = FloatingQuartic.of(levelled(coefficients).rest)
    best: CriticalLines | None = None
    for attempt in range(1, ATTEMPTS + 1):
        found = _gathered(form, _followed(form, rng, tracker), attempt)
        if best is None or _lost(found) < _lost(best):
            best = found
        if found.outcome is not PathsOutcome.INCOMPLETE:
            return found
        tracker = tracker.careful()
    assert best is not None  # noqa: S101 - there is an attempt
    return best


def _followed(
    form: FloatingQuartic, rng: np.random.Generator, tracker: TrackerSettings
) -> TrackedPaths:
    """The paths from a start that is drawn anew."""
    phases = np.exp(2j * np.pi * rng.uniform(size=4))
    noise = rng.normal(size=(2, 4))
    chart = noise[0] + 1j * noise[1]
    coefficients = np.zeros(len(MONOMIALS), dtype=np.complex128)
    coefficients[[MONOMIALS.index((i,) * 4) for i in range(4)]] = phases
    start = FloatingQuartic.of(coefficients)
    roots = np.array([_root(line, chart) for line in _known_lines(phases)])
    return track(LineForm(start, chart), LineForm(form, chart), roots, 1.0, tracker)


def _known_lines(a: Complexes) -> list[Complexes]:
    """The 40 critical lines of sum a_i q_i^4: entries +-a_i^(-1/2) or 0, one of q and -q each."""
    roots = 1.0 / np.sqrt(a)
    lines: list[Complexes] = []
    for count in range(1, 5):
        for support in combinations(range(4), count):
            for signs in product((1.0, -1.0), repeat=count - 1):
                line = np.zeros(4, dtype=np.complex128)
                line[list(support)] = roots[list(support)] * (1.0, *signs)
                lines.append(line)
    return lines


def _root(line: Complexes, chart: Complexes) -> Complexes:
    """The point of a known line in the chart, and its l: 4 where a_i q_i^2 = 1."""
    scale = 1.0 / (line @ chart)
    return np.append(scale * line, 4.0 * scale * scale)


def _gathered(form: FloatingQuartic, tracked: TrackedPaths, attempt: int) -> CriticalLines:
    """The ends made units, the real ones sorted out, and what all amounts to."""
    q = tracked.points[:, :4]
    largest = np.take_along_axis(q, np.abs(q).argmax(axis=1)[:, None], axis=1)
    q = q / largest
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    regular = tracked.codes == REGULAR
    real = q[regular & (np.linalg.norm(q.imag, axis=1) < REAL)].real
    real /= np.linalg.norm(real, axis=1, keepdims=True)
    return CriticalLines(
        points=q,
        codes=tracked.codes,
        quaternions=real[np.argsort(form.values(real), kind="stable")],
        outcome=_outcome(q[regular], tracked.codes),
        attempts=attempt,
    )


def _outcome(regular: Complexes, codes: NDArray[np.int8]) -> PathsOutcome:
    """FOUND if all ends are regular and no two the same."""
    overlaps = regular.conj() @ regular.T
    met = _sines(regular, overlaps)
    met[np.diag_indices(len(regular))] = 1.0
    if ((codes == LOST) | (codes == DIVERGED)).any() or (met < SAME_LINE).any():
        return PathsOutcome.INCOMPLETE
    return PathsOutcome.FOUND if len(regular) == LINES else PathsOutcome.SINGULAR


def _sines(units: Complexes, overlaps: Complexes) -> Reals:
    """Of the angles between all lines: |p - (q.p) q|, right where 1 - |q.p|^2 is not."""
    apart = units[:, None] - overlaps.T[..., None] * units[None]
    return np.linalg.norm(apart, axis=2)


def _lost(found: CriticalLines) -> int:
    return int(((found.codes == LOST) | (found.codes == DIVERGED)).sum())
