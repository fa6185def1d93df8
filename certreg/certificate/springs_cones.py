"""Certificates of kind "springs-cones": the optimal pose of general springs, by cones and caps.

Its theorems are in `certreg.verify`; `cones` finds what proves them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

from certreg.certificate.springs_sos import SpringsBody
from certreg.exact.dyadic import Dyadic
from certreg.verify import CAPS_MAX

if TYPE_CHECKING:
    from fractions import Fraction


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringsConesBody(SpringsBody):
    """A proof that a pose of general springs is optimal up to bounds, by cones and caps.

    delta, mu: the objective exceeds its value here less delta by mu sin^2(theta/2), theta the angle
        to that rotation; in units of the energy. delta is the claimed gap.
    caps: of each six integers: a quaternion, at whose rotation the Hessian of the objective, in
        rotation angle, exceeds curvature I; mantissa and exponent of the curvature.
    """

    KIND: ClassVar[str] = "springs-cones"
    PLACES: ClassVar = {**SpringsBody.PLACES, "mu": "proof.mu", "caps": "proof.caps"}

    mu: Dyadic
    caps: Annotated[tuple[int, ...], range(0, 6 * CAPS_MAX + 1, 6)]

    @property
    def delta(self) -> Dyadic:
        """The objective exceeds its value here less this by mu sin^2(theta/2)."""
        return self.claims.gap

    @property
    def growth(self) -> Fraction:
        """The objective exceeds its value here less `gap` by this times sin^2(theta/2)."""
        return self.mu.value
