"""Certificates of kind "isotropic": the optimal pose of a problem with springs alike in every way.

And of kind "similarity", of a problem whose scale is free: the rotation is proved in the same way.
Their theorems, and how they give the scale, are in `certreg.verify`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

from certreg.certificate.file_parts import FilePart
from certreg.certificate.radius import SeparatedRadius
from certreg.exact.dyadic import Dyadic, power_of_two

if TYPE_CHECKING:
    from fractions import Fraction


@dataclass(frozen=True, slots=True, kw_only=True)
class RotationClaims(FilePart):
    """What a certificate claims of a rotation; the checker proves each from the data or refuses.

    gap: the objective at the pose (over the best translation, and scale where that is free) exceeds
        the minimum by less.
    sin2_half_angle: sin^2(theta/2) is less, for the angle theta to every optimum; None: no claim.
    unique: True claims that the optimum is one single pose; False claims nothing.
    pattern: multiplicities of the eigenvalues of K, largest first.
    """

    gap: Dyadic
    sin2_half_angle: Dyadic | None
    unique: bool
    pattern: Annotated[tuple[int, ...], range(5)]


@dataclass(frozen=True, slots=True, kw_only=True)
class RotationBody(FilePart):
    """A proof that a rotation is optimal: an integer quaternion, a few dyadic numbers.

    quaternion: integers (w, x, y, z), the certified rotation is R(q) of the unit vector along it.
    mu, delta: (v + delta - mu) I - K + mu q q^T / |q|^2 > 0 with v = q^T K q / |q|^2.
    radius: how far points may move before an optimum turns by more than an angle.
    rotation_only: of a problem without a translation.
    """

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
    claims: RotationClaims
    radius: SeparatedRadius | None = None
    rotation_only: bool = False

    @property
    def gap(self) -> Fraction:
        """The claimed bound on objective(R(q)) - minimum."""
        return self.claims.gap.value


@dataclass(frozen=True, slots=True, kw_only=True)
class Claims(RotationClaims):
    """What is claimed besides.

    unstable: unstable eigenvalues of the dynamics at each component; None: no claim.
    basin: True claims that a body in the certificate's `basin` state ends at the optimum.
    sdp_gap: the gap as the dual of the semidefinite relaxation alone bounds it; None: no claim.
    """

    unstable: Annotated[tuple[int, ...], range(5)] | None
    basin: bool | None = None
    sdp_gap: Dyadic | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RotationState(FilePart):
    """A rotation and an angular velocity (body frame, in the time unit of the springs), exactly.

    quaternion: integers (w, x, y, z). angular_velocity: three integers, the exponent of their unit.
    """

    quaternion: tuple[int, int, int, int]
    angular_velocity: tuple[int, int, int, int]

    @property
    def spin(self) -> tuple[Fraction, ...]:
        """The angular velocity in radians per time unit, body frame."""
        *velocity, exponent = self.angular_velocity
        return tuple(entry * power_of_two(exponent) for entry in velocity)


@dataclass(frozen=True, slots=True, kw_only=True)
class IsotropicBody(RotationBody):
    """A proof that a pose is optimal, and what follows.

    multiplier: nu with nu I - K > 0, the dual of the semidefinite relaxation rounded outwards.
    basin: a state of the moving body from which it must end at the optimum.
    """

    KIND: ClassVar[str] = "isotropic"
    PLACES: ClassVar = {**RotationBody.PLACES, "multiplier": "sdp.nu"}

    claims: Claims
    multiplier: Dyadic | None = None
    basin: RotationState | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SimilarityClaims(RotationClaims):
    """What is claimed besides. scale_lower, scale_upper: the scale of every optimum is between."""

    scale_lower: Dyadic
    scale_upper: Dyadic


@dataclass(frozen=True, slots=True, kw_only=True)
class SimilarityBody(RotationBody):
    """A proof that a pose with a scale is optimal, and between which scales.

    scale: "asymmetric" or "symmetric", as of the problem.
    """

    KIND: ClassVar[str] = "similarity"

    scale: str
    claims: SimilarityClaims
