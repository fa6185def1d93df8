"""The semidefinite relaxation of a quartic on unit quaternions: its cones, solved by Clarabel.

Minimise L(F) over linear functions L of the 35 monomials with L(|q|^4) = 1 whose 10x10 matrix of
moments L(m m^T), m the products q_i q_j, is positive semidefinite. The dual is the largest value v
with F - v |q|^4 = m^T G m for a positive semidefinite G: sums of squares of degree four. It is the
relaxation in the ten entries of r = (1, vec R) by all 21 quadratics of a rotation, as m and r are
linear in each other and both have 20 dimensions of quadratics that vanish.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.errors import MissingToolError
from certreg.objective.quartics import MONOMIALS, PAIRS
from certreg.relaxation.cones import cones_of
from certreg.relaxation.conic import RelaxationStatus, called, matrix_of, status_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Reals = NDArray[np.float64]

SIZE = len(PAIRS)
PLACES = np.array(
    [[MONOMIALS.index(tuple(sorted((*one, *other)))) for other in PAIRS] for one in PAIRS]
)  # (10, 10): which monomial each entry of m m^T is


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MomentSolution:
    """What the solver returned; the numbers are None unless it solved the program, at least nearly.

    said: the solver's own word.
    value: of the relaxation.
    moments: (10, 10), the optimal L(m m^T).
    gram: (10, 10), the dual G.
    """

    status: RelaxationStatus
    said: str
    value: float | None = None
    moments: Reals | None = None
    gram: Reals | None = None


def solve_moments(quartic: Reals) -> MomentSolution:
    """The solution for a quartic (35,) whose largest coefficient is near 1, or zero.

    The tolerances of a solver are absolute as much as relative: far from 1 they mean little.
    """
    try:
        cones = cones_of("quartic")
        # Without refinement a third faster, and in 270 problems as many iterations.
        answer = called(cones, cones.cost @ quartic, refinement=False)
    except MissingToolError as error:
        return MomentSolution(status=RelaxationStatus.UNAVAILABLE, said=str(error))
    said = str(answer.status)
    status = status_of(said, solved="Solved", inaccurate="AlmostSolved")
    if status is RelaxationStatus.FAILED:
        return MomentSolution(status=status, said=said)
    return MomentSolution(
        status=status,
        said=said,
        value=answer.obj_val,
        moments=matrix_of(np.array(answer.s[cones.equalities :]), SIZE),
        gram=matrix_of(np.array(answer.z[cones.equalities :]), SIZE),
    )
