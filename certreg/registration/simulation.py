"""Simulated motions with their problems, and what is proved of where one ends."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, Any

from certreg._loading import cached_property, found_late, late
from certreg.certificate.checking import check_own, require_accepted
from certreg.certificate.isotropic import RotationState, produce
from certreg.dynamics import simulation
from certreg.dynamics.integrators import DEFAULT_SETTINGS, SimulationSettings
from certreg.dynamics.simulation import optimal_damping
from certreg.dynamics.trajectory import Trajectory
from certreg.exact.dyadic import nearest_double, power_of_two
from certreg.native.loops import Integrator, Kind
from certreg.objective.by_structure import objective_of
from certreg.objective.isotropic import Isotropic
from certreg.problem.lifting import lift
from certreg.problem.support import Verb, require_supported
from certreg.registration.agreement import require_basin, require_sound_trajectory
from certreg.registration.problem_arguments import require_problem
from certreg.results import OUT_OF_RANGE, Absent, Brief, Presented

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from certreg.dynamics.body import Basin
    from certreg.dynamics.valleys import BreathingBody
    from certreg.equilibrium import breathing
    from certreg.objective.springs import Springs
    from certreg.problem.problem import RegistrationProblem
else:
    breathing = late("certreg.equilibrium.breathing")


@dataclass(frozen=True, kw_only=True, eq=False)
class SimulatedMotion(Trajectory, Presented):
    """A trajectory with its problem: what is known of its end is asked for when it is printed.

    objective: of the problem, as the run had it.
    """

    problem: RegistrationProblem
    objective: Isotropic | Springs

    __repr__ = Trajectory.__repr__

    @property
    def outcome(self) -> str:
        """How it ended, in a sentence."""
        return self.status.value

    @property
    def never_collapses(self) -> bool:
        """Whether it is proved that a scale that moves never comes to 0; False where none does."""
        return False

    @property
    def energy_unit(self) -> Fraction:
        """What the trajectory's energies are worth in objective units."""
        return self.moving.mass * power_of_two(2 * self.length_exponent)

    @property
    def energies(self) -> tuple[float | Absent, float | Absent]:
        """V_p + V_k at the start and at the end, in objective units."""
        first, last = (self.potential + self.kinetic)[[0, -1]].tolist()
        return _rounded(first, self.energy_unit), _rounded(last, self.energy_unit)


def _rounded(value: float, unit: Fraction) -> float | Absent:
    energy = nearest_double(Fraction(value) * unit)
    return OUT_OF_RANGE if energy is None else energy


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ProblemTrajectory(SimulatedMotion):
    """Of a problem of one weight per pair and scale 1, whose optimum is known."""

    objective: Isotropic

    __repr__ = Trajectory.__repr__

    @property
    def basin(self) -> Basin | None:
        """What is certified of the optimum."""
        return self.moving.basin


@dataclass(frozen=True, kw_only=True, eq=False)
class SimulatedBreathing(SimulatedMotion):
    """With a free scale; where it ended beside the optimum."""

    objective: Isotropic
    moving: BreathingBody

    __repr__ = Trajectory.__repr__

    @property
    def scales(self) -> NDArray[np.float64]:
        """(L,), target over source."""
        return self.moving.scales(self.samples["state"])

    @cached_property
    def angle_to_optimum(self) -> float:
        """Radians, from the last rotation to the nearest optimum."""
        return self.objective.angle_to_optimum(lift(self.quaternion).integers)

    @property
    def best_scale(self) -> float | None:
        """That of the optimum, target over source; None where no double holds it."""
        return nearest_double(self.objective.best_scale(self.objective.optimum))

    @property
    def never_collapses(self) -> bool:
        """Whether it is proved that the exact motion from the start never comes to the scale 0."""
        return never_collapses(self.objective)


def never_collapses(objective: Isotropic) -> bool:
    """Whether the exact motion from where the source was given, at rest at scale 1, keeps s > 0.

    Proved, in rationals: it begins with less energy than Syy (derivations, breathing_confined).
    False means not proved, not disproved. Raises as `source_size`.
    """
    still = (1, 0, 0, 0)
    shifted = objective.translation_energy(still, (Fraction(0),) * 3)
    released = objective.energy_at(still, shifted, Fraction(1))
    return released < objective.moments.spread - breathing.source_size(objective)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SimulatedRegistration(Brief):
    """A simulation, and what is proved of its end.

    angle_to_optimum: radians, from the last rotation to the nearest optimum.
    in_certified_basin: the checker accepted that the exact flow from the last state ends at the
        optimum; False means not proved, not disproved.
    unique: whether there is one optimum.
    """

    trajectory: SimulatedMotion
    angle_to_optimum: float
    in_certified_basin: bool
    unique: bool


MOTIONS: Mapping[Kind, Callable[[], type[SimulatedMotion]]] = {  # by the kind of the body
    Kind.RIGID: lambda: ProblemTrajectory,
    Kind.SPRINGS: found_late("certreg.registration.valley", "SimulatedSprings"),
    Kind.BREATHING: lambda: SimulatedBreathing,
}


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


def _with_step(settings: SimulationSettings | None, step: float | None) -> SimulationSettings:
    settings = settings or DEFAULT_SETTINGS
    return settings if step is None else replace(settings, step=step)


def optimally_damped(problem: RegistrationProblem) -> RegistrationProblem:
    """The same problem with the damping under which the slowest mode decays fastest.

    Raises DegenerateProblemError where the dynamics is not defined or the optimum is not unique.
    """
    require_supported(problem.cell, Verb.DAMPING)
    return problem.damped(optimal_damping(Isotropic.of(problem)))


def simulated_motion(
    problem: RegistrationProblem,
    objective: Isotropic | Springs,
    integrator: Integrator | str | None = None,
    *,
    settings: SimulationSettings | None = None,
) -> SimulatedMotion:
    """The motion of a problem, released at rest where the source was given.

    integrator: None for the body's own. Raises InvalidProblemError for those that do not move such
    a body, DegenerateProblemError where the dynamics is not defined or too stiff.
    """
    chosen = None if integrator is None else Integrator(integrator)
    require_supported(problem.cell, Verb((chosen or Integrator.MIDPOINT).value))
    made = partial(_of_its_kind, problem=problem, objective=objective)
    return simulation.simulate(objective, problem.damping, chosen, settings=settings, kind=made)


def _of_its_kind(**fields: Any) -> SimulatedMotion:
    return MOTIONS[fields["moving"].KIND]()(**fields)


def proved_end(run: ProblemTrajectory) -> SimulatedRegistration:
    """A trajectory with what the checker has proved of its end.

    Raises ContradictionError or RefusedCertificateError where certreg contradicts itself.
    """
    certificate = produce(run.problem, run.objective, state=final_state(run))
    if certificate is not None:
        require_accepted(check_own(certificate, run.problem))
        require_sound_trajectory(run.objective, certificate.body, run)
        require_basin(certificate.body, run)
    return SimulatedRegistration(
        trajectory=run,
        angle_to_optimum=run.objective.angle_to_optimum(lift(run.quaternion).integers),
        in_certified_basin=certificate is not None and bool(certificate.body.claims.basin),
        unique=run.objective.classification.unique,
    )


def final_state(trajectory: Trajectory) -> RotationState:
    """The last state of a trajectory, exactly: what the basin proof is about."""
    velocity = lift(trajectory.angular_velocity)
    (w, x, y, z), (a, b, c) = lift(trajectory.quaternion).integers, velocity.integers
    return RotationState(quaternion=(w, x, y, z), angular_velocity=(a, b, c, velocity.exponent))
