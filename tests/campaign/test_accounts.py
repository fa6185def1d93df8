"""What a campaign counts, lists and says of its pairs and files is what is there."""

from __future__ import annotations

import json
import signal
from abc import ABC, abstractmethod
from concurrent.futures import BrokenExecutor, Executor, Future
from dataclasses import replace
from hashlib import sha256
from multiprocessing import get_context
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from campaign_work import VERSIONS, Cut, InProcess, numbered
from commands import certreg, strict_json, write_csv

from certreg.campaign import listing as lists
from certreg.campaign import pairs, store, table, workers
from certreg.campaign.listing import read_listing
from certreg.campaign.pairs import ERROR_SCHEMA, PairCampaign
from certreg.campaign.runner import Observer, completed, run
from certreg.campaign.store import Manifest, digest_of, occupied
from certreg.campaign.table import Column, write_table
from certreg.campaign.workers import Task, TaskResult
from certreg.errors import CampaignError, InvalidFileError
from certreg.registration.certification import certify
from certreg.results import Absent

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path


def listing(folder: Path, *rows: str, header: str = "source,target") -> Path:
    path = folder / "pairs.csv"
    path.write_text("\n".join((header, *rows)) + "\n", "utf-8")
    return path


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A pair of clouds, a.csv and b.csv."""
    rng = np.random.default_rng(0)
    source = rng.normal(size=(6, 3))
    write_csv(tmp_path / "a.csv", source.tolist())
    write_csv(tmp_path / "b.csv", (source[:, [1, 2, 0]] + 0.01 * rng.normal(size=(6, 3))).tolist())
    return tmp_path


def test_a_list_may_be_as_long_as_its_limit(folder: Path, monkeypatch: pytest.MonkeyPatch):
    path = listing(folder, "a.csv,b.csv")
    size = path.stat().st_size

    monkeypatch.setattr(lists, "MAX_LIST_BYTES", size)
    assert read_listing(path).count == 1
    monkeypatch.setattr(lists, "MAX_LIST_BYTES", size - 1)
    with pytest.raises(InvalidFileError, match=f"more than {size - 1} bytes") as caught:
        read_listing(path)
    assert caught.value.limit == size - 1


def test_a_header_that_is_wrong_is_told_with_its_place(folder: Path):
    path = listing(folder, "a.csv,b.csv", header="source,target,source")
    with pytest.raises(InvalidFileError) as caught:
        read_listing(path)

    assert (caught.value.path, caught.value.line, caught.value.column) == (path, 1, "source")
    path = listing(folder, "a.csv,b.csv,1", header="source,target,sigm")
    with pytest.raises(InvalidFileError, match="did you mean 'sigma'") as caught:
        read_listing(path)
    assert (caught.value.path, caught.value.column, caught.value.limit) == (path, "sigm", "sigma")


def test_every_row_of_a_list_is_in_one_task_and_what_is_done_is_left_out(
    folder: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(pairs, "SHARD_PAIRS", 3)
    monkeypatch.setattr(pairs, "LEAST_SHARDS", 1)
    path = listing(folder, *(f"a.csv,b.csv,p{k}" for k in range(8)), header="source,target,name")
    kind = PairCampaign(listing=read_listing(path), certificates=False)
    tasks = list(kind.tasks(()))

    assert [len(task.arguments["rows"]) for task in tasks] == [3, 3, 2]
    names = [row.name for task in tasks for row in task.arguments["rows"]]
    assert names == [f"p{k}" for k in range(8)]
    (last,) = kind.tasks({0, 1})
    assert [row.name for row in last.arguments["rows"]] == ["p6", "p7"]


def test_a_shard_is_final_if_no_line_is_an_error_and_all_have_inputs(folder: Path):
    kind = PairCampaign(listing=read_listing(listing(folder, "a.csv,b.csv")), certificates=False)
    cases = {
        ("certreg-result/1", True): True,
        ("certreg-result/1", False): False,
        (ERROR_SCHEMA, True): False,
        (ERROR_SCHEMA, False): False,
    }
    for (schema, inputs), final in cases.items():
        line = json.dumps({"schema": schema} | ({"inputs": {}} if inputs else {})).encode()
        assert kind.final(line + b"\n") == final


@pytest.fixture
def row(folder: Path) -> lists.PairRow:
    return next(read_listing(listing(folder, "a.csv,b.csv")).rows())


def test_a_line_says_what_it_was_computed_from_and_holds_no_number_that_json_lacks(
    folder: Path, row: lists.PairRow, monkeypatch: pytest.MonkeyPatch
):
    limits = PairCampaign(listing=read_listing(folder / "pairs.csv"), certificates=False).limits
    monkeypatch.setattr(
        pairs, "certify", lambda problem, **_: certify(problem, relaxation=False, simulation=False)
    )
    entry, certificate = pairs._entry(row, folder, limits)

    assert list(entry)[:4] == ["schema", "name", "place", "exit_code"]
    assert entry["notes"] == pairs._problem(row, folder)[1].notes == []
    assert entry["inputs"] == {
        name: sha256((folder / name).read_bytes()).hexdigest() for name in ("a.csv", "b.csv")
    }
    assert strict_json(certificate or b"")["problem"]["digest"] == entry["digest"]
    found = certify(pairs._problem(row, folder)[0], relaxation=False, simulation=False)
    missing = replace(found.solution, certificate=None, absent={"certificate": Absent("lost")})
    bare = replace(
        found, solution=missing, verdict=None, bounds=None, absent={"bounds": Absent("lost")}
    )
    monkeypatch.setattr(pairs, "certify", lambda *_, **__: bare)
    entry, certificate = pairs._entry(row, folder, limits)
    assert (entry["exit_code"], certificate) == (4, None)
    with pytest.raises(ValueError, match="JSON"):
        pairs._line({"rmse": float("nan")})


def test_a_command_of_a_list_needs_a_folder_for_parquet_and_for_nothing_else(
    folder: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr("certreg.cli.campaigns.workers_at", lambda _: InProcess(1))
    path = listing(folder, "a.csv,none.csv")
    refused = certreg("batch", path, "--parquet")

    assert refused.code == 2
    assert refused.err.startswith("Usage: ")
    assert refused.out == ""
    assert len(certreg("batch", path).out.splitlines()) == 1


def test_without_parquet_a_table_needs_no_further_library(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    def gone(*_: str) -> Any:
        raise ImportError

    monkeypatch.setattr(table, "library", gone)
    columns = (Column("a", int, "", "a count"),)
    write_table(tmp_path, columns, [[[1, 2]]], parquet=False)

    assert (tmp_path / "summary.csv").read_bytes().split() == [b"a", b"1", b"2"]


class Stumbling(Executor, ABC):
    """Carries out what it is given, but for the first call."""

    def __init__(self) -> None:
        self.calls = 0

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        self.calls += 1
        if self.calls == 1:
            return self.stumbled(lambda: fn(*args, **kwargs))
        future = Future[Any]()
        future.set_result(fn(*args, **kwargs))
        return future

    @abstractmethod
    def stumbled(self, work: Callable[[], Any]) -> Future[Any]:
        """What becomes of the first call."""


class Mistaking(Stumbling):
    """Takes its first result for an exception, as dask does where the worker has died since."""

    def stumbled(self, work: Callable[[], Any]) -> Future[Any]:
        future, result = Future[Any](), work()
        try:
            _, _, _ = result
        except TypeError as error:
            future.set_exception(error)
        return future


def test_a_result_that_is_taken_for_an_error_is_made_again():
    crew = InProcess(2)
    crew.executor = Mistaking()
    found = [result.content for _, result in completed(numbered(3), crew, VERSIONS)]

    assert sorted(found) == [b"0", b"1", b"2"]
    assert crew.executor.calls == 4


class Refusing(Stumbling):
    """Refuses its first call, as a pool that has broken down does."""

    def stumbled(self, work: Callable[[], Any]) -> Future[Any]:
        del work
        raise BrokenExecutor


def test_a_pool_that_refuses_a_task_is_renewed_and_the_task_is_done():
    crew = InProcess(2)
    crew.executor = Refusing()
    found = [result.content for _, result in completed(numbered(3), crew, VERSIONS)]

    assert sorted(found) == [b"0", b"1", b"2"]
    assert crew.renewals == 1


def test_what_ended_together_is_told_in_the_order_of_the_shards():
    """All end at once: the set of those that have ended has no order of its own."""
    with InProcess(1) as crew:
        crew.count = 20
        crew.executor = Refusing()
        crew.executor.calls = 1
        told = [task.shard for task, _ in completed(numbered(40), crew, VERSIONS)]

    assert told == sorted(told)


class Timed(Cut):
    """Shards that do nothing, two seconds each by their own clocks."""

    def tasks(self, done: Any) -> Any:
        for task in super().tasks(done):
            yield Task(shard=task.shard, function=timed, arguments={})


def timed() -> TaskResult:
    return TaskResult(content=b"", timings={"solving": 2.0, "writing": 0.5})


def test_seconds_of_workers_are_added_up(tmp_path: Path):
    kind, silent = (
        Timed(count=45, points=5),
        Observer(begun=lambda _: None, advanced=lambda _: None, noted=lambda _: None),
    )
    with InProcess() as crew, occupied(tmp_path / "a" / "b", kind.manifest()):
        timings = run(kind, tmp_path / "a" / "b", crew, silent)

    assert timings == {"solving": 10.0, "writing": 2.5}


def test_a_manifest_is_text_that_can_be_read_and_compared():
    manifest = Manifest(kind="x", count=5, shard_size=2, settings={"b": 1, "a": 2}, versions={})

    assert manifest.to_json().startswith(b'{\n "count": 5,\n "')
    assert [list(manifest.items(k)) for k in range(manifest.shards)] == [[0, 1], [2, 3], [4]]


def test_a_digest_is_that_of_a_file_and_of_nothing_else(tmp_path: Path):
    (tmp_path / "a").write_bytes(b"abc")

    assert digest_of(tmp_path / "a") == sha256(b"abc").hexdigest()
    assert digest_of(tmp_path) is digest_of(tmp_path / "none") is None


def test_a_worker_leaves_ctrl_c_to_its_campaign_and_ends_with_it(monkeypatch: pytest.MonkeyPatch):
    """In this process: the thread that would end it only says so."""
    ended, set_ = list[int](), list[Any]()
    reader, writer = get_context("spawn").Pipe(duplex=False)

    class Started:
        def __init__(self, *, target: Any, daemon: bool) -> None:
            self.target = target
            assert daemon

        def start(self) -> None:
            writer.close()
            self.target()

    monkeypatch.setattr(workers.os, "_exit", ended.append)
    monkeypatch.setattr(workers.signal, "signal", lambda *given: set_.append(given))
    monkeypatch.setattr(workers.threading, "Thread", Started)
    workers._end_with(reader)

    assert ended == [1]
    assert set_ == [(signal.SIGINT, signal.SIG_IGN)]


class Client:
    """A scheduler with so many threads; None: it is gone."""

    def __init__(self, threads: int | None) -> None:
        self.threads, self.closed = threads, 0

    def nthreads(self) -> dict[str, int]:
        if self.threads is None:
            raise OSError
        return {"a": self.threads, "b": 1} if self.threads else {}

    def get_executor(self, *, pure: bool) -> Any:
        assert not pure
        return self

    def shutdown(self, *, wait: bool) -> None:
        assert not wait
        self.closed += 1

    def close(self) -> None:
        self.closed += 1


def test_workers_of_a_cluster_are_counted_and_a_scheduler_that_is_gone_is_told(
    monkeypatch: pytest.MonkeyPatch,
):
    client, clock = Client(3), [100.0]
    monkeypatch.setattr(workers, "_connected", lambda *_: client)
    monkeypatch.setattr(workers, "_killed_worker", lambda: KeyError)
    monkeypatch.setattr(workers.time, "monotonic", lambda: clock[0])
    with workers.workers_at("tcp://here") as crew:
        assert isinstance(crew, workers.ClusterWorkers)
        assert crew.count == 4
        client.threads = 7
        crew.renew()
        assert crew.count == 8
        client.threads, clock[0] = 0, 100.0 + workers.PATIENCE
        crew.require_alive()
        clock[0] += 0.5
        with pytest.raises(CampaignError, match="has no workers"):
            crew.require_alive()
        client.threads = None
        with pytest.raises(CampaignError, match="is gone: start it") as caught:
            crew.require_alive()
        assert caught.value.address == "tcp://here"
    assert client.closed == 2


class Pool:
    """A pool of processes that are never started."""

    def __init__(self, count: int, *, mp_context: Any, initializer: Any, initargs: Any) -> None:
        self.count, self.initializer, self.initargs = count, initializer, initargs
        self.shut = False
        assert mp_context.get_start_method() == "spawn"

    def shutdown(self, *, wait: bool, cancel_futures: bool) -> None:
        self.shut = wait and cancel_futures


def test_local_workers_are_bound_to_their_campaign_and_renewed_as_a_whole(
    monkeypatch: pytest.MonkeyPatch,
):
    monkeypatch.setattr(workers, "ProcessPoolExecutor", Pool)
    monkeypatch.setattr(workers, "_processors", lambda: 5)
    with workers.workers_at(None) as crew:
        assert isinstance(crew, workers.LocalWorkers)
        first: Any = crew.executor
        assert (first.count, first.initializer) == (5, workers._end_with)
        (reader,) = first.initargs
        crew.require_alive()
        assert not reader.closed
        crew.renew()
        second: Any = crew.executor
        assert (first.shut, reader.closed, second.shut) == (True, True, False)
        assert second is not first
    assert second.shut
    assert second.initargs[0].closed
    with workers.LocalWorkers(2) as two:
        assert two.count == 2
        place = two.place
        assert place is not None
        assert place.is_dir()
    assert not place.exists()


def test_there_is_a_processor_where_nobody_knows(monkeypatch: pytest.MonkeyPatch):
    assert workers._processors() >= 1
    monkeypatch.delattr(workers.os, "sched_getaffinity", raising=False)
    monkeypatch.setattr(workers.os, "cpu_count", lambda: None)
    assert workers._processors() == 1


def test_what_the_system_refuses_is_told_with_the_folder(tmp_path: Path):
    for error in (OSError(13, "no"), OSError(13, "no", str(tmp_path / "other"))):
        with pytest.raises(InvalidFileError) as caught, store._complaints(tmp_path):
            raise error
        named = tmp_path if error.filename is None else tmp_path / "other"
        assert caught.value.path == named
        assert str(caught.value).startswith(f"{named}: cannot be used")
