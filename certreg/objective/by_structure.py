"""The objective of a problem, by its structure."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from certreg._loading import found_late
from certreg.objective.structure import Structure

if TYPE_CHECKING:
    from certreg.objective.isotropic import Isotropic
    from certreg.objective.springs import Springs
    from certreg.problem.problem import RegistrationProblem

OBJECTIVES: Mapping[Structure, Callable[[], type[Isotropic | Springs]]] = {
    Structure.LINEAR: found_late("certreg.objective.isotropic", "Isotropic"),
    Structure.QUARTIC: found_late("certreg.objective.springs", "Springs"),
}


def objective_of(problem: RegistrationProblem) -> Isotropic | Springs:
    """The energy of a problem as a function of the rotation, by its structure.

    Raises DegenerateProblemError where its scale is free, and the points tell none.
    """
    return OBJECTIVES[Structure.of(problem.cell)]().of(problem)
