"""Campaigns survive what kills them, and their results depend on their manifests alone."""

from __future__ import annotations

import csv
import dataclasses
import json
import math
import os
import select
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest import mock

import numpy as np
import pytest
from campaign_work import (
    VERSIONS,
    Cut,
    Fragile,
    InProcess,
    die_once,
    echo,
    fail_far_down,
    finish,
    large,
    longest_message,
    numbered,
    record_messages,
    tree,
)
from commands import certreg as run_command
from hypothesis import given
from hypothesis import strategies as st

import certreg
from certreg.campaign import runner, store
from certreg.campaign.pairs import PAIR_COLUMNS
from certreg.campaign.runner import completed, in_order, perform
from certreg.campaign.store import (
    CERTIFICATES,
    MANIFEST,
    SHARDS,
    Manifest,
    Shards,
    arithmetic,
    current_versions,
    occupied,
)
from certreg.campaign.table import Column, write_table
from certreg.campaign.workers import LocalWorkers, Task, TaskResult, workers_at
from certreg.cli import campaigns, reproducing
from certreg.cli.reproducing import LARGEST_RUNS
from certreg.equilibrium.batch import solve_many
from certreg.errors import (
    CampaignError,
    CertregError,
    ContradictionError,
    InvalidFileError,
    InvalidProblemError,
    MissingToolError,
    RefusedCertificateError,
)
from certreg.native import kernels
from certreg.paper.equilibrium_maps import SPRING_COLUMNS
from certreg.paper.monte_carlo import (
    EXTREMES,
    INSTANCE_COLUMNS,
    MonteCarlo,
    Totals,
    pieces,
    unpacked,
    write_instance_results,
)
from certreg.results import Ruling, Verdict

SMALL = Cut(count=45, points=5)  # five shards
FLAT = MonteCarlo(count=3, points=2)  # two points: every instance is an exception
FEW = MonteCarlo(count=250, points=4, seed=7)


def contents(count, workers, limit=None):
    found = completed(numbered(count), workers, VERSIONS)
    return [result.content.decode() for _, result in found]


def test_the_work_is_done_once_each():
    with InProcess(3) as workers:
        assert sorted(map(int, contents(50, workers))) == list(range(50))


def test_results_can_be_had_in_order():
    with InProcess(4) as workers:
        found = in_order(completed(numbered(200), workers, VERSIONS))
        assert [result.content.decode() for result in found] == [str(k) for k in range(200)]


def test_few_calls_are_drawn_ahead_of_what_is_asked_for():
    drawn = 0

    def tasks():
        nonlocal drawn
        for task in numbered(10_000):
            drawn += 1
            yield task

    with InProcess(2) as workers:
        found = completed(tasks(), workers, VERSIONS)
        for _ in range(5):
            next(found)
        found.close()

    assert drawn <= 5 + 2 * runner.UNDER_WAY


@pytest.mark.slow
def test_nothing_runs_far_ahead_of_a_slow_shard():
    """While shard 0 does not end, others do, but only so many must be held for their turn."""
    import threading

    release, seen = threading.Event(), list[int]()

    def slow(*, words):
        release.wait()
        return echo(words=words)

    def tasks():
        yield Task(shard=0, function=slow, arguments={"words": "0"})
        yield from (dataclasses.replace(task, shard=task.shard + 1) for task in numbered(5000))

    with InProcess(2) as workers, mock.patch.multiple(runner, SPREAD=10, TICK=0.05):
        workers.require_alive = release.set  # the tick: nothing else is left to do
        seen = [task.shard for task, _ in completed(tasks(), workers, VERSIONS)]

    assert len(seen) == 5001
    assert max(seen[: seen.index(0)]) <= 2 * 10


@pytest.mark.slow
@given(st.sets(st.integers(0, 40), max_size=3))
def test_what_dead_workers_held_is_done_by_others(deaths):
    workers = InProcess(2)
    workers.executor = Fragile(deaths)

    assert sorted(map(int, contents(30, workers))) == list(range(30))
    assert (workers.renewals > 0) == bool(deaths & set(range(30)))  # later ones are not reached


def test_a_campaign_gives_up_where_workers_do_nothing_but_die():
    workers = InProcess(1)
    workers.executor = Fragile(set(range(1000)))

    with pytest.raises(
        CampaignError, match=r"workers died 4 times in a row.*shards 0, 1, 2"
    ) as told:
        contents(5, workers)
    assert "run the same command" in str(told.value)
    assert workers.renewals == runner.BREAKDOWNS


@pytest.mark.slow
@pytest.mark.parametrize(
    ("processes", "deadly"), [(1, {1}), pytest.param(2, {1, 6}, marks=pytest.mark.long)]
)
def test_a_killed_process_of_the_pool_is_replaced(processes, deadly, tmp_path):
    tasks = (
        Task(
            shard=k,
            function=die_once if k in deadly else echo,
            arguments={"words": str(k)} | ({"folder": str(tmp_path)} if k in deadly else {}),
        )
        for k in range(9)
    )
    with LocalWorkers(processes) as workers:
        found = [result.content.decode() for _, result in completed(tasks, workers, VERSIONS)]

    assert sorted(map(int, found)) == list(range(9))
    assert len(list(tmp_path.iterdir())) == len(deadly)


@pytest.mark.slow
def test_what_goes_through_the_pipe_is_sent_whole_or_not_at_all():
    task = Task(shard=3, function=large, arguments={"size": 1 << 20})
    with LocalWorkers(1) as workers:
        assert workers.place is not None
        workers.executor.submit(record_messages).result()
        assert [result for _, result in completed(iter([task]), workers, VERSIONS)] == [
            large(size=1 << 20)
        ]
        assert not list(workers.place.iterdir())
        failing = Task(shard=4, function=fail_far_down, arguments={"depth": 200})
        with pytest.raises(CampaignError, match=r"shard 4 .ValueError: far down"):
            list(completed(iter([failing]), workers, VERSIONS))
        assert 0 < workers.executor.submit(longest_message).result() <= select.PIPE_BUF


def test_a_result_is_handed_over_as_it_is(tmp_path):
    results = [
        large(size=1000),
        TaskResult(content=b""),
        TaskResult(content=b"\n{}", files={"a": b""}),
    ]
    for result in results:
        assert TaskResult.taken_from(result.left_at(tmp_path / "0")) == result
        assert not list(tmp_path.iterdir())
    with pytest.raises(CampaignError, match=r"a result cannot be handed over .*set TMPDIR"):
        results[0].left_at(tmp_path / "gone" / "0")


def test_a_worker_with_other_versions_is_refused():
    task = next(numbered(1))

    assert perform(task, VERSIONS).content == b"0"
    with pytest.raises(CampaignError, match=r"a worker has certreg .*, the campaign certreg 9\.9"):
        perform(task, VERSIONS | {"certreg": "9.9"})


@pytest.mark.parametrize("name", ["kernels", "numpy_bits", "linear_algebra_bits", "libm_bits"])
def test_a_worker_that_computes_otherwise_is_refused_by_name(name):
    task, here = next(numbered(1)), current_versions()[name]

    words = f"^a worker has {name} {here}, the campaign {name} other: install the same everywhere, "
    with pytest.raises(CampaignError, match=words):
        perform(task, VERSIONS | {name: "other"})


def test_a_folder_begun_by_compiled_code_is_not_resumed_in_python(tmp_path, monkeypatch):
    with occupied(tmp_path / "begun", FEW.manifest()):
        pass
    before = current_versions()
    assert before["kernels"] == "compiled"
    monkeypatch.setattr(store, "arithmetic", lambda: {**before, "kernels": "python"})

    words = "its versions.kernels is compiled, here it is python: choose another folder"
    with pytest.raises(InvalidFileError, match=words), occupied(tmp_path / "begun", FEW.manifest()):
        pass


@pytest.mark.parametrize(
    ("module", "function", "name"),
    [
        (np, "exp", "numpy_bits"),
        (np.linalg, "inv", "linear_algebra_bits"),
        (math, "sin", "libm_bits"),
    ],
)
def test_the_last_bit_of_one_result_is_seen(module, function, name, monkeypatch):
    """As of a processor for which other code is chosen."""
    usual, before = getattr(module, function), arithmetic()

    def rounded_otherwise(given):
        found = np.array(usual(given))
        found.flat[-1] = np.nextafter(found.flat[-1], np.inf)
        return found

    monkeypatch.setattr(module, function, rounded_otherwise)
    found = arithmetic.__wrapped__()
    assert {key for key in before if found[key] != before[key]} == {name}


RESUMING = """
import sys, pathlib
from campaign_work import Cut, finish
finish(Cut(count=45, points=5), pathlib.Path(sys.argv[1]))
finish(Cut(count=15, points=2), pathlib.Path(sys.argv[2]))
"""


@pytest.mark.long
def test_a_folder_begun_by_one_variant_is_resumed_by_another_to_the_byte(tmp_path):
    variants = kernels.runnable(kernels.record_of(kernels.BUILT), kernels.BUILT)
    folders = [tmp_path / "instances", tmp_path / "flat"]
    root = Path(__file__).parents[2]

    def finish_by(variant: str) -> dict[str, bytes]:
        subprocess.run(
            [sys.executable, "-c", RESUMING, *map(str, folders)],
            env={
                **os.environ,
                "CERTREG_VARIANT": variant,
                "PYTHONPATH": os.pathsep.join((str(root / "tests"), str(root))),
            },
            check=True,
        )
        return tree(tmp_path)

    whole = finish_by(variants[-1])
    for folder in folders:
        for path in sorted((folder / SHARDS).iterdir())[::2]:
            path.unlink()
    assert tree(tmp_path) != whole
    assert finish_by(variants[0]) == whole


def test_a_failure_of_a_worker_is_one_clear_error():
    task = Task(shard=3, function=echo, arguments={"no": "such keyword"})
    with InProcess() as workers, pytest.raises(CampaignError, match=r"shard 3 \(TypeError: .*same"):
        list(completed(iter([task]), workers, VERSIONS))


def test_a_contradiction_travels_between_processes():
    verdict = Verdict(ruling=Ruling.REFUTED, words="wrong")

    def refused(*, words):
        raise RefusedCertificateError(words, verdict=verdict)

    with pytest.raises(ContradictionError, match="refused it"):
        perform(Task(shard=0, function=refused, arguments={"words": "refused it"}), VERSIONS)


def test_a_manifest_is_the_same_bytes_for_the_same_campaign():
    assert FEW.manifest().to_json() == MonteCarlo(count=250, points=4, seed=7).manifest().to_json()
    for change in ({"seed": 8}, {"sigma": 0.02}, {"points": 5}, {"count": 251}, {"damping": 1.0}):
        assert dataclasses.replace(FEW, **change).manifest().identity() != FEW.manifest().identity()


@given(st.integers(1, 500), st.integers(1, 60))
def test_shards_cover_the_items_without_overlap(count, size):
    manifest = Manifest(kind="any", count=count, shard_size=size, settings={}, versions=VERSIONS)

    assert [k for s in range(manifest.shards) for k in manifest.items(s)] == list(range(count))


@pytest.mark.parametrize("wrong", [{"count": 0}, {"points": 0}, {"seed": -1}])
def test_what_is_no_campaign_is_refused(wrong):
    with pytest.raises(InvalidProblemError, match="at least one instance"):
        dataclasses.replace(FEW, **wrong).manifest()


def test_another_campaign_in_the_folder_is_refused(tmp_path):
    finish(FEW, tmp_path / "out")
    before = tree(tmp_path)

    with pytest.raises(InvalidFileError, match=r"campaign.json.*settings.seed is 7, here it is 8"):
        finish(dataclasses.replace(FEW, seed=8), tmp_path / "out")
    assert tree(tmp_path) == before


@pytest.mark.parametrize(
    ("old", "new", "who"),
    [(b'"seed"', b'"older": 1,\n  "seed"', "it"), (b'"seed": 7', b'"sown": 7', "this version")],
)
def test_a_campaign_of_another_version_is_not_told_to_give_what_cannot_be_given(
    tmp_path, old, new, who
):
    finish(FEW, tmp_path / "out")
    kept = tmp_path / "out" / MANIFEST
    kept.write_bytes(kept.read_bytes().replace(old, new))

    with pytest.raises(InvalidFileError, match=rf"only {who} knows settings\.\w+: .*that began it"):
        finish(FEW, tmp_path / "out")


@pytest.mark.parametrize("text", [b"[]", b"{", b"\xff", b"null", b"[" * 50_000])
def test_a_manifest_that_is_none_is_refused(tmp_path, text):
    (tmp_path / MANIFEST).write_bytes(text)

    with pytest.raises(InvalidFileError, match="choose another folder"):
        finish(FEW, tmp_path)


def test_a_folder_with_other_files_is_refused(tmp_path):
    (tmp_path / "thesis.tex").write_text("mine", "utf-8")

    with pytest.raises(InvalidFileError, match="holds other files: choose a new folder"):
        finish(FEW, tmp_path)
    assert tree(tmp_path) == {"thesis.tex": b"mine"}


def test_a_folder_that_is_a_file_is_refused(tmp_path):
    (tmp_path / "out").write_text("mine", "utf-8")

    with pytest.raises(InvalidFileError, match=r"out.*choose another folder"):
        finish(FEW, tmp_path / "out")


def test_half_written_files_of_a_killed_run_are_swept_away(tmp_path):
    (tmp_path / "out" / SHARDS).mkdir(parents=True)
    finish(FEW, tmp_path / "whole")
    (tmp_path / "out" / ".certreg-x1").write_text("half", "utf-8")
    (tmp_path / "out" / MANIFEST).write_bytes(FEW.manifest().to_json())
    (tmp_path / "out" / SHARDS / ".certreg-x2").write_text("half", "utf-8")

    finish(FEW, tmp_path / "out")
    assert tree(tmp_path / "out") == tree(tmp_path / "whole")


def test_two_processes_do_not_share_a_folder(tmp_path):
    with (
        occupied(tmp_path / "out", FEW.manifest()),
        pytest.raises(CampaignError, match="another process is at work there"),
        occupied(tmp_path / "out", FEW.manifest()),
    ):
        pass


@pytest.mark.parametrize("system", ["posix", "nt"])
def test_a_folder_is_locked_by_the_system_and_free_when_its_process_ends(
    tmp_path, monkeypatch, system
):
    """As the version before locked it, by flock of the folder; on Windows by a file that stays."""
    fcntl: Any = pytest.importorskip("fcntl")
    monkeypatch.setattr(store, "os", OtherSystem(system))
    finish(FEW, tmp_path / "whole")
    with store._locked(tmp_path / "whole"):
        handle = os.open(tmp_path / "whole" / (store.LOCK if system == "nt" else "."), os.O_RDONLY)
        with pytest.raises(BlockingIOError):
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    with pytest.raises(CampaignError, match="another process"), store._locked(tmp_path / "whole"):
        pass
    os.close(handle)
    finish(FEW, tmp_path / "whole")


class OtherSystem:
    """The module os under another system's name."""

    def __init__(self, name: str) -> None:
        self.name = name

    def __getattr__(self, name: str) -> object:
        return getattr(os, name)


@pytest.mark.slow
@given(st.data())
def test_damage_to_a_shard_is_seen(tmp_path_factory, data):
    folder = tmp_path_factory.mktemp("shards")
    shards = Shards(folder=folder, identity="a" * 64, suffix=".bin")
    content = data.draw(st.binary(min_size=1, max_size=40))
    shards.replace(5, content)
    (path,) = folder.iterdir()
    assert dict(shards.sound()) == {5: content}

    how = data.draw(st.sampled_from(["flip", "cut", "longer", "renamed", "other campaign"]))
    if how == "flip":
        place = data.draw(st.integers(0, len(content) - 1))
        bent = bytearray(content)
        bent[place] ^= 1 << data.draw(st.integers(0, 7))
        path.write_bytes(bent)
    elif how == "cut":
        path.write_bytes(content[:-1])
    elif how == "longer":
        path.write_bytes(content + b"\0")
    elif how == "renamed":
        path.rename(folder / path.name.replace("00000005", "00000006"))
    other = dataclasses.replace(shards, identity="b" * 64) if how == "other campaign" else shards

    assert dict(other.sound()) == {}
    assert len(other.drop_damaged()) == 1
    assert list(folder.iterdir()) == []


def test_a_damaged_shard_is_computed_anew_with_a_note(tmp_path):
    finish(SMALL, tmp_path / "whole")
    finish(SMALL, tmp_path / "out")
    shards = sorted((tmp_path / "out" / SHARDS).iterdir())
    shards[1].write_bytes(shards[1].read_bytes()[:-7])
    shards[3].unlink()

    notes = finish(SMALL, tmp_path / "out")
    assert len(notes) == 1
    assert shards[1].name in notes[0]
    assert tree(tmp_path / "out") == tree(tmp_path / "whole")


def test_results_do_not_depend_on_who_computes_them(tmp_path):
    for count in (1, 4):
        finish(SMALL, tmp_path / str(count), InProcess(count))

    assert tree(tmp_path / "1") == tree(tmp_path / "4")


def test_only_what_is_missing_is_computed(tmp_path):
    finish(SMALL, tmp_path)
    (gone, *_) = (tmp_path / SHARDS).iterdir()
    gone.unlink()
    with mock.patch.object(ThreadPoolExecutor, "submit", autospec=True) as submit:
        submit.side_effect = RuntimeError
        with pytest.raises(RuntimeError):
            finish(SMALL, tmp_path)
        assert submit.call_count == 1
        assert f"{submit.call_args.args[2].shard:08d}" == gone.name[:8]


def test_a_shard_has_the_seed_of_a_spawned_child():
    manifest = MonteCarlo(count=9000, points=4, seed=11).manifest()
    child = np.random.SeedSequence(11).spawn(manifest.shards)[2]
    first, made = next(pieces(manifest, 2))

    assert first == 2 * manifest.shard_size > 0
    rng = np.random.default_rng(child)
    expected = rng.standard_normal(made.sources.shape)  # the first draw of the generator
    shift = expected - made.sources
    assert np.abs(shift - shift[:, :1]).max() < 1e-14


def test_a_shard_holds_what_the_solver_says_of_its_instances(tmp_path):
    finish(FEW, tmp_path)
    totals = write_instance_results(FEW, tmp_path)
    (path,) = (tmp_path / SHARDS).iterdir()
    arrays = unpacked(path.read_bytes())
    _, made = next(pieces(FEW.manifest(), 0))
    found = solve_many(made.sources, made.targets, damping=FEW.damping, threads=1)

    assert len(arrays["instance"]) == 250
    assert (arrays["rmse"] == found.rmse[:250]).all()
    best = [
        certreg.certify(certreg.RegistrationProblem(x, y), relaxation=False, simulation=False)
        for x, y in zip(made.sources[:3], made.targets[:3], strict=True)
    ]
    for k, registration in enumerate(best):
        error = made.rotations[k].T @ registration.pose.rotation
        angle = np.arccos(np.clip((np.trace(error) - 1) / 2, -1, 1))
        assert arrays["rotation_error_rad"][k] == pytest.approx(angle, abs=1e-7)
        assert arrays["rmse"][k] == pytest.approx(
            [c.rmse for c in registration.equilibria.components]
        )
    assert totals.count == totals.regular == 250
    assert totals.largest["half_turn_error_rad"] < 1e-12


def test_what_doubles_do_not_decide_is_listed_with_its_certificate(tmp_path):
    finish(FLAT, tmp_path)
    totals = write_instance_results(FLAT, tmp_path)
    with (tmp_path / "exceptions.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))

    assert (totals.regular, totals.exceptions, len(rows)) == (0, 3, 3)
    for k, row in enumerate(rows):
        assert (row["instance"], row["pattern"], row["unstable"]) == (str(k), "2 2", "")
        assert certreg.verify(tmp_path / row["certificate"]).proved
        document = json.loads((tmp_path / row["certificate"]).read_text("utf-8"))
        assert document["about"]["instance"] == k
    _, made = next(pieces(FLAT.manifest(), 0))
    problem = certreg.RegistrationProblem(made.sources[1], made.targets[1])
    assert document["problem"]["digest"] != problem.digest()
    second = json.loads((tmp_path / rows[1]["certificate"]).read_text("utf-8"))
    assert second["problem"]["digest"] == problem.digest()


def test_a_lost_certificate_is_written_anew(tmp_path):
    finish(FLAT, tmp_path)
    before = tree(tmp_path)
    gone, *_ = sorted((tmp_path / CERTIFICATES).iterdir())
    gone.unlink()

    finish(FLAT, tmp_path)
    assert tree(tmp_path) == before


@pytest.mark.one_in(3)
@pytest.mark.parametrize("which", [0, 1, 2])
@pytest.mark.parametrize("damaged", [lambda whole: whole[:-9], lambda whole: whole + b"\n"])
def test_a_certificate_that_was_damaged_is_written_anew(tmp_path, which: int, damaged):
    """Each for itself, and all others there: nothing else says that the shard is not done."""
    finish(FLAT, tmp_path)
    before = tree(tmp_path)
    bent = sorted((tmp_path / CERTIFICATES).iterdir())[which]
    bent.write_bytes(damaged(bent.read_bytes()))

    finish(FLAT, tmp_path)
    assert tree(tmp_path) == before


@pytest.mark.slow
def test_the_table_is_the_same_in_both_formats(tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    finish(FEW, tmp_path)
    write_instance_results(FEW, tmp_path, parquet=True)
    with (tmp_path / "summary.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    table = parquet.read_table(tmp_path / "summary.parquet")
    with (tmp_path / "columns.csv").open(encoding="utf-8") as stream:
        described = list(csv.DictReader(stream))

    assert len(rows) == table.num_rows == FEW.count
    assert list(rows[0]) == table.column_names == [column["column"] for column in described]
    for name in table.column_names:
        assert [float(row[name]) for row in rows] == table[name].to_pylist()
    for column, told in zip(INSTANCE_COLUMNS, described, strict=True):
        field = table.schema.field(column.name).metadata
        assert field == {b"unit": column.unit.encode(), b"meaning": column.meaning.encode()}
        assert (told["unit"], told["meaning"]) == (column.unit, column.meaning)


@pytest.mark.parametrize(
    "columns",
    [PAIR_COLUMNS, INSTANCE_COLUMNS, SPRING_COLUMNS],
    ids=["pairs", "instances", "springs"],
)
def test_the_page_on_campaign_files_describes_every_column(columns):
    page = Path(certreg.__file__).parents[1] / "docs" / "reference" / "campaign-files.md"
    rows = page.read_text("utf-8").splitlines()

    assert [c for c in columns if f"| `{c.name}` | {c.unit} | {c.meaning} |" not in rows] == []


def test_a_missing_extra_is_one_clear_error(tmp_path):
    with mock.patch.dict(sys.modules, {"pyarrow": None, "pyarrow.parquet": None}):
        with pytest.raises(MissingToolError, match=r"pip install 'certreg\[parquet\]'"):
            write_table(tmp_path, [Column("a", int, "", "")], [[[1]]], parquet=True)
        assert list(tmp_path.iterdir()) == []
    with (
        mock.patch.dict(sys.modules, {"distributed": None}),
        pytest.raises(MissingToolError, match=r"pip install 'certreg\[campaign\]'"),
    ):
        workers_at("tcp://127.0.0.1:1")


def test_a_full_disk_leaves_nothing_half_written(tmp_path):
    finish(SMALL, tmp_path / "whole")
    written = 0

    def full(descriptor, mode):
        nonlocal written
        written += 1
        if written == 4:
            raise OSError(28, "No space left on device")
        return real(descriptor, mode)

    import os

    real = os.fdopen
    with (
        mock.patch("certreg.io.atomic.os.fdopen", full),
        pytest.raises(InvalidFileError, match="No space left on device"),
    ):
        finish(SMALL, tmp_path / "out")
    assert len(list((tmp_path / "out" / SHARDS).iterdir())) == 2
    finish(SMALL, tmp_path / "out")
    assert tree(tmp_path / "out") == tree(tmp_path / "whole")


def without_figures(monkeypatch) -> list[int | None]:
    """The runs that the figures are asked to draw in their own process; they are made elsewhere."""
    asked: list[int | None] = []

    def figures(setup, *_, **__):
        asked.append(setup.runs)
        raise CertregError("the figures are tested elsewhere")

    monkeypatch.setattr(reproducing, "reproduced", figures)
    return asked


@pytest.mark.slow
def test_many_runs_of_reproduce_are_a_campaign_that_goes_on(tmp_path, monkeypatch):
    in_process = without_figures(monkeypatch)
    monkeypatch.setattr(campaigns, "workers_at", lambda _: InProcess(2))
    given = ("reproduce", "--runs", 1500, "--points", 5, "--noise", 0.1, "--seed", 4)
    run = run_command(*given, "--out", tmp_path)
    again = run_command(*given, "--out", tmp_path)

    assert in_process == [None, None]
    assert run.out.startswith("1,500 of 1,500 random instances have four equilibria, with 0, 1, 2")
    assert "a second; without making them" in run.out
    assert again.err.startswith("note: 1,500 of 1,500 instances were there already")
    settings = json.loads((tmp_path / "campaign" / "campaign.json").read_text("utf-8"))["settings"]
    assert {settings[name] for name in ("points", "sigma", "seed", "damping")} == {5, 0.1, 4, 2.0}
    table = (tmp_path / "campaign" / "summary.csv").read_text("utf-8")
    assert table.count("\n") == 1501


@pytest.mark.parametrize(("runs", "apart"), [(LARGEST_RUNS, False), (LARGEST_RUNS + 1, True)])
def test_a_campaign_begins_beyond_the_largest_number_of_runs(tmp_path, monkeypatch, runs, apart):
    drawn, in_process = [], without_figures(monkeypatch)
    monkeypatch.setattr(reproducing, "_run_campaign", lambda kind, *_, **__: drawn.append(kind))
    run_command("reproduce", "--runs", runs, "--out", tmp_path)

    assert [kind.count for kind in drawn] == ([runs] if apart else [])
    assert in_process == [None if apart else runs]


@pytest.mark.parametrize(
    ("given", "runs", "apart"),
    [
        ([], None, None),
        (["--runs", 3], 3, None),
        (["--parquet"], None, 50),
        (["--scheduler", "tcp://here:1", "--runs", 3], None, 3),
    ],
    ids=str,
)
def test_few_runs_are_a_campaign_only_with_a_scheduler_or_a_parquet_table(
    tmp_path, monkeypatch, given, runs, apart
):
    drawn, in_process = [], without_figures(monkeypatch)
    monkeypatch.setattr(reproducing, "_run_campaign", lambda kind, *_, **__: drawn.append(kind))
    run_command("reproduce", *given, "--out", tmp_path)

    assert [kind.count for kind in drawn] == ([] if apart is None else [apart])
    assert in_process == [runs]


def test_the_rates_of_a_campaign_are_instances_over_seconds(tmp_path, monkeypatch, capsys):
    """1200 in 4 s are 300 a second; solved within 3 s of either of two workers, 800."""
    watch = SimpleNamespace(made=1200, seconds=4.0, observer=lambda: None)
    none: dict[str, float] = dict.fromkeys(EXTREMES, 0.0)
    totals = Totals(count=1200, regular=1199, exceptions=1, largest=none, smallest=none)
    monkeypatch.setattr(campaigns, "workers_at", lambda _: nullcontext(InProcess(2)))
    monkeypatch.setattr(campaigns, "Progress", lambda *_, **__: nullcontext(watch))
    monkeypatch.setattr(reproducing, "run", lambda *_: {"solving": 3.0, "all": 5.0})
    monkeypatch.setattr(reproducing, "write_instance_results", lambda *_, **__: totals)
    reproducing._run_campaign(FEW, tmp_path, None, parquet=False)
    first, second, third, _ = capsys.readouterr().out.splitlines()

    assert first.startswith("1,199 of 1,200 random instances have four equilibria")
    assert second.startswith("1 were decided in exact arithmetic")
    assert third == "1,200 in 4.0 s: 300 a second; without making them 800, with 2 at work"


def test_a_shard_that_is_there_twice_is_made_one(tmp_path):
    """As a kill leaves it between a new shard and the end of its former one."""
    finish(SMALL, tmp_path / "whole")
    finish(SMALL, tmp_path / "out")
    shards = Shards(
        folder=tmp_path / "out" / SHARDS, identity=SMALL.manifest().identity(), suffix=".npz"
    )
    (second,) = shards.files()[1]
    shards.replace(1, longer := second.read_bytes() + b"\0")
    assert {len(paths) for paths in shards.files().values()} == {1, 2}
    assert longer in [content for _, content in shards.sound()]

    finish(SMALL, tmp_path / "out")
    assert tree(tmp_path / "out") == tree(tmp_path / "whole")


def test_a_file_that_is_no_shard_is_left_alone(tmp_path):
    finish(SMALL, tmp_path)
    for name in (".nfs0001", "notes.txt", "00000001-mine.npz"):
        (tmp_path / SHARDS / name).write_text("mine", "utf-8")
    before = tree(tmp_path)

    assert finish(SMALL, tmp_path) == []
    assert tree(tmp_path) == before
