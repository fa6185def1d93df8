"""A row of a list of pairs: which line it names, where its files lie, what becomes of it."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from campaign_work import VERSIONS, Cut, Fragile, InProcess, numbered
from commands import write_csv

from certreg.campaign import pairs, runner
from certreg.campaign.listing import read_listing
from certreg.campaign.pairs import PairCampaign, Tally
from certreg.campaign.runner import completed
from certreg.campaign.store import Shards, occupied
from certreg.cli import campaigns
from certreg.cli.progress import Progress
from certreg.errors import InvalidFileError
from certreg.registration.certification import certify

if TYPE_CHECKING:
    from pathlib import Path

    from certreg.campaign.listing import PairRow

POINTS = np.random.default_rng(3).standard_normal((5, 3))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_csv(tmp_path / "a.csv", POINTS.tolist())
    write_csv(tmp_path / "b.csv", POINTS[::-1].tolist())
    return tmp_path


def rows(folder: Path, *lines: str) -> list[PairRow]:
    (folder / "pairs.csv").write_text("\n".join([*lines, ""]), "utf-8")
    return list(read_listing(folder / "pairs.csv").rows())


def test_a_name_that_comes_a_third_time_is_told_the_first_line(folder: Path):
    faults = [row.fault or "" for row in rows(folder, "name,source,target", *["a,a.csv,b.csv"] * 3)]

    assert [bool(fault) for fault in faults] == [False, True, True]
    assert all("is that of line 2, too" in fault for fault in faults[1:])


def test_pairs_without_a_name_are_numbered_from_one_whatever_other_columns_call_them(
    folder: Path,
):
    found = rows(folder, "id,source,target", "7,a.csv,b.csv", "8,a.csv,b.csv")

    assert [(row.name, row.number) for row in found] == [("pair-1", 0), ("pair-2", 1)]
    assert read_listing(folder / "pairs.csv").ignored == ("id",)


def test_of_a_name_and_a_label_the_name_is_read(folder: Path):
    found = rows(folder, "name,label,source,target", "n,l,a.csv,b.csv")

    assert [row.name for row in found] == ["n"]
    assert read_listing(folder / "pairs.csv").ignored == ("label",)


def test_a_row_with_a_column_too_few_or_many_says_how_many_it_has(folder: Path):
    found = rows(folder, "source,target,sigma", "a.csv,b.csv", "a.csv,b.csv,1,2")

    assert [row.fault for row in found] == [f"{n} columns, not 3: mend the row" for n in (2, 4)]


@pytest.mark.parametrize("column", ["sigma", "damping"])
def test_a_number_that_is_none_is_told_with_its_line_and_column(folder: Path, column: str):
    (row,) = rows(folder, f"source,target,{column}", "a.csv,b.csv,many")
    with pytest.raises(InvalidFileError, match=f"line 2, {column}: 'many'") as caught:
        pairs._problem(row, folder)

    assert (caught.value.line, caught.value.column) == (2, column)


def test_the_files_of_a_row_lie_beside_the_list(folder: Path):
    """Whatever the folder is in which the command runs."""
    weights = [1.0, 2.0, 0.0, 4.0, 5.0]
    (folder / "w.txt").write_text("\n".join(map(str, weights)), "utf-8")
    (folder / "p.csv").write_text("0,4\n2,2\n4,0\n", "utf-8")
    header = "source,target,weights,pairs,damping,match"
    (row,) = rows(folder, header, "a.csv,b.csv,w.txt,p.csv,3.5,all")
    problem, pair = pairs._problem(row, folder)

    assert problem.weights.tolist() == [weights[k] for k in (0, 2, 4)]
    assert (problem.source.tolist(), problem.damping) == (POINTS[[0, 2, 4]].tolist(), 3.5)
    assert problem.target.tolist() == problem.source.tolist()
    assert pair.left_out == (2, 2)


@pytest.mark.slow
def test_a_certificate_that_is_kept_leaves_no_reason_for_its_absence(
    folder: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(pairs, "certify", partial(certify, relaxation=False, simulation=False))
    found = rows(folder, "name,source,target", "a/b,a.csv,b.csv", "c,b.csv,a.csv")
    limits = PairCampaign(listing=read_listing(folder / "pairs.csv"), certificates=True).limits
    for kept in (True, False):
        made = pairs.certify_pairs(
            rows=tuple(found), folder=str(folder), certificates=kept, limits=limits
        )
        entries = [json.loads(line) for line in made.content.splitlines()]
        names = ["000001-a_b.json", "000002-c.json"] if kept else []
        assert list(made.files) == names
        for k, entry in enumerate(entries):
            assert entry["certificate"] == (f"certificates/{names[k]}" if kept else None)
            assert ("certificate" in entry["reasons"]) != kept
            assert (entry["timings_ms"], entry["exit_code"]) == ({}, 0)


def test_no_more_than_the_first_ten_of_a_kind_are_told_by_name():
    tally = Tally()
    error: dict[str, Any] = {"schema": pairs.ERROR_SCHEMA, "exit_code": 2}
    poor = {"schema": "certreg-result/1", "exit_code": 0, "fit": {"warnings": [{"text": "bad"}]}}
    for k in range(pairs.SHOWN_ERRORS + 2):
        tally.add({**error, "name": f"e{k}", "error": {"message": "lost"}})
        tally.add({**poor, "name": f"p{k}"})

    assert tally.errors.count == tally.poor.count == pairs.SHOWN_ERRORS + 2
    assert tally.errors.first == [f"e{k}: lost" for k in range(pairs.SHOWN_ERRORS)]
    assert tally.poor.first == [f"p{k}: bad" for k in range(pairs.SHOWN_ERRORS)]
    assert tally.codes == {0: tally.poor.count, 2: tally.errors.count}


def test_a_damaged_file_goes_at_once_and_is_told_once(tmp_path: Path):
    """Also one beside a sound shard of the same number, which nothing else would replace."""
    shards = Shards(folder=tmp_path, identity="a" * 64, suffix=".jsonl")
    shards.replace(5, b"sound")
    (sound,) = tmp_path.iterdir()
    (tmp_path / f"00000005-{'0' * 32}.jsonl").write_bytes(b"not")

    (note,) = shards.drop_damaged()
    assert f"00000005-{'0' * 32}.jsonl: damaged, or not of this campaign" in note
    assert list(tmp_path.iterdir()) == [sound]
    assert shards.drop_damaged() == []


def test_workers_that_die_now_and_then_are_no_reason_to_give_up():
    """More often than BREAKDOWNS in all, but with results in between."""
    workers = InProcess(1)
    deaths = {0, 5, 10, 15, 20}
    assert len(deaths) > runner.BREAKDOWNS
    workers.executor = Fragile(deaths)
    found = [result.content.decode() for _, result in completed(numbered(30), workers, VERSIONS)]

    assert sorted(map(int, found)) == list(range(30))
    assert workers.renewals == len(deaths)


def test_a_shard_of_another_campaign_or_number_is_none_of_this_one(tmp_path: Path):
    shards = Shards(folder=tmp_path, identity="a" * 64, suffix=".jsonl")
    names = {
        replace(shards, identity=identity)._name(number, content)
        for identity in ("a" * 64, "b" * 64)
        for number in (5, 6)
        for content in (b"one", b"two")
    }
    assert len({name.partition("-")[2] for name in names}) == 8


def test_what_was_there_is_counted_in_items_and_not_in_shards(tmp_path: Path):
    begun: list[int] = []
    advanced: list[int] = []
    noted: list[str] = []
    observer = runner.Observer(begun=begun.append, advanced=advanced.append, noted=noted.append)
    kind = Cut(count=25, points=5, sigma=0.01, damping=2.0, seed=0)
    for _ in range(2):
        with occupied(tmp_path / "out", kind.manifest()), InProcess(1) as workers:
            runner.run(kind, tmp_path / "out", workers, observer)

    assert (begun, noted) == ([0, 25], [])
    assert sorted(advanced) == [5, 10, 10]


def test_every_pair_that_is_printed_moves_the_bar(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    bars: list[Progress] = []

    class Bar(Progress):
        def __init__(self, total: int, *, items: str) -> None:
            super().__init__(total, items=items)
            bars.append(self)

    monkeypatch.setattr(campaigns, "Progress", Bar)
    monkeypatch.setattr(campaigns, "workers_at", lambda _: InProcess(1))
    monkeypatch.setattr(pairs, "certify", partial(certify, relaxation=False, simulation=False))
    rows(folder, "source,target", "a.csv,b.csv", "b.csv,a.csv", "a.csv,lost.csv")
    campaign = PairCampaign(listing=read_listing(folder / "pairs.csv"), certificates=False)
    tally = campaigns._streamed(campaign, None)

    assert [(bar.made, bar._todo, bar._items) for bar in bars] == [(3, 3, "pairs")]
    assert (tally.errors.count, len(capsys.readouterr().out.splitlines())) == (1, 3)


def test_a_shard_that_is_done_again_takes_nothing_back_of_how_far_a_campaign_is():
    workers = InProcess(1)
    scheduler = runner._Scheduler(numbered(9), workers, VERSIONS)
    assert scheduler.fill()
    first, *_ = scheduler.under_way.values()
    furthest = scheduler._furthest
    assert furthest == len(scheduler.under_way) - 1 > first.shard
    scheduler.under_way.clear()
    scheduler.again.append(first)
    assert scheduler.fill()

    assert first in scheduler.under_way.values()
    assert scheduler._furthest >= furthest
    scheduler.under_way.clear()
    scheduler.again.append(first)
    scheduler._tasks = iter(())
    scheduler.fill()
    assert scheduler._furthest > first.shard
