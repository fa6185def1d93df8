"""From two clouds to the rotation, beside every peer and beside reading the points once.

All of them in turn, on the same clouds, from ten points to ten million. Each peer comes with the
threads that it takes by itself; reading is one thread's. That the rotations agree is asserted
before anything is timed; how many digits they have is measured by `accuracy`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from benchmarks.clouds import random_clouds
from benchmarks.measuring import Figure, Quantity, Series, exponent, fastest, power_of_ten
from benchmarks.peers import PEERS, presence
from certreg.equilibria.closed_form import horn
from certreg.moments import floating_moments
from certreg.pipeline import solve
from certreg.problem import RegistrationProblem
from certreg.so3 import rotation_matrix

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

SIZES = (10, 100, 1000, 10_000, 100_000, 1_000_000, 10_000_000)
PROVED = (10, 100, 1000, 10_000, 100_000)  # more points take minutes with all rounds
LINEAR = (10_000, 100_000, 1_000_000, 10_000_000)
SLOPE = (0.95, 1.05)  # of the cost against the number of points
PEER, SCIPY = 10.0, 30.0  # times faster than the fastest library and than SciPy, at the last size
OURS, PROOF, READING = "certreg", "certreg, with proof", "reading once"
AGREE = 1e-9  # radians, to a peer; raw sums keep no more of clouds at the origin


def measure() -> Iterator[Figure | Series]:
    lines: dict[str, dict[int, float]] = {name: {} for name in (OURS, READING, PROOF)}
    for n in SIZES:
        works = _works(n)
        times = fastest(*works.values(), rounds=_rounds(n), seconds=0.02 if n < 10**6 else 0.1)
        for name, seconds in zip(works, times, strict=True):
            lines.setdefault(name, {})[n] = seconds
    yield Series(what="one registration", size="points", lines=lines)
    yield _linear({n: lines[OURS][n] for n in LINEAR})
    yield from _ratios({name: times[SIZES[-1]] for name, times in lines.items() if name != PROOF})


def _rounds(n: int) -> int:
    return 5 if n <= 10**6 else 3


def _works(n: int) -> dict[str, Callable[[], Any]]:
    """Every way to register clouds of n points that is installed, each seen to be right."""
    source, target = random_clouds(n, noise=0.1)
    works = {OURS: lambda: registered(source, target)} | {
        peer.name: peer.prepare(source, target) for peer in PEERS if not presence(peer).absent
    }
    turn = registered(source, target)
    for name, work in works.items():
        assert np.abs(work() - turn).max() < AGREE, f"{name} finds another rotation, N = {n}"
    if n in PROVED:
        works[PROOF] = lambda: solve(RegistrationProblem(source, target))
    return works | {READING: lambda: (source.max(), target.max())}


def registered(source: Any, target: Any) -> Any:
    """The rotation (3, 3) by certreg: validation, moments, closed form."""
    moments = floating_moments(RegistrationProblem(source, target))
    return np.array(rotation_matrix(horn(moments.cross_covariance).tolist()))


def _linear(times: dict[int, float]) -> Figure:
    least, bound = SLOPE
    return Figure(
        what="k, cost grows as Nᵏ",
        value=Quantity(exponent(times), ""),
        least=least,
        bound=bound,
        beside={
            f"N = {power_of_ten(n)}:": Quantity(1e9 * seconds / n, "ns/point")
            for n, seconds in times.items()
        },
    )


def _ratios(times: dict[str, float]) -> Iterator[Figure]:
    """At the largest size: beside SciPy, the fastest library, and reading."""
    libraries = {
        peer.name: times[peer.name] for peer in PEERS if peer.library if peer.name in times
    }
    quickest = min(libraries, key=libraries.__getitem__)
    beside = {name: Quantity(seconds, "s") for name, seconds in times.items()}
    for what, name, least in (
        (f"fastest library ({quickest})", quickest, PEER),
        ("SciPy", "SciPy", SCIPY),
    ):
        yield Figure(
            what=f"{what} / certreg, N = {power_of_ten(SIZES[-1])}",
            value=Quantity(times[name] / times[OURS], "x"),
            least=least,
            beside=beside,
        )
    yield Figure(
        what=f"certreg / reading once, N = {power_of_ten(SIZES[-1])}",
        value=Quantity(times[OURS] / times[READING], "x"),
    )
