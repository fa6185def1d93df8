"""The covariance of a pose on general springs, to first order in the noise.

The objective is twice the negative log-likelihood of Gaussian noise of covariance W^-1 on the
target, where W has an inverse, and of the noise along its springs where it has none. With the
source turned and shifted about a centre c, R -> R exp([phi]), t + R c -> t + R c + d, and z the
source about c,

    r -> r - A (d, phi) - R [phi]^2 z / 2 + ...,    A = (I, -R [z]),

so that half the Hessian of the objective is the sum of A^T W A and, of the turn alone, of
(g . z) I - (g z^T + z g^T) / 2 with g = R^T W r. Its inverse is the covariance of (d, phi); t moves
by d + R [c] phi.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from certreg.exact import nearest_double
from certreg.problem import row_blocks
from certreg.registration.covariance import (
    FAR,
    FEW_CARRY,
    LEAST_CORRELATION,
    NO_RESIDUALS,
    NOT_UNIQUE,
    PARAMETERS,
    PoseCovariance,
    least_correlation,
    second_order,
)
from certreg.registration.spring_rows import lower_triangles
from certreg.results import OUT_OF_RANGE, Absent

if TYPE_CHECKING:
    from fractions import Fraction

    from numpy.typing import NDArray

    from certreg.geometry import Pose
    from certreg.problem import RegistrationProblem
    from certreg.registration.spring_rows import ResidualSums

NO_FREEDOM = Absent(
    "the springs leave no degree of freedom for the noise: give sigma, or covariances"
)
FLAT = Absent("the springs hardly resist a move of the pose: to first order it is undetermined")
LEAST_CURVATURE = 1e-12  # of the largest, in the clouds' own unit: less is rounding


def spring_covariance(
    problem: RegistrationProblem, pose: Pose, least: Fraction, sums: ResidualSums, *, unique: bool
) -> PoseCovariance | Absent:
    """The covariance of an optimal pose; least: the objective there. Absent where there is none."""
    degrees = problem.degrees_of_freedom
    if not unique:
        return NOT_UNIQUE
    if not problem.noise_given:
        if degrees <= 0 or least <= 0:
            return NO_FREEDOM if degrees <= 0 else NO_RESIDUALS
        if 2 * sums.effective_rows < sums.rows:
            return FEW_CARRY
    factor = nearest_double(least / degrees) if degrees > 0 else None
    scale = 1.0 if problem.noise_given else factor
    if scale is None:
        return OUT_OF_RANGE
    centre = source_centre(problem)
    with np.errstate(all="ignore"):
        half = half_hessian(problem, pose, centre)
        inverse = _inverse(half)
        if isinstance(inverse, Absent):
            return inverse
        return _covariance(problem, pose, centre, (scale * inverse, factor, degrees))


def source_centre(problem: RegistrationProblem) -> NDArray[np.float64]:
    """The mean of the source, about which nothing cancels."""
    blocks = (problem.spring_block(rows) for rows in row_blocks(problem.n))
    return np.sum([block.source.mean(axis=0) * len(block.source) for block in blocks], axis=0) / (
        problem.n
    )


def half_hessian(
    problem: RegistrationProblem, pose: Pose, centre: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(6, 6), half the second derivatives of the objective in (d, phi)."""
    rotation, total = pose.rotation, np.zeros((PARAMETERS, PARAMETERS))
    image = pose.apply(centre[np.newaxis])[0]
    for rows in row_blocks(problem.n):
        block = problem.spring_block(rows)
        lower, z = lower_triangles(block.factors), block.source - centre
        residuals = (block.target - image) - z @ rotation.T
        moved = np.zeros((len(z), 3, PARAMETERS))
        moved[:, :, :3] = np.eye(3)
        moved[:, :, 3:] = -rotation @ _crosses(z)
        pulled = np.einsum("kij,kin->kjn", lower, moved).reshape(-1, PARAMETERS)
        total += pulled.T @ pulled
        forces = np.einsum("kij,klj,kl->ki", lower, lower, residuals)
        bent = (forces @ rotation).T @ z
        total[3:, 3:] += np.trace(bent) * np.eye(3) - (bent + bent.T) / 2
    return total


def _crosses(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """(k, 3, 3): [z], with [z] v = z x v."""
    x, y, z = points.T
    zero = np.zeros_like(x)
    return np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)


def _inverse(half: NDArray[np.float64]) -> NDArray[np.float64] | Absent:
    """The inverse, where all six directions are resisted; of numbers of one size."""
    sizes = np.sqrt(np.diag(half))
    if not (np.isfinite(half).all() and (sizes > 0).all()):
        return FLAT if np.isfinite(half).all() else OUT_OF_RANGE
    levels, axes = np.linalg.eigh(half / sizes / sizes[:, np.newaxis])
    if levels[0] <= LEAST_CURVATURE * levels[-1]:
        return FLAT
    return (axes / levels) @ axes.T / sizes / sizes[:, np.newaxis]


def _covariance(
    problem: RegistrationProblem,
    pose: Pose,
    centre: NDArray[np.float64],
    found: tuple[NDArray[np.float64], float | None, int],
) -> PoseCovariance | Absent:
    about, factor, degrees = found
    rotation, turn = pose.rotation, about[3:, 3:]
    change = np.eye(PARAMETERS)
    change[:3, 3:] = rotation @ _crosses(centre[np.newaxis])[0]
    matrix = change @ about @ change.T
    matrix = (matrix + matrix.T) / 2
    variances, axes = np.linalg.eigh(turn)
    if not (np.isfinite(matrix).all() and (np.diag(matrix) > 0).all()):
        return OUT_OF_RANGE
    sigmas, loosest = np.sqrt(np.diag(matrix)), axes[:, -1]
    told = least_correlation(matrix) >= LEAST_CORRELATION
    deviations = rotation @ (axes * np.sqrt(np.maximum(variances, 0.0)))
    return PoseCovariance(
        matrix=matrix if told else None,
        translation_sigma=sigmas[:3],
        second_order=second_order(deviations, rotation @ centre, sigmas[:3]),
        rotation_sigma=sigmas[3:],
        loosest_sigma=math.sqrt(max(0.0, float(variances[-1]))),
        loosest_axis=loosest * np.sign(loosest[np.argmax(np.abs(loosest))]),
        variance_factor=factor,
        degrees_of_freedom=max(degrees, 0),
        centre_sigma=math.sqrt(float(np.linalg.eigvalsh(about[:3, :3])[-1])),
        estimated=not problem.noise_given,
        rotation=rotation,
        absent={
            "variance_factor": NO_FREEDOM if degrees <= 0 else OUT_OF_RANGE,
            **({} if told else {"matrix": FAR}),
        },
    )
