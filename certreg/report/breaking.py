"""The motion on springs that break, in a report: a picture of its course, and its stages."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.report.markup import rendered
from certreg.report.picture import SOURCE, SPRING
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.registration.breaking import SimulatedBreaking

TEMPLATE = "report/templates/breaking.html"
WIDTH, LEFT, RIGHT = 640, 64, 16  # pixels
TOP, PANEL, GAP, FOOT = 24, 110, 40, 24  # pixels: two panels, one above the other
APART = 0.15  # of a panel, between two marks that do not touch
MOST_ROWS = 14  # stages in the table: more are thinned, the first and the last kept
HEAD = ("bounds", "springs that hold", "broke", "mended", "energy", "time")


@dataclass(frozen=True, slots=True, kw_only=True)
class Tick(Brief):
    """A mark of an axis: its place in pixels, and what stands there."""

    place: str
    words: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Panel(Brief):
    """A curve over time with its name; top, bottom: pixels of its frame."""

    name: str
    top: int
    bottom: int
    curve: str
    colour: str
    ticks: tuple[Tick, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class CoursePicture(Brief):
    """Two panels over one axis of time, in pixels: what `templates/breaking.html` draws."""

    words: str
    panels: tuple[Panel, ...]
    times: tuple[Tick, ...]
    width: int = WIDTH
    height: int = TOP + 2 * PANEL + GAP + FOOT
    left: int = LEFT
    right: int = WIDTH - RIGHT


@dataclass(frozen=True, slots=True, kw_only=True)
class BreakingCourse(Brief):
    """What a page shows of the motion: how it ended, a picture, a row for each stage.

    picture: None where nothing moved.
    """

    words: str
    picture: CoursePicture | None
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str | None


def breaking_course(run: SimulatedBreaking) -> BreakingCourse:
    """What a page that includes `templates/breaking.html` gives it as `course`."""
    count = len(run.stages)
    shown = np.unique(np.linspace(0, count - 1, min(count, MOST_ROWS)).astype(np.int64)).tolist()
    note = f"{len(shown)} of {count} stages, evenly chosen." if len(shown) < count else None
    return BreakingCourse(
        words=run.ending,
        picture=_picture(run),
        head=HEAD,
        rows=tuple(_row(run, *pair) for pair in zip([None, *shown], shown, strict=False)),
        note=note,
    )


def breaking_fragment(run: SimulatedBreaking) -> str:
    """The motion as HTML on its own, that loads nothing and runs nothing."""
    return rendered(TEMPLATE, course=breaking_course(run))


def _row(run: SimulatedBreaking, before: int | None, index: int) -> tuple[str, ...]:
    stage = run.stages[index]
    held = stage.held
    last = np.ones_like(held) if before is None else run.stages[before].held
    return (
        f"{stage.width:.4g}",
        f"{stage.count:,} of {len(held):,}",
        f"{int((last & ~held).sum()):,}",
        f"{int((held & ~last).sum()):,}",
        f"{stage.energy:.6g}",
        f"{stage.time:.4g}",
    )


def _picture(run: SimulatedBreaking) -> CoursePicture | None:
    """Number of springs that hold and width of the bounds over time; None where nothing moved."""
    times = np.array([stage.time for stage in run.stages])
    total, n = float(times[-1]), run.problem.n
    if not total > 0.0:
        return None
    counts = np.array([stage.count for stage in run.stages], dtype=np.float64)
    widths = np.log([stage.width for stage in run.stages])
    widest, last = run.stages[0].width, run.stages[-1]
    across = LEFT + (WIDTH - LEFT - RIGHT) * np.concatenate([[0.0], times]) / total
    held_ticks = {0: "0", n: f"{n:,}"}
    if APART * n < last.count < (1.0 - APART) * n:
        held_ticks[last.count] = f"{last.count:,}"
    width_ticks = {1.0: "1", widest: f"{widest:.3g}"}
    top = float(widths.max()) or 1.0
    return CoursePicture(
        words="springs that hold, and the width of the bounds over those given, over time",
        panels=(
            _panel(
                "springs that hold",
                0,
                across,
                counts / n,
                SOURCE,
                {value / n: words for value, words in held_ticks.items()},
            ),
            _panel(
                "bounds, over those given (logarithmic)",
                1,
                across,
                widths / top,
                SPRING,
                {float(np.log(value)) / top: words for value, words in width_ticks.items()},
            ),
        ),
        times=(
            Tick(place=f"{LEFT}", words="0"),
            Tick(place=f"{WIDTH - RIGHT}", words=f"{total:.4g}"),
        ),
    )


def _panel(
    name: str,
    place: int,
    across: NDArray[np.float64],
    heights: NDArray[np.float64],
    colour: str,
    marks: dict[float, str],
) -> Panel:
    """A curve of steps: each height, from 0 to 1, from one time to the next."""
    top = TOP + place * (PANEL + GAP)
    corners = np.repeat(across, 2)[1:-1]
    down = top + PANEL * (1.0 - np.repeat(heights, 2))
    points = zip(corners.tolist(), down.tolist(), strict=True)
    return Panel(
        name=name,
        top=top,
        bottom=top + PANEL,
        curve=" ".join(f"{x:.1f},{y:.1f}" for x, y in points),
        colour=colour,
        ticks=tuple(
            Tick(place=f"{top + PANEL * (1.0 - height):.1f}", words=words)
            for height, words in marks.items()
        ),
    )
