"""The sections of a still page: where the body can rest, and how it moved; and its picture."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from certreg._loading import late
from certreg.equilibrium.line_set import Finiteness
from certreg.errors import MissingToolError
from certreg.problem.motion import ROTATION, TRANSLATION
from certreg.report.equilibria import (
    inside_out_words,
    rests_beside,
    scaled_count_words,
    spring_notes,
    spring_rests,
)
from certreg.report.lines import away_words, step_words
from certreg.report.parts import listed, sprung
from certreg.report.picture import (
    CLOUDS,
    ON_PAGE,
    Picture,
    energy_picture,
    registration_picture,
    scale_picture,
    shown_words,
    springs_picture,
)
from certreg.report.pose_facts import Fact
from certreg.report.pose_words import PLACE
from certreg.report.scale import rests_of
from certreg.report.sections import Curve, Section, Table
from certreg.report.sentences import begun, sentence
from certreg.report.simulation import motion_beside
from certreg.results import Absent, Guarantee

if TYPE_CHECKING:
    from certreg.registration import equilibria
    from certreg.registration.equilibria import SpringEquilibrium
    from certreg.registration.result import Registration
else:
    equilibria = late("certreg.registration.equilibria")

COUNTED = {  # on what the number of equilibria of springs rests
    Finiteness.FORTY: ("forty_lines",),
    Finiteness.FOUR: ("eigenvectors", "classification"),
}
MOST_RELEASED = 8  # stable ones of which a run is made: more than eight were never seen
TRAP = "stable, and wrong"
RETURNS = "a body comes back"
CAME_BACK = (
    "A body comes back: released at rest, turned by 1°, it came to rest within 0.1° of where it "
    "was, as seen in doubles."
)
SPRUNG = "The target as rings, the source at the pose as dots. The orange lines are the springs"
MOVES = ((ROTATION, "turns"), (TRANSLATION, "moves"))
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
class Listed:
    """What the page says of the equilibria of general springs.

    complete: whether these are proved to be all, and finitely many. theorems: that show it.
    """

    words: str
    table: Table | None = None
    notes: tuple[str, ...] = ()
    complete: bool = False
    guarantee: Guarantee = Guarantee.NUMERICAL
    theorems: tuple[str, ...] = ()

    @property
    def section(self) -> Section:
        """As a page shows it."""
        return Section(
            name="listed",
            title="All equilibria of these springs",
            words=(self.words,),
            table=self.table,
            notes=self.notes,
        )


def springs_listed(registration: Registration) -> Listed | None:
    """All equilibria of these springs; None where nothing can be listed.

    Without python-flint no rows, and the words say so: the proof of the optimum needs no list.
    """
    own = sprung(registration)
    if own is None:
        return None
    problem, objective = own.problem, own.solution.objective
    try:
        found = equilibria.listed_springs(problem, objective)
    except MissingToolError as error:
        return Listed(words=f"None is listed here: {error}.")
    if found is None:
        return None
    told, parts = spring_rests(found), found.components
    stable = [part for part in parts if part.stable][:MOST_RELEASED]
    kept = {id(part) for part in stable if equilibria.returns(problem, objective, part)}
    rows = [
        (*cells, _with(words, part, returned=id(part) in kept))
        for (*cells, words), part in zip(told.rows, parts, strict=True)
    ]
    traps = frozenset(k for k, part in enumerate(parts) if is_trap(part))
    return Listed(
        words=told.headline,
        table=Table(head=told.head, rows=rows, stressed=traps) if rows else None,
        notes=(*spring_notes(found), *[CAME_BACK] * bool(kept)),
        complete=found.count is not None,
        guarantee=found.guarantee,
        theorems=COUNTED.get(found.finiteness, ()),
    )


def is_trap(part: SpringEquilibrium) -> bool:
    """Whether an equilibrium is stable, and not the optimum."""
    return part.stable is True and part.optimal is False


def _with(words: str, part: SpringEquilibrium, *, returned: bool) -> str:
    """The words of a row, and what a body does there."""
    return "; ".join(filter(None, (words, TRAP * is_trap(part), RETURNS * returned)))


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
    told, found = rests_beside(registration), rests_of(registration)
    words, rows, after = TURNS, told.rows, tuple[str, ...]()
    if found is not None:
        words = SAME_SIZE
        if found.breathing is not None:
            motion = registration.problem.motion
            moves = " ".join([", ".join(motion.entries(MOVES)), *motion.lacking(PLACE)])
            words = BREATHES.format(moves=moves)
            after = (sentence(scaled_count_words(found)), inside_out_words(found.breathing))
    return Section(
        name="listed",
        title="Every pose at which it can rest",
        lead=words,
        table=Table(head=told.head, rows=rows) if rows else None,
        after=after,
    )


def _moved(registration: Registration) -> Section:
    """How the simulated motion ended, what is proved of it, curves over time."""
    told, name, title = motion_beside(registration), "moved", "How it moved"
    if isinstance(told, Absent):
        words = sentence(f"{NO_MOTION}{told.reason}")
        return Section(name=name, title=title, words=(words,))
    run, away = told.run, registration.solution.agreement.simulation
    facts = [
        Fact(name="Steps", value=str(run.steps), words=step_words(run.step)),
        Fact(name="Time", value=f"{run.times[-1]:.6g}", words="in units of the springs"),
        Fact(name="Escapes", value=str(run.escapes), words="kicked off a saddle"),
    ]
    if away is not None:
        unique = registration.equilibria.classification.unique
        facts.append(Fact(name="End", value="", words=away_words(away, unique=unique)))
    facts += [Fact(name=row.capitalize(), value="", words=words) for row, words in told.state]
    curves = ("Energy", energy_picture(run)), ("Scale", scale_picture(run))
    return Section(
        name=name,
        title=title,
        words=(run.outcome,),
        facts=facts,
        curves=[Curve(name=name, picture=one) for name, one in curves if one is not None],
        after=(told.last,) if told.state else (),
    )
