"""Independent methods for one pose: they must agree with what is certified."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from certreg._loading import late
from certreg.dynamics.body import SimulationStatus
from certreg.errors import ContradictionError
from certreg.exact.dyadic import power_of_two
from certreg.native.layout import MATRIX_STATE, named
from certreg.problem.fast_pose import floating_pose
from certreg.problem.lifting import lift
from certreg.problem.moments import floating_moments
from certreg.registration.closed_form import arun, horn
from certreg.results import Absent, Explained

if TYPE_CHECKING:
    from certreg.certificate.isotropic import IsotropicBody, RotationBody
    from certreg.dynamics.trajectory import Trajectory
    from certreg.equilibrium import breathing
    from certreg.objective.isotropic import Isotropic
    from certreg.problem.problem import RegistrationProblem
    from certreg.relaxation.shor import Relaxation
else:
    breathing = late("certreg.equilibrium.breathing")


# A floating-point method whose loss is larger contradicts the certificate. Losses are relative to
# the alignment between the best and the worst rotation.
CLOSED_FORM_LOSS = 1e-11  # a thousand times the rounding of an O(N) sum
RELAXATION_LOSS = 1e-5  # a thousand times the solver's tolerance
SIMULATION_LOSS = 1e-2  # a run stops at |s'| < 1e-4, near the optimum, not at it
ENERGY_ULPS = 64.0  # of rounding in a logged energy: a sum of twelve products


@dataclass(frozen=True, slots=True, kw_only=True)
class Agreement(Explained):
    """Angles in radians from the pose of each method to the nearest optimum; None: not taken.

    closed_form: the larger of Horn's and Arun's.
    """

    closed_form: float
    relaxation: float | None
    simulation: float | None


def agreement(
    problem: RegistrationProblem,
    objective: Isotropic,
    *,
    relaxation: Relaxation | Absent,
    trajectory: Trajectory | Absent,
) -> Agreement:
    """How well the methods agree. Raises ContradictionError if one ends where it must not."""
    relaxed = simulated = None
    if not isinstance(relaxation, Absent) and relaxation.quaternion_wxyz is not None:
        name, q = "the semidefinite relaxation", lift(relaxation.quaternion_wxyz).integers
        relaxed = _angle(objective, name, q, RELAXATION_LOSS)
    if not isinstance(trajectory, Absent):
        allowed = SIMULATION_LOSS if trajectory.converged else math.inf
        q = lift(trajectory.quaternion).integers
        simulated = _angle(objective, "the simulation", q, allowed)
    not_taken = {"relaxation": relaxation, "simulation": trajectory}
    return Agreement(
        closed_form=_closed_form_angle(problem, objective),
        relaxation=relaxed,
        simulation=simulated,
        absent={name: why for name, why in not_taken.items() if isinstance(why, Absent)},
    )


def require_sound_trajectory(
    objective: Isotropic,
    body: RotationBody,
    trajectory: Trajectory,
) -> None:
    """Nothing, if a trajectory respects the proved minimum; ContradictionError if not.

    No logged V_p may be below it by more than rounding: 64 ulps of the terms of its sum, and one
    for every step, as rotations multiplied add up theirs.
    """
    moments = objective.moments
    unit = moments.total_weight * power_of_two(2 * trajectory.length_exponent)
    minimum = objective.energy(body.quaternion) - body.gap
    centres = np.square(named(trajectory.states, MATRIX_STATE)["c"]).sum(axis=1)
    terms = 3.0 * float(_squares(objective, trajectory) / unit) + centres
    ulps = ENERGY_ULPS + trajectory.steps
    slack = ulps * np.finfo(float).eps * terms
    if (trajectory.potential < float(minimum / unit) - slack).any():
        raise ContradictionError(
            "the simulation went below the certified minimum: please report this",
            methods=("simulation", "certificate"),
            value=float(trajectory.potential.min()),
            limit=float(minimum / unit),
        )


def require_basin(body: IsotropicBody, trajectory: Trajectory) -> None:
    """Nothing, if a run that came to rest inside the basin is proved to lie there.

    ContradictionError if not.
    """
    if trajectory.status is SimulationStatus.CONVERGED and not body.claims.basin:
        raise ContradictionError(
            "the simulation ended where the basin could not be proved: please report this",
            methods=("simulation", "certificate"),
        )


def _squares(objective: Isotropic, trajectory: Trajectory) -> Fraction:
    """Syy + s^2 Sxx, with the largest scale of a run: of what the terms of V_p are made."""
    spread = objective.moments.spread
    if trajectory.scales is not None:
        largest = Fraction(float(trajectory.scales.max())) ** 2
        spread += (largest - 1) * breathing.source_size(objective)
    return spread


def _closed_form_angle(problem: RegistrationProblem, objective: Isotropic) -> float:
    """The larger angle of the rotations of both closed forms, from sums in doubles."""
    found = None
    if problem.motion.translations:  # that is of a pose with a translation
        found = floating_pose(problem.source, problem.target, problem.weights)
    if found is None:
        sums = floating_moments(problem).cross_covariance
        proposed = horn(sums)
    else:
        sums, proposed = found.cross_covariance, found.pose.quaternion_wxyz
    angles: list[float] = []
    for method, form, quaternion in (("Horn", horn, proposed), ("Arun", arun, arun(sums))):
        q = lift(quaternion).integers
        if objective.relative_loss(q) <= CLOSED_FORM_LOSS:
            angles.append(objective.angle_to_optimum(q))
            continue
        # weights or lengths more than 300 decades apart vanish from sums of doubles: of the exact
        # sums, each entry is rounded once, in some unit
        unit = 1 << objective.shift
        rounded = np.array([[entry / unit for entry in row] for row in objective.moments.cross])
        q = lift(form(rounded)).integers
        angles.append(_angle(objective, f"{method}'s closed form", q, CLOSED_FORM_LOSS))
    return max(angles)


def _angle(objective: Isotropic, method: str, q: list[int], allowed: float) -> float:
    angle, loss = objective.angle_to_optimum(q), float(objective.relative_loss(q))
    if loss > allowed:
        raise ContradictionError(
            f"{method} contradicts the certified pose: it is {math.degrees(angle):.3g} degrees "
            "away; please report this problem",
            methods=(method, "certificate"),
            value=loss,
            limit=allowed,
        )
    return angle
