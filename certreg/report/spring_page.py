"""The report on general springs: one HTML file with still pictures, that asks no other host."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from certreg.registration.headlines import WEAK, is_green
from certreg.registration.quartic import QuarticSolution
from certreg.registration.result import Registration
from certreg.report.any_report import AnyReport, head_of, worst_rows
from certreg.report.picture import ON_PAGE, shown_words, springs_picture
from certreg.report.spring_listed import listed
from certreg.report.spring_overview import spring_overview
from certreg.report.spring_summary import spring_remedies, spring_verdict_words, spring_warnings
from certreg.report.spring_words import not_claimed_of_springs, spring_sentences
from certreg.report.words import begun
from certreg.results import Optimality

if TYPE_CHECKING:
    from collections.abc import Mapping

    from certreg.report.viewer import Names


CLOUDS = "The target as rings, the source at the pose as dots. The orange lines are the springs"
WEAK_WORDS = "The certificate that certreg certify writes for these points and springs proves more."


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SpringReport(AnyReport[Registration[QuarticSolution]]):
    """What a page shows of a registration on general springs."""

    TEMPLATE: ClassVar = "report/templates/springs.html"
    DIGESTED: ClassVar = "points and springs"
    GUARANTEES: ClassVar = (
        "Exact: integer arithmetic and a theorem. Enclosed: each rotation alone in a box, by ball "
        "arithmetic. Numerical: computed with rounding that nobody has bounded. Each theorem has a "
        "page in the documentation; certreg derive NAME proves it anew."
    )

    def values(self, names: Names) -> Mapping[str, Any]:
        """Verdict, warnings, pose and fit; the picture, the worst pairs, what is proved."""
        registration = self.registration
        equilibria = listed(registration)
        return {
            **_head(self),
            "overview": spring_overview(registration),
            "picture": springs_picture(registration),
            "picture_words": picture_words(registration),
            "known": spring_sentences(registration, equilibria),
            "not_claimed": not_claimed_of_springs(registration, equilibria),
            "listed": equilibria,
            "labelled": names.labels is not None,
            "worst": worst_rows(registration),
            "certificate_link": self.certificate_link,
        }


def picture_words(registration: Registration[QuarticSolution]) -> str:
    """What the picture shows of these springs, and of how many."""
    springs = registration.problem.springs
    planes, lines = (springs.ranks[1], springs.ranks[2]) if springs is not None else (0, 0)
    shown = shown_words(registration, ON_PAGE)
    head = f"{begun(shown.removeprefix('; '))}. {CLOUDS}" if shown else CLOUDS
    if not planes + lines:
        return f"{head}; how much one counts depends on its direction."
    kinds = " or ".join([*["plane"] * bool(planes), *["line"] * bool(lines)])
    pieces = " and ".join([*["squares"] * bool(planes), *["strokes"] * bool(lines)])
    return (
        f"{head}: each ends where its {kinds} is nearest. The grey {pieces} are pieces of these, "
        "of a size that means nothing. A pair need not meet: only what is off along its springs "
        "counts."
    )


def _head(report: SpringReport) -> dict[str, Any]:
    registration = report.registration
    headline, *further = spring_verdict_words(registration)
    weak = report.weak and registration.status is not Optimality.BOUNDED
    if weak:
        further, headline = [headline, *further, WEAK_WORDS], WEAK.said()
    todo, warned = spring_remedies(registration), spring_warnings(registration, headline)
    return {
        "good": not weak and is_green(registration),
        **head_of(headline, further=further, todo=todo, warnings=warned),
    }
