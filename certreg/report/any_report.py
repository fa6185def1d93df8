"""What the pages of all registrations share: the certificate in them, the policy, the sentences."""

from __future__ import annotations

import base64
import hashlib
import shlex
from dataclasses import dataclass
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from certreg.report.markup import printable

if TYPE_CHECKING:
    from certreg.certificate import Certificate
    from certreg.registration import AnyRegistration
    from certreg.results import Verdict

ASSETS = files("certreg.report") / "assets"
GUARANTEE_WORDS = (
    "Exact: integer arithmetic and a theorem. Numerical: computed with rounding that nobody has "
    "bounded. Each theorem has a page in the documentation; certreg derive NAME proves it anew."
)
EMBEDDED_BYTES = 8 << 20  # of a certificate in its page; a larger one is named there


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AnyReport:
    """What a page shows, beside the registration.

    content: the bytes of the certificate's file, name: what it is called. verdict: the checker's,
    on these; the registration's bounds are those that it proves. weak: they are far from what can
    be proved. documentation: where its pages lie, to link to.
    """

    certificate: Certificate[Any]
    content: bytes
    verdict: Verdict
    name: str = "certificate.json"
    weak: bool = False
    documentation: str | None = None

    @property
    def embedded(self) -> bool:
        """Whether the page carries the certificate; a large one it only names."""
        return len(self.content) <= EMBEDDED_BYTES

    @property
    def file(self) -> dict[str, Any]:
        """The certificate's file: in the page, or named there."""
        return file_fields(self)

    def html(self) -> bytes:
        """The file's content, in UTF-8."""
        raise NotImplementedError


def file_fields(report: AnyReport) -> dict[str, Any]:
    """What the page says of the certificate's file."""
    name = printable(report.name)
    return {
        "embedded": report.embedded,
        "name": name,
        "argument": "certificate.json" if report.embedded else shlex.quote(name),
        "mebibytes": len(report.content) / 2**20,
        "most": f"{EMBEDDED_BYTES / 2**20:.0f}",
        "sha256": hashlib.sha256(report.content).hexdigest(),
    }


def required_proof(registration: AnyRegistration) -> tuple[Certificate[Any], Verdict]:
    """The certificate and the checker's verdict. Raises ValueError where there is none."""
    certificate, verdict = registration.certificate, registration.verdict
    if certificate is None or verdict is None:
        message = "the registration is not certified: there is no certificate to report"
        raise ValueError(message)
    return certificate, verdict


def policy(*, style: str, script: str | None = None) -> str:
    """Nothing is loaded from anywhere; only these texts are style and script."""
    hashes = [_hash(text) for text in (style, script) if text is not None]
    scripts = "'none'" if script is None else hashes[1]
    return (
        f"default-src 'none'; style-src {hashes[0]}; script-src {scripts}; img-src data:; "
        "base-uri 'none'; form-action 'none'"
    )


def _hash(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode('ascii')}'"


def begun(words: str) -> str:
    """Words as the beginning of a sentence."""
    return words[:1].upper() + words[1:]


def sentence(words: str) -> str:
    """Words as a sentence that ends by itself."""
    ended = words.removesuffix(":").removesuffix(".")
    whole = begun(ended if ended.endswith("?") else f"{ended}.")
    return whole.replace(" %", "\u00a0%")  # on one line
