"""How often all equilibria of general springs are listed and proved.

    make rates NAME=spring_lists ARGS="[COUNT [FAMILY]]"

So many problems of each cell, 100 unless told.

Of each cell of `spring_families.LISTED`: the share of lists that are proved complete, the Euler sum
of the indices, how many equilibria and stable ones there are, and the CPU time of a list, scaled to
a machine on which SciPy registers 100 pairs in 100 microseconds. Then the time of a problem where
many go in one call of `solve_many_springs`, in floating point, beside a loop that follows their
paths, and how many of them have the proved counts.
"""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass
from typing import Any

import numpy as np
import spring_families as families
from scipy.spatial.transform import Rotation

from certreg import solve_many_springs
from certreg.equilibrium.line_set import LineSet
from certreg.equilibrium.methods import search
from certreg.equilibrium.paths import critical_lines
from certreg.objective.springs import Springs
from certreg.problem.problem import RegistrationProblem

COUNT = 100  # of each cell
LEAST_SHARE = 0.99  # proved complete
MEDIAN, LAST = 50.0, 100.0  # milliseconds, scaled: of the middle one, of 99 in 100
YARDSTICK = 1e-4  # seconds of the yardstick where a millisecond is one
PAIRS, CALLS = 100, 200  # of the yardstick


@dataclass(frozen=True, slots=True, kw_only=True)
class ListRate:
    """What became of the problems of a cell.

    complete: lists that are proved. wrong: of these, with another Euler sum than 0, an index that
    is missing, or an odd number. counts, stable: the least and the most. median, last: scaled
    milliseconds, of the middle list and of 99 in 100.
    """

    cell: families.Cell
    count: int
    complete: int
    wrong: int
    counts: tuple[int, int]
    stable: tuple[int, int]
    median: float
    last: float

    @property
    def good(self) -> bool:
        """Whether the cell is as it must be."""
        enough = self.complete >= LEAST_SHARE * self.count
        return enough and not self.wrong and self.median <= MEDIAN and self.last <= LAST

    def __str__(self) -> str:
        (few, many), (least, most) = self.counts, self.stable
        return (
            f"{'' if self.good else 'MISSED '}{self.cell}: {self.complete} of {self.count} proved "
            f"complete, {few} to {many} equilibria, {least} to {most} stable, {self.wrong} with a "
            f"wrong Euler sum, {self.median:.1f} ms, 99 % within {self.last:.1f} ms"
        )


def listed(cell: families.Cell, seed: int) -> tuple[LineSet | None, float]:
    """The list of a problem by the 40 paths, and seconds of CPU from the sums on."""
    problem = RegistrationProblem(**families.statement(families.instance(cell, seed)))
    objective = Springs.of(problem)
    start = time.process_time()
    found = search(objective, "homotopy").critical
    seconds = time.process_time() - start
    return found if isinstance(found, LineSet) else None, seconds


def yardstick() -> float:
    """Seconds of CPU of SciPy's registration of 100 pairs: the least of many calls."""
    rng = np.random.default_rng(0)
    source, target = rng.normal(size=(2, PAIRS, 3))
    times: list[float] = []
    for _ in range(CALLS):
        start = time.process_time()
        Rotation.align_vectors(target, source)
        times.append(time.process_time() - start)
    return min(times)


def rate_of(cell: families.Cell, count: int) -> ListRate:
    """The first so many problems of a cell."""
    listed(cell, 0)  # libraries and tables
    made = [listed(cell, seed) for seed in range(count)]
    proved = [found for found, _ in made if found is not None and found.complete]
    unit = yardstick() / YARDSTICK
    times = np.array([1e3 * seconds / unit for _, seconds in made])
    counts = [len(found.components) for found in proved]
    stable = [found.stable for found in proved]
    return ListRate(
        cell=cell,
        count=count,
        complete=len(proved),
        wrong=sum(not _is_balanced(found) for found in proved),
        counts=(min(counts, default=0), max(counts, default=0)),
        stable=(min(stable, default=0), max(stable, default=0)),
        median=float(np.median(times)),
        last=float(np.quantile(times, 0.99)),
    )


def _is_balanced(found: LineSet) -> bool:
    """What Morse's theory asks: every index, and as many even ones as odd ones."""
    indices = found.indices
    return {0, 1, 2, 3} <= set(indices) and sum(
        -1 if index % 2 else 1 for index in indices if index is not None
    ) == 0


def batch_line(cell: families.Cell, count: int) -> str:
    """The CPU time of a problem where many are solved at once, and where they are one by one."""
    made = [families.instance(cell, seed) for seed in range(count)]
    springs: dict[str, Any] = {
        name: np.array([m.springs[name] for m in made]) for name in made[0].springs
    }
    clouds = np.array([m.source for m in made]), np.array([m.target for m in made])
    start = time.process_time()
    found = solve_many_springs(*clouds, threads=1, **springs)
    together = time.process_time() - start
    start = time.process_time()
    for one in made:
        problem = RegistrationProblem(**families.statement(one))
        critical_lines(Springs.of(problem).floating_quartic()[0])
    alone = time.process_time() - start
    proved = [listed(cell, seed)[0] for seed in range(count)]
    same = sum(
        p is not None and len(p.components) == k for p, k in zip(proved, found.counts, strict=True)
    )
    return (
        f"{cell}: {1e3 * together / count:.2f} ms a problem in one call, {1e3 * alone / count:.2f} "
        f"in a loop, both in doubles and not scaled; {same} of {count} with the proved count"
    )


def main(count: int = COUNT, family: str = "") -> int:
    """Print a line for each cell; 1 if one is not as it must be."""
    bad = 0
    for cell in families.LISTED:
        if not family or cell.family == family:
            rate = rate_of(cell, count)
            bad += not rate.good
            sys.stdout.write(f"{rate}\n")
            sys.stdout.flush()
    sys.stdout.write(f"{bad} cells missed\n{batch_line(families.LISTED[3], count)}\n")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(int((*sys.argv[1:2], COUNT)[0]), (*sys.argv[2:3], "")[0]))
