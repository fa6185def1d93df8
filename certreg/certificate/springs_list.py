"""Certificates of kind "springs-list": all equilibria of general springs, and their indices.

Its theorems are in `certreg.verify`; `listing` finds what proves them.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, ClassVar

from certreg.exact import Dyadic
from certreg.results import Brief

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.exact import IntegerQuaternion


def quaternion_product(a: Sequence[int], p: Sequence[int]) -> IntegerQuaternion:
    """The product a p."""
    (w, x, y, z), (d, e, f, g) = a, p
    return (
        w * d - x * e - y * f - z * g,
        x * d + w * e - z * f + y * g,
        y * d + z * e + w * f - x * g,
        z * d - y * e + x * f + w * g,
    )


def _with_positive_first(q: IntegerQuaternion) -> IntegerQuaternion:
    """The quaternion of the same rotation whose first entry that is not zero is positive."""
    w, x, y, z = q
    return q if next(filter(None, q), 1) > 0 else (-w, -x, -y, -z)


@dataclass(frozen=True, slots=True, kw_only=True)
class ListClaims(Brief):
    """What a list of equilibria claims; the checker proves each or refuses.

    indices: of all real equilibria, in the order of the list: how many independent directions lead
        down. Those of index 0 are stable. None is degenerate.
    second: the objective is at least that at every equilibrium but the first.
    gap: the objective at the pose, over the best translation, exceeds the minimum by less.
    sin2_half_angle: sin^2(theta/2) is less, for the angle theta to every optimum; None: no claim.
    unique: True claims that the optimum is one single rotation; None: none.
    """

    gap: Dyadic
    indices: tuple[int, ...]
    second: Dyadic
    sin2_half_angle: Dyadic | None
    unique: bool | None

    def to_fields(self) -> dict[str, Any]:
        """The object `claims` of the file."""
        angle = self.sin2_half_angle
        return {
            "gap": self.gap.pair,
            "indices": list(self.indices),
            "second": self.second.pair,
            "sin2_half_angle": None if angle is None else angle.pair,
            "unique": self.unique,
        }

    @classmethod
    def from_fields(cls, fields: dict[str, Any]) -> ListClaims:
        """The inverse of `to_fields`."""
        angle = fields["sin2_half_angle"]
        return cls(
            gap=Dyadic.of_pair(fields["gap"]),
            indices=tuple(fields["indices"]),
            second=Dyadic.of_pair(fields["second"]),
            sin2_half_angle=None if angle is None else Dyadic.of_pair(angle),
            unique=fields["unique"],
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringsListBody(Brief):
    """A proof that these are all equilibria of general springs: boxes of 40 complex lines.

    chart: an integer quaternion a; a critical line holds a p, p = (2^bits, x, y, z), where
        x, y, z are within 1 of the integers in `real` or `pairs`.
    real: (x, y, z) of each equilibrium, the best first.
    pairs: (x, x', y, y', z, z') of x + i x', y + i y', z + i z', one of two conjugate lines.
    modulus: with which linear algebra shows that there are no more.
    """

    KIND: ClassVar[str] = "springs-list"

    bits: int
    chart: IntegerQuaternion
    real: tuple[tuple[int, ...], ...]
    pairs: tuple[tuple[int, ...], ...]
    modulus: int
    claims: ListClaims

    @property
    def quaternions(self) -> tuple[IntegerQuaternion, ...]:
        """Of all equilibria, right to about 2^-bits: integers (w, x, y, z) of any length."""
        found = [quaternion_product(self.chart, (1 << self.bits, *line)) for line in self.real]
        return tuple(map(_with_positive_first, found))

    @property
    def quaternion(self) -> IntegerQuaternion:
        """The certified rotation is that of the unit vector along it: the first equilibrium."""
        return self.quaternions[0]

    @property
    def gap(self) -> Fraction:
        """The claimed bound on objective(R(q)) - minimum."""
        return self.claims.gap.value

    @property
    def growth(self) -> Fraction:
        """What is proved here of how the objective grows around the pose: nothing."""
        return Fraction(0)

    @property
    def stable(self) -> int:
        """How many equilibria are stable."""
        return self.claims.indices.count(0)

    def to_fields(self) -> dict[str, Any]:
        """The part of the file that is of this kind alone."""
        real = [k for line in self.real for entry in line for k in (entry, 0)]
        return {
            "claims": self.claims.to_fields(),
            "proof": {
                "bits": self.bits,
                "chart": list(self.chart),
                "lines": [*real, *[k for line in self.pairs for k in line]],
                "modulus": self.modulus,
                "pose": list(self.quaternion),
            },
        }

    @classmethod
    def from_fields(cls, fields: dict[str, Any]) -> SpringsListBody:
        """The inverse of `to_fields`, of a file that the checker has found well-formed."""
        proof = fields["proof"]
        w, x, y, z = proof["chart"]
        rows = [tuple(proof["lines"][k : k + 6]) for k in range(0, len(proof["lines"]), 6)]
        return cls(
            bits=proof["bits"],
            chart=(w, x, y, z),
            real=tuple(row[::2] for row in rows if not any(row[1::2])),
            pairs=tuple(row for row in rows if any(row[1::2])),
            modulus=proof["modulus"],
            claims=ListClaims.from_fields(fields["claims"]),
        )
