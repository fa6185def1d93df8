"""Moments of general springs in doubles, in one pass over the points: proposals, never proofs.

Deviations from an origin near both means are summed, so that offsets of 1e8 cost no digits; where a
sum leaves the range of doubles, of numbers over powers of two, so that scales of 1e+-150 cost none.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import cached_property
from certreg.native.library import library_if_any
from certreg.problem.arrays import row_blocks
from certreg.problem.exact_sums import UPPER
from certreg.problem.factors import lower_triangles
from certreg.problem.floating_sums import total
from certreg.problem.moments import LARGEST_LEVER, LEAST_SUM, MOST_SUM, PASSES, near_mean
from certreg.problem.stiffness import COORDINATES
from certreg.problem.terms import Pairs, SprungPairs
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.problem.problem import RegistrationProblem


LEAST_STIFFNESS = 1e-13  # of the largest eigenvalue of S: below, a direction counts as free
FULL = tuple(UPPER.index((min(a, b), max(a, b))) for a, b in product(range(3), repeat=2))
TRACE = (0, 3, 5)  # the diagonal among the six entries


@dataclass(frozen=True, kw_only=True, eq=False)
class FloatingSpringMoments(Brief):
    """Sums over the points in doubles, of deviations from an origin, in the order of `SpringSums`.

    Lengths are over 2^length_exponent, W over 2^weight_exponent; origin: (6,), of source and
    target, in the user's unit.
    """

    n: int
    length_exponent: int
    weight_exponent: int
    origin: NDArray[np.float64]
    sums: NDArray[np.float64]

    @cached_property
    def hessian_form(self) -> NDArray[np.float64]:
        """H, 13x13, with f = z^T H z for z = (1, vec R, t - target origin + R source origin)."""
        return hessian_form_of(self.sums)

    @cached_property
    def form(self) -> NDArray[np.float64]:
        """Q, 10x10: the energy r^T Q r at the best translation, in 2^(weight + 2 length).

        Directions whose stiffness is below 1e-13 of the largest count as free.
        """
        H = self.hessian_form
        values, vectors = np.linalg.eigh(H[10:, 10:])
        kept = values > LEAST_STIFFNESS * values[-1]
        arms = H[:10, 10:] @ vectors[:, kept]
        return H[:10, :10] - (arms / values[kept]) @ arms.T


def hessian_form_of(sums: NDArray[np.float64]) -> NDArray[np.float64]:
    """H, (13, 13, ...), of sums (73, ...) about an origin."""
    H = np.zeros((13, 13, *sums.shape[1:]))
    source, scatter = sums[6:24].reshape(6, 3, -1), sums[24:60].reshape(6, 6, -1)
    cross = sums[63:72].reshape(3, 3, *sums.shape[1:])
    H[0, 0] = sums[72]
    for a, b in product(range(3), repeat=2):
        spring, here = FULL[3 * a + b], (slice(1 + a, 10, 3), slice(1 + b, 10, 3))
        H[10 + a, 10 + b] = sums[spring]
        lever = source[spring].reshape(3, *sums.shape[1:])
        H[1 + a : 10 : 3, 10 + b] = H[10 + b, 1 + a : 10 : 3] = lever
        H[here] = scatter[spring][list(FULL)].reshape(3, 3, *sums.shape[1:])
    H[0, 1:10] = H[1:10, 0] = -cross.swapaxes(0, 1).reshape(9, *sums.shape[1:])
    H[0, 10:] = H[10:, 0] = -sums[60:63]
    return H


def floating_spring_moments(problem: RegistrationProblem) -> FloatingSpringMoments:
    """The moments of general springs in doubles, in one pass over the points.

    More where the mean turns out to be far from that of a few points, or sums leave the range.
    """
    origin = np.concatenate([near_mean(problem.source), near_mean(problem.target)])
    exponents, sums = (0, 0), _summed(problem, origin, (0, 0))
    if not _in_range(sums):
        exponents = _exponents(problem, origin)
        sums = _summed(problem, origin, exponents)
    for _ in range(PASSES - 1):
        shift = _shift(sums)
        if shift is None:
            break
        origin = origin + np.ldexp(shift, exponents[0])
        sums = _summed(problem, origin, exponents)
    return FloatingSpringMoments(
        n=problem.n,
        length_exponent=exponents[0],
        weight_exponent=2 * exponents[1],
        origin=origin,
        sums=sums,
    )


def _summed(
    problem: RegistrationProblem, origin: NDArray[np.float64], exponents: tuple[int, int]
) -> NDArray[np.float64]:
    """The sums over all points; infinite or NaN where no double holds them."""
    parts = [_of_block(block, origin, exponents) for block in _blocks(problem)]
    table = np.concatenate(parts, axis=1)
    return np.array([total(row) for row in table.tolist()])


def _blocks(problem: RegistrationProblem) -> Iterator[Pairs]:
    return map(problem.block, row_blocks(problem.n))


def _of_block(
    block: Pairs, origin: NDArray[np.float64], exponents: tuple[int, int]
) -> NDArray[np.float64]:
    """(73, 2), values and what rounding left of them; (73, 1) where nothing is compiled."""
    if exponents != (0, 0):
        block, origin = _over(block, origin, exponents), np.zeros(6)
    library = library_if_any()
    if library is None:
        return _summed_in_numpy(block, origin)[:, np.newaxis]
    sums = np.empty((len(COORDINATES), 2))
    arrays = (block.source, block.target, block.springs, origin, sums)
    pointers = [ctypes.c_void_p(array.ctypes.data) for array in arrays]
    library.handle.certreg_springs(ctypes.c_int64(len(block.source)), *pointers)
    return sums


def _over(block: Pairs, origin: NDArray[np.float64], exponents: tuple[int, int]) -> Pairs:
    """Deviations and factors over powers of two, without overflow: first halved, then the rest."""
    length, factor = exponents
    source, target = (
        np.ldexp(0.5 * side - 0.5 * part, 1 - length)
        for side, part in ((block.source, origin[:3]), (block.target, origin[3:]))
    )
    return SprungPairs(source=source, target=target, springs=np.ldexp(block.springs, -factor))


def _summed_in_numpy(block: Pairs, origin: NDArray[np.float64]) -> NDArray[np.float64]:
    """(73,): the sums, where nothing is compiled."""
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        x, y = block.source - origin[:3], block.target - origin[3:]
        L = lower_triangles(block.springs)
        W = L @ L.transpose(0, 2, 1)
        six = W.reshape(-1, 9)[:, (0, 1, 2, 4, 5, 8)]
        squares = np.stack([x[:, j] * x[:, k] for j, k in UPPER], axis=1)
        pulls = (W @ y[:, :, np.newaxis])[:, :, 0]
        parts = (six.sum(axis=0), six.T @ x, six.T @ squares)
        parts += (pulls.sum(axis=0), pulls.T @ x, (pulls * y).sum())
    return np.concatenate([np.ravel(part) for part in parts])


def is_settled(sums: NDArray[np.float64]) -> bool:
    """Whether sums are in the range of doubles, and about an origin that is near the means."""
    return _in_range(sums) and _shift(sums) is None


def _in_range(sums: NDArray[np.float64]) -> bool:
    """Whether the squares that are summed neither vanish nor overflow, nor their products."""
    diagonal = list(TRACE)
    scatter = sums[24:60].reshape(6, 6)[np.ix_(diagonal, diagonal)].sum()
    squares = map(float, (sums[diagonal].sum(), sums[72], scatter))
    return all(LEAST_SUM <= s <= MOST_SUM for s in squares)


def _exponents(problem: RegistrationProblem, origin: NDArray[np.float64]) -> tuple[int, int]:
    """Exponents of powers of two above all deviations and all factors."""
    farthest, most = 0.0, 0.0
    for block in _blocks(problem):
        for side, part in ((block.source, origin[:3]), (block.target, origin[3:])):
            farthest = max(farthest, float(np.abs(0.5 * side - 0.5 * part).max()))
        most = max(most, float(np.abs(block.springs).max()))
    return math.frexp(farthest)[1] + 1, math.frexp(most)[1]


def _shift(sums: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """From the origin to the means, with the traces of W as masses; None where that is near.

    The mean of the target is where it would be if all springs pulled at it alike: W y over S.
    """
    diagonal = list(TRACE)
    mass = float(sums[diagonal].sum())
    source = sums[6:24].reshape(6, 3)[diagonal].sum(axis=0) / mass
    radius = float(sums[24:60].reshape(6, 6)[np.ix_(diagonal, diagonal)].sum()) / mass
    stiffness = sums[list(FULL)].reshape(3, 3)
    solved: Any = np.linalg.lstsq(stiffness, sums[60:63], rcond=LEAST_STIFFNESS)
    target: NDArray[np.float64] = solved[0]
    pull = float(target @ stiffness @ target)
    near = float(source @ source) <= LARGEST_LEVER * (radius - float(source @ source))
    near = near and pull <= LARGEST_LEVER * max(float(sums[72]) - pull, 0.0)
    shift = np.concatenate([source, target])
    return None if near or not np.isfinite(shift).all() or not shift.any() else shift
