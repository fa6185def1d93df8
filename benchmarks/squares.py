"""Certificates of general springs at 20 pairs, made and checked, beside CVXPY and Clarabel again.

CVXPY states the relaxation for each problem, as a script does; a solve of one that is stated once
is shown beside. Its value is no bound: how often it lies above the optimum is counted.
"""

from __future__ import annotations

import time
from fractions import Fraction
from functools import partial
from statistics import median
from typing import TYPE_CHECKING

from benchmarks.measuring import Figure, Quantity, fastest
from certreg.certificate.cones import springs_certificate
from certreg.objective.springs import Springs
from certreg.problem.problem import RegistrationProblem
from certreg.relaxation.cvxpy_models import quartic_statement, solve_stated
from certreg.relaxation.optimum import find_optimum
from certreg.verify import check
from tests.spring_families import Cell, instance, statement

if TYPE_CHECKING:
    from collections.abc import Iterator

    import numpy as np
    from numpy.typing import NDArray

    from certreg.relaxation.conic import ConicSolution

CELLS = [Cell(name, 20, 0.1) for name in ("plane", "line", "aniso", "gicp", "mixed", "wall")]
SEEDS, ROUNDS = range(3), 4
PRODUCED, CHECKED = 0.7, 1.2  # of a solve by CVXPY and Clarabel


def measure() -> Iterator[Figure]:
    made, checked, solved, once, above = [], [], [], [], 0
    problems = [_problem(cell, seed) for cell in CELLS for seed in SEEDS]
    for problem in problems:
        content = _produced(problem)
        found = find_optimum(Springs.of(problem))
        rest = found.levelled.rest
        again = partial(solve_stated, quartic_statement(), rest, "CLARABEL")
        works = partial(_produced, problem), partial(check, content), partial(_anew, rest), again
        times = fastest(*works, rounds=ROUNDS, clock=time.process_time)
        for row, seconds in zip((made, checked, solved, once), times, strict=True):
            row.append(seconds)
        q = found.quaternion
        norm = sum(c * c for c in q) ** 2
        optimum = Fraction(found.levelled.value(q), 24 * norm)
        above += (again().value or 0.0) > float(optimum / found.levelled.scale)
    for what, times, bound in (("produced", made, PRODUCED), ("checked", checked, CHECKED)):
        ratio = median([a / b for a, b in zip(times, solved, strict=True)])
        yield Figure(
            what=f"springs, N = 20: {what}",
            value=Quantity(ratio, "x"),
            bound=bound,
            beside={
                "certreg": Quantity(median(times), "s"),
                "CVXPY and Clarabel": Quantity(median(solved), "s"),
                "stated once": Quantity(median(once), "s"),
                "its value above the optimum": Quantity(above, f"of {len(problems)}"),
            },
        )


def _anew(quartic: NDArray[np.float64]) -> ConicSolution:
    return solve_stated(quartic_statement(), quartic, "CLARABEL")


def _problem(cell: Cell, seed: int) -> RegistrationProblem:
    return RegistrationProblem(**statement(instance(cell, seed)))


def _produced(problem: RegistrationProblem) -> bytes:
    """All of it, from the points to the bytes of the file."""
    objective = Springs.of(problem)
    certificate = springs_certificate(problem, objective, find_optimum(objective))
    return b"" if certificate is None else certificate.to_json()
