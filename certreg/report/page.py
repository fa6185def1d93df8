"""The report: one HTML file that shows a registration and its proof, and asks no other host."""

from __future__ import annotations

import base64
import hashlib
import shlex
from dataclasses import dataclass
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from certreg import __version__
from certreg.registration import WEAK, ambiguous_words, headline_of, is_green
from certreg.report.markup import asset, inert, inert_json, printable, rendered
from certreg.report.overview import Overview
from certreg.report.remedies import remedies
from certreg.report.summary import verdict_words, warnings
from certreg.report.viewer import (
    Names,
    packed,
    sample_of,
    scene_document,
    told_rmse,
    viewer_words,
)
from certreg.report.words import (
    NOT_CLAIMED,
    THEOREMS,
    MethodAngles,
    sentences,
    trap_words,
    weak_words,
)
from certreg.results import Optimality

if TYPE_CHECKING:
    from certreg.certificate import Certificate, IsotropicBody
    from certreg.registration import Headline, Registration
    from certreg.results import Verdict

ASSETS = files("certreg.report") / "assets"
GUARANTEE_WORDS = (
    "Exact: integer arithmetic and a theorem. Numerical: computed with rounding that nobody has "
    "bounded. Each theorem has a page in the documentation; certreg derive NAME proves it anew."
)
EMBEDDED_BYTES = 8 << 20  # of a certificate in its page; a larger one is named there


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Report:
    """What a page shows.

    content: the bytes of the certificate's file, name: what it is called. verdict: the checker's,
    on these; the registration's bounds are those that it proves. weak: they are far from what can
    be proved. documentation: where its pages lie, to link to.
    """

    registration: Registration
    certificate: Certificate[IsotropicBody]
    content: bytes
    verdict: Verdict
    name: str = "certificate.json"
    weak: bool = False
    documentation: str | None = None

    @classmethod
    def of(cls, registration: Registration, *, documentation: str | None = None) -> Report:
        """The report of a registration just made. Raises ValueError where it is not certified."""
        certificate, verdict = registration.certificate, registration.verdict
        if certificate is None or verdict is None:
            message = "the registration is not certified: there is no certificate to report"
            raise ValueError(message)
        return cls(
            registration=registration,
            certificate=certificate,
            content=certificate.to_json(),
            verdict=verdict,
            documentation=documentation,
        )

    @property
    def embedded(self) -> bool:
        """Whether the page carries the certificate; a large one it only names."""
        return len(self.content) <= EMBEDDED_BYTES

    @property
    def verdict_words(self) -> list[str]:
        """What this certificate proves of the pose: a headline, then what else comes first."""
        headline, *further = verdict_words(self.registration)
        if self.headline is WEAK:
            headline = WEAK.said()
        return [headline, *([weak_words(self.registration)] if self.weak else []), *further]

    @property
    def headline(self) -> Headline:
        """Which headline the page has: that of a weak certificate is no better than it is."""
        if self.weak and self.registration.status is not Optimality.BOUNDED:
            return WEAK
        return headline_of(self.registration)


def html_page(report: Report) -> bytes:
    """The file's content, in UTF-8."""
    names = Names.of(report.certificate.about, report.registration.problem.n)
    style, script = ((ASSETS / name).read_text("utf-8") for name in ("report.css", "report.js"))
    whole = rendered(
        "report/templates/report.html",
        policy=_policy(style, script),
        style=asset("style", style),
        script=asset("script", script),
        version=__version__,
        names=names,
        documentation=report.documentation,
        **_head(report),
        **_body(report),
        **_blocks(report, names),
    )
    return f"{whole}\n".encode()


def _policy(style: str, script: str) -> str:
    """Nothing is loaded from anywhere; only these two texts are style and script."""
    hashes = [base64.b64encode(hashlib.sha256(t.encode()).digest()) for t in (style, script)]
    styles, scripts = (f"'sha256-{digest.decode('ascii')}'" for digest in hashes)
    return (
        f"default-src 'none'; style-src {styles}; script-src {scripts}; img-src data:; "
        "base-uri 'none'; form-action 'none'"
    )


def _blocks(report: Report, names: Names) -> dict[str, Any]:
    """What the page's script reads."""
    sampled = report.certificate.data is None or not report.embedded
    problem = report.registration.problem
    return {
        "scene_data": inert_json(scene_document(report.registration, names)),
        "certificate_data": inert(packed(report.content)) if report.embedded else None,
        "sample_data": inert(sample_of(problem)) if sampled else None,
    }


def _head(report: Report) -> dict[str, Any]:
    """What is said first: the verdict, warnings, the pose, the fit."""
    registration = report.registration
    headline, *further = report.verdict_words
    stamp, _, said = headline.partition(": ")
    tie = ambiguous_words(registration.equilibria)
    if tie in further and stamp.endswith("NEARLY AMBIGUOUS"):  # not to be in smaller print
        others = [words for words in further if words != tie]
        said, further = tie, [f"Proved: {said}", *others]
    n = registration.problem.n
    return {
        "pairs": f"{n} pair{'s' * (n != 1)}",
        "stamp": stamp,
        "good": report.headline is not WEAK and is_green(registration),
        "headline": _sentence(said),
        "further": [_begun(words) for words in further],
        "todo": [_begun(words) for words in remedies(registration)],
        "warnings": [_sentence(words) for words in warnings(registration, headline)],
        "overview": Overview.of(registration),
    }


def _begun(words: str) -> str:
    return words[:1].upper() + words[1:]


def _sentence(words: str) -> str:
    """Words as a sentence that ends by itself."""
    ended = words.removesuffix(":").removesuffix(".")
    whole = _begun(ended if ended.endswith("?") else f"{ended}.")
    return whole.replace(" %", "\u00a0%")  # on one line


def _body(report: Report) -> dict[str, Any]:
    """The sections below: scene, charts, what is proved, how to check it, the pose."""
    registration = report.registration
    angles = MethodAngles.of(registration.solution.agreement)
    return {
        "viewer": viewer_words(registration),
        "trap": trap_words(registration.equilibria, told_rmse(registration)),
        "guarantee_words": GUARANTEE_WORDS,
        "known": sentences(registration, report.certificate.body, angles),
        "theorems": THEOREMS,
        "not_claimed": NOT_CLAIMED,
        "file": _file(report),
        "digest": registration.problem.digest(),
        "checked": report.verdict.theorems,
    }


def _file(report: Report) -> dict[str, Any]:
    """The certificate's file: in the page, or named there."""
    name = printable(report.name)
    return {
        "embedded": report.embedded,
        "name": name,
        "argument": "certificate.json" if report.embedded else shlex.quote(name),
        "mebibytes": len(report.content) / 2**20,
        "most": f"{EMBEDDED_BYTES / 2**20:.0f}",
        "sha256": hashlib.sha256(report.content).hexdigest(),
    }
