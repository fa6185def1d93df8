"""How many labels of random problems with wrong pairs are proved, and in what time.

    make rates NAME=consensus_labels ARGS="[COUNT [CELLS]]"

COUNT problems of each cell, 50 unless told, of the law of `outlier_instance`; with CELLS, as
"100,500", those of so many pairs alone. Figures go to benchmarks/acceptance/consensus.json, cell by
cell; a cell that is there with as many problems, of the same commit, is not measured again. Times
are of the processor, medians of milliseconds.
"""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
import time
from dataclasses import asdict, dataclass
from importlib import import_module
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Any

import numpy as np

from benchmarks.rates.consensus_poses import graduated_nonconvexity
from certreg.certificate.producing_consensus import ConsensusProver
from certreg.errors import InvalidProblemError
from certreg.geometry.so3 import rotation_matrix
from certreg.problem.bounds import bounded
from certreg.problem.problem import RegistrationProblem
from certreg.registration.consensus import PROVER, proved_consensus
from certreg.registration.pipeline import Asked, Work

if TYPE_CHECKING:
    from numpy.typing import NDArray


checker = import_module("certreg.verify")
ROOT = Path(__file__).resolve().parents[2]
RESULTS = ROOT / "benchmarks" / "acceptance" / "consensus.json"
COUNT = 50  # of each cell
SIGMA, BETA = 0.01, 5.54  # of the noise; of the bound, in sigmas
CHECKED = 5  # problems of a cell whose certificates are checked: seconds each of 1,000 pairs
MOST_BYTES = 100_000
SMALL = 100  # pairs: proving takes no longer than GNC alone, checking a tenth of a second


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class OutlierInstance:
    """Pairs of which some are wrong, with the motion of the others: y = R x + t + noise.

    source, target: (N, 3), row i to row i. wrong: (N,), which pairs. rotation: (3, 3), target from
    source; translation: (3,).
    """

    source: NDArray[np.float64]
    target: NDArray[np.float64]
    wrong: NDArray[np.bool_]
    rotation: NDArray[np.float64]
    translation: NDArray[np.float64]


def outlier_instance(
    rng: np.random.Generator, *, points: int, outliers: int, sigma: float = SIGMA
) -> OutlierInstance:
    """Points of the unit cube, moved at random with noise; of so many pairs the target is wrong.

    x uniform in [0, 1]^3, R uniform on SO(3), t uniform in [-1, 1]^3, y = R x + t + e with
    e ~ N(0, sigma^2 I), not cut at any bound. Wrong targets are uniform in the ball about the mean
    of the right ones whose radius is half the diagonal of the cube. Rows are in random order.

    Raises InvalidProblemError where no pair is right, or sigma is negative or not finite.

    >>> made = outlier_instance(np.random.default_rng(0), points=50, outliers=40)
    >>> int(made.wrong.sum())
    40
    """
    if not 0 <= outliers < points or not 0.0 <= sigma < math.inf:
        message = (
            f"{outliers} of {points} pairs are wrong, with sigma {sigma!r}: give at least one that "
            "is right, and a finite standard deviation >= 0"
        )
        wrong = ("outliers", outliers) if not 0 <= outliers < points else ("sigma", sigma)
        raise InvalidProblemError(message, array=wrong[0], value=wrong[1])
    source = rng.random((points, 3))
    q = rng.standard_normal(4)
    rotation = np.array(rotation_matrix((q / math.sqrt((q * q).sum())).tolist()))
    translation = rng.uniform(-1.0, 1.0, 3)
    target = sigma * rng.standard_normal((points, 3)) + translation
    for column in range(3):
        target += source[:, column, np.newaxis] * rotation[:, column]
    wrong = rng.permutation(points) < outliers
    directions = rng.standard_normal((outliers, 3))
    lengths = np.sqrt((directions * directions).sum(axis=1))
    radii = math.sqrt(3.0) / 2.0 * np.cbrt(rng.random(outliers))
    target[wrong] = target[~wrong].mean(axis=0) + directions * (radii / lengths)[:, np.newaxis]
    return OutlierInstance(
        source=source, target=target, wrong=wrong, rotation=rotation, translation=translation
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Cell:
    """Problems of one kind; wrong: percent of the pairs. beta: of sigma."""

    n: int
    wrong: int
    sigma: float = SIGMA
    beta: float = BETA

    @property
    def name(self) -> str:
        """As it is told."""
        return f"N={self.n} {self.wrong}% sigma={self.sigma:g} beta={self.beta:g}"

    def instance(self, seed: int) -> OutlierInstance:
        """One of its problems."""
        rng = np.random.default_rng([self.n, self.wrong, seed])
        wrong = round(self.n * self.wrong / 100)
        return outlier_instance(rng, points=self.n, outliers=wrong, sigma=self.sigma)

    def problem(self, made: OutlierInstance) -> RegistrationProblem:
        """The same with its bounds."""
        points = RegistrationProblem(made.source, made.target)
        return bounded(points, self.beta * self.sigma)


PLAIN = {
    20: (0, 30, 50),
    50: (0, 50, 80),
    100: (0, 50, 80, 90, 95, 99),
    500: (50, 80, 90, 95),
    1000: (50, 80, 90),
}
CELLS = (
    *(Cell(n=n, wrong=wrong) for n, all_wrong in PLAIN.items() for wrong in all_wrong),
    *(Cell(n=100, wrong=wrong, beta=3.0) for wrong in (50, 80, 90)),
    *(Cell(n=100, wrong=wrong, sigma=0.03) for wrong in (50, 80, 90)),
)
# The least shares of labels and of outliers that are proved: of n pairs, up to so much percent.
LEAST_SHARES = {
    20: {50: (0.99, 0.0)},
    50: {80: (0.95, 0.0)},
    100: {80: (0.95, 0.0), 90: (0.88, 0.0)},
    500: {50: (0.92, 0.999), 80: (0.9, 0.999), 90: (0.87, 0.999), 95: (0.75, 0.999)},
    1000: {90: (0.8, 0.995)},
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Rate:
    """What became of the problems of a cell.

    labels: share of those with all labels proved; outliers: of the pairs that the witness does not
    meet; best: share where no motion meets more, proved. gnc: graduated non-convexity alone;
    proving: the graph and the proof with the best motion as witness; together: with finding it;
    checking: of the first few. size: bytes of the longest certificate.
    """

    cell: str
    count: int
    labels: float
    outliers: float
    best: float
    gnc: float
    proving: float
    together: float
    checking: float
    size: int
    commit: str
    load: float


def rate_of(cell: Cell, count: int, checked: int = CHECKED) -> Rate:
    """The first so many problems of a cell."""
    labels, best, outside, proved = 0, 0, 0, 0
    times: dict[str, list[float]] = {"gnc": [], "proving": [], "together": [], "checking": [0.0]}
    size = 0
    for seed in range(count):
        made = cell.instance(seed)
        problem = cell.problem(made)
        start = time.process_time()
        graduated_nonconvexity(made.source, made.target, problem.bounds)
        times["gnc"].append(time.process_time() - start)
        start = time.process_time()
        prover = ConsensusProver(problem)
        graph = time.process_time() - start
        found = proved_consensus(problem, prover, 1.0)
        times["together"].append(time.process_time() - start)
        if found is None:
            outside += round(cell.n * cell.wrong / 100)
            continue
        start = time.process_time()
        prover.witnessed(found.witness)
        times["proving"].append(graph + time.process_time() - start)
        labels += found.decided
        best += found.upper == len(found.met)
        outside += cell.n - len(found.met)
        proved += found.labels.count("o")
        if seed < checked:
            seconds, length = checking(problem)
            times["checking"].append(seconds)
            size = max(size, length)
    if checked and len(times["checking"]) > 1:
        times["checking"].remove(0.0)
    return Rate(
        cell=cell.name,
        count=count,
        labels=labels / count,
        outliers=proved / outside if outside else 1.0,
        best=best / count,
        size=size,
        commit=commit(),
        load=os.getloadavg()[0],
        **{name: 1e3 * median(seconds or [0.0]) for name, seconds in times.items()},
    )


def checking(problem: RegistrationProblem) -> tuple[float, int]:
    """Seconds that the checker takes, and the bytes of the certificate."""
    made = PROVER.certified(problem, Asked(), Work())
    text = made.certificate.to_json()
    start = time.process_time()
    outcome = checker.check(text)
    seconds = time.process_time() - start
    if not outcome.verified:
        raise AssertionError(outcome.reason)
    return seconds, len(text)


def misses(cell: Cell, rate: Rate) -> list[str]:
    """What is not as it must be: names of fields."""
    missed = list[str]()
    if (cell.sigma, cell.beta) != (SIGMA, BETA):
        return missed
    limits = [of for wrong, of in LEAST_SHARES[cell.n].items() if cell.wrong <= wrong]
    if not limits:  # told, whatever it is
        return missed
    missed += ["labels"] * (rate.labels < limits[0][0])
    missed += ["outliers"] * (rate.outliers < limits[0][1])
    if cell.wrong:
        factor = 1.0 if cell.n <= SMALL else 5.0
        missed += ["proving"] * (rate.proving > factor * rate.gnc and cell.n != 500)
        missed += ["together"] * (rate.together > 10.0 * rate.gnc)
    limit = 100.0 if cell.n <= SMALL else 4000.0
    missed += ["checking"] * (rate.checking > limit)
    return missed + ["size"] * (rate.size > MOST_BYTES)


def line(cell: Cell, rate: Rate) -> str:
    """A row of the table."""
    missed = misses(cell, rate)
    return (
        f"{cell.name:34}{rate.labels:7.0%}{rate.outliers:9.2%}{rate.best:6.0%}{rate.gnc:7.1f}"
        f"{rate.proving / rate.gnc:7.1f}{rate.together / rate.gnc:8.1f}{rate.checking:8.0f}"
        f"{rate.size / 1e3:6.0f}  {'missed: ' + ', '.join(missed) if missed else ''}".rstrip()
    )


HEAD = (
    f"{'cell':34}{'labels':>7}{'outliers':>9}{'best':>6}{'GNC ms':>7}{'prove':>7}{'together':>8}"
    f"{'check ms':>9}{'kB':>5}  (prove, together: times GNC)"
)


def commit() -> str:
    """Of the checkout."""
    command = ["git", "rev-parse", "--short=12", "HEAD"]
    told = subprocess.run(command, cwd=ROOT, capture_output=True, encoding="utf-8", check=False)
    return told.stdout.strip()


def main(count: int = COUNT, sizes: str = "", results: Path = RESULTS) -> int:
    """Print and keep a line for each cell; 1 if one is not as it must be."""
    kept: dict[str, Any] = json.loads(results.read_text("utf-8")) if results.exists() else {}
    some = [int(size) for size in sizes.split(",") if size]
    bad, now = 0, commit()
    sys.stdout.write(f"{HEAD}\n")
    for cell in CELLS:
        if some and cell.n not in some:
            continue
        old = kept.get(cell.name)
        if old and old["count"] >= count and old["commit"] == now:
            rate = Rate(**old)
        else:
            rate = rate_of(cell, count)
            kept[cell.name] = asdict(rate)
            results.parent.mkdir(parents=True, exist_ok=True)
            results.write_text(json.dumps(kept, indent=1) + "\n", "utf-8")
        bad += bool(misses(cell, rate))
        sys.stdout.write(f"{line(cell, rate)}\n")
        sys.stdout.flush()
    sys.stdout.write(f"{bad} cells missed\n")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(int((*sys.argv[1:2], COUNT)[0]), (*sys.argv[2:3], "")[0]))
