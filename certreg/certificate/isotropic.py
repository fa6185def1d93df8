"""Certificates of kind "isotropic": the optimal pose of a problem with springs alike in every way.

The kind of every certificate of `certify`. Its theorems are in `certreg.verify`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from certreg.certificate.radius import Radius
from certreg.exact import Dyadic, power_of_two
from certreg.results import Brief

if TYPE_CHECKING:
    from fractions import Fraction


@dataclass(frozen=True, slots=True, kw_only=True)
class Claims(Brief):
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
    pattern: tuple[int, ...]
    unstable: tuple[int, ...] | None
    basin: bool | None = None
    sdp_gap: Dyadic | None = None

    def to_fields(self) -> dict[str, Any]:
        """The object `claims` of the file."""
        return {
            "basin": self.basin,
            "gap": self.gap.pair,
            "pattern": list(self.pattern),
            "sdp_gap": _pair(self.sdp_gap),
            "sin2_half_angle": _pair(self.sin2_half_angle),
            "unique": self.unique,
            "unstable": None if self.unstable is None else list(self.unstable),
        }

    @classmethod
    def from_fields(cls, fields: dict[str, Any]) -> Claims:
        """The inverse of `to_fields`."""
        unstable = fields["unstable"]
        return cls(
            gap=Dyadic.of_pair(fields["gap"]),
            sin2_half_angle=_dyadic(fields["sin2_half_angle"]),
            unique=fields["unique"],
            pattern=tuple(fields["pattern"]),
            unstable=None if unstable is None else tuple(unstable),
            basin=fields["basin"],
            sdp_gap=_dyadic(fields["sdp_gap"]),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class RotationState(Brief):
    """A rotation and an angular velocity (body frame, in the time unit of the springs), exactly.

    quaternion: integers (w, x, y, z). angular_velocity: three integers times 2^exponent.
    """

    quaternion: tuple[int, ...]
    angular_velocity: tuple[int, ...]
    exponent: int

    @property
    def spin(self) -> tuple[Fraction, ...]:
        """The angular velocity in radians per time unit, body frame."""
        return tuple(entry * power_of_two(self.exponent) for entry in self.angular_velocity)

    def to_fields(self) -> dict[str, Any]:
        """The object `basin` of the file."""
        velocity = [*self.angular_velocity, self.exponent]
        return {"angular_velocity": velocity, "quaternion": list(self.quaternion)}

    @classmethod
    def from_fields(cls, fields: dict[str, Any]) -> RotationState | None:
        """The inverse of `to_fields`; None if all is null. Raises ValueError if a part is."""
        missing = [name for name, value in fields.items() if value is None]
        if len(missing) == len(fields):
            return None
        if missing:
            message = f"basin.{missing[0]} is null beside a state"
            raise ValueError(message)
        *velocity, exponent = fields["angular_velocity"]
        return cls(
            quaternion=tuple(fields["quaternion"]),
            angular_velocity=tuple(velocity),
            exponent=exponent,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class IsotropicBody(Brief):
    """A proof that a pose is optimal: an integer quaternion, a few dyadic numbers, what follows.

    quaternion: integers (w, x, y, z), the certified rotation is R(q) of the unit vector along it.
    multiplier: nu with nu I - K > 0, the dual of the semidefinite relaxation rounded outwards.
    basin: a state of the moving body from which it must end at the optimum.
    radius: how far points may move before an optimum turns by more than an angle.
    rotation_only: of a problem without a translation.
    mu, delta: (v + delta - mu) I - K + mu q q^T / |q|^2 > 0 with v = q^T K q / |q|^2.
    """

    KIND: ClassVar[str] = "isotropic"

    quaternion: tuple[int, int, int, int]
    mu: Dyadic
    delta: Dyadic
    claims: Claims
    multiplier: Dyadic | None = None
    basin: RotationState | None = None
    radius: Radius | None = None
    rotation_only: bool = False

    @property
    def gap(self) -> Fraction:
        """The claimed bound on objective(R(q)) - minimum."""
        return self.claims.gap.value

    def to_fields(self) -> dict[str, Any]:
        """The part of the file that is of this kind alone."""
        return {
            "basin": None if self.basin is None else self.basin.to_fields(),
            "claims": self.claims.to_fields(),
            "optimality": {"delta": self.delta.pair, "mu": self.mu.pair},
            "pose": list(self.quaternion),
            "sdp": None if self.multiplier is None else {"nu": self.multiplier.pair},
            **({} if self.radius is None else {"radius": self.radius.to_fields()}),
            **({"rotation_only": True} if self.rotation_only else {}),
        }

    @classmethod
    def from_fields(cls, fields: dict[str, Any]) -> IsotropicBody:
        """The inverse of `to_fields`, of a file that the checker has found well-formed."""
        w, x, y, z = fields["pose"]
        basin, sdp, radius = fields["basin"], fields["sdp"], fields.get("radius")
        return cls(
            quaternion=(w, x, y, z),
            mu=Dyadic.of_pair(fields["optimality"]["mu"]),
            delta=Dyadic.of_pair(fields["optimality"]["delta"]),
            claims=Claims.from_fields(fields["claims"]),
            multiplier=None if sdp is None else _dyadic(sdp["nu"]),
            basin=None if basin is None else RotationState.from_fields(basin),
            radius=None if radius is None else Radius.from_fields(radius),
            rotation_only=bool(fields.get("rotation_only")),
        )


def _pair(number: Dyadic | None) -> list[int] | None:
    return None if number is None else number.pair


def _dyadic(pair: list[int] | None) -> Dyadic | None:
    return None if pair is None else Dyadic.of_pair(pair)
