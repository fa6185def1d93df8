"""Which parts a registration has: asked of what is there, not of which kind it is."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

if TYPE_CHECKING:
    from certreg.registration.consensus import ConsensusRegistration
    from certreg.registration.linear import LinearSolution
    from certreg.registration.quartic import QuarticSolution
    from certreg.registration.result import Registration
    from certreg.registration.truncated import TruncatedRegistration

    Labelled = ConsensusRegistration | TruncatedRegistration


def listed(registration: Registration) -> Registration[LinearSolution] | None:
    """With all equilibria and a closed form; None where no equilibria are listed."""
    return None if registration.equilibria is None else registration


def sprung(registration: Registration) -> Registration[QuarticSolution] | None:
    """With a spring of its own for each pair; None where pairs weigh alone."""
    if registration.problem.springs is None:
        return None
    return cast("Registration[QuarticSolution]", registration)


def labelled(result: Registration | Labelled) -> Labelled | None:
    """With a label for each pair, as some may be wrong; None where all count."""
    return None if result.labels is None else cast("Labelled", result)


def counted(result: Labelled) -> ConsensusRegistration | None:
    """With the most pairs that one motion brings within; None where none are counted."""
    return cast("ConsensusRegistration", result) if hasattr(result, "upper") else None


def costed(result: Labelled) -> TruncatedRegistration | None:
    """With the least truncated cost; None where none is sought."""
    return cast("TruncatedRegistration", result) if hasattr(result, "cost") else None
