"""General springs: a 3x3 matrix for every pair, W = L L^T with a lower triangular L.

The energy of a pair is (y - R x - t)^T W (y - R x - t), so W stands in the frame of the target. L
is what the digest binds and what every proof is about: exact as it stands, positive semidefinite by
construction, of a rank that one can see. `factors.py` makes it of what a user gives.

A column of an L is a plane, so every problem is one of point to plane, of at most 3 N planes.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import cached_property
from certreg.errors import InvalidProblemError
from certreg.exact.dyadic import weight_of_sigma
from certreg.problem.arrays import (
    finite_doubles,
    first_row,
    mapped_file,
    per_point,
    real_numbers,
    row_blocks,
)
from certreg.problem.attributes import (
    SHAPES,
    absent_rows,
    any_of,
    checked_rows,
    held_rows,
    require,
    require_not_of_source,
    warn_of_unused,
    warn_of_unused_noise,
)
from certreg.problem.factors import (
    LARGEST_ENTRY,
    SMALLEST_ENTRY,
    covariance_factors,
    information_factors,
    line_factors,
    plane_factors,
    weigh,
)
from certreg.problem.terms import Pairs, SprungPairs
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Rows = NDArray[np.float64]


POINT = (1.0, 0.0, 1.0, 0.0, 0.0, 1.0)  # the factor of a pair without a kind: L = I
UNIT_LENGTH = 1e-3  # a normal whose length is further from 1 is told of
BEYOND = "gives a factor outside the doubles: change the unit of length, of clouds and springs"
NO_LENGTH = "is 0, 0, 0: a direction needs a length; remove the pair, or give it the weight 0"
INDEFINITE = "has an eigenvalue below zero: give a matrix that is positive semidefinite"
RANK_BELOW_3 = (
    "has a rank below 3, to rounding: a spring is its inverse; add the noise across, or give "
    "normals, directions or information"
)


@dataclass(frozen=True, kw_only=True, eq=False)
class GivenSprings(Brief):
    """The arguments of a problem that state general springs, as the user gave them."""

    normals: Any = None
    directions: Any = None
    covariances: Any = None
    information: Any = None
    factors: Any = None

    @cached_property
    def rows(self) -> dict[str, Any]:
        """Those that were given, by name."""
        named = {name: getattr(self, name) for name in SHAPES}
        return {name: value for name, value in named.items() if value is not None}

    @property
    def is_noise(self) -> bool:
        """Whether they say how large the noise is, as covariances do and other springs may not."""
        return set(self.rows) == {"covariances"}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StatedSprings(Brief):
    """Factors (N, 6), and what the user should know of them."""

    springs: Rows
    notes: tuple[str, ...]


def stated_springs(
    given: GivenSprings,
    clouds: tuple[Any, Any],
    n: int,
    *,
    sigma: Rows | None = None,
    weights: Rows | None = None,
) -> StatedSprings:
    """The factors of the springs that a user gave for n pairs.

    clouds: source and target, as the user gave them. sigma, weights: (n,) or (1,); L is divided by
    sigma, or multiplied by the root of the weight. Raises InvalidProblemError with the row.
    """
    kinds = {name: _rows_of(given, name, clouds, n) for name in given.rows}
    given_notes = [getattr(value, "spring_note", None) for value in given.rows.values()]
    if set(kinds) == {"factors"} and sigma is None and weights is None:
        rows, _ = kinds["factors"]
        if rows.shape[1] == 6 and mapped_file(rows) is not None:
            return StatedSprings(springs=rows, notes=())
    factors, odd = np.empty((n, 6)), _Odd()
    for part in row_blocks(n):
        over, times = _part(sigma, part), _part(weights, part)
        with np.errstate(over="ignore", under="ignore", invalid="ignore"):
            bare = _mixed(kinds, part, odd)
            made = weigh(bare, over, times)
        counts = any_of(bare) if times is None else any_of(bare) & (times > 0.0)
        good = np.isfinite(made).all(axis=1) & (~counts | any_of(made))
        require(next(iter(kinds)), bare, good, BEYOND, part.start)
        factors[part] = made
    return StatedSprings(
        springs=factors, notes=(*(note for note in given_notes if note), *odd.notes)
    )


def _rows_of(
    given: GivenSprings, name: str, clouds: tuple[Any, Any], n: int
) -> tuple[Rows, NDArray[np.bool_]]:
    """Numbers of one kind, and (n,) where it holds."""
    source, target = clouds
    values, several = given.rows[name], len(given.rows) > 1
    require_not_of_source(values, source, target, name)
    array = held_rows(values, name)
    rows = checked_rows(array, name, n, several=several)
    absent = absent_rows(array.reshape(n, -1)) if several else np.zeros(n, dtype=bool)
    return rows, ~absent


@dataclass(slots=True)
class _Odd:
    """Rows that a note tells of, block by block: how many by its words, and which was the first."""

    counts: Counter[str] = field(default_factory=Counter[str])
    first: dict[str, int] = field(default_factory=dict[str, int])

    def add(self, words: str, start: int, odd: NDArray[np.bool_]) -> None:
        """Of a block that begins at row `start`; words: with {count} and {first}."""
        if odd.any():
            self.counts[words] += int(odd.sum())
            self.first.setdefault(words, start + int(np.argmax(odd)))

    @property
    def notes(self) -> Iterable[str]:
        return (
            words.format(count=count, first=f"the first in row {self.first[words]} (from 0)")
            for words, count in self.counts.items()
        )


def _mixed(
    kinds: dict[str, tuple[Rows, NDArray[np.bool_]]], part: slice, odd: _Odd
) -> NDArray[np.float64]:
    """(k, 6): the factors of some pairs, each of the one kind that holds for it, or of a point."""
    factors = np.tile(POINT, (part.stop - part.start, 1))
    taken = np.zeros(len(factors), dtype=bool)
    for name, (rows, present) in kinds.items():
        here = present[part]
        if (taken & here).any():
            row = part.start + int(np.argmax(taken & here))
            others = [other for other in kinds if other != name and kinds[other][1][row]]
            raise InvalidProblemError(
                f"row {row} (counting from 0) has {others[0]} and {name}: a pair has one kind of "
                "spring, and NaN in the others",
                array=name,
                row=row,
            )
        taken |= here
        chosen = np.asarray(rows[part], dtype=np.float64)
        factors[here] = _made(name, chosen, here, part.start, odd)[here]
    words = "{count} pairs have no kind of spring, {first}: each is a point spring"
    odd.add(words, part.start, ~taken)
    return factors


def _made(
    name: str, rows: Rows, here: NDArray[np.bool_], start: int, odd: _Odd
) -> NDArray[np.float64]:
    """(k, 6): factors of one kind; of rows where it does not hold they mean nothing."""
    if name in {"normals", "directions"}:
        require(name, rows, ~here | any_of(rows), NO_LENGTH, start)
        _note_lengths(name, rows, here, start, odd)
        safe = np.where(here[:, np.newaxis], rows, 1.0)
        return plane_factors(safe) if name == "normals" else line_factors(safe)
    if name == "factors":
        return plane_factors(rows) if rows.shape[1] == 3 else rows
    largest = np.abs(rows).max(axis=1)
    good = (largest == 0.0) | ((largest >= SMALLEST_ENTRY) & (largest <= LARGEST_ENTRY))
    require(name, rows, ~here | good, BEYOND, start)
    return _of_matrices(name, rows, here, start, odd)


def _note_lengths(name: str, rows: Rows, here: NDArray[np.bool_], start: int, odd: _Odd) -> None:
    with np.errstate(over="ignore", under="ignore"):
        lengths = np.sqrt((rows * rows).sum(axis=1))
    words = f"{name}: {{count}} are not of length 1, {{first}}: springs count by its square"
    odd.add(words, start, here & (np.abs(lengths - 1.0) > UNIT_LENGTH))


def _of_matrices(
    name: str, rows: Rows, here: NDArray[np.bool_], start: int, odd: _Odd
) -> NDArray[np.float64]:
    """Factors of information, or of the inverse of covariances."""
    safe = np.where(here[:, np.newaxis], rows, (1.0, 0.0, 0.0, 1.0, 0.0, 1.0))
    found = covariance_factors(safe) if name == "covariances" else information_factors(safe)
    require(name, rows, ~found.indefinite, INDEFINITE, start)
    if name == "covariances":
        require(name, rows, found.ranks == 3, RANK_BELOW_3, start)
    words = f"{name}: {{count}} are singular to rounding, {{first}}: read as of a lower rank"
    odd.add(words, start, here & found.singular)
    return found.lower


def _part(values: Rows | None, part: slice) -> Rows | None:
    """Of one number for each pair those of some; a single one as it is."""
    return values if values is None or len(values) == 1 else np.asarray(values[part], np.float64)


def require_one_noise(sigma: Any, weights: Any) -> None:
    """Raises InvalidProblemError where both were given."""
    if sigma is not None and weights is not None:
        raise InvalidProblemError(
            "both sigma and weights were given: give one (weights = 1/sigma^2)", array="weights"
        )


def given_weights(weights: ArrayLike | None, n: int) -> NDArray[np.float64]:
    """(n,) weights >= 0, not all zero; equal ones take the place of one."""
    array = (
        np.ones(1)
        if weights is None
        else finite_doubles(per_point(weights, "weights", n), "weights")
    )
    row = first_row(array, lambda block: block < 0)
    if row is not None:
        raise InvalidProblemError(
            f"weights[{row}] is {array[row]}: weights must be >= 0",
            array="weights",
            row=row,
            value=float(array[row]),
            limit=0.0,
        )
    if first_row(array, lambda block: block > 0) is None:
        raise InvalidProblemError(
            "all weights are zero: no correspondence counts, so every pose is as good",
            array="weights",
            value=0.0,
        )
    return np.broadcast_to(array, (n,))


def given_sigma(sigma: ArrayLike, n: int) -> NDArray[np.float64]:
    """(n,) or (1,) standard deviations > 0."""
    if np.ndim(sigma) == 0 and not np.isfinite(real_numbers(sigma, "sigma")):
        raise InvalidProblemError(
            f"sigma is {sigma}: a standard deviation must be finite and > 0",
            array="sigma",
            value=sigma,
            limit=0.0,
        )
    array = finite_doubles(per_point(sigma, "sigma", n), "sigma")
    row = first_row(array, lambda block: block <= 0)
    if row is not None:
        place = "sigma" if np.ndim(sigma) == 0 else f"sigma[{row}]"
        raise InvalidProblemError(
            f"{place} is {array[row]}: a standard deviation must be > 0",
            array="sigma",
            row=None if np.ndim(sigma) == 0 else row,
            value=float(array[row]),
            limit=0.0,
        )
    return array


def weights_of_sigma(sigma: ArrayLike, n: int) -> NDArray[np.float64]:
    """(n,) weights in memory, even if the sigmas are mapped; equal ones take the place of one."""
    array = given_sigma(sigma, n)
    distinct, inverse = np.unique(array, return_inverse=True)
    weights = np.empty(len(distinct))
    for i, value in enumerate(distinct.astype(float).tolist()):
        weights[i] = weight_of_sigma(value)
        if not 0.0 < weights[i] < math.inf:
            raise InvalidProblemError(
                f"sigma = {value!r} gives the weight 1/sigma^2 = {weights[i]}, outside the "
                "doubles: change the unit of length, of clouds and sigma alike",
                array="sigma",
                value=value,
            )
    return np.broadcast_to(weights[inverse], (n,))


def stated_pairs(
    clouds: tuple[Rows, Rows],
    given: GivenSprings,
    held: tuple[Any, Any],
    *,
    sigma: ArrayLike | None,
    weights: ArrayLike | None,
) -> Pairs:
    """The pairs of checked clouds (N, 3), with the springs that a user gave for them.

    held: source and target, as the user gave them. General springs are over sigma, or times the
    weights. Raises InvalidProblemError with the row.
    """
    n = len(clouds[0])
    source, target = map(_read_only, clouds)
    if sigma is None and weights is None:
        warn_of_unused_noise(*held, depth=2)
    if not given.rows:
        warn_of_unused(held[1], n, depth=2)
        own = given_weights(weights, n) if sigma is None else weights_of_sigma(sigma, n)
        return Pairs(source=source, target=target, springs=_read_only(own))
    over = None if sigma is None else given_sigma(sigma, n)
    times = None if weights is None else given_weights(weights, n)
    made = stated_springs(given, held, n, sigma=over, weights=times)
    return SprungPairs(
        source=source, target=target, springs=_read_only(made.springs), noted=made.notes
    )


def _read_only(array: Rows) -> Rows:
    view = array.view()
    view.flags.writeable = False
    return view
