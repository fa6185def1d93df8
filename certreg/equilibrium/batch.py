r"""All equilibria of many problems at once, and which of the answers doubles are enough for.

For campaigns of millions of instances. Nothing here is a certificate: an instance that is `decided`
has exactly four equilibria, listed in the order of their Morse index, by the bound below and the
theorem that an equilibrium is an eigenvector of the Davenport matrix. The others go the exact way
(`exactly`), one by one.

>>> import numpy as np
>>> rng = np.random.default_rng(0)
>>> source = rng.normal(size=(20, 3))
>>> targets = source + 0.01 * rng.normal(size=(1000, 20, 3))
>>> found = solve_many(source, targets)
>>> bool(found.decided.all()), bool((found.unstable == [0, 1, 2, 3]).all())
(True, True)

The bound. Let u = 2^-53, N points, P_x and P_y the sums of w |x - a|^2 and w |y - b|^2 about the
doubles a, b that the points are shifted by, all over the mass; norms are Frobenius norms.

1. Shifting rounds each difference once, and C is the sum of w (y - b)(x - a)^T less a product of
   the two sums of what is left of the means, whatever a and b are. Each sum has N terms of at most
   five roundings, in any order, and |sum w |y - b| |x - a|^T| <= sqrt(P_x P_y) by Cauchy and
   Schwarz; the sums of what is left are at most sqrt(P_x), sqrt(P_y). So the computed C is off by
   at most 5 g sqrt(P_x P_y), g = (N + 8) u / (1 - (N + 8) u), and S2 by 5 g P_x. (Points, weights
   and sums are over powers of two. What underflows there is less than the tiny `FLOOR` per point.)
2. The Davenport matrix is linear in C, its eigenvalues are sums of three singular values of C with
   signs: |K(E)|_2 <= sqrt(3) |E|. Forming K rounds by at most 5 u |K|.
3. Let V, L be the computed vectors and values, Q the orthogonal factor of V; |V - Q| is at most
   s = |V^T V - I|. Then K Q - Q L is at most |K V - V L| + s (|K| + |L|), the kernel's `residual`,
   which is computed to within 35 u (|K| + |L|), and by Weyl's inequality the k-th eigenvalue of K
   is that close to the k-th entry of L.

So each eigenvalue is known to B = sqrt(3) 5 g sqrt(P_x P_y) + residual + 40 u (|K| + |L|), and if
all neighbours are more than 2 B apart, they are distinct. J is definite then: were the source
collinear, C would have rank one and K double eigenvalues.

The unstable eigenvalues are counted among the twelve of the linearised dynamics: those of the
translation, and the roots of s^2 + mu s + g, g an eigenvalue of the pencil (G, J). The count is
given where the instance is decided and every |g| is larger than its error:

4. With q a vector of V, v = q^T K q and r = K q - v q, q is an exact eigenvector of the symmetric
   K - r q^T - q r^T, which has the same G and eigenvalues within |r| of those of K. So the
   eigenvalues of G are differences of eigenvalues of K to within 2 B; the generated Hessian rounds
   by less than 2^8 u |K|.
5. With J = T T^T, those g are the eigenvalues of T^-1 G T^-T, and an error of G is multiplied by
   |T^-1|^2, at most 1 / j for j below the least eigenvalue of J. That is at least e / P_x, e the
   sum of the principal minors of S2, which is off by at most 2 P_x |E| if S2 is by E. Reducing G
   by the computed T rounds by less than 2^8 u |K| sqrt(2 P_x / j) / j.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.equilibrium.critical_set import by_eigenspaces
from certreg.equilibrium.equilibrium_set import EquilibriumSet, equilibrium_set
from certreg.equilibrium.stability import Oscillations
from certreg.errors import InvalidProblemError
from certreg.native.library import MANY, library_for
from certreg.native.stationary import ManyClouds, StationaryPoses
from certreg.objective.isotropic import Isotropic
from certreg.problem.budget import checked_threads
from certreg.problem.moments import exact_moments
from certreg.problem.motion import DEFAULT_DAMPING, checked_damping
from certreg.problem.problem import RegistrationProblem
from certreg.problem.row_labels import require_same_labels
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


Array = Any  # NDArray[np.float64]
MODES = 12  # of the linearised dynamics
PORTION = 1024  # instances that a thread takes at a time: fewer, and handing over costs more
ROUNDING = 2.0**-53
FLOOR = 2.0**-1000  # far above N times the least normal double
LEAST_SPREAD = 2.0**-400  # mean squares below: squares of their rounding errors would underflow
SLACK = 1.0 + 2.0**-10  # for the roundings in evaluating a bound itself


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Solutions(Brief):
    """The four equilibria of each problem, by descending eigenvalue: row k has Morse index k.

    That holds where `decided`; elsewhere the rows are what doubles make of it.

    quaternions: (count, 4, 4), unit, (w, x, y, z). translations: (count, 4, 3), target from source.
    rmse: (count, 4), sqrt(sum w r^2 / sum w), in the unit of length.
    unstable: (count, 4), of the 12 eigenvalues of the linearised dynamics those with a positive
        real part, counted; -1 where doubles do not decide.
    margins: (count,), the least difference of neighbouring eigenvalues over that of the outermost.
    decided: (count,), proved: four equilibria, and three source points are not collinear. Never
        where a cloud is smaller than 2^-200 of its largest coordinate, points without weight, too.
    eigenvalues: (count, 4, 12) of the linearised dynamics, by descending real part; NaN where J is
        singular to rounding. None unless asked for.
    """

    quaternions: NDArray[np.float64]
    translations: NDArray[np.float64]
    rmse: NDArray[np.float64]
    unstable: NDArray[np.int8]
    margins: NDArray[np.float64]
    decided: NDArray[np.bool_]
    eigenvalues: NDArray[np.complex128] | None

    @classmethod
    def empty(cls, count: int, *, spectrum: bool) -> Solutions:
        """Room for so many problems."""
        return cls(
            quaternions=np.empty((count, 4, 4)),
            translations=np.empty((count, 4, 3)),
            rmse=np.empty((count, 4)),
            unstable=np.empty((count, 4), dtype=np.int8),
            margins=np.empty(count),
            decided=np.empty(count, dtype=np.bool_),
            eigenvalues=np.empty((count, 4, 12), dtype=np.complex128) if spectrum else None,
        )

    def part(self, chosen: slice) -> Solutions:
        """Some of the problems; what is written there is written here."""
        arrays: Any = {f.name: getattr(self, f.name) for f in fields(self)}
        parts: Any = {k: a if a is None else a[chosen] for k, a in arrays.items()}
        return Solutions(**parts)


def solve_many(  # noqa: PLR0913 - each is one question, and has its usual answer
    sources: ArrayLike,
    targets: ArrayLike,
    *,
    weights: ArrayLike | None = None,
    damping: float = DEFAULT_DAMPING,
    threads: int = 2,
    spectrum: bool = False,
    progress: Callable[[int, int], object] | None = None,
) -> Solutions:
    """The equilibria of many problems, on so many threads; the same numbers on any.

    The interpreter's lock is free most of the time.

    Parameters
    ----------
    sources, targets
        (count, N, 3), or (N, 3) for the same in all.
    weights
        (count, N) or (N,), not negative.
    damping
        mu > 0.
    threads
        How many.
    spectrum
        Whether the eigenvalues are computed, too.
    progress
        Called with the number of problems that are done and that of all.

    Returns
    -------
    Solutions
        And for which problems doubles decide.

    Raises
    ------
    InvalidProblemError
        For other shapes and values; it names the instance.
    """
    given = clouds(sources, targets, weights)
    damping, threads = checked_damping(damping), checked_threads(threads)
    solutions = Solutions.empty(given.count, spectrum=spectrum)

    def solve(start: int) -> int:
        chosen = slice(start, start + PORTION)
        some = given.part(chosen)
        found = stationary_poses(some, start)
        _write(solutions.part(chosen), found, some, damping)
        return min(chosen.stop, given.count)

    starts = range(0, given.count, PORTION)
    alone = threads == 1 or len(starts) == 1
    with ThreadPoolExecutor(threads) if not alone else nullcontext() as pool:
        for done in map(solve, starts) if pool is None else pool.map(solve, starts):
            if progress is not None:
                progress(done, given.count)
    return solutions


def exactly(
    source: ArrayLike,
    target: ArrayLike,
    *,
    weights: ArrayLike | None = None,
    damping: float = DEFAULT_DAMPING,
) -> EquilibriumSet:
    """All equilibria of one problem in exact arithmetic: for what is not decided."""
    problem = RegistrationProblem(source, target, weights=weights, damping=damping)
    objective = Isotropic(exact_moments(problem))
    return equilibrium_set(by_eigenspaces(objective), objective, problem.damping)


def clouds(sources: ArrayLike, targets: ArrayLike, weights: ArrayLike | None) -> ManyClouds:
    """The arrays as the engines take them. Raises InvalidProblemError for other shapes."""
    require_same_labels(sources, target=targets)  # of data frames, the same in every instance
    x, y = _points(sources, "sources"), _points(targets, "targets")
    if x.shape[1] != y.shape[1]:
        raise InvalidProblemError(
            f"sources have {x.shape[1]} points and targets {y.shape[1]}: they correspond",
            array="targets",
            value=y.shape[1],
            limit=x.shape[1],
        )
    w = np.ones((1, x.shape[1])) if weights is None else _weights(weights, x.shape[1])
    count = max(len(x), len(y), len(w))
    for name, array in (("sources", x), ("targets", y), ("weights", w)):
        if len(array) not in {1, count}:
            raise InvalidProblemError(
                f"{name} are of {len(array)} instances, other arrays of {count}",
                array=name,
                value=len(array),
                limit=count,
            )
    return ManyClouds(count=count, sources=x, targets=y, weights=w)


def stationary_poses(given: ManyClouds, first: int = 0) -> StationaryPoses:
    """What doubles say of the equilibria of each problem, on one thread.

    Raises InvalidProblemError, which names the instance, counted from `first`, for a number that is
    not finite: it shows in the sums, and nothing else makes a NaN of them. MissingLibraryError
    where there is no compiled code.
    """
    found = library_for(MANY).stationary_poses(given)
    lost = np.isnan(found.cross).any(axis=1)
    if lost.any():
        k = int(np.argmax(lost))
        raise _infinite(given.part(slice(k, k + 1)), first + k)
    return found


def require_finite(given: ManyClouds) -> None:
    """Raises InvalidProblemError, which names the instance, for a number that is not finite."""
    good = np.isfinite(given.sources).all(axis=(1, 2)) & np.isfinite(given.targets).all(axis=(1, 2))
    if not good.all():
        k = int(np.argmin(np.broadcast_to(good, given.count)))
        raise _infinite(given.part(slice(k, k + 1)), k)


def _infinite(one: ManyClouds, number: int) -> InvalidProblemError:
    """The error that says where a number of a problem is not finite."""
    clouds = {"sources": one.sources[0], "targets": one.targets[0]}
    name = next(name for name, rows in clouds.items() if not np.isfinite(rows).all())
    row = int(np.argmin(np.isfinite(clouds[name]).all(axis=1)))
    value = clouds[name][row].tolist()
    message = f"{name} of instance {number}, row {row}, is {value}: every value must be finite"
    return InvalidProblemError(message, array=name, row=row, instance=number, value=value)


def _points(given: ArrayLike, name: str) -> Array:
    array = _doubles(given, name)
    array = array[np.newaxis] if array.ndim == 2 else array
    if array.ndim != 3 or array.shape[2] != 3 or 0 in array.shape:
        raise InvalidProblemError(
            f"{name} have the shape {array.shape}: give (count, N, 3) or (N, 3), none of them 0",
            array=name,
            value=array.shape,
        )
    return array


def _weights(given: ArrayLike, points: int) -> Array:
    array = np.atleast_2d(_doubles(given, "weights"))
    if array.ndim != 2 or array.shape[1] != points:
        raise InvalidProblemError(
            f"weights have the shape {array.shape}: give (count, {points}) or ({points},)",
            array="weights",
            value=array.shape,
        )
    wrong = (array < 0.0).any(axis=1) | ~(array.max(axis=1) > 0.0) | ~np.isfinite(array).all(axis=1)
    if wrong.any():
        k = int(np.argmax(wrong))
        raise InvalidProblemError(
            f"the weights of instance {k} are not finite numbers >= 0, or all of them are zero",
            array="weights",
            instance=k,
            limit=0.0,
        )
    return array


def _doubles(given: ArrayLike, name: str) -> Array:
    try:
        array = np.asarray(given)
    except (ValueError, TypeError) as error:
        raise InvalidProblemError(
            f"{name} are not an array of numbers: {error}", array=name
        ) from error
    if array.dtype.kind not in "fiu":
        raise InvalidProblemError(
            f"{name} have entries of type {array.dtype}: give real numbers",
            array=name,
            value=array.dtype,
        )
    return np.ascontiguousarray(array, dtype=np.float64)


def _write(solutions: Solutions, found: StationaryPoses, some: ManyClouds, damping: float) -> None:
    """Put what follows from the equilibria of some problems where it belongs."""
    bounds = Bounds.of(found, some.sources.shape[1])
    least = (found.values[:, :-1] - found.values[:, 1:]).min(axis=1)
    span = found.values[:, 0] - found.values[:, 3]
    solutions.margins[:] = np.divide(least, span, out=np.zeros_like(least), where=span > 0.0)
    solutions.decided[:] = least > 2.0 * bounds.eigenvalue
    solutions.quaternions[:] = found.vectors
    solutions.translations[:] = found.translations
    solutions.rmse[:] = found.rmse
    modes = Oscillations.of(_springs(found), damping)
    growing = modes.growing
    certain = np.abs(found.ratios).min(axis=2) > bounds.ratio[:, np.newaxis]
    certain &= solutions.decided[:, np.newaxis]
    certain &= growing + modes.decaying == MODES  # none overflowed or underflowed
    solutions.unstable[:] = np.where(certain, growing, -1)
    if solutions.eigenvalues is not None:
        solutions.eigenvalues[:] = modes.eigenvalues


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Bounds:
    """How far what was computed can be from what is, over the mass and in the units of the clouds.

    eigenvalue: (count,), B, of each eigenvalue of K; infinite where squares could underflow.
    ratio: (count,), of each eigenvalue of (G, J); infinite where J may be singular.
    """

    eigenvalue: NDArray[np.float64]
    ratio: NDArray[np.float64]

    @classmethod
    def of(cls, found: StationaryPoses, points: int) -> Bounds:
        """The bounds for problems of so many points."""
        source, target = found.spreads["source"], found.spreads["target"]
        sound = (source > LEAST_SPREAD) & (target > LEAST_SPREAD)
        g = 5.0 * (points + 8) * ROUNDING / (1.0 - (points + 8) * ROUNDING)
        size = 2.0 * np.linalg.norm(found.cross, axis=1)  # of K
        cross = g * np.sqrt(source) * np.sqrt(target) + points * FLOOR
        values = 40.0 * ROUNDING * (size + np.linalg.norm(found.values, axis=1))
        eigenvalue = SLACK * (np.sqrt(3.0) * cross + found.residual + values)
        a, b, c, d, e, f = found.scatter.T
        minors = (a * d - b * b) + (a * f - c * c) + (d * f - e * e)
        with np.errstate(divide="ignore", invalid="ignore"):
            inertia = minors / source - SLACK * 2.0 * (g * source + points * FLOOR)
            reduction = 256.0 * ROUNDING * size * (1.0 + np.sqrt(2.0 * source / inertia))
            ratio = SLACK * (2.0 * eigenvalue + reduction) / inertia
        return cls(
            eigenvalue=np.where(sound, eigenvalue, np.inf),
            ratio=np.where(sound & (inertia > 0.0), ratio, np.inf),
        )


def _springs(found: StationaryPoses) -> Array:
    """The ratios in the units given: G scales as source times target, J as the source squared."""
    exponents = found.exponents[:, 1] - found.exponents[:, 0]
    with np.errstate(over="ignore"):
        return np.ldexp(found.ratios, exponents[:, np.newaxis, np.newaxis])
