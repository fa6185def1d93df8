"""The semidefinite programs in CVXPY's words, for any solver that it finds installed.

Beside the road of `conic`, which makes the same cones by itself: another solver is another witness.

That of a quartic on unit quaternions: minimise L(F) over linear functions L of the 35 monomials
with L(|q|^4) = 1 whose 10x10 matrix of moments L(m m^T), m the products q_i q_j, is positive
semidefinite. The dual is the largest value v with F - v |q|^4 = m^T G m for a positive semidefinite
G: sums of squares of degree four. It is the relaxation in the ten entries of r = (1, vec R) by all
21 quadratics of a rotation, as m and r are linear in each other and both have 20 dimensions of
quadratics that vanish.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import library
from certreg.errors import MissingToolError
from certreg.objective.normalisation import norm_fourth
from certreg.objective.quartics import MONOMIALS, PAIRS
from certreg.relaxation.conic import ConicSolution, RelaxationStatus, named, status_of
from certreg.relaxation.qcqp import RelaxationForm, quadratic_program

if TYPE_CHECKING:
    from numpy.typing import NDArray

WHO = "a solver of your choice"
# Where a solver stops short of what is asked of the relaxation by default.
OPTIONS: dict[str, dict[str, Any]] = {
    "SCS": {"eps_abs": 1e-9, "eps_rel": 1e-9, "max_iters": 100_000},
}
SIZE = len(PAIRS)
PLACES = np.array(
    [[MONOMIALS.index(tuple(sorted((*one, *other)))) for other in PAIRS] for one in PAIRS]
)  # (10, 10): which monomial each entry of m m^T is


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StatedProgram:
    """A program in CVXPY's words.

    data: the parameter. matrix: of variables, positive semidefinite. constraints of the problem:
    the normalisation first, the cone last.
    """

    problem: Any
    data: Any
    matrix: Any


def statement(form: RelaxationForm) -> StatedProgram:
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
    return StatedProgram(problem=problem, data=C, matrix=Z)


def quartic_statement() -> StatedProgram:
    """Minimise <F, y>, <|q|^4, y> = 1, the matrix of the moments y positive semidefinite."""
    modelling = library("cvxpy", WHO)
    quartic, y = modelling.Parameter(len(MONOMIALS)), modelling.Variable(len(MONOMIALS))
    matrix = modelling.reshape(y[PLACES.ravel()], (SIZE, SIZE), order="C")
    constraints = [norm_fourth() @ y == 1, matrix >> 0]
    problem = modelling.Problem(modelling.Minimize(quartic @ y), constraints)
    return StatedProgram(problem=problem, data=quartic, matrix=matrix)


def solve_stated(program: StatedProgram, data: NDArray[np.float64], solver: str) -> ConicSolution:
    """As `conic.solve`, by the solver that CVXPY knows by this name.

    Raises MissingToolError where CVXPY is not installed, or finds no solver of the name.
    """
    program.data.value = data
    status, said = outcome(program.problem, solver)
    if status is RelaxationStatus.FAILED:
        return ConicSolution(status=status, said=said)
    first, *_, last = program.problem.constraints
    dual = np.array(last.dual_value)
    return ConicSolution(
        status=status,
        said=said,
        value=float(program.problem.value),
        multiplier=float(first.dual_value),
        matrix=np.array(program.matrix.value),
        dual=(dual + dual.T) / 2.0,
    )


def outcome(problem: Any, solver: str) -> tuple[RelaxationStatus, str]:
    """What a solver made of a problem whose parameters are set, and its own word.

    Raises MissingToolError where CVXPY finds no solver of the name.
    """
    modelling = library("cvxpy", WHO)
    found: list[str] = modelling.installed_solvers()
    if solver.upper() not in found:
        raise MissingToolError(
            f"CVXPY finds no solver {solver!r}: it finds {', '.join(found)}", tool=solver
        )
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
