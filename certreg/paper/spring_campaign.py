"""The maps of general springs as a campaign: long runs that are stopped, and go on.

Item k is instance k % instances of cell k // instances. An instance draws from a seed of its own
(`spring_maps.generator`), so the counts are those of `spring_maps.measured` in one process, however
the campaign is cut up and whoever computes it.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.campaign.runner import contents
from certreg.campaign.store import Manifest, current_versions
from certreg.campaign.table import Block, Column, write_table
from certreg.campaign.task import TaskResult
from certreg.paper.monte_carlo import RandomCampaign, packed, unpacked
from certreg.paper.spring_maps import (
    SPRING_CELLS,
    SPRING_INSTANCES,
    RunEnd,
    SpringCell,
    SpringCounts,
    SpringObservation,
    generator,
    observed,
    spring_problem,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

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
