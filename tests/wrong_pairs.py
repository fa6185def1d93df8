"""Clouds whose pairs are partly wrong: a unit cube, moved at random, with noise.

The wrong targets are uniform in the ball of the cube's half diagonal about the mean of the true
ones, or of all where none is; noise is not cut at the bound; rows come in random order.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from certreg.geometry.so3 import rotation_matrix

SIGMA = 0.01
BOUND = 5.54 * SIGMA


@dataclass(frozen=True, kw_only=True, eq=False)
class WrongPairs:
    """Points (N, 3), (N, 3), bounds (N,), and which rows are true (N,)."""

    source: np.ndarray
    target: np.ndarray
    bounds: np.ndarray
    true: np.ndarray


def wrong_pairs(rng: np.random.Generator, points: int, wrong: float) -> WrongPairs:
    """One instance; wrong: the share of wrong pairs."""
    kept = round(points * (1.0 - wrong))
    source = rng.random((points, 3))
    q = rng.standard_normal(4)
    R = np.array(rotation_matrix((q / np.linalg.norm(q)).tolist()))
    target = source @ R.T + rng.uniform(-1.0, 1.0, 3) + SIGMA * rng.standard_normal((points, 3))
    ways = rng.standard_normal((points - kept, 3))
    radii = math.sqrt(3.0) / 2.0 * rng.random(points - kept) ** (1.0 / 3.0)
    ways *= (radii / np.linalg.norm(ways, axis=1))[:, np.newaxis]
    target[kept:] = target[: kept or points].mean(axis=0) + ways
    order = rng.permutation(points)
    return WrongPairs(
        source=source[order],
        target=target[order],
        bounds=np.full(points, BOUND),
        true=order < kept,
    )
