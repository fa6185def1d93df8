"""The figures of the reproduction: those of random instances, and all in the order of the paper."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.paper.experiments import sides
from certreg.paper.pictures import construction_drawing, polygon_drawing, pose_drawing
from certreg.paper.style import (
    BLACK,
    BLUE,
    GREY,
    PALE,
    VERMILLION,
    Drawing,
    blank,
    finished,
    house_style,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from certreg.paper.experiments import EquilibriumRun, SimulationRun
    from certreg.paper.observations import Observations

SHOWN = 200  # runs in a figure: more would only be darker
EXACT = 3e-17  # degrees: where an error of exactly zero is drawn
FIRST_STEPS = 12
BLOWN_UP = 1e3  # of the energy at the start: more is not drawn
NUMBERS = ("none", "one", "two", "three")


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
    descent = shown.descent
    with house_style():
        figure = blank(2.9)
        left, middle, right = figure.subplots(1, 3, width_ratios=(1.15, 1.3, 1.0))
        _boxes(left, runs)
        scale = float(descent.energy[0])
        for name, energy, line in (
            ("$V$", descent.energy, "-"),
            ("$V_p$", descent.potential, "--"),
        ):
            colour = BLUE if line == "-" else VERMILLION
            above = (energy - shown.least) / (scale - shown.least)
            above = np.where(above < BLOWN_UP, above, np.nan)
            middle.plot(descent.times, above, color=colour, linestyle=line, label=name)
        middle.set(xlabel="time", yscale="log", ylim=(1e-10, 3.0), xlim=(0.0, None))
        middle.set_title("(b) Energies of one run above\ntheir minimum, start = 1")
        middle.legend()
        first = (descent.energy[: FIRST_STEPS + 1] / scale - 1.0) * 1e6
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
    rising = np.diff(run.descent.energy) > 0.0
    return len(rising) if rising.all() else int(np.argmin(rising))


def _boxes(panel: Any, runs: Sequence[SimulationRun]) -> None:
    columns = [
        [run.closed_form_error for run in runs],
        [run.error for run in runs],
        [run.distance for run in runs],
    ]
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
