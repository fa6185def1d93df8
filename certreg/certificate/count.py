"""Certificates of kind "count": at most four equilibria, by a rank modulo a prime.

The theorem is in `certreg.equilibrium.counting`; the checker proves it again from the data, with
formulas of its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

AT_MOST = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class CountBody:
    """A proof that a problem has few equilibria, complex ones counted with multiplicity.

    chart, modulus: with which the quadratics are seen to be independent.
    at_most: the claim; no less than four is ever proved.
    """

    KIND: ClassVar[str] = "count"

    chart: tuple[int, int, int, int]
    modulus: int
    at_most: int = AT_MOST

    def to_fields(self) -> dict[str, Any]:
        """The part of the file that is of this kind alone."""
        return {
            "claims": {"at_most": self.at_most},
            "proof": {"chart": list(self.chart), "modulus": self.modulus},
        }

    @classmethod
    def from_fields(cls, fields: dict[str, Any]) -> CountBody:
        """The inverse of `to_fields`, of a file that the checker has found well-formed."""
        a, b, c, d = fields["proof"]["chart"]
        return cls(
            chart=(a, b, c, d),
            modulus=fields["proof"]["modulus"],
            at_most=fields["claims"]["at_most"],
        )
