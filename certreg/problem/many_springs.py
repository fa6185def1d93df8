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
from certreg.problem.attributes import SHAPES
from certreg.problem.floating_stiffness import (
    LEAST_STIFFNESS,
    FloatingSpringMoments,
    floating_spring_moments,
    hessian_form_of,
    is_settled,
)
from certreg.problem.problem import RegistrationProblem
from certreg.problem.springs import GivenSprings, require_one_noise, stated_springs
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray


Array = Any  # NDArray[np.float64]
SUMS = 73


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ManySprings(Brief):
    """`count` problems of N pairs each; an array of length one is shared by all of them.

    sources, targets: (count or 1, N, 3); springs: (count or 1, N, 6), contiguous doubles. notes:
    what the user should know; row k of problem p counts as p N + k there.
    """

    count: int
    sources: NDArray[np.float64]
    targets: NDArray[np.float64]
    springs: NDArray[np.float64]
    notes: tuple[str, ...]

    @property
    def points(self) -> int:
        """N."""
        return self.sources.shape[1]

    @property
    def arrays(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Sources, targets, springs."""
        return self.sources, self.targets, self.springs

    def part(self, chosen: slice) -> ManySprings:
        """Some of the problems."""
        sources, targets, springs = (a if len(a) == 1 else a[chosen] for a in self.arrays)
        return ManySprings(
            count=len(range(*chosen.indices(self.count))),
            sources=sources,
            targets=targets,
            springs=springs,
            notes=self.notes,
        )

    def problem(self, k: int) -> RegistrationProblem:
        """One of them by itself."""
        source, target, factors = (a[0 if len(a) == 1 else k] for a in self.arrays)
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
    if not given.rows:
        raise InvalidProblemError(
            "no springs were given: give normals, directions, covariances, information or factors "
            "(for one weight per pair: solve_many)",
            array="normals",
        )
    kinds = {name: _of_each(rows, name, n) for name, rows in given.rows.items()}
    extra = {"sigma": sigma, "weights": weights}
    numbers = {name: _scales(a, name, n) for name, a in extra.items() if a is not None}
    springs = {**kinds, **numbers}
    total = max(count, *map(len, springs.values()))
    for name, array in {**springs, "sources": sources, "targets": targets}.items():
        if len(array) not in {1, total}:
            raise InvalidProblemError(
                f"{name} are of {len(array)} instances, other arrays of {total}",
                array=name,
                value=len(array),
                limit=total,
            )
    require_one_noise(sigma, weights)
    times = max(map(len, springs.values()))
    rows = GivenSprings(**{name: _flat(array, times) for name, array in kinds.items()})
    scaled = {name: _flat(array, times) for name, array in numbers.items()}
    try:
        stated = stated_springs(rows, (None, None), times * n, **scaled)
    except InvalidProblemError as error:
        raise _of_instance(error, n, times) from error
    factors = stated.springs.reshape(times, n, 6)
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
        count=total, sources=sources, targets=targets, springs=factors, notes=stated.notes
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
    arrays = [np.ascontiguousarray(a) for a in given.arrays]
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


def _of_each(given: Any, name: str, n: int) -> Array:
    """(count or 1, N, ...): the rows of each problem, or of all."""
    array = _numbers(given, name)
    shape = array.shape
    of_all = shape[:1] == (n,) and shape[1:] in SHAPES[name]
    of_each = shape[1:2] == (n,) and shape[2:] in SHAPES[name]
    if of_all != of_each:
        return array if of_each else array[np.newaxis]
    forms = [str((n, *row)).removeprefix("(") for row in SHAPES[name]]
    wanted = " or ".join(f"({form}" for form in forms), " or ".join(f"(count, {f}" for f in forms)
    message = f"{name} have the shape {shape}: give {wanted[0]} for all, or {wanted[1]}"
    if of_all:
        message = f"{name} have the shape {shape}, which can be read in two ways: give (1, *shape)"
    raise InvalidProblemError(message, array=name, value=shape)


def _flat(array: Array, times: int) -> Array:
    """The rows of all problems, one problem after another."""
    every = np.broadcast_to(array, (times, *array.shape[1:]))
    return np.ascontiguousarray(every).reshape(-1, *array.shape[2:])


def _scales(given: Any, name: str, n: int) -> Array:
    """Sigma or weights, (count or 1, N). Raises InvalidProblemError for what is none of them."""
    array = np.atleast_2d(_numbers(given, name).astype(float))
    try:
        every = np.broadcast_to(array, (len(array), n))
    except ValueError as error:
        raise InvalidProblemError(
            f"{name} have the shape {np.shape(given)}: give ({n},) for all or (count, {n})",
            array=name,
            value=np.shape(given),
        ) from error
    good = np.isfinite(every) & (every > 0.0 if name == "sigma" else every >= 0.0)
    if not good.all():
        instance, row = divmod(int(np.argmin(good)), n)
        raise InvalidProblemError(
            f"{name} of instance {instance}, row {row}, is {every[instance, row]}: give finite "
            f"numbers {'> 0' if name == 'sigma' else '>= 0'}",
            array=name,
            instance=instance,
            row=row,
            value=float(every[instance, row]),
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
