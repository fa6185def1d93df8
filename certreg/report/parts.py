"""Which parts a registration has: asked of what is there, not of which kind it is."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

if TYPE_CHECKING:
    from certreg.registration import AnyRegistration, Registration, SpringRegistration


def listed(registration: AnyRegistration) -> Registration | None:
    """With all equilibria and a closed form; None where no equilibria are listed."""
    return None if registration.equilibria is None else cast("Registration", registration)


def sprung(registration: AnyRegistration) -> SpringRegistration | None:
    """With a spring of its own for each pair; None where pairs weigh alone."""
    if registration.problem.springs is None:
        return None
    return cast("SpringRegistration", registration)
