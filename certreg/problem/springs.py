"""General springs: a 3x3 matrix for every pair, W = L L^T with a lower triangular L.

The energy of a pair is (y - R x - t)^T W (y - R x - t), so W stands in the frame of the target. L
is what the digest binds and what every proof is about: exact as it stands, positive semidefinite by
construction, of a rank that one can see. How L comes from what a user gives is written here in
single operations on doubles (+ - * / and square roots, none fused, in this order), so that other
languages make the same bits of it.

A column of an L is a plane: `normals` are taken as they are, one column each.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.errors import InvalidProblemError
from certreg.problem.arrays import finite_doubles, mapped_file, real_numbers, row_blocks
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray

SPRINGS_PREFIX = b"certreg-springs/1\0"
ENTRIES = ("l11", "l21", "l22", "l31", "l32", "l33")  # of L, by rows
KINDS = {1: "plane", 2: "line", 3: "full"}  # by rank, where all pairs have the same


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GivenSprings(Brief):
    """The arguments of a problem that state general springs, as the user gave them."""

    normals: Any = None
    factors: Any = None

    @property
    def rows(self) -> dict[str, Any]:
        """Those that were given, by name."""
        named = {"normals": self.normals, "factors": self.factors}
        return {name: value for name, value in named.items() if value is not None}


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringSummary(Brief):
    """What kind of springs a problem has.

    kind: "plane", "line" or "full" where all that count have the rank 1, 2 or 3, else "mixed".
    ranks: how many springs have the rank 0, 1, 2, 3; those of rank 0 do not count.
    notes: what the user should know.
    """

    kind: str
    ranks: tuple[int, int, int, int]
    notes: tuple[str, ...] = ()


def spring_factors(
    given: GivenSprings,
    n: int,
    *,
    sigma: NDArray[np.float64] | None = None,
    weights: NDArray[np.float64] | None = None,
) -> NDArray[np.float64]:
    """(n, 6): the entries l11, l21, l22, l31, l32, l33 of every L.

    sigma, weights: (n,) or (1,); L is divided by sigma, or multiplied by the root of the weight.
    Raises InvalidProblemError with the row.
    """
    if len(given.rows) != 1:
        message = f"{' and '.join(given.rows)} were given: give one kind of springs"
        raise InvalidProblemError(message, array=next(iter(given.rows)))
    ((name, values),) = given.rows.items()
    array = real_numbers(values, name)
    width = 6 if name == "factors" else 3
    if array.shape != (n, width):
        message = f"{name} has shape {array.shape}: expected ({n}, {width}), one row per pair"
        raise InvalidProblemError(message, array=name, value=array.shape, limit=(n, width))
    rows = finite_doubles(array, name)
    if name == "factors" and mapped_file(rows) is not None and sigma is None and weights is None:
        return rows
    factors = np.zeros((n, 6))
    for part in row_blocks(n):
        factors[part] = rows[part] if name == "factors" else plane_factors(rows[part])
        _weigh(factors[part], part, sigma, weights)
    if name == "normals":
        _require_lengths(rows, name)
    return factors


def plane_factors(normals: NDArray[np.float64]) -> NDArray[np.float64]:
    """(k, 6): L = (n, 0, 0), the normals (k, 3) as they are: W = n n^T."""
    factors = np.zeros((len(normals), 6))
    factors[:, [0, 1, 3]] = normals
    return factors


def _weigh(
    factors: NDArray[np.float64],
    part: slice,
    sigma: NDArray[np.float64] | None,
    weights: NDArray[np.float64] | None,
) -> None:
    """Divides by sigma, or multiplies by the root of the weight, in place: the last operation."""
    if sigma is not None:
        factors /= sigma[part, np.newaxis] if len(sigma) > 1 else sigma[0]
    if weights is not None:
        factors *= np.sqrt(weights[part, np.newaxis] if len(weights) > 1 else weights[0])
    factors += 0.0  # -0.0 + 0.0 is 0.0: one problem, one digest


def _require_lengths(rows: NDArray[np.float64], name: str) -> None:
    for part in row_blocks(len(rows)):
        empty = ~rows[part].any(axis=1)
        if empty.any():
            row = part.start + int(np.argmax(empty))
            message = (
                f"{name} row {row} (counting from 0) is 0, 0, 0: a direction needs a length; "
                "remove the pair, or give it the weight 0"
            )
            raise InvalidProblemError(message, array=name, row=row, value=[0.0] * 3)


def summary_of(factors: NDArray[np.float64]) -> SpringSummary:
    """The kind of springs, by the exact ranks of their factors (N, 6).

    Raises InvalidProblemError where none counts.
    """
    counts = np.zeros(4, dtype=np.int64)
    for part in row_blocks(len(factors)):
        counts += np.bincount(ranks_of(factors[part]), minlength=4)
    present = [rank for rank in (1, 2, 3) if counts[rank]]
    if not present:
        message = "all springs are zero: no correspondence counts, so every pose is as good"
        raise InvalidProblemError(message, array="factors", value=0.0)
    kind = KINDS[present[0]] if len(present) == 1 else "mixed"
    zero, one, two, three = counts.tolist()
    return SpringSummary(kind=kind, ranks=(zero, one, two, three))


def ranks_of(factors: NDArray[np.float64]) -> NDArray[np.int64]:
    """(k,): the exact rank of every L.

    Where l11 is not zero, the first column is independent of the others, which have the rank of
    [[l22, 0], [l32, l33]]. Else L has the rank of its other rows (l21, l22, 0), (l31, l32, l33).
    """
    l11, l21, l22, l31, l32, l33 = (column != 0.0 for column in factors.T)
    rest = (l22 | l32 | l33).astype(np.int64) + (l22 & l33)
    upper, lower = l21 | l22, l31 | l32 | l33
    other = (upper | lower).astype(np.int64) + (upper & l33)
    for row in np.flatnonzero(~l11 & upper & lower & ~l33):
        _, a, b, c, d, _ = map(Fraction, factors[row].tolist())
        other[row] += a * d != b * c
    other[l11] = 1 + rest[l11]
    return other
