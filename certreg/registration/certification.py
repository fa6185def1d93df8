"""The main job: register, enumerate, certify, check."""

from __future__ import annotations

import logging
import time
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

from certreg.certificate.bounds import pose_bounds, pose_energy
from certreg.certificate.checking import check_own, require_accepted
from certreg.certificate.producing import produce, produce_similarity
from certreg.dynamics.integrators import DEFAULT_SETTINGS, SimulationSettings
from certreg.dynamics.simulation import optimal_damping
from certreg.errors import DegenerateProblemError, InvalidProblemError
from certreg.exact.dyadic import nearest_double, nearest_root
from certreg.native.kernels import MissingLibraryError
from certreg.native.loops import Integrator
from certreg.objective.isotropic import Isotropic
from certreg.problem.support import Verb, refusal, require_supported
from certreg.registration.agreement import agreement, require_sound_trajectory
from certreg.registration.optimum import exact_pose, optimal_pose
from certreg.registration.parts import logged
from certreg.registration.result import Registration, Solution
from certreg.registration.simulation import final_state, objective_of, simulated_motion
from certreg.registration.stating import require_problem
from certreg.relaxation.shor import relax
from certreg.results import OUT_OF_RANGE, Absent, Limits

if TYPE_CHECKING:
    from collections.abc import Callable

    from certreg.certificate.envelope import Certificate
    from certreg.certificate.isotropic import IsotropicBody
    from certreg.certificate.similarity import SimilarityBody
    from certreg.problem.problem import RegistrationProblem
    from certreg.registration.simulation import SimulatedMotion
    from certreg.relaxation.shor import Relaxation
    from certreg.results import Verdict


LOG = logging.getLogger(__name__)
PARTS = 3  # of certify, besides relaxation and simulation: sums, certificate, checker
NOT_ASKED = Absent("not asked for")
NOT_CERTIFIED = Absent("not certified")
NO_SCALE_THERE = Absent("the relaxation is of scale 1, not of a free one")
CROSS_CHECK = Integrator.SPLITTING  # a few large steps, however stiff the springs


def certified(  # noqa: PLR0913 - as above
    problem: RegistrationProblem,
    *,
    relaxation: bool | str,
    integrator: str | None,
    settings: SimulationSettings | None = None,
    robustness_angle: float | None = None,
    about: dict[str, Any] | None = None,
    limits: Limits | None = None,
    done: Callable[[str], None] = logged,
    not_taken: Absent = NOT_ASKED,
) -> Registration:
    """As `certify`, the simulation by an integrator of `simulate`; None for no simulation.

    done: called with the name of each part. not_taken: why relaxation or simulation is left out.
    """
    start = time.perf_counter()
    solution = solve(
        problem,
        relaxation=relaxation,
        integrator=integrator,
        settings=settings,
        robustness_angle=robustness_angle,
        about=about,
        done=done,
        not_taken=not_taken,
    )
    solved = time.perf_counter()
    timings = {"compute": solved - start}
    certificate = solution.certificate
    verdict = None
    if certificate is not None:
        verdict = check_own(certificate, solution.problem)
        timings["check"] = time.perf_counter() - solved
        require_accepted(verdict)
        if not isinstance(solution.trajectory, Absent):
            require_sound_trajectory(solution.objective, certificate.body, solution.trajectory)
    done("checker")
    if problem.mapped:
        solution.complete()
    return _registration(solution, verdict, timings, limits or Limits())


def simulate(
    problem: RegistrationProblem,
    integrator: str | None = None,
    *,
    step: float | None = None,
    settings: SimulationSettings | None = None,
) -> SimulatedMotion:
    """The trajectory of the damped body, released at rest where the source was given.

    Parameters
    ----------
    problem
        Its damping is that of the body.
    integrator
        "euler", explicit with projection; "midpoint", whose energy never rises; "splitting", a few
        large steps. None: "euler", and "midpoint" on general springs, where that is not there, and
        with a free scale, where no other is.
    step
        In the time unit of the springs, None for the integrator's own; less is taken, and noted in
        the trajectory, where this is not stable or gains nothing.
    settings
        What else may be set; a step given beside them comes before theirs.

    Returns
    -------
    SimulatedMotion
        A `Trajectory` with its problem; how it ended is in its `status`. On general springs the
        body may come to rest elsewhere than at the optimum; with a free scale its size moves, too.

    Raises
    ------
    ValueError
        For other steps.
    InvalidProblemError
        For other integrators; for "euler" on general springs; for all but "midpoint" with a free
        scale; for the symmetric scale, which no springs have; for what is no problem.
    DegenerateProblemError
        Where the dynamics is not defined or too stiff.
    """
    require_problem(problem, "simulate")
    settings = _with_step(settings, step)
    return simulated_motion(problem, objective_of(problem), integrator, settings=settings)


def solve(  # noqa: PLR0913 - as above
    problem: RegistrationProblem,
    *,
    relaxation: bool | str = False,
    integrator: str | None = None,
    settings: SimulationSettings | None = None,
    robustness_angle: float | None = None,
    about: dict[str, Any] | None = None,
    done: Callable[[str], None] = logged,
    not_taken: Absent = NOT_ASKED,
) -> Solution:
    """Everything that is computed, nothing yet checked. integrator: None for no simulation."""
    objective = Isotropic.of(problem)
    done("exact sums")
    problem = _best_damped(problem, objective)
    relaxed = trajectory = not_taken
    if relaxation:
        relaxed = NO_SCALE_THERE if problem.scaled else _relaxation(objective, relaxation)
        done("relaxation")
    if integrator is not None:
        settings = settings or DEFAULT_SETTINGS
        trajectory = _simulation(objective, problem, integrator, settings)
        done("simulation")
    about = {**(about or {}), "damping": problem.damping, "integrator": integrator}
    certificate = _certificate(
        problem,
        objective,
        relaxed,
        trajectory,
        robustness_angle=robustness_angle,
        about=about,
    )
    done("certificate")
    return Solution(
        problem=problem,
        objective=objective,
        pose=optimal_pose(objective),
        relaxation=relaxed,
        trajectory=trajectory,
        agreement=agreement(problem, objective, relaxation=relaxed, trajectory=trajectory),
        certificate=certificate,
        absent={"certificate": NOT_CERTIFIED},
    )


def _certificate(
    problem: RegistrationProblem,
    objective: Isotropic,
    relaxed: Relaxation | Absent,
    trajectory: SimulatedMotion | Absent,
    *,
    robustness_angle: float | None,
    about: dict[str, Any],
) -> Certificate[IsotropicBody] | Certificate[SimilarityBody] | None:
    """Of the kind that proves of such a problem."""
    if objective.scaling is not None:
        return produce_similarity(
            problem, objective, objective.scaling, robustness_angle=robustness_angle, about=about
        )
    return produce(
        problem,
        objective,
        proposal=None if isinstance(relaxed, Absent) else relaxed.proposal,
        state=None if isinstance(trajectory, Absent) else final_state(trajectory),
        robustness_angle=robustness_angle,
        about=about,
    )


def _best_damped(problem: RegistrationProblem, objective: Isotropic) -> RegistrationProblem:
    """The problem with the damping of the fastest decay, where it names none and there is one."""
    if problem.damping_given or problem.scaled:
        return problem
    try:
        damped = problem.damped(optimal_damping(objective))
    except (DegenerateProblemError, InvalidProblemError) as error:
        LOG.info("damping %g: there is no best one: %s", problem.damping, error)
        return problem
    LOG.info("damping %g, of the fastest decay", damped.damping)
    return damped


def _relaxation(objective: Isotropic, solver: str | Literal[True]) -> Relaxation | Absent:
    """The relaxation, or why there is none; solver: by CVXPY's name, True for Clarabel."""
    relaxed = relax(objective, solver=solver if isinstance(solver, str) else None)
    LOG.info("relaxation %s by %s: %s", relaxed.form.value, relaxed.solver, relaxed.status.name)
    if relaxed.value is None:
        return Absent(relaxed.reason)
    return relaxed


def _simulation(
    objective: Isotropic,
    problem: RegistrationProblem,
    integrator: str,
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


def _with_step(settings: SimulationSettings | None, step: float | None) -> SimulationSettings:
    settings = settings or DEFAULT_SETTINGS
    return settings if step is None else replace(settings, step=step)


def optimally_damped(problem: RegistrationProblem) -> RegistrationProblem:
    """The same problem with the damping under which the slowest mode decays fastest.

    Raises DegenerateProblemError where the dynamics is not defined or the optimum is not unique.
    """
    require_supported(problem.cell, Verb.DAMPING)
    return problem.damped(optimal_damping(Isotropic.of(problem)))


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
