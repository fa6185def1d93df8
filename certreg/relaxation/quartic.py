"""The semidefinite relaxation of a quartic, at any scale, and the rotation that is read off it.

A relaxation proposes. Its value and its Gram matrix are right up to the solver's tolerance, on
either side of the truth, so they bound nothing; a certificate makes a proved bound of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from certreg.geometry.so3 import canonical
from certreg.objective.levelling import levelled
from certreg.objective.quartics import PAIR_PLACE
from certreg.relaxation.conic import RelaxationStatus, solve, solver_name
from certreg.relaxation.cvxpy_models import quartic_statement, solve_stated, stated_name
from certreg.results import Brief

if TYPE_CHECKING:
    from collections.abc import Sequence


Reals = NDArray[np.float64]

RANK_THRESHOLD = 1e-4  # of the largest eigenvalue of the moments; the solver's tolerance is 1e-8
TIMES = np.array(
    [[PAIR_PLACE[min(i, j), max(i, j)] for j in range(4)] for i in range(4)]
)  # (4, 4): where q_i q_j stands among the ten products


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class QuarticRelaxation(Brief):
    """A solved relaxation. The numbers are None where the status says that there are none.

    solver: name and version. solver_word: its own status; where it is missing, what to install.
    value: of the relaxation, in units of the quartic; not a bound.
    gram: G, (10, 10), with F - value |q|^4 = m^T G m up to the solver's tolerance, m the ten
        products q_i q_j in the order of PAIRS.
    rank: number of eigenvalues of the optimal moments above RANK_THRESHOLD times the largest; 1
        where the relaxation found one rotation.
    quaternion_wxyz: (4,), unit, canonical sign: the one nearest to the moments.
    """

    solver: str
    solver_word: str
    status: RelaxationStatus
    value: float | None
    gram: Reals | None
    rank: int | None
    quaternion_wxyz: Reals | None

    @property
    def reason(self) -> str:
        """Why there are no numbers, where there are none; else what became of the solver."""
        unavailable = self.status is RelaxationStatus.UNAVAILABLE
        return self.solver_word if unavailable else self.status.value


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
    rank, quaternion = _rank_and_quaternion(solution.matrix)
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


def _rank_and_quaternion(moments: Reals | None) -> tuple[int | None, Reals | None]:
    """The rank of the moments, and the top eigenvector of the symmetric matrix of the products."""
    if moments is None:
        return None, None
    values, vectors = np.linalg.eigh(moments)
    rank = int((values > RANK_THRESHOLD * values[-1]).sum())
    products = vectors[:, -1][TIMES]
    products *= np.sign(np.trace(products))
    return rank, canonical(np.linalg.eigh(products)[1][:, -1])
