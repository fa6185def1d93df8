"""Many problems of general springs as arrays, and their moments in doubles: proposals, no proofs.

All problems have the same number of pairs; what all share is given once.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import cached_property
from certreg.errors import InvalidProblemError
from certreg.native.library import MANY, library_for
from certreg.problem.floating_stiffness import (
    LEAST_STIFFNESS,
    FloatingSpringMoments,
    floating_spring_moments,
    hessian_form_of,
    is_settled,
)
from certreg.problem.problem import RegistrationProblem
from certreg.problem.spring_rows import SHAPES
from certreg.problem.springs import GivenSprings, stated_springs
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray


Array = Any  # NDArray[np.float64]
SUMS = 73


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ManySprings(Brief):
    """`count` problems of N pairs each; an array of length one is shared by all of them.

    sources, targets: (count or 1, N, 3); factors: (count or 1, N, 6), contiguous doubles. notes:
    what the user should know; row k of problem p counts as p N + k there.
    """

    count: int
    sources: NDArray[np.float64]
    targets: NDArray[np.float64]
    factors: NDArray[np.float64]
    notes: tuple[str, ...]

    @property
    def points(self) -> int:
        """N."""
        return self.sources.shape[1]

    def part(self, chosen: slice) -> ManySprings:
        """Some of the problems."""
        arrays = (self.sources, self.targets, self.factors)
        sources, targets, factors = (a if len(a) == 1 else a[chosen] for a in arrays)
        return ManySprings(
            count=len(range(*chosen.indices(self.count))),
            sources=sources,
            targets=targets,
            factors=factors,
            notes=self.notes,
        )

    def problem(self, k: int) -> RegistrationProblem:
        """One of them by itself."""
        arrays = (self.sources, self.targets, self.factors)
        source, target, factors = (a[0 if len(a) == 1 else k] for a in arrays)
        return RegistrationProblem(source, target, factors=factors)


@dataclass(frozen=True, kw_only=True, eq=False)
class ManySpringMoments(Brief):
    """The fields of `FloatingSpringMoments` of many problems, each with a leading (count,)."""

    n: int
    length_exponent: NDArray[np.int64]
    weight_exponent: NDArray[np.int64]
    origin: NDArray[np.float64]
    sums: NDArray[np.float64]

    @cached_property
    def hessian_form(self) -> NDArray[np.float64]:
        """H, (count, 13, 13), as there."""
        # One after another: products of stacks round as their strides have it, which are then
        # the same however many there are.
        return np.ascontiguousarray(np.moveaxis(hessian_form_of(self.sums.T), -1, 0))

    @cached_property
    def _resisted(self) -> NDArray[np.float64]:
        """-S^-1 H_tr, (count, 3, 10): the translation of least energy by r = (1, vec R).

        Along directions whose stiffness counts as none it is 0 from the origins.
        """
        linear: Any = np.linalg  # whose stubs know no stacks of matrices
        H = self.hessian_form
        values, vectors = linear.eigh(H[:, 10:, 10:])
        kept = values > LEAST_STIFFNESS * values[:, -1:]
        inverse = np.divide(1.0, values, out=np.zeros_like(values), where=kept)
        turned = np.swapaxes(vectors, 1, 2)
        found: Any = -(vectors * inverse[:, np.newaxis]) @ (turned @ H[:, 10:, :10])
        return found

    @cached_property
    def form(self) -> NDArray[np.float64]:
        """Q, (count, 10, 10), as there."""
        H = self.hessian_form
        return H[:, :10, :10] + H[:, :10, 10:] @ self._resisted

    def translations(
        self, which: NDArray[np.integer[Any]], rotations: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """The best translations (m, 3), in the user's unit, of problems at rotations (m, 3, 3)."""
        columns = np.swapaxes(rotations, 1, 2).reshape(-1, 9)
        r = np.concatenate([np.ones((len(columns), 1)), columns], axis=1)
        offset = (self._resisted[which] @ r[..., np.newaxis])[..., 0]
        source, target = self.origin[which, :3], self.origin[which, 3:]
        moved = (rotations @ source[..., np.newaxis])[..., 0]
        return target - moved + np.ldexp(offset, self.length_exponent[which, np.newaxis])


def stated_many(
    sources: Array, targets: Array, given: GivenSprings, sigma: Any, weights: Any, count: int
) -> ManySprings:
    """Checked clouds, (count or 1, N, 3), with the springs that a user gave for them.

    The arrays of springs are of all problems, with the shapes that a problem takes, or have a
    leading axis (count,); so have sigma and weights, (N,) or (count, N), sigma also a scalar.
    Raises InvalidProblemError, which names the row and the instance.
    """
    n = sources.shape[1]
    kinds = {name: _numbers(rows, name) for name, rows in given.rows.items()}
    if not kinds:
        raise InvalidProblemError(
            "no springs were given: give normals, directions, covariances, information or factors "
            "(for one weight per pair: solve_many)",
            array="normals",
        )
    several = {name: _has_problems(rows, name, n) for name, rows in kinds.items()}
    extra = {"sigma": sigma, "weights": weights}
    numbers = {k: _numbers(a, k).astype(float) for k, a in extra.items() if a is not None}
    own = [rows for name, rows in kinds.items() if several[name]]
    own += [array for array in numbers.values() if array.ndim == 2]
    leading = {len(array) for array in own}
    total = max(count, *leading) if leading else count
    for name, size in _sizes(kinds, several, numbers, (sources, targets)):
        if size not in {1, total}:
            raise InvalidProblemError(
                f"{name} are of {size} instances, other arrays of {total}",
                array=name,
                value=size,
                limit=total,
            )
    times = total if leading - {1} else 1
    rows = GivenSprings(**{k: _rows(a, times, n, own=several[k]) for k, a in kinds.items()})
    scaled = {name: _scales(array, name, times, n) for name, array in numbers.items()}
    if len(scaled) == 2:
        raise InvalidProblemError(
            "both sigma and weights were given: give one (weights = 1/sigma^2)", array="weights"
        )
    try:
        stated = stated_springs(rows, (None, None), times * n, **scaled)
    except InvalidProblemError as error:
        raise _of_instance(error, n, times) from error
    factors = stated.factors.reshape(times, n, 6)
    empty = ~factors.any(axis=(1, 2))
    if empty.any():
        k = int(np.argmax(empty))
        raise InvalidProblemError(
            f"all springs of instance {k} are zero: no pair counts, every pose is as good",
            array="factors",
            instance=k,
            value=0.0,
        )
    return ManySprings(
        count=total, sources=sources, targets=targets, factors=factors, notes=stated.notes
    )


def many_spring_moments(given: ManySprings) -> ManySpringMoments:
    """The moments of many problems in doubles, in one pass over the points of each.

    A problem whose sums leave the range of doubles, or whose mean is no origin for its springs,
    goes by itself, as `floating_spring_moments`. Raises MissingLibraryError where there is no
    compiled code.
    """
    origins = np.empty((given.count, 6))
    with np.errstate(over="ignore", invalid="ignore"):
        origins[:, :3], origins[:, 3:] = given.sources.mean(axis=1), given.targets.mean(axis=1)
    sums = _sums(given, origins)
    exponents = np.zeros((given.count, 2), dtype=np.int64)
    for k in range(given.count):
        if not is_settled(sums[k]):
            alone: FloatingSpringMoments = floating_spring_moments(given.problem(k))
            sums[k], origins[k] = alone.sums, alone.origin
            exponents[k] = alone.length_exponent, alone.weight_exponent
    length, weight = exponents.T
    return ManySpringMoments(
        n=given.points, length_exponent=length, weight_exponent=weight, origin=origins, sums=sums
    )


def _sums(given: ManySprings, origins: Array) -> Array:
    found = np.empty((given.count, SUMS, 2))
    arrays = [np.ascontiguousarray(a) for a in (given.sources, given.targets, given.factors)]
    strides = np.array([0 if len(a) == 1 else a[0].size for a in arrays], dtype=np.int64)
    pointers = [ctypes.c_void_p(a.ctypes.data) for a in (*arrays, strides, origins, found)]
    sizes = (ctypes.c_int64(given.count), ctypes.c_int64(given.points))
    library_for(MANY).handle.certreg_many_springs(*sizes, *pointers)
    return found.sum(axis=2)


def _numbers(rows: Any, name: str) -> Array:
    try:
        array = np.asarray(rows)
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
    return array


def _has_problems(array: Array, name: str, n: int) -> bool:
    """Whether the first axis is that of the problems."""
    shape = array.shape
    of_all = shape[:1] == (n,) and shape[1:] in SHAPES[name]
    of_each = shape[1:2] == (n,) and shape[2:] in SHAPES[name]
    if of_all != of_each:
        return of_each
    forms = [str((n, *row)).removeprefix("(") for row in SHAPES[name]]
    wanted = " or ".join(f"({form}" for form in forms), " or ".join(f"(count, {f}" for f in forms)
    message = f"{name} have the shape {shape}: give {wanted[0]} for all, or {wanted[1]}"
    if of_all:
        message = f"{name} have the shape {shape}, which can be read in two ways: give (1, *shape)"
    raise InvalidProblemError(message, array=name, value=shape)


def _sizes(
    kinds: dict[str, Array], several: dict[str, bool], numbers: dict[str, Array], clouds: Any
) -> list[tuple[str, int]]:
    """Of how many problems each array is."""
    sizes = [(name, len(rows)) for name, rows in kinds.items() if several[name]]
    sizes += [(name, len(array)) for name, array in numbers.items() if array.ndim == 2]
    return [*sizes, *zip(("sources", "targets"), map(len, clouds), strict=True)]


def _rows(array: Array, times: int, n: int, *, own: bool) -> Array:
    """The rows of all problems, one problem after another."""
    row = array.shape[2:] if own else array.shape[1:]
    several = array if own else array[np.newaxis]
    return np.ascontiguousarray(np.broadcast_to(several, (times, n, *row))).reshape(-1, *row)


def _scales(array: Array, name: str, times: int, n: int) -> Array:
    """Sigma or weights of all rows. Raises InvalidProblemError for what is none of them."""
    try:
        every = np.ascontiguousarray(np.broadcast_to(np.atleast_2d(array), (times, n))).ravel()
    except ValueError as error:
        raise InvalidProblemError(
            f"{name} have the shape {array.shape}: give ({n},) for all or (count, {n})",
            array=name,
            value=array.shape,
        ) from error
    good = np.isfinite(every) & (every > 0.0 if name == "sigma" else every >= 0.0)
    if not good.all():
        row = int(np.argmin(good))
        raise InvalidProblemError(
            f"{name} of instance {row // n}, row {row % n}, is {every[row]}: give finite numbers "
            f"{'> 0' if name == 'sigma' else '>= 0'}",
            array=name,
            instance=row // n,
            row=row % n,
            value=float(every[row]),
        )
    return every


def _of_instance(error: InvalidProblemError, n: int, times: int) -> InvalidProblemError:
    """The same error with the row within its problem."""
    if error.row is None or times == 1:
        return error
    instance, row = divmod(error.row, n)
    words = str(error).replace(f"row {error.row}", f"row {row} of instance {instance}", 1)
    known = {f: getattr(error, f) for f in ("array", "value", "limit")}
    return InvalidProblemError(words, row=row, instance=instance, **known)
