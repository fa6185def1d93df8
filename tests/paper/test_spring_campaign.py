"""The maps of general springs as a campaign: as in one process, stopped and gone on with."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import replace
from functools import partial
from types import SimpleNamespace
from typing import TYPE_CHECKING

import pytest
from campaign_work import InProcess, finish, tree
from commands import certreg as run_command

from certreg.campaign.store import MANIFEST, SHARDS
from certreg.campaign.table import SUMMARY, records_bytes
from certreg.cli import campaigns, reproducing
from certreg.cli.reproducing import LARGEST_RUNS
from certreg.errors import InvalidFileError, InvalidProblemError
from certreg.paper import equilibrium_maps
from certreg.paper.equilibrium_maps import (
    SPRING_CELLS,
    SPRING_COLUMNS,
    SPRING_INSTANCES,
    RunEnd,
    SpringCampaign,
    SpringCell,
    SpringCounts,
    SpringObservation,
    measured,
    spring_rows,
    write_spring_results,
)

if TYPE_CHECKING:
    from pathlib import Path

    from certreg.campaign.store import Manifest

CELLS = (
    SpringCell(family="plane", points=20, noise=0.1),
    SpringCell(family="covariance", points=10, noise=1.0),
)


class InPairs(SpringCampaign):
    """The same in shards of two."""

    def manifest(self) -> Manifest:
        return replace(super().manifest(), shard_size=2)


IN_PROCESS = (SpringCounts(cell=CELLS[0], seen=()),)  # stands for the maps that no campaign made
KIND = InPairs(instances=3, seed=5, cells=CELLS)  # the second shard holds the end of the first cell


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("springs") / "whole"
    finish(KIND, folder)
    write_spring_results(KIND, folder)
    return folder


@pytest.mark.slow
def test_a_campaign_sees_what_is_seen_in_one_process(whole):
    counts = write_spring_results(KIND, whole)
    expected = tuple(measured(cell, 5, 3) for cell in CELLS)

    assert counts == expected
    assert records_bytes(spring_rows(counts)) == records_bytes(spring_rows(expected))
    assert len({seen for each in counts for seen in each.seen}) > 1  # a row knows its instance


@pytest.mark.slow
def test_a_campaign_that_was_stopped_goes_on_to_the_same_bytes(whole, tmp_path):
    def stop(_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        finish(KIND, tmp_path, advanced=stop)
    (kept,) = (tmp_path / SHARDS).iterdir()
    (tmp_path / SHARDS / ".certreg-half").write_bytes(b"of a killed run")
    when = kept.stat().st_mtime_ns
    made: list[int] = []
    finish(KIND, tmp_path, advanced=made.append)
    write_spring_results(KIND, tmp_path)

    assert made == [2, 2]
    assert kept.stat().st_mtime_ns == when
    assert tree(tmp_path) == tree(whole)


@pytest.mark.slow
def test_the_table_has_a_row_for_each_instance(whole):
    rows = list(csv.DictReader(io.StringIO((whole / SUMMARY).read_text("utf-8"))))
    first = measured(CELLS[0], 5, 1).seen[0]

    assert list(rows[0]) == [column.name for column in SPRING_COLUMNS]
    assert [(row["family"], row["instance"]) for row in rows] == [
        (cell.family, str(k)) for cell in CELLS for k in range(3)
    ]
    assert rows[0] == {
        "family": "plane",
        "points": "20",
        "noise": "0.1",
        "instance": "0",
        "listed": "1",
        "equilibria": str(first.equilibria),
        "stable": str(first.stable),
        "spurious": str(first.spurious),
        "ended": str(int(first.ended)),
        "place": str(first.place),
    }


def test_every_number_of_an_observation_is_kept(tmp_path, monkeypatch):
    seen = (
        SpringObservation(listed=False),
        SpringObservation(equilibria=40, stable=8, spurious=7, ended=RunEnd.SPURIOUS, place=39),
        SpringObservation(equilibria=4, stable=1, ended=RunEnd.UNSETTLED),
    )
    expected = SpringCounts(cell=CELLS[0], seen=seen)
    again = iter(expected.seen)
    monkeypatch.setattr(equilibrium_maps, "observed", lambda _: next(again))
    kind = SpringCampaign(instances=3, cells=CELLS[:1])
    finish(kind, tmp_path)

    assert write_spring_results(kind, tmp_path) == (expected,)


def test_a_manifest_says_which_cells_and_another_seed_is_refused(whole):
    kept = json.loads((whole / MANIFEST).read_text("utf-8"))

    assert (kept["kind"], kept["count"]) == ("springs", 6)
    assert kept["settings"] == {
        "cells": [["plane", 20, 0.1], ["covariance", 10, 1.0]],
        "instances": 3,
        "seed": 5,
    }
    with pytest.raises(InvalidFileError, match=r"its settings\.seed is 5, here it is 6"):
        finish(replace(KIND, seed=6), whole)
    with pytest.raises(InvalidFileError, match=r"its settings\.cells is"):
        finish(replace(KIND, cells=CELLS[::-1]), whole)


@pytest.mark.parametrize("wrong", [{"instances": 0}, {"seed": -1}], ids=str)
def test_what_is_no_map_is_refused(wrong):
    with pytest.raises(InvalidProblemError, match="at least one instance of each cell"):
        SpringCampaign(**wrong).manifest()


def test_every_cell_is_mapped_unless_some_are_given():
    manifest = SpringCampaign().manifest()

    assert manifest.count == SPRING_INSTANCES * len(SPRING_CELLS)
    assert manifest.items(1) == range(64, 128)


@pytest.fixture
def figures(monkeypatch) -> list[tuple[SpringCounts, ...]]:
    """The springs of which figures are asked for; all that is not springs is left out."""
    asked: list[tuple[SpringCounts, ...]] = []

    def written(_made, _drawn, folder, _sweeps, springs):
        asked.append(springs)
        return folder

    made = SimpleNamespace(stands=True, observations=None)
    monkeypatch.setattr(reproducing, "reproduced", lambda *_, **__: made)
    monkeypatch.setattr(reproducing, "_run_campaign", lambda *_, **__: None)
    monkeypatch.setattr(reproducing, "all_sweeps", lambda *_: ())
    monkeypatch.setattr(reproducing, "paper_drawings", lambda _: ())
    monkeypatch.setattr(reproducing, "texts", lambda _: ())
    monkeypatch.setattr(reproducing, "spring_drawings", lambda _: ())
    monkeypatch.setattr(reproducing, "write_reproduction", written)
    monkeypatch.setattr(reproducing, "spring_counts", lambda *_: IN_PROCESS)
    monkeypatch.setattr(reproducing, "SpringCampaign", partial(InPairs, cells=CELLS))
    monkeypatch.setattr(campaigns, "workers_at", lambda _: InProcess())
    return asked


@pytest.mark.slow
def test_reproduce_reads_its_maps_from_the_campaign_and_goes_on(figures, tmp_path, whole):
    given = ("--scheduler", "tcp://here:1", "--runs", 3, "--seed", 5, "--out", tmp_path)
    first, again = (run_command("reproduce", "--beyond", *given) for _ in range(2))
    expected = write_spring_results(KIND, whole)

    assert figures == [expected, expected]
    wrong = sum(each.ended(RunEnd.SPURIOUS) for each in expected)
    assert first.out.startswith(
        "6 of 6 random instances of planes, lines and covariances have their equilibria counted "
        f"(not proved); {wrong} runs of these end at a stable spurious one\nTable: "
    )
    assert again.err.startswith("note: 6 of 6 instances were there already")
    assert tree(tmp_path / "springs-campaign") == tree(whole)


@pytest.mark.parametrize(
    ("given", "apart", "counts"),
    [
        (["--beyond", "--runs", LARGEST_RUNS], None, IN_PROCESS),
        (["--beyond", "--runs", LARGEST_RUNS + 1], LARGEST_RUNS + 1, ()),
        (["--beyond", "--scheduler", "tcp://here:1"], SPRING_INSTANCES, ()),
        (["--runs", LARGEST_RUNS + 1], None, ()),
    ],
    ids=str,
)
def test_maps_are_a_campaign_where_the_runs_are(
    figures, tmp_path, monkeypatch, given, apart, counts
):
    drawn: list[int] = []

    def campaign(kind, *_, **__):
        drawn.append(kind.instances)
        return ()

    monkeypatch.setattr(reproducing, "_run_springs", campaign)
    run_command("reproduce", *given, "--out", tmp_path)

    assert drawn == ([] if apart is None else [apart])
    assert figures == [counts]
