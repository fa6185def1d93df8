"""The least squares over some of the pairs, those that are met: with what was asked of it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from certreg._loading import late
from certreg.registration.certification import certified
from certreg.results import Absent, Limits

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.dynamics.integrators import SimulationSettings
    from certreg.problem.problem import RegistrationProblem
    from certreg.registration import spring_certification
    from certreg.registration.result import Registration
    from certreg.registration.row_names import RowNames
    from certreg.registration.spring_result import SpringRegistration
else:  # not of one weight per pair
    spring_certification = late("certreg.registration.spring_certification")

BY_NAME = Absent(
    "with --max-residual it is taken only where it is named, of the pairs within: --solver NAME "
    "(relaxation), --integrator NAME (simulation)"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class FitSettings:
    """What is asked of the least squares, as of any registration.

    solver, integrator: of relaxation and simulation, by name; None: not taken. simulation: further
    settings. limits: within which the pose is called certified; None for the usual ones.
    """

    solver: str | None = None
    integrator: str | None = None
    simulation: SimulationSettings | None = None
    robustness_angle: float | None = None
    limits: Limits | None = None


USUAL = FitSettings()


def fitted(
    problem: RegistrationProblem, rows: Sequence[int], names: RowNames, settings: FitSettings
) -> Registration | SpringRegistration:
    """The registration of a problem whose pairs are some of others: `rows` says which.

    names: of the rows of all.
    """
    about: dict[str, Any] = {"rows": list(rows)}
    if names.labels is not None:
        about["labels"] = [names.labels[row] for row in rows]
    limits = settings.limits or Limits()
    if problem.factors is not None:
        return spring_certification.certified_springs(
            problem,
            solver=settings.solver,
            robustness_angle=settings.robustness_angle,
            about=about,
            limits=limits,
        )
    fit = certified(
        problem,
        relaxation=settings.solver or False,
        integrator=settings.integrator,
        settings=settings.simulation,
        robustness_angle=settings.robustness_angle,
        about=about,
        not_taken=BY_NAME,
    )
    return replace(fit, limits=limits)
