"""What certificates of a pose have in common: the rotation, and how good it is claimed to be."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from certreg.certificate.envelope import CertificateBody
from certreg.certificate.file_parts import FilePart
from certreg.exact.dyadic import Dyadic

if TYPE_CHECKING:
    from fractions import Fraction


@dataclass(frozen=True, slots=True, kw_only=True)
class PoseClaims(FilePart):
    """What a certificate claims of a pose; the checker proves each from the data or refuses.

    gap: the objective at the pose (over the best translation, and scale where that is free) exceeds
        the minimum by less.
    sin2_half_angle: sin^2(theta/2) is less, for the angle theta to every optimum; None: no claim.
    unique: True claims that the optimum is one single rotation, False that it is not; None: none.
    """

    gap: Dyadic
    sin2_half_angle: Dyadic | None
    unique: bool | None


@dataclass(frozen=True, slots=True, kw_only=True)
class PoseBody(CertificateBody):
    """A proof that a pose is optimal.

    quaternion: integers (w, x, y, z), the certified rotation is R(q) of the unit vector along it.
    """

    quaternion: tuple[int, int, int, int]
    claims: PoseClaims

    @property
    def gap(self) -> Fraction:
        """The claimed bound on objective(R(q)) - minimum."""
        return self.claims.gap.value
