"""How far the points may be off with the optimum proved to turn by no more than an angle."""

from __future__ import annotations

from dataclasses import dataclass, replace
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
    scale_target, scale_both
        Between which numbers a free scale stays meanwhile, rounded outwards; None where nothing
        bounds it, and where the scale is not free.
    """

    angle: float
    target: float
    both: float
    scale_target: tuple[float, float] | None = None
    scale_both: tuple[float, float] | None = None

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
        return replace(
            self,
            scale_target=proved_scales(body, moments, source=Fraction(0), target=target),
            scale_both=proved_scales(body, moments, source=both, target=both),
        )
