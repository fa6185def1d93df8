"""Uncertainty of the optimal pose: a covariance to first order, and residuals per point.

The objective is twice the negative log-likelihood of Gaussian noise on the target, but a constant.
With the error model R_true = R exp([phi]), phi in the source's (body) frame, and t_true = t + dt in
the target's frame, P = 2 G^-1 (G the Hessian at the optimum) and mean source point m:

    cov(phi) = P,    cov(dt, phi) = R [m] P,    cov(dt) = I / M + R [m] P [m]^T R^T.

Where the scale s of the asymmetric objective is free, s_true = s + ds, P = 2 (s G)^-1 with G of the
same matrix C, var(ds) = 1 / Sxx, ds and phi are uncorrelated, and dt = e + s R [m] phi - R m ds, e
the mean of the noise: the normal equations of e - ds R x~ + s R [x~] phi, whose blocks are Sxx and
s^2 J, J the inertia, with none between them. Without a translation dt is 0, and sums are about the
origin. Claims `covariance` and `scale_covariance`.

To second order the turn moves t by -theta x (theta x R m) / 2 more, theta = R phi. Along an axis e
that is theta^T A theta / 2 with a = R m, A = (a . e) I - (a e^T + e a^T) / 2; of a Gaussian theta
with covariance C C^T the mean of its square is ((tr B)^2 + 2 |B|^2) / 4, B = C^T A C.

Source: Gauss-Markov theory for the linearised problem; G as in certreg.equilibrium.stability.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from math import hypot, inf, lcm, prod
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.equilibrium import rotation_double, unit_double
from certreg.exact import (
    nearest_double,
    nearest_or_zero,
    nearest_root,
    power_of_two,
    root_of_quotient,
)
from certreg.geometry import body_frame, dot, rotation_matrix, squared_norm
from certreg.problem import Scale, contiguous, row_blocks
from certreg.results import OUT_OF_RANGE, Absent, Explained, present

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from certreg.geometry import Pose, Similarity
    from certreg.objective import Isotropic
    from certreg.problem import Block, RegistrationProblem

PARAMETERS = 6  # of a pose
TURN = 3  # where its rotation begins
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
BIASED = Absent(
    "noise in the target makes the symmetric scale too large, of many points by more than it "
    "scatters, which no covariance tells"
)
NO_SCALE = Absent("the scale was not asked for")
NOT_TOLD_APART = Absent("the two best eigenvalues are not told apart")
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
        of that no rotation moves it, it is the least that a point of the source can have.
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
    centre_sigma: float
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
        change = np.zeros((6, 6))
        change[:3, :3] = np.eye(3)
        change[3:, 3:] = self.rotation
        return None if self.matrix is None else change @ self.matrix[:6, :6] @ change.T

    @property
    def gtsam(self) -> NDArray[np.float64] | None:
        """The (6, 6) of gtsam.Pose3: (phi, v), rotation first, both in the body frame.

        T_true = T Exp((phi, v)), to first order t_true = t + R v. Of a free scale it says nothing.
        """
        change = np.zeros((6, 6))
        change[:3, 3:] = np.eye(3)
        change[3:, :3] = self.rotation.T
        return None if self.matrix is None else change @ self.matrix[:6, :6] @ change.T


def pose_covariance(problem: RegistrationProblem, objective: Isotropic) -> PoseCovariance | Absent:
    """The covariance of the optimal pose; Absent if the optimum is not unique or doubles overflow.

    Also of a symmetric scale, which noise in the target shifts.

    Where no noise was given the variance is estimated, which takes N >= 3 points with weight,
    residuals that are not all zero, and weights that at least half of the points carry: relative
    weights say little of noise, and rows that hardly count would count as degrees of freedom.
    """
    biased = problem.scale is Scale.SYMMETRIC
    if biased or not objective.classification.unique:
        return BIASED if biased else NOT_UNIQUE
    degrees = problem.degrees_of_freedom
    least = objective.energy(objective.optimum)
    if not problem.noise_given and (degrees <= 0 or least <= 0):
        return NO_VARIANCE if degrees <= 0 else NO_RESIDUALS
    if not problem.noise_given and 6 * effective_rows(problem) < problem.observations:
        return FEW_CARRY
    variance = Fraction(1) if problem.noise_given else least / degrees
    parts = _Parts.of(objective, variance)
    if parts is None:
        return NOT_TOLD_APART
    if problem.rotation_only:
        parts = replace(parts, centre=Fraction(0))
    exact, grown = parts.matrix(), _swelling(objective, variance)
    if grown is not None:
        exact = exact.grown(*grown)
    sigmas = [root_of_quotient(row[i], exact.denominator) for i, row in enumerate(exact.rows)]
    centre, loosest = nearest_root(parts.centre), nearest_root(parts.loosest)
    if None in sigmas or centre is None or loosest is None:
        return OUT_OF_RANGE
    told = np.array(sigmas, dtype=np.float64)
    given = TURN if problem.rotation_only else 0
    matrix, axis = _in_doubles(exact, given), unit_double(parts.axis)
    factor = nearest_double(least / degrees) if degrees > 0 else None
    rotation = rotation_double(objective.optimum)
    best = objective.best_scale(objective.optimum)
    arm = [nearest_or_zero(best * entry) for entry in objective.moments.source_centroid]
    swung = second_order(rotation @ parts.turns(), rotation @ arm, told[:TURN])
    size = float(told[PARAMETERS]) if problem.scaled else None
    if size is not None and any(arm):  # ds theta x R m beside s theta x R m, of which dt has more
        swung = hypot(swung, nearest_or_zero(Fraction(size) / best))
    return PoseCovariance(
        matrix=present(matrix),
        translation_sigma=told[:TURN],
        second_order=swung,
        rotation_sigma=told[TURN:PARAMETERS],
        loosest_sigma=loosest,
        loosest_axis=axis * np.sign(axis[np.argmax(np.abs(axis))]),
        variance_factor=factor,
        degrees_of_freedom=max(degrees, 0),
        centre_sigma=centre,
        estimated=not problem.noise_given,
        rotation=rotation,
        scale_sigma=size,
        absent={
            "scale_sigma": NO_SCALE,
            "variance_factor": NO_VARIANCE if degrees <= 0 else OUT_OF_RANGE,
            **({"matrix": matrix} if isinstance(matrix, Absent) else {}),
        },
    )


@dataclass(frozen=True, kw_only=True)
class _Parts:
    """The covariance in rational numbers, as a sum over the principal axes of the rotation.

    P = sum_k f_k u_k u_k^T, u_k = L(q)^T q_k a unit vector, f_k = 2 v / (s (l1 - lk)), v the
    variance of weight one, s the scale, 1 unless it is free; dt moves by s R (m x u_k) with it, and
    by the centre's own: so every variance is a sum of squares.

    All in integers: moves: (dt, phi) along each axis, times `denominator`. weights: of their
    squares, f_k / |u_k|^2 in units of `unit` / `whole`. loosest: f_1. centre: v / M.
    """

    moves: list[list[int]]
    axis: list[int]
    denominator: int
    weights: list[int]
    unit: Fraction
    whole: int
    loosest: Fraction
    centre: Fraction

    @classmethod
    def of(cls, objective: Isotropic, variance: Fraction) -> _Parts | None:
        """None where two eigenvalues are not told apart."""
        q, vectors = objective.optimum, objective.eigenvectors
        drops, moments = objective.eigenvalue_drops[1:], objective.moments
        best = objective.best_scale(q)
        if min(drops) <= 0 or best <= 0:
            return None
        frame, turn = list(zip(*body_frame(q), strict=True)), rotation_matrix(q)
        axes = [[dot(column, vector) for column in frame] for vector in vectors[1:]]
        arm = best * power_of_two(moments.source_exponent) / (moments.mass * squared_norm(q))
        levers = [[dot(row, _cross(moments.source_sum, axis)) for row in turn] for axis in axes]
        ends = zip(levers, axes, strict=True)
        shares = [drop * squared_norm(axis) for drop, axis in zip(drops, axes, strict=True)]
        whole = prod(shares)
        spread = 2 * variance / (best * objective.eigenvalue_unit)
        return cls(
            moves=[
                [*(m * arm.numerator for m in lever), *(m * arm.denominator for m in axis)]
                for lever, axis in ends
            ],
            axis=axes[0],
            denominator=arm.denominator,
            weights=[whole // share for share in shares],
            unit=spread,
            whole=whole,
            loosest=spread / drops[0],
            centre=variance / moments.total_weight,
        )

    def turns(self) -> NDArray[np.float64]:
        """(3, 3), in its columns one deviation of the turn along each principal axis: C C^T = P."""
        columns: list[NDArray[np.float64]] = []
        below = self.unit.denominator * self.whole * self.denominator**2
        for weight, move in zip(self.weights, self.moves, strict=True):
            axis = move[TURN:]
            sigma = root_of_quotient(self.unit.numerator * weight * squared_norm(axis), below)
            columns.append(unit_double(axis) * (inf if sigma is None else sigma))
        return np.array(columns).T

    def matrix(self) -> RationalMatrix:
        """(6, 6), the covariance of (dt, phi)."""
        size, unit, centre = range(PARAMETERS), self.unit, self.centre
        below = unit.denominator * self.whole * self.denominator**2
        factor, own = unit.numerator * centre.denominator, centre.numerator * below
        entries = [[0] * PARAMETERS for _ in size]
        for i in size:
            heavy = [w * moves[i] for w, moves in zip(self.weights, self.moves, strict=True)]
            for j in range(i + 1):
                products = (a * moves[j] for a, moves in zip(heavy, self.moves, strict=True))
                entries[i][j] = entries[j][i] = factor * sum(products) + own * (i == j < TURN)
        return RationalMatrix(rows=entries, denominator=below * centre.denominator)


@dataclass(frozen=True, kw_only=True)
class RationalMatrix:
    """A matrix of rational numbers, as integers over one denominator."""

    rows: list[list[int]]
    denominator: int

    def grown(self, move: list[Fraction], variance: Fraction) -> RationalMatrix:
        """With one more row and column, and the covariance of `move` times a number added."""
        last = len(self.rows)
        whole = lcm(*(entry.denominator for entry in move))
        below = lcm(self.denominator, whole**2 * variance.denominator)
        rows = [[0] * (last + 1) for _ in move]
        for i, a in enumerate(move):
            for j, b in enumerate(move):
                own = self.rows[i][j] * (below // self.denominator) if max(i, j) < last else 0
                rows[i][j] = own + int(a * b * variance * below)
        return RationalMatrix(rows=rows, denominator=below)


def _swelling(objective: Isotropic, variance: Fraction) -> tuple[list[Fraction], Fraction] | None:
    """What (dt, phi, ds) a growth of the scale is, and its variance; None where it is not free."""
    if objective.scaling is None:
        return None
    moments, q = objective.moments, objective.optimum
    unit = power_of_two(moments.source_exponent) / (moments.mass * squared_norm(q))
    shift = [-unit * dot(row, moments.source_sum) for row in rotation_matrix(q)]
    return [*shift, *[Fraction(0)] * TURN, Fraction(1)], variance / objective.scaling.source


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


def _cross(a: Sequence[int], b: Sequence[int]) -> list[int]:
    return [a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3] for i in range(3)]


def residual_distances(
    points: RegistrationProblem | Block, pose: Pose | Similarity
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
        distances[~np.isfinite(distances)] = -1.0
        least = max(0.0, np.partition(distances, -count)[-count] if count < len(distances) else 0.0)
        far = np.flatnonzero(distances >= least)
        far = far[np.argsort(-distances[far], kind="stable")[:count]]
        worst += [Residual(row=rows.start + int(k), distance=float(distances[k])) for k in far]
        worst = sorted(worst, key=lambda one: (-one.distance, one.row))[:count]
    return worst


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
