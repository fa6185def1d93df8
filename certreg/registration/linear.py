"""The provers of one weight per pair, by eigenvalues: of a rigid motion, and of a free scale."""

from __future__ import annotations

import logging
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import cached_property
from certreg.certificate.bounds import ExactPose, PoseBounds, pose_bounds, pose_energy
from certreg.certificate.isotropic import RotationState, produce
from certreg.dynamics.integrators import DEFAULT_SETTINGS, SimulationSettings
from certreg.dynamics.simulation import optimal_damping
from certreg.equilibrium.critical_set import by_eigenspaces
from certreg.errors import DegenerateProblemError, InvalidProblemError
from certreg.native.kernels import MissingLibraryError
from certreg.native.loops import Integrator
from certreg.objective.isotropic import Isotropic
from certreg.problem.arrays import row_blocks
from certreg.problem.motion import Scale
from certreg.problem.support import Cell, Verb, refusal
from certreg.registration.agreement import (
    Agreement,
    agreement,
    require_basin,
    require_sound_trajectory,
)
from certreg.registration.ambiguity import equilibria_at
from certreg.registration.covariance import (
    PoseCovariance,
    Residual,
    pose_covariance,
    residual_distances,
    worst_residuals,
)
from certreg.registration.fit import Fit, fit_of
from certreg.registration.optimum import optimal_pose
from certreg.registration.result import Method, PoseWorth, Solution
from certreg.registration.simulation import SimulatedMotion, final_state, simulated_motion
from certreg.registration.squares import NOT_CERTIFIED, SquaresProver
from certreg.relaxation.shor import Relaxation, relax
from certreg.results import Absent

if TYPE_CHECKING:
    from fractions import Fraction

    from certreg.certificate.envelope import Certificate
    from certreg.equilibrium.equilibrium_set import EquilibriumSet
    from certreg.problem.moments import ExactMoments
    from certreg.problem.problem import RegistrationProblem
    from certreg.registration.pipeline import Asked, Work
    from certreg.registration.result import ResidualBlock
    from certreg.registration.robustness import Robustness
    from certreg.registration.row_names import RowNames


LOG = logging.getLogger(__name__)
NO_SCALE_THERE = Absent("the relaxation is of scale 1, not of a free one")
CROSS_CHECK = Integrator.SPLITTING  # a few large steps, however stiff the springs


@dataclass(frozen=True, kw_only=True, eq=False)
class LinearSolution(Solution):
    """What is computed before anything is checked.

    What no proof needs is computed when it is first asked for: the numbers of the equilibria, the
    covariance (why there is none is stated, and not in `absent`), the statistics of the fit.

    problem: as stated, with the damping that was taken.
    relaxation: Absent says why there is none.
    """

    objective: Isotropic
    relaxation: Relaxation | Absent
    agreement: Agreement

    @cached_property
    def equilibria(self) -> EquilibriumSet:  # pyright: ignore[reportIncompatibleMethodOverride]
        """All equilibria of the registration dynamics."""
        found = by_eigenspaces(self.objective)
        return equilibria_at(found, self.objective, self.problem, lambda: self.fit)

    def measured_covariance(self) -> PoseCovariance | Absent:
        """The covariance of the pose, computed now; why there is none."""
        return pose_covariance(self.problem, self.objective)

    def told_robustness(self, found: Robustness) -> Robustness:
        """With the range of a free scale."""
        if self.objective.scaling is None or self.certificate is None:
            return found
        return found.with_scales(self.certificate.body, self.moments)

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

    def worth(self, place: ExactPose, body: Any) -> PoseWorth:
        """What a pose costs, and what a body of a certificate of this problem proves of it."""
        objective = self.objective
        shifted = objective.translation_energy(place.quaternion, place.translation, place.scale)
        energy = pose_energy(objective, place, shifted)
        squares = objective.squares(energy, place.scale)
        return PoseWorth(
            energy=energy,
            mean_square=squares / self.moments.total_weight,
            bounds=None
            if body is None
            else pose_bounds(objective, body, place, shifted=shifted, energy=energy),
        )

    def squares(self, objective: float) -> float:
        """The symmetric scale divides them."""
        return self.objective.squares(objective, self.pose.scale)

    def method_by(self, bounds: PoseBounds) -> Method:
        """Eigenvalues."""
        del bounds
        return Method.SPECTRAL

    def merged(self, own: Any, given: Any) -> Any:
        """Its own body with what one given proves of robustness, and of a free scale."""
        return replace(own, radius=given.radius) if self.objective.scaling is None else given

    def residual_blocks(self) -> Iterator[ResidualBlock]:
        """All rows: slices, distances, and these in standard deviations of weight one."""
        for rows in row_blocks(self.problem.n):
            block = self.problem.block(rows)
            distances = residual_distances(block, self.pose)
            with np.errstate(over="ignore", invalid="ignore"):
                strained = np.where(block.weights > 0, np.sqrt(block.weights) * distances, math.nan)
            yield rows, distances, strained

    def worst_residuals(self, count: int) -> list[Residual]:
        """The correspondences that are farthest apart."""
        return worst_residuals(self.problem, self.pose, count)


@dataclass(frozen=True, slots=True, kw_only=True)
class LinearProposal:
    """The problem, with the damping that was taken, and what was computed of it."""

    problem: RegistrationProblem
    objective: Isotropic
    relaxation: Relaxation | Absent
    trajectory: SimulatedMotion | Absent
    integrator: Integrator | None


class LinearProver(SquaresProver[LinearProposal, LinearSolution]):
    """Of a rigid motion, or a rotation alone."""

    SCALES = frozenset({Scale.NONE})
    PARTS = 3  # exact sums, certificate, checker
    USUAL = CROSS_CHECK  # integrator

    def accepts(self, cell: Cell) -> bool:
        """Whether the scale is its own."""
        return cell.scale in self.SCALES

    def parts(self, asked: Asked) -> int:
        """With relaxation and simulation, where they are asked for."""
        return self.PARTS + bool(asked.relaxation) + bool(asked.simulation)

    def propose(self, problem: RegistrationProblem, asked: Asked, work: Work) -> LinearProposal:
        """Sums, and what other methods come to: eigenvalues need no proposal."""
        objective = Isotropic.of(problem)
        work.done("exact sums")
        problem = self.damped(problem, objective)
        relaxed = trajectory = asked.not_taken
        if asked.relaxation:
            relaxed = self.relaxed(objective, asked.solver)
            work.done("relaxation")
        integrator = asked.integrator(self.USUAL)
        if integrator is not None:
            settings = asked.settings or DEFAULT_SETTINGS
            trajectory = _simulation(objective, problem, integrator, settings)
            work.done("simulation")
        return LinearProposal(
            problem=problem,
            objective=objective,
            relaxation=relaxed,
            trajectory=trajectory,
            integrator=integrator,
        )

    def prove(
        self, problem: RegistrationProblem, proposal: LinearProposal, asked: Asked, work: Work
    ) -> LinearSolution:
        """The certificate, and how well the methods agree."""
        problem, objective, run = proposal.problem, proposal.objective, proposal.integrator
        about = {"damping": problem.damping, "integrator": None if run is None else run.value}
        certificate = self.certificate(proposal, asked.robustness_angle, {**asked.about, **about})
        work.done("certificate")
        solution = LinearSolution(
            problem=problem,
            objective=objective,
            pose=optimal_pose(objective),
            relaxation=proposal.relaxation,
            trajectory=proposal.trajectory,
            agreement=agreement(
                problem,
                objective,
                relaxation=proposal.relaxation,
                trajectory=proposal.trajectory,
            ),
            certificate=certificate,
            absent={"certificate": NOT_CERTIFIED},
        )
        work.lap("compute")
        return solution

    def require_sound(self, proved: LinearSolution, certificate: Certificate[Any]) -> None:
        """Raises ContradictionError where the simulation goes, or ends, where it must not."""
        if not isinstance(proved.trajectory, Absent):
            require_sound_trajectory(proved.objective, certificate.body, proved.trajectory)
            require_basin(certificate.body, proved.trajectory)

    def damped(self, problem: RegistrationProblem, objective: Isotropic) -> RegistrationProblem:
        """The problem with the damping of the fastest decay, where it names none and one is."""
        if problem.damping_given:
            return problem
        try:
            damped = problem.damped(optimal_damping(objective))
        except (DegenerateProblemError, InvalidProblemError) as error:
            LOG.info("damping %g: there is no best one: %s", problem.damping, error)
            return problem
        LOG.info("damping %g, of the fastest decay", damped.damping)
        return damped

    def relaxed(self, objective: Isotropic, solver: str | None) -> Relaxation | Absent:
        """The relaxation, or why there is none; solver: by CVXPY's name, None for Clarabel."""
        relaxed = relax(objective, solver=solver)
        LOG.info("relaxation %s by %s: %s", relaxed.form.value, relaxed.solver, relaxed.status.name)
        return Absent(relaxed.reason) if relaxed.value is None else relaxed

    def certificate(
        self, proposal: LinearProposal, robustness_angle: float | None, about: dict[str, Any]
    ) -> Certificate[Any] | None:
        """Of the kind that proves of such a problem."""
        relaxed, trajectory = proposal.relaxation, proposal.trajectory
        return produce(
            proposal.problem,
            proposal.objective,
            proposal=None if isinstance(relaxed, Absent) else relaxed.proposal,
            state=None if isinstance(trajectory, Absent) else final_state(trajectory),
            robustness_angle=robustness_angle,
            about=about,
        )


class SimilarityProver(LinearProver):
    """Of a free scale, with its own certificate: no relaxation, no best damping, no basin."""

    SCALES = frozenset({Scale.ASYMMETRIC, Scale.SYMMETRIC})
    USUAL = Integrator.MIDPOINT

    def require_sound(self, proved: LinearSolution, certificate: Certificate[Any]) -> None:
        """The same, but that no basin is proved in which it ends."""
        if not isinstance(proved.trajectory, Absent):
            require_sound_trajectory(proved.objective, certificate.body, proved.trajectory)

    def damped(self, problem: RegistrationProblem, objective: Isotropic) -> RegistrationProblem:
        """The problem as it is."""
        del objective
        return problem

    def relaxed(self, objective: Isotropic, solver: str | None) -> Absent:
        """None."""
        del objective, solver
        return NO_SCALE_THERE

    def certificate(
        self, proposal: LinearProposal, robustness_angle: float | None, about: dict[str, Any]
    ) -> Certificate[Any] | None:
        """Of the similarity."""
        problem, objective = proposal.problem, proposal.objective
        return produce(problem, objective, robustness_angle=robustness_angle, about=about)


RIGID = LinearProver()
SIMILARITY = SimilarityProver()


def _simulation(
    objective: Isotropic,
    problem: RegistrationProblem,
    integrator: Integrator,
    settings: SimulationSettings,
) -> SimulatedMotion | Absent:
    """The simulated registration, or why there is none."""
    unmoved = refusal(problem.cell, Verb.MIDPOINT)  # the integrator that takes most
    if unmoved is not None:
        return Absent(unmoved.sentence)
    try:
        return simulated_motion(problem, objective, integrator, settings=settings)
    except (DegenerateProblemError, MissingLibraryError) as error:
        return Absent(str(error))
