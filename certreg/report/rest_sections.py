"""The sections of a still page: where the body can rest, and how it moved; and its picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.registration.breathing import SimulatedBreathing
from certreg.report.breathing import HEADINGS as SCALED_HEADINGS
from certreg.report.breathing import (
    inside_out_words,
    scaled_count_words,
    scaled_rows,
)
from certreg.report.equilibria import HEADINGS, equilibria_rows
from certreg.report.lines import away_words, step_words
from certreg.report.parts import listed
from certreg.report.picture import (
    CLOUDS,
    ON_PAGE,
    energy_picture,
    registration_picture,
    scale_picture,
    shown_words,
    springs_picture,
)
from certreg.report.pose_facts import Fact
from certreg.report.scale import rests_of
from certreg.report.sections import Curve, Section, Table
from certreg.report.sentences import begun, sentence
from certreg.report.simulation import keeps_words, scale_course
from certreg.results import Absent

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from certreg.registration.result import Registration
    from certreg.report.picture import Picture
    from certreg.report.spring_listed import Listed

SPRUNG = "The target as rings, the source at the pose as dots. The orange lines are the springs"
TURNS_ALONE = "turns about the origin"
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


def still_picture(registration: Registration) -> tuple[Picture | None, str]:
    """The clouds, with a piece of each plane and line; and what is to be seen."""
    springs = registration.problem.springs
    if springs is None:
        words = f"{begun(CLOUDS)}{shown_words(registration)}."
        return registration_picture(registration), words
    shown = shown_words(registration, ON_PAGE)
    head = f"{begun(shown.removeprefix('; '))}. {SPRUNG}" if shown else SPRUNG
    return springs_picture(registration), f"{head}{_pieces_words(springs.ranks)}"


def _pieces_words(ranks: Sequence[int]) -> str:
    """What the picture shows of planes and lines."""
    planes, lines = ranks[1], ranks[2]
    if not planes + lines:
        return "; how much one counts depends on its direction."
    kinds = " or ".join([*["plane"] * bool(planes), *["line"] * bool(lines)])
    pieces = " and ".join([*["squares"] * bool(planes), *["strokes"] * bool(lines)])
    return (
        f": each ends where its {kinds} is nearest. The grey {pieces} are pieces of these, "
        "of a size that means nothing. A pair need not meet: only what is off along its springs "
        "counts."
    )


def rest_sections(registration: Registration, found: Listed | None) -> Iterator[Section]:
    """All equilibria, and the motion; found: those of general springs."""
    own = listed(registration)
    if found is not None:
        yield found.section
    if own is not None:
        yield _rests(own)
        yield _moved(own)


def _rests(registration: Registration) -> Section:
    """What moves, a table, and the states with a scale below 0."""
    found, after = rests_of(registration), tuple[str, ...]()
    head, rows, words = HEADINGS, equilibria_rows(registration.equilibria), TURNS
    if found is not None:
        head, rows, words = SCALED_HEADINGS, scaled_rows(found), SAME_SIZE
        if found.breathing is not None:
            turns = "turns, moves" if registration.problem.motion.translations else TURNS_ALONE
            words = BREATHES.format(moves=turns)
            after = (sentence(scaled_count_words(found)), inside_out_words(found.breathing))
    return Section(
        name="listed",
        title="Every pose at which it can rest",
        lead=words,
        table=Table(head=head, rows=rows) if rows else None,
        after=after,
    )


def _moved(registration: Registration) -> Section:
    """How the simulated motion ended, what is proved of it, curves over time."""
    run, name, title = registration.solution.trajectory, "moved", "How it moved"
    if isinstance(run, Absent):
        words = sentence(f"{NO_MOTION}{run.reason}")
        return Section(name=name, title=title, words=(words,))
    away = registration.solution.agreement.simulation
    facts = [
        Fact(name="Steps", value=str(run.steps), words=step_words(run.step)),
        Fact(name="Time", value=f"{run.times[-1]:.6g}", words="in units of the springs"),
        Fact(name="Escapes", value=str(run.escapes), words="kicked off a saddle"),
    ]
    if away is not None:
        unique = registration.equilibria.classification.unique
        facts.append(Fact(name="End", value="", words=away_words(away, unique=unique)))
    curves, after = [("Energy", energy_picture(run))], tuple[str, ...]()
    if isinstance(run, SimulatedBreathing):
        facts.append(Fact(name="Scale", value="", words=scale_course(run)))
        curves.append(("Scale", scale_picture(run)))
        after = (keeps_words(run),)
    return Section(
        name=name,
        title=title,
        words=(run.status.value,),
        facts=facts,
        curves=[Curve(name=name, picture=one) for name, one in curves if one is not None],
        after=after,
    )
