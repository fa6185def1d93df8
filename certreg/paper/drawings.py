"""All figures of the reproduction, in the order of the paper."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.paper.figures import angle_drawing, eigenvalue_drawing, simulation_drawing
from certreg.paper.pictures import construction_drawing, polygon_drawing, pose_drawing

if TYPE_CHECKING:
    from certreg.paper.observations import Observations
    from certreg.paper.style import Drawing


def all_drawings(seen: Observations) -> tuple[Drawing, ...]:
    """The figures, drawn."""
    return (
        construction_drawing(seen),
        polygon_drawing(seen),
        eigenvalue_drawing(seen, ambient=False),
        eigenvalue_drawing(seen, ambient=True),
        angle_drawing(seen),
        simulation_drawing(seen),
        pose_drawing(seen),
    )
