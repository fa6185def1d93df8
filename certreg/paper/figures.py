"""The figures of the paper's experiments, in its order: those of numbers and those of clouds."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.paper.experiments import EquilibriumRun, SimulationRun, sides
from certreg.paper.observations import (
    LANDMARKS,
    Observations,
    Polygon,
    Turn,
    coil,
    flipped,
    projected,
    torques,
)
from certreg.paper.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    INDEX_COLOURS,
    INDEX_MARKERS,
    PALE,
    VERMILLION,
    Drawing,
    blank,
    finished,
    house_style,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray


SHOWN_ANGLE = math.radians(40.0)  # of the polygons that are drawn
LINES = ("-", "--", "-.", ":")
VIEW = np.array([[-0.86, -0.5, 0.0], [0.19, -0.33, 0.92]])  # of a head: from its left front, above
LABEL_RADIUS = 145.0  # mm: outside of both heads
SPRING: dict[str, Any] = {"color": GREY, "linewidth": 0.7, "zorder": 1}
SHOWN = 200  # runs in a figure: more would only be darker
EXACT = 3e-17  # degrees: where an error of exactly zero is drawn
FIRST_STEPS = 12
BLOWN_UP = 1e3  # of the energy at the start: more is not drawn
NUMBERS = ("none", "one", "two", "three")


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
        large = dots | {"zorder": 4, "markersize": 8}
        panel.plot(*centres.T, marker="P", color=BLACK, label="centres of mass", **large)
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


def eigenvalue_drawing(observed: Observations, *, ambient: bool) -> Drawing:
    """The eigenvalues at the four equilibria, a panel each; ambient: of the paper's 18 numbers."""
    runs = [run for run in observed.equilibria if run.count == 4][:SHOWN]
    values = np.array([[r.ambient if ambient else r.intrinsic for r in run.poses] for run in runs])
    left, right = 1.12 * values.real.min(), 1.8 * values.real.max()
    with house_style():
        figure = blank(2.3)
        axes = figure.subplots(1, 4, sharex=True, sharey=True)
        for k, panel in enumerate(axes):
            _plane(panel, values[:, k])
            panel.axvspan(0.0, right, color=PALE, zorder=0)
            panel.set_title(f"({'abcd'[k]}) {NUMBERS[k]} unstable")
        axes[0].set(ylabel="imaginary part", xlim=(left, right))
        figure.supxlabel("real part (1 / time)", fontsize=8.5)
    size, name = (18, "ambient") if ambient else (12, "intrinsic")
    words = (
        "Six of them are zero at every equilibrium, also at the optimum (the ring at the origin in "
        "every panel): 18 numbers describe 12 dimensions. So at the optimum not all eigenvalues "
        "lie in the left half-plane; none lies in the right."
        if ambient
        else "From (a), the optimum, to (d), the worst rotation, one more eigenvalue lies to the "
        "right of the dashed axis (triangles), which makes (b), (c) and (d) unstable. No "
        "eigenvalue is zero."
    )
    return finished(
        name=f"eigenvalues-{name}",
        title=f"Eigenvalues of the {name} {size}×{size} Jacobian",
        caption=f"All {size} eigenvalues at the four equilibria of {len(runs)} random instances, "
        f"transparent, so that darker means more often. {words}",
        figure=figure,
    )


def _plane(panel: Any, spectra: NDArray[np.complex128]) -> None:
    """Eigenvalues (runs, 12 or 18): triangles to the right of the axis, rings at zero."""
    side = np.array([sides(spectrum) for spectrum in spectra])
    panel.axvline(0.0, color=BLACK, linewidth=0.8, linestyle=(0, (4, 3)), zorder=1)
    styles = {
        -1: {"marker": "o", "s": 16, "facecolors": "none", "edgecolors": BLUE},
        1: {"marker": "^", "s": 22, "facecolors": VERMILLION, "edgecolors": "none"},
        0: {"marker": "o", "s": 60, "facecolors": "none", "edgecolors": BLACK},
    }
    for which, style in styles.items():
        at = spectra[side == which]
        panel.scatter(at.real, at.imag, alpha=0.35, linewidths=0.9, zorder=2, **style)


def angle_drawing(observed: Observations) -> Drawing:
    """How far the equilibria are from 180 and 0 degrees, by two formulas."""
    runs = observed.equilibria[:SHOWN]
    rows = angle_errors(runs)
    with house_style():
        figure = blank(2.6)
        panel = figure.subplots()
        jitter = np.random.default_rng(0)
        for row, (errors, marker, colour) in enumerate(
            zip(rows.values(), "osos", (BLUE, VERMILLION, BLUE, VERMILLION), strict=True)
        ):
            height = row + 0.22 * jitter.uniform(-1.0, 1.0, len(errors))
            shown = np.maximum(errors, EXACT)
            panel.scatter(
                shown,
                height,
                s=14,
                marker=marker,
                alpha=0.45,
                facecolors="none" if marker == "s" else colour,
                edgecolors=colour,
                linewidths=0.7,
            )
        panel.set(
            xscale="log",
            xlabel="distance from 180° (spurious) or from 0° (optimum), in degrees",
            yticks=range(len(rows)),
            yticklabels=list(rows),
            ylim=(len(rows) - 0.5, -0.5),
            xlim=(EXACT / 3, 1e-4),
        )
        panel.axvline(EXACT, color=GREY, linewidth=0.8, linestyle=":", zorder=0)
        panel.annotate(
            "exactly 0",
            (EXACT, -0.5),
            (3, 1),
            textcoords="offset points",
            va="bottom",
            color=GREY,
            fontsize=8,
            annotation_clip=False,
        )
    return finished(
        name="angles",
        title="Angles of the equilibria to the optimum",
        caption=f"Each mark is an equilibrium of {len(runs)} random instances; its angle is to the "
        "closed-form optimum. From the quaternions (circles) the spurious ones are half a turn "
        "away, and the optimum none, up to the rounding of the last digit. The paper's formula, "
        "|arccos((tr − 1)/2)| (squares), has the same angles with half of the digits: arccos is "
        "infinitely steep at both ends. Where rounding happens to give ±1, the angle is exact.",
        figure=figure,
    )


def angle_errors(runs: Sequence[EquilibriumRun]) -> dict[str, NDArray[np.float64]]:
    """The distances of the angles from 180 or 0 degrees, by what and how they were measured."""
    spurious = [pose for run in runs for pose in run.poses[1:]]
    best = [run.poses[0] for run in runs]
    return {
        "spurious,\nquaternions": np.array([pose.half_turn_error for pose in spurious]),
        "spurious,\npaper's arccos": np.array([abs(180.0 - r.arccos_angle) for r in spurious]),
        "optimum,\nquaternions": np.array([pose.angle for pose in best]),
        "optimum,\npaper's arccos": np.array([pose.arccos_angle for pose in best]),
    }


def simulation_drawing(observed: Observations) -> Drawing:
    """Rotation errors of closed form and simulation, and the energies of a typical run."""
    runs = [run for run in observed.simulations if not run.diverged]
    shown = typical(runs or observed.simulations)
    with house_style():
        figure = blank(2.9)
        left, middle, right = figure.subplots(1, 3, width_ratios=(1.15, 1.3, 1.0))
        _boxes(left, runs)
        scale = float(shown.energy[0])
        for name, energy, line in (
            ("$V$", shown.energy, "-"),
            ("$V_p$", shown.potential, "--"),
        ):
            colour = BLUE if line == "-" else VERMILLION
            above = (energy - shown.least) / (scale - shown.least)
            above = np.where(above < BLOWN_UP, above, np.nan)
            middle.plot(shown.times, above, color=colour, linestyle=line, label=name)
        middle.set(xlabel="time", yscale="log", ylim=(1e-10, 3.0), xlim=(0.0, None))
        middle.set_title("(b) Energies of one run above\ntheir minimum, start = 1")
        middle.legend()
        first = (shown.energy[: FIRST_STEPS + 1] / scale - 1.0) * 1e6
        right.axhline(0.0, color=GREY, linewidth=0.8, linestyle=":")
        right.plot(range(len(first)), first, color=BLUE, marker="o", markersize=3.5)
        right.set(xlabel="step", xticks=range(0, FIRST_STEPS + 1, 3))
        right.set_title("(c) Change of $V$ in the\nfirst steps, millionths")
    return finished(
        name="simulations",
        title="Simulation of the dynamics",
        caption=_caption(runs, shown),
        figure=figure,
    )


def typical(runs: Sequence[SimulationRun]) -> SimulationRun:
    """The run with the median number of steps (of two, the shorter)."""
    return sorted(runs, key=lambda run: run.steps)[(len(runs) - 1) // 2]


def _caption(runs: Sequence[SimulationRun], shown: SimulationRun) -> str:
    return (
        f"(a) {_error_words(runs)} (b) A run of {shown.steps} steps, the median: the total energy "
        "V falls, the potential energy V_p under it "
        f"{'oscillates' if shown.potential_rises else 'falls with it'}. (c) The start of the same "
        f"run, enlarged: explicit Euler raises V in the first {_first_rises(shown)} steps, which "
        "(b) is too coarse to show."
    )


def _error_words(runs: Sequence[SimulationRun]) -> str:
    if not runs:
        return "No simulation stayed within the doubles: the step is too large for the damping."
    errors = [[run.closed_form_error, run.error, run.distance] for run in runs]
    closed, simulated, between = np.median(errors, axis=0).tolist()
    return (
        f"Rotation errors of {len(runs)} random instances, in the median: the closed form is "
        f"{closed:.3f}° from the true rotation and the simulation {simulated:.3f}°, for the noise "
        f"makes that error; {between:.3f}° lie between the two. Boxes hold the middle half, bars "
        "reach the outermost runs within 1.5 boxes, rings lie beyond."
    )


def _first_rises(run: SimulationRun) -> int:
    """How many steps from the start raise V, one after the other."""
    rising = np.diff(run.energy) > 0.0
    return len(rising) if rising.all() else int(np.argmin(rising))


def _boxes(panel: Any, runs: Sequence[SimulationRun]) -> None:
    names = ("closed_form_error", "error", "distance")
    columns = [[getattr(run, name) for run in runs] for name in names]
    boxes = panel.boxplot(
        columns,
        widths=0.55,
        patch_artist=True,
        medianprops={"color": BLACK, "linewidth": 1.4},
        flierprops={"marker": "o", "markersize": 3.5, "markerfacecolor": "none"},
    )
    for box, colour, hatch in zip(
        boxes["boxes"], ("#9FC8E0", "#F2B88F", "white"), ("", "///", ""), strict=True
    ):
        box.set(facecolor=colour, hatch=hatch, linewidth=0.8)
    panel.set_xticks([1, 2, 3], ["closed\nform", "simu-\nlation", "between\nthem"])
    panel.set_ylim(bottom=0.0)
    panel.set_title("(a) Rotation error,\ndegrees")


def paper_drawings(observed: Observations) -> tuple[Drawing, ...]:
    """All figures of the reproduction, in the order of the paper."""
    return (
        construction_drawing(observed),
        polygon_drawing(observed),
        eigenvalue_drawing(observed, ambient=False),
        eigenvalue_drawing(observed, ambient=True),
        angle_drawing(observed),
        simulation_drawing(observed),
        pose_drawing(observed),
    )
