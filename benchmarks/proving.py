"""Certificates of many points: exact moments against N, and whole processes that make and check.

Its seconds are the processor's, of all threads: on a machine with nothing else to do no run takes
longer. What a process loads counts, and so does the file that it writes.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from benchmarks.clouds import random_problem
from benchmarks.measuring import Figure, Quantity, exponent, fastest, power_of_ten
from certreg import verify
from certreg.problem.exact_sums import SumMethod, fastest_method, sums_by

if TYPE_CHECKING:
    from collections.abc import Iterator

SIZES = (10_000, 100_000, 1_000_000, 10_000_000)
SLOPE = (0.95, 1.05)  # k where exact moments cost N^k
COMPARED, FASTER = 100_000, 10.0  # times than Python's integers, of that many points
CERTIFIED = 1_000_000  # points: the most that a certificate holds
PRODUCED, CHECKED = 3.0, 30.0  # seconds
ROUNDS = 5
ROOT = Path(__file__).parent.parent
WATCHED = """
import json, sys, time
start = 0.0
{work}
status = open("/proc/self/status").read().split()
print()
print(json.dumps([time.process_time() - start, int(status[status.index("VmHWM:") + 1]) / 1024]))
"""
PRODUCING = """
import numpy as np
x, y, w = (np.load(f"{sys.argv[1]}/{name}.npy") for name in "xyw")
import certreg
start = time.process_time() if sys.argv[2] == "warm" else start
problem = certreg.RegistrationProblem(x, y, weights=w)
registration = certreg.certify(problem, relaxation=True, simulation=True)
registration.certificate.save(f"{sys.argv[1]}/certificate.json")
"""
CHECKING = """
import runpy
sys.argv[1:] = [f"{sys.argv[1]}/certificate.json"]
try:
    runpy.run_path("certreg/verify.py", run_name="__main__")
except SystemExit as end:
    assert end.code == 0
"""


def measure() -> Iterator[Figure]:
    yield from _exact_moments()
    with tempfile.TemporaryDirectory() as folder:
        problem = random_problem(CERTIFIED)
        arrays = {"x": problem.source, "y": problem.target, "w": problem.weights}
        for name, array in arrays.items():
            np.save(f"{folder}/{name}.npy", array)
        del problem, arrays
        yield from _processes(Path(folder))


def _exact_moments() -> Iterator[Figure]:
    times: dict[int, float] = {}
    for n in SIZES:
        problem = random_problem(n)
        (times[n],) = fastest(
            lambda problem=problem: sums_by(fastest_method(problem), problem, threads=1),
            rounds=ROUNDS,
        )
    yield Figure(
        what="exact sums, one thread, ~ N^k",
        value=Quantity(exponent(times), ""),
        least=SLOPE[0],
        bound=SLOPE[1],
        beside={power_of_ten(n): Quantity(seconds, "s") for n, seconds in times.items()},
    )
    problem = random_problem(COMPARED)
    works = {method: (lambda method=method: sums_by(method, problem)) for method in SumMethod}
    seconds = dict(zip(works, fastest(*works.values(), rounds=ROUNDS), strict=True))
    slowest = seconds[SumMethod.INTEGERS]
    for method in (SumMethod.FIXED_POINT, SumMethod.BY_EXPONENT, SumMethod.LIMBS):
        yield Figure(
            what=f"Python's integers / {method.value}",
            value=Quantity(slowest / seconds[method], "x"),
            least=None if method is SumMethod.LIMBS else FASTER,
            beside={"N": Quantity(COMPARED, "points"), "here": Quantity(seconds[method], "s")},
        )


def _processes(folder: Path) -> Iterator[Figure]:
    file, points = folder / "certificate.json", power_of_ten(CERTIFIED)
    for start in ("cold", "warm"):  # with what is loaded at the start, and from the arrays on
        seconds, peak = _watched(PRODUCING, str(folder), start)
        yield Figure(
            what=f"certify and save, {start}, N = {points}",
            value=Quantity(seconds, "s"),
            bound=PRODUCED,
            beside={"peak": Quantity(round(peak), "MB"), "file": _megabytes(file)},
        )
    seconds, peak = _watched(CHECKING, str(folder))
    yield Figure(
        what=f"verify.py, N = {points}",
        value=Quantity(seconds, "s"),
        bound=CHECKED,
        beside={"peak": Quantity(round(peak), "MB"), "file": _megabytes(file)},
    )
    assert verify(file).proved


def _megabytes(file: Path) -> Quantity:
    return Quantity(round(file.stat().st_size / 2**20), "MB")


def _watched(work: str, *arguments: str) -> tuple[float, float]:
    """Seconds and megabytes of the fastest of three processes."""
    command = [sys.executable, "-c", WATCHED.format(work=work), *arguments]
    found: list[list[Any]] = []
    for _ in range(3):
        done = subprocess.run(
            command, cwd=ROOT, check=True, capture_output=True, text=True, encoding="utf-8"
        )
        found.append(json.loads(done.stdout.splitlines()[-1]))
    seconds, peak = min(found)
    return seconds, peak
