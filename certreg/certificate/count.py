"""Certificates of kind "count": at most four equilibria, by a rank modulo a prime.

The theorem is in `certreg.equilibrium.torques`; the checker proves it again from the data, with
formulas of its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from certreg.certificate.file_parts import FilePart

AT_MOST = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class CountBody(FilePart):
    """A proof that a problem has few equilibria, complex ones counted with multiplicity.

    chart, modulus: with which the quadratics are seen to be independent.
    at_most: the claim; no less than four is ever proved.
    """

    KIND: ClassVar[str] = "count"
    PLACES: ClassVar = {
        "chart": "proof.chart",
        "modulus": "proof.modulus",
        "at_most": "claims.at_most",
    }

    chart: tuple[int, int, int, int]
    modulus: int
    at_most: int = AT_MOST
