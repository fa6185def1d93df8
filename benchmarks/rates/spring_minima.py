"""The best of several local minima, on minimal problems: six planes, three lines.

    make rates NAME=spring_minima ARGS="[INSTANCES]"

Their energies have up to eight local minima, several of them exact optima where there is no noise.
For each instance what `find_optimum` gives is held to the complete list: 40 ends, all different,
tracked in NumPy from another start with shorter steps; and to descents from random rotations. A
part of it is in the tests.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any
from unittest import mock

import numpy as np
import spring_families

from certreg import RegistrationProblem
from certreg.equilibrium import paths
from certreg.equilibrium.paths import PathsOutcome, critical_lines
from certreg.equilibrium.quartics import FloatingQuartic, descended
from certreg.geometry.so3 import squared_norm
from certreg.objective.springs import Springs
from certreg.relaxation.optimum import find_optimum

INSTANCES = 500
CELLS = (*spring_families.MINIMAL, *(replace(c, noise=0.05) for c in spring_families.MINIMAL))
STARTS = 200  # random rotations
AS_GOOD = 1e-12  # of the largest coefficient: doubles beside an exact value
SEED = 7


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """One instance.

    complete: the list of 40 was. excess: of the optimum found over the best of the list;
    by_descent: over the best of the random starts; both over the largest coefficient.
    several: there are local minima of different energies.
    """

    complete: bool
    tight: bool
    excess: float
    by_descent: float
    several: bool
    seconds: float

    @property
    def missed(self) -> bool:
        return self.excess > AS_GOOD or self.by_descent > AS_GOOD


def outcome_of(cell: Any, seed: int) -> Outcome:
    """What became of one instance of a cell."""
    made = spring_families.instance(cell, seed)
    problem = RegistrationProblem(**spring_families.statement(made))
    objective = Springs.of(problem)
    assert objective.quartic  # made before the clock starts
    begun = time.process_time()
    found = find_optimum(objective)
    seconds = time.process_time() - begun
    levelled = found.levelled
    value = Fraction(levelled.value(found.quaternion), squared_norm(found.quaternion) ** 2)
    value /= 1 << levelled.bits
    form = FloatingQuartic.of(levelled.rest)
    with (
        mock.patch.object(paths, "quartic_paths", return_value=None),
        mock.patch.object(paths, "SEED", SEED),
    ):
        lines = critical_lines(levelled.rest, tracker=paths.SETTINGS.careful())
    least = form.values(lines.quaternions).min(initial=np.inf)
    starts = np.random.default_rng(seed).normal(size=(STARTS, 4))
    lowest = descended(form, starts).values
    return Outcome(
        complete=lines.outcome is PathsOutcome.FOUND,
        tight=found.lines is None,
        excess=float(value) - float(least),
        by_descent=float(value) - float(lowest.min()),
        several=float(np.ptp(lowest)) > AS_GOOD,
        seconds=seconds,
    )


def main(count: int = INSTANCES) -> int:
    """All cells; 1 where the best was missed."""
    missed = 0
    for cell in CELLS:
        outcomes = [outcome_of(cell, seed) for seed in range(count)]
        counts = Counter(
            name
            for each in outcomes
            for name in ("complete", "tight", "several", "missed")
            if getattr(each, name)
        )
        milliseconds = 1e3 * float(np.median([each.seconds for each in outcomes]))
        missed += counts["missed"]
        sys.stdout.write(
            f"{cell!s:20} {count} instances: complete list {counts['complete']}, several minima "
            f"{counts['several']}, tight {counts['tight']}, best missed {counts['missed']}, "
            f"median {milliseconds:.1f} ms\n"
        )
        sys.stdout.flush()
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
