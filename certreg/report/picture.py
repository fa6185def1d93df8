"""Small static pictures of results, drawn as SVG of our own: no library, no script, no network."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.registration.whitened_residuals import SpringAxes
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.dynamics.trajectory import Trajectory
    from certreg.registration.result import Registration
    from certreg.registration.whitened_residuals import SpringAxes


WIDTH, HEIGHT, MARGIN = 240, 160, 10  # pixels
BODY = 30  # points: fewer are hardly seen without lines between them
SHOWN = 200  # points: a card is 20 kB at most
ON_PAGE = 400  # points, of general springs, with what is held of each: 60 kB
CROWD = 60  # points: more are drawn smaller
PIECE = 0.2  # half of the side of a piece of a plane, of the median distance from the middle
CLOUDS = "the target as rings, the source at the pose as dots"
VIEW = np.array([[1.0, 0.0], [0.0, 0.87], [0.0, 0.5]])  # from 30 degrees beside the thinnest
SOURCE, SPRING = "#0a84c6", "#d9690f"  # blue and orange, told apart by all eyes on any ground


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sample(Brief):
    """Some of the correspondences, evenly chosen: target and moved source, (k, 3)."""

    target: NDArray[np.float64]
    moved: NDArray[np.float64]
    ends: NDArray[np.float64] | None  # of general springs, where each pulls to; None: the target
    axes: SpringAxes | None  # of general springs

    @classmethod
    def of(cls, registration: Registration, most: int) -> Sample:
        """At most so many rows of a registration, the first and the last among them."""
        problem, n = registration.problem, registration.problem.n
        rows = np.unique(np.linspace(0, n - 1, min(n, most)).astype(np.int64))
        with np.errstate(over="ignore", invalid="ignore"):
            moved = registration.pose.apply(problem.source[rows])
        target, axes, ends = problem.target[rows].astype(np.float64), None, None
        if np.isfinite(moved).all():
            axes = registration.solution.spring_axes(rows)
        if axes is not None:
            ends = axes.pulled_to(moved, target)
        return cls(target=target, moved=moved, ends=ends, axes=axes)

    @property
    def pieces(self) -> NDArray[np.float64] | None:
        """(4, k, 3): corners of a square in each plane, about the target; two of a line; else one.

        None where springs are not general.
        """
        if self.axes is None:
            return None
        off = np.linalg.norm(self.target - np.median(self.target, axis=0), axis=1)
        half = PIECE * min(1.0, (CROWD / len(self.target)) ** 0.5) * float(np.median(off))
        ranks = self.axes.ranks[:, np.newaxis]
        across = half * self.axes.axes[:, :, 1] * (ranks == 1)
        along = half * self.axes.axes[:, :, 2] * ((ranks == 1) | (ranks == 2))
        turns = ((1, 1), (1, -1), (-1, -1), (-1, 1))
        return np.stack([self.target + a * across + b * along for a, b in turns])


@dataclass(frozen=True, slots=True, kw_only=True)
class Picture(Brief):
    """What `templates/card.html` draws, in pixels: as text, for it computes nothing.

    words: what is to be seen. springs: lines x1, y1, x2, y2. rings, dots: of target and moved
    source. spokes: from the target's centre, for few points. pieces: the corners of pieces of
    planes, and of lines. curve: the points of a line. radii: of rings and dots. stroke: of lines,
    where it is not 1.
    """

    words: str
    pieces: tuple[str, ...] = ()
    radii: tuple[float, float] = (3, 1.6)
    stroke: float | None = None
    springs: tuple[tuple[str, ...], ...] = ()
    rings: tuple[tuple[str, ...], ...] = ()
    dots: tuple[tuple[str, ...], ...] = ()
    spokes: tuple[tuple[str, ...], ...] = ()
    curve: str | None = None
    width: int = WIDTH
    height: int = HEIGHT
    margin: int = MARGIN
    source_colour: str = SOURCE
    spring_colour: str = SPRING


def registration_picture(registration: Registration) -> Picture | None:
    """Target and moved source, seen obliquely, so that no distance is hidden by the view.

    None where that leaves the doubles.
    """
    sample = Sample.of(registration, SHOWN)
    clouds = [sample.target, sample.moved, *([] if sample.ends is None else [sample.ends])]
    flat = flattened(np.stack(clouds))
    if flat is None:
        return None
    target, moved, *ends = flat
    centre = target.mean(axis=0)
    bodied = len(target) <= BODY and not ends
    return Picture(
        words=f"{CLOUDS}{shown_words(registration)}",
        springs=pixels(np.hstack([*(ends or [target]), moved])),
        rings=pixels(target),
        dots=pixels(moved),
        spokes=pixels(np.hstack([np.broadcast_to(centre, target.shape), target])) if bodied else (),
        radii=(5, 3) if bodied else (3, 1.6),
    )


def shown_words(registration: Registration, most: int = SHOWN) -> str:
    """How many of the pairs are drawn, where it is not all of them."""
    n = registration.problem.n
    return f"; {most} of {n} pairs, evenly chosen" if n > most else ""


def springs_picture(registration: Registration) -> Picture | None:
    """As `registration_picture`, with a piece of each plane and line, for a page."""
    sample = Sample.of(registration, ON_PAGE)
    axes, ends, pieces = sample.axes, sample.ends, sample.pieces
    if axes is None or ends is None or pieces is None:
        return None
    flat = flattened(np.stack([sample.target, sample.moved, ends, *pieces]))
    if flat is None:
        return None
    target, moved, ends, *corners = flat
    held = (axes.ranks == 1) | (axes.ranks == 2)
    shapes = np.hstack(corners)[held]
    return Picture(
        words=f"{CLOUDS}{shown_words(registration, ON_PAGE)}",
        springs=pixels(np.hstack([ends, moved])),
        rings=pixels(target),
        dots=pixels(moved),
        pieces=tuple(map(" ".join, pixels(shapes))),
        radii=(2, 1.1) if len(target) <= CROWD else (1, 0.6),
        stroke=0.5 if len(target) <= CROWD else 0.25,
    )


def energy_picture(trajectory: Trajectory) -> Picture | None:
    """The energy over time, as a line; None where that leaves the doubles."""
    with np.errstate(over="ignore", invalid="ignore"):
        energy = trajectory.potential + trajectory.kinetic
    return _over_time(trajectory.times, energy, "the energy over time, from the start to rest")


def scale_picture(trajectory: Trajectory) -> Picture | None:
    """The scale over time, as a line from 0 up; None where it is 1, or leaves the doubles."""
    if trajectory.scales is None:
        return None
    words = "the scale over time, from 1 to rest"
    return _over_time(trajectory.times, trajectory.scales, words)


def _over_time(
    times: NDArray[np.float64], values: NDArray[np.float64], words: str
) -> Picture | None:
    rows = np.unique(np.linspace(0, len(values) - 1, SHOWN).astype(np.int64))
    times, height = times[rows], values[rows]
    last, top = float(times[-1]), float(height.max())
    if not (np.isfinite([last, top]).all() and last > 0.0 and top > 0.0):
        return None
    across = MARGIN + (WIDTH - 2 * MARGIN) * (times / last)
    down = HEIGHT - MARGIN - (HEIGHT - 2 * MARGIN) * (height / top)
    return Picture(
        words=words,
        curve=" ".join(map(",".join, pixels(np.column_stack([across, down])))),
    )


def pixels(rows: NDArray[np.float64]) -> tuple[tuple[str, ...], ...]:
    """Numbers of rows as text, to a tenth of a pixel."""
    return tuple(tuple(f"{value:.1f}" for value in row) for row in rows.tolist())


def flattened(clouds: NDArray[np.float64]) -> Iterator[NDArray[np.float64]] | None:
    """Clouds (m, k, 3) in pixels (k, 2) each: the widest direction of both across the picture.

    Up goes the second, and some of the thinnest: along it a mirrored cloud is off.
    """
    points = clouds.reshape(-1, 3)
    with np.errstate(over="ignore", invalid="ignore"):
        centred = points - points[:1]
        centred -= centred.mean(axis=0)
        size = float(np.abs(centred).max())
        if not np.isfinite(size):
            return None
        centred /= size or 1.0
    _, _, axes = np.linalg.svd(centred, full_matrices=False)
    along = np.zeros((len(points), 3))
    along[:, : len(axes)] = centred @ axes.T  # a single correspondence has two directions
    flat = along @ VIEW
    low, high = flat.min(axis=0), flat.max(axis=0)
    room = np.array([WIDTH - 2 * MARGIN, HEIGHT - 2 * MARGIN])
    spans = np.maximum(high - low, 1e-9)
    pixels = (flat - (low + high) / 2.0) * float((room / spans).min())
    pixels += np.array([WIDTH / 2.0, HEIGHT / 2.0])
    return iter(pixels.reshape(len(clouds), -1, 2))
