"""The semidefinite programs in CVXPY's words, for any solver that it finds installed.

Beside the road of `conic`, which makes the same cones by itself: another solver is another witness.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import library
from certreg.errors import MissingToolError
from certreg.relaxation.conic import ConicSolution, RelaxationStatus, named, status_of
from certreg.relaxation.qcqp import RelaxationForm, quadratic_program

if TYPE_CHECKING:
    from numpy.typing import NDArray

WHO = "a solver of your choice"
# Where a solver stops short of what is asked of the relaxation by default.
OPTIONS: dict[str, dict[str, Any]] = {
    "SCS": {"eps_abs": 1e-9, "eps_rel": 1e-9, "max_iters": 100_000},
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StatedRelaxation:
    """A program in CVXPY's words.

    cross_covariance: the parameter C, (3, 3). solution: the variable Z, (n, n).
    """

    problem: Any
    cross_covariance: Any
    solution: Any


def statement(form: RelaxationForm) -> StatedRelaxation:
    """Maximise <F, Z> / multiple, <N, Z> = 1, <A, Z> = 0 for every quadratic A, Z >= 0, over Z.

    With Z = v v^T this is the quadratic program; what is relaxed is that Z has rank one.
    """
    modelling = library("cvxpy", WHO)
    C = modelling.Parameter((3, 3))
    program = quadratic_program(form, [[C[i, j] for j in range(3)] for i in range(3)])
    Z = modelling.Variable((program.size, program.size), symmetric=True)

    def product(matrix: Any) -> Any:
        return modelling.trace(matrix @ Z)

    objective = product(modelling.bmat([list(row) for row in program.objective]))
    constraints = [
        product(np.array(program.normalisation)) == 1,  # first: so is its multiplier
        *(product(np.array(quadratic)) == 0 for quadratic in program.quadratics),
        Z >> 0,
    ]
    problem = modelling.Problem(modelling.Maximize(objective / program.multiple), constraints)
    return StatedRelaxation(problem=problem, cross_covariance=C, solution=Z)


def solve_stated(form: RelaxationForm, C: NDArray[np.float64], solver: str) -> ConicSolution:
    """As `conic.solve`, by the solver that CVXPY knows by this name.

    Raises MissingToolError where CVXPY is not installed, or finds no solver of the name.
    """
    program = statement(form)
    program.cross_covariance.value = C
    status, said = outcome(program.problem, solver)
    if status is RelaxationStatus.FAILED:
        return ConicSolution(status=status, said=said)
    return ConicSolution(
        status=status,
        said=said,
        value=float(program.problem.value),
        multiplier=float(program.problem.constraints[0].dual_value),
        matrix=np.array(program.solution.value),
    )


def outcome(problem: Any, solver: str) -> tuple[RelaxationStatus, str]:
    """What a solver made of a problem whose parameters are set, and its own word.

    Raises MissingToolError where CVXPY finds no solver of the name.
    """
    modelling = library("cvxpy", WHO)
    found: list[str] = modelling.installed_solvers()
    if solver.upper() not in found:
        message = f"CVXPY finds no solver {solver!r}: it finds {', '.join(found)}"
        raise MissingToolError(message, tool=solver)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of answers that are rough: their status says so
            problem.solve(solver=solver.upper(), **OPTIONS.get(solver.upper(), {}))
    except (modelling.error.SolverError, ValueError) as error:  # it may not know semidefinite cones
        return RelaxationStatus.FAILED, " ".join(str(error).split())
    said = str(problem.status)
    return status_of(said, solved="optimal", inaccurate="optimal_inaccurate"), said


def stated_name(solver: str) -> str:
    """The solver with its version, and who stated the program."""
    return f"{named(solver.upper())}, stated by {named('cvxpy-base')}"
