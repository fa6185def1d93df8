"""The report: one HTML file that shows a registration and its proof, and asks no other host."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from certreg import __version__
from certreg.registration import WEAK, ambiguous_words, headline_of, is_green
from certreg.report.any_report import (
    ASSETS,
    GUARANTEE_WORDS,
    AnyReport,
    begun,
    policy,
    required_proof,
    sentence,
)
from certreg.report.markup import asset, inert, inert_json, rendered
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
    from certreg.registration import Headline, Registration


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Report(AnyReport):
    """What a page shows of a registration."""

    registration: Registration

    @classmethod
    def of(cls, registration: Registration, *, documentation: str | None = None) -> Report:
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

    def html(self) -> bytes:
        """The file's content, in UTF-8."""
        names = Names.of(self.certificate.about, self.registration.problem.n)
        style, script = ((ASSETS / name).read_text("utf-8") for name in ("report.css", "report.js"))
        whole = rendered(
            "report/templates/report.html",
            policy=policy(style=style, script=script),
            style=asset("style", style),
            script=asset("script", script),
            version=__version__,
            names=names,
            documentation=self.documentation,
            **_head(self),
            **_body(self),
            **_blocks(self, names),
        )
        return f"{whole}\n".encode()


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
        "headline": sentence(said),
        "further": [begun(words) for words in further],
        "todo": [begun(words) for words in remedies(registration)],
        "warnings": [sentence(words) for words in warnings(registration, headline)],
        "overview": Overview.of(registration),
    }


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
        "file": report.file,
        "digest": registration.problem.digest(),
        "checked": report.verdict.theorems,
    }
