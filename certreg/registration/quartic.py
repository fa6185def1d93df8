"""The prover of general springs: a search for the optimum, squares or cones, their check."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from certreg._loading import cached_property, late
from certreg.certificate.bounds import (
    ExactPose,
    PoseBounds,
    sin2_half_angle_between,
    spring_energy,
    spring_pose_bounds,
)
from certreg.exact.dyadic import half_angle_bound
from certreg.objective.neighbourhood import Neighbourhood
from certreg.objective.springs import Springs
from certreg.problem.lifting import lift
from certreg.registration.covariance import (
    FLAT,
    NOT_UNIQUE,
    OF_SPRINGS,
    PoseCovariance,
    Residual,
    covariance_at,
)
from certreg.registration.curvature import soft_axes
from certreg.registration.fit import Fit, spring_fit
from certreg.registration.optimum import pose_at
from certreg.registration.outlying import LISTED
from certreg.registration.result import UNDECIDED, Method, PoseWorth, Solution
from certreg.registration.squares import NOT_CERTIFIED, SquaresProver
from certreg.registration.unobservable import Freedom
from certreg.registration.weakly_constrained import WeakShift, weak_shifts
from certreg.registration.whitened_residuals import (
    ResidualSums,
    SpringAxes,
    blocks_at,
    source_centre,
)
from certreg.results import Absent

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from certreg.certificate import cones
    from certreg.geometry.pose import Pose
    from certreg.problem.problem import RegistrationProblem
    from certreg.registration.pipeline import Asked, Work
    from certreg.registration.result import ResidualBlock
    from certreg.registration.row_names import RowNames
    from certreg.relaxation import optimum
    from certreg.relaxation.optimum import Found
else:
    # what proposes and proves is loaded where it is called
    cones = late("certreg.certificate.cones")
    optimum = late("certreg.relaxation.optimum")


NOT_LISTED = Absent(
    "general springs have up to forty equilibria, or infinitely many, which `certify` does not "
    "list, as its proof needs none of them: `certreg equilibria` lists them"
)
NOT_SIMULATED = Absent(
    "`certify` does not simulate the motion on general springs: `certreg simulate` does"
)
METHODS = {"springs-sos": Method.SQUARES, "springs-cones": Method.CONES}
SPRING_KINDS = tuple(METHODS)  # of certificates


@dataclass(frozen=True, kw_only=True, eq=False)
class QuarticSolution(Solution):
    """What is computed before anything is checked; statistics when they are first asked for.

    found: the optimum as it was proposed, with the relaxation. quaternion: of the certified
        rotation, integers. pose: the same in doubles, with its best translation.
    """

    pose: Pose
    objective: Springs
    found: Found
    quaternion: tuple[int, int, int, int]

    @cached_property
    def freedom(self) -> Freedom:
        """What the springs leave undetermined, exactly."""
        return Freedom.of(self.objective)

    @cached_property
    def weak_shifts(self) -> tuple[WeakShift, ...]:
        """The shifts that the springs hardly resist: of rounding as much as of the data."""
        return weak_shifts(self.objective)

    @cached_property
    def least(self) -> Fraction:
        """The objective at the certified rotation with its best translation, exactly."""
        return self.objective.energy(self.quaternion)

    @cached_property
    def near(self) -> Neighbourhood:
        """The energy about the optimum, exactly."""
        return Neighbourhood(self.objective.reduced, self.quaternion, self.problem.motion)

    @cached_property
    def centre(self) -> tuple[Fraction, ...]:
        """The mean of the source in doubles, about which nothing cancels."""
        return source_centre(self.problem)

    @cached_property
    def sums(self) -> ResidualSums:
        """What one look at the rows says of the pose."""
        return ResidualSums.of(self.problem, self.pose, LISTED)

    def measured_covariance(self) -> PoseCovariance | Absent:
        """The covariance of the pose, computed now; why there is none."""
        if not self.unique:
            return UNDECIDED if self.unique is None else NOT_UNIQUE
        return covariance_at(
            self.problem,
            self.near,
            self.centre,
            least=self.least,
            carried=lambda: 2 * self.sums.effective_rows >= self.sums.rows,
            conditions=OF_SPRINGS,
        )

    def measured_fit(self, names: RowNames) -> Fit:
        """What the optimum is worth as a fit, computed now."""
        determined = self.unique is True and self.stated_covariance != FLAT
        return spring_fit(
            self.problem, self.sums, least=self.least, determined=determined, names=names
        )

    def worth(self, place: ExactPose, body: Any) -> PoseWorth:
        """What a pose costs, and what a body of a certificate of this problem proves of it."""
        energy, stiffness = spring_energy(self.objective, place), self.sums.stiffness
        measured = 0.0 < stiffness < math.inf
        return PoseWorth(
            energy=energy,
            mean_square=energy / Fraction(stiffness) if measured else None,
            bounds=None if body is None else spring_pose_bounds(self.objective, body, place),
        )

    def method_by(self, bounds: PoseBounds) -> Method:
        """The certificate, or, where that is coarser, the energy itself.

        The energy is a sum of squares, so that no gap is larger than the energy.
        """
        body: Any = self.certificate and self.certificate.body
        own = bounds.greatest_gap - bounds.least_gap < body.gap
        return Method.ENERGY if own and bounds.least_range_squared else METHODS[body.KIND]

    def residual_blocks(self) -> Iterator[ResidualBlock]:
        """All rows: slices, how far each is off along its springs, and sqrt(r^T W r)."""
        for rows, at in blocks_at(self.problem, self.pose):
            yield rows, at.along, at.strained

    def worst_residuals(self, count: int) -> list[Residual]:
        """The rows that are farthest off along their springs, at most ten."""
        return list(self.sums.worst[:count])

    def spring_axes(self, rows: NDArray[np.int64]) -> SpringAxes:
        """Along which axes the springs of some rows pull."""
        return SpringAxes.of(self.problem.pairs.rows(rows).springs)

    @property
    def equilibria(self) -> None:
        """None: `certreg.equilibria` lists those of general springs."""
        return

    @property
    def relaxation_value(self) -> Fraction | None:
        """The value of the relaxation, no bound, in the unit of the objective; None without one."""
        value, levelled = self.found.relaxation.value, self.found.levelled
        if value is None:
            return None
        return (Fraction(value) * levelled.scale + levelled.level) * self.objective.unit

    @property
    def angle_to_relaxation(self) -> float | Absent:
        """Radians from the pose to the rotation that is read off the relaxation."""
        q = self.found.relaxation.quaternion_wxyz
        if q is None:
            return Absent(self.found.relaxation.reason)
        return float(half_angle_bound(sin2_half_angle_between(self.quaternion, lift(q).integers)))

    @cached_property
    def soft_axes(self) -> NDArray[np.float64]:
        """(k, 3), the source's axes about which the energy hardly curves, in doubles."""
        return soft_axes(self.objective, self.quaternion)

    @property
    def near_minima(self) -> int:
        """How many local minima that were met may be optimal, as far as is proved; one at least."""
        if self.certificate is None:
            return 1
        most = self.least + self.certificate.body.gap
        return sum(self.objective.energy(q) <= most for q in self.found.minima) or 1

    @property
    def unique_rotation(self) -> bool | None:
        """Whether one rotation is optimal, as far as that is proved."""
        if self.certificate is not None and self.certificate.body.claims.unique is not None:
            return self.certificate.body.claims.unique
        return False if self.freedom.moves_optimum else None

    @property
    def unique(self) -> bool | None:
        """Whether one pose is optimal: a free shift makes others as good at any rotation."""
        return False if self.freedom.translations else self.unique_rotation

    def complete(self) -> None:
        """Compute all that reads points now: later their file may hold others."""
        _ = self.sums, self.stated_covariance, self.fit


@dataclass(frozen=True, slots=True, kw_only=True)
class QuarticProposal:
    """The optimum in doubles, with the relaxation that led to it."""

    objective: Springs
    found: Found


class QuarticProver(SquaresProver[QuarticProposal, QuarticSolution]):
    """Of a rigid motion; the relaxation is a part of the search, and always taken."""

    PARTS = 4  # exact sums, optimum, certificate, checker

    def propose(self, problem: RegistrationProblem, asked: Asked, work: Work) -> QuarticProposal:
        """The best that was found."""
        objective = Springs.of(problem)
        work.done("exact sums")
        found = optimum.find_optimum(objective, asked.solver)
        work.done("optimum")
        return QuarticProposal(objective=objective, found=found)

    def prove(
        self, problem: RegistrationProblem, proposal: QuarticProposal, asked: Asked, work: Work
    ) -> QuarticSolution:
        """By squares or cones."""
        objective, found = proposal.objective, proposal.found
        certificate = cones.springs_certificate(
            problem,
            objective,
            found,
            robustness_angle=asked.robustness_angle,
            about=asked.about,
        )
        work.done("certificate")
        quaternion = found.quaternion if certificate is None else certificate.body.quaternion
        solution = QuarticSolution(
            problem=problem,
            objective=objective,
            found=found,
            pose=pose_at(objective, quaternion),
            quaternion=quaternion,
            certificate=certificate,
            trajectory=NOT_SIMULATED,
            absent={"certificate": NOT_CERTIFIED, "equilibria": NOT_LISTED},
        )
        work.lap("compute")
        return solution


PROVER = QuarticProver()
