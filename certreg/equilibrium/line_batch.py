"""All equilibria of many problems of general springs at once, in doubles.

Of each problem the sums over its points and the 40 paths to its critical lines are taken in C, all
problems in one call; what is done with their ends runs over arrays. This is floating point: where
`outcome` says that all 40 paths ended apart, the real ends are all equilibria as far as doubles
tell. With `prove` each problem gets the list that `certreg.equilibria` makes, its ends in boxes.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.equilibrium.batch import clouds, require_finite
from certreg.equilibrium.equilibrium_set import unit_double
from certreg.equilibrium.homotopy import proved_list
from certreg.equilibrium.paths import CriticalLines, GatheredEnds, PathsOutcome, many_critical_lines
from certreg.equilibrium.quartics import LEAST_CURVATURE, StackedQuartics
from certreg.exact.dyadic import nearest_double
from certreg.geometry.so3 import rotation_matrix
from certreg.objective.normalisation import levelled
from certreg.objective.quartics import quartic_of_form
from certreg.objective.springs import Springs
from certreg.problem.budget import checked_threads
from certreg.problem.many_springs import (
    ManySpringMoments,
    ManySprings,
    many_spring_moments,
    stated_many,
)
from certreg.problem.springs import GivenSprings
from certreg.results import Brief, Guarantee

if TYPE_CHECKING:
    from fractions import Fraction

    from numpy.typing import ArrayLike, NDArray

    from certreg.equilibrium.line_set import LineSet


Array = Any  # NDArray[np.float64]
PORTION = 64  # problems that a thread takes at a time: 64 ms, and 7 MB for the ends
UNKNOWN_INDEX = -1


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class QuarticSolutions(Brief):
    """All equilibria of each problem, by ascending energy: row j of problem k, j < counts[k].

    What stands behind them is NaN, and -1 in `indices`.

    counts: (count,), how many equilibria are listed.
    quaternions: (count, most, 4), unit, (w, x, y, z). translations: (count, most, 3), target from
        source. energies: (count, most), sum r^T W r at each, infinite where no double holds it.
    indices: (count, most), in how many independent directions the energy falls; 0 is stable. -1
        where a curvature is below 1e-9 of the largest and the list is not proved.
    outcomes: what became of the 40 paths of each problem; only where FOUND are all equilibria
        listed, as far as doubles tell.
    decided: (count,), the list is proved complete, with its energies and indices; never without
        `prove`.
    lists: of each problem what is proved, where that was asked for; else None.
    notes: what the user should know of the springs; row k of problem p counts as p N + k there.
    """

    counts: NDArray[np.int64]
    quaternions: NDArray[np.float64]
    translations: NDArray[np.float64]
    energies: NDArray[np.float64]
    indices: NDArray[np.int8]
    outcomes: tuple[PathsOutcome, ...]
    decided: NDArray[np.bool_]
    lists: tuple[LineSet, ...] | None
    notes: tuple[str, ...]

    @property
    def found(self) -> NDArray[np.bool_]:
        """Whether all 40 paths of a problem ended at isolated lines, (count,); no proof."""
        return np.array([outcome is PathsOutcome.FOUND for outcome in self.outcomes], dtype=bool)

    @property
    def stable(self) -> NDArray[np.int64]:
        """How many of the listed equilibria are stable, (count,)."""
        return (self.indices == 0).sum(axis=1)

    @property
    def guarantee(self) -> Guarantee:
        """Of all rows: proved only where every list is."""
        every = bool(self.decided.all()) and self.lists is not None
        return Guarantee.ENCLOSED if every else Guarantee.NUMERICAL


def solve_many_springs(  # noqa: PLR0913 - each is one question, and has its usual answer
    sources: ArrayLike,
    targets: ArrayLike,
    *,
    normals: ArrayLike | None = None,
    directions: ArrayLike | None = None,
    covariances: ArrayLike | None = None,
    information: ArrayLike | None = None,
    factors: ArrayLike | None = None,
    sigma: ArrayLike | None = None,
    weights: ArrayLike | None = None,
    threads: int = 2,
    prove: bool = False,
    progress: Callable[[int, int], object] | None = None,
) -> QuarticSolutions:
    """All equilibria of many problems of general springs; the same numbers on any threads.

    Floating point unless `prove` is set. The interpreter's lock is free while paths are followed.

    Parameters
    ----------
    sources, targets
        (count, N, 3), or (N, 3) for the same in all.
    normals, directions, covariances, information, factors
        The springs, as for a `RegistrationProblem`: of all problems, or with a leading axis of
        (count,). With several kinds, rows of NaN where a pair has another.
    sigma, weights
        (count, N) or (N,), sigma also a scalar; one of them.
    threads
        How many.
    prove
        Whether the list of each problem is proved, too: some 20 milliseconds each.
    progress
        Called with the number of problems that are done and that of all.

    Returns
    -------
    QuarticSolutions
        And what became of the paths of each problem.

    Raises
    ------
    InvalidProblemError
        For other shapes and values; it names the instance.
    """
    given = many_springs(
        sources,
        targets,
        normals=normals,
        directions=directions,
        covariances=covariances,
        information=information,
        factors=factors,
        sigma=sigma,
        weights=weights,
    )
    threads = checked_threads(threads)

    def solve(start: int) -> _Portion:
        return _solved(given.part(slice(start, start + PORTION)), prove=prove)

    parts: list[_Portion] = []
    with ThreadPoolExecutor(threads) as pool:
        for part in pool.map(solve, range(0, given.count, PORTION)):
            parts.append(part)
            if progress is not None:
                progress(min(len(parts) * PORTION, given.count), given.count)
    return _joined(parts, given)


def many_springs(
    sources: ArrayLike,
    targets: ArrayLike,
    *,
    sigma: ArrayLike | None,
    weights: ArrayLike | None,
    **springs: ArrayLike | None,
) -> ManySprings:
    """The problems as `solve_many_springs` takes them. Raises InvalidProblemError for others.

    springs: fields of `GivenSprings`.
    """
    points, given = clouds(sources, targets, None), GivenSprings(**springs)
    require_finite(points)
    return stated_many(points.sources, points.targets, given, sigma, weights, points.count)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Rows:
    """Equilibria one after another: which problem (m,), and the columns of `QuarticSolutions`."""

    problem: NDArray[np.int64]
    quaternions: NDArray[np.float64]
    translations: NDArray[np.float64]
    energies: NDArray[np.float64]
    indices: NDArray[np.int8]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Portion:
    """What was found of some problems."""

    rows: _Rows
    outcomes: tuple[PathsOutcome, ...]
    lists: tuple[LineSet, ...] | None


@cache
def _quartic_table() -> Array:
    """(35, 100): the coefficients of r^T Q r from the entries of a symmetric Q."""
    table = np.empty((35, 10, 10))
    for i in range(10):
        for j in range(10):
            form = [[0] * 10 for _ in range(10)]
            form[i][j] += 1
            form[j][i] += 1
            table[:, i, j] = np.array(quartic_of_form(form)) / 2.0
    return table.reshape(35, 100)


def _solved(given: ManySprings, *, prove: bool) -> _Portion:
    moments = many_spring_moments(given)
    columns = moments.form.reshape(-1, 100, 1)  # of each by itself: no sum depends on the others
    flat = [levelled(row) for row in (_quartic_table() @ columns)[..., 0]]
    rests = np.array([one.rest for one in flat])
    varied: NDArray[np.int64] = np.flatnonzero(rests.any(axis=1))
    ends = many_critical_lines(rests[varied]) if len(varied) else None
    outcomes = [PathsOutcome.CONSTANT] * given.count
    for k, outcome in zip(varied, ends.outcomes if ends else (), strict=True):
        outcomes[k] = outcome
    scales = np.array([(one.scale, one.level) for one in flat])
    rows = _rows(moments, rests, scales, varied, ends)
    lists = None
    if prove:
        lists = _proved(given, varied, ends, tuple(outcomes))
        rows = _with_proved(rows, lists, given)
    return _Portion(rows=rows, outcomes=tuple(outcomes), lists=lists)


def _rows(
    moments: ManySpringMoments,
    rests: Array,
    scales: Array,
    varied: NDArray[np.int64],
    ends: GatheredEnds | None,
) -> _Rows:
    """The real ends, by problem and ascending energy."""
    place, path = np.nonzero(ends.real) if ends else (np.zeros(0, dtype=int),) * 2
    problem = varied[place]
    q = ends.units[place, path].real if ends else np.zeros((0, 4))
    q = q / np.linalg.norm(q, axis=1, keepdims=True)
    values, _, hessians = StackedQuartics.of(rests).chosen(problem).curvatures(q)
    order = np.lexsort((values, problem))
    problem, q, values, hessians = problem[order], q[order], values[order], hessians[order]
    linear: Any = np.linalg  # whose stubs know no stacks of matrices
    curved = linear.eigvalsh(hessians)
    sizes = np.abs(curved)
    flat = (sizes <= LEAST_CURVATURE * sizes.max(axis=1, keepdims=True)).any(axis=1)
    exponents = moments.weight_exponent + 2 * moments.length_exponent
    energies = np.maximum(scales[problem, 0] * values + scales[problem, 1], 0.0)
    with np.errstate(over="ignore"):
        energies = np.ldexp(energies, exponents[problem])
    rotations = np.moveaxis(np.array(rotation_matrix(list(q.T))), -1, 0).reshape(-1, 3, 3)
    return _Rows(
        problem=problem,
        quaternions=q,
        translations=moments.translations(problem, rotations),
        energies=energies,
        indices=np.where(flat, UNKNOWN_INDEX, (curved < 0.0).sum(axis=1)).astype(np.int8),
    )


def _proved(
    given: ManySprings,
    varied: NDArray[np.integer[Any]],
    ends: GatheredEnds | None,
    outcomes: tuple[PathsOutcome, ...],
) -> tuple[LineSet, ...]:
    """The list of each problem, of the ends that are known where they are good enough."""
    places = {int(k): place for place, k in enumerate(varied)}
    lists: list[LineSet] = []
    for k, outcome in enumerate(outcomes):
        objective, found = Springs.of(given.problem(k)), None
        if ends is not None and outcome is PathsOutcome.FOUND:
            place = places[k]
            lines = CriticalLines(
                points=ends.units[place],
                codes=ends.codes[place],
                quaternions=np.zeros((0, 4)),
                outcome=outcome,
                attempts=1,
            )
            found = proved_list(objective, lines)
        complete = found is not None and found.complete
        lists.append(found if found is not None and complete else proved_list(objective))
    return tuple(lists)


def _with_proved(rows: _Rows, lists: tuple[LineSet, ...], given: ManySprings) -> _Rows:
    """The rows with those of complete lists in the place of theirs."""
    parts = [_picked(rows, ~np.array([one.complete for one in lists])[rows.problem])]
    parts += [
        _of_list(found, k, Springs.of(given.problem(k)))
        for k, found in enumerate(lists)
        if found.complete
    ]
    together = _concatenated(parts)
    return _picked(together, np.argsort(together.problem, kind="stable"))


def _of_list(found: LineSet, k: int, objective: Springs) -> _Rows:
    points = [part for part in found.components if len(part.span) == 1]
    shifts = [objective.best_translation(part.quaternion) for part in points]
    return _Rows(
        problem=np.full(len(points), k, dtype=np.int64),
        quaternions=np.array([unit_double(p.quaternion) for p in points]).reshape(-1, 4),
        translations=np.array([[_double(c) for c in shift] for shift in shifts]).reshape(-1, 3),
        energies=np.array([_double(part.value) for part in points]),
        indices=np.array(
            [UNKNOWN_INDEX if part.index is None else part.index for part in points], dtype=np.int8
        ),
    )


def _double(value: Fraction) -> float:
    nearest = nearest_double(value)
    return np.nan if nearest is None else nearest


def _picked(rows: _Rows, which: NDArray[Any]) -> _Rows:
    return _Rows(**{name: getattr(rows, name)[which] for name in _Rows.__annotations__})


def _concatenated(parts: list[_Rows]) -> _Rows:
    names = _Rows.__annotations__
    return _Rows(**{name: np.concatenate([getattr(p, name) for p in parts]) for name in names})


def _joined(parts: list[_Portion], given: ManySprings) -> QuarticSolutions:
    """The rows of all portions, every problem's in a row of its own."""
    for number, part in enumerate(parts):
        part.rows.problem[:] += number * PORTION
    rows = _concatenated([part.rows for part in parts])
    counts = np.bincount(rows.problem, minlength=given.count)
    most = int(counts.max(initial=0))
    place = np.arange(len(rows.problem)) - np.repeat(np.cumsum(counts) - counts, counts)
    lists = None
    if parts[0].lists is not None:
        lists = tuple(one for part in parts for one in part.lists or ())

    def spread(column: Array, fill: float) -> Array:
        table = np.full((given.count, most, *column.shape[1:]), fill, dtype=column.dtype)
        table[rows.problem, place] = column
        return table

    return QuarticSolutions(
        counts=counts,
        quaternions=spread(rows.quaternions, np.nan),
        translations=spread(rows.translations, np.nan),
        energies=spread(rows.energies, np.nan),
        indices=spread(rows.indices, UNKNOWN_INDEX),
        outcomes=tuple(outcome for part in parts for outcome in part.outcomes),
        decided=np.array(
            [one.complete for one in lists or ()] or [False] * given.count, dtype=bool
        ),
        lists=lists,
        notes=given.notes,
    )
