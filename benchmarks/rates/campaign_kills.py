"""A campaign killed at 20 random moments and resumed; ARGS: another number.

The whole process group gets SIGKILL once a random number of shards stands there, and a random
moment later; the campaign is begun again in the same folder. Every file must then be, byte for
byte, what an uninterrupted run writes. Seeds are fixed; the moments are the machine's.
"""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

from campaign_work import Cut, finish, tree

from certreg.campaign.store import SHARDS, Manifest
from certreg.paper.equilibrium_maps import SpringCampaign, SpringCell, write_spring_results
from certreg.paper.monte_carlo import write_instance_results


class Maps(SpringCampaign):
    """The maps of general springs, in shards of four."""

    def manifest(self) -> Manifest:
        return replace(super().manifest(), shard_size=4)


KIND = Cut(count=600, points=5, seed=3)
FLATS = Cut(count=200, points=2, seed=3)  # each with a certificate
CELLS = tuple(SpringCell(family="plane", points=points, noise=0.1) for points in (6, 20))
MAPS = Maps(instances=40, seed=3, cells=CELLS)
KINDS = {"KIND": KIND, "FLATS": FLATS, "MAPS": MAPS}
ALL = 20
Kind = Cut | Maps


def whole(kind: Kind, folder: Path, workers: Any = None) -> None:
    """The campaign to its end, by threads of this process if nobody else."""
    finish(kind, folder, workers)
    if isinstance(kind, Maps):
        write_spring_results(kind, folder)
    else:
        write_instance_results(kind, folder)


def begin(kind: Kind, folder: Path) -> subprocess.Popen[bytes]:
    """The campaign in a process group of its own."""
    code = (
        "import sys, pathlib, benchmarks.rates.campaign_kills as k\n"
        "from certreg.campaign.workers import LocalWorkers\n"
        "k.whole(k.KINDS[sys.argv[1]], pathlib.Path(sys.argv[2]), LocalWorkers(2))"
    )
    name = next(name for name, one in KINDS.items() if one is kind)
    here = Path(__file__).resolve().parents[2] / "tests"
    paths = os.pathsep.join((str(here), str(here.parent)))
    return subprocess.Popen(
        [sys.executable, "-W", "error", "-c", code, name, str(folder)],
        start_new_session=True,
        env={**os.environ, "PYTHONPATH": paths},
    )


def kill_within(kind: Kind, folder: Path, rng: random.Random) -> bool:
    """Begin, and kill everything at a random moment; False where the end came first."""
    goal = rng.randint(0, kind.manifest().shards)
    delay = rng.uniform(0.0, 0.05)
    run = begin(kind, folder)
    while run.poll() is None and shards(folder) < goal:
        time.sleep(0.001)
    time.sleep(delay)
    if run.poll() is None:
        os.killpg(run.pid, signal.SIGKILL)
    return run.wait() == -signal.SIGKILL


def shards(folder: Path) -> int:
    place = folder / SHARDS
    return sum(1 for _ in place.iterdir()) if place.exists() else 0


def resumed_alike(kind: Kind, trials: int, seed: int) -> int:
    """How many of the trials were killed before their end; raises where a result is another."""
    rng, killed = random.Random(seed), 0
    with tempfile.TemporaryDirectory() as place:
        whole(kind, Path(place) / "whole")
        expected = tree(Path(place) / "whole")
        for trial in range(trials):
            folder = Path(place) / str(trial)
            killed += kill_within(kind, folder, rng)
            there = shards(folder)
            whole(kind, folder)
            if tree(folder) != expected:
                message = f"trial {trial}, killed at {there} shards, ended with other results"
                raise AssertionError(message)
    return killed


if __name__ == "__main__":
    amount = int(sys.argv[1]) if len(sys.argv) > 1 else ALL
    for kind in KINDS.values():
        killed = resumed_alike(kind, amount, seed=amount)
        sys.stdout.write(f"{amount} trials, {killed} killed before the end: the same in each\n")
