"""The paper's construction as a scene: a rigid body of particles on springs to a fixed cloud."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.geometry.so3 import rotation_matrix
from certreg.paper.particles import Particles
from certreg.problem.problem import RegistrationProblem

if TYPE_CHECKING:
    from numpy.typing import NDArray

HOUSE = (
    *((-1.0, -0.7, 0.0), (1.0, -0.7, 0.0), (1.0, 0.7, 0.0), (-1.0, 0.7, 0.0)),
    *((-1.0, -0.7, 1.0), (1.0, -0.7, 1.0), (1.0, 0.7, 1.0), (-1.0, 0.7, 1.0)),
    *((-1.0, 0.0, 1.7), (1.0, 0.0, 1.7)),
)
LINKS = (
    *((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)),
    *((0, 4), (1, 5), (2, 6), (3, 7), (4, 8), (7, 8), (5, 9), (6, 9), (8, 9)),
)
TURN = (math.cos(0.4), math.sin(0.4) * 0.36, math.sin(0.4) * 0.48, math.sin(0.4) * 0.8)
SHIFT = (2.9, -0.9, 0.5)
NOISE = 0.08  # large enough to be seen
COILS, ZIGZAG = 16, 0.05  # of a drawn spring: turns, and half its width in the unit of length


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Scene:
    """The body at the paper's start. Lengths in the unit of the clouds.

    source, target: (N, 3); links: pairs of points that the rigid body is drawn with.
    centres: (2, 3), of the source and the target. force: (3,), on the body; torque: (3,), on it
    about its centre, body frame.
    """

    source: NDArray[np.float64]
    target: NDArray[np.float64]
    links: tuple[tuple[int, int], ...]
    centres: NDArray[np.float64]
    force: NDArray[np.float64]
    torque: NDArray[np.float64]


def scene() -> Scene:
    """A house whose source is turned, moved and disturbed: the same picture every time."""
    house = np.array(HOUSE)
    R = np.array(rotation_matrix(TURN))
    noise = NOISE * np.random.default_rng(0).standard_normal(house.shape)
    problem = RegistrationProblem(house @ R.T + SHIFT + noise, house)
    particles = Particles.of(problem)
    start = particles.start
    return Scene(
        source=particles.source,
        target=particles.target,
        links=LINKS,
        centres=np.array([particles.centre, np.zeros(3)]),
        force=particles.force(start),
        torque=particles.torque(start),
    )


def projected(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points (N, 3) as seen from the front right and above, without perspective, (N, 2)."""
    across, up = math.radians(-28.0), math.radians(20.0)
    x = math.cos(across) * points[:, 0] + math.sin(across) * points[:, 1]
    away = -math.sin(across) * points[:, 0] + math.cos(across) * points[:, 1]
    return np.column_stack([x, math.cos(up) * points[:, 2] + math.sin(up) * away])


def coil(start: NDArray[np.float64], end: NDArray[np.float64]) -> NDArray[np.float64]:
    """A spring from one point of the plane to another as a zigzag line, (k, 2)."""
    along = end - start
    across = np.array([-along[1], along[0]]) / (np.linalg.norm(along) or 1.0)
    places = np.concatenate([[0.0], np.linspace(0.15, 0.85, 2 * COILS + 1), [1.0]])
    sides = np.concatenate([[0.0, 0.0], np.resize([1.0, -1.0], 2 * COILS - 1), [0.0, 0.0]])
    return start + np.outer(places, along) + ZIGZAG * np.outer(sides, across)
