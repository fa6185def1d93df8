"""The report with a free scale, or without a translation: still pictures, and no script."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from certreg.registration.breathing import SimulatedBreathing, scaled_equilibria
from certreg.report.any_report import worst_rows
from certreg.report.breathing import HEADINGS as SCALED_HEADINGS
from certreg.report.breathing import (
    inside_out_words,
    keeps_words,
    scale_course,
    scaled_count_words,
    scaled_rows,
)
from certreg.report.lines import HEADINGS, away_words, equilibria_rows, step_words
from certreg.report.overview import Fact
from certreg.report.page import Report
from certreg.report.picture import (
    CLOUDS,
    energy_picture,
    registration_picture,
    scale_picture,
    shown_words,
)
from certreg.report.similarity_overview import similarity_overview
from certreg.report.similarity_words import not_claimed_of, similarity_sentences
from certreg.report.words import begun, sentence
from certreg.results import Absent

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from certreg.registration.result import Registration
    from certreg.report.picture import Picture
    from certreg.report.viewer import Names

NO_MOTION = "Nothing was moved: "
BREATHES = (
    "Each pair is joined by a spring, and the source {moves} and changes its size: a body that "
    "breathes. The index counts the independent directions in which the energy falls; with a scale "
    "above 0 it is 0 only at the best."
)
SAME_SIZE = (
    "The symmetric scale is the same whatever the rotation: a source of that size is a rigid body. "
    "The index counts the independent turns that lower the energy: 0 only at the best."
)
TURNS = (
    "Each pair is joined by a spring, and the source turns about the origin as one rigid body. "
    "The index counts the independent turns that lower the energy: 0 only at the best."
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Rests:
    """The section on equilibria: what moves, a table, and the states with a scale below 0."""

    words: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Curve:
    """A number over time."""

    name: str
    picture: Picture


@dataclass(frozen=True, slots=True, kw_only=True)
class Moved:
    """The section on the simulated motion: how it ended, what is proved of it, curves over time."""

    words: str
    note: str = ""
    facts: tuple[Fact, ...] = ()
    curves: tuple[Curve, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SimilarityReport(Report):
    """What a page shows of a registration with a free scale, or without a translation."""

    TEMPLATE: ClassVar = "report/templates/similarity.html"
    SCRIPT: ClassVar = None

    def values(self, names: Names) -> Mapping[str, Any]:
        """Verdict, pose with its scale and fit; where the body can rest, how it moved; proofs."""
        registration = self.registration
        return {
            **self.head(),
            "overview": similarity_overview(registration),
            "picture": registration_picture(registration),
            "picture_words": f"{begun(CLOUDS)}{shown_words(registration)}.",
            "rests": _rests(registration),
            "moved": _moved(registration),
            "known": similarity_sentences(registration, self.certificate.body),
            "not_claimed": not_claimed_of(registration),
            "labelled": names.labels is not None,
            "worst": worst_rows(registration),
            "certificate_link": self.certificate_link,
        }


def _rests(registration: Registration) -> Rests:
    equilibria = registration.equilibria
    if not registration.problem.scaled:
        return Rests(words=TURNS, head=HEADINGS, rows=equilibria_rows(equilibria))
    found = scaled_equilibria(registration.solution.objective, equilibria)
    rows, below = scaled_rows(found), found.breathing
    if below is None:
        return Rests(words=SAME_SIZE, head=SCALED_HEADINGS, rows=rows)
    notes = (sentence(scaled_count_words(found)), inside_out_words(below))
    moves = "turns about the origin" if registration.problem.rotation_only else "turns, moves"
    return Rests(words=BREATHES.format(moves=moves), head=SCALED_HEADINGS, rows=rows, notes=notes)


def _moved(registration: Registration) -> Moved:
    run = registration.solution.trajectory
    if isinstance(run, Absent):
        return Moved(words=sentence(f"{NO_MOTION}{run.reason}"))
    away = registration.solution.agreement.simulation
    facts = [
        Fact(name="Steps", value=str(run.steps), words=step_words(run.step)),
        Fact(name="Time", value=f"{run.times[-1]:.6g}", words="in units of the springs"),
        Fact(name="Escapes", value=str(run.escapes), words="kicked off a saddle"),
    ]
    if away is not None:
        unique = registration.equilibria.classification.unique
        facts.append(Fact(name="End", value="", words=away_words(away, unique=unique)))
    curves = [("Energy", energy_picture(run))]
    if isinstance(run, SimulatedBreathing):
        facts.append(Fact(name="Scale", value="", words=scale_course(run)))
        curves.append(("Scale", scale_picture(run)))
    return Moved(
        words=run.status.value,
        note=keeps_words(run) if isinstance(run, SimulatedBreathing) else "",
        facts=tuple(facts),
        curves=tuple(Curve(name=name, picture=one) for name, one in curves if one is not None),
    )
