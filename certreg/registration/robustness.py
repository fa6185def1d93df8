"""How far the points may be off with the optimum proved to turn by no more than an angle."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TYPE_CHECKING

from certreg.certificate.radius import MOST_DEGREES, Radius
from certreg.errors import InvalidProblemError
from certreg.exact.decimals import at_most
from certreg.exact.dyadic import degrees_above, double_below, half_angle_bound
from certreg.registration.scale_range import proved_scales
from certreg.results import Absent, Brief

if TYPE_CHECKING:
    from certreg.certificate.isotropic import SimilarityBody
    from certreg.problem.moments import ExactMoments

ROBUSTNESS_ANGLE = 5.0  # degrees, unless another is asked for
NONE_PROVED = Absent("no error of the points is proved to be harmless, or that was not asked for")
DIGITS = 6  # of the angle, which is told in degrees


def checked_angle(degrees: float | None) -> float | None:
    """An angle of more than 0 and at most 90 degrees, or None; InvalidProblemError for others."""
    if degrees is None or 0.0 < degrees <= MOST_DEGREES:
        return degrees
    raise InvalidProblemError(
        f"the angle of robustness is {degrees!r} degrees: give more than 0, and at most 90",
        array="robustness_angle",
        value=degrees,
        limit=MOST_DEGREES,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Robustness(Brief):
    """Proved: as long as points are off by less, every optimum stays within the angle.

    Attributes
    ----------
    angle
        Degrees, from the certified rotation.
    target
        Every target point may be off by less than this length, in the unit of the target.
    both
        Or every point of both clouds by less than this one. Both are sufficient, not sharp; the
        springs stay as they are.
    scales
        Between which numbers a free scale stays meanwhile, rounded outwards, by what is off; None
        where nothing bounds it. Empty where the scale is not free.
    """

    angle: float
    target: float
    both: float
    scales: Mapping[str, tuple[float, float] | None] = field(
        default_factory=dict[str, tuple[float, float] | None], repr=False
    )

    @property
    def scale_target(self) -> tuple[float, float] | None:
        """Between which a free scale stays while target points are off; None where nothing says."""
        return self.scales.get("target")

    @property
    def scale_both(self) -> tuple[float, float] | None:
        """The same while points of both clouds are off."""
        return self.scales.get("both")

    @classmethod
    def of(cls, radius: Radius) -> Robustness:
        """What a certificate claims, lengths rounded down and the angle up."""
        angle = half_angle_bound(radius.sin_half_angle.value**2)
        return cls(
            angle=float(at_most(degrees_above(angle), DIGITS)),
            target=double_below(radius.target.value),
            both=double_below(radius.both.value),
        )

    def with_scales(self, body: SimilarityBody, moments: ExactMoments) -> Robustness:
        """The same of a problem whose scale is free; body: of its certificate."""
        target, both = Fraction(self.target), Fraction(self.both)
        scales = {
            "target": proved_scales(body, moments, source=Fraction(0), target=target),
            "both": proved_scales(body, moments, source=both, target=both),
        }
        return replace(self, scales=scales)
