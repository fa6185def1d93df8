"""The paper's experiment with springs that are matrices: how many equilibria, how many stable.

Clouds, motions and start are the paper's; the springs pull towards planes or lines, or along axes
of each pair's own. At each size and noise the critical rotations of many instances are found by
following 40 paths in doubles: counted, not proved. An instance whose paths did not all end apart
is left out of the counts, and said to be.

>>> import numpy as np
>>> cell = SpringCell(family="plane", points=6, noise=0.1)
>>> problem = spring_problem(np.random.default_rng(0), cell)
>>> seen = observed(problem)
>>> seen.listed, seen.equilibria % 2, seen.stable >= 1
(True, 0, True)
"""

from __future__ import annotations

import csv
import io
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.equilibrium import FloatingQuartic, PathsOutcome, critical_lines
from certreg.objective import Springs
from certreg.problem import RegistrationProblem, gaussian_instances, spring_moments

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from numpy.typing import NDArray

    from certreg.paper.observations import StageProgress

SPRING_INSTANCES = 100  # in each cell: a share is known to 0.1
SPRINGS_FILE = "springs.csv"
LONGEST = 100.0  # axes of covariances: deviations from the noise down to a hundredth of it
Z95 = 1.959963984540054  # of the normal distribution, two-sided 95 %


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringCell:
    """Instances of one family, size and noise."""

    family: str
    points: int
    noise: float


FAMILY_WORDS = {"plane": "planes", "line": "lines", "covariance": "covariances"}
NOISES = (0.001, 0.01, 0.1, 0.3, 1.0, 3.0)
SIZES = {"plane": (6, 7, 10, 20, 100), "line": (3, 4, 10, 20, 100), "covariance": (3, 4, 10, 20)}
SPRING_CELLS = tuple(
    SpringCell(family=family, points=points, noise=noise)
    for family, sizes in SIZES.items()
    for points in sizes
    for noise in NOISES
)


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringObservation:
    """What is seen of one instance.

    listed: whether all 40 paths ended apart. equilibria, stable: real critical rotations, and those
    of them that are minima; 0 where they are not listed.
    """

    listed: bool
    equilibria: int = 0
    stable: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringCounts:
    """A cell with what was seen of its instances, (count,) each."""

    cell: SpringCell
    listed: NDArray[np.bool_]
    equilibria: NDArray[np.int64]
    stable: NDArray[np.int64]

    @property
    def counted(self) -> NDArray[np.int64]:
        """Numbers of equilibria of the instances that are listed."""
        return self.equilibria[self.listed]

    @property
    def several(self) -> int:
        """Instances with a stable equilibrium besides the optimum."""
        return int((self.stable[self.listed] > 1).sum())


def spring_problem(rng: np.random.Generator, cell: SpringCell) -> RegistrationProblem:
    """A random instance: clouds and motion of the paper's experiment, springs of the family."""
    made = gaussian_instances(rng, points=cell.points, sigma=0.0)
    noise, springs = SPRINGS[cell.family](rng, cell.points, cell.noise)
    return RegistrationProblem(made.sources[0], made.targets[0] + noise, **springs)


Drawn = tuple["NDArray[np.float64]", dict[str, Any]]


def _planes(rng: np.random.Generator, n: int, noise: float) -> Drawn:
    return noise * rng.standard_normal((n, 3)), {"normals": _directions(rng, n)}


def _lines(rng: np.random.Generator, n: int, noise: float) -> Drawn:
    return noise * rng.standard_normal((n, 3)), {"directions": _directions(rng, n)}


def _covariances(rng: np.random.Generator, n: int, noise: float) -> Drawn:
    """Axes at random, deviations from `noise` down to a hundredth; noise is drawn from them."""
    axes = np.linalg.qr(rng.standard_normal((n, 3, 3)))[0]
    share = np.exp(-rng.uniform(0.0, math.log(LONGEST), size=(n, 3)))
    drawn = noise * share * rng.standard_normal((n, 3))
    information = np.einsum("nij,nj,nkj->nik", axes, share**-2.0, axes)
    information = (information + information.transpose(0, 2, 1)) / 2.0
    return np.einsum("nij,nj->ni", axes, drawn), {"information": information}


SPRINGS: dict[str, Callable[[np.random.Generator, int, float], Drawn]] = {
    "plane": _planes,
    "line": _lines,
    "covariance": _covariances,
}


def _directions(rng: np.random.Generator, n: int) -> NDArray[np.float64]:
    rows = rng.standard_normal((n, 3))
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)


def observed(problem: RegistrationProblem) -> SpringObservation:
    """The equilibria of an instance, counted."""
    quartic = Springs(spring_moments(problem)).floating_quartic()[0]
    lines = critical_lines(quartic)
    if lines.outcome is not PathsOutcome.FOUND:
        return SpringObservation(listed=False)
    curvatures = FloatingQuartic.of(quartic).curvatures(lines.quaternions)[2]
    least = np.linalg.eigvalsh(curvatures)[:, 0]
    count = len(lines.quaternions)
    return SpringObservation(listed=True, equilibria=count, stable=int((least > 0.0).sum()))


def spring_counts(seed: int, runs: int | None, progress: StageProgress) -> tuple[SpringCounts, ...]:
    """Every cell measured on `runs` instances."""
    found: list[SpringCounts] = []
    for k, cell in enumerate(SPRING_CELLS):
        progress("springs", k, len(SPRING_CELLS))
        found.append(measured(cell, seed, runs or SPRING_INSTANCES))
    progress("springs", len(SPRING_CELLS), len(SPRING_CELLS))
    return tuple(found)


def measured(cell: SpringCell, seed: int, count: int) -> SpringCounts:
    """A cell: instance k is the same whatever the count, and however a campaign is cut up."""
    seen = [observed(spring_problem(generator(cell, seed, k), cell)) for k in range(count)]
    return SpringCounts(
        cell=cell,
        listed=np.array([each.listed for each in seen]),
        equilibria=np.array([each.equilibria for each in seen]),
        stable=np.array([each.stable for each in seen]),
    )


def generator(cell: SpringCell, seed: int, instance: int) -> np.random.Generator:
    """The random numbers of an instance; the same at every noise, so that it alone differs."""
    key = (list(SIZES).index(cell.family), cell.points, instance)
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=key))


def wilson(seen: int, count: int) -> tuple[float, float]:
    """The interval of a share, 95 %, by Wilson's score.

    >>> [round(x, 3) for x in wilson(0, 100)]
    [0.0, 0.037]
    """
    if not count:
        return 0.0, 1.0
    share, spread = seen / count, Z95**2 / count
    middle = share + spread / 2.0
    half = math.sqrt(spread * (share * (1.0 - share) + spread / 4.0))
    low, high = (middle - half) / (1.0 + spread), (middle + half) / (1.0 + spread)
    return max(0.0, low), min(1.0, high)


def spring_rows(counts: Sequence[SpringCounts]) -> Iterator[dict[str, Any]]:
    """A row for each cell, of the CSV file or the JSON document; None where nothing was listed."""
    for each in counts:
        cell, listed, known = each.cell, int(each.listed.sum()), each.counted
        low, high = wilson(each.several, listed)
        yield {
            "family": cell.family,
            "points": cell.points,
            "noise": cell.noise,
            "instances": len(each.listed),
            "listed": listed,
            "equilibria_least": int(known.min()) if listed else None,
            "equilibria_median": float(np.median(known)) if listed else None,
            "equilibria_most": int(known.max()) if listed else None,
            "stable_most": int(each.stable[each.listed].max()) if listed else None,
            "several_stable": each.several,
            "several_stable_low": low,
            "several_stable_high": high,
        }


def spring_table(counts: Sequence[SpringCounts]) -> bytes:
    """The rows as CSV with a header; nothing where a number is None."""
    text = io.StringIO()
    rows = list(spring_rows(counts))
    writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue().encode()
