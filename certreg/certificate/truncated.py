"""Certificates of kind "truncated-rotation": a rotation of least truncated squares, and labels.

The checker searches all rotations again, in boxes, so a rotation and labels are nearly all there
is; the theorems are in `certreg.verify`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from certreg.certificate.file_parts import FilePart
from certreg.exact.dyadic import Dyadic

if TYPE_CHECKING:
    from fractions import Fraction


@dataclass(frozen=True, slots=True, kw_only=True)
class TruncatedClaims(FilePart):
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


@dataclass(frozen=True, slots=True, kw_only=True)
class TruncatedRotationBody(FilePart):
    """A proof that a rotation is optimal; mu makes that of the angle short."""

    KIND: ClassVar[str] = "truncated-rotation"
    PLACES: ClassVar = {"quaternion": "pose", "mu": "optimality.mu"}

    quaternion: tuple[int, int, int, int]
    mu: Dyadic
    claims: TruncatedClaims

    @property
    def gap(self) -> Fraction:
        """The claimed bound on cost(R(q)) - minimum."""
        return self.claims.gap.value
