"""Lists of equilibria in words: how many there are, how that is known, and a table."""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING

from certreg.registration.ambiguity import ambiguous_words, narrow_words
from certreg.report.lines import number
from certreg.results import ComponentKind, Guarantee

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.equilibrium.equilibrium_set import Component, EquilibriumSet

COUNTS = {0: "none", 1: "one", 2: "two", 3: "three", 4: "four"}
KINDS = {
    ComponentKind.POINT: "point",
    ComponentKind.CIRCLE: "circle",
    ComponentKind.PROJECTIVE_PLANE: "projective plane",
    ComponentKind.ROTATION_GROUP: "every rotation",
}
HEADINGS = ("index", "kind", "RMSE", "energy", "to optimum", "unstable", "")


def equilibria_summary(equilibria: EquilibriumSet) -> str:
    """The equilibrium set as a sentence and a table."""
    return "\n".join((count_words(equilibria), *table_of([HEADINGS, *equilibria_rows(equilibria)])))


def equilibria_rows(equilibria: EquilibriumSet) -> list[tuple[str, ...]]:
    """A row for each, under HEADINGS."""
    sure = equilibria.doubt is None
    return [_row(component, sure=sure) for component in equilibria.components]


def table_of(rows: Sequence[Sequence[str]]) -> list[str]:
    """The lines of a table, its columns flush right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        ("  " + "  ".join(cell.rjust(w) for cell, w in zip(row, widths, strict=True))).rstrip()
        for row in rows
    ]


def equilibria_words(equilibria: EquilibriumSet) -> str:
    """The equilibrium set with its margin, and what is in doubt or not unique."""
    lines = [equilibria_summary(equilibria), f"Ambiguity margin: {margin_words(equilibria)}."]
    tie, narrow = ambiguous_words(equilibria), narrow_words(equilibria)
    if tie is not None:
        lines.append(tie)
    elif narrow is not None:
        lines.append(f"{narrow[0].upper()}{narrow[1:]}.")
    if equilibria.doubt is not None:
        lines.append(f"Not proved: {equilibria.doubt}")
    elif equilibria.classification.ambiguity is not None:
        lines.append(f"Not unique: {equilibria.classification.ambiguity.value}.")
    return "\n".join(lines)


def count_words(equilibria: EquilibriumSet) -> str:
    """How many equilibria there are and how that is known, in one sentence."""
    known = f"{equilibria.guarantee.label}, {'' if equilibria.complete else 'not proved '}complete"
    return f"Equilibria ({known}): {_counted(equilibria)}."


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


def margin_words(equilibria: EquilibriumSet) -> str:
    """How far the optimum is from being ambiguous, in words."""
    margin = equilibria.margin
    if equilibria.doubt is not None:
        return "not known: the list of equilibria is not proved complete"
    if not equilibria.classification.unique:
        return "0: the optimum is not unique"
    percent = f"{100 * margin.relative:.3g} % of the range of energies"
    if equilibria.pairs_in_doubt:
        return f"{percent}: unique, but the poor fit may have turned the answer over"
    if equilibria.nearly_ambiguous:
        return f"{percent}: unique, but a small change of the data may turn the answer over"
    return f"{percent}: unique"


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
