"""Certificates of general springs for tests: made once for each cell, seed and solver."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from spring_families import Cell, instance, statement

from certreg.certificate import Certificate, springs_certificate
from certreg.finding import find_optimum
from certreg.objective import Springs
from certreg.problem import RegistrationProblem, spring_moments


@dataclass(frozen=True, eq=False)
class Certified:
    """A problem of a cell with its certificate, None where no proof was found."""

    problem: RegistrationProblem
    objective: Springs
    certificate: Certificate | None


@cache
def certified(family: str, n: int, noise: float, seed: int = 0) -> Certified:
    problem = RegistrationProblem(**statement(instance(Cell(family, n, noise), seed)))
    objective = Springs(spring_moments(problem))
    certificate = springs_certificate(problem, objective, find_optimum(objective))
    return Certified(problem, objective, certificate)
