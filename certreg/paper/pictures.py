"""The figures that show clouds: the construction, the balanced polygons, poses of a real cloud.

Apart from `figures`, which shows numbers: both together are too long for one module.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.paper.scenes import LANDMARKS, coil, flipped, projected, torques
from certreg.paper.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    INDEX_COLOURS,
    INDEX_MARKERS,
    VERMILLION,
    Drawing,
    blank,
    finished,
    house_style,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.paper.observations import Observations
    from certreg.paper.scenes import Polygon, Turn

SHOWN_ANGLE = math.radians(40.0)  # of the polygons that are drawn
LINES = ("-", "--", "-.", ":")
VIEW = np.array([[-0.86, -0.5, 0.0], [0.19, -0.33, 0.92]])  # of a head: from its left front, above
LABEL_RADIUS = 145.0  # mm: outside of both heads
SPRING: dict[str, Any] = {"color": GREY, "linewidth": 0.7, "zorder": 1}


def construction_drawing(observed: Observations) -> Drawing:
    """The two clouds and their springs."""
    scene = observed.scene
    source, target = projected(scene.source), projected(scene.target)
    centres = projected(scene.centres)
    with house_style():
        figure = blank(3.4)
        panel = figure.subplots()
        for a, b in zip(source, target, strict=True):
            panel.plot(*coil(a, b).T, **SPRING)
        for cloud, colour, line in ((target, VERMILLION, "--"), (source, BLUE, "-")):
            for i, j in scene.links:
                panel.plot(*cloud[[i, j]].T, color=colour, linestyle=line, linewidth=1.1, zorder=2)
        dots: dict[str, Any] = {"zorder": 3, "linestyle": "none", "markersize": 6}
        panel.plot(
            *target.T,
            marker="s",
            color=VERMILLION,
            markerfacecolor="white",
            label="scene, fixed: $y_i$",
            **dots,
        )
        panel.plot(*source.T, marker="o", color=BLUE, label="model, moving: $x_i$", **dots)
        panel.plot(
            *centres.T,
            marker="P",
            color=BLACK,
            label="centres of mass",
            zorder=4,
            linestyle="none",
            markersize=8,
        )
        panel.plot([], [], label="springs, $k_i = 2/\\sigma_i^2$", **SPRING)
        panel.set_aspect("equal")
        panel.set_axis_off()
        figure.legend(loc="outside lower center", ncols=4)
    return finished(
        name="construction",
        title="Registration as a body on springs",
        caption="The model (filled circles, solid links) is a rigid body of particles, the scene "
        "(open squares, dashed links) is fixed, and a spring pulls each particle to its "
        "counterpart. Released from rest in a viscous medium, the body moves and turns until all "
        "forces and torques balance. The energy of the springs is the sum of squares that "
        "registration minimises.",
        figure=figure,
    )


def polygon_drawing(observed: Observations) -> Drawing:
    """The polygons, flipped and turned, and the torque of each spring at every angle."""
    with house_style():
        figure = blank(4.9)
        rows = figure.subplots(2, 2, height_ratios=(1.2, 1.0), sharey="row")
        for k, turn in enumerate(observed.turns):
            _flipped_polygon(rows[0, k], turn.polygon)
            rows[0, k].set_title(f"({'ab'[k]}) The {turn.polygon.name}, turned by 40° and flipped")
            _torques(rows[1, k], turn)
            rows[1, k].set_title(f"({'cd'[k]}) Torque of each of its springs")
        rows[1, 0].set_ylabel("torque / (k l² / 2)")
        handles, labels = rows[1, 1].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=5)
    return finished(
        name="polygons",
        title="Two symmetric clouds that balance at every angle",
        caption="A regular polygon (filled circles) turned by θ and flipped over onto its copy "
        "(open squares); corners that belong together have the same number. Above: springs that "
        "turn it counter-clockwise are solid, clockwise ones dashed. Below: each torque depends on "
        "θ, their sum (heavy line) is zero at every θ. So are all forces, exactly: the sums are "
        "polynomials in the tangent of θ/2 whose coefficients vanish. A circle of equilibria, all "
        "unstable: turning it out of the plane about the axis of the flip lowers the energy (about "
        "the other axis in the plane it raises it).",
        figure=figure,
    )


def _torques(panel: Any, turn: Turn) -> None:
    """Markers stand apart, for lines that coincide."""
    degrees = np.degrees(turn.angles)
    for corner, torque in enumerate(turn.torques.T):
        panel.plot(
            degrees,
            torque,
            linestyle=LINES[corner],
            color=INDEX_COLOURS[corner],
            marker=INDEX_MARKERS[corner],
            markersize=4.5,
            markevery=(12 * corner, 48),
            label=f"corner {corner + 1}",
        )
    panel.plot(degrees, turn.torques.sum(axis=1), color=BLACK, linewidth=2.4, label="sum")
    panel.axvline(math.degrees(SHOWN_ANGLE), color=GREY, linewidth=0.8, linestyle=":")
    panel.set(xlabel="angle θ, degrees", xticks=range(0, 361, 90), xlim=(0, 360), ylim=(-2.2, 2.2))


def _flipped_polygon(panel: Any, polygon: Polygon) -> None:
    """The two polygons at one angle, springs by the sense of their torque."""
    cos, sin = math.cos(SHOWN_ANGLE), math.sin(SHOWN_ANGLE)
    target = np.array(polygon.points(math.sqrt(3.0))) / 2.0
    rows = tuple((x, y) for x, y in target.tolist())
    source = np.array(flipped(polygon, rows, cos, sin))
    pulls = torques(tuple((x, y) for x, y in source.tolist()), rows)
    for x, y, pull in zip(source, target, pulls, strict=True):
        line = "-" if pull > 0.0 else (0, (4, 2))
        panel.annotate(
            "",
            y,
            x,
            arrowprops={
                "arrowstyle": "-|>",
                "linestyle": line,
                "color": BLACK,
                "linewidth": 0.9,
                "shrinkA": 4,
                "shrinkB": 5,
            },
        )
    for cloud, colour, line, marker in ((target, VERMILLION, "--", "s"), (source, BLUE, "-", "o")):
        closed = np.vstack([cloud, cloud[:1]])
        face = "white" if marker == "s" else colour
        panel.plot(
            *closed.T,
            color=colour,
            linestyle=line,
            marker=marker,
            markerfacecolor=face,
            markersize=6,
        )
    for cloud, colour, reach in ((target, VERMILLION, 1.2), (source, BLUE, 1.22)):
        for k, corner in enumerate(cloud):
            panel.text(*(reach * corner), str(k + 1), color=colour, ha="center", va="center")
    panel.plot(0.0, 0.0, marker="P", color=BLACK, markersize=6)
    panel.set(aspect="equal", xlim=(-1.45, 1.45), ylim=(-1.35, 1.35))
    panel.set_axis_off()


def pose_drawing(observed: Observations) -> Drawing:
    """A real cloud at its four equilibria."""
    gallery = observed.gallery
    with house_style():
        figure = blank(6.0)
        panels = figure.subplots(2, 2, sharex=True, sharey=True).ravel()
        for k, (panel, pose) in enumerate(zip(panels, gallery.poses, strict=True)):
            _heads(panel, gallery.target @ VIEW.T, pose.points @ VIEW.T)
            turned = "the optimum" if k == 0 else f"{pose.angle:.0f}° from it"
            panel.set_title(f"({'abcd'[k]}) index {pose.index}, RMSE {pose.rmse:.1f} mm: {turned}")
            panel.set(aspect="equal", xlim=(-168, 168), ylim=(-150, 150))
            panel.set_axis_off()
    return finished(
        name="poses",
        title="The four equilibria of a real cloud",
        caption=f"{len(gallery.target)} electrodes on one head (dots) registered to those on "
        "another (open squares), thin lines being the springs; nose and ears of the moving head "
        "are marked. (a) is the optimum. In the others the head is turned by half a turn about the "
        "line from nose to neck, from ear to ear, and upright; forces and torques balance there as "
        "well, and a turn in one, two or three independent directions lowers the energy.",
        figure=figure,
    )


def _heads(panel: Any, target: NDArray[np.float64], moved: NDArray[np.float64]) -> None:
    """Both clouds in the plane of the picture, springs between them, landmarks with names."""
    for a, b in zip(moved, target, strict=True):
        panel.plot(*np.array([a, b]).T, color=GREY, linewidth=0.25, alpha=0.6, zorder=1)
    dots = {"linestyle": "none", "zorder": 2}
    panel.plot(
        *target.T,
        marker="s",
        markersize=3,
        markerfacecolor="none",
        markeredgecolor=VERMILLION,
        markeredgewidth=0.5,
        **dots,
    )
    panel.plot(*moved.T, marker="o", markersize=2, color=BLUE, **dots)
    for name, row in LANDMARKS.items():
        outwards = moved[row] / np.linalg.norm(moved[row])
        panel.annotate(
            name,
            moved[row],
            LABEL_RADIUS * outwards,
            ha="center",
            va="center",
            zorder=5,
            arrowprops={"arrowstyle": "-", "linewidth": 0.8, "color": BLACK},
        )
        panel.plot(
            *moved[row],
            marker="o",
            markersize=6,
            markerfacecolor=GREEN,
            markeredgecolor=BLACK,
            zorder=4,
        )
