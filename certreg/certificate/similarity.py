"""Certificates of kind "similarity": the optimal pose of a problem whose scale is free.

The rotation is proved as in the kind "isotropic"; its theorems, and how they give the scale, are in
`certreg.verify`.
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
class SimilarityClaims(Brief):
    """What the certificate claims; the checker proves each from the data or refuses.

    gap: the objective at the rotation, with the best scale and translation for it, exceeds the
        minimum by less.
    sin2_half_angle: sin^2(theta/2) is less, for the angle theta to every optimum; None: no claim.
    unique: True claims that the optimum is one single pose; False claims nothing.
    pattern: multiplicities of the eigenvalues of K, largest first.
    scale_lower, scale_upper: the scale of every optimum is between.
    """

    gap: Dyadic
    sin2_half_angle: Dyadic | None
    unique: bool
    pattern: tuple[int, ...]
    scale_lower: Dyadic
    scale_upper: Dyadic

    def to_fields(self) -> dict[str, Any]:
        """The object `claims` of the file."""
        angle = self.sin2_half_angle
        return {
            "gap": self.gap.pair,
            "pattern": list(self.pattern),
            "scale_lower": self.scale_lower.pair,
            "scale_upper": self.scale_upper.pair,
            "sin2_half_angle": None if angle is None else angle.pair,
            "unique": self.unique,
        }

    @classmethod
    def from_fields(cls, fields: dict[str, Any]) -> SimilarityClaims:
        """The inverse of `to_fields`."""
        angle = fields["sin2_half_angle"]
        return cls(
            gap=Dyadic.of_pair(fields["gap"]),
            sin2_half_angle=None if angle is None else Dyadic.of_pair(angle),
            unique=fields["unique"],
            pattern=tuple(fields["pattern"]),
            scale_lower=Dyadic.of_pair(fields["scale_lower"]),
            scale_upper=Dyadic.of_pair(fields["scale_upper"]),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class SimilarityBody(Brief):
    """A proof that a pose with a scale is optimal; as `IsotropicBody`, and between which scales.

    scale: "asymmetric" or "symmetric", as of the problem. rotation_only: without a translation.
    radius: how far points may move before the rotation of an optimum turns by more than an angle.
    """

    KIND: ClassVar[str] = "similarity"

    quaternion: tuple[int, int, int, int]
    mu: Dyadic
    delta: Dyadic
    scale: str
    claims: SimilarityClaims
    radius: Radius | None = None
    rotation_only: bool = False

    @property
    def gap(self) -> Fraction:
        """The claimed bound on objective(R(q)) - minimum."""
        return self.claims.gap.value

    def to_fields(self) -> dict[str, Any]:
        """The part of the file that is of this kind alone."""
        return {
            "claims": self.claims.to_fields(),
            "optimality": {"delta": self.delta.pair, "mu": self.mu.pair},
            "pose": list(self.quaternion),
            "scale": self.scale,
            **({} if self.radius is None else {"radius": self.radius.to_fields()}),
            **({"rotation_only": True} if self.rotation_only else {}),
        }

    @classmethod
    def from_fields(cls, fields: dict[str, Any]) -> SimilarityBody:
        """The inverse of `to_fields`, of a file that the checker has found well-formed."""
        w, x, y, z = fields["pose"]
        radius = fields.get("radius")
        return cls(
            quaternion=(w, x, y, z),
            mu=Dyadic.of_pair(fields["optimality"]["mu"]),
            delta=Dyadic.of_pair(fields["optimality"]["delta"]),
            scale=fields["scale"],
            claims=SimilarityClaims.from_fields(fields["claims"]),
            radius=None if radius is None else Radius.from_fields(radius),
            rotation_only=bool(fields.get("rotation_only")),
        )
