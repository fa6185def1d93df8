"""The cones of the semidefinite programs, read from what `make generate` wrote.

Each program is stated once, in CVXPY's words (`stated`, `stated_quartic`), whose import takes about
a second. What CVXPY makes of them for Clarabel are these few numbers; the tests write them anew and
find the same bytes.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import library

if TYPE_CHECKING:
    from numpy.typing import NDArray

GENERATED = Path(__file__).with_name("generated")
CONES_FILE = "cones.json"
NEED = "the relaxation"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cones:
    """Minimise (cost p) x subject to rows x + s = right, s = 0 first, then s a matrix >= 0.

    The matrix is its upper triangle by columns, times sqrt(2) off the diagonal: so Clarabel keeps
    the inner product. p: what the program depends on, the nine entries of C by rows or the
    coefficients of a quartic.
    """

    size: int  # of the matrix
    equalities: int
    rows: Any  # (equalities + size (size + 1) / 2, unknowns), sparse
    right: NDArray[np.float64]
    cost: NDArray[np.float64]  # (unknowns, parameters)
    curvature: Any  # the program is linear: a sparse zero


@cache
def cones_of(program: str) -> Cones:
    """The cones of a program: a word of `Form`, or "quartic".

    Raises MissingToolError where SciPy is not installed.
    """
    csc_matrix = library("scipy.sparse", NEED).csc_matrix
    given = json.loads((GENERATED / CONES_FILE).read_text("utf-8"))[program]
    right, unknowns = np.array(given["right"]), given["unknowns"]
    cost = np.zeros((unknowns, given["parameters"]))
    first, last, entries = given["cost"]
    cost[first, last] = entries
    row, column, values = given["rows"]
    return Cones(
        size=given["size"],
        equalities=given["equalities"],
        rows=csc_matrix((values, (row, column)), shape=(len(right), unknowns)),
        right=right,
        cost=cost,
        curvature=csc_matrix((unknowns, unknowns)),
    )
