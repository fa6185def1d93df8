"""The plots of a run, made from its document alone: `python -m benchmarks.plots JSON FOLDER`."""

from __future__ import annotations

import io
import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from benchmarks.run import read
from certreg.io.atomic import write_atomically

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Colours of Okabe and Ito for what certreg does; peers are grey, told apart by labels and marks.
BLUE, SKY, ORANGE, BLACK, GREY = "#0072B2", "#56B4E9", "#D55E00", "#000000", "#8a8a8a"
MARKS = "os^vD<>phX*P"  # the peers' lines carry them, and so do their names
CASES = {  # of `accuracy`, with colour and mark
    "generic, no weights": ("at the origin", "#0072B2", "o"),
    "offset 1e6, no weights": ("offset 10⁶", "#E69F00", "s"),
    "offset as in UTM, no weights": ("offset as in UTM", "#009E73", "^"),
    "offset 1e8, no weights": ("offset 10⁸", "#CC79A7", "D"),
}
ROOM = 100  # times the size at the end of a line: there its name fits beside it
ROUNDING = 1.1e-16  # half a unit in the last place of 1
STYLE: Any = {
    "axes.spines.right": False,
    "axes.spines.top": False,
    "figure.facecolor": "white",
    "font.size": 9,
    "svg.fonttype": "path",  # the same everywhere, whatever fonts a reader has
    "svg.hashsalt": "certreg",
}
TITLES = {"points": "points N", "instances": "instances of 100 points"}


def drawings(run: dict[str, Any]) -> dict[str, bytes]:
    """The plots that the run has data for, as SVG; without a date: equal runs, equal files."""
    import matplotlib as mpl

    with mpl.rc_context(STYLE):
        return {name: _svg(figure) for name, figure in figures(run)}


def write(run: dict[str, Any], folder: Path) -> list[Path]:
    """The drawings as files in a folder. Raises InvalidFileError."""
    found = {folder / f"{name}.svg": drawing for name, drawing in drawings(run).items()}
    for path, drawing in found.items():
        write_atomically(path, drawing)
    return list(found)


def figures(run: dict[str, Any]) -> Iterator[tuple[str, Figure]]:
    """The name and the figure of every plot."""
    for row in run["series"].values():
        for series in row:
            yield f"cost-against-{series['size']}", cost(series)
    if any(figure["what"] in CASES for figure in run["figures"].get("accuracy", ())):
        yield "accuracy", accuracy(run)


def cost(series: dict[str, Any]) -> Figure:
    """Seconds against a size, both logarithmic; every line is named where it ends."""
    figure, axes = _sheet((7.2, 4.6))
    looks = {line["name"]: _look(line["name"], k) for k, line in enumerate(series["lines"])}
    for line in series["lines"]:
        axes.plot(line["sizes"], line["seconds"], **looks[line["name"]])
    axes.set(xscale="log", yscale="log", xlabel=TITLES[series["size"]], ylabel="seconds")
    axes.set_title(series["what"], loc="left")
    axes.grid(visible=True, color="0.92")
    _name_lines(axes, series["lines"], looks)
    return figure


def accuracy(run: dict[str, Any]) -> Figure:
    """A row for each tool, a mark for each case: the worst angle to the optimum."""
    figure, axes = _sheet((7.2, 3.9))
    found = {f["what"]: f["beside"] for f in run["figures"]["accuracy"] if f["what"] in CASES}
    tools = list(next(iter(found.values())))[::-1]
    rows = range(len(tools))
    axes.hlines(rows, 1e-17, 10, color="0.9", lw=0.8, zorder=0)
    axes.axvline(ROUNDING, color="0.6", lw=0.8, ls=":")
    axes.annotate("a double's rounding", (ROUNDING, len(tools) - 0.4), color="0.4", ha="center")
    for case, beside in found.items():
        words, colour, mark = CASES[case]
        errors = [beside[tool]["value"] or math.nan for tool in tools]
        axes.plot(errors, rows, mark, color=colour, mfc="white", ms=6, mew=1.4, label=words)
    axes.set(xscale="log", xlim=(4e-17, 8), xlabel="angle to the optimum, radians, worst of 20")
    axes.set_yticks(rows, tools)
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
    figure.legend(loc="outside upper left", ncols=len(CASES), frameon=False)
    return figure


def _svg(figure: Figure) -> bytes:
    stream = io.BytesIO()
    figure.savefig(stream, format="svg", metadata={"Date": None})
    return stream.getvalue()


def _sheet(size: tuple[float, float]) -> tuple[Figure, Axes]:
    """A figure of its own, not of pyplot: nothing is kept open."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, layout="constrained")
    FigureCanvasAgg(figure)
    return figure, figure.subplots()


def _look(name: str, number: int) -> dict[str, Any]:
    """The first line is certreg's and stands out; the bound of nature is dashed; peers are grey."""
    if not number:
        return {"color": BLUE, "lw": 2.6, "marker": "o", "ms": 6, "zorder": 4}
    if name == "certreg, with proof":
        return {"color": ORANGE, "lw": 1.8, "marker": "s", "ms": 5, "zorder": 3}
    if name.startswith("certreg"):
        return {"color": SKY, "lw": 1.4, "marker": "o", "ms": 4, "zorder": 3}
    if name.startswith("reading"):
        return {"color": BLACK, "lw": 1.4, "ls": "--", "zorder": 3}
    return {"color": GREY, "lw": 0.9, "marker": MARKS[number % len(MARKS)], "ms": 4, "zorder": 2}


def _name_lines(
    axes: Axes, lines: Sequence[dict[str, Any]], looks: dict[str, dict[str, Any]]
) -> None:
    """In a column at the right, in the order of the ends; over the end where it is early."""
    last = max(line["sizes"][-1] for line in lines)
    low, high = (math.log10(each) for each in axes.get_ylim())
    long = [line for line in lines if line["sizes"][-1] == last]
    heights = [(math.log10(line["seconds"][-1]) - low) / (high - low) for line in long]
    for line in lines:
        end, look = (line["sizes"][-1], line["seconds"][-1]), looks[line["name"]]
        words = {"color": "0.3" if look["color"] == GREY else look["color"], "va": "center"}
        if line not in long:
            beside = end[0] * ROOM <= last
            place = (
                {"xytext": (8, 0), "ha": "left"} if beside else {"xytext": (0, 9), "ha": "right"}
            )
            axes.annotate(line["name"], end, textcoords="offset points", **place, **words)
            continue
        height = spread(heights, gap=0.055)[long.index(line)]
        axes.annotate(
            "",
            end,
            (1.06, height),
            textcoords="axes fraction",
            arrowprops={"arrowstyle": "-", "color": "0.8", "lw": 0.6, "shrinkA": 1, "shrinkB": 3},
            annotation_clip=False,
        )
        axes.plot(1.07, height, **{**look, "ls": ""}, transform=axes.transAxes, clip_on=False)
        axes.text(1.09, height, line["name"], transform=axes.transAxes, **words)


def spread(heights: Sequence[float], *, gap: float) -> list[float]:
    """The heights moved as little as a simple rule can, so that they are `gap` apart, in order.

    >>> [round(each, 2) for each in spread([0.5, 0.52, 0.1], gap=0.1)]
    [0.46, 0.56, 0.1]
    """
    order = sorted(range(len(heights)), key=heights.__getitem__)
    groups: list[list[int]] = []
    for k in order:  # a group is a stack around the mean of what it holds
        groups.append([k])
        while len(groups) > 1 and _bottom(groups[-1], heights, gap) < gap + _top(
            groups[-2], heights, gap
        ):
            groups[-2:] = [groups[-2] + groups[-1]]
    placed = dict.fromkeys(order, 0.0)
    for group in groups:
        for position, k in enumerate(group):
            placed[k] = _bottom(group, heights, gap) + gap * position
    return [placed[k] for k in range(len(heights))]


def _bottom(group: Sequence[int], heights: Sequence[float], gap: float) -> float:
    return sum(heights[k] for k in group) / len(group) - gap * (len(group) - 1) / 2


def _top(group: Sequence[int], heights: Sequence[float], gap: float) -> float:
    return _bottom(group, heights, gap) + gap * (len(group) - 1)


if __name__ == "__main__":
    for plot in write(read(Path(sys.argv[1])), Path(sys.argv[2])):
        print(plot)
