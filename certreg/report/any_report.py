"""What the pages of all registrations share: the certificate in them, the policy, the sentences."""

from __future__ import annotations

import base64
import hashlib
import shlex
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib.resources import files
from typing import TYPE_CHECKING, Any, Generic, Self, TypeVar

from certreg import __version__
from certreg.report.markup import asset, printable, rendered
from certreg.report.sentences import THEOREMS, begun, sentence
from certreg.report.viewer import Names

if TYPE_CHECKING:
    from certreg.certificate.envelope import Certificate
    from certreg.registration.result import Registration
    from certreg.results import Verdict


R = TypeVar("R", bound="Registration")

ASSETS = files("certreg.report") / "assets"
GUARANTEE_WORDS = (
    "Exact: integer arithmetic and a theorem. Numerical: computed with rounding that nobody has "
    "bounded. Each theorem has a page in the documentation; certreg derive NAME proves it anew."
)
EMBEDDED_BYTES = 8 << 20  # of a certificate in its page; a larger one is named there


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AnyReport(ABC, Generic[R]):
    """What a page shows of a registration.

    content: the bytes of the certificate's file, name: what it is called. verdict: the checker's,
    on these; the registration's bounds are those that it proves. weak: they are far from what can
    be proved. documentation: where its pages lie, to link to.
    """

    registration: R
    certificate: Certificate[Any]
    content: bytes
    verdict: Verdict
    name: str = "certificate.json"
    weak: bool = False
    documentation: str | None = None

    @classmethod
    def of(cls, registration: R, *, documentation: str | None = None) -> Self:
        """The report of a registration just made. Raises ValueError where it is not certified."""
        certificate, verdict = required_proof(registration)
        return cls(
            registration=registration,
            certificate=certificate,
            content=certificate.to_json(),
            verdict=verdict,
            documentation=documentation,
        )

    @property
    def template(self) -> str:
        """Of the page: still pictures."""
        return "report/templates/still.html"

    @property
    def script(self) -> str | None:
        """One of the assets, where there is something to run."""
        return None

    @property
    @abstractmethod
    def digested(self) -> str:
        """What the digest binds, in words."""

    @property
    def guarantees(self) -> str:
        """What the words mean that say how something is known."""
        return GUARANTEE_WORDS

    @property
    def embedded(self) -> bool:
        """Whether the page carries the certificate; a large one it only names."""
        return len(self.content) <= EMBEDDED_BYTES

    @property
    def certificate_link(self) -> str | None:
        """The certificate as a link to itself, for a page without a script that could save it."""
        if not self.embedded:
            return None
        return f"data:application/json;base64,{base64.b64encode(self.content).decode('ascii')}"

    @property
    def file(self) -> dict[str, Any]:
        """The certificate's file: in the page, or named there."""
        return file_fields(self)

    def html(self) -> bytes:
        """The file's content, in UTF-8."""
        problem = self.registration.problem
        style = (ASSETS / "report.css").read_text("utf-8")
        script = None if self.script is None else (ASSETS / self.script).read_text("utf-8")
        names = Names.of(self.certificate.about, problem.n)
        whole = rendered(
            self.template,
            policy=policy(style=style, script=script),
            style=asset("style", style),
            script=None if script is None else asset("script", script),
            scripted=script is not None,
            version=__version__,
            names=names,
            pairs=pairs_words(problem.n),
            documentation=self.documentation,
            guarantee_words=self.guarantees,
            theorems=THEOREMS,
            file=self.file,
            digested=self.digested,
            digest=problem.digest(),
            checked=self.verdict.theorems,
            **self.values(names),
        )
        return f"{whole}\n".encode()

    @abstractmethod
    def values(self, names: Names) -> Mapping[str, Any]:
        """What the template of these registrations takes besides."""


def pairs_words(n: int) -> str:
    """How many pairs there are."""
    return f"{n} pair{'s' * (n != 1)}"


def head_of(
    headline: str,
    *,
    further: Iterable[str],
    todo: Iterable[str],
    warnings: Iterable[str],
) -> dict[str, Any]:
    """What is said first, of a headline `STAMP: words`."""
    stamp, _, said = headline.partition(": ")
    return {
        "stamp": stamp,
        "headline": sentence(said),
        "further": [begun(words) for words in further],
        "todo": [begun(words) for words in todo],
        "warnings": [sentence(words) for words in warnings],
    }


def file_fields(report: AnyReport[Any]) -> dict[str, Any]:
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


def required_proof(registration: Registration) -> tuple[Certificate[Any], Verdict]:
    """The certificate and the checker's verdict. Raises ValueError where there is none."""
    certificate, verdict = registration.certificate, registration.verdict
    if certificate is None or verdict is None:
        raise ValueError("the registration is not certified: there is no certificate to report")
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
