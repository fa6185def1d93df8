"""Which parts a registration has: asked of what is there, not of which kind it is."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

if TYPE_CHECKING:
    from certreg.registration.labelled import LabelledRegistration
    from certreg.registration.linear import LinearSolution
    from certreg.registration.quartic import QuarticSolution
    from certreg.registration.result import Registration


def listed(registration: Registration) -> Registration[LinearSolution] | None:
    """With all equilibria and a closed form; None where no equilibria are listed."""
    return None if registration.equilibria is None else registration


def sprung(registration: Registration) -> Registration[QuarticSolution] | None:
    """With a spring of its own for each pair; None where pairs weigh alone."""
    if registration.problem.springs is None:
        return None
    return cast("Registration[QuarticSolution]", registration)


def labelled(result: Registration | LabelledRegistration) -> LabelledRegistration | None:
    """With a label for each pair, as some may be wrong; None where all count."""
    return None if result.labels is None else cast("LabelledRegistration", result)
