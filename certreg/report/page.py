"""The report: one HTML file that shows a registration and its proof, and asks no other host."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from certreg.registration.ambiguity import ambiguous_words
from certreg.registration.headlines import WEAK, headline_of, is_green
from certreg.registration.result import Registration
from certreg.report.any_report import AnyReport, head_of
from certreg.report.lines import verdict_words, warnings
from certreg.report.markup import inert, inert_json
from certreg.report.overview import Overview
from certreg.report.remedies import remedies
from certreg.report.viewer import (
    packed,
    sample_of,
    scene_document,
    told_rmse,
    viewer_words,
)
from certreg.report.words import (
    NOT_CLAIMED,
    MethodAngles,
    sentences,
    trap_words,
    weak_words,
)
from certreg.results import Optimality

if TYPE_CHECKING:
    from collections.abc import Mapping

    from certreg.registration.headlines import Headline
    from certreg.report.viewer import Names


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Report(AnyReport[Registration]):
    """What a page shows of a registration with one weight for each pair."""

    TEMPLATE: ClassVar = "report/templates/report.html"
    SCRIPT: ClassVar = "report.js"
    DIGESTED: ClassVar = "points and weights"

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

    def head(self) -> dict[str, Any]:
        """The headline, whether it is a good one, and what else comes first."""
        registration = self.registration
        headline, *further = self.verdict_words
        warned = warnings(registration, headline)
        stamp, _, said = headline.partition(": ")
        tie = ambiguous_words(registration.equilibria)
        if tie in further and stamp.endswith("NEARLY AMBIGUOUS"):  # not to be in smaller print
            others = [words for words in further if words != tie]
            headline, further = f"{stamp}: {tie}", [f"Proved: {said}", *others]
        return {
            **head_of(headline, further=further, todo=remedies(registration), warnings=warned),
            "good": self.headline is not WEAK and is_green(registration),
        }

    def values(self, names: Names) -> Mapping[str, Any]:
        """Verdict, warnings, pose and fit; scene, charts, what is proved; what the script reads."""
        registration = self.registration
        angles = MethodAngles.of(registration.solution.agreement)
        return {
            **self.head(),
            **_blocks(self, names),
            "overview": Overview.of(registration),
            "viewer": viewer_words(registration),
            "trap": trap_words(registration.equilibria, told_rmse(registration)),
            "known": sentences(registration, self.certificate.body, angles),
            "not_claimed": NOT_CLAIMED,
        }


def _blocks(report: Report, names: Names) -> dict[str, Any]:
    """What the page's script reads."""
    sampled = report.certificate.data is None or not report.embedded
    problem = report.registration.problem
    return {
        "scene_data": inert_json(scene_document(report.registration, names)),
        "certificate_data": inert(packed(report.content)) if report.embedded else None,
        "sample_data": inert(sample_of(problem)) if sampled else None,
    }
