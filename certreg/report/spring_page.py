"""The report on general springs: one HTML file with still pictures, that asks no other host."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from certreg import __version__
from certreg.registration import WEAK, is_green_spring
from certreg.report.any_report import (
    ASSETS,
    GUARANTEE_WORDS,
    AnyReport,
    begun,
    policy,
    required_proof,
    sentence,
)
from certreg.report.markup import asset, rendered
from certreg.report.picture import registration_picture
from certreg.report.spring_overview import spring_overview
from certreg.report.spring_summary import spring_remedies, spring_verdict_words, spring_warnings
from certreg.report.spring_words import NOT_CLAIMED_OF_SPRINGS, spring_sentences
from certreg.report.summary import number
from certreg.report.viewer import Names
from certreg.report.words import THEOREMS
from certreg.results import Optimality

if TYPE_CHECKING:
    from certreg.registration import SpringRegistration

PICTURE_WORDS = (
    "The target as rings, the source at the pose as dots. The lines are the springs: each ends "
    "where its plane or line is nearest. A pair need not meet: only what is off along its springs "
    "counts."
)
WEAK_WORDS = "The certificate that certreg certify writes for these points and springs proves more."


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SpringReport(AnyReport):
    """What a page shows of a registration on general springs."""

    registration: SpringRegistration

    @classmethod
    def of(
        cls, registration: SpringRegistration, *, documentation: str | None = None
    ) -> SpringReport:
        """The report of a registration just made. Raises ValueError where it is not certified."""
        certificate, verdict = required_proof(registration)
        return cls(
            registration=registration,
            certificate=certificate,
            content=certificate.to_json(),
            verdict=verdict,
            documentation=documentation,
        )

    def html(self) -> bytes:
        """The file's content, in UTF-8."""
        registration, certificate = self.registration, self.certificate
        style = (ASSETS / "report.css").read_text("utf-8")
        names = Names.of(certificate.about, registration.problem.n)
        picture = registration_picture(registration)
        whole = rendered(
            "report/templates/springs.html",
            policy=policy(style=style),
            style=asset("style", style),
            version=__version__,
            names=names,
            documentation=self.documentation,
            overview=spring_overview(registration),
            picture=picture,
            picture_words=PICTURE_WORDS,
            guarantee_words=GUARANTEE_WORDS,
            known=spring_sentences(registration),
            theorems=THEOREMS,
            not_claimed=NOT_CLAIMED_OF_SPRINGS,
            labelled=names.labels is not None,
            worst=[
                {"row": one.row, "label": one.label or "", "words": number(one.residual)}
                for one in registration.fit.worst
            ],
            file=self.file,
            certificate_link=self._link() if self.embedded else None,
            digest=registration.problem.digest(),
            checked=self.verdict.theorems,
            **_head(self),
        )
        return f"{whole}\n".encode()

    def _link(self) -> str:
        """The certificate as a link to itself: the page has no script that could save it."""
        return f"data:application/json;base64,{base64.b64encode(self.content).decode('ascii')}"


def _head(report: SpringReport) -> dict[str, Any]:
    """What is said first: the verdict, warnings, what to do."""
    registration = report.registration
    headline, *further = spring_verdict_words(registration)
    weak = report.weak and registration.status is not Optimality.BOUNDED
    if weak:
        further, headline = [headline, *further, WEAK_WORDS], WEAK.said()
    stamp, _, said = headline.partition(": ")
    n = registration.problem.n
    return {
        "pairs": f"{n} pair{'s' * (n != 1)}",
        "stamp": stamp,
        "good": not weak and is_green_spring(registration),
        "headline": sentence(said),
        "further": [begun(words) for words in further],
        "todo": [begun(words) for words in spring_remedies(registration)],
        "warnings": [sentence(words) for words in spring_warnings(registration, headline)],
    }
