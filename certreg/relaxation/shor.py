"""The semidefinite (Shor) relaxation of the rotation problem max tr(R^T C), solved in doubles.

A relaxation proposes. Its value is right up to the solver's tolerance and on either side of the
truth, so it bounds nothing; certificate/isotropic.py makes a proved bound of its multiplier.
Source: [Briales2017]; tight for this problem, as the quaternion form is an eigenvalue problem.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from certreg.exact.dyadic import power_of_two
from certreg.geometry.so3 import Matrix3, quaternion_from_matrix
from certreg.relaxation.conic import (
    ConicSolution,
    RelaxationStatus,
    SolvedRelaxation,
    rank_and_quaternion,
    solve,
    solver_name,
)
from certreg.relaxation.cvxpy_models import solve_stated, stated_name, statement
from certreg.relaxation.qcqp import RelaxationForm

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.objective.isotropic import Isotropic


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Relaxation(SolvedRelaxation):
    """A solved relaxation.

    unit: what 1 is worth, in units of tr(R^T C): exact, so that no scale is out of range. Where C
        is zero, the spread of the clouds: the solver's rounding must be small beside something.
    value: of the relaxation, times unit; not a bound.
    multiplier: the least nu with nu I - K >= 0 as the solver sees it, times unit; not a bound
        either. None in the rotation form.
    rank: of the optimal Z. With m the multiplicity of the largest eigenvalue of K, the optima span
        m dimensions in the quaternion form and m (m + 1) / 2 in the rotation form, and that is the
        rank of Z: 1 iff the optimum is unique, as far as the solver can tell.
    """

    form: RelaxationForm
    unit: Fraction
    multiplier: float | None

    @property
    def proposal(self) -> Fraction | None:
        """The multiplier in units of tr(R^T C): what `proved_multiplier` asks for."""
        return None if self.multiplier is None else Fraction(self.multiplier) * self.unit


def relax(
    objective: Isotropic, form: str = RelaxationForm.QUATERNION, solver: str | None = None
) -> Relaxation:
    """The relaxation of a problem, in one of the two forms of `RelaxationForm`.

    solver: one that CVXPY finds installed, by its name there; None for Clarabel, called directly.

    Solved for C over a power of two, each entry rounded once, so at any scale. Raises ValueError
    for a form that does not exist, MissingToolError for a solver that does not. Whatever befalls a
    solver is a status.
    """
    form, moments = _known(form), objective.moments
    shift = max(abs(entry) for row in moments.cross for entry in row).bit_length()
    C = _normalised(moments.cross, shift)
    if solver is None:
        solution = solve(form, C, largest=True)
    else:
        solution = solve_stated(statement(form), C, solver)
    unit, status = power_of_two(shift) * moments.cross_unit, solution.status
    if shift == 0:
        unit = moments.spread or unit
        status = RelaxationStatus.DEGENERATE if status is RelaxationStatus.SOLVED else status
    rank, quaternion = rank_and_quaternion(solution.matrix, partial(_quaternion, solution, form))
    return Relaxation(
        form=form,
        solver=solver_name() if solver is None else stated_name(solver),
        solver_word=solution.said,
        status=status,
        unit=unit,
        value=solution.value,
        multiplier=solution.multiplier if form is RelaxationForm.QUATERNION else None,
        rank=rank,
        quaternion_wxyz=quaternion,
    )


def _known(form: str) -> RelaxationForm:
    if form not in set(RelaxationForm):
        raise ValueError(f"form is {form!r}: this version knows {', '.join(RelaxationForm)}")
    return RelaxationForm(form)


def _normalised(cross: Matrix3[int], shift: int) -> NDArray[np.float64]:
    """The matrix over 2^shift: division of integers rounds once, however long they are."""
    return np.array([[entry / (1 << shift) for entry in row] for row in cross])


def _quaternion(
    solution: ConicSolution, form: RelaxationForm, top: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The top eigenvector of Z; or of the rotation nearest to the R of its first column."""
    if form is RelaxationForm.QUATERNION or solution.matrix is None:
        return top
    return quaternion_from_matrix(solution.matrix[1:, 0].reshape(3, 3).T)
