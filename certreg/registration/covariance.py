"""Uncertainty of the optimal pose: a 6x6 covariance to first order, and residuals per point.

The objective is twice the negative log-likelihood of Gaussian noise on the target, but a constant.
With the error model R_true = R exp([phi]), phi in the source's (body) frame, and t_true = t + dt in
the target's frame, P = 2 G^-1 (G the Hessian at the optimum) and mean source point m:

    cov(phi) = P,    cov(dt, phi) = R [m] P,    cov(dt) = I / M + R [m] P [m]^T R^T.

Source: Gauss-Markov theory for the linearised problem; G as in certreg.equilibrium.stability.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.equilibrium import rotation_double, unit_double
from certreg.exact import nearest_double, nearest_quotient
from certreg.geometry import body_frame
from certreg.problem import contiguous, row_blocks
from certreg.results import OUT_OF_RANGE, Absent, Explained

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.geometry import Pose
    from certreg.objective import Isotropic
    from certreg.problem import Block, RegistrationProblem

PARAMETERS = 6  # of a pose
NOT_UNIQUE = Absent("the optimum is not unique")
NO_VARIANCE = Absent(
    f"{OUT_OF_RANGE.reason}, or fewer than three points with weight leave no degree of freedom for "
    "the noise"
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PoseCovariance(Explained):
    """Covariance of a pose, in three conventions.

    matrix: (6, 6), order (dt, phi): translation in the target's frame and unit squared, then the
        rotation vector phi in the source's frame, radians; R_true = R exp([phi]), t_true = t + dt.
    variance_factor: objective / (3 N - 6), near 1 if the given sigma is right; None if N < 3.
    degrees_of_freedom: 3 N - 6, of the residuals; N counts the points with weight.
    centre_sigma: standard deviation, along any axis, of where the weighted mean of the source goes:
        of that no rotation moves it, it is the least that a point of the source can have.
    estimated: whether `matrix` was scaled by the variance factor, because no noise was given.
    rotation: (3, 3), the R of the pose.
    """

    matrix: NDArray[np.float64]
    variance_factor: float | None
    degrees_of_freedom: int
    centre_sigma: float
    estimated: bool
    rotation: NDArray[np.float64]

    def __array__(
        self,
        dtype: Any = None,
        copy: bool | None = None,  # noqa: FBT001 - so NumPy calls it
    ) -> NDArray[Any]:
        return np.array(self.matrix, dtype=dtype, copy=copy)

    @property
    def translation_sigma(self) -> NDArray[np.float64]:
        """(3,), one standard deviation of t, along the target's axes, in the unit of length.

        t is where the source's origin goes: far from the points its lever makes this large.
        """
        return np.sqrt(np.diag(self.matrix)[:3].clip(0.0))

    @property
    def rotation_sigma(self) -> NDArray[np.float64]:
        """(3,), one standard deviation of phi, about the source's axes, in radians."""
        return np.sqrt(np.diag(self.matrix)[3:].clip(0.0))

    @property
    def loosest_turn(self) -> tuple[float, NDArray[np.float64]]:
        """The largest standard deviation of phi along any axis, radians, and that unit axis."""
        values, vectors = np.linalg.eigh(self.matrix[3:, 3:])
        axis = vectors[:, 2]
        upwards = np.sign(axis[np.argmax(np.abs(axis))])
        return float(np.sqrt(max(values[2], 0.0))), upwards * axis

    @property
    def ros(self) -> NDArray[np.float64]:
        """The (6, 6) of ROS PoseWithCovariance: (x, y, z, about X, Y, Z).

        All in the target's (fixed) frame: R_true = exp([theta]) R, theta = R phi.
        """
        change = np.zeros((6, 6))
        change[:3, :3] = np.eye(3)
        change[3:, 3:] = self.rotation
        return change @ self.matrix @ change.T

    @property
    def gtsam(self) -> NDArray[np.float64]:
        """The (6, 6) of gtsam.Pose3: (phi, v), rotation first, both in the body frame.

        T_true = T Exp((phi, v)), to first order t_true = t + R v.
        """
        change = np.zeros((6, 6))
        change[:3, 3:] = np.eye(3)
        change[3:, :3] = self.rotation.T
        return change @ self.matrix @ change.T


def pose_covariance(problem: RegistrationProblem, objective: Isotropic) -> PoseCovariance | Absent:
    """The covariance of the optimal pose; Absent if the optimum is not unique or doubles overflow.

    Where no noise was given the variance is estimated, which takes N >= 3 points with weight.
    """
    if not objective.classification.unique:
        return NOT_UNIQUE
    reason = OUT_OF_RANGE if problem.noise_given else NO_VARIANCE
    moments, q = objective.moments, objective.quaternions[0]
    degrees = 3 * rows_with_weight(problem) - PARAMETERS
    factor = None
    if degrees > 0:
        factor = nearest_double(objective.energy(q) / degrees)
    scale = 1.0 if problem.noise_given else factor
    with np.errstate(over="ignore", invalid="ignore"):
        inverse = _inverse_hessian(objective)
        weight = nearest_double(1 / moments.total_weight)
        if scale is None or inverse is None or weight is None:
            return reason
        R = rotation_double(q)
        x, y, z = (float(entry) for entry in moments.source_centroid)
        lever = R @ np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        blocks = np.block(
            [
                [weight * np.eye(3) + 2.0 * lever @ inverse @ lever.T, 2.0 * lever @ inverse],
                [2.0 * inverse @ lever.T, 2.0 * inverse],
            ]
        )
        matrix = scale * (blocks + blocks.T) / 2.0
    if not np.isfinite(matrix).all():
        return reason
    return PoseCovariance(
        matrix=matrix,
        variance_factor=factor,
        degrees_of_freedom=max(degrees, 0),
        centre_sigma=float(np.sqrt(scale * weight)),
        estimated=not problem.noise_given,
        rotation=R,
        absent={"variance_factor": NO_VARIANCE},
    )


def residual_distances(points: RegistrationProblem | Block, pose: Pose) -> NDArray[np.float64]:
    """(N,), |y_i - R x_i - t|, in the unit of length; no square of a length is formed."""
    with np.errstate(over="ignore", invalid="ignore"):
        x, y, z = (points.target - pose.apply(points.source)).T
        return np.hypot(np.hypot(x, y), z)


@dataclass(frozen=True, slots=True, kw_only=True)
class Residual:
    """How badly a correspondence fits: its row, and |y - R x - t| in the unit of length."""

    row: int
    distance: float


def worst_residuals(problem: RegistrationProblem, pose: Pose, count: int) -> list[Residual]:
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


def rows_with_weight(problem: RegistrationProblem) -> int:
    """How many points have a weight other than zero."""
    blocks = (contiguous(problem.weights, rows) for rows in row_blocks(problem.n))
    return sum(int(np.count_nonzero(block)) for block in blocks)


def _inverse_hessian(objective: Isotropic) -> NDArray[np.float64] | None:
    """G^-1 from the eigenvectors: sum of u u^T / (l1 - lk), u = L(q)^T q_k; no cancellation."""
    unit, drops, vectors = (
        objective.eigenvalue_unit,
        objective.eigenvalue_drops,
        objective.eigenvectors,
    )
    frame = np.array(body_frame(tuple(unit_double(objective.quaternions[0]).tolist())))
    total = np.zeros((3, 3))
    for k in (1, 2, 3):
        gap = drops[k] * unit.numerator
        inverse = nearest_quotient(unit.denominator, gap) if gap > 0 else None
        if inverse is None:
            return None
        u = frame.T @ unit_double(vectors[k])
        total += inverse * np.outer(u, u)
    return total
