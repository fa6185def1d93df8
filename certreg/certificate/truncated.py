"""Certificates of kind "truncated-rotation": a rotation of least truncated squares, and labels.

The checker searches all rotations again, in boxes, so a rotation and labels are nearly all there
is; the theorems are in `certreg.verify`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from certreg.exact import Dyadic
from certreg.results import Brief

if TYPE_CHECKING:
    from fractions import Fraction


@dataclass(frozen=True, slots=True, kw_only=True)
class TruncatedClaims(Brief):
    """What the certificate claims; the checker proves each from the data or refuses.

    gap: the cost of the rotation exceeds the minimum by less.
    labels: a character a pair: 1, at every optimum it is within its bound; 0, at every optimum it
        is not; ?, no claim.
    sin2_half_angle: sin^2(theta/2) is less, for the angle theta to every optimum; None: no claim.
    unique: True claims that the optimum is one single rotation; False claims nothing.
    """

    gap: Dyadic
    labels: str
    sin2_half_angle: Dyadic | None
    unique: bool

    def to_fields(self) -> dict[str, Any]:
        """The object `claims` of the file."""
        angle = self.sin2_half_angle
        return {
            "gap": self.gap.pair,
            "labels": self.labels,
            "sin2_half_angle": None if angle is None else angle.pair,
            "unique": self.unique,
        }

    @classmethod
    def from_fields(cls, fields: dict[str, Any]) -> TruncatedClaims:
        """The inverse of `to_fields`."""
        angle = fields["sin2_half_angle"]
        return cls(
            gap=Dyadic.of_pair(fields["gap"]),
            labels=fields["labels"],
            sin2_half_angle=None if angle is None else Dyadic.of_pair(angle),
            unique=fields["unique"],
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class TruncatedRotationBody(Brief):
    """A proof that a rotation is optimal; mu makes that of the angle short."""

    KIND: ClassVar[str] = "truncated-rotation"

    quaternion: tuple[int, int, int, int]
    mu: Dyadic
    claims: TruncatedClaims

    @property
    def gap(self) -> Fraction:
        """The claimed bound on cost(R(q)) - minimum."""
        return self.claims.gap.value

    def to_fields(self) -> dict[str, Any]:
        """The part of the file that is of this kind alone."""
        return {
            "claims": self.claims.to_fields(),
            "optimality": {"mu": self.mu.pair},
            "pose": list(self.quaternion),
        }

    @classmethod
    def from_fields(cls, fields: dict[str, Any]) -> TruncatedRotationBody:
        """The inverse of `to_fields`, of a file that the checker has found well-formed."""
        w, x, y, z = fields["pose"]
        return cls(
            quaternion=(w, x, y, z),
            mu=Dyadic.of_pair(fields["optimality"]["mu"]),
            claims=TruncatedClaims.from_fields(fields["claims"]),
        )
