"""The relaxation of a quartic in CVXPY's words, for any solver that it finds installed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import library
from certreg.objective.levelling import norm_fourth
from certreg.objective.quartics import MONOMIALS
from certreg.relaxation.conic import RelaxationStatus
from certreg.relaxation.moments import PLACES, SIZE, MomentSolution
from certreg.relaxation.stated import WHO, outcome

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StatedQuartic:
    """The program in CVXPY's words.

    quartic: the parameter F, (35,). moments: the unknowns, (35,). constraints of the problem: the
    normalisation, then the cone.
    """

    problem: Any
    quartic: Any
    moments: Any


def quartic_statement() -> StatedQuartic:
    """Minimise <F, y>, <|q|^4, y> = 1, the matrix of the moments y positive semidefinite."""
    modelling = library("cvxpy", WHO)
    quartic, y = modelling.Parameter(len(MONOMIALS)), modelling.Variable(len(MONOMIALS))
    matrix = modelling.reshape(y[PLACES.ravel()], (SIZE, SIZE), order="C")
    constraints = [norm_fourth() @ y == 1, matrix >> 0]
    problem = modelling.Problem(modelling.Minimize(quartic @ y), constraints)
    return StatedQuartic(problem=problem, quartic=quartic, moments=y)


def solve_stated_quartic(quartic: NDArray[np.float64], solver: str) -> MomentSolution:
    """As `solve_moments`, by the solver that CVXPY knows by this name.

    Raises MissingToolError where CVXPY is not installed, or finds no solver of the name.
    """
    program = quartic_statement()
    program.quartic.value = quartic
    status, said = outcome(program.problem, solver)
    if status is RelaxationStatus.FAILED:
        return MomentSolution(status=status, said=said)
    dual = np.array(program.problem.constraints[1].dual_value)
    return MomentSolution(
        status=status,
        said=said,
        value=float(program.problem.value),
        moments=np.array(program.moments.value)[PLACES],
        gram=(dual + dual.T) / 2.0,
    )
