"""Pairs of clouds to measure with: normal points, a random motion, noise, an offset, a scale."""

from __future__ import annotations

import numpy as np

from certreg.problem import RegistrationProblem


def random_problem(
    n: int,
    *,
    seed: int = 0,
    noise: float = 0.01,
    offset: float | tuple[float, float, float] = 0.0,
    scale: float = 1.0,
) -> RegistrationProblem:
    """A weighted problem of n points; noise relative to the cloud, the offset added to both."""
    rng = np.random.default_rng(seed)
    rotation = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    rotation *= np.sign(np.linalg.det(rotation))
    source = rng.normal(size=(n, 3))
    target = source @ rotation.T + rng.normal(size=3) + noise * rng.normal(size=(n, 3))
    weights, shift = rng.uniform(0.5, 2.0, size=n), np.array(offset)
    return RegistrationProblem((source + shift) * scale, (target + shift) * scale, weights=weights)
