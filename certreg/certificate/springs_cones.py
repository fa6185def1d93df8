"""Certificates of kind "springs-cones": the optimal pose of general springs, by cones and caps.

Its theorems are in `certreg.verify`; `cones` finds what proves them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

from certreg.certificate.file_parts import FilePart
from certreg.certificate.radius import Radius
from certreg.certificate.springs_sos import SpringsClaims
from certreg.exact import Dyadic
from certreg.verify import CAPS_MAX

if TYPE_CHECKING:
    from fractions import Fraction


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringsConesBody(FilePart):
    """A proof that a pose of general springs is optimal up to bounds, by cones and caps.

    quaternion: integers (w, x, y, z), the certified rotation is R(q) of the unit vector along it.
    delta, mu: the objective exceeds its value here less delta by mu sin^2(theta/2), theta the angle
        to that rotation; in units of the energy. delta is the claimed gap.
    caps: of each six integers: a quaternion, at whose rotation the Hessian of the objective, in
        rotation angle, exceeds curvature I; mantissa and exponent of the curvature.
    symmetry: turns (a, b) of world and body that keep the objective; where there are many optima.
    radius: how far points may move before an optimum turns by more than an angle.
    """

    KIND: ClassVar[str] = "springs-cones"
    PLACES: ClassVar = {
        "quaternion": "proof.pose",
        "mu": "proof.mu",
        "caps": "proof.caps",
        "symmetry": "proof.symmetry",
        "radius": "radius?",
    }

    quaternion: tuple[int, int, int, int]
    mu: Dyadic
    caps: Annotated[tuple[int, ...], range(0, 6 * CAPS_MAX + 1, 6)]
    claims: SpringsClaims
    symmetry: Annotated[tuple[int, ...], (6,)] | None = None
    radius: Radius | None = None

    @property
    def delta(self) -> Dyadic:
        """The objective exceeds its value here less this by mu sin^2(theta/2)."""
        return self.claims.gap

    @property
    def gap(self) -> Fraction:
        """The claimed bound on objective(R(q)) - minimum."""
        return self.claims.gap.value

    @property
    def growth(self) -> Fraction:
        """The objective exceeds its value here less `gap` by this times sin^2(theta/2)."""
        return self.mu.value
