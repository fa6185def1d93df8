"""The facts of a pose beside those of the optimum, exactly, and the verdict that they give."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, cast

from certreg.certificate.bounds import ExactPose, PoseBounds
from certreg.errors import UndecidedError
from certreg.exact.dyadic import nearest_double, nearest_root
from certreg.exact.eigenbasis import integer_eigenbasis
from certreg.geometry.so3 import davenport_matrix, dot, rotation_matrix, squared_norm
from certreg.problem.lifting import lift
from certreg.registration.gap_parts import GapParts, gap_parts
from certreg.registration.landscape import AssessmentSettings, PosePlace, landscape_of
from certreg.registration.loose_turns import LOOSE_SIGMA, TURNED_FAR, beyond_first_order
from certreg.registration.misfits import LEVEL
from certreg.registration.tail_probabilities import log_chi2_above
from certreg.results import OUT_OF_RANGE, Absent, Brief, Limits, PoseVerdict

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from certreg.geometry.given import GivenPose
    from certreg.objective.isotropic import Isotropic
    from certreg.objective.springs import Springs
    from certreg.registration.result import PoseWorth, Registration


GOOD = (PoseVerdict.OPTIMAL, PoseVerdict.NEAR_OPTIMAL)
PROJECTION_BITS = 160  # of a nearest rotation: thrice a double's
FINE_PROOF = 1e-24  # of the range of energies: what a turn by 1e-12 radians costs at most
SURELY = 100.0  # standard deviations: a probability below 1e-1000
UNDECIDED = "the optimum could not be certified: nothing is proved of any pose"
NO_NOISE = Absent("no noise was given: give sigma")
NOT_OF_SCALE = Absent("it is not computed where the scale is free")
FIT_WARNED = Absent("the fit has a warning: it would be of the sigma given and right pairs alone")


@dataclass(frozen=True, slots=True, kw_only=True)
class SigmaDistance(Brief):
    """How far a pose is from the optimum by the covariance, to first order; not proved.

    value: sqrt(e^T P^-1 e), in standard deviations: e the rotation vector from the optimum and the
        shift of the source's centroid, P their joint covariance.
    dof: 6; 3 where only a rotation was given, and P is that of the rotation.
    p: the probability that the true pose is as far or farther, if all pairs are right and the
        noise is Gaussian with the sigma that was given: the tail of the chi-squared distribution.
    """

    value: float
    dof: int
    p: float


@dataclass(frozen=True, slots=True, kw_only=True)
class JudgedEnergies(Brief):
    """What a pose and the optimum cost, exactly, or between exact bounds, of any size.

    objective, optimum: of the two. mean_square, least_square: of their RMSE; None where there is
    none. bounds: of objective - minimum. rounding_cost: of rounding the numbers of the optimal pose
    to doubles. of_what: what an RMSE is of.
    """

    objective: Fraction
    optimum: Fraction
    mean_square: Fraction | None
    least_square: Fraction | None
    bounds: PoseBounds
    rounding_cost: Fraction
    of_what: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Findings:
    """The facts on which the verdict rests; energies exact, angles in radians.

    rounding_cost: of the optimal pose. away: to the nearest optimum; None where others may be as
    good. parts: of the gap, where the scale is free.
    """

    registration: Registration
    worth: PoseWorth
    bounds: PoseBounds
    rounding_cost: Fraction
    place: PosePlace
    away: float | None
    parts: GapParts | None

    @property
    def unique(self) -> bool | None:
        """Whether one rotation is optimal; None where that is not decided."""
        return self.registration.solution.unique_rotation

    @property
    def proof_gap(self) -> Fraction:
        """What the proof itself leaves open of the pose."""
        return self.bounds.greatest_gap - self.bounds.least_gap

    @property
    def is_elsewhere(self) -> bool:
        """Whether the equilibrium nearest to the pose is worse than the optimum."""
        return self.place.rest is not None and self.place.rest.worse

    def is_near(self, settings: AssessmentSettings) -> bool:
        """Whether its angle is not in doubt: where uniqueness is not decided, by a proved bound."""
        angle = self.bounds.angle_upper
        proved = angle is not None and angle <= settings.near_optimal_angle
        return proved or self.unique is not None


def findings(
    registration: Registration, pose: ExactPose, cost: Fraction, settings: AssessmentSettings
) -> Findings:
    """What is known of a pose; cost: of rounding the optimal one.

    Raises UndecidedError where the optimum could not be certified.
    """
    solution = registration.solution
    if solution.certificate is None:
        raise UndecidedError(UNDECIDED, method="certificate")
    body = solution.certificate.body
    worth, parts = solution.worth(pose, body), gap_parts(solution.objective, body.gap, pose)
    bounds = cast("PoseBounds", worth.bounds)  # as there is a certificate
    place = landscape_of(registration).place(solution, pose, bounds, parts, settings)
    away, proved = place.away, bounds.angle_upper  # proved from more bits than it is computed
    return Findings(
        registration=registration,
        worth=worth,
        bounds=bounds,
        rounding_cost=cost,
        place=place,
        away=away if away is None or proved is None else min(away, proved),
        parts=parts,
    )


def verdict_of(facts: Findings, settings: AssessmentSettings) -> PoseVerdict:
    """The verdict: by the proved gap, by the angle, and by the equilibrium that the pose is at.

    A small gap may only mean that little is at stake, which at a worse equilibrium it does. Where
    uniqueness is not decided, a proved angle to every optimum shows that it means more.
    """
    gap, scale = facts.bounds.greatest_gap, facts.place.energy_range
    turned = facts.away is not None and facts.away > settings.near_optimal_angle
    if gap <= Fraction(settings.near_optimal_gap) * scale and not turned:
        within = facts.bounds.meet(Limits(), unique=facts.unique is True)
        own = facts.proof_gap
        fine = own <= max(facts.rounding_cost, Fraction(FINE_PROOF) * scale)
        if gap - own <= facts.rounding_cost and fine and within:
            return PoseVerdict.OPTIMAL
        if not facts.is_elsewhere:
            return PoseVerdict.NEAR_OPTIMAL if facts.is_near(settings) else PoseVerdict.BOUNDED
    rest = facts.place.rest
    if rest is not None and rest.here and facts.bounds.least_gap > 0:
        return PoseVerdict.SPURIOUS_EQUILIBRIUM
    return PoseVerdict.NOT_AN_EQUILIBRIUM


def sigma_distance(facts: Findings, given: GivenPose, least: Fraction) -> SigmaDistance | Absent:
    """The distance of a pose from the optimum in standard deviations; Absent without a sigma.

    least: the energy of the optimum.

    The objective is twice the negative log-likelihood: to first order its rise is the square. A
    rotation by a vector phi costs phi^T (G / 2) phi, G half the Hessian, and the energy of a large
    one is stretched to that: so no covariance is inverted, and nothing cancels. Absent, too, where
    the fit has a warning, as the optimum may then be off by more than the noise, and where the turn
    is beyond a first order; of a loose one it is told only where it rules the pose out.
    """
    registration, away = facts.registration, facts.away
    covariance = registration.covariance
    if covariance is None:
        absent: Absent = registration.stated("covariance")
        return absent
    if (why := _no_distance(facts)) is not None:
        return why
    if away is None or away > LOOSE_SIGMA:
        return TURNED_FAR
    shifted = facts.place.translation_energy
    square = facts.place.stretch * max(Fraction(0), facts.worth.energy - shifted - least) + shifted
    value, squared = nearest_root(square), nearest_double(square)
    if value is None:
        return OUT_OF_RANGE
    dof = registration.problem.motion.parameters_given(translation=given.translation is not None)
    p = 0.0 if squared is None else math.exp(log_chi2_above(squared, dof))
    distance = SigmaDistance(value=value, dof=dof, p=p)
    loose = beyond_first_order(covariance)
    return loose if loose is not None and not rules_out(registration, distance) else distance


def _no_distance(facts: Findings) -> Absent | None:
    """Why no distance is told, wherever the pose is; None where one may be."""
    if facts.parts is not None:
        return NOT_OF_SCALE
    if not facts.registration.problem.noise_given:
        return NO_NOISE
    return FIT_WARNED if facts.registration.fit.warnings else None


def rules_out(registration: Registration, distance: SigmaDistance) -> bool:
    """Whether the noise rules a pose out: the true one is as far with a probability below LEVEL.

    Of a fit without a warning, as the distance is.
    Where the residuals are larger than sigma says, so is the noise, and the distance is as much
    smaller.
    """
    covariance = registration.covariance
    factor = None if covariance is None else covariance.variance_factor
    value = distance.value / math.sqrt(max(1.0, factor or 1.0))
    return value >= SURELY or log_chi2_above(value**2, distance.dof) <= math.log(LEVEL)


def exact_pose(
    objective: Isotropic | Springs, given: GivenPose, centre: Sequence[Fraction]
) -> ExactPose:
    """Exactly the pose that is judged; centre: of the source.

    A quaternion is normalised. A matrix M is taken as the nearest rotation, turned about the centre
    so that this goes where the matrix takes it, and, where there is a scale, with tr(R^T M) / 3 of
    it. Without a translation, with the best one; without a scale, too, with the best of that.
    """
    q, scale = nearest_quaternion(given.turn), Fraction(1 if given.scale is None else given.scale)
    if given.translation is None:
        best = ExactPose(
            quaternion=q,
            translation=objective.best_translation(q),
            scale=objective.best_scale(q),
        )
        if given.scale is None:
            return best
        image = best.moved(centre)
    else:
        moved = [scale * entry for entry in turned(given.turn, centre)]
        image = added(moved, [Fraction(t) for t in given.translation.tolist()])
    if given.is_matrix and given.scale is not None:
        rows = zip(rotation_matrix(q), given.turn.tolist(), strict=True)
        held = sum(dot(a, [Fraction(entry) for entry in b]) for a, b in rows)
        scale *= held * Fraction(1, 3 * squared_norm(q))
    return replace(pose_through(q, [scale * entry for entry in centre], image), scale=scale)


def nearest_quaternion(turn: NDArray[np.float64]) -> tuple[int, ...]:
    """An integer quaternion (4,) as it is; of a matrix (3, 3) that of the nearest rotation.

    That maximises tr(R^T A): the first eigenvector of A's Davenport matrix, far beyond doubles.
    """
    entries = lift(turn.ravel()).integers
    if turn.shape == (4,):
        return tuple(entries)
    nearest = davenport_matrix((entries[:3], entries[3:6], entries[6:]))
    return tuple(integer_eigenbasis(nearest, PROJECTION_BITS).vectors[0])


def pose_through(
    q: Sequence[int], point: Sequence[Fraction], image: Sequence[Fraction]
) -> ExactPose:
    """The pose with the rotation of q that takes a point to its image."""
    moved = rotated(q, point)
    shift = tuple(a - b for a, b in zip(image, moved, strict=True))
    return ExactPose(quaternion=tuple(q), translation=shift)


def rotated(q: Sequence[int], point: Sequence[Fraction]) -> list[Fraction]:
    """R(q) x, for an integer quaternion, normalised."""
    share = Fraction(1, squared_norm(q))
    return [dot(row, point) * share for row in rotation_matrix(q)]


def turned(turn: NDArray[np.float64], point: Sequence[Fraction]) -> list[Fraction]:
    """A x exactly: of a matrix (3, 3) as it is, of a quaternion (4,) normalised."""
    if turn.shape == (4,):
        return rotated(nearest_quaternion(turn), point)
    return [dot([Fraction(a) for a in row], point) for row in turn.tolist()]


def added(a: Sequence[Fraction], b: Sequence[Fraction]) -> list[Fraction]:
    """The sum of two vectors."""
    return [x + y for x, y in zip(a, b, strict=True)]
