"""Words and documents of results that hold what is shown: lists of equilibria, a motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._loading import late
from certreg.registration.simulation import proved_end
from certreg.report.document import equilibria_document, simulation_document
from certreg.report.methods import enumeration_summary
from certreg.report.summary import simulation_summary

if TYPE_CHECKING:
    from certreg.registration.enumeration import ListedEquilibria
    from certreg.registration.simulation import ProblemTrajectory, SimulatedRegistration
    from certreg.registration.spring_equilibria import ListedSpringEquilibria
    from certreg.report import spring_equilibria
    from certreg.report.encoding import Document
else:
    spring_equilibria = late("certreg.report.spring_equilibria")


def _simulated(trajectory: ProblemTrajectory) -> SimulatedRegistration:
    return proved_end(trajectory)


def trajectory_words(trajectory: ProblemTrajectory) -> str:
    """The text of a simulated motion."""
    return simulation_summary(_simulated(trajectory))


def trajectory_document(trajectory: ProblemTrajectory) -> Document:
    """Its document."""
    return simulation_document(_simulated(trajectory))


def enumeration_words(listed: ListedEquilibria) -> str:
    """The text of a list of equilibria."""
    return enumeration_summary(listed.enumeration)


def enumeration_document(listed: ListedEquilibria) -> Document:
    """Its document."""
    return equilibria_document(listed.enumeration)


def spring_enumeration_words(listed: ListedSpringEquilibria) -> str:
    """The text of a list of equilibria on general springs."""
    return spring_equilibria.spring_enumeration_summary(listed.enumeration)


def spring_enumeration_document(listed: ListedSpringEquilibria) -> Document:
    """Its document."""
    return spring_equilibria.spring_equilibria_document(listed.enumeration)
