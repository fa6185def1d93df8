"""Pictures of pairs with bounds: where they are, and how far off against their bounds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.report.picture import SOURCE, SPRING, flattened, pixels
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.registration.labelled import LabelledRegistration

    Reals = NDArray[np.float64]

COLOURS = {"inlier": SOURCE, "outlier": SPRING, "undecided": "#8a5fbf"}  # told apart in the dark
LEGEND = 24  # pixels below the pairs
MOST = 400  # pairs drawn: more are thinned evenly
SCALE = 2.4  # of the usual small picture
WIDTH, HEIGHT, LEFT, TOP, FOOT, RIGHT = 576, 220, 56, 14, 30, 10  # pixels, of the residuals
LEAST, HIGHEST = 1e-3, 1e3  # of a bound: smaller and larger residuals are drawn at the edge


@dataclass(frozen=True, slots=True, kw_only=True)
class LabelledPairs(Brief):
    """Pairs of one label, in pixels: lines from source to target, rings, dots."""

    word: str
    colour: str
    count: int
    lines: tuple[tuple[str, ...], ...]
    rings: tuple[tuple[str, ...], ...]
    dots: tuple[tuple[str, ...], ...]

    @property
    def told(self) -> str:
        """How many there are, for the legend."""
        return f"{self.count} {self.word}{'s' * (self.word != 'undecided' and self.count != 1)}"


@dataclass(frozen=True, slots=True, kw_only=True)
class PairsPicture(Brief):
    """Both clouds at the pose."""

    words: str
    groups: tuple[LabelledPairs, ...]
    width: int
    height: int


@dataclass(frozen=True, slots=True, kw_only=True)
class ChartMark(Brief):
    """A line across the chart and what stands beside it."""

    place: str
    words: str
    strong: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class ResidualChart(Brief):
    """Residuals over bounds, the smallest on the left, on a logarithmic scale."""

    words: str
    groups: tuple[LabelledPairs, ...]
    marks: tuple[ChartMark, ...]
    width: int = WIDTH
    height: int = HEIGHT
    left: int = LEFT
    right: int = WIDTH - RIGHT


def pairs_picture(result: LabelledRegistration) -> PairsPicture | None:
    """The clouds at the pose, each pair in the colour of its label; None beyond the doubles."""
    rows = _shown(result)
    block = result.problem.points
    moved = result.pose.apply(block.source[rows])
    flat = flattened(np.stack([block.target[rows], moved]))
    if flat is None:
        return None
    target, source = (SCALE * part for part in flat)
    labels = np.array(result.labels)[rows]
    more = f"; {len(rows)} of {result.problem.n} pairs" if len(rows) < result.problem.n else ""
    return PairsPicture(
        words=f"the target as rings, the source at the pose as dots, by label{more}",
        groups=_grouped(labels, source, lines=np.hstack([source, target]), rings=target),
        width=round(SCALE * 240),
        height=round(SCALE * 160) + LEGEND,
    )


def residual_chart(result: LabelledRegistration) -> ResidualChart:
    """How far each pair is off, as a multiple of its bound."""
    rows = _shown(result)
    share = result.residuals[rows] / result.problem.bounds[rows]
    order = np.argsort(share, kind="stable")
    share, labels = share[order], np.array(result.labels)[rows][order]
    low = max(LEAST, min(0.1, float(share.min()) if share.min() > 0.0 else LEAST))
    high = min(HIGHEST, max(10.0, float(share.max())))
    across = LEFT + (WIDTH - LEFT - RIGHT) * (np.arange(len(rows)) + 0.5) / len(rows)
    places = np.column_stack([across, _down(np.clip(share, low, high), low, high)])
    steps = range(math.ceil(math.log10(low) - 1e-9), math.floor(math.log10(high) + 1e-9) + 1)
    return ResidualChart(
        words="residuals at the pose over bounds, from the smallest to the largest",
        groups=_grouped(labels, places),
        marks=tuple(
            ChartMark(
                place=f"{float(_down(np.array([10.0**k]), low, high)[0]):.1f}",
                words="bound" if k == 0 else f"{10.0**k:g} ×",
                strong=k == 0,
            )
            for k in steps
        ),
    )


def _grouped(
    labels: NDArray[np.str_],
    dots: Reals,
    *,
    lines: Reals | None = None,
    rings: Reals | None = None,
) -> tuple[LabelledPairs, ...]:
    """The places of the pairs, in pixels, by label."""
    return tuple(
        LabelledPairs(
            word=word,
            colour=colour,
            count=int(own.sum()),
            lines=() if lines is None else pixels(lines[own]),
            rings=() if rings is None else pixels(rings[own]),
            dots=pixels(dots[own]),
        )
        for word, colour in COLOURS.items()
        for own in [labels == word]
    )


def _down(share: NDArray[np.float64], low: float, high: float) -> NDArray[np.float64]:
    span = math.log(high / low)
    return TOP + (HEIGHT - TOP - FOOT) * (1.0 - np.log(share / low) / span)


def _shown(result: LabelledRegistration) -> NDArray[np.intp]:
    n = result.problem.n
    return np.unique(np.linspace(0, n - 1, min(n, MOST)).astype(np.intp))
