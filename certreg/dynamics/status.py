"""How simulations end: each value is the message shown to the user."""

from __future__ import annotations

import enum
from typing import TYPE_CHECKING

from certreg.native.loops import Ending

if TYPE_CHECKING:
    from collections.abc import Mapping


class Status(enum.Enum):
    """How a simulation ended."""

    @property
    def at_rest(self) -> bool:
        """Whether the body came to rest."""
        return self.name in {"CONVERGED", "AT_REST"}


class SimulationStatus(Status):
    """Of a body on springs of one weight per pair."""

    CONVERGED = (
        "The body is at rest (slower than the tolerance), its rotation with too little energy to "
        "leave the optimum."
    )
    AT_REST = (
        "The body is at rest (slower than the tolerance); where no optimum is unique, no more is "
        "asked."
    )
    OUT_OF_STEPS = (
        "The steps ran out before the body was at rest at the optimum. The certificate does not "
        "depend on it."
    )


class SpringStatus(Status):
    """Of a body on general springs."""

    AT_REST = (
        "The body is at rest: slower than the tolerance, in a valley of the energy. Which one it "
        "is does not follow from that."
    )
    OUT_OF_STEPS = "The steps ran out before the body was at rest."


class BreathingStatus(Status):
    """Of a body with a free scale."""

    AT_REST = (
        "The body is at rest: slower than the tolerance, where the energy falls in no direction."
    )
    COLLAPSED = (
        "The scale falls to 0, where the inertia vanishes and the motion is not defined: stopped "
        "before it. Begin with less energy, nearer to the target in size and rotation."
    )
    OUT_OF_STEPS = "The steps ran out before the body was at rest."


def by_ending(statuses: type[Status]) -> Mapping[int, Status]:
    """What each ending of the loops means for a body."""
    return {Ending[status.name]: status for status in statuses}
