"""The provers of one weight per pair, by eigenvalues: of a rigid motion, and of a free scale."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from certreg.certificate.bounds import pose_bounds, pose_energy
from certreg.certificate.checking import check_own, require_accepted
from certreg.certificate.producing import produce, produce_similarity
from certreg.dynamics.integrators import DEFAULT_SETTINGS
from certreg.dynamics.simulation import optimal_damping
from certreg.errors import DegenerateProblemError, InvalidProblemError
from certreg.exact.dyadic import nearest_double, nearest_root
from certreg.native.kernels import MissingLibraryError
from certreg.native.loops import Integrator
from certreg.objective.isotropic import Isotropic
from certreg.problem.support import Verb, refusal
from certreg.registration.agreement import agreement, require_sound_trajectory
from certreg.registration.optimum import exact_pose, optimal_pose
from certreg.registration.pipeline import Asked, Prover, Work
from certreg.registration.result import Registration, Solution
from certreg.registration.simulation import final_state, simulated_motion
from certreg.relaxation.shor import relax
from certreg.results import OUT_OF_RANGE, Absent

if TYPE_CHECKING:
    from certreg.certificate.envelope import Certificate
    from certreg.dynamics.integrators import SimulationSettings
    from certreg.problem.problem import RegistrationProblem
    from certreg.problem.support import Cell
    from certreg.registration.simulation import SimulatedMotion
    from certreg.relaxation.shor import Relaxation
    from certreg.results import Limits, Verdict

LOG = logging.getLogger(__name__)
NOT_CERTIFIED = Absent("not certified")
NO_SCALE_THERE = Absent("the relaxation is of scale 1, not of a free one")
CROSS_CHECK = Integrator.SPLITTING  # a few large steps, however stiff the springs


@dataclass(frozen=True, slots=True, kw_only=True)
class LinearProposal:
    """The problem, with the damping that was taken, and what was computed of it."""

    problem: RegistrationProblem
    objective: Isotropic
    relaxation: Relaxation | Absent
    trajectory: SimulatedMotion | Absent
    integrator: Integrator | None


class LinearProver(Prover[LinearProposal, Solution, Registration]):
    """Of a rigid motion, or a rotation alone."""

    PARTS = 3  # exact sums, certificate, checker
    USUAL = CROSS_CHECK  # integrator

    def accepts(self, cell: Cell) -> bool:
        """Whether the scale is 1."""
        return not cell.scaled

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
    ) -> Solution:
        """The certificate, and how well the methods agree."""
        problem, objective, run = proposal.problem, proposal.objective, proposal.integrator
        about = {"damping": problem.damping, "integrator": None if run is None else run.value}
        certificate = self.certificate(proposal, asked.robustness_angle, {**asked.about, **about})
        work.done("certificate")
        solution = Solution(
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

    def check(self, proved: Solution, work: Work) -> Verdict | None:
        """The checker's answer; where it proves the optimum, the simulation must have ended so."""
        verdict, certificate = None, proved.certificate
        if certificate is not None:
            verdict = check_own(certificate, proved.problem)
            work.lap("check")
            require_accepted(verdict)
            if not isinstance(proved.trajectory, Absent):
                require_sound_trajectory(proved.objective, certificate.body, proved.trajectory)
        work.done("checker")
        return verdict

    def judge(
        self, proved: Solution, verdict: Verdict | None, asked: Asked, timings: dict[str, float]
    ) -> Registration:
        """What a solution says of the pose as it is printed."""
        if proved.problem.mapped:
            proved.complete()
        return _registration(proved, verdict, timings, asked.limits)

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
    """Of a free scale, with its own certificate; it has no relaxation, and no best damping."""

    USUAL = Integrator.MIDPOINT

    def accepts(self, cell: Cell) -> bool:
        """Whether the scale is free."""
        return cell.scaled

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
        scaling: Any = objective.scaling  # free
        return produce_similarity(
            problem, objective, scaling, robustness_angle=robustness_angle, about=about
        )


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


def _registration(
    solution: Solution,
    verdict: Verdict | None,
    timings: dict[str, float],
    limits: Limits,
) -> Registration:
    pose, moments, certificate = solution.pose, solution.moments, solution.certificate
    objective, place = solution.objective, exact_pose(pose)
    shifted = objective.translation_energy(place.quaternion, place.translation, place.scale)
    energy = pose_energy(objective, place, shifted)
    squares = objective.squares(energy, place.scale)
    return Registration(
        problem=solution.problem,
        solution=solution,
        objective=nearest_double(energy),
        rmse=nearest_root(squares / moments.total_weight),
        bounds=(
            None
            if certificate is None
            else pose_bounds(objective, certificate.body, place, shifted=shifted, energy=energy)
        ),
        limits=limits,
        verdict=verdict,
        timings=timings,
        absent={
            **solution.absent,
            "objective": OUT_OF_RANGE,
            "rmse": OUT_OF_RANGE,
            "bounds": NOT_CERTIFIED,
        },
    )
