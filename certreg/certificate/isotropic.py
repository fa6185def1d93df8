"""Certificates of kind "isotropic": the optimal pose of a problem with springs alike in every way.

The kind of every certificate of `certify`. Its theorems are in `certreg.verify`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

from certreg.certificate.file_parts import FilePart
from certreg.certificate.radius import SeparatedRadius
from certreg.exact import Dyadic, power_of_two

if TYPE_CHECKING:
    from fractions import Fraction


@dataclass(frozen=True, slots=True, kw_only=True)
class Claims(FilePart):
    """What the certificate claims; the checker proves each from the data or refuses.

    gap: the objective at the pose (over the best translation) exceeds the minimum by less.
    sin2_half_angle: sin^2(theta/2) is less, for the angle theta to every optimum; None: no claim.
    unique: True claims that the optimum is one single pose; False claims nothing.
    pattern: multiplicities of the eigenvalues of K, largest first.
    unstable: unstable eigenvalues of the dynamics at each component; None: no claim.
    basin: True claims that a body in the certificate's `basin` state ends at the optimum.
    sdp_gap: the gap as the dual of the semidefinite relaxation alone bounds it; None: no claim.
    """

    gap: Dyadic
    sin2_half_angle: Dyadic | None
    unique: bool
    pattern: Annotated[tuple[int, ...], range(5)]
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
class IsotropicBody(FilePart):
    """A proof that a pose is optimal: an integer quaternion, a few dyadic numbers, what follows.

    quaternion: integers (w, x, y, z), the certified rotation is R(q) of the unit vector along it.
    multiplier: nu with nu I - K > 0, the dual of the semidefinite relaxation rounded outwards.
    basin: a state of the moving body from which it must end at the optimum.
    radius: how far points may move before an optimum turns by more than an angle.
    rotation_only: of a problem without a translation.
    mu, delta: (v + delta - mu) I - K + mu q q^T / |q|^2 > 0 with v = q^T K q / |q|^2.
    """

    KIND: ClassVar[str] = "isotropic"
    PLACES: ClassVar = {
        "quaternion": "pose",
        "mu": "optimality.mu",
        "delta": "optimality.delta",
        "multiplier": "sdp.nu",
        "radius": "radius?",
        "rotation_only": "rotation_only?",
    }

    quaternion: tuple[int, int, int, int]
    mu: Dyadic
    delta: Dyadic
    claims: Claims
    multiplier: Dyadic | None = None
    basin: RotationState | None = None
    radius: SeparatedRadius | None = None
    rotation_only: bool = False

    @property
    def gap(self) -> Fraction:
        """The claimed bound on objective(R(q)) - minimum."""
        return self.claims.gap.value
