"""The result of `certify`: what is computed, and what the checker has accepted of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg._loading import cached_property
from certreg.certificate.isotropic import SimilarityBody
from certreg.equilibrium.spectral import by_eigenspaces
from certreg.problem.arrays import row_blocks
from certreg.registration.ambiguity import equilibria_at
from certreg.registration.any_registration import AnyRegistration, AnySolution
from certreg.registration.covariance import (
    pose_covariance,
    residual_distances,
    worst_residuals,
)
from certreg.registration.fit import fit_of
from certreg.registration.simulation import final_state
from certreg.results import (
    Absent,
    present,
)

if TYPE_CHECKING:
    from collections.abc import Iterator
    from fractions import Fraction

    from certreg.certificate.isotropic import RotationState
    from certreg.equilibrium.presentation import EquilibriumSet
    from certreg.objective.isotropic import Isotropic
    from certreg.problem.moments import ExactMoments
    from certreg.registration.agreement import Agreement
    from certreg.registration.any_registration import ResidualBlock
    from certreg.registration.covariance import PoseCovariance, Residual
    from certreg.registration.fit import Fit
    from certreg.registration.robustness import Robustness
    from certreg.registration.row_names import RowNames
    from certreg.registration.simulation import SimulatedMotion
    from certreg.relaxation.shor import Relaxation


@dataclass(frozen=True, kw_only=True, eq=False)
class Solution(AnySolution):
    """What is computed before anything is checked.

    What no proof needs is computed when it is first asked for: the numbers of the equilibria, the
    covariance (why there is none is stated, and not in `absent`), the statistics of the fit.

    problem: as stated, with the damping that was taken.
    relaxation, trajectory: Absent says why there is none.
    """

    objective: Isotropic
    relaxation: Relaxation | Absent
    trajectory: SimulatedMotion | Absent
    agreement: Agreement

    @cached_property
    def equilibria(self) -> EquilibriumSet:
        """All equilibria of the registration dynamics."""
        found = by_eigenspaces(self.objective)
        return equilibria_at(found, self.objective, self.problem, lambda: self.fit)

    def measured_covariance(self) -> PoseCovariance | Absent:
        """The covariance of the pose, computed now; why there is none."""
        return pose_covariance(self.problem, self.objective)

    def told_robustness(self, found: Robustness) -> Robustness:
        """With the range of a free scale."""
        body = None if self.certificate is None else self.certificate.body
        return found.with_scales(body, self.moments) if isinstance(body, SimilarityBody) else found

    def measured_fit(self, names: RowNames) -> Fit:
        """What the optimum is worth as a fit, computed now."""
        covariance = self.stated_covariance
        return fit_of(self.problem, self.objective, self.pose, covariance, names=names)

    @property
    def unique(self) -> bool:
        """Whether there is one optimal pose: of one weight per pair that is always decided."""
        return self.objective.classification.unique

    @property
    def unique_rotation(self) -> bool:
        """The same: to a rotation one translation is best."""
        return self.unique

    def complete(self) -> None:
        """Compute all that reads points now: later their file may hold others."""
        _ = self.equilibria, self.stated_covariance, self.fit

    @property
    def moments(self) -> ExactMoments:
        """The sums over the points, exactly."""
        return self.objective.moments

    @property
    def energy_unit(self) -> Fraction:
        """What the trajectory's energies are worth in objective units."""
        run = self.trajectory
        return self.moments.total_weight if isinstance(run, Absent) else run.energy_unit

    def ended_in(self, state: RotationState) -> bool:
        """Whether a simulation was run and ended in exactly this state."""
        trajectory = self.trajectory
        return not isinstance(trajectory, Absent) and final_state(trajectory) == state


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Registration(AnyRegistration):
    """The result of `certify`: a solution and what the checker has accepted of it.

    Attributes
    ----------
    problem, solution
        What was asked, and what was found.
    objective
        sum w |y - R x - t|^2 at `pose`; None where no double holds it.
    rmse
        sqrt(objective / sum w), in the unit of length.
    bounds
        Proved of `pose` as reported, rounding included; None if nothing is proved.
    limits
        Of the bounds, within which the pose is called certified.
    verdict
        The checker's, with the theorems in its words; None if there is no certificate.
    timings
        Seconds per phase.
    absent
        Why an attribute is None, by its name.
    """

    solution: Solution

    __repr__ = AnyRegistration.__repr__

    @property
    def equilibria(self) -> EquilibriumSet:
        """All equilibria of the registration dynamics."""
        return self.solution.equilibria

    @property
    def trajectory(self) -> SimulatedMotion | None:
        """The simulated motion; None where none was taken."""
        return present(self.solution.trajectory)

    @property
    def degrees_of_freedom(self) -> int:
        """Of the residuals, all parameters of the pose counted."""
        return self.problem.degrees_of_freedom

    def residual_blocks(self) -> Iterator[ResidualBlock]:
        """All rows: slices, distances, and these in standard deviations of weight one."""
        for rows in row_blocks(self.problem.n):
            block = self.problem.block(rows)
            distances = residual_distances(block, self.pose)
            with np.errstate(over="ignore", invalid="ignore"):
                strained = np.where(block.weights > 0, np.sqrt(block.weights) * distances, math.nan)
            yield rows, distances, strained

    def worst_residuals(self, count: int) -> list[Residual]:
        """The correspondences that are farthest apart at `pose`.

        Parameters
        ----------
        count
            How many.

        Returns
        -------
        list[Residual]
            Rows and distances, the largest first; of equal ones the first row.
        """
        return worst_residuals(self.problem, self.pose, count)
