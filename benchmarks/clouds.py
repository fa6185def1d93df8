"""Pairs of clouds to measure with: normal points, a random motion, noise, an offset, a scale."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.problem.problem import RegistrationProblem

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Cloud = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Shape:
    """Noise relative to the cloud, the offset added to both clouds, the scale of all."""

    noise: float = 0.01
    offset: float | tuple[float, float, float] = 0.0
    scale: float = 1.0


def random_problem(n: int, *, seed: int = 0, **shape: Any) -> RegistrationProblem:
    """A problem of n points, weighted between 1/2 and 2; `shape` as in `Shape`."""
    rng = np.random.default_rng(seed)
    source, target = _clouds(rng, n, Shape(**shape))
    return RegistrationProblem(source, target, weights=rng.uniform(0.5, 2.0, size=n))


def random_clouds(n: int, *, seed: int = 0, **shape: Any) -> tuple[Cloud, Cloud]:
    """Source and target (n, 3) of the same problem, without weights."""
    return _clouds(np.random.default_rng(seed), n, Shape(**shape))


def _clouds(rng: np.random.Generator, n: int, shape: Shape) -> tuple[Cloud, Cloud]:
    rotation = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    rotation *= np.sign(np.linalg.det(rotation))
    source = rng.normal(size=(n, 3))
    target = source @ rotation.T  # in place from here on: ten million points are 240 MB
    target += rng.normal(size=3)
    target += shape.noise * rng.normal(size=(n, 3))
    target += np.array(shape.offset)
    source += np.array(shape.offset)
    target *= shape.scale
    source *= shape.scale
    return source, target
