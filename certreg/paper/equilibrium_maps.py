"""The paper's experiment with springs that are matrices: how many equilibria, and where runs end.

Clouds, motions and start are the paper's; the springs pull towards planes or lines, or along axes
of each pair's own. At each size and noise the critical rotations of many instances are found by
following 40 paths in doubles, and the body is released at rest where the source was given: counted,
not proved. An instance whose paths did not all end apart is left out, and said to be.

As a campaign, item k is instance k % instances of cell k // instances. An instance draws from a
seed of its own (`generator`), so the counts are those of `measured` in one process, however the
campaign is cut up and whoever computes it.

>>> cell = SpringCell(family="plane", points=7, noise=0.1)
>>> seen = observed(spring_problem(generator(cell, 0, 0), cell))
>>> seen.listed, seen.equilibria % 2, seen.stable > seen.spurious
(True, 0, True)
"""

from __future__ import annotations

import enum
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import astuple, dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.campaign.runner import contents
from certreg.campaign.store import Manifest, current_versions
from certreg.campaign.table import Block, Column, write_table
from certreg.campaign.workers import TaskResult
from certreg.dynamics.simulation import simulate
from certreg.equilibrium.paths import PathsOutcome, critical_lines
from certreg.equilibrium.quartics import FloatingQuartic
from certreg.objective.springs import Springs
from certreg.paper.monte_carlo import RandomCampaign, packed, unpacked
from certreg.paper.observations import StageProgress, each_of
from certreg.problem.problem import RegistrationProblem
from certreg.problem.random_instances import gaussian_instances

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray


SPRING_INSTANCES = 100  # in each cell: a share is known to 0.1
SPRINGS_FILE = "springs.csv"
LONGEST = 100.0  # axes of covariances: deviations from the noise down to a hundredth of it
TIED = 1e-12  # of the range of energies: far above rounding, far below what noise makes
NEAR = 1.0 - 1e-6  # cosine of half the angle to an equilibrium: within 0.16 degrees
Z95 = 1.959963984540054  # of the normal distribution, two-sided 95 %


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringCell:
    """Instances of one family, size and noise."""

    family: str
    points: int
    noise: float


FAMILY_WORDS = {"plane": "planes", "line": "lines", "covariance": "covariances"}
NOISES = (0.01, 0.1, 0.3, 1.0, 3.0)
SIZES = {"plane": (6, 7, 10, 20, 100), "line": (3, 4, 10, 100), "covariance": (3, 4, 10, 100)}
SPRING_CELLS = tuple(
    SpringCell(family=family, points=points, noise=noise)
    for family, sizes in SIZES.items()
    for points in sizes
    for noise in NOISES
)


class RunEnd(enum.IntEnum):
    """Where a run from the paper's start ends."""

    NOT_LISTED = -1  # paths did not end apart: nothing is said
    OPTIMUM = 0
    SPURIOUS = 1  # at a stable equilibrium of more energy
    UNSETTLED = 2  # not at rest, or at none of the stable equilibria


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringObservation:
    """What is seen of one instance.

    listed: whether all 40 paths ended apart. equilibria, stable: real critical rotations, and those
    of them that are minima; spurious: of these those with more energy than the least (six planes or
    three lines can be fitted exactly in several ways). place: of the equilibrium where the run
    ended, by energy from 0; -1: none.
    """

    listed: bool = True
    equilibria: int = 0
    stable: int = 0
    spurious: int = 0
    ended: RunEnd = RunEnd.NOT_LISTED
    place: int = -1


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringCounts:
    """A cell with what was seen of its instances, in order."""

    cell: SpringCell
    seen: tuple[SpringObservation, ...]

    @property
    def listed(self) -> tuple[SpringObservation, ...]:
        """The instances of which all is known."""
        return tuple(each for each in self.seen if each.listed)

    @property
    def counted(self) -> NDArray[np.int64]:
        """Their numbers of equilibria."""
        return np.array([each.equilibria for each in self.listed], dtype=np.int64)

    @property
    def trapping(self) -> int:
        """Instances with a stable spurious equilibrium."""
        return sum(each.spurious > 0 for each in self.listed)

    def ended(self, end: RunEnd) -> int:
        """Runs that end so."""
        return sum(each.ended is end for each in self.listed)


def spring_problem(rng: np.random.Generator, cell: SpringCell) -> RegistrationProblem:
    """A random instance: clouds and motion of the paper's experiment, springs of the family."""
    made = gaussian_instances(rng, points=cell.points, sigma=0.0)
    noise, springs = SPRINGS[cell.family](rng, cell.points, cell.noise)
    return RegistrationProblem(made.sources[0], made.targets[0] + noise, **springs)


Drawn = tuple["NDArray[np.float64]", dict[str, Any]]


def _planes(rng: np.random.Generator, n: int, noise: float) -> Drawn:
    return noise * rng.standard_normal((n, 3)), {"normals": _directions(rng, n)}


def _lines(rng: np.random.Generator, n: int, noise: float) -> Drawn:
    return noise * rng.standard_normal((n, 3)), {"directions": _directions(rng, n)}


def _covariances(rng: np.random.Generator, n: int, noise: float) -> Drawn:
    """Axes at random, deviations from `noise` down to a hundredth; noise is drawn from them."""
    axes = np.linalg.qr(rng.standard_normal((n, 3, 3)))[0]
    share = np.exp(-rng.uniform(0.0, math.log(LONGEST), size=(n, 3)))
    drawn = noise * share * rng.standard_normal((n, 3))
    information = np.einsum("nij,nj,nkj->nik", axes, share**-2.0, axes)
    information = (information + information.transpose(0, 2, 1)) / 2.0
    return np.einsum("nij,nj->ni", axes, drawn), {"information": information}


SPRINGS: dict[str, Callable[[np.random.Generator, int, float], Drawn]] = {
    "plane": _planes,
    "line": _lines,
    "covariance": _covariances,
}


def _directions(rng: np.random.Generator, n: int) -> NDArray[np.float64]:
    rows = rng.standard_normal((n, 3))
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)


def observed(problem: RegistrationProblem) -> SpringObservation:
    """The equilibria of an instance, counted, and where the run from its start ends."""
    objective = Springs.of(problem)
    quartic = objective.floating_quartic()[0]
    lines = critical_lines(quartic)
    if lines.outcome is not PathsOutcome.FOUND:
        return SpringObservation(listed=False)
    values, _, curvatures = FloatingQuartic.of(quartic).curvatures(lines.quaternions)
    stable = np.linalg.eigvalsh(curvatures)[:, 0] > 0.0
    above = values - values.min() > TIED * np.ptp(values)
    run = simulate(objective, problem.damping)
    cosines = np.abs(lines.quaternions @ run.quaternion)
    place = int(cosines.argmax())
    settled = run.at_rest and bool(stable[place]) and bool(cosines[place] > NEAR)
    end = RunEnd.SPURIOUS if above[place] else RunEnd.OPTIMUM
    return SpringObservation(
        equilibria=len(values),
        stable=int(stable.sum()),
        spurious=int((stable & above).sum()),
        ended=end if settled else RunEnd.UNSETTLED,
        place=place if settled else -1,
    )


def spring_counts(seed: int, runs: int | None, progress: StageProgress) -> tuple[SpringCounts, ...]:
    """Every cell measured on `runs` instances."""
    count = runs or SPRING_INSTANCES
    cells = each_of(SPRING_CELLS.__getitem__, len(SPRING_CELLS), "springs", progress)
    return tuple(measured(cell, seed, count) for cell in cells)


def measured(cell: SpringCell, seed: int, count: int) -> SpringCounts:
    """A cell: instance k is the same whatever the count, and however a campaign is cut up."""
    seen = [observed(spring_problem(generator(cell, seed, k), cell)) for k in range(count)]
    return SpringCounts(cell=cell, seen=tuple(seen))


def generator(cell: SpringCell, seed: int, instance: int) -> np.random.Generator:
    """The random numbers of an instance; the same at every noise, so that it alone differs."""
    key = (list(SIZES).index(cell.family), cell.points, instance)
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=key))


def wilson(seen: int, count: int) -> tuple[float, float]:
    """The interval of a share, 95 %, by Wilson's score.

    >>> [round(x, 3) for x in wilson(0, 100)]
    [0.0, 0.037]
    """
    if not count:
        return 0.0, 1.0
    share, spread = seen / count, Z95**2 / count
    middle = share + spread / 2.0
    half = math.sqrt(spread * (share * (1.0 - share) + spread / 4.0))
    low, high = (middle - half) / (1.0 + spread), (middle + half) / (1.0 + spread)
    return max(0.0, low), min(1.0, high)


def spring_rows(counts: Sequence[SpringCounts]) -> Iterator[dict[str, Any]]:
    """A row for each cell, of the CSV file or the JSON document; None where nothing was listed."""
    for each in counts:
        cell, listed, known = each.cell, each.listed, each.counted
        wrong = each.ended(RunEnd.SPURIOUS)
        trapping, ended = wilson(each.trapping, len(listed)), wilson(wrong, len(listed))
        yield {
            "family": cell.family,
            "points": cell.points,
            "noise": cell.noise,
            "instances": len(each.seen),
            "listed": len(listed),
            "equilibria_least": int(known.min()) if listed else None,
            "equilibria_median": float(np.median(known)) if listed else None,
            "equilibria_most": int(known.max()) if listed else None,
            "stable_most": max((one.stable for one in listed), default=None),
            "stable_spurious": each.trapping,
            "stable_spurious_low": trapping[0],
            "stable_spurious_high": trapping[1],
            "ended_at_optimum": each.ended(RunEnd.OPTIMUM),
            "ended_wrong": wrong,
            "ended_wrong_low": ended[0],
            "ended_wrong_high": ended[1],
            "unsettled": each.ended(RunEnd.UNSETTLED),
        }


SHARD_ITEMS = 64  # a second of work
SEEN = tuple(field.name for field in fields(SpringObservation))  # each is a whole number
SPRING_COLUMNS = (
    Column("family", str, "", "plane, line or covariance"),
    Column("points", int, "", "pairs of points, each with a spring"),
    Column("noise", float, "1", "standard deviation of the noise, in the clouds' own"),
    Column("instance", int, "", "number of the instance within its family, size and noise, from 0"),
    Column("listed", int, "", "1 if all 40 paths ended apart, 0 if not: nothing more is said then"),
    Column("equilibria", int, "", "real critical rotations"),
    Column("stable", int, "", "those of them that are minima"),
    Column("spurious", int, "", "stable ones of more energy than the least"),
    Column("ended", int, "", "the run: 0 optimum, 1 stable spurious, 2 unsettled, -1 not listed"),
    Column("place", int, "", "of the equilibrium where it ended, by energy from 0; -1 none"),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringCampaign(RandomCampaign):
    """So many instances of each cell; a seed."""

    instances: int = SPRING_INSTANCES
    seed: int = 0
    cells: tuple[SpringCell, ...] = SPRING_CELLS

    def manifest(self) -> Manifest:
        """All of it. Raises InvalidProblemError where it is no campaign."""
        words = "give at least one instance of each cell, and a seed >= 0"
        self._least(words, instances=1, seed=0)
        return Manifest(
            kind="springs",
            count=self.instances * len(self.cells),
            shard_size=SHARD_ITEMS,
            settings={
                "instances": self.instances,
                "seed": self.seed,
                "cells": [astuple(cell) for cell in self.cells],
            },
            versions=current_versions(),
        )

    @property
    def work(self) -> Callable[..., TaskResult]:
        """Instances observed: counted, not proved."""
        return seen_of


def seen_of(*, manifest: Manifest, shard: int) -> TaskResult:
    """What is seen of the instances of a shard: a row of numbers each."""
    settings, rows = manifest.settings, list[tuple[int, ...]]()
    for item in manifest.items(shard):
        place, instance = divmod(item, settings["instances"])
        family, points, noise = settings["cells"][place]
        cell = SpringCell(family=family, points=points, noise=noise)
        seen = observed(spring_problem(generator(cell, settings["seed"], instance), cell))
        rows.append(astuple(seen))
    return TaskResult(content=packed({"seen": np.array(rows, dtype=np.int8)}))


def write_spring_results(
    kind: SpringCampaign, folder: Path, *, parquet: bool = False
) -> tuple[SpringCounts, ...]:
    """Write the table of all instances; every cell with what was seen of them.

    Raises InvalidFileError, MissingToolError.
    """
    manifest, seen = kind.manifest(), list[SpringObservation]()

    def blocks() -> Iterator[Block]:
        for shard, content in enumerate(contents(kind, folder)):
            rows = unpacked(content)["seen"].tolist()
            seen.extend(map(_observation, rows))
            yield _table_columns(kind, manifest.items(shard), rows)

    write_table(folder, SPRING_COLUMNS, blocks(), parquet=parquet)
    each = kind.instances
    return tuple(
        SpringCounts(cell=cell, seen=tuple(seen[k * each : (k + 1) * each]))
        for k, cell in enumerate(kind.cells)
    )


def _observation(row: list[int]) -> SpringObservation:
    values: dict[str, Any] = dict(zip(SEEN, row, strict=True))
    values |= {"listed": bool(values["listed"]), "ended": RunEnd(values["ended"])}
    return SpringObservation(**values)


def _table_columns(kind: SpringCampaign, items: range, rows: list[list[int]]) -> Block:
    """The columns of the table, of a shard."""
    places = [divmod(item, kind.instances) for item in items]
    cells = [astuple(kind.cells[place]) for place, _ in places]
    lines = zip(cells, places, rows, strict=True)
    table = [[*cell, instance, *row] for cell, (_, instance), row in lines]
    return [list(column) for column in zip(*table, strict=True)]
