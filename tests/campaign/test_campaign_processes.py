"""Campaigns in processes of their own: killed as a whole, killed in part, on a cluster."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest
from campaign_work import Cut, finish, tree

from benchmarks.rates.campaign_kills import KIND, begin, resumed_alike, shards
from certreg.campaign.workers import workers_at
from certreg.errors import CampaignError

HERE = Path(__file__).parents[1]
pytestmark = pytest.mark.slow


@pytest.mark.slow
@pytest.mark.parametrize("trials", [1, pytest.param(2, marks=pytest.mark.long)])
def test_a_campaign_killed_at_any_moment_ends_with_the_same_bytes(trials):
    assert resumed_alike(KIND, trials=trials, seed=2) == trials


def children(parent: int) -> set[int]:
    """Processes whose parent is the given one, from /proc."""
    found = set()
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            _, _, rest = stat.read_text("utf-8").rpartition(")")
        except OSError:
            continue
        if int(rest.split()[1]) == parent and rest.split()[0] != "Z":
            found.add(int(stat.parent.name))
    return found


def is_running(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text("utf-8").rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.long
@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="there is no /proc here")
def test_workers_end_with_the_campaign_that_is_killed(tmp_path):
    run = begin(KIND, tmp_path / "out")
    workers = children(run.pid)
    while run.poll() is None and (shards(tmp_path / "out") < 3 or len(workers) < 2):
        time.sleep(0.05)  # looking through /proc is work, too
        workers = children(run.pid)
    run.kill()  # it alone, not its group
    run.wait()

    assert len(workers) >= 2
    deadline = time.monotonic() + 20
    while any(map(is_running, workers)):
        assert time.monotonic() < deadline
        time.sleep(0.05)


@contextmanager
def worker(address: str):
    """A worker of dask in a process of its own, once it is registered."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, (HERE, HERE.parent)))}
    options = ("--nthreads", "1", "--no-nanny", "--no-dashboard", "--host", "127.0.0.1")
    process = subprocess.Popen(
        [sys.executable, "-m", "distributed.cli.dask_worker", address, *options],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env=environment,
        start_new_session=True,
        encoding="utf-8",
    )
    assert process.stdout is not None
    try:
        ready = re.compile("Starting established connection|Registered to")
        assert any(map(ready.search, process.stdout))
        yield process
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        process.stdout.close()


@contextmanager
def cluster():
    """A scheduler's address and one of its two workers; the other one lives in this process."""
    distributed = pytest.importorskip("distributed", reason="the extra `campaign` is not installed")
    with (
        distributed.LocalCluster(
            n_workers=1,
            threads_per_worker=1,
            processes=False,
            protocol="tcp://",
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",
        ) as here,
        worker(here.scheduler_address) as one,
    ):
        yield here.scheduler_address, one


@pytest.mark.long
def test_a_campaign_on_a_cluster_survives_a_killed_worker(tmp_path):
    kind = Cut(count=900, points=5, seed=3)
    finish(kind, tmp_path / "whole")

    with cluster() as (address, one):

        class Killing:
            """Counts what is done, and kills one of the workers in the middle of it."""

            done = 0

        def advanced(count):
            Killing.done += count
            if Killing.done == 300:
                os.killpg(one.pid, signal.SIGKILL)

        finish(kind, tmp_path / "out", workers_at(address), advanced)
        assert one.poll() is not None or one.wait(10) is not None

    assert tree(tmp_path / "out") == tree(tmp_path / "whole")


@pytest.mark.long  # loads distributed, a second
def test_a_scheduler_that_is_not_there_is_one_clear_error(monkeypatch):
    pytest.importorskip("distributed", reason="the extra `campaign` is not installed")
    monkeypatch.setattr("certreg.campaign.workers.CONNECTING", 0.5)
    for address in ("tcp://127.0.0.1:9", "nonsense://x"):
        with pytest.raises(CampaignError, match="no dask scheduler answers"):
            workers_at(address)
