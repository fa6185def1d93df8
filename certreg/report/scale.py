"""What is said of a free scale: its value, its unit, what noise does to it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._loading import late
from certreg.exact.decimals import at_least, at_most
from certreg.geometry.similarity import Similarity
from certreg.problem.motion import Scale
from certreg.registration.covariance import NO_SCALE
from certreg.report.parts import listed
from certreg.results import Absent

if TYPE_CHECKING:
    from certreg.geometry.pose import Pose
    from certreg.registration import equilibria, gap_parts
    from certreg.registration.equilibria import ScaledEquilibria
    from certreg.registration.result import Registration
else:
    # of which few results have a free scale
    equilibria = late("certreg.registration.equilibria")
    gap_parts = late("certreg.registration.gap_parts")


SCALE_ZERO = (
    "                    0: the clouds do not correspond (the cross-covariance is zero), so that "
    "the best fit is one point"
)
BIAS = {
    Scale.ASYMMETRIC: "noise in the source makes it too small; noise in the target does not",
    Scale.SYMMETRIC: "right where both clouds have the same relative noise, too large with noise "
    "in the target alone",
}
ALL_DIGITS = 17  # of a double


def scale_of(pose: Pose | Similarity) -> float | Absent:
    """Of a similarity, or why a pose has none."""
    return pose.scale if isinstance(pose, Similarity) else NO_SCALE


def scale_lines(registration: Registration) -> list[str]:
    """In the terminal; none where the scale is not free."""
    kind, scale, own = registration.problem.scale, scale_of(registration.pose), listed(registration)
    if isinstance(scale, Absent) or own is None:
        return []
    unit = gap_parts.unit_of(own)
    return [
        f"  scale             {scale!r}  ({kind.value}; target over source)",
        *([SCALE_ZERO] if scale == 0.0 else []),
        *([] if unit is None else [f"                    {unit}"]),
        f"                    {BIAS[kind]}",
    ]


def rests_of(registration: Registration) -> ScaledEquilibria | None:
    """All equilibria with their scales; None where the scale is not free."""
    if registration.problem.scale not in BIAS:
        return None
    return equilibria.scaled_equilibria(registration.solution.objective, registration.equilibria)


def printed_interval(bounds: tuple[float, float]) -> tuple[str, str]:
    """Two proved numbers in words, rounded outwards: all digits of a double may not be enough."""
    low, high = bounds
    return at_least(low, ALL_DIGITS), at_most(high, ALL_DIGITS)
