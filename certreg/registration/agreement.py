"""Independent methods for one pose: they must agree with what is certified."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.dynamics import SimulationStatus
from certreg.errors import ContradictionError
from certreg.exact import power_of_two
from certreg.native import MATRIX_STATE, named
from certreg.problem import floating_moments, lift
from certreg.registration.closed_form import arun, horn
from certreg.results import Absent, Explained

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.certificate import IsotropicBody
    from certreg.dynamics import Trajectory
    from certreg.objective import Isotropic
    from certreg.problem import RegistrationProblem
    from certreg.relaxation import Relaxation

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
    closed = list[float]()
    moments = floating_moments(problem)
    for name, form in (("Horn's closed form", horn), ("Arun's closed form", arun)):
        quaternion = form(moments.cross_covariance)
        if objective.relative_loss(lift(quaternion).integers) > CLOSED_FORM_LOSS:
            # weights or lengths more than 300 decades apart vanish from sums of doubles
            quaternion = form(_rounded_covariance(objective))
        closed.append(_angle(objective, name, quaternion, CLOSED_FORM_LOSS))
    relaxed = None
    if not isinstance(relaxation, Absent) and relaxation.quaternion_wxyz is not None:
        name, place = "the semidefinite relaxation", relaxation.quaternion_wxyz
        relaxed = _angle(objective, name, place, RELAXATION_LOSS)
    simulated = None
    if not isinstance(trajectory, Absent):
        allowed = SIMULATION_LOSS if trajectory.converged else math.inf
        simulated = _angle(objective, "the simulation", trajectory.quaternion, allowed)
    not_taken = {"relaxation": relaxation, "simulation": trajectory}
    return Agreement(
        closed_form=max(closed),
        relaxation=relaxed,
        simulation=simulated,
        absent={name: why for name, why in not_taken.items() if isinstance(why, Absent)},
    )


def require_sound_trajectory(
    objective: Isotropic, body: IsotropicBody, trajectory: Trajectory
) -> None:
    """Nothing, if a trajectory respects what is proved; ContradictionError if not.

    A run that came to rest inside the basin must be proved to lie there, and no logged V_p may be
    below the certified minimum by more than rounding: 64 ulps of the terms of its sum, and one for
    every step, as rotations multiplied add up theirs.
    """
    if trajectory.status is SimulationStatus.CONVERGED and not body.claims.basin:
        message = "the simulation ended where the basin could not be proved: please report this"
        raise ContradictionError(message, methods=("simulation", "certificate"))
    moments = objective.moments
    unit = moments.total_weight * power_of_two(2 * trajectory.length_exponent)
    minimum = objective.energy(body.quaternion) - body.gap
    centres = np.square(named(trajectory.states, MATRIX_STATE)["c"]).sum(axis=1)
    terms = 3.0 * float(moments.spread / unit) + centres
    ulps = ENERGY_ULPS + trajectory.steps
    slack = ulps * np.finfo(float).eps * terms
    if (trajectory.potential < float(minimum / unit) - slack).any():
        message = "the simulation went below the certified minimum: please report this"
        raise ContradictionError(
            message,
            methods=("simulation", "certificate"),
            value=float(trajectory.potential.min()),
            limit=float(minimum / unit),
        )


def _rounded_covariance(objective: Isotropic) -> NDArray[np.float64]:
    """The exact cross-covariance, each entry rounded once, in some unit."""
    shift = objective.shift
    return np.array([[entry / (1 << shift) for entry in row] for row in objective.moments.cross])


def _angle(
    objective: Isotropic, method: str, quaternion: NDArray[np.float64], allowed: float
) -> float:
    q = lift(quaternion).integers
    angle = objective.angle_to_optimum(q)
    loss = float(objective.relative_loss(q))
    if loss > allowed:
        message = (
            f"{method} contradicts the certified pose: it is {math.degrees(angle):.3g} degrees "
            "away; please report this problem"
        )
        raise ContradictionError(
            message, methods=(method, "certificate"), value=loss, limit=allowed
        )
    return angle
