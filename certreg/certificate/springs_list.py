"""Certificates of kind "springs-list": all equilibria of general springs, and their indices.

Its theorems are in `certreg.verify`; `listing` finds what proves them.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated, ClassVar

from certreg.certificate.file_parts import FilePart
from certreg.exact.dyadic import Dyadic

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.exact.spaces import IntegerQuaternion


def quaternion_product(a: Sequence[int], p: Sequence[int]) -> IntegerQuaternion:
    """The product a p."""
    (w, x, y, z), (d, e, f, g) = a, p
    return (
        w * d - x * e - y * f - z * g,
        x * d + w * e - z * f + y * g,
        y * d + z * e + w * f - x * g,
        z * d - y * e + x * f + w * g,
    )


def with_positive_first(q: IntegerQuaternion) -> IntegerQuaternion:
    """The quaternion of the same rotation whose first entry that is not zero is positive."""
    w, x, y, z = q
    return q if next(filter(None, q), 1) > 0 else (-w, -x, -y, -z)


@dataclass(frozen=True, slots=True, kw_only=True)
class ListClaims(FilePart):
    """What a list of equilibria claims; the checker proves each or refuses.

    indices: of all real equilibria, in the order of the list: how many independent directions lead
        down. Those of index 0 are stable. None is degenerate.
    second: the objective is at least that at every equilibrium but the first.
    gap: the objective at the pose, over the best translation, exceeds the minimum by less.
    sin2_half_angle: sin^2(theta/2) is less, for the angle theta to every optimum; None: no claim.
    unique: True claims that the optimum is one single rotation; None: none.
    """

    gap: Dyadic
    indices: Annotated[tuple[int, ...], range(41)]
    second: Dyadic
    sin2_half_angle: Dyadic | None
    unique: bool | None


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringsListBody(FilePart):
    """A proof that these are all equilibria of general springs: boxes of 40 complex lines.

    quaternion: integers (w, x, y, z), the certified rotation is R(q) of the unit vector along it:
        the first equilibrium, the best.
    chart: an integer quaternion a; a critical line holds a p, p = (2^bits, x, y, z), where
        x, y, z are within 1 of the integers in `lines`.
    lines: x, x', y, y', z, z' of each, of x + i x', y + i y', z + i z': those of the equilibria,
        which are real, and one of two that are conjugate.
    modulus: with which linear algebra shows that there are no more.
    rotation_only: of a problem without a translation.
    """

    KIND: ClassVar[str] = "springs-list"
    PLACES: ClassVar = {
        "quaternion": "proof.pose",
        "bits": "proof.bits",
        "chart": "proof.chart",
        "lines": "proof.lines",
        "modulus": "proof.modulus",
        "rotation_only": "rotation_only?",
    }

    quaternion: tuple[int, int, int, int]
    bits: int
    chart: tuple[int, int, int, int]
    lines: Annotated[tuple[int, ...], range(120, 241, 6)]  # 40, half of them at least real
    modulus: int
    claims: ListClaims
    rotation_only: bool = False

    @property
    def quaternions(self) -> tuple[IntegerQuaternion, ...]:
        """Of all equilibria, right to about 2^-bits: integers (w, x, y, z) of any length."""
        rows = [self.lines[k : k + 6] for k in range(0, len(self.lines), 6)]
        real = [row[::2] for row in rows if not any(row[1::2])]
        found = [quaternion_product(self.chart, (1 << self.bits, *line)) for line in real]
        return tuple(map(with_positive_first, found))

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
