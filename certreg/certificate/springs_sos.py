"""Certificates of kind "springs-sos": the optimal pose of general springs, by a sum of squares.

Its theorems are in `certreg.verify`; `squares` finds what proves them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from certreg.certificate.radius import Radius
from certreg.exact import Dyadic
from certreg.results import Brief

if TYPE_CHECKING:
    from fractions import Fraction


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringsClaims(Brief):
    """What a certificate of general springs claims; the checker proves each or refuses.

    gap: the objective at the pose, over the best translation, exceeds the minimum by less.
    sin2_half_angle: sin^2(theta/2) is less, for the angle theta to every optimum; None: no claim.
    unique: True claims that the optimum is one single rotation, False that it is not; None: none.
    """

    gap: Dyadic
    sin2_half_angle: Dyadic | None
    unique: bool | None

    def to_fields(self) -> dict[str, Any]:
        """The object `claims` of the file."""
        angle = self.sin2_half_angle
        return {
            "gap": self.gap.pair,
            "sin2_half_angle": None if angle is None else angle.pair,
            "unique": self.unique,
        }

    @classmethod
    def from_fields(cls, fields: dict[str, Any]) -> SpringsClaims:
        """The inverse of `to_fields`."""
        angle = fields["sin2_half_angle"]
        return cls(
            gap=Dyadic.of_pair(fields["gap"]),
            sin2_half_angle=None if angle is None else Dyadic.of_pair(angle),
            unique=fields["unique"],
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringsSosBody(Brief):
    """A proof that a pose of general springs is optimal: integers over 2^unit, and what follows.

    quaternion: integers (w, x, y, z), the certified rotation is R(q) of the unit vector along it.
    level, mu: the objective exceeds level + mu sin^2(theta/2), theta the angle to that rotation.
    free: the twenty entries of the Gram matrix that its identity leaves free, over
        2^(unit + free_exponent).
    symmetry: turns (a, b) of world and body that keep the objective; where there are many optima.
    radius: how far points may move before an optimum turns by more than an angle.
    """

    KIND: ClassVar[str] = "springs-sos"

    quaternion: tuple[int, int, int, int]
    unit: int
    level: int
    mu: int
    free: tuple[int, ...]
    free_exponent: int
    claims: SpringsClaims
    symmetry: tuple[int, ...] | None = None
    radius: Radius | None = None

    @property
    def gap(self) -> Fraction:
        """The claimed bound on objective(R(q)) - minimum."""
        return self.claims.gap.value

    @property
    def growth(self) -> Fraction:
        """The objective exceeds its value here less `gap` by this times sin^2(theta/2)."""
        return Dyadic(mantissa=self.mu, exponent=self.unit).value

    def to_fields(self) -> dict[str, Any]:
        """The part of the file that is of this kind alone."""
        return {
            "claims": self.claims.to_fields(),
            "proof": {
                "gram": [*self.free, self.free_exponent],
                "level": self.level,
                "mu": self.mu,
                "pose": list(self.quaternion),
                "symmetry": None if self.symmetry is None else list(self.symmetry),
                "unit": self.unit,
            },
            **({} if self.radius is None else {"radius": self.radius.to_fields()}),
        }

    @classmethod
    def from_fields(cls, fields: dict[str, Any]) -> SpringsSosBody:
        """The inverse of `to_fields`, of a file that the checker has found well-formed."""
        proof, radius = fields["proof"], fields.get("radius")
        w, x, y, z = proof["pose"]
        symmetry = proof["symmetry"]
        return cls(
            quaternion=(w, x, y, z),
            unit=proof["unit"],
            level=proof["level"],
            mu=proof["mu"],
            free=tuple(proof["gram"][:-1]),
            free_exponent=proof["gram"][-1],
            claims=SpringsClaims.from_fields(fields["claims"]),
            symmetry=None if symmetry is None else tuple(symmetry),
            radius=None if radius is None else Radius.from_fields(radius),
        )
