"""Certificates of kind "count": at most four equilibria, by a rank modulo a prime.

The theorem is in `certreg.equilibrium.counting`; the checker proves it again from the data, with
formulas of its own.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from certreg.certificate.envelope import FORMAT, file_pieces
from certreg.io import write_atomically
from certreg.problem import exact_moments
from certreg.settings import CertificateSettings

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator

    from certreg.problem import RegistrationProblem

COUNT = "count"
AT_MOST = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class CountCertificate:
    """A proof that a problem has at most four equilibria, complex ones counted with multiplicity.

    chart, modulus: with which the quadratics are seen to be independent.
    data: the bytes that are hashed into the digest; None where the problem is too large to inline.
    """

    n: int
    digest: str
    data: bytes | None
    chart: tuple[int, int, int, int]
    modulus: int
    about: dict[str, Any] = field(default_factory=dict[str, Any])

    def pieces(self) -> Iterator[bytes]:
        """The file's content, piece by piece."""
        document = {
            "about": self.about,
            "claims": {"at_most": AT_MOST},
            "format": FORMAT,
            "kind": COUNT,
            "problem": {"data": None, "digest": self.digest, "n": self.n},
            "proof": {"chart": list(self.chart), "modulus": self.modulus},
        }
        yield from file_pieces(document, self.data)

    def to_json(self) -> bytes:
        """The file's content."""
        return b"".join(self.pieces())

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the file; under a temporary name first, so that it is never half there."""
        write_atomically(path, self.pieces())


def count_certificate(
    problem: RegistrationProblem, settings: CertificateSettings | None = None
) -> CountCertificate | None:
    """The certificate that a problem has at most four equilibria; None for infinitely many.

    None means not proved, not disproved.
    """
    from certreg.equilibrium import at_most_four

    settings = settings or CertificateSettings()
    proof = at_most_four(exact_moments(problem).cross)
    if proof is None:
        return None
    return CountCertificate(
        n=problem.n,
        digest=problem.digest(),
        data=problem.data_bytes() if problem.n <= settings.inline_points else None,
        chart=proof.chart,
        modulus=proof.prime,
    )
