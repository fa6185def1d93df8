"""Lists of equilibria in words: how many there are, how that is known, a table, notes.

One text, one document and one card; a function for each kind says what it adds.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from certreg._loading import late
from certreg.registration.ambiguity import ambiguous_words, narrow_words
from certreg.report.encoding import Document, encoded
from certreg.report.lines import margin_words, number
from certreg.report.scale import rests_of
from certreg.results import Brief, ComponentKind, Guarantee

if TYPE_CHECKING:
    from certreg.equilibrium import line_set
    from certreg.equilibrium.breathing import BreathingEquilibria
    from certreg.equilibrium.equilibrium_set import Component, EquilibriumSet
    from certreg.registration.enumeration import Enumeration, ListedEquilibria
    from certreg.registration.equilibria import (
        ScaledEquilibria,
        SpringEquilibria,
        SpringEquilibrium,
    )
    from certreg.registration.result import Registration
    from certreg.report import cards, equilibrium_fields, methods
else:
    line_set = late("certreg.equilibrium.line_set")
    cards = late("certreg.report.cards")
    equilibrium_fields = late("certreg.report.equilibrium_fields")
    methods = late("certreg.report.methods")

EQUILIBRIA_SCHEMA = "certreg-equilibria/1"
COUNTS = {0: "none", 1: "one", 2: "two", 3: "three", 4: "four"}
KINDS = {
    ComponentKind.POINT: "point",
    ComponentKind.CIRCLE: "circle",
    ComponentKind.PROJECTIVE_PLANE: "projective plane",
    ComponentKind.ROTATION_GROUP: "every rotation",
}
NOTHING = "0 to rounding"  # of a proved equilibrium: less than its energy is known to
NO_MINIMUM = (
    "None of these is the optimum: at the first, too, the energy falls in some direction. "
    "`certify` gives the best pose, and needs no list."
)
STAYS = (
    "A body that is released near a stable equilibrium stays there: not every stable one is the "
    "optimum."
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Rests(Brief):
    """What is said of a list of equilibria.

    headline: how many there are and how that is known, in one sentence. head, rows: of the table.
    after: what belongs to the table. notes: what must be said beside it. fields, margin: make what
    stands under `equilibria` and `margin` of a document. enumeration: the searches for them; None
    where the list stands beside something else.
    """

    headline: str
    head: tuple[str, ...]
    rows: list[tuple[str, ...]]
    after: list[str] = field(default_factory=list[str])
    notes: list[str]
    fields: Callable[[], Document]
    margin: Callable[[], Document]
    enumeration: Enumeration[Any] | None = None

    def table(self) -> list[str]:
        """The lines of the headline and of the table."""
        rows = [self.head, *self.rows] if self.rows else []
        return [self.headline, *table_of(rows), *self.after]

    def words(self) -> str:
        """The result of `equilibria`, readable; with the searches, if more than the usual one."""
        lines, searched = [*self.table(), *self.notes], self.enumeration
        if searched is not None and methods.unusual(searched):
            lines += ["", methods.methods_summary(searched)]
        return "\n".join(lines)

    def document(self) -> Document:
        """The list as `certreg-equilibria/1`; with the searches, if there were several."""
        searched = {} if self.enumeration is None else methods.methods_fields(self.enumeration)
        told = {"equilibria": self.fields(), "margin": self.margin(), **searched}
        return encoded({"schema": EQUILIBRIA_SCHEMA, **told})

    def card(self) -> str:
        """All equilibria as a table in a notebook."""
        notes = [*self.after, *self.notes]
        return cards.Card(
            headline=self.headline, notes=notes, head=self.head, rows=self.rows
        ).html()


def table_of(rows: Sequence[Sequence[str]]) -> list[str]:
    """The lines of a table, its columns flush right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        ("  " + "  ".join(cell.rjust(w) for cell, w in zip(row, widths, strict=True))).rstrip()
        for row in rows
    ]


# --- one weight per pair


def rigid_rests(
    found: EquilibriumSet, enumeration: Enumeration[EquilibriumSet] | None = None
) -> Rests:
    """Of a rigid body with one weight per pair."""
    notes = [f"Ambiguity margin: {margin_words(found)}."]
    tie, narrow = ambiguous_words(found), narrow_words(found)
    if tie is not None:
        notes.append(tie)
    elif narrow is not None:
        notes.append(f"{narrow[0].upper()}{narrow[1:]}.")
    if found.doubt is not None:
        notes.append(f"Not proved: {found.doubt}")
    elif found.classification.ambiguity is not None:
        notes.append(f"Not unique: {found.classification.ambiguity.value}.")
    return Rests(
        headline=count_words(found),
        head=("index", "kind", "RMSE", "energy", "to optimum", "unstable", ""),
        rows=[_row(component, sure=found.doubt is None) for component in found.components],
        notes=notes,
        fields=lambda: equilibrium_fields.rigid_fields(found),
        margin=lambda: equilibrium_fields.margin_fields(found),
        enumeration=enumeration,
    )


def listed_rests(found: ListedEquilibria) -> Rests:
    """The same with the searches for them."""
    return rigid_rests(found, found.enumeration)


def count_words(equilibria: EquilibriumSet) -> str:
    """How many equilibria there are and how that is known, in one sentence."""
    return _known(equilibria, _counted(equilibria))


def _known(found: EquilibriumSet | ScaledEquilibria | SpringEquilibria, counted: str) -> str:
    known = f"{found.guarantee.label}, {'' if found.complete else 'not proved '}complete"
    return f"Equilibria ({known}): {counted}."


def _counted(equilibria: EquilibriumSet) -> str:
    classification = equilibria.classification
    spurious = classification.spurious
    if equilibria.doubt is not None:
        if equilibria.components[0].kind is ComponentKind.ROTATION_GROUP:
            return "the search could not tell any two rotations apart"
        kinds = [component.kind for component in equilibria.components]
        return f"the search found {kinds_words(kinds)}, and there may be more"
    exactly = "" if equilibria.guarantee is Guarantee.NUMERICAL else "exactly "
    if classification.finite:
        what = f"{exactly}four equilibria: the optimum and three spurious ones"
    elif spurious == 0:
        what = "every rotation is an equilibrium, and every one is optimal"
    elif spurious is None:
        optima = "one optimum" if classification.unique else "infinitely many optima"
        what = f"{optima} and infinitely many spurious equilibria"
    else:
        what = f"infinitely many optima and {exactly}{COUNTS[spurious]} spurious equilibri" + (
            "um" if spurious == 1 else "a"
        )
    return what


def kinds_words(found: Sequence[ComponentKind]) -> str:
    """For example: two points and one circle."""
    kinds = Counter(found)
    return " and ".join(
        KINDS[kind]
        if kind is ComponentKind.ROTATION_GROUP
        else f"{COUNTS[count]} {KINDS[kind]}{'s' * (count > 1)}"
        for kind, count in kinds.items()
    )


def _row(component: Component, *, sure: bool) -> tuple[str, ...]:
    """A line of the table; what follows from the list being complete, where that is sure."""
    unstable = component.unstable_eigenvalues
    return (
        str(component.morse_index) if sure else "-",
        KINDS[component.kind],
        number(component.rmse),
        number(component.energy),
        f"{math.degrees(component.angle_to_optimum):.6g} deg",
        ("undefined" if unstable is None else str(unstable)) if sure else "-",
        ("optimal" if sure else "best found") if component.optimal else "",
    )


# --- a free scale


def scaled_rests(found: ScaledEquilibria) -> Rests:
    """With a free scale, and the states inside out; the rest is that of the body of scale 1."""
    rigid = rigid_rests(found.rigid)
    states = found.breathing
    return replace(
        rigid,
        headline=rigid.headline if states is None else _known(found, scaled_count_words(found)),
        head=("index", "kind", "scale", "RMSE", "energy", "to optimum", ""),
        rows=[
            (
                str(each.component.morse_index),
                KINDS[each.component.kind],
                number(each.scale),
                number(each.rmse),
                number(each.component.energy),
                f"{math.degrees(each.component.angle_to_optimum):.6g} deg",
                "optimal" if each.component.optimal else "",
            )
            for each in found.components
        ],
        after=[] if states is None else [inside_out_words(states)],
        notes=rigid.notes[:1],  # the margin
        fields=lambda: {**rigid.fields(), **equilibrium_fields.scaled_fields(found)},
        enumeration=found.enumeration,
    )


def scaled_count_words(equilibria: ScaledEquilibria) -> str:
    """How many there are of a body whose size is a state, and which of them are the best."""
    count = len(equilibria.components)
    if not count:
        return "none with a scale above 0; the body shrinks to a point"
    if equilibria.count is None:
        kinds = [each.component.kind for each in equilibria.components]
        return f"{kinds_words(kinds)} with a scale above 0"
    others = f" and {COUNTS[count - 1]} spurious" if count > 1 else " alone"
    return f"exactly {COUNTS[count]} with a scale above 0: the optimum{others}"


def inside_out_words(breathing: BreathingEquilibria) -> str:
    """The states with a scale below 0, in one line."""
    kinds = [each.kind for each in breathing.inside_out]
    if not kinds:
        return "Inside out (scale below 0): none."
    stable = sum(each.stable for each in breathing.inside_out)
    points = kinds.count(ComponentKind.POINT) == len(kinds)
    what = f"{COUNTS[len(kinds)]} more" if points else kinds_words(kinds)
    return (
        f"Inside out (scale below 0): {what}, {COUNTS[stable]} stable; only through the scale 0, "
        "where the motion is not defined, does a body come there."
    )


# --- general springs


def spring_rests(found: SpringEquilibria) -> Rests:
    """On general springs, up to forty, of which several may be stable.

    Angles are to the first row, which may be the optimum.
    """
    parts, words = found.components, found.undetermined
    known = any(part.angle_to_optimum is not None for part in parts)
    return Rests(
        headline=_spring_headline(found),
        head=("index", "stable", "RMSE", "energy", f"to {'optimum' if known else 'row 1'}", ""),
        rows=[
            (
                "-" if part.morse_index is None else str(part.morse_index),
                {True: "yes", False: "no", None: "-"}[part.stable],
                _magnitude(part, part.rmse),
                _magnitude(part, part.energy),
                f"{math.degrees(part.angle_to_first):.6g} deg",
                _place_words(part, parts[0]),
            )
            for part in parts
        ],
        notes=[*spring_notes(found), *([f"{words[:1].upper()}{words[1:]}."] if words else [])],
        fields=lambda: equilibrium_fields.spring_fields(found),
        margin=lambda: equilibrium_fields.spring_margin_fields(found),
        enumeration=found.enumeration,
    )


def _spring_headline(found: SpringEquilibria) -> str:
    """How many equilibria there are and how that is known, in one sentence."""
    if found.finiteness is line_set.Finiteness.SYMMETRIC:
        return f"Equilibria (exact): infinitely many; {_apart_words(found)}."
    return _known(found, _count_of_springs(found))


def _count_of_springs(equilibria: SpringEquilibria) -> str:
    if equilibria.finiteness is line_set.Finiteness.CONSTANT:
        return "every rotation is an equilibrium, and every one is optimal"
    count, stable = equilibria.count, equilibria.stable
    if count is not None:
        return f"exactly {count}, of which {stable} stable"
    return f"not counted; {_apart_words(equilibria)}"


def _apart_words(equilibria: SpringEquilibria) -> str:
    if not equilibria.components:
        return "none is listed"
    apart = sum(part.separated for part in equilibria.components)
    return f"{ {0: 'none', 1: 'one'}.get(apart, apart) } proved to be isolated"


def spring_notes(equilibria: SpringEquilibria) -> list[str]:
    """What must be said beside the table."""
    notes: list[str] = []
    if equilibria.doubt is not None:
        ruled_out = [part.optimal is False for part in equilibria.components]
        saddles = [NO_MINIMUM] if ruled_out and all(ruled_out) else []
        return [f"Not proved complete: {equilibria.doubt}", *saddles]
    if equilibria.count is None:
        return notes
    euler = f"the Euler sum of the indices is {equilibria.euler_sum}, as that of all must be."
    if equilibria.count_complex is None:
        notes.append(
            f"{equilibria.finiteness.value} Each is proved to be alone in a box around it; {euler}"
        )
    else:
        notes.append(
            f"All 40 critical lines, complex ones included, are simple: {equilibria.count} "
            f"rotations and {equilibria.pairs} conjugate pairs, each proved to be alone in a box "
            f"around it; {euler}"
        )
    if equilibria.tied > 1:
        notes.append(
            f"Not decided which is best: the first {equilibria.tied} have the same energy, as far "
            "as 300 digits tell."
        )
    elif (equilibria.stable or 0) > 1:
        notes.append(STAYS)
    return notes


def _magnitude(part: SpringEquilibrium, value: float | None) -> str:
    """The energy or the RMSE of an equilibrium."""
    return NOTHING if value == 0.0 and part.kind is ComponentKind.POINT else number(value)


def _place_words(part: SpringEquilibrium, first: SpringEquilibrium) -> str:
    """Whether it is the optimum; of one that shows the energy of the first, by how much not."""
    if not part.separated:
        return "not separated"
    if part.optimal is not False:
        return "optimal" if part.optimal else "may be optimal"
    same = part.above and number(part.energy) == number(first.energy)
    return f"higher by {part.above:.1e}" if same else ""


def rests_beside(registration: Registration) -> Rests:
    """What is said of the equilibria of a registration that lists them."""
    scaled = rests_of(registration)
    return rigid_rests(registration.equilibria) if scaled is None else scaled_rests(scaled)
