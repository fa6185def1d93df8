"""Uncertainty of the optimal pose: a covariance to first order, and residuals per point.

The objective is twice the negative log-likelihood of Gaussian noise on the target, but a constant:
of covariance W^-1, or, where W has no inverse, along its springs alone. With the error model
R_true = R exp([phi]), phi in the source's (body) frame, t_true = t + dt in the target's frame and,
where the scale is free, s_true = s + ds, the best translation follows (phi, ds) by a matrix L, and

    cov(phi, ds) = P,    cov(dt, (phi, ds)) = L P,    cov(dt) = S^-1 + L P L^T,

P the inverse of half the Hessian of the objective over (phi, ds), S = sum W. Without a translation
dt is 0. Of one weight per pair P = 2 G^-1 and L = R [m], m the mean source point; claims
`covariance` and `scale_covariance`.

To second order the turn moves t by -theta x (theta x R m) / 2 more, theta = R phi. Along an axis e
that is theta^T A theta / 2 with a = R m, A = (a . e) I - (a e^T + e a^T) / 2; of a Gaussian theta
with covariance C C^T the mean of its square is ((tr B)^2 + 2 |B|^2) / 4, B = C^T A C.

Source: Gauss-Markov theory for the linearised problem; the Hessian as in `Neighbourhood`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import hypot, inf
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import cached_property
from certreg.equilibrium.equilibrium_set import rotation_double
from certreg.exact.dyadic import (
    dyadic_below,
    nearest_double,
    nearest_or_zero,
    power_of_two,
    root_of_quotient,
)
from certreg.objective.neighbourhood import Neighbourhood
from certreg.problem.arrays import contiguous, row_blocks
from certreg.problem.motion import TRANSLATION, Scale
from certreg.results import OUT_OF_RANGE, Absent, Explained, present

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.geometry.pose import Pose
    from certreg.geometry.similarity import Similarity
    from certreg.objective.isotropic import Isotropic
    from certreg.problem.problem import RegistrationProblem
    from certreg.problem.terms import Pairs

PARAMETERS = 6  # of a pose in a matrix: a translation that is given has rows of 0 there
TURN = 3  # where its rotation begins
GIVEN_ROWS = ((TRANSLATION, TURN),)  # how many are 0 where it is not found
# Six entries rounded once change the correlations by a matrix of norm 6 / 2^53 at most, so every
# variance computed with them by less than this share of itself: a hundredth.
LEAST_CORRELATION = 100 * 6 / 2**53
NOT_UNIQUE = Absent("the optimum is not unique")
NO_VARIANCE = Absent(
    "fewer than three points with weight leave no degree of freedom for the noise: give sigma"
)
FEW_CARRY = Absent(
    "the weights differ so much that few points carry the fit, and without sigma nothing says that "
    "they stand for noise: give sigma"
)
NO_RESIDUALS = Absent("the residuals are so near rounding that they tell no noise: give sigma")
BIASED = {  # what is said in the place of a covariance, by the scale
    Scale.SYMMETRIC: Absent(
        "noise in the target makes the symmetric scale too large, of many points by more than it "
        "scatters, which no covariance tells"
    )
}
TURNED = Absent("without a translation the source's mean goes where the rotation takes it")
NO_SCALE = Absent("the scale was not asked for")
NOT_TOLD_APART = Absent("the two best eigenvalues are not told apart")
NO_FREEDOM = Absent(
    "the springs leave no degree of freedom for the noise: give sigma, or covariances"
)
FLAT = Absent("the springs hardly resist a move of the pose: to first order it is undetermined")
SCALE_BITS = 160  # of an optimal scale: its error counts by its square
LEAST_CURVATURE = 1e-12  # of the largest, in the clouds' own unit: less is rounding
LOST = "lost in rounding: variances computed with a matrix of doubles would be wrong, even negative"
FAR = Absent(f"{LOST}, so far are the points from the origin: move it to them")
LOOSE = Absent(f"{LOST}: one turn is hardly determined, beside the others")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PoseCovariance(Explained):
    """Covariance of a pose, in three conventions.

    matrix: (6, 6), order (dt, phi): translation in the target's frame and unit squared, then the
        rotation vector phi in the source's frame, radians; R_true = R exp([phi]), t_true = t + dt.
        (7, 7) where the scale is free, the scale last, s_true = s + ds. Without a translation,
        which is given then, the rows and columns of dt are 0. None where doubles do not hold it: a
        variance of something moved, computed with it, could be off by more than a hundredth, or
        negative.
    translation_sigma: (3,), one standard deviation of t, along the target's axes, in the unit of
        length. t is where the source's origin goes: far from the points its lever makes this large.
    second_order: the largest share of a translation_sigma that the second order of the turn is, as
        a root mean square: where it is not small, translation_sigma is not what it says.
    rotation_sigma: (3,), one standard deviation of phi, about the source's axes, in radians.
    loosest_sigma, loosest_axis: the largest standard deviation of phi along any axis, radians, and
        that unit axis (3,).
    variance_factor: objective / degrees_of_freedom, near 1 if the given sigma is right; None if
        there are none.
    degrees_of_freedom: of the residuals, 3 N - 6; N counts the points with weight. One less where
        the scale is free, three more without a translation.
    centre_sigma: standard deviation, along any axis, of where the weighted mean of the source goes:
        of that no rotation moves it, it is the least that a point of the source can have. None
        without a translation.
    estimated: whether all this was scaled by the variance factor, because no noise was given.
    rotation: (3, 3), the R of the pose.
    scale_sigma: one standard deviation of a free scale; None of others.

    The standard deviations are roots of exact sums, each rounded once.
    """

    matrix: NDArray[np.float64] | None
    translation_sigma: NDArray[np.float64]
    second_order: float
    rotation_sigma: NDArray[np.float64]
    loosest_sigma: float
    loosest_axis: NDArray[np.float64]
    variance_factor: float | None
    degrees_of_freedom: int
    centre_sigma: float | None
    estimated: bool
    rotation: NDArray[np.float64]
    scale_sigma: float | None = None

    def __array__(
        self,
        dtype: Any = None,
        copy: bool | None = None,  # noqa: FBT001 - so NumPy calls it
    ) -> NDArray[Any]:
        if self.matrix is None:
            reason: Absent = self.stated("matrix")
            raise ValueError(reason.reason)
        return np.array(self.matrix, dtype=dtype, copy=copy)

    @property
    def ros(self) -> NDArray[np.float64] | None:
        """The (6, 6) of ROS PoseWithCovariance: (x, y, z, about X, Y, Z).

        All in the target's (fixed) frame: R_true = exp([theta]) R, theta = R phi. Of a free scale
        it says nothing.
        """
        still = np.zeros((3, 3))
        return self._in(np.block([[np.eye(3), still], [still, self.rotation]]))

    @property
    def gtsam(self) -> NDArray[np.float64] | None:
        """The (6, 6) of gtsam.Pose3: (phi, v), rotation first, both in the body frame.

        T_true = T Exp((phi, v)), to first order t_true = t + R v. Of a free scale it says nothing.
        """
        still = np.zeros((3, 3))
        return self._in(np.block([[still, np.eye(3)], [self.rotation.T, still]]))

    def _in(self, change: NDArray[np.float64]) -> NDArray[np.float64] | None:
        return None if self.matrix is None else change @ self.matrix[:6, :6] @ change.T


@dataclass(frozen=True, slots=True, kw_only=True)
class Conditions:
    """What an optimum must be to have a covariance, and what is said of one that is not.

    least_curvature: of half the Hessian about the centre of the points, each direction in its own
        unit, as a share of the largest. 0: that the optimum is unique is decided exactly.
    """

    no_freedom: Absent
    undetermined: Absent
    least_curvature: float


OF_WEIGHTS = Conditions(no_freedom=NO_VARIANCE, undetermined=NOT_TOLD_APART, least_curvature=0.0)
OF_SPRINGS = Conditions(no_freedom=NO_FREEDOM, undetermined=FLAT, least_curvature=LEAST_CURVATURE)


def pose_covariance(problem: RegistrationProblem, objective: Isotropic) -> PoseCovariance | Absent:
    """The covariance of the optimal pose of one weight per pair, as `covariance_at`.

    Absent also of a symmetric scale, which noise in the target shifts.
    """
    if (biased := BIASED.get(problem.scale)) is not None:
        return biased
    if not objective.classification.unique:
        return NOT_UNIQUE
    q = objective.optimum
    scale = dyadic_below(objective.best_scale(q), SCALE_BITS).value
    return covariance_at(
        problem,
        Neighbourhood(objective.reduced, q, problem.motion, scale),
        objective.moments.source_centroid,
        least=objective.energy(q),
        carried=lambda: 6 * effective_rows(problem) >= problem.observations,
        conditions=OF_WEIGHTS,
    )


def covariance_at(
    problem: RegistrationProblem,
    near: Neighbourhood,
    centre: Sequence[Fraction],
    *,
    least: Fraction,
    carried: Callable[[], bool],
    conditions: Conditions,
) -> PoseCovariance | Absent:
    """The covariance of a unique optimum; Absent if it is flat or doubles overflow.

    centre: a point of the source amid the others. least: the objective. carried: whether at least
    half of the rows carry the weights. Where no noise was given the variance is estimated, which
    takes degrees of freedom, residuals that are not all zero, and such rows: relative weights say
    little of noise, and rows that hardly count would count as degrees of freedom.
    """
    degrees, variance = problem.degrees_of_freedom, _variance(problem, least, carried, conditions)
    if isinstance(variance, Absent):
        return variance
    fault = _flatness(near, centre, conditions)
    if fault is not None:
        return fault
    given = sum(near.motion.lacking(GIVEN_ROWS))
    whole, shifted = _propagated(near, variance, given)
    if whole.sigmas is None or shifted.sigmas is None:
        return OUT_OF_RANGE
    translation, rotation = whole.sigmas[:TURN], rotation_double(near.quaternion)
    turning = whole.factor(slice(TURN, None))
    middle = np.hstack([shifted.factor(), near.moves(centre) @ turning])
    if not np.isfinite(middle).all():
        return OUT_OF_RANGE
    matrix = _in_doubles(whole, given)
    axes, sizes, _ = np.linalg.svd(turning[:TURN])
    size = next(iter(whole.sigmas[PARAMETERS:].tolist()), None)
    arm = [0.0 if given else nearest_or_zero(near.scale * entry) for entry in centre]
    swung = second_order(rotation @ turning[:TURN], rotation @ arm, translation)
    if size is not None and any(arm):  # ds theta x R m beside s theta x R m, of which dt has more
        swung = hypot(swung, nearest_or_zero(Fraction(size) / near.scale))
    return PoseCovariance(
        matrix=present(matrix),
        translation_sigma=translation,
        second_order=swung,
        rotation_sigma=whole.sigmas[TURN:PARAMETERS],
        loosest_sigma=float(sizes[0]),
        loosest_axis=axes[:, 0] * np.sign(axes[np.argmax(np.abs(axes[:, 0])), 0]),
        variance_factor=nearest_double(least / degrees) if degrees > 0 else None,
        degrees_of_freedom=max(degrees, 0),
        centre_sigma=None if given else float(np.linalg.norm(middle, 2)),
        estimated=not problem.noise_given,
        rotation=rotation,
        scale_sigma=size,
        absent={
            "scale_sigma": NO_SCALE,
            "centre_sigma": TURNED,
            "variance_factor": conditions.no_freedom if degrees <= 0 else OUT_OF_RANGE,
            **({"matrix": matrix} if isinstance(matrix, Absent) else {}),
        },
    )


def _variance(
    problem: RegistrationProblem,
    least: Fraction,
    carried: Callable[[], bool],
    conditions: Conditions,
) -> Fraction | Absent:
    """Of weight one; arguments as of `covariance_at`."""
    if problem.noise_given:
        return Fraction(1)
    degrees = problem.degrees_of_freedom
    if degrees <= 0 or least <= 0:
        return conditions.no_freedom if degrees <= 0 else NO_RESIDUALS
    return least / degrees if carried() else FEW_CARRY


def _flatness(
    near: Neighbourhood, centre: Sequence[Fraction], conditions: Conditions
) -> Absent | None:
    """Why some move is hardly resisted; None where each is."""
    if near.inverse is None or not conditions.least_curvature:
        return conditions.undetermined if near.inverse is None else None
    half = near.half_hessian(centre)
    if not np.isfinite(half).all():
        return OUT_OF_RANGE
    sizes = np.sqrt(np.maximum(np.diag(half), 0.0))
    if not sizes.all():
        return conditions.undetermined
    levels = np.linalg.eigvalsh(half / sizes / sizes[:, np.newaxis])
    told = levels[0] > conditions.least_curvature * levels[-1]
    return None if told else conditions.undetermined


@dataclass(frozen=True, kw_only=True)
class RationalMatrix:
    """A covariance of rational numbers, as integers over one denominator."""

    rows: Any  # an array of Python's integers
    denominator: int

    @cached_property
    def sigmas(self) -> NDArray[np.float64] | None:
        """The roots of the diagonal, each rounded once; None beyond the doubles."""
        roots = [root_of_quotient(entry, self.denominator) for entry in self.rows.diagonal()]
        return None if None in roots else np.array(roots, dtype=np.float64)

    def factor(self, chosen: slice = slice(None)) -> NDArray[np.float64]:
        """F with F F^T a part of the matrix, in doubles: independent deviations in its columns."""
        deviations: Any = self.sigmas
        rows, sigmas = self.rows[chosen, chosen], deviations[chosen]
        own = np.array([entry or 1 for entry in rows.diagonal()], dtype=object)
        shares, sizes = rows / own[:, np.newaxis], np.where(sigmas > 0.0, sigmas, 1.0)
        levels, axes = np.linalg.eigh(shares.astype(np.float64) * sizes[:, np.newaxis] / sizes)
        return sigmas[:, np.newaxis] * axes * np.sqrt(np.maximum(levels, 0.0))


def _propagated(
    near: Neighbourhood, variance: Fraction, given: int
) -> tuple[RationalMatrix, RationalMatrix]:
    """Exactly, of (dt, phi) and a free scale, and of dt where these are fixed.

    given: so many rows of dt are 0.
    """
    inverse: Any = near.inverse
    form, (adjugate, determinant), (moves, over) = near.form, inverse, near.shifts
    length, weight = power_of_two(2 * form.length_exponent), variance / form.unit
    moves = np.concatenate([moves, over * np.eye(len(adjugate), dtype=int).astype(object)])
    rows = 2 * weight.numerator * (moves @ adjugate @ moves.T)
    own = np.array(form.compliance, dtype=object)
    own[:given] = 0
    own = weight.numerator * length.numerator * own
    rows[:TURN, :TURN] += determinant * own
    below = weight.denominator * (over // near.over) ** 2
    return (
        RationalMatrix(rows=rows, denominator=determinant * below),
        RationalMatrix(rows=own, denominator=below),
    )


def _in_doubles(exact: RationalMatrix, given: int = 0) -> NDArray[np.float64] | Absent:
    """Each entry rounded once; Absent where that loses too much. given: so many rows are 0."""
    try:
        matrix = np.array([[entry / exact.denominator for entry in row] for row in exact.rows])
    except OverflowError:
        return OUT_OF_RANGE
    free = matrix[given:, given:]
    least = np.diag(free).min()  # below the normal doubles digits are lost
    if not np.isfinite(matrix).all() or least < np.finfo(np.float64).tiny:
        return OUT_OF_RANGE
    limit = LEAST_CORRELATION * max(len(matrix), PARAMETERS) / PARAMETERS
    if least_correlation(free) >= limit:
        return matrix
    return LOOSE if least_correlation(matrix[TURN:, TURN:]) < limit else FAR


def second_order(
    turns: NDArray[np.float64], arm: NDArray[np.float64], sigmas: NDArray[np.float64]
) -> float:
    """The largest share of a deviation of t that the second order of the turn is; inf if beyond.

    turns: (3, 3), in its columns independent turns of one deviation, target's frame; arm: R m;
    sigmas: (3,), the deviations of t.
    """
    unit = float(np.abs(arm).max())
    if not unit:
        return 0.0
    axes, arm = np.eye(3), arm / unit
    outer = axes[:, :, np.newaxis] * arm  # e a^T, of each axis
    bends = arm[:, np.newaxis, np.newaxis] * axes - (outer + outer.transpose(0, 2, 1)) / 2
    with np.errstate(all="ignore"):
        forms = turns.T @ bends @ turns
        traces, squares = np.trace(forms, axis1=1, axis2=2), (forms * forms).sum(axis=(1, 2))
        shares = np.sqrt(traces * traces + 2.0 * squares) / 2.0 / (sigmas / unit)
    return float(shares.max()) if np.isfinite(shares).all() else inf


def least_correlation(matrix: NDArray[np.float64]) -> float:
    """The least eigenvalue of a covariance divided by the standard deviations."""
    sigmas = np.sqrt(np.diag(matrix))
    return float(np.linalg.eigvalsh(matrix / sigmas / sigmas[:, None])[0])


def residual_distances(
    points: RegistrationProblem | Pairs, pose: Pose | Similarity
) -> NDArray[np.float64]:
    """(N,), |y_i - R x_i - t|, in the unit of length; no square of a length is formed."""
    with np.errstate(over="ignore", invalid="ignore"):
        x, y, z = (points.target - pose.apply(points.source)).T
        return np.hypot(np.hypot(x, y), z)


@dataclass(frozen=True, slots=True, kw_only=True)
class Residual:
    """How badly a correspondence fits: its row, and |y - R x - t| in the unit of length."""

    row: int
    distance: float


def worst_residuals(
    problem: RegistrationProblem, pose: Pose | Similarity, count: int
) -> list[Residual]:
    """The correspondences with the largest distances, largest first; of equal ones the first.

    Those whose distance no double holds are left out.
    """
    worst: list[Residual] = []
    for rows in row_blocks(problem.n):
        distances = residual_distances(problem.block(rows), pose)
        known = np.flatnonzero(np.isfinite(distances))
        worst = largest(worst, rows.start + known, distances[known], count)
    return worst


def largest(
    known: list[Residual],
    rows: NDArray[np.integer[Any]],
    distances: NDArray[np.float64],
    count: int,
) -> list[Residual]:
    """So many of those known and these, the largest first; of equal ones the first."""
    least = known[-1].distance if len(known) == count else 0.0
    if len(rows) > count:
        least = max(least, float(np.partition(distances, -count)[-count]))
    places = np.flatnonzero(distances >= least)
    places = places[np.argsort(-distances[places], kind="stable")[:count]]
    more = [Residual(row=int(rows[k]), distance=float(distances[k])) for k in places.tolist()]
    return sorted([*known, *more], key=lambda one: (-one.distance, one.row))[:count]


def effective_rows(problem: RegistrationProblem) -> float:
    """(sum w)^2 / sum w^2: as many rows as there are if all have one weight.

    By Satterthwaite a sum of squares whose variances are w is like a chi-squared variable of so
    many degrees.
    """
    blocks = list(row_blocks(problem.n))
    largest = max(float(contiguous(problem.weights, rows).max()) for rows in blocks)
    total = squares = 0.0
    for rows in blocks:
        shares = contiguous(problem.weights, rows) / largest
        total += float(shares.sum())
        squares += float(shares @ shares)
    return total**2 / squares
