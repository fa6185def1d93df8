"""Certificates of general springs for tests: made once for each cell and seed."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

from spring_families import Cell, instance, statement

from certreg import simulate
from certreg.certificate.cones import springs_certificate
from certreg.objective.springs import Springs
from certreg.problem.problem import RegistrationProblem
from certreg.registration.valley import SimulatedSprings
from certreg.relaxation.optimum import find_optimum


@dataclass(frozen=True, eq=False)
class Certified:
    """A problem of a cell with its certificate."""

    problem: Any
    objective: Springs
    certificate: Any  # of a sum of squares; None where no proof was found


def certificate_of(problem: RegistrationProblem, **asked: Any) -> Any:
    """By a sum of squares."""
    objective = Springs.of(problem)
    return springs_certificate(problem, objective, find_optimum(objective), **asked)


@cache
def certified(family: str, n: int, noise: float, seed: int = 0) -> Certified:
    """A problem of a family, and its certificate."""
    problem = RegistrationProblem(**statement(instance(Cell(family, n, noise), seed)))
    return Certified(problem, Springs.of(problem), certificate_of(problem))


def moved_springs(problem: RegistrationProblem, integrator: str | None = None) -> SimulatedSprings:
    """The simulated motion of a problem of general springs."""
    run = simulate(problem, integrator)
    assert isinstance(run, SimulatedSprings)
    return run
