"""Certificates of kind "springs-cones": the optimal pose of general springs, by cones and caps.

Its theorems are in `certreg.verify`; `cones` finds what proves them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from certreg.certificate.radius import Radius
from certreg.certificate.springs_sos import SpringsClaims
from certreg.exact import Dyadic
from certreg.results import Brief

if TYPE_CHECKING:
    from fractions import Fraction

    from certreg.exact import IntegerQuaternion


@dataclass(frozen=True, slots=True, kw_only=True)
class ConesCap(Brief):
    """A rotation at which the Hessian of the objective, in rotation angle, exceeds curvature I."""

    quaternion: IntegerQuaternion
    curvature: Dyadic


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringsConesBody(Brief):
    """A proof that a pose of general springs is optimal up to bounds, by cones and caps.

    quaternion: integers (w, x, y, z), the certified rotation is R(q) of the unit vector along it.
    delta, mu: the objective exceeds its value here less delta by mu sin^2(theta/2), theta the angle
        to that rotation; in units of the energy. delta is the claimed gap.
    symmetry: turns (a, b) of world and body that keep the objective; where there are many optima.
    radius: how far points may move before an optimum turns by more than an angle.
    """

    KIND: ClassVar[str] = "springs-cones"

    quaternion: IntegerQuaternion
    mu: Dyadic
    caps: tuple[ConesCap, ...]
    claims: SpringsClaims
    symmetry: tuple[int, ...] | None = None
    radius: Radius | None = None

    @property
    def delta(self) -> Dyadic:
        """The objective exceeds its value here less this by mu sin^2(theta/2)."""
        return self.claims.gap

    @property
    def gap(self) -> Fraction:
        """The claimed bound on objective(R(q)) - minimum."""
        return self.claims.gap.value

    @property
    def growth(self) -> Fraction:
        """The objective exceeds its value here less `gap` by this times sin^2(theta/2)."""
        return self.mu.value

    def to_fields(self) -> dict[str, Any]:
        """The part of the file that is of this kind alone."""
        return {
            "claims": self.claims.to_fields(),
            "proof": {
                "caps": [k for cap in self.caps for k in (*cap.quaternion, *cap.curvature.pair)],
                "mu": self.mu.pair,
                "pose": list(self.quaternion),
                "symmetry": None if self.symmetry is None else list(self.symmetry),
            },
            **({} if self.radius is None else {"radius": self.radius.to_fields()}),
        }

    @classmethod
    def from_fields(cls, fields: dict[str, Any]) -> SpringsConesBody:
        """The inverse of `to_fields`, of a file that the checker has found well-formed."""
        proof, radius = fields["proof"], fields.get("radius")
        w, x, y, z = proof["pose"]
        rows = [proof["caps"][k : k + 6] for k in range(0, len(proof["caps"]), 6)]
        symmetry = proof["symmetry"]
        return cls(
            quaternion=(w, x, y, z),
            mu=Dyadic.of_pair(proof["mu"]),
            caps=tuple(
                ConesCap(quaternion=(a, b, c, d), curvature=Dyadic.of_pair(pair))
                for a, b, c, d, *pair in rows
            ),
            claims=SpringsClaims.from_fields(fields["claims"]),
            symmetry=None if symmetry is None else tuple(symmetry),
            radius=None if radius is None else Radius.from_fields(radius),
        )
