"""Directions, turned at random, with noise; some of the pairs are wrong."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from certreg.geometry.so3 import rotation_matrix

SIGMA = 0.01
BOUND = 0.0554  # 5.54 SIGMA


@dataclass(frozen=True, kw_only=True, eq=False)
class RotatedPairs:
    """Points (N, 3), (N, 3), bounds (N,), and which rows are true (N,)."""

    source: np.ndarray
    target: np.ndarray
    bounds: np.ndarray
    true: np.ndarray


def rotated_pairs(
    rng: np.random.Generator, n: int, wrong: float, sigma: float = SIGMA
) -> RotatedPairs:
    """One instance; wrong: the share of pairs whose target is a direction at random."""
    source, others = directions(rng, n), directions(rng, n)
    q = rng.standard_normal(4)
    R = np.array(rotation_matrix((q / np.linalg.norm(q)).tolist()))
    true = rng.permutation(n) >= round(wrong * n)
    turned = source @ R.T + sigma * rng.standard_normal((n, 3))
    target = np.where(true[:, np.newaxis], turned, others)
    return RotatedPairs(source=source, target=target, bounds=np.full(n, BOUND), true=true)


def directions(rng: np.random.Generator, n: int) -> np.ndarray:
    """(n, 3), of length 1."""
    made = rng.standard_normal((n, 3))
    return made / np.linalg.norm(made, axis=1)[:, np.newaxis]
