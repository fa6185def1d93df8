"""The equilibria of a real pair of clouds as poses: what each does to the points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.paper.particles import Particles
from certreg.registration.enumeration import equilibria
from certreg.registration.examples import STORIES, stated

if TYPE_CHECKING:
    from numpy.typing import NDArray

HEAD = STORIES[1]
LANDMARKS = {"nose": 2, "left ear": 0, "right ear": 1}  # rows Nz, LPA, RPA of both files


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Posed:
    """The source at one equilibrium, both clouds with the target's centre as the origin.

    points: (N, 3), moved; index: how many independent turns lower the energy; rmse: in mm; angle:
    degrees to the optimum; axis: (3,), unit, of the turn that leads there from the optimum, None at
    the optimum.
    """

    points: NDArray[np.float64]
    index: int
    rmse: float
    angle: float
    axis: NDArray[np.float64] | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Gallery:
    """The target, (N, 3) in mm about its centre, and the source at each equilibrium."""

    target: NDArray[np.float64]
    poses: tuple[Posed, ...]


def gallery() -> Gallery:
    """The packaged electrodes on two heads, at all of their equilibria."""
    problem = stated(HEAD)
    particles = Particles.of(problem)
    components = equilibria(problem).components
    best = components[0].rotation
    return Gallery(
        target=particles.target,
        poses=tuple(
            Posed(
                points=particles.arms @ each.rotation.T,
                index=each.morse_index,
                rmse=each.rmse or 0.0,
                angle=float(np.degrees(each.angle_to_optimum)),
                axis=_axis(each.rotation @ best.T) if each.morse_index else None,
            )
            for each in components
        ),
    )


def _axis(half_turn: NDArray[np.float64]) -> NDArray[np.float64]:
    """The axis of a rotation by 180 degrees: R = 2 a a^T - I."""
    outer = (half_turn + np.eye(3)) / 2.0
    largest = int(np.argmax(outer.diagonal()))
    return outer[largest] / np.sqrt(outer[largest, largest])
