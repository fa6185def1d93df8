"""From two clouds to the rotation, beside every peer and beside reading the points once.

All of them in turn, on the same clouds. First on one core, from ten points to ten million, in a
process that has no other: so no tool is ahead by its threads. Then on all cores, at ten million.
That the rotations agree is asserted before anything is timed; `accuracy` counts their digits.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from benchmarks.clouds import random_clouds
from benchmarks.measuring import Figure, Quantity, Series, fastest, power_of_ten
from benchmarks.peers import PEERS, presence
from certreg.problem.floating_sums import CloudPair, floating_sums
from certreg.problem.problem import RegistrationProblem
from certreg.registration.closed_form import register
from certreg.registration.squares import solve

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    Times = dict[str, dict[int, float]]

SIZES = (10, 100, 1000, 10_000, 100_000, 1_000_000, 10_000_000)
LARGEST = SIZES[-1]
PROVED = SIZES[:-1]
# Times faster than the fastest library and than SciPy, on one core. That library takes 6.4 to 7.4
# times what reading the points takes, so nothing is ten times faster; `register` is held to 1.4.
PEER, SCIPY = 4.0, 30.0
TRIMESH = (10_000, 1.0)  # at so many points, at least so many times faster than this library
OURS, SUMS, PROOF = "certreg", "certreg, sums alone", "certreg, with proof"
READING = "reading once"
AGREE = 1e-9  # largest difference of entries; the clouds are at the origin
ROOT = Path(__file__).parent.parent
ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS"), "1"
)


def measure() -> Iterator[Figure | Series]:
    lines = _on_one_core()
    yield Series(what="one registration, on one core", size="points", lines=lines)
    last = {name: times[LARGEST] for name, times in lines.items() if LARGEST in times}
    yield from _ratios(last, "one core", bounded=True)
    yield from _trimesh(lines)
    alone = {name: line[LARGEST] for name, line in times_of((LARGEST,), threads=_cores()).items()}
    yield from _ratios(alone, f"{_cores()} cores", bounded=False)


def times_of(sizes: Sequence[int], *, threads: int) -> Times:
    """Seconds of every way to register clouds of so many points, certreg on so many threads."""
    lines: Times = {}
    for n in sizes:
        works = _works(n, threads)
        many = n >= 10**6
        times = fastest(*works.values(), rounds=3 if many else 5, seconds=0.1 if many else 0.02)
        for name, seconds in zip(works, times, strict=True):
            lines.setdefault(name, {})[n] = seconds
    return lines


def _works(n: int, threads: int) -> dict[str, Callable[[], Any]]:
    """Every way that is installed, each seen to be right; then sums, proof and reading."""
    source, target = random_clouds(n, noise=0.1)
    works: dict[str, Callable[[], Any]] = {
        OURS: lambda: register(source, target, threads=threads).rotation
    }
    works |= {
        peer.name: peer.prepare(source, target)
        for peer in PEERS
        if n <= (peer.most or n) and not presence(peer).absent
    }
    turn = works[OURS]()
    for name, work in works.items():
        assert np.abs(work() - turn).max() < AGREE, f"{name} finds another rotation, N = {n}"
    clouds = CloudPair(source=source, target=target, weights=None, origin=np.zeros(6))
    further: dict[str, Callable[[], Any]] = {
        SUMS: lambda: floating_sums(clouds, threads=threads),
        READING: lambda: (source.max(), target.max()),
    }
    if n in PROVED and threads == 1:
        further[PROOF] = lambda: solve(RegistrationProblem(source, target))
    return {OURS: works.pop(OURS), **further, **works}


def _on_one_core() -> Times:
    """`times_of` in a process that is tied to one core before it loads anything."""
    command = [sys.executable, "-m", "benchmarks.comparing"]
    run = subprocess.run(
        command, cwd=ROOT, env={**os.environ, **ONE_THREAD}, check=True, stdout=subprocess.PIPE
    )
    found = json.loads(run.stdout)
    return {name: {int(n): t for n, t in times.items()} for name, times in found.items()}


def _cores() -> int:
    tied = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return tied or 1


def _ratios(times: dict[str, float], where: str, *, bounded: bool) -> Iterator[Figure]:
    """At the largest size: the fastest library, and SciPy."""
    libraries = [peer.name for peer in PEERS if peer.library and peer.name in times]
    quickest = min(libraries, key=times.__getitem__)
    beside = {name: Quantity(seconds, "s") for name, seconds in times.items()}
    at = f"N = {power_of_ten(LARGEST)}, {where}"
    fastest_library = f"fastest library, {quickest}"
    for what, name, least in ((fastest_library, quickest, PEER), ("SciPy", "SciPy", SCIPY)):
        yield Figure(
            what=f"{what} / certreg, {at}",
            value=Quantity(times[name] / times[OURS], "x"),
            least=least if bounded else None,
            beside=beside,
        )
        beside = {}  # once is enough


def _trimesh(lines: Times) -> Iterator[Figure]:
    """Where it is installed: the library that is next where there are few points."""
    n, least = TRIMESH
    if "trimesh" in lines:
        yield Figure(
            what=f"trimesh / certreg, N = {power_of_ten(n)}, one core",
            value=Quantity(lines["trimesh"][n] / lines[OURS][n], "x"),
            least=least,
            beside={"certreg": Quantity(lines[OURS][n], "s")},
        )


def tie_to_one_core() -> None:
    """Before any library starts threads; where the system cannot, they are asked for one each."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})


if __name__ == "__main__":
    tie_to_one_core()
    print(json.dumps(times_of(SIZES, threads=1)))
