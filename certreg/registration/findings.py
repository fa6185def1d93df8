"""The facts of a pose beside those of the optimum, exactly, and the verdict that they give."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

from certreg.certificate.bounds import ExactPose, flat_energy, pose_bounds, pose_energy
from certreg.errors import UndecidedError
from certreg.exact.dyadic import nearest_double, nearest_root
from certreg.exact.eigenbasis import integer_eigenbasis
from certreg.geometry.pose_matrix import ROTATION_TOLERANCE
from certreg.geometry.similarity import Similarity
from certreg.geometry.so3 import davenport_matrix, rotation_matrix, squared_norm
from certreg.problem.lifting import lift
from certreg.registration.loose_turns import LOOSE_SIGMA, TURNED_FAR, beyond_first_order
from certreg.registration.misfits import LEVEL
from certreg.registration.rounding import rounding_cost
from certreg.registration.scaled_poses import GapParts, gap_parts, scaled_rounding_cost
from certreg.registration.tails import log_chi2_above
from certreg.results import OUT_OF_RANGE, Absent, Brief, Limits, PoseVerdict

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from certreg.certificate.bounds import PoseBounds
    from certreg.geometry.given import GivenPose
    from certreg.objective.isotropic import Isotropic
    from certreg.registration.linear import LinearSolution
    from certreg.registration.result import Registration


GOOD = (PoseVerdict.OPTIMAL, PoseVerdict.NEAR_OPTIMAL)
PROJECTION_BITS = 160  # of a nearest rotation: thrice a double's
SURELY = 100.0  # standard deviations: a probability below 1e-1000
UNDECIDED = "the optimum could not be certified: nothing is proved of any pose"
NO_NOISE = Absent("no noise was given: give sigma")
NOT_OF_SCALE = Absent("it is not computed where the scale is free")
FIT_WARNED = Absent("the fit has a warning: it would be of the sigma given and right pairs alone")


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
class Findings:
    """The facts on which the verdict rests; energies exact, angles in radians."""

    registration: Registration
    bounds: PoseBounds
    rounding_cost: Fraction  # of the optimal pose, see `certreg.registration.rounding`
    energy: Fraction
    squares: Fraction  # sum w |y - s R x - t|^2
    translation_energy: Fraction  # what the translation adds to the best one
    energy_range: Fraction  # the scale that says which energies are small
    angles: list[float]  # to each component of equilibria
    nearest: int  # the component of the least angle
    parts: GapParts | None = None  # of the gap, where the scale is free

    @property
    def unique(self) -> bool:
        """Whether there is one optimum."""
        return self.registration.equilibria.classification.unique

    @property
    def away(self) -> float:
        """The angle to the nearest optimum."""
        return self.angles[0]


@dataclass(frozen=True, slots=True, kw_only=True)
class JudgedEnergies(Brief):
    """The energies of a pose and of the optimum, exactly, or between exact bounds, of any size.

    objective, optimum: of the two. bounds: of objective - minimum. rounding_cost: of rounding the
    numbers of the optimal pose to doubles. total_weight: of which they are sums. of_what: what an
        RMSE is of.
    """

    objective: Fraction
    optimum: Fraction
    bounds: PoseBounds
    rounding_cost: Fraction
    total_weight: Fraction
    of_what: str = "weighted"

    @classmethod
    def of(cls, facts: Findings) -> JudgedEnergies:
        """Of a pose that was judged."""
        objective = facts.registration.solution.objective
        return cls(
            objective=facts.energy,
            optimum=objective.energy(objective.optimum),
            bounds=facts.bounds,
            rounding_cost=facts.rounding_cost,
            total_weight=objective.moments.total_weight,
        )


def findings(registration: Registration, pose: ExactPose, cost: Fraction) -> Findings:
    """What is known of a pose; cost: of rounding the optimal one.

    Raises UndecidedError where the optimum could not be certified.
    """
    solution = registration.solution
    objective, q = solution.objective, pose.quaternion
    angles = [objective.angle_to(i, q) for i in range(len(objective.classification.pattern))]
    if solution.certificate is None:
        raise UndecidedError(UNDECIDED, method="certificate")
    shifted = objective.translation_energy(q, pose.translation, pose.scale)
    energy, body = pose_energy(objective, pose, shifted), solution.certificate.body
    bounds = pose_bounds(objective, body, pose, shifted=shifted, energy=energy)
    if bounds.angle_upper is not None:  # proved from more bits than a computed angle has
        angles[0] = min(angles[0], bounds.angle_upper)
    return Findings(
        registration=registration,
        bounds=bounds,
        rounding_cost=cost,
        energy=energy,
        squares=objective.squares(energy, pose.scale),
        translation_energy=shifted,
        energy_range=_energy_range(solution),
        angles=angles,
        nearest=min(range(len(angles)), key=angles.__getitem__),
        parts=gap_parts(objective, body.gap, pose),
    )


def _energy_range(solution: LinearSolution) -> Fraction:
    """Energy between the best and the worst rotation; the clouds' own where all are equal."""
    objective, moments = solution.objective, solution.moments
    spaces = len(objective.classification.pattern)
    if objective.scaling is not None:
        worst, best = (objective.energy(objective.quaternions[k]) for k in (-1, 0))
        return worst - best if spaces > 1 else flat_energy(moments)
    if spaces > 1:
        return 2 * objective.eigenvalue_difference(0, spaces - 1)
    return flat_energy(moments)


def verdict_of(facts: Findings, settings: AssessmentSettings) -> PoseVerdict:
    """The verdict: by the angle first, as a small gap may only mean that little is at stake."""
    scale = facts.energy_range
    settled = facts.angles[facts.nearest] <= settings.equilibrium_angle
    if facts.translation_energy > Fraction(settings.equilibrium_shift) ** 2 * scale:
        settled = False
    if facts.parts is not None and not _scale_settled(facts, settings):
        settled = False
    if facts.nearest > 0:
        return PoseVerdict.SPURIOUS_EQUILIBRIUM if settled else PoseVerdict.NOT_AN_EQUILIBRIUM
    gap, away = facts.bounds.greatest_gap, facts.away
    if gap > Fraction(settings.near_optimal_gap) * scale or away > settings.near_optimal_angle:
        return PoseVerdict.NOT_AN_EQUILIBRIUM
    if gap <= facts.rounding_cost and facts.bounds.meet(Limits(), unique=facts.unique):
        return PoseVerdict.OPTIMAL
    return PoseVerdict.NEAR_OPTIMAL


def _scale_settled(facts: Findings, settings: AssessmentSettings) -> bool:
    """Whether the scale is the best one for a rotation, and positive: a symmetric one always is."""
    objective, parts = facts.registration.solution.objective, facts.parts
    if parts is None or not objective.best_scale(objective.quaternions[facts.nearest]):
        return False
    return parts.scale <= Fraction(settings.equilibrium_shift) ** 2 * facts.energy_range


def sigma_distance(facts: Findings, given: GivenPose) -> SigmaDistance | Absent:
    """The distance of a pose from the optimum by the joint covariance; Absent without a sigma.

    In e = (c, phi), c the shift of the source's centroid and phi = a u the rotation vector, P^-1 is
    M and half the Hessian G, with no entries between them. The energy of the rotation is
    2 sin^2(a/2) times sum (l1 - lk) u_k^2, and phi^T (G / 2) phi is a^2 / 2 times the same sum: so
    no covariance is inverted, and nothing cancels. Absent, too, where the fit has a warning, as
    the optimum may then be off by more than the noise, and where the turn is beyond a first
    order; of a loose one it is told only where it rules the pose out.
    """
    solution, covariance = facts.registration.solution, facts.registration.solution.covariance
    if facts.registration.problem.scaled or covariance is None:
        absent: Absent = NOT_OF_SCALE if covariance is not None else solution.stated("covariance")
        return absent
    if not facts.registration.problem.noise_given:
        return NO_NOISE
    if facts.registration.fit.warnings:
        return FIT_WARNED
    if facts.away > LOOSE_SIGMA:
        return TURNED_FAR
    least, half = solution.objective.energy(solution.objective.optimum), facts.away / 2
    stretch = Fraction(half / math.sin(half)) if half else Fraction(1)
    turned = max(Fraction(0), facts.energy - facts.translation_energy - least)
    square = stretch**2 * turned + facts.translation_energy
    value, squared = nearest_root(square), nearest_double(square)
    if value is None:
        return OUT_OF_RANGE
    dof = facts.registration.problem.motion.parameters_given(
        translation=given.translation is not None
    )
    p = 0.0 if squared is None else math.exp(log_chi2_above(squared, dof))
    distance, loose = SigmaDistance(value=value, dof=dof, p=p), beyond_first_order(covariance)
    return loose if loose is not None and not rules_out(facts.registration, distance) else distance


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


def cost_of_rounding(
    registration: Registration, given: GivenPose, *, inverse: bool = False
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
    if isinstance(pose, Similarity):
        return scaled_rounding_cost(objective, pose, turn, shift)
    return rounding_cost(objective, turn, shift, centre)


def exact_pose(objective: Isotropic, given: GivenPose) -> ExactPose:
    """Exactly the pose that is judged.

    A quaternion is normalised. A matrix is taken as the nearest rotation, turned about the source's
    centroid, so that this goes where the matrix takes it. Without a translation, with the best one.
    """
    q = nearest_quaternion(given.turn)
    if given.translation is None and (objective.scaling is None or given.scale is None):
        best = objective.best_translation(q)
        return ExactPose(quaternion=q, translation=best, scale=objective.best_scale(q))
    if objective.scaling is not None or given.translation is None:
        return _scaled_pose(objective, q, given)
    x = objective.moments.source_centroid
    shift = [Fraction(t) for t in given.translation.tolist()]
    if not given.is_matrix:
        return ExactPose(quaternion=q, translation=tuple(shift))
    return pose_through(q, x, added(turned(given.turn, x), shift))


def _scaled_pose(objective: Isotropic, q: tuple[int, ...], given: GivenPose) -> ExactPose:
    """With the scale of a matrix M, tr(R^T M) / 3, exactly; without a translation with the best."""
    moments, scale = objective.moments, Fraction(1 if given.scale is None else given.scale)
    held, x = Fraction(1), list(moments.source_centroid)
    if given.is_matrix:
        rows = zip(rotation_matrix(q), given.turn.tolist(), strict=True)
        held = sum((_sum_of_products(a, list(map(Fraction, b))) for a, b in rows), Fraction(0))
        held /= 3 * squared_norm(q)
    image = list(moments.target_centroid)
    if given.translation is not None:
        moved = [scale * entry for entry in turned(given.turn, x)]
        image = added(moved, [Fraction(t) for t in given.translation.tolist()])
    pose = pose_through(q, [scale * held * entry for entry in x], image)
    return replace(pose, scale=scale * held)


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
    norm = squared_norm(q)
    return [_sum_of_products(row, point) / norm for row in rotation_matrix(q)]


def turned(turn: NDArray[np.float64], point: Sequence[Fraction]) -> list[Fraction]:
    """A x exactly: of a matrix (3, 3) as it is, of a quaternion (4,) normalised."""
    if turn.shape == (4,):
        return rotated(nearest_quaternion(turn), point)
    return [_sum_of_products([Fraction(a) for a in row], point) for row in turn.tolist()]


def added(a: Sequence[Fraction], b: Sequence[Fraction]) -> list[Fraction]:
    """The sum of two vectors."""
    return [x + y for x, y in zip(a, b, strict=True)]


def _sum_of_products(row: Sequence[Fraction | int], point: Sequence[Fraction]) -> Fraction:
    return sum((a * x for a, x in zip(row, point, strict=True)), start=Fraction(0))
