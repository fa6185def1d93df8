"""Certificates of all equilibria: how many are produced and accepted, how long that takes.

    make rates NAME=list_certificates ARGS="[INSTANCES]"

Of each cell of `spring_families.LISTED`. A part of it is in the tests.
"""

from __future__ import annotations

import statistics
import sys
import time
from importlib import import_module
from typing import TYPE_CHECKING

from spring_families import LISTED, instance, statement

from certreg.certificate.listing import springs_list_certificate
from certreg.equilibrium.paths import critical_lines
from certreg.objective.springs import Springs
from certreg.problem.problem import RegistrationProblem

if TYPE_CHECKING:
    from spring_families import Cell


checker = import_module("certreg.verify")
INSTANCES = 25
FIRST = 100  # seeds of which no test makes use


def rates(cell: Cell, instances: int) -> str:
    """Accepted by the checker, of how many; medians of CPU time."""
    accepted, made, checked = 0, list[float](), list[float]()
    for seed in range(FIRST, FIRST + instances):
        problem = RegistrationProblem(**statement(instance(cell, seed)))
        objective = Springs.of(problem)
        lines = critical_lines(objective.floating_quartic()[0])
        start = time.process_time()
        certificate = springs_list_certificate(problem, objective, lines)
        made.append(time.process_time() - start)
        if certificate is not None:
            content = certificate.to_json()
            start = time.process_time()
            accepted += checker.check(content).verified
            checked.append(time.process_time() - start)
            signs = sum((-1) ** index for index in certificate.body.claims.indices)
            if signs:
                raise AssertionError(
                    f"{cell}, seed {seed}: the signs of the indices add to {signs}"
                )
    times = [1e3 * statistics.median(part or [0.0]) for part in (made, checked)]
    return (
        f"{accepted} of {instances} accepted; made in {times[0]:.1f} ms, checked in {times[1]:.0f}"
    )


def main() -> None:
    """Print a line for each cell."""
    instances = int(sys.argv[1]) if len(sys.argv) > 1 else INSTANCES
    for cell in LISTED:
        sys.stdout.write(f"{cell!s:<18} {rates(cell, instances)} ms of CPU\n")


if __name__ == "__main__":
    main()
