"""Ten million points: sums beside a loop in C that only reads them, memory, accuracy, threads.

And exact sums of a million, beside the same loop.
"""

from __future__ import annotations

import ctypes
import os
import subprocess
import tempfile
import time
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import mpmath
import numpy as np

from benchmarks.clouds import random_clouds
from benchmarks.measuring import Figure, Quantity, exponent, fastest, power_of_ten
from benchmarks.reference import DIGITS, angle
from build_kernels import find_compiler
from certreg.geometry.so3 import davenport_matrix
from certreg.native.kernels import FLAGS
from certreg.native.library import loaded_library
from certreg.problem.exact_sums import SumMethod, fastest_method, sums_by
from certreg.problem.floating_stiffness import floating_spring_moments
from certreg.problem.floating_sums import CloudPair, compiled, floating_sums
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem
from certreg.registration.closed_form import register

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

N = 10_000_000
READING = 1.6  # times the loop that only reads
REGISTERING = 1.4  # the same of `register`, on one core
MILLION = 1_000_000
EXACT = {"unit weights": 9.0, "weighted": 14.0}  # the same of exact sums of a million
PLANES = 40.0  # times the pass in doubles: exact sums of a million point-to-plane pairs
MEMORY = 50.0  # MB that a registration adds to the two clouds
NEAR, FAR = 1e-14, 2e-13  # radians; at an offset of 1e8 the points themselves hold 8 digits
SLOPE = (0.95, 1.05)  # k where the sums cost N^k
LINEAR: tuple[int, ...] = (10_000, 100_000, 1_000_000, N)
FEW = (5_000, 10_000)
ROUNDS, BLOCKS = 7, 6  # blocks of rounds are added until memory was ours for once


def measure() -> Iterator[Figure]:
    assert compiled() is not None, "this is about compiled code: run `make kernels`"
    source, target = random_clouds(N, noise=0.1)
    weights = np.random.default_rng(1).uniform(0.5, 2.0, size=N)
    yield _reading("doubles", source, target, None)
    yield _reading("doubles with weights", source, target, weights)
    yield _registering(source, target)
    yield from _exact(source, target, weights)
    yield _planes(source[:MILLION], target[:MILLION])
    yield _linear(source, target)
    yield _others(source, target)
    yield _memory(source, target, weights)
    yield _accuracy("generic", source, target, NEAR)
    del weights
    source += 1e8
    target += 1e8
    yield _accuracy("offset 1e8", source, target, FAR)


def _reading(what: str, source: Any, target: Any, weights: Any) -> Figure:
    arrays = [array for array in (source, target, weights) if array is not None]
    read = _reader(arrays)
    assert np.isclose(read(), sum(float(array.sum()) for array in arrays), rtol=1e-6, atol=1e3)
    clouds = _clouds(source, target, weights)
    reading = summing = np.inf
    for _ in range(BLOCKS):
        times = fastest(read, lambda: floating_sums(clouds), rounds=ROUNDS, seconds=0.05)
        reading, summing = min(reading, times[0]), min(summing, times[1])
        if summing <= READING * reading:
            break
    gigabytes = sum(array.nbytes for array in arrays) / 1e9
    return Figure(
        what=f"sums / reading, {what}",
        value=Quantity(summing / reading, "x"),
        bound=READING,
        beside={
            "sums": Quantity(summing, "s"),
            "reading": Quantity(reading, "s"),
            "that is": Quantity(round(gigabytes / reading, 1), "GB/s"),
        },
    )


def _registering(source: Any, target: Any) -> Figure:
    reading, ours = fastest(
        _reader([source, target]),
        lambda: register(source, target),
        rounds=3 * ROUNDS,
        seconds=0.05,
        clock=time.process_time,
    )
    return Figure(
        what="register / reading",
        value=Quantity(ours / reading, "x"),
        bound=REGISTERING,
        beside={"register": Quantity(ours, "s"), "reading": Quantity(reading, "s")},
    )


def _exact(source: Any, target: Any, weights: Any) -> Iterator[Figure]:
    """Exact sums on one thread; a bound where the processor multiplies pairs of 52 bits.

    Of each million in turn: again and again the same one would stand in the cache for a part.
    """
    fast, parts = loaded_library().multiplies_digits, range(0, N, MILLION)
    for what, given in zip(EXACT, (None, weights), strict=True):
        arrays = [array for array in (source, target, given) if array is not None]
        millions = [_million(source, target, given, first) for first in parts]
        methods = (SumMethod.FIXED_POINT, SumMethod.BY_EXPONENT)
        works = [partial(_in_turn, method, millions) for method in methods]
        reading, *times = fastest(
            _reader(arrays), *works, rounds=ROUNDS, seconds=0.05, clock=time.process_time
        )
        ratios = [Quantity(seconds / reading, "x") for seconds in times]
        beside = {method.value: ratio for method, ratio in zip(methods, ratios, strict=True)}
        yield Figure(
            what=f"exact sums / reading, {what}",
            value=ratios[methods.index(fastest_method(millions[0]))],
            bound=EXACT[what] if fast else None,
            beside={**beside, "reading": Quantity(reading / len(millions), "s")},
        )


def _million(source: Any, target: Any, weights: Any, first: int) -> RegistrationProblem:
    rows = slice(first, first + MILLION)
    own = None if weights is None else weights[rows]
    return RegistrationProblem(source[rows], target[rows], weights=own)


def _in_turn(method: SumMethod, problems: list[RegistrationProblem]) -> None:
    for problem in problems:
        sums_by(method, problem, threads=1)


def _planes(source: Any, target: Any) -> Figure:
    """Exact sums of springs of planes on one thread, by both methods in C."""
    normals = np.random.default_rng(2).normal(size=source.shape)
    problem = RegistrationProblem(source, target, normals=normals)
    methods = (SumMethod.LIMBS, SumMethod.BY_EXPONENT)
    works = [partial(sums_by, method, problem, threads=1) for method in methods]
    passing, *times = fastest(
        partial(floating_spring_moments, problem),
        *works,
        rounds=ROUNDS,
        seconds=0.05,
        clock=time.process_time,
    )
    ratios = [Quantity(seconds / passing, "x") for seconds in times]
    beside = {method.value: ratio for method, ratio in zip(methods, ratios, strict=True)}
    return Figure(
        what="exact sums of planes / the pass in doubles",
        value=ratios[0],
        bound=PLANES,
        beside={**beside, "the pass in doubles": Quantity(passing, "s")},
    )


def _linear(source: Any, target: Any) -> Figure:
    """All points at every size, in calls of N: each size has the same share of a busy memory.

    What a call costs before its first point is taken off: 2 T(n) - T(2 n) for few points n.
    """
    few = [_clouds(source[:n], target[:n], None) for n in FEW]
    works = [lambda part=part: floating_sums(part) for part in few]
    works += [_in_calls(source, target, n) for n in LINEAR]
    times = np.full(len(works), np.inf)
    call, spent = np.inf, dict.fromkeys(LINEAR, np.inf)
    for _ in range(BLOCKS):
        times = np.minimum(times, fastest(*works, rounds=ROUNDS, seconds=0.05))
        call = float(2 * times[0] - times[1])
        spent = {n: float(t) * n / N - call for n, t in zip(LINEAR, times[2:], strict=True)}
        if SLOPE[0] <= exponent(spent) <= SLOPE[1]:
            break
    return Figure(
        what="k, sums cost Nᵏ",
        value=Quantity(round(exponent(spent), 3), ""),
        least=SLOPE[0],
        bound=SLOPE[1],
        beside={
            "call": Quantity(call, "s"),
            **{
                f"N = {power_of_ten(n)}:": Quantity(round(1e9 * t / n, 2), "ns/point")
                for n, t in spent.items()
            },
        },
    )


def _in_calls(source: Any, target: Any, n: int) -> Callable[[], None]:
    parts = [_clouds(source[k : k + n], target[k : k + n], None) for k in range(0, N, n)]

    def work() -> None:
        for part in parts:
            floating_sums(part)

    return work


def _others(source: Any, target: Any) -> Figure:
    """Other types and layouts, and two threads; no bound."""
    usual = _clouds(source, target, None)
    columns = [np.ascontiguousarray(cloud.T).T for cloud in (source, target)]
    singles = [cloud.astype(np.float32) for cloud in (source, target)]
    works = {
        "doubles": lambda: floating_sums(usual),
        "two threads": lambda: floating_sums(usual, threads=2),
        "3×N": lambda: floating_sums(_clouds(columns[0], columns[1], None)),
        "floats": lambda: floating_sums(_clouds(singles[0], singles[1], None)),
        "register": lambda: register(source, target),
    }
    times = fastest(*works.values(), rounds=ROUNDS, seconds=0.05)
    beside = {name: Quantity(t, "s") for name, t in zip(works, times, strict=True)}
    return Figure(what="types, layouts, threads", beside=beside)


def _clouds(source: Any, target: Any, weights: Any) -> CloudPair:
    return CloudPair(source=source, target=target, weights=weights, origin=np.zeros(6))


def _reader(arrays: list[Any]) -> Callable[[], float]:
    """The loop in C over all arrays, compiled for this processor."""
    with tempfile.TemporaryDirectory() as folder:
        library = Path(folder) / "streaming.so"
        unit = Path(__file__).with_name("streaming.c")
        subprocess.run(
            [
                *find_compiler().command,
                *FLAGS,
                "-march=native",
                "-shared",
                str(unit),
                "-o",
                str(library),
            ],
            check=True,
        )
        function = ctypes.CDLL(str(library)).benchmark_sum
    function.restype = ctypes.c_double
    return lambda: sum(
        function(ctypes.c_void_p(array.ctypes.data), ctypes.c_int64(array.size)) for array in arrays
    )


def _memory(source: Any, target: Any, weights: Any) -> Figure:
    """What a registration adds to the memory in use, at its peak (proc(5): clear_refs, status)."""
    status, reset = Path("/proc/self/status"), Path("/proc/self/clear_refs")
    what = f"memory added, N = {power_of_ten(N)}"
    if not os.access(reset, os.W_OK):
        return Figure(what=what)

    def kilobytes(entry: str) -> int:
        lines = status.read_text("utf-8").splitlines()
        return next(int(line.split()[1]) for line in lines if line.startswith(entry))

    reset.write_text("5", "utf-8")
    before = kilobytes("VmRSS:")
    register(source, target, weights, threads=2)
    return Figure(
        what=what,
        value=Quantity(round((kilobytes("VmHWM:") - before) / 1024, 1), "MB"),
        bound=MEMORY,
        beside={"clouds": Quantity(round((source.nbytes + target.nbytes) / 2**20), "MB")},
    )


def _accuracy(what: str, source: Any, target: Any, bound: float) -> Figure:
    """The angle to the eigenvector, in 60 digits, of the moments in integers."""
    cross = exact_moments(RegistrationProblem(source, target)).cross
    largest = max(abs(entry) for row in cross for entry in row)
    with mpmath.workdps(DIGITS):
        rows = [[mpmath.mpf(entry) / largest for entry in row] for row in davenport_matrix(cross)]
        vectors = mpmath.eigsy(mpmath.matrix(rows))[1]  # by ascending eigenvalue
        reference = [vectors[i, 3] for i in range(4)]
    found = register(source, target).quaternion_wxyz
    return Figure(
        what=f"error, N = {power_of_ten(N)}, {what}",
        value=Quantity(angle(found.tolist(), reference), "rad"),
        bound=bound,
    )
