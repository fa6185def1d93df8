"""The figures of `spring_maps`: how many equilibria, and how often runs end at a wrong one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.paper.equilibrium_maps import FAMILY_WORDS, RunEnd, wilson
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

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from certreg.paper.equilibrium_maps import SpringCounts

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
