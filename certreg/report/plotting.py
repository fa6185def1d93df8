"""A registration drawn by Matplotlib, where it is installed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from certreg._loading import library
from certreg.report.picture import SOURCE, SPRING, Sample

if TYPE_CHECKING:
    from certreg.registration.result import Registration


PLOTTED = 5_000  # points: more are a cloud all the same, and slow to turn
JOINED = 500  # of them: more springs hide the points


def plotted(registration: Registration, axes: Any = None) -> Any:
    """The clouds at the pose in three dimensions, and the springs between them; the axes.

    axes: of the projection "3d", None for a new figure. Raises MissingToolError.
    """
    if axes is None:
        pyplot = library("matplotlib.pyplot", "plot")
        axes = pyplot.figure().add_subplot(projection="3d")
    if getattr(axes, "name", "") != "3d":
        raise ValueError(
            "axes is not of three dimensions: make it by figure.add_subplot(projection='3d')"
        )
    sample = Sample.of(registration, PLOTTED)
    few = Sample.of(registration, JOINED)
    ends = few.target if few.ends is None else few.ends
    for start, end in zip(ends, few.moved, strict=True):
        axes.plot(*zip(start, end, strict=True), color=SPRING, linewidth=0.8)
    axes.scatter(*sample.target.T, facecolors="none", edgecolors="0.4", label="target")
    axes.scatter(*sample.moved.T, s=8, color=SOURCE, label="source at the pose")
    axes.set_aspect("equal")
    axes.set_title(str(registration).partition(":")[0])
    axes.legend()
    return axes
