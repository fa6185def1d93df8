"""The semidefinite programs: cones read once per process, solved by Clarabel every time.

A module of its own: the only one that imports Clarabel, where it is used. A program depends on C
through its cost alone, and linearly: a solve is a matrix product and one call of Clarabel, with no
state from solve to solve. What the solver complains of becomes a status here and goes no further.
"""

from __future__ import annotations

import enum
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import library
from certreg.errors import MissingToolError
from certreg.geometry.so3 import canonical
from certreg.relaxation.cones import NEED, Cones, cones_of
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray


SOLVER = "Clarabel"
# How far the solver goes. Data are scaled so that the largest entry is near 1.
GAP_TOLERANCE = 1e-8  # Clarabel's own default
FEASIBILITY_TOLERANCE = 1e-8  # as above
MAX_ITERATIONS = 100  # seven are usual
RANK_THRESHOLD = 1e-4  # of the largest eigenvalue of the optimal matrix


class RelaxationStatus(enum.Enum):
    """Outcome of a relaxation; the value is the message shown to the user."""

    SOLVED = "The relaxation was solved to the solver's tolerance."
    DEGENERATE = (
        "The cross-covariance is zero: every rotation is optimal, "
        "and the relaxation cannot prefer one."
    )
    INACCURATE = (
        "The solver stopped short of its tolerance: the numbers of the relaxation are rough."
    )
    FAILED = "The solver did not solve the relaxation: there are no numbers to report."
    UNAVAILABLE = "A library that the relaxation needs could not be loaded."


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ConicSolution:
    """What the solver returned; the numbers are None unless it solved the program, at least nearly.

    said: the solver's own word.
    value: of the program, in units of its cost. multiplier: of the normalisation, in the same.
    matrix: (n, n), the optimal one, positive semidefinite. dual: (n, n), its multipliers.
    """

    status: RelaxationStatus
    said: str
    value: float | None = None
    multiplier: float | None = None
    matrix: NDArray[np.float64] | None = None
    dual: NDArray[np.float64] | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SolvedRelaxation(Brief):
    """What a solver found. The numbers are None where the status says that there are none.

    solver: name and version. solver_word: its own status; where it is missing, what to install.
    value: of the relaxation; not a bound.
    rank: number of eigenvalues of the optimal matrix above RANK_THRESHOLD times the largest.
    quaternion_wxyz: (4,), unit, canonical sign: the rotation read off that matrix.
    """

    solver: str
    solver_word: str
    status: RelaxationStatus
    value: float | None
    rank: int | None
    quaternion_wxyz: NDArray[np.float64] | None

    @property
    def reason(self) -> str:
        """Why there are no numbers, where there are none; else what became of the solver."""
        unavailable = self.status is RelaxationStatus.UNAVAILABLE
        return self.solver_word if unavailable else self.status.value


def rank_and_quaternion(
    matrix: NDArray[np.float64] | None,
    quaternion_of: Callable[[NDArray[np.float64]], NDArray[np.float64]],
) -> tuple[int | None, NDArray[np.float64] | None]:
    """The rank of an optimal matrix, and the quaternion of its top eigenvector; None of none."""
    if matrix is None:
        return None, None
    values, vectors = np.linalg.eigh(matrix)
    rank = int((values > RANK_THRESHOLD * values[-1]).sum())
    return rank, canonical(quaternion_of(vectors[:, -1]))


def solver_name() -> str:
    """The solver with its version; the bare name where it is not installed."""
    return named(SOLVER)


@cache
def named(solver: str) -> str:
    """A package with its version; the bare name where it is not installed."""
    try:
        return f"{solver} {version(solver.lower())}"
    except ImportError:  # PackageNotFoundError is one
        return solver


def status_of(said: str, *, solved: str, inaccurate: str) -> RelaxationStatus:
    """What a solver's word means, of which these two come with a solution."""
    known = {solved: RelaxationStatus.SOLVED, inaccurate: RelaxationStatus.INACCURATE}
    return known.get(said, RelaxationStatus.FAILED)


def solve(
    program: str, data: NDArray[np.float64], *, largest: bool = False, refinement: bool = True
) -> ConicSolution:
    """The solution of a program of `cones_of` for finite data, the largest near 1, or all zero.

    largest: whether it asks for the most of what its cones hold the opposite of. refinement: as in
    `called`. The tolerances of a solver are absolute as much as relative: far from 1 they mean
    little.
    """
    try:
        cones = cones_of(program)
        answer = called(cones, cones.cost @ data.ravel(), refinement=refinement)
    except MissingToolError as error:
        return ConicSolution(status=RelaxationStatus.UNAVAILABLE, said=str(error))
    said = str(answer.status)
    status = status_of(said, solved="Solved", inaccurate="AlmostSolved")
    if status is RelaxationStatus.FAILED:
        return ConicSolution(status=status, said=said)
    matrix, dual = (np.array(part[cones.equalities :]) for part in (answer.s, answer.z))
    return ConicSolution(
        status=status,
        said=said,
        value=-answer.obj_val if largest else answer.obj_val,
        multiplier=answer.z[0],
        matrix=matrix_of(matrix, cones.size),
        dual=matrix_of(dual, cones.size),
    )


def called(cones: Cones, cost: NDArray[np.float64], *, refinement: bool = True) -> Any:
    """What Clarabel returns. Raises MissingToolError where it is not installed.

    refinement: of the linear systems that it solves.
    """
    solver = library("clarabel", NEED)
    library("scipy.linalg", NEED)  # whose LAPACK it calls
    options = solver.DefaultSettings()
    options.verbose = False
    options.max_iter = MAX_ITERATIONS
    options.iterative_refinement_enable = refinement
    options.tol_gap_abs = options.tol_gap_rel = GAP_TOLERANCE
    options.tol_feas = FEASIBILITY_TOLERANCE
    parts = [solver.ZeroConeT(cones.equalities), solver.PSDTriangleConeT(cones.size)]
    data = (cones.curvature, cost, cones.rows, cones.right, parts, options)
    return solver.DefaultSolver(*data).solve()


def matrix_of(triangle: NDArray[np.float64], size: int) -> NDArray[np.float64]:
    """The symmetric matrix of Clarabel's upper triangle by columns, sqrt(2) off the diagonal."""
    places, over = _places(size)
    return triangle[places] / over


@cache
def _places(size: int) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Where each entry of the matrix stands in the triangle, and over what: (size, size) both."""
    first, last = np.sort(np.indices((size, size)), axis=0)
    return last * (last + 1) // 2 + first, np.where(first == last, 1.0, np.sqrt(2.0))
