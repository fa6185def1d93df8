"""The facts of a pose on general springs beside those of the optimum, and the verdict they give."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from certreg.certificate.bounds import ExactPose, sin2_half_angle_between, spring_pose_bounds
from certreg.errors import UndecidedError
from certreg.exact.dyadic import (
    half_angle_bound,
    nearest_double,
    nearest_or_zero,
    nearest_root,
    rational_root_above,
)
from certreg.registration.findings import (
    FIT_WARNED,
    NO_NOISE,
    JudgedEnergies,
    SigmaDistance,
    added,
    nearest_quaternion,
    pose_through,
    rules_out,
    turned,
)
from certreg.registration.findings import UNDECIDED as UNPROVED
from certreg.registration.loose_turns import LOOSE_SIGMA, TURNED_FAR, beyond_first_order
from certreg.registration.nearby_equilibrium import equilibrium_near
from certreg.registration.rounding import rounding_errors
from certreg.registration.tail_probabilities import log_chi2_above
from certreg.results import OUT_OF_RANGE, Absent, Limits, PoseVerdict

if TYPE_CHECKING:
    from certreg.certificate.bounds import PoseBounds
    from certreg.geometry.given import GivenPose
    from certreg.registration.findings import AssessmentSettings
    from certreg.registration.nearby_equilibrium import NearbyEquilibrium
    from certreg.registration.quartic import QuarticSolution
    from certreg.registration.result import Registration


SLACK = 1.01  # of a rounding cost: its parts are computed in doubles
FINE_PROOF = 1e-24  # of the range of energies: what a turn by 1e-12 radians costs at most
BALANCED = 1e-9  # of the oscillation: the slope at what Newton's steps led to, if it is critical


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringFindings:
    """The facts on which the verdict rests; energies exact, angles in radians.

    away: to the certified rotation; None where others are as good, or may be. critical: another
    equilibrium than the optimum, right at the pose.
    """

    registration: Registration[QuarticSolution]
    bounds: PoseBounds
    rounding_cost: Fraction
    energy: Fraction
    translation_energy: Fraction
    energy_range: Fraction
    away: float | None
    critical: NearbyEquilibrium | None

    @property
    def proof_gap(self) -> Fraction:
        """What the proof itself leaves open of the pose."""
        return self.bounds.greatest_gap - self.bounds.least_gap

    @property
    def is_elsewhere(self) -> bool:
        """Whether the pose is at an equilibrium that is worse than the optimum."""
        return self.critical is not None and self.critical.is_worse

    def is_near(self, settings: AssessmentSettings) -> bool:
        """Whether its angle is not in doubt: where uniqueness is not decided, by a proved bound."""
        if self.registration.solution.unique_rotation is not None:
            return True
        angle = self.bounds.angle_upper
        return angle is not None and angle <= settings.near_optimal_angle

    @property
    def energies(self) -> JudgedEnergies:
        """Those that are told."""
        solution = self.registration.solution
        return JudgedEnergies(
            objective=self.energy,
            optimum=solution.least,
            bounds=self.bounds,
            rounding_cost=self.rounding_cost,
            total_weight=Fraction(solution.sums.stiffness),
            of_what="along the springs",
        )


def spring_findings(
    registration: Registration[QuarticSolution], given: GivenPose, settings: AssessmentSettings
) -> SpringFindings:
    """What is known of a pose. Raises UndecidedError where the optimum could not be certified."""
    solution = registration.solution
    if solution.certificate is None:
        raise UndecidedError(UNPROVED, method="certificate")
    objective, pose = solution.objective, _exact_pose(registration, given)
    q = pose.quaternion
    bounds = spring_pose_bounds(objective, solution.certificate.body, pose)
    shifted = objective.translation_energy(q, pose.translation)
    scale = rational_root_above(bounds.least_range_squared)
    away = None
    if solution.unique_rotation:
        away = float(half_angle_bound(sin2_half_angle_between(solution.quaternion, q)))
        if bounds.angle_upper is not None:
            away = min(away, bounds.angle_upper)
    settled = shifted <= Fraction(settings.equilibrium_shift) ** 2 * scale
    return SpringFindings(
        registration=registration,
        bounds=bounds,
        rounding_cost=_cost_of_rounding(registration, given),
        energy=objective.energy(q) + shifted,
        translation_energy=shifted,
        energy_range=scale,
        away=away,
        critical=_critical_near(registration, q, settings) if settled else None,
    )


def _exact_pose(registration: Registration[QuarticSolution], given: GivenPose) -> ExactPose:
    """Exactly the pose that is judged: a matrix as the nearest rotation about the source's mean."""
    q = nearest_quaternion(given.turn)
    if given.translation is None:
        best = registration.solution.objective.best_translation(q)
        return ExactPose(quaternion=q, translation=best)
    shift = [Fraction(t) for t in given.translation.tolist()]
    if not given.is_matrix:
        return ExactPose(quaternion=q, translation=tuple(shift))
    x = registration.solution.centre
    return pose_through(q, x, added(turned(given.turn, x), shift))


def _cost_of_rounding(registration: Registration[QuarticSolution], given: GivenPose) -> Fraction:
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


def _critical_near(
    registration: Registration[QuarticSolution], q: tuple[int, ...], settings: AssessmentSettings
) -> NearbyEquilibrium | None:
    """The equilibrium at a rotation, by Newton's steps from there; None if there is none near."""
    solution = registration.solution
    if not solution.objective.oscillation:
        return None
    near = equilibrium_near(solution.objective, solution.found.levelled, q, solution.least)
    return near if near.angle <= settings.equilibrium_angle and near.slope <= BALANCED else None


def spring_verdict_of(facts: SpringFindings, settings: AssessmentSettings) -> PoseVerdict:
    """The verdict: by the proved gap, and by the angle where one rotation alone is optimal.

    Where that is not decided, by a proved angle to every optimum; without one a small gap may only
    mean that little is at stake. At an equilibrium that is worse it means just that.
    """
    gap, scale = facts.bounds.greatest_gap, facts.energy_range
    turned = facts.away is not None and facts.away > settings.near_optimal_angle
    if gap <= Fraction(settings.near_optimal_gap) * scale and not turned:
        within = facts.bounds.meet(Limits(), unique=facts.away is not None)
        own = facts.proof_gap
        fine = own <= max(facts.rounding_cost, Fraction(FINE_PROOF) * scale)
        if gap - own <= facts.rounding_cost and fine and within:
            return PoseVerdict.OPTIMAL
        if not facts.is_elsewhere:
            return PoseVerdict.NEAR_OPTIMAL if facts.is_near(settings) else PoseVerdict.BOUNDED
    if facts.critical is not None and facts.bounds.least_gap > 0:
        return PoseVerdict.SPURIOUS_EQUILIBRIUM
    return PoseVerdict.NOT_AN_EQUILIBRIUM


def spring_sigma_distance(facts: SpringFindings, given: GivenPose) -> SigmaDistance | Absent:
    """The distance from the optimum in standard deviations, where the noise is given.

    The objective is twice the negative log-likelihood: to first order its rise is the square.
    """
    registration = facts.registration
    if registration.covariance is None:
        absent: Absent = registration.stated("covariance")
        return absent
    if not registration.problem.noise_given:
        return NO_NOISE
    if registration.fit.warnings:
        return FIT_WARNED
    if facts.away is None or facts.away > LOOSE_SIGMA:
        return TURNED_FAR
    rise = max(Fraction(0), facts.energy - registration.solution.least)
    value, squared = nearest_root(rise), nearest_double(rise)
    if value is None or squared is None:
        return OUT_OF_RANGE
    dof = registration.problem.motion.parameters_given(translation=given.translation is not None)
    distance = SigmaDistance(value=value, dof=dof, p=math.exp(log_chi2_above(squared, dof)))
    loose = beyond_first_order(registration.covariance)
    return loose if loose is not None and not rules_out(registration, distance) else distance
