"""The figures beyond the paper: parameter sweeps with their predictions, and general springs.

Of springs: how many equilibria there are, and how often runs end at a wrong one.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import library
from certreg.dynamics.integrators import SimulationSettings
from certreg.paper.claims import rough
from certreg.paper.equilibrium_maps import FAMILY_WORDS, RunEnd, SpringCounts, wilson
from certreg.paper.parameter_sweeps import QUANTITIES, Curves, Sweep
from certreg.paper.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    VERMILLION,
    Drawing,
    blank,
    finished,
    house_style,
)
from certreg.problem.motion import DEFAULT_DAMPING

if TYPE_CHECKING:
    from numpy.typing import NDArray


STEPS, ESCAPE, MARGIN = QUANTITIES
LINEAR = {("start", "steps"), ("start", "escape_times")}  # what is logarithmic shows as a line
LABELS = 6  # decades on an axis with a label each; of more, every second or third


def sweep_drawings(sweeps: Sequence[Sweep]) -> tuple[Drawing, ...]:
    """A figure for each sweep."""
    return tuple(sweep_drawing(sweep) for sweep in sweeps)


def sweep_drawing(sweep: Sweep) -> Drawing:
    """Three panels over one parameter: steps, escape time, margin."""
    family = sweep.family
    with house_style():
        figure = blank(2.75)
        axes = figure.subplots(1, len(QUANTITIES), sharex=True)
        for k, (panel, quantity) in enumerate(zip(axes, QUANTITIES, strict=True)):
            _panel(panel, sweep, quantity)
            panel.set_title(f"({'abc'[k]}) {quantity.title}")
        _ticks(axes[0], sweep)
        figure.supxlabel(family.label, fontsize=8.5)
        handles, labels = max(
            (p.get_legend_handles_labels() for p in axes), key=lambda h: len(h[0])
        )
        figure.legend(handles, labels, loc="outside upper right", ncols=3)
    count = len(sweep.measurements[0].steps)
    few = min(len(each.steps) for each in sweep.measurements)
    fewer = "" if few == count else f", of large clouds {few} and more"
    return finished(
        name=f"map-{family.name}",
        title=f"Beyond the paper: {family.title.lower()}",
        caption=f"{count} random instances at each value{fewer}: {WORDS[family.name](sweep)}",
        figure=figure,
    )


def _panel(panel: Any, sweep: Sweep, quantity: Any) -> None:
    places, curves = _apart(sweep, sweep.curves(quantity))
    style = {"markersize": 4.5, "linewidth": 1.0}
    median = {"color": BLUE, "marker": "o", "label": "median"}
    worst = {"color": VERMILLION, "marker": "v", "markerfacecolor": "none", "label": "worst"}
    predicted = {"color": BLACK, "linestyle": (0, (4, 2)), "label": "theory", "zorder": 3}
    panel.plot(places, curves.median, **median, **style)
    panel.plot(places, curves.worst, **worst, linestyle=":", **style)
    if np.isfinite(curves.predicted).any():
        panel.plot(places, curves.predicted, **predicted)
    if sweep.family.name == "damping":
        panel.axvline(DEFAULT_DAMPING, color=GREY, linewidth=0.8, linestyle=":", zorder=0)
    panel.set(xscale="log")
    if (sweep.family.name, quantity.name) in LINEAR:
        panel.set(ylim=(0.0, 1.12 * float(np.nanmax(curves.worst))))
        panel.yaxis.set_major_formatter(_number)
        return
    panel.set(yscale="log", ylim=_range(curves))
    _decades_labelled(panel)


def _apart(sweep: Sweep, curves: Curves) -> tuple[NDArray[np.float64], Curves]:
    """Places and curves, with a gap in the lines after a value of zero; what is 0 is not drawn."""
    rows = (np.array(sweep.family.places), curves.median, curves.worst, curves.predicted)
    rows = tuple(np.where((row > 0.0) & np.isfinite(row), row, np.nan) for row in rows)
    if sweep.family.values[0] == 0.0:
        rows = tuple(np.insert(row, 1, np.nan) for row in rows)
    places, median, worst, predicted = rows
    return places, Curves(median=median, worst=worst, predicted=predicted)


def _decades_labelled(panel: Any) -> None:
    """Labels at powers of ten, and at 2 and 5 times these where there are few."""
    ticker = library("matplotlib.ticker", "a figure")
    low, high = panel.get_ylim()
    subs = (1.0, 2.0, 5.0) if math.log10(high / low) < 2.2 else (1.0,)
    panel.yaxis.set_major_locator(ticker.LogLocator(subs=subs, numticks=8))
    panel.yaxis.set_minor_locator(ticker.NullLocator())
    panel.yaxis.set_major_formatter(_number)


def _number(value: float, _: Any = None) -> str:
    """A number as people write it, very large and small powers of ten as such."""
    if 1e-3 <= abs(value) < 1e5 or value == 0.0:
        return f"{value:,g}" if value < 1000 else f"{value:,.0f}"
    exponent = round(math.log10(value))
    return f"$10^{{{exponent}}}$"


def _range(curves: Any) -> tuple[float, float]:
    """Limits that hold all that is positive, a decade at least and on whole halves of decades."""
    values = np.concatenate([curves.median, curves.worst, curves.predicted])
    logs = np.log10(values[np.isfinite(values) & (values > 0.0)])
    low, high = float(logs.min()), float(logs.max())
    spare = max(0.0, 1.2 - (high - low)) / 2.0 + 0.08 * (high - low) + 0.05
    return 10.0 ** (low - spare), 10.0 ** (high + spare)


def _ticks(panel: Any, sweep: Sweep) -> None:
    """Decades along the common axis, and zero where it is one of the values."""
    positive = [value for value in sweep.family.values if value > 0.0]
    first, last = math.ceil(math.log10(min(positive)) - 1e-9), math.floor(math.log10(max(positive)))
    with_zero = sweep.family.values[0] == 0.0
    every = 1 + (last - first + 2 * with_zero) // LABELS
    decades = [k for k in range(first, last + 1) if (last - k) % every == 0]
    places = [10.0**k for k in decades]
    labels = [f"$10^{{{k}}}$" if abs(k) > 1 else f"{10.0**k:g}" for k in decades]
    if with_zero:
        places, labels = [sweep.family.places[0], *places], ["0", *labels]
    panel.set_xticks(places, labels)
    panel.minorticks_off()


def _damping(sweep: Sweep) -> str:
    mu = np.array(sweep.family.values)
    fewest, soonest = (mu[np.argmin(sweep.curves(m).median)] for m in (STEPS, ESCAPE))
    return (
        f"the fewest steps are made at μ = {fewest:g}, near √8 (dotted), where without noise the "
        "slowest part of the motion dies out fastest. With less damping the body swings, with more "
        "it creeps; the dashed line is the slowest mode of the linearised dynamics at the optimum. "
        f"From a saddle the way is shortest at μ = {soonest:g}: with less the body leaves sooner, "
        "as the linearised dynamics there says (dashed), but has then to lose its energy before it "
        "can only end at the optimum. The gap is of the data, not of the motion."
    )


def _noise(sweep: Sweep) -> str:
    steps, margins = sweep.curves(STEPS), sweep.curves(MARGIN)
    return (
        "noise as large as the clouds hardly changes steps and escape times; ten times that does "
        f"not change the median of the steps, {steps.median[-1]:,.0f}, but the worst run makes "
        f"{steps.worst[-1]:,.0f}. Noise does not endanger the four equilibria, on the contrary: "
        f"the median gap grows from {margins.median[0]:.2g} to {margins.median[-1]:.2g}, as the "
        f"central limit theorem says (dashed). {_four(sweep)}"
    )


def _points(sweep: Sweep) -> str:
    steps, margins = sweep.curves(STEPS), sweep.curves(MARGIN)
    return (
        "steps and escape times do not depend on N; but some triangles (N = 3) are so thin that "
        f"explicit Euler needs short steps, up to {steps.worst[0]:,.0f} of them. The second "
        "moments of Gaussian clouds become equal in all directions as N grows, and the gap falls "
        f"as 1/√N (dashed: the central limit theorem), to {margins.median[-1]:.2g} at N = 10⁵. "
        f"{_four(sweep)}"
    )


def _symmetry(sweep: Sweep) -> str:
    return (
        "the spurious equilibria of a cube are infinitely many. With its corners moved at random, "
        "however little, they are three: the gap is proportional to the moves over eleven decades, "
        "as the first order of the second moments says (dashed). At 0 what is left of it is the "
        f"rounding of the targets. Steps and escape times do not notice. {_four(sweep)}"
    )


def _degeneracy(sweep: Sweep) -> str:
    steps, escape = sweep.curves(STEPS), sweep.curves(ESCAPE)
    lost = sum(int(each.lost.sum()) for each in sweep.measurements)
    return (
        "the target is nearly a mirror image of the source. Where d₂ + d₃ vanishes the optima form "
        "a circle; near it the springs hardly turn the body about one axis. Steps and escape times "
        f"grow as one over the distance, to {steps.median[0]:,.0f} steps and "
        f"{escape.median[0]:,.0f} units of time at {sweep.family.values[0]:g}, and the gap falls "
        "with it, as theory says (dashed). The paper's stopping rule, slow is enough, ends "
        f"{lost} of these runs more than 90° from the optimum."
    )


def _start(sweep: Sweep) -> str:
    values, escape = sweep.family.values, sweep.curves(ESCAPE).median
    decades = math.log10(values[-2] / values[0])
    lost = [each.value for each in sweep.measurements if each.lost.all()]
    stopped = (
        f"stops every run at the saddle from {rough(max(lost))} radians down" if lost else "holds"
    )
    return (
        "the body is released at rest, that far from the best saddle. For each decade nearer it "
        f"needs {(escape[0] - escape[-2]) / decades:.2f} units of time more, as the linearised "
        "dynamics says (dashed): the escape time is logarithmic. certreg kicks a body that is slow "
        f"outside of the basin by {SimulationSettings().first_perturbation:g} radians, so the "
        "steps grow no further (a); the most are made where it is just fast enough not to be "
        f"kicked. The paper's rule, slow is enough, {stopped}."
    )


def _four(sweep: Sweep) -> str:
    """Of how many instances the count is proved."""
    four = sum(int(each.four.sum()) for each in sweep.measurements)
    total = sum(len(each.four) for each in sweep.measurements)
    return (
        f"Exactly four equilibria, decided by proved bounds or in exact arithmetic: {four:,} of "
        f"{total:,} instances."
    )


WORDS: dict[str, Callable[[Sweep], str]] = {
    "damping": _damping,
    "noise": _noise,
    "points": _points,
    "symmetry": _symmetry,
    "degeneracy": _degeneracy,
    "start": _start,
}


LINES = ((VERMILLION, "o"), (ORANGE, "^"), (GREEN, "s"), (BLUE, "D"), (BLACK, "v"))
ISOTROPIC = 4  # equilibria of one weight for each pair, in general
DARK = 0.55  # of the colours: white letters beyond
LEGEND = 0.32  # of the axis, for the legend above the shares
MOST_SHADED = 14.0  # the median that is darkest


def spring_drawings(counts: Sequence[SpringCounts]) -> tuple[Drawing, ...]:
    """Both figures; none where nothing was measured."""
    return (counts_drawing(counts), ends_drawing(counts)) if counts else ()


def counts_drawing(counts: Sequence[SpringCounts]) -> Drawing:
    """Numbers of equilibria over noise and size, a panel for each family."""
    families = _by_family(counts)
    with house_style():
        figure = blank(2.9)
        axes = figure.subplots(1, len(families), squeeze=False)[0]
        for k, (panel, (name, cells)) in enumerate(zip(axes, families.items(), strict=True)):
            _table(panel, cells)
            panel.set_title(f"({'abc'[k]}) {FAMILY_WORDS[name]}")
        axes[0].set_ylabel("points N")
        figure.supxlabel("noise σ (clouds: 1)", fontsize=8.5)
    known = np.concatenate([each.counted for each in counts])
    return finished(
        name="springs-counts",
        title="Beyond the paper: how many equilibria general springs have",
        caption=(
            f"{len(counts[0].seen)} random instances in each cell: the least and the largest "
            "number of real equilibria, shaded by the median. One weight for each pair has "
            f"{ISOTROPIC} (last row, a theorem); these have {known.min()} to {known.max()}, always "
            "an even number. The fewer the springs beyond what fixes the pose, the more "
            f"equilibria; noise beyond the clouds' own size leaves few. {_listed(counts)}"
        ),
        figure=figure,
    )


def ends_drawing(counts: Sequence[SpringCounts]) -> Drawing:
    """Shares of instances with a stable spurious equilibrium, and of runs that end at one."""
    with house_style():
        figure = blank(4.2)
        axes = figure.subplots(
            2,
            len(_by_family(counts)),
            sharex=True,
            sharey="row",
            squeeze=False,
            height_ratios=(1.0 + LEGEND, 1.0),
        )
        _share_row(axes[0], counts, lambda each: each.trapping, legend=True)
        _share_row(axes[1], counts, lambda each: each.ended(RunEnd.SPURIOUS), legend=False)
        axes[0, 0].set_ylabel("share with a stable\nspurious equilibrium")
        axes[1, 0].set_ylabel("share of runs\nthat end at one")
        figure.supxlabel("noise σ (clouds: 1)", fontsize=8.5)
    known = sum(len(each.listed) for each in counts)
    trapping = sum(each.trapping for each in counts)
    wrong, lost = (
        sum(each.ended(end) for each in counts) for end in (RunEnd.SPURIOUS, RunEnd.UNSETTLED)
    )
    unsettled = f" {lost:,} had not settled at a stable one." if lost else ""
    return finished(
        name="springs-ends",
        title="Beyond the paper: stable spurious equilibria, and runs that end at them",
        caption=(
            "of the same instances the share in which an equilibrium other than the optimum is "
            f"stable ({trapping:,} of {known:,}), and the share of runs from the paper's start, at "
            f"rest with R = I, that end at one of these ({wrong:,}), with intervals of 95 %. With "
            "one weight for each pair both are zero: no spurious equilibrium is stable there. "
            f"With a hundred springs it is rare, with few it is common.{unsettled}"
        ),
        figure=figure,
    )


def _by_family(counts: Sequence[SpringCounts]) -> dict[str, list[SpringCounts]]:
    found: dict[str, list[SpringCounts]] = {}
    for each in counts:
        found.setdefault(each.cell.family, []).append(each)
    return found


def _table(panel: Any, cells: Sequence[SpringCounts]) -> None:
    """A cell for each size and noise: least to most, shaded by the median; last the isotropic."""
    sizes = sorted({each.cell.points for each in cells})
    noises = sorted({each.cell.noise for each in cells})
    shades = np.full((len(sizes) + 1, len(noises)), np.nan)
    shades[-1] = 0.0
    for column in range(len(noises)):
        panel.text(column, len(sizes), str(ISOTROPIC), ha="center", va="center", fontsize=6.5)
    for each in cells:
        known = each.counted
        if not len(known):
            continue
        row, column = sizes.index(each.cell.points), noises.index(each.cell.noise)
        shade = min(1.0, (float(np.median(known)) - ISOTROPIC) / (MOST_SHADED - ISOTROPIC))
        shades[row, column] = shade
        words = f"{known.min()}–{known.max()}" if known.min() < known.max() else f"{known[0]}"
        colour = "white" if shade > DARK else BLACK
        panel.text(column, row, words, ha="center", va="center", fontsize=6.5, color=colour)
    panel.imshow(shades, cmap="Blues", vmin=0.0, vmax=1.15, aspect="auto")
    panel.axhline(len(sizes) - 0.5, color=GREY, linewidth=1.0)
    panel.set_xticks(range(len(noises)), [f"{noise:g}" for noise in noises])
    panel.set_yticks(range(len(sizes) + 1), [*map(str, sizes), "one\nweight"])
    panel.tick_params(length=0.0, labelsize=7.0)


def _share_row(
    axes: Any,
    counts: Sequence[SpringCounts],
    seen: Callable[[SpringCounts], int],
    *,
    legend: bool,
) -> None:
    """A panel for each family: a share over the noise, a line for each size."""
    for k, (panel, (name, cells)) in enumerate(zip(axes, _by_family(counts).items(), strict=True)):
        sizes = sorted({each.cell.points for each in cells})
        for size, (colour, marker) in zip(sizes, LINES, strict=False):
            own = [each for each in cells if each.cell.points == size and each.listed]
            _line(panel, own, seen, color=colour, marker=marker, label=f"N = {size}")
        top = 1.03 + LEGEND * legend
        panel.set(xscale="log", ylim=(-0.03, top), yticks=np.linspace(0.0, 1.0, 6))
        panel.spines["left"].set_bounds(-0.03, 1.0)
        if legend:
            panel.set_title(f"({'abc'[k]}) {FAMILY_WORDS[name]}")
            panel.legend(
                loc="upper left", ncols=3, fontsize=6.5, handlelength=1.4, columnspacing=0.8
            )


def _line(
    panel: Any, cells: Sequence[SpringCounts], seen: Callable[[SpringCounts], int], **style: Any
) -> None:
    listed = [len(each.listed) for each in cells]
    shares = np.array([seen(each) / n for each, n in zip(cells, listed, strict=True)])
    ends = np.array([wilson(seen(each), n) for each, n in zip(cells, listed, strict=True)])
    apart = np.abs(ends.reshape(-1, 2).T - shares)
    noises = [each.cell.noise for each in cells]
    panel.errorbar(noises, shares, apart, markersize=4.0, linewidth=1.0, elinewidth=0.6, **style)


def _listed(counts: Sequence[SpringCounts]) -> str:
    """Whether any instance is left out."""
    total = sum(len(each.seen) for each in counts)
    missing = total - sum(len(each.listed) for each in counts)
    if not missing:
        return "Counted by 40 paths in doubles, which all ended apart."
    return (
        "Counted by 40 paths in doubles; "
        f"{missing:,} of {total:,} instances are left out, whose paths did not all end apart."
    )
