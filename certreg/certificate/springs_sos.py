"""Certificates of kind "springs-sos": the optimal pose of general springs, by a sum of squares.

Its theorems are in `certreg.verify`; `squares` finds what proves them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

from certreg.certificate.file_parts import FilePart
from certreg.certificate.radius import Radius
from certreg.exact.dyadic import Dyadic

if TYPE_CHECKING:
    from fractions import Fraction


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringsClaims(FilePart):
    """What a certificate of general springs claims; the checker proves each or refuses.

    gap: the objective at the pose, over the best translation, exceeds the minimum by less.
    sin2_half_angle: sin^2(theta/2) is less, for the angle theta to every optimum; None: no claim.
    unique: True claims that the optimum is one single rotation, False that it is not; None: none.
    """

    gap: Dyadic
    sin2_half_angle: Dyadic | None
    unique: bool | None


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringsBody(FilePart):
    """A proof that a pose of general springs is optimal.

    quaternion: integers (w, x, y, z), the certified rotation is R(q) of the unit vector along it.
    symmetry: turns (a, b) of world and body that keep the objective; where there are many optima.
    radius: how far points may move before an optimum turns by more than an angle.
    rotation_only: of a problem without a translation.
    """

    PLACES: ClassVar = {
        "quaternion": "proof.pose",
        "symmetry": "proof.symmetry",
        "radius": "radius?",
        "rotation_only": "rotation_only?",
    }

    quaternion: tuple[int, int, int, int]
    claims: SpringsClaims
    symmetry: Annotated[tuple[int, ...], (6,)] | None = None
    radius: Radius | None = None
    rotation_only: bool = False

    @property
    def gap(self) -> Fraction:
        """The claimed bound on objective(R(q)) - minimum."""
        return self.claims.gap.value


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringsSosBody(SpringsBody):
    """A proof that a pose of general springs is optimal: integers over 2^unit, and what follows.

    level, mu: the objective exceeds level + mu sin^2(theta/2), theta the angle to that rotation.
    gram: the twenty entries of the Gram matrix that its identity leaves free, and k: over
        2^(unit + k).
    """

    KIND: ClassVar[str] = "springs-sos"
    PLACES: ClassVar = {
        **SpringsBody.PLACES,
        "unit": "proof.unit",
        "level": "proof.level",
        "mu": "proof.mu",
        "gram": "proof.gram",
    }

    unit: int
    level: int
    mu: int
    gram: Annotated[tuple[int, ...], (21,)]

    @property
    def growth(self) -> Fraction:
        """The objective exceeds its value here less `gap` by this times sin^2(theta/2)."""
        return Dyadic(mantissa=self.mu, exponent=self.unit).value
