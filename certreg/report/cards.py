"""Cards: results in a notebook, as HTML that loads nothing."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from certreg.registration.headlines import is_green
from certreg.report.lines import (
    OF_SPREAD,
    explained_words,
    margin_words,
    number,
    verdict_words,
    warnings,
)
from certreg.report.markup import printable, rendered
from certreg.report.parts import listed
from certreg.report.picture import Picture, registration_picture
from certreg.report.remedies import ADVICE, remedies
from certreg.report.springs import springs_words
from certreg.report.uncertainty import uncertainty_rows
from certreg.results import Brief

if TYPE_CHECKING:
    from certreg.certificate.checking import CertificateVerdict
    from certreg.registration.assessed import Assessment
    from certreg.registration.result import Registration


GREEN, AMBER = "#1f8d3e", "#bd5f00"  # 4.2 : 1 on white and on #131416, as a page is in the dark
TEMPLATE = "report/templates/card.html"


@dataclass(frozen=True, slots=True, kw_only=True)
class Card(Brief):
    """What `templates/card.html` shows.

    good: the headline is green, else amber; None for neither. facts: names and values. head, rows:
    of a table.
    """

    headline: str
    notes: Sequence[str]
    good: bool | None = None
    facts: Sequence[tuple[str, str]] = ()
    head: Sequence[str] = ()
    rows: Sequence[Sequence[str]] = ()
    picture: Picture | None = None

    def html(self) -> str:
        """The card."""
        return rendered(
            TEMPLATE,
            headline=printable(self.headline),
            notes=[printable(note) for note in self.notes],
            colour={True: GREEN, False: AMBER, None: "inherit"}[self.good],
            facts=self.facts,
            head=self.head,
            rows=self.rows,
            picture=self.picture,
        )


def registration_card(registration: Registration) -> str:
    """Verdict, pose with its deviations and fit of a registration, and a picture of it."""
    first, *further = verdict_words(registration)
    pose, own, springs = registration.pose, listed(registration), springs_words(registration)
    listed_facts: list[tuple[str, str]] = []
    if own is not None:
        explained = explained_words(own.fit).removesuffix(OF_SPREAD)
        margin = margin_words(own.equilibria)
        listed_facts = [("explained", explained), ("ambiguity margin", margin)]
    return Card(
        headline=first,
        notes=[
            *further,
            *(f"Warning: {words}" for words in warnings(registration, first)),
            *(f"{ADVICE}{words}" for words in remedies(registration)),
        ],
        good=is_green(registration),
        facts=[
            ("correspondences", f"{registration.problem.n:,}"),
            *([("springs", springs)] if springs else []),
            ("rotation (wxyz)", _numbers(pose.quaternion_wxyz.tolist())),
            ("translation", _numbers(pose.translation.tolist())),
            *_deviations(registration),
            ("RMSE", f"{number(registration.rmse)}{' along the springs' if springs else ''}"),
            *listed_facts,
        ],
        picture=registration_picture(registration),
    ).html()


def assessment_card(assessment: Assessment) -> str:
    """What is known of a pose."""
    away = assessment.angle_to_optimum
    facts = [
        ("RMSE", number(assessment.rmse)),
        ("angle to the optimum", f"{math.degrees(away or 0.0):.4g} degrees"),
    ]
    explained = assessment.hint or assessment.unexplained
    return Card(
        headline=assessment.headline,
        notes=[assessment.words, *([] if explained is None else [explained])],
        good=assessment.green,
        facts=[] if away is None else facts,
    ).html()


def verdict_card(verdict: CertificateVerdict) -> str:
    """The checker's answer."""
    first = "VERIFIED" if verdict.proved else f"REFUSED: {verdict.words}"
    return Card(headline=first, notes=verdict.theorems, good=verdict.proved).html()


def _deviations(registration: Registration) -> Iterator[tuple[str, str]]:
    """One standard deviation of each part of the pose, in few words; or why there is none."""
    for name, words in uncertainty_rows(registration):
        if name == "uncertainty":
            yield name, words
        elif name.endswith("±"):
            figures, _, rest = words.partition("  (")
            yield f"{name} 1σ", f"{figures}{rest.partition(')')[2]}"


def _numbers(values: Sequence[float]) -> str:
    return "  ".join(f"{value:.6g}" for value in values)
