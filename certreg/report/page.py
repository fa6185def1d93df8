"""The report: one HTML file that shows a registration and its proof, and asks no other host."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from certreg._loading import late
from certreg.registration.ambiguity import ambiguous_words
from certreg.registration.headlines import WEAK, Headline, headline_of, is_green
from certreg.registration.result import Registration
from certreg.report.any_report import GUARANTEE_WORDS, AnyReport, head_of
from certreg.report.lines import verdict_words, warnings
from certreg.report.markup import inert, inert_json
from certreg.report.overview import Overview, untested_words
from certreg.report.parts import listed, sprung
from certreg.report.remedies import remedies
from certreg.report.scene_words import trap_words
from certreg.report.sections import worst_section
from certreg.report.viewer import Names, packed, sample_of, scene_document, told_rmse, viewer_words
from certreg.report.words import not_claimed, sentences, weak_words
from certreg.results import Optimality

if TYPE_CHECKING:
    from certreg.report import rest_sections
else:
    rest_sections = late("certreg.report.rest_sections")


WEAK_WORDS = "The certificate that certreg certify writes for these points and springs proves more."
ENCLOSED_WORDS = GUARANTEE_WORDS.replace(
    "Numerical:", "Enclosed: each rotation alone in a box, by ball arithmetic. Numerical:"
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Report(AnyReport[Registration]):
    """What a page shows of a registration by least squares."""

    @property
    def moving(self) -> Registration | None:
        """The registration, where it is shown in a moving scene: weights, and a rigid motion."""
        own = listed(self.registration)
        return None if own is None or own.problem.motion.options else own

    @property
    def template(self) -> str:
        """A page with a script, or of still pictures."""
        return f"report/templates/{'still' if self.moving is None else 'report'}.html"

    @property
    def script(self) -> str | None:
        """That of the moving scene."""
        return None if self.moving is None else "report.js"

    @property
    def digested(self) -> str:
        """What the digest binds, in words."""
        return f"points and {'weights' if sprung(self.registration) is None else 'springs'}"

    @property
    def guarantees(self) -> str:
        """What the words mean that say how something is known."""
        return GUARANTEE_WORDS if sprung(self.registration) is None else ENCLOSED_WORDS

    @property
    def headline(self) -> Headline:
        """Which headline the page has: that of a weak certificate is no better than it is."""
        if self.weak and self.registration.status is not Optimality.BOUNDED:
            return WEAK
        return headline_of(self.registration)

    @property
    def verdict_words(self) -> list[str]:
        """What this certificate proves of the pose: a headline, then what else comes first."""
        own, (headline, *further) = listed(self.registration), verdict_words(self.registration)
        weak = self.headline is WEAK
        if own is None:
            return [WEAK.said(), headline, *further, WEAK_WORDS] if weak else [headline, *further]
        said = [weak_words(own)] if self.weak else []
        return [WEAK.said() if weak else headline, *said, *further]

    def head(self) -> dict[str, Any]:
        """The headline, whether it is a good one, and what else comes first."""
        registration = self.registration
        headline, *further = self.verdict_words
        warned = warnings(registration, headline)
        stamp, _, said = headline.partition(": ")
        tie = None
        if registration.equilibria is not None:
            tie = ambiguous_words(registration.equilibria)
        if tie in further and stamp.endswith("NEARLY AMBIGUOUS"):  # not to be in smaller print
            others = [words for words in further if words != tie]
            headline, further = f"{stamp}: {tie}", [f"Proved: {said}", *others]
        return {
            **head_of(headline, further=further, todo=remedies(registration), warnings=warned),
            "good": self.headline is not WEAK and is_green(registration),
        }

    def values(self, names: Names) -> Mapping[str, Any]:
        """Verdict, warnings, pose and fit; a scene or sections; what is proved, and what not."""
        registration, moving = self.registration, self.moving
        found, untested = None, ""
        if registration.equilibria is None:
            found = rest_sections.springs_listed(registration)
        elif registration.problem.motion.options:
            untested = untested_words(registration)
        return {
            **self.head(),
            "overview": Overview.of(registration),
            **(_sections(self, names, found) if moving is None else _scene(self, moving, names)),
            "known": sentences(registration, self.certificate.body, found),
            "not_claimed": not_claimed(registration, found, untested),
        }


def _scene(report: Report, registration: Registration, names: Names) -> dict[str, Any]:
    """The moving scene, and what its script reads."""
    sampled = report.certificate.data is None or not report.embedded
    return {
        "viewer": viewer_words(registration),
        "trap": trap_words(registration.equilibria, told_rmse(registration)),
        "scene_data": inert_json(scene_document(registration, names)),
        "certificate_data": inert(packed(report.content)) if report.embedded else None,
        "sample_data": inert(sample_of(registration.problem)) if sampled else None,
    }


def _sections(report: Report, names: Names, found: Any) -> dict[str, Any]:
    """A still picture, and sections: where the body can rest, how it moved, the worst pairs."""
    registration = report.registration
    picture, words = rest_sections.still_picture(registration)
    return {
        "picture": picture,
        "picture_words": words,
        "pairs_shown": False,
        "sections": [
            *rest_sections.rest_sections(registration, found),
            worst_section(registration, names),
        ],
        "certificate_link": report.certificate_link,
    }
