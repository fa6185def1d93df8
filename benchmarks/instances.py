"""A million small problems: all equilibria and unstable counts of each, beside an eigvals loop.

The paper's generator, N = 100, in blocks; the data are made on one core and timed apart. In every
block, by turns: certreg, and the loop that one writes: NumPy's `eigvals` on the Jacobian at each of
the four equilibria, of some instances of the block, equilibria and Jacobians given. The ratio is to
the faster of two loops, 12x12 and 18x18; `stacked` are all matrices of a sample in one call. The
loops run on one thread. What they count must be what certreg counts. The rate is that of the
fastest block, as all times are the least of several; `whole run` is the mean, whatever else ran.
"""

from __future__ import annotations

import time
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from benchmarks.measuring import Figure, Quantity, Series, fastest
from certreg.dynamics.batch import bodies_of
from certreg.dynamics.states import state_at_rest
from certreg.equilibrium.batch import Solutions, exactly, solve_many
from certreg.geometry.so3 import davenport_matrix, rotation_matrix
from certreg.native.engine import current_engine
from certreg.problem.random_instances import gaussian_instances

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

COUNT, BLOCK, PART, POINTS = 1_000_000, 2000, 250, 100
SAMPLE = 16  # instances of each block for the loops: 64 Jacobians, as long as the block takes
LOOP, RATE = 15.0, 100_000.0  # times faster; instances a second on two threads
SIZES, MOST_ALONE = (1, 10, 100, 1000, 10_000, 100_000), 100
THREADS = 2
STRUCTURAL = 1e-7  # zeros of the ambient Jacobian come out as small as that
GENERATED, ALONE, OURS = "generating", "certreg, 1 thread", f"certreg, {THREADS} threads"
LOOPS = ("loop 12x12", "loop 18x18")


def measure() -> Iterator[Figure | Series]:
    print(f"      {current_engine().words}")
    yield from _million()
    yield _by_number()


def _million() -> Iterator[Figure]:
    rng = np.random.default_rng(0)
    times: dict[str, list[float]] = {}
    others = undecided = 0
    for _ in range(COUNT // BLOCK):
        made = _timed(times, GENERATED, BLOCK, partial(_made, rng))
        for name, threads in ((ALONE, 1), (OURS, THREADS)):
            solve = partial(solve_many, *made, threads=threads)
            found = _timed(times, name, BLOCK, solve)
        _timed_loops(times, made, found)
        others += int((found.unstable != range(4)).any(axis=1).sum())
        undecided += int((~found.decided).sum())
    least = {name: min(each) for name, each in times.items()}
    yield Figure(
        what="eigvals loop / all of it",
        value=Quantity(min(least[name] for name in LOOPS) / least[OURS], "x"),
        least=LOOP,
        beside={k: Quantity(t, "s") for k, t in least.items() if k != GENERATED},
    )
    yield Figure(
        what=f"{COUNT:,} instances",
        value=Quantity(round(1.0 / least[OURS]), "/s"),
        least=RATE,
        beside={
            "whole run": Quantity(round(1.0 / np.mean(times[OURS])), "/s"),
            GENERATED: Quantity(round(1.0 / np.mean(times[GENERATED])), "/s"),
            "not 0/1/2/3": Quantity(others, ""),
            "undecided": Quantity(undecided, ""),
        },
    )


def _timed(times: dict[str, list[float]], name: str, count: int, work: Callable[[], Any]) -> Any:
    """What a work gives; its seconds an instance go to the times of that name."""
    start = time.perf_counter()
    result = work()
    times.setdefault(name, []).append((time.perf_counter() - start) / count)
    return result


def _by_number() -> Series:
    """Seconds for so many instances, data given; the loop also finds the equilibria here."""
    sources, targets = _made(np.random.default_rng(1))
    lines: dict[str, dict[int, float]] = {}
    for count in SIZES:
        given = [np.resize(cloud, (count, POINTS, 3)) for cloud in (sources, targets)]
        works = {
            OURS: partial(solve_many, *given, threads=THREADS),
            ALONE: partial(solve_many, *given, threads=1),
        }
        if count <= MOST_ALONE:
            assert (solve_many(*given).unstable == _by_loop(*given)).all()
            works["NumPy, eigvals loop"] = partial(_by_loop, *given)
            works["exact, one by one"] = partial(_exactly, *given)
        times = fastest(*works.values(), rounds=5)
        for name, seconds in zip(works, times, strict=True):
            lines.setdefault(name, {})[count] = seconds
    return Series(what="all equilibria, unstable eigenvalues", size="instances", lines=lines)


def _by_loop(sources: Any, targets: Any) -> Any:
    """Unstable eigenvalues at the equilibria of each instance, the Jacobians written out."""
    counts = np.empty((len(sources), 4), dtype=int)
    damping = np.sqrt(8.0)
    for k, (source, target) in enumerate(zip(sources, targets, strict=True)):
        x, y = source - source.mean(axis=0), target - target.mean(axis=0)
        cross, scatter = y.T @ x, x.T @ x
        inverse = np.linalg.inv(np.trace(scatter) * np.eye(3) - scatter)
        vectors = np.linalg.eigh(np.array(davenport_matrix(cross.tolist())))[1]
        for row, q in enumerate(vectors.T[::-1]):
            aligned = np.array(rotation_matrix(q.tolist())).T @ cross
            jacobian = np.zeros((12, 12))
            jacobian[:6, 6:] = np.eye(6)
            jacobian[6:9, :3] = -2.0 * np.eye(3)
            jacobian[9:, 3:6] = inverse @ (
                aligned + aligned.T - 2.0 * np.trace(aligned) * np.eye(3)
            )
            jacobian[6:, 6:] = -damping * np.eye(6)
            counts[k, row] = (np.linalg.eigvals(jacobian).real > STRUCTURAL).sum()
    return counts


def _exactly(sources: Any, targets: Any) -> Any:
    return [exactly(x, y) for x, y in zip(sources, targets, strict=True)]


def _made(rng: np.random.Generator) -> tuple[Any, Any]:
    """Sources and targets of a block, made by parts that fit the processor's cache."""
    parts = [gaussian_instances(rng, points=POINTS, count=PART) for _ in range(BLOCK // PART)]
    return np.concatenate([p.sources for p in parts]), np.concatenate([p.targets for p in parts])


def _timed_loops(times: dict[str, list[float]], clouds: Any, found: Solutions) -> None:
    """The other ways to the unstable counts of a sample, the Jacobians given."""
    bodies = bodies_of(*(cloud[:SAMPLE] for cloud in clouds)).records
    intrinsic, ambient = _jacobians(bodies, found.quaternions[:SAMPLE])
    eigvals = np.linalg.eigvals
    works = {
        LOOPS[0]: lambda: np.array([eigvals(matrix) for matrix in intrinsic]),
        LOOPS[1]: lambda: np.array([eigvals(matrix) for matrix in ambient]),
        "stacked": lambda: eigvals(intrinsic),
    }
    for name, work in works.items():
        values = _timed(times, name, SAMPLE, work)
        counts = (values.real > STRUCTURAL).sum(axis=1).reshape(SAMPLE, 4)
        assert (counts == found.unstable[:SAMPLE]).all(), name


def _jacobians(bodies: Any, quaternions: Any) -> tuple[Any, Any]:
    """The Jacobians at four equilibria of each body, (4 count, 12, 12) and (4 count, 18, 18)."""
    intrinsic, ambient, evaluate = list[Any](), list[Any](), current_engine().evaluate
    for record, rows in zip(bodies, quaternions, strict=True):
        for q in rows:
            state = state_at_rest(np.array(rotation_matrix(q.tolist())))
            intrinsic += evaluate("certreg_intrinsic_jacobian", state, record)
            ambient += evaluate("certreg_ambient_jacobian", state, record)
    return np.reshape(intrinsic, (-1, 12, 12)), np.reshape(ambient, (-1, 18, 18))
