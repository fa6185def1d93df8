"""The cones of the semidefinite programs, read from what `make generate` wrote.

Each program is stated once, in CVXPY's words (`cvxpy_models`), whose import takes about a second.
What CVXPY makes of them for Clarabel are these few numbers; the tests write them anew and find the
same bytes.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import accumulate
from operator import itemgetter
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

GENERATED = Path(__file__).with_name("generated")
CONES_FILE = "cones.json"
NEED = "the relaxation"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Columns:
    """A sparse matrix by columns: what Clarabel reads of one of SciPy's, by the same names.

    The entries of column k, rows ascending, are those from indptr[k] on, up to indptr[k + 1].
    SciPy's sparse matrices themselves take as long to load as a small problem to certify.
    """

    shape: tuple[int, int]
    indptr: list[int]
    indices: list[int]
    data: list[float]
    has_canonical_format: bool = True

    @classmethod
    def of(cls, entries: Sequence[tuple[int, int, float]], shape: tuple[int, int]) -> Columns:
        """Of rows, columns and values; no place is there twice."""
        ordered = sorted(entries, key=itemgetter(1, 0))
        counts = Counter(column for _, column, _ in ordered)
        return cls(
            shape=shape,
            indptr=list(accumulate((counts[k] for k in range(shape[1])), initial=0)),
            indices=[row for row, _, _ in ordered],
            data=[value for _, _, value in ordered],
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cones:
    """Minimise (cost p) x subject to rows x + s = right, s = 0 first, then s a matrix >= 0.

    The matrix is its upper triangle by columns, times sqrt(2) off the diagonal: so Clarabel keeps
    the inner product. p: what the program depends on, the nine entries of C by rows or the
    coefficients of a quartic.
    """

    size: int  # of the matrix
    equalities: int
    rows: Columns  # (equalities + size (size + 1) / 2, unknowns)
    right: NDArray[np.float64]
    cost: NDArray[np.float64]  # (unknowns, parameters)
    curvature: Columns  # the program is linear: zero


@cache
def cones_of(program: str) -> Cones:
    """The cones of a program: a word of `RelaxationForm`, or "quartic"."""
    given = json.loads((GENERATED / CONES_FILE).read_text("utf-8"))[program]
    right, unknowns = np.array(given["right"]), given["unknowns"]
    cost = np.zeros((unknowns, given["parameters"]))
    first, last, entries = given["cost"]
    cost[first, last] = entries
    entries = list(zip(*given["rows"], strict=True))
    return Cones(
        size=given["size"],
        equalities=given["equalities"],
        rows=Columns.of(entries, (len(right), unknowns)),
        right=right,
        cost=cost,
        curvature=Columns.of([], (unknowns, unknowns)),
    )
