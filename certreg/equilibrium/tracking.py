"""Predictor-corrector continuation: from the known roots of one system to those of another.

H(x, t) = gamma t G(x) + (1 - t) F(x), t from 1 (the start system G) to 0 (the target F). With a
random complex gamma the paths meet no singularity before t = 0, with probability one [Sommese2005].
All paths of all instances advance at once, each with its own t and step. A module of its own: the
tracker knows nothing of what it solves; any two systems of n polynomials in n unknowns will do.

This is floating point: it proposes. What became of each path is said for each path.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Complexes = NDArray[np.complex128]
    Reals = NDArray[np.float64]
    Indices = NDArray[np.intp]


class System(Protocol):
    """n polynomials in n unknowns; each path has its own coefficients."""

    def evaluate(self, which: Indices, x: Complexes, /) -> tuple[Complexes, Complexes]:
        """Values (m, n) and Jacobians (m, n, n) of the polynomials of paths `which` (m,) at x."""
        ...


class PathStatus(enum.Enum):
    """What became of a path; the value is the sentence for the user."""

    REGULAR = "The path ended at an isolated root."
    SINGULAR = "The path ended where roots meet: in a multiple root, in a continuum, or nearly so."
    DIVERGED = "The path went to infinity."
    LOST = "The path was not followed to its end: try another gamma, or more rounds."


REGULAR, SINGULAR, DIVERGED, LOST = range(4)  # as stored: places in `list(PathStatus)`


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackerSettings:
    """Steps of the path tracker in t, from 1 to 0; changes of a point are relative to its size.

    Long steps may leave a path for another; whoever needs every root compares the ends.
    """

    first_step: float = 0.2  # a start system is chosen well conditioned; halved where it fails
    predictor_bound: float = 0.2  # of Newton's first change: beyond, it may leave its basin
    predictor_aim: float = 0.05  # what the next step is chosen for
    corrector_bound: float = 0.01  # of its last change, whose square is what is left: 1e-4
    step_power: float = 0.25  # the error of a cubic grows with the fourth power of the step
    least_growth: float = 0.5  # an accepted step was not that bad
    most_growth: float = 3.0  # a step is not to outrun what is known of the path
    shrink: float = 0.4  # after a step that failed
    least_step: float = 1e-4  # of t: below, something is in the way
    endgame: float = 1e-14  # t below counts as 0: less than the rounding of the coefficients
    max_rounds: int = 300  # fifteen are usual, sixty at a singular end
    care: float = 0.25  # factor of all bounds of a step when a lost path is tried again
    infinity: float = 1e6  # in a random chart a root is as large once in 10^12
    straightenings: int = 2  # quadratic convergence from 1e-4
    polishings: int = 30  # two are usual; at a double root each halves the error, to 2^-27
    polished: float = 1e-10  # of Newton's change: squared, nothing is left
    largest_move: float = 0.5  # of one polishing step: beyond, it leads to another root
    weak_share: float = 1e-2  # of a Jacobian's largest singular value: a corrector's own accuracy
    singular_condition: float = 1e11  # beyond, fewer than five digits of a root are right
    singular_residual: float = 1e-7  # relative; a double root is right to the root of an ulp
    steadiness: float = 0.5  # of a singular value: less of it may change within the error
    rounding: float = 100.0  # of Newton's last change, in ulps times the condition

    def careful(self) -> TrackerSettings:
        """The same with shorter steps that are corrected further."""
        return replace(
            self,
            first_step=self.first_step * self.care,
            predictor_bound=self.predictor_bound * self.care,
            predictor_aim=self.predictor_aim * self.care,
            corrector_bound=self.corrector_bound * self.care,
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TrackedPaths:
    """The ends of all paths.

    points: (paths, n). codes: (paths,), places in `list(PathStatus)`.
    conditions: of the Jacobian at the end, relative to the larger of it and that at the start
        root; infinite where none was reached.
    coranks: of that Jacobian, numerically; through the end goes no continuum of more dimensions.
    rounds: (paths,), of predicting and correcting, the refused ones too.
    """

    points: Complexes
    codes: NDArray[np.int8]
    conditions: Reals
    coranks: NDArray[np.int8]
    rounds: NDArray[np.int64]


def statuses_of(codes: NDArray[np.int8]) -> tuple[PathStatus, ...]:
    """The statuses that stored codes (paths,) stand for."""
    every = tuple(PathStatus)
    places: list[int] = codes.tolist()
    return tuple(every[place] for place in places)


def track(
    start: System,
    target: System,
    roots: Complexes,
    gamma: complex,
    settings: TrackerSettings | None = None,
) -> TrackedPaths:
    """Follow the roots (paths, n) of the start system to the target system.

    gamma: any complex number that is neither zero nor negative; random, so that the paths stay
    clear of singularities.
    """
    settings = settings or TrackerSettings()
    roots = roots.astype(np.complex128)
    front = _Front(_Segment(start=start, target=target, gamma=gamma), roots, settings)
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):  # ends as a status
        while len(front.which):
            front.advance()
        arrivals = Arrivals(
            roots=front.roots, points=front.ends, codes=front.codes, rounds=front.rounds
        )
        return polished(target, arrivals, settings)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Arrivals:
    """Paths near their ends.

    roots, points: (paths, n), where they began and where they are. codes: (paths,), REGULAR at
    t = 0. rounds: (paths,).
    """

    roots: Complexes
    points: Complexes
    codes: NDArray[np.int8]
    rounds: NDArray[np.int64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Segment:
    """The straight homotopy between two systems, bent by gamma."""

    start: System
    target: System
    gamma: complex

    def newton(self, which: Indices, x: Complexes, t: Reals) -> tuple[Complexes, Complexes]:
        """Newton's change and the tangent dx/dt, both with the sign turned, (m, n)."""
        back, ahead = (self.gamma * t)[:, None], (1.0 - t)[:, None]
        G, jacobian = self.start.evaluate(which, x)
        F, target_jacobian = self.target.evaluate(which, x)
        jacobian *= back[..., None]
        target_jacobian *= ahead[..., None]
        jacobian += target_jacobian
        columns = np.empty((*x.shape, 2), dtype=np.complex128)
        columns[..., 0] = back * G + ahead * F
        columns[..., 1] = self.gamma * G - F
        both = _solved(jacobian, columns)
        return both[..., 0], both[..., 1]


class _Front:
    """Where the paths are that are still under way; it alone changes while they are followed."""

    def __init__(self, segment: _Segment, x: Complexes, settings: TrackerSettings) -> None:
        paths = len(x)
        self.segment, self.settings, self.round = segment, settings, 0
        self.roots, self.ends, self.codes = x, x.copy(), np.full(paths, LOST, dtype=np.int8)
        self.rounds = np.zeros(paths, dtype=np.int64)
        self.which = np.arange(paths)
        self.x, self.t, self.step = x, np.ones(paths), np.full(paths, settings.first_step)
        self.slope = -segment.newton(self.which, x, self.t)[1]
        # before the start the path is taken to be its tangent
        self.x0, self.t0, self.slope0 = x + self.slope, self.t + 1.0, self.slope

    def advance(self) -> None:
        """One round: predict and correct every path, keep what is good, shorten the other steps."""
        settings = self.settings
        t = np.maximum(self.t - self.step, 0.0)
        new = self._corrected(self._predicted(t), t)
        kept = (new.first <= settings.predictor_bound) & (new.last <= settings.corrector_bound)
        growth = (settings.predictor_aim / new.first) ** settings.step_power
        longer = self.step * np.minimum(
            np.maximum(growth, settings.least_growth), settings.most_growth
        )
        if kept.all():
            self.x0, self.t0, self.slope0 = self.x, self.t, self.slope
            self.x, self.t, self.slope, self.step = new.x, t, new.slope, longer
        else:
            shorter = np.minimum(self.step, self.t) * settings.shrink
            rows = kept[:, None]
            self.x0, self.x = np.where(rows, self.x, self.x0), np.where(rows, new.x, self.x)
            self.slope0 = np.where(rows, self.slope, self.slope0)
            self.slope = np.where(rows, new.slope, self.slope)
            self.t0, self.t = np.where(kept, self.t, self.t0), np.where(kept, t, self.t)
            self.step = np.where(kept, longer, shorter)
        self.round += 1
        self._retire()

    def _retire(self) -> None:
        """Take off the list what has arrived, diverged or got stuck."""
        settings, t = self.settings, self.t
        arrived = t < settings.endgame
        far = np.abs(self.x).max(axis=1) > settings.infinity
        stuck = (self.step < settings.least_step * t) | (self.round >= settings.max_rounds)
        done = arrived | far | stuck
        if not done.any():
            return
        ended = self.which[done]
        self.ends[ended], self.rounds[ended] = self.x[done], self.round
        self.codes[ended] = np.where(arrived, REGULAR, np.where(far, DIVERGED, LOST))[done]
        left = ~done
        for name in ("which", "x", "t", "slope", "step", "x0", "t0", "slope0"):
            setattr(self, name, getattr(self, name)[left])

    def _predicted(self, t: Reals) -> Complexes:
        """The cubic through the last two points and tangents, in Newton's form."""
        span, ahead = (self.t - self.t0)[:, None], (t - self.t)[:, None]
        secant = (self.x - self.x0) / span
        bend = (self.slope - secant) / span
        twist = (self.slope - 2.0 * secant + self.slope0) / (span * span)
        ahead = ahead.astype(np.complex128)
        return self.x + ahead * (self.slope + ahead * (bend + twist * (ahead + span)))

    def _corrected(self, x: Complexes, t: Reals) -> _Correction:
        """Point and tangent after one or two Newton steps."""
        settings = self.settings
        change, slope = self.segment.newton(self.which, x, t)
        first = _relative(change, x)
        x, slope = x - change, -slope
        again = (first > settings.corrector_bound) & (first <= settings.predictor_bound)
        if not again.any():
            return _Correction(x=x, slope=slope, first=first, last=first)
        change, second = self.segment.newton(self.which[again], x[again], t[again])
        last = first.copy()
        last[again] = _relative(change, x[again])
        x[again] -= change
        slope[again] = -second
        return _Correction(x=x, slope=slope, first=first, last=last)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Correction:
    """Points (m, n), tangents, and the first and the last relative change (m,)."""

    x: Complexes
    slope: Complexes
    first: Reals
    last: Reals


def polished(target: System, arrivals: Arrivals, settings: TrackerSettings) -> TrackedPaths:
    """The ends after Newton's method on the target alone, the regular told from the singular.

    Points and codes of the arrivals are changed.
    """
    x, codes = arrivals.points, arrivals.codes
    conditions, coranks = np.full(len(x), np.inf), np.zeros(len(x), dtype=np.int8)
    there = np.flatnonzero(codes == REGULAR)
    if len(there):
        point = _straightened(target, there, x[there], settings)
        point, change = _newton(target, there, point, settings)
        values, jacobian = target.evaluate(there, point)
        scale = np.linalg.svd(jacobian, compute_uv=False)
        # with one unknown a Jacobian has no condition of its own: the start gives the scale
        usual = np.linalg.norm(target.evaluate(there, arrivals.roots[there])[1], axis=(1, 2))
        size = np.maximum(scale[:, 0], usual)
        condition = np.where(scale[:, -1] > 0.0, size / scale[:, -1], np.inf)
        tiny = settings.singular_residual * size * np.abs(point).max(axis=1)
        least = np.maximum(settings.polished, settings.rounding * np.finfo(float).eps * condition)
        regular = (change <= least) & (condition < settings.singular_condition)
        weak = np.flatnonzero(regular & (least * settings.rounding > scale[:, -1]))
        if len(weak):
            regular[weak] = ~_multiple(target, there[weak], point[weak], least[weak], settings)
        singular = np.abs(values).max(axis=1) <= tiny
        codes[there] = np.where(regular, REGULAR, np.where(singular, SINGULAR, LOST))
        coranks[there] = (scale * settings.singular_condition < size[:, None]).sum(axis=1)
        x[there], conditions[there] = point, condition
    return TrackedPaths(
        points=x, codes=codes, conditions=conditions, coranks=coranks, rounds=arrivals.rounds
    )


def _multiple(
    target: System, which: Indices, x: Complexes, error: Reals, settings: TrackerSettings
) -> NDArray[np.bool_]:
    """Where, within the error of a point, the Jacobian's weakest direction loses its sign.

    With the weakest singular value s and its vectors u, v: where |u^H F'' v v| times the error is
    not small beside s, there may be two roots. At a double root both shrink alike.
    """
    jacobian = target.evaluate(which, x)[1]
    u, scale, v = np.linalg.svd(jacobian)
    null, image = v[:, -1].conj(), u[:, :, -1].conj()
    reach = (error * np.abs(x).max(axis=1))[:, None]
    moved = target.evaluate(which, x + reach * null)[1] - jacobian
    bend = np.abs((image * (moved @ null[..., None])[..., 0]).sum(axis=1))
    return bend > settings.steadiness * scale[:, -1]


def _straightened(
    target: System, which: Indices, x: Complexes, settings: TrackerSettings
) -> Complexes:
    """The points, those at weak Jacobians moved onto the solutions in the strong directions.

    What is left of the corrector's error there, squared, would drown the weak directions, in which
    Newton's method then would leave its basin.
    """
    scale = np.linalg.svd(target.evaluate(which, x)[1], compute_uv=False)
    rows = np.flatnonzero(scale[:, -1] < settings.weak_share * scale[:, 0])
    if not len(rows):
        return x
    x, which = x.copy(), which[rows]
    for _ in range(settings.straightenings):
        values, jacobian = target.evaluate(which, x[rows])
        u, scale, v = np.linalg.svd(jacobian)
        weak = scale < settings.weak_share * scale[:, :1]
        inside = (u.conj().transpose(0, 2, 1) @ values[..., None])[..., 0]
        moves = np.where(weak, 0.0, inside / scale)
        x[rows] -= (v.conj().transpose(0, 2, 1) @ moves[..., None])[..., 0]
    return x


def _newton(
    target: System, which: Indices, x: Complexes, settings: TrackerSettings
) -> tuple[Complexes, Reals]:
    """The points after Newton's method, and the size of its last relative change."""
    change = np.zeros(len(x))
    for _ in range(settings.polishings):
        values, jacobian = target.evaluate(which, x)
        step = _solved(jacobian, values[..., None])[..., 0]
        change = _relative(step, x)
        x = np.where((change < settings.largest_move)[:, None], x - step, x)
        if not (change > settings.polished).any():
            break
    return x, change


def _solved(matrices: Complexes, columns: Complexes) -> Any:
    """The solutions (m, n, k) of m linear systems; those of least norm if a matrix is singular."""
    linear: Any = np.linalg  # whose stubs know no stacks of matrices
    try:
        return linear.solve(matrices, columns)
    except np.linalg.LinAlgError:
        return linear.pinv(np.nan_to_num(matrices)) @ columns


def _relative(change: Complexes, x: Complexes) -> Reals:
    """The size of each change relative to the point; not a number where either is none."""
    sizes: Reals = np.abs(change).max(axis=1) / np.abs(x).max(axis=1)
    return sizes
