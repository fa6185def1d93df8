"""A cluster may be without workers at any moment: a campaign waits, says so, and goes on."""

from __future__ import annotations

import logging
import time
from concurrent.futures import Executor, Future
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from campaign_work import VERSIONS, Cut, finish, numbered, tree
from commands import certreg, write_csv
from hypothesis import example, given
from hypothesis import strategies as st

from certreg.campaign import runner, workers
from certreg.campaign.runner import completed
from certreg.errors import CampaignError

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Sequence
    from contextlib import AbstractContextManager
    from pathlib import Path

FOR_EVER = 10**9
ADDRESS = "tcp://here"


class Cluster(Executor):
    """A scheduler, a client of it and its executor: tasks wait there while there are no workers.

    Each time it is asked for its workers the next of `shifts` begins: one worker that ends so many
    tasks and leaves. The last one stays.
    """

    def __init__(self, shifts: Sequence[int]) -> None:
        self.shifts, self.left = [*shifts, FOR_EVER], 0
        self.waiting: list[Callable[[], None]] = []

    def nthreads(self) -> dict[str, int]:
        self.left = self.shifts.pop(0) if self.shifts else self.left
        threads = {"worker": 1} if self.left else {}
        self._work()
        return threads

    def get_executor(self, *, pure: bool) -> Cluster:
        assert not pure
        return self

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        future = Future[Any]()
        self.waiting.append(lambda: future.set_result(fn(*args, **kwargs)))
        self._work()
        return future

    def _work(self) -> None:
        while self.left and self.waiting:
            self.left -= 1
            self.waiting.pop(0)()

    def close(self) -> None: ...


@contextmanager
def connected(cluster: Any) -> Generator[workers.ClusterWorkers]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(workers, "_connected", lambda *_: cluster)
        patch.setattr(workers, "_killed_worker", lambda: KeyError)
        patch.setattr(runner, "TICK", 0.001)
        with workers.ClusterWorkers(ADDRESS) as crew:
            yield crew


@given(st.lists(st.integers(0, 3), max_size=6))
@example([0])  # at the moment of connecting
@example([0, 0, 0])  # and long after
@example([3, 0, 0])  # between shards: all three that were under way are done
@example([2, 0])  # with tasks under way
@example([1, 0, 1, 0])  # again and again
def test_all_work_is_done_whenever_there_is_no_worker(shifts: list[int]):
    with connected(Cluster(shifts)) as crew:
        ended = [result.content for _, result in completed(numbered(9), crew, VERSIONS)]

    assert sorted(map(int, ended)) == list(range(9))


@pytest.mark.parametrize(
    ("shifts", "said"),
    [([3, 3, 3], 0), ([0], 0), ([0, 0], 1), ([0, 0, 0, 0], 1), ([0, 0, 2, 0, 0, 1, 0, 0], 3)],
)
def test_each_time_that_there_is_none_is_said_once(
    shifts: list[int], said: int, logged: Callable[[int], AbstractContextManager[list[str]]]
):
    with connected(Cluster(shifts)) as crew, logged(logging.WARNING) as messages:
        assert len(list(completed(numbered(9), crew, VERSIONS))) == 9

    words = f"the scheduler at {ADDRESS} has no workers: waiting 60 seconds for one: start some"
    assert [words in message for message in messages] == [True] * said


def test_a_minute_without_any_is_the_end(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(workers, "PATIENCE", 0.01)
    with (
        connected(Cluster([0] * 1000)) as crew,
        pytest.raises(CampaignError, match="has no workers: start some with `dask worker"),
    ):
        list(completed(numbered(9), crew, VERSIONS))


@pytest.mark.parametrize("first", [0, 1])
def test_workers_that_join_late_are_given_work(first: int):
    """Also where results keep coming: they are counted with the next result, or with the first."""

    cluster = Cluster([first])
    with connected(cluster) as crew, pytest.MonkeyPatch.context() as patch:
        assert crew.count == first
        patch.setattr(runner, "TICK", 0.0 if first else 600.0)
        patch.setattr(cluster, "nthreads", lambda: {"a": 5, "b": 3})
        cluster.left = FOR_EVER
        assert len(list(completed(numbered(60), crew, VERSIONS))) == 60
        assert crew.count == 8


def test_a_worker_without_threads_is_none(monkeypatch: pytest.MonkeyPatch):
    cluster = Cluster([0])
    counts = iter([{"a": 0}] * 100)
    monkeypatch.setattr(cluster, "nthreads", lambda: next(counts))
    monkeypatch.setattr(workers, "PATIENCE", 0.0)
    with connected(cluster) as crew, pytest.raises(CampaignError, match="has no workers"):
        list(completed(numbered(1), crew, VERSIONS))


@pytest.mark.slow
def test_a_command_says_that_it_waits(tmp_path: Path):
    points = np.random.default_rng(1).normal(size=(5, 3))
    a = write_csv(tmp_path / "a.csv", points.tolist())
    listing = tmp_path / "pairs.csv"
    listing.write_text(f"source,target\n{a.name},{a.name}\n", "utf-8")
    with connected(Cluster([])), pytest.MonkeyPatch.context() as patch:
        patch.setattr(workers, "_connected", lambda *_: Cluster([0, 0, 0]))
        run = certreg("batch", listing, "--scheduler", ADDRESS)
        kept = certreg("batch", listing, "--scheduler", ADDRESS, "--out", tmp_path / "out")

    for each in (run, kept):
        assert each.code == 0
        told = [line for line in each.err.splitlines() if "no workers" in line]
        assert [line.startswith("note: the scheduler at tcp://here") for line in told] == [True]
    assert len(run.out.splitlines()) == 1


@pytest.mark.long
def test_a_cluster_of_dask_begins_and_goes_on_without_workers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    distributed = pytest.importorskip("distributed", reason="the extra `campaign` is not installed")
    kind = Cut(count=100, points=5, seed=3)
    finish(kind, tmp_path / "whole")
    monkeypatch.setattr(runner, "TICK", 0.02)
    with distributed.LocalCluster(
        n_workers=0,
        threads_per_worker=1,
        processes=False,
        protocol="inproc://",
        dashboard_address=None,
    ) as cluster:
        crew = workers.ClusterWorkers(cluster.scheduler.address)
        waited: list[str] = []

        class Coming(logging.Handler):
            """A worker comes once it is said that there is none."""

            def emit(self, record: logging.LogRecord) -> None:
                waited.append(record.getMessage())
                cluster.scale(1)

        def leaving(_: int) -> None:
            """The worker leaves after the first shard."""
            if len(waited) == 1:
                cluster.scale(0)
                while cluster.scheduler.workers:
                    time.sleep(0.001)

        handler = Coming()
        workers.LOG.addHandler(handler)
        try:
            finish(kind, tmp_path / "out", crew, leaving)
        finally:
            workers.LOG.removeHandler(handler)

    assert len(waited) == 2
    assert tree(tmp_path / "out") == tree(tmp_path / "whole")
