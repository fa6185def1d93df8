"""What is known around an optimum and at a pose, beside the proved bounds, by the structure.

One weight per pair lists its equilibria; on general springs Newton's steps lead to the one at the
pose, if there is one.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.certificate.bounds import ExactPose, PoseBounds, flat_energy, sin2_half_angle_between
from certreg.exact.dyadic import half_angle_bound, nearest_or_zero, rational_root_above
from certreg.geometry.pose_matrix import ROTATION_TOLERANCE
from certreg.objective.structure import Structure
from certreg.registration.nearby_equilibrium import equilibrium_near
from certreg.registration.optimum import exact_pose
from certreg.registration.rounding import rounding_cost, rounding_errors

if TYPE_CHECKING:
    from certreg.geometry.given import GivenPose
    from certreg.objective.isotropic import Isotropic
    from certreg.registration.gap_parts import GapParts
    from certreg.registration.linear import LinearSolution
    from certreg.registration.quartic import QuarticSolution
    from certreg.registration.result import PoseWorth, Registration


SLACK = 1.01  # of a rounding cost: its parts are computed in doubles
BALANCED = 1e-9  # of the oscillation: the slope at what Newton's steps led to, if it is critical


@dataclass(frozen=True, slots=True, kw_only=True)
class AssessmentSettings:
    """Where the words of an assessment change. Gaps are relative to the range of energies.

    What is optimal is no choice: the gap is then at most what rounding the pose can cost, and
    within what `certify` calls certified (`Limits`).

    Parameters
    ----------
    rotation_tolerance
        How far, in the norm of R^T R - I, a matrix may be off a rotation.
    near_optimal_gap, near_optimal_angle
        A share of the range of energies, and radians: what is nearer than both is near optimal.
    equilibrium_angle, equilibrium_shift
        Radians, and a distance of the centroids relative to the clouds' radius: what is nearer than
        both to another equilibrium is told to be there.
    """

    rotation_tolerance: float = ROTATION_TOLERANCE  # |R^T R - I|, as for poses in files
    near_optimal_gap: float = 1e-4  # a pose off by one part in a hundred
    near_optimal_angle: float = 0.1  # radians
    equilibrium_angle: float = 1e-3  # radians: a pose printed with few digits still counts
    equilibrium_shift: float = 1e-3  # distance of the centroids, relative to the clouds' radius


@dataclass(frozen=True, slots=True, kw_only=True)
class Rest:
    """The equilibrium nearest to a pose, of those that are known.

    index: directions in which the energy falls. angle: radians, from the pose. here: whether the
    pose is right at it, and it is not the listed optimum. worse: whether the optimum is better.
    number: among those that are listed, the optimum first; None where none are.
    """

    index: int
    angle: float
    here: bool
    worse: bool
    number: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class PosePlace:
    """Where a pose is; energies exact, angles in radians.

    translation_energy: what the translation adds to the best one. energy_range: the scale that says
    which energies are small. away: to the nearest optimum, computed; None where others may be as
    good as the certified one. rest: None where no equilibrium is known near. stretch: by how much
    the turn costs less than to second order.
    """

    translation_energy: Fraction
    energy_range: Fraction
    away: float | None
    rest: Rest | None
    stretch: Fraction = Fraction(1)


@dataclass(frozen=True, slots=True, kw_only=True)
class Landscape:
    """How a structure answers what the judge of poses asks.

    optimum: the certified rotation. centre: the source's mean, about which a matrix is read as the
    nearest rotation. place: of a pose with these bounds and parts of the gap. rounding_cost: of the
    optimal pose, written in doubles as a given one is.
    """

    optimum: Callable[[Any], Sequence[int]]
    centre: Callable[[Any], Sequence[Fraction]]
    place: Callable[[Any, ExactPose, PoseBounds, GapParts | None, AssessmentSettings], PosePlace]
    rounding_cost: Callable[[Registration[Any], GivenPose], Fraction]


def little(settings: AssessmentSettings, energy_range: Fraction) -> Fraction:
    """What a translation within `equilibrium_shift` costs."""
    return Fraction(settings.equilibrium_shift) ** 2 * energy_range


def landscape_of(registration: Registration) -> Landscape:
    """That of its structure."""
    return LANDSCAPES[registration.structure]


def optimum_worth(registration: Registration) -> PoseWorth:
    """What the optimum costs itself, not rounded."""
    solution = registration.solution
    q, objective = landscape_of(registration).optimum(solution), solution.objective
    shift, scale = objective.best_translation(q), objective.best_scale(q)
    return solution.worth(ExactPose(quaternion=tuple(q), translation=shift, scale=scale), None)


def linear_place(
    solution: LinearSolution,
    pose: ExactPose,
    bounds: PoseBounds,
    parts: GapParts | None,
    settings: AssessmentSettings,
) -> PosePlace:
    """Among the eigenspaces; at one whose best scale is zero no pose is."""
    del bounds
    objective, components, q = solution.objective, solution.equilibria.components, pose.quaternion
    scale, angles = _range(objective), [objective.angle_to(k, q) for k in range(len(components))]
    shifted = objective.translation_energy(q, pose.translation, pose.scale)
    nearest = min(range(len(angles)), key=angles.__getitem__)
    costs = shifted if parts is None else max(shifted, parts.scale)
    settled = angles[nearest] <= settings.equilibrium_angle and costs <= little(settings, scale)
    half = angles[0] / 2
    return PosePlace(
        translation_energy=shifted,
        energy_range=scale,
        away=angles[0],
        rest=Rest(
            index=components[nearest].morse_index,
            angle=angles[nearest],
            here=nearest > 0
            and settled
            and objective.best_scale(objective.quaternions[nearest]) > 0,
            worse=nearest > 0,
            number=nearest,
        ),
        stretch=Fraction(half / math.sin(half)) ** 2 if half else Fraction(1),
    )


def _range(objective: Isotropic) -> Fraction:
    """Energy between the best and the worst rotation; the clouds' own where all are equal."""
    spaces = len(objective.classification.pattern)
    if spaces == 1:
        return flat_energy(objective.moments)
    if objective.scaling is None:
        return 2 * objective.eigenvalue_difference(0, spaces - 1)
    return objective.energy(objective.quaternions[-1]) - objective.energy(objective.quaternions[0])


def linear_rounding_cost(
    registration: Registration[LinearSolution], given: GivenPose, *, inverse: bool = False
) -> Fraction:
    """What rounding can cost, the optimal pose written as the given one; of many, that near it.

    inverse: whether it is written as the motion from the target to the source.
    """
    objective, pose = registration.solution.objective, registration.pose
    turn, shift, centre = given.turn, given.translation, objective.moments.source_centroid
    if inverse:
        pose, centre = pose.inverse(), objective.moments.target_centroid
    if objective.classification.unique:
        turn = pose.rotation if given.is_matrix else pose.quaternion_wxyz
        shift = None if shift is None else pose.translation
    return rounding_cost(objective, turn, shift, centre, scale=exact_pose(pose).scale)


def quartic_place(
    solution: QuarticSolution,
    pose: ExactPose,
    bounds: PoseBounds,
    parts: GapParts | None,
    settings: AssessmentSettings,
) -> PosePlace:
    """Where Newton's steps lead, if that is at the pose and an equilibrium."""
    del parts
    objective, q, rest, away = solution.objective, pose.quaternion, None, None
    scale = rational_root_above(bounds.least_range_squared) or bounds.flat_energy
    shifted = objective.translation_energy(q, pose.translation)
    if shifted <= little(settings, scale) and objective.oscillation:
        near = equilibrium_near(objective, solution.found.levelled, q, solution.least)
        if near.angle <= settings.equilibrium_angle and near.slope <= BALANCED:
            rest = Rest(index=near.index, angle=near.angle, here=True, worse=near.is_worse)
    if solution.unique_rotation:
        away = float(half_angle_bound(sin2_half_angle_between(solution.quaternion, q)))
    return PosePlace(translation_energy=shifted, energy_range=scale, away=away, rest=rest)


def quartic_rounding_cost(
    registration: Registration[QuarticSolution], given: GivenPose
) -> Fraction:
    """What rounding the optimal pose to doubles can cost, to second order; of many, that printed.

    A turn by a about the source's mean and a shift of its image by d cost at most
    (sqrt(G_dd) |d| + sqrt(G_aa) a)^2, G half the Hessian, which is semidefinite at the optimum.
    """
    pose, solution = registration.pose, registration.solution
    turn = pose.rotation if given.is_matrix else pose.quaternion_wxyz
    shift = None if given.translation is None else pose.translation
    sine, away = rounding_errors(turn, shift, solution.centre)
    with np.errstate(all="ignore"):
        half = solution.near.half_hessian(solution.centre)
        if not np.isfinite(half).all():
            return Fraction(0)
        parts = slice(3), slice(-3, None)  # of a shift, if the motion has any, and of a turn
        shifted, spun = (float(np.linalg.norm(half[k, k], 2)) for k in parts)
    angle = 2.0 * math.asin(min(1.0, math.sqrt(nearest_or_zero(sine))))
    cost = math.sqrt(shifted * nearest_or_zero(away)) + math.sqrt(spun) * angle
    return Fraction(SLACK * cost**2)


LANDSCAPES: Mapping[Structure, Landscape] = {
    Structure.LINEAR: Landscape(
        optimum=lambda solution: solution.objective.optimum,
        centre=lambda solution: solution.objective.moments.source_centroid,
        place=linear_place,
        rounding_cost=linear_rounding_cost,
    ),
    Structure.QUARTIC: Landscape(
        optimum=lambda solution: solution.quaternion,
        centre=lambda solution: solution.centre,
        place=quartic_place,
        rounding_cost=quartic_rounding_cost,
    ),
}
