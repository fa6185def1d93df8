"""Certificates of kind "count": at most four equilibria, by a rank modulo a prime.

The theorem is in `certreg.equilibrium.torques`; the checker proves it again from the data, with
formulas of its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from certreg.certificate.envelope import Certificate, CertificateBody, enclosed
from certreg.errors import InvalidProblemError
from certreg.problem.moments import exact_moments

if TYPE_CHECKING:
    from certreg.problem.problem import RegistrationProblem


AT_MOST = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class CountBody(CertificateBody):
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


def count_certificate(problem: RegistrationProblem) -> Certificate[CountBody] | None:
    """The certificate that a problem has at most four equilibria; None for infinitely many.

    None means not proved, not disproved. Raises InvalidProblemError without a translation, or with
    a free scale: that kind states a rigid motion.
    """
    if problem.motion.options:
        raise InvalidProblemError(
            f"no certificate counts equilibria with {problem.motion.options}: leave --out out",
            array="problem",
        )
    from certreg.equilibrium.torques import at_most_four  # loads FLINT, which few need

    proof = at_most_four(exact_moments(problem).cross)
    if proof is None:
        return None
    return enclosed(problem, CountBody(chart=proof.chart, modulus=proof.prime))
