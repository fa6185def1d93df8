"""Certificates of kind "similarity": the optimal pose of a problem whose scale is free.

The rotation is proved as in the kind "isotropic"; its theorems, and how they give the scale, are in
`certreg.verify`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

from certreg.certificate.file_parts import FilePart
from certreg.certificate.radius import SeparatedRadius
from certreg.exact import Dyadic

if TYPE_CHECKING:
    from fractions import Fraction


@dataclass(frozen=True, slots=True, kw_only=True)
class SimilarityClaims(FilePart):
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
    pattern: Annotated[tuple[int, ...], range(5)]
    scale_lower: Dyadic
    scale_upper: Dyadic


@dataclass(frozen=True, slots=True, kw_only=True)
class SimilarityBody(FilePart):
    """A proof that a pose with a scale is optimal; as `IsotropicBody`, and between which scales.

    scale: "asymmetric" or "symmetric", as of the problem. rotation_only: without a translation.
    radius: how far points may move before the rotation of an optimum turns by more than an angle.
    """

    KIND: ClassVar[str] = "similarity"
    PLACES: ClassVar = {
        "quaternion": "pose",
        "mu": "optimality.mu",
        "delta": "optimality.delta",
        "radius": "radius?",
        "rotation_only": "rotation_only?",
    }

    quaternion: tuple[int, int, int, int]
    mu: Dyadic
    delta: Dyadic
    scale: str
    claims: SimilarityClaims
    radius: SeparatedRadius | None = None
    rotation_only: bool = False

    @property
    def gap(self) -> Fraction:
        """The claimed bound on objective(R(q)) - minimum."""
        return self.claims.gap.value
