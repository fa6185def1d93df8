"""The semidefinite relaxation of a quartic, at any scale, and the rotation that is read off it.

A relaxation proposes. Its value and its Gram matrix are right up to the solver's tolerance, on
either side of the truth, so they bound nothing; a certificate makes a proved bound of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from certreg.objective.normalisation import levelled
from certreg.objective.quartics import PAIR_PLACE
from certreg.relaxation.conic import SolvedRelaxation, rank_and_quaternion, solve, solver_name
from certreg.relaxation.cvxpy_models import quartic_statement, solve_stated, stated_name

Reals = NDArray[np.float64]

TIMES = np.array(
    [[PAIR_PLACE[min(i, j), max(i, j)] for j in range(4)] for i in range(4)]
)  # (4, 4): where q_i q_j stands among the ten products


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class QuarticRelaxation(SolvedRelaxation):
    """A solved relaxation.

    value: of the relaxation, in units of the quartic; not a bound.
    gram: G, (10, 10), with F - value |q|^4 = m^T G m up to the solver's tolerance, m the ten
        products q_i q_j in the order of PAIRS.
    rank: of the optimal moments; 1 where the relaxation found one rotation.
    """

    gram: Reals | None


def relax_quartic(
    coefficients: Sequence[float] | Reals, solver: str | None = None
) -> QuarticRelaxation:
    """The relaxation of a quartic of 35 finite coefficients.

    solver: one that CVXPY finds installed, by its name there; None for Clarabel, called directly.

    Raises MissingToolError for a solver that does not exist. Whatever befalls a solver is a status.
    """
    quartic = levelled(coefficients)
    rest = quartic.rest
    if solver is None:
        # Without refinement a third faster, and in 270 problems as many iterations.
        solution = solve("quartic", rest, refinement=False)
    else:
        solution = solve_stated(quartic_statement(), rest, solver)
    rank, quaternion = rank_and_quaternion(solution.matrix, _nearest)
    value, gram = solution.value, solution.dual
    return QuarticRelaxation(
        solver=solver_name() if solver is None else stated_name(solver),
        solver_word=solution.said,
        status=solution.status,
        value=None if value is None else quartic.scale * value + quartic.level,
        gram=None if gram is None else quartic.scale * gram,
        rank=rank,
        quaternion_wxyz=quaternion,
    )


def _nearest(top: Reals) -> Reals:
    """The top eigenvector of the symmetric matrix of the ten products."""
    products = top[TIMES]
    products *= np.sign(np.trace(products))
    return np.linalg.eigh(products)[1][:, -1]
