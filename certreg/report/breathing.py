"""The dynamics of a free scale in words and as a card: equilibria with scales."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from certreg.report.cards import Card
from certreg.report.equilibria import (
    COUNTS,
    KINDS,
    count_words,
    kinds_words,
    margin_words,
    table_of,
)
from certreg.report.lines import number
from certreg.results import ComponentKind

if TYPE_CHECKING:
    from certreg.equilibrium.breathing import BreathingEquilibria
    from certreg.registration.breathing import ScaledEquilibria


HEADINGS = ("index", "kind", "scale", "RMSE", "energy", "to optimum", "")


def scaled_equilibria_words(equilibria: ScaledEquilibria) -> str:
    """All equilibria with a free scale as a sentence and a table, with the inside-out states."""
    rows = [HEADINGS, *scaled_rows(equilibria)] if equilibria.components else []
    breathing = equilibria.breathing
    inside_out = [] if breathing is None else [inside_out_words(breathing)]
    return "\n".join((_headline(equilibria), *table_of(rows), *inside_out))


def scaled_enumeration_summary(equilibria: ScaledEquilibria) -> str:
    """The same with the margin."""
    words = scaled_equilibria_words(equilibria)
    return f"{words}\nAmbiguity margin: {margin_words(equilibria.rigid)}."


def scaled_equilibria_card(equilibria: ScaledEquilibria) -> str:
    """The same in a notebook."""
    breathing = equilibria.breathing
    return Card(
        headline=_headline(equilibria),
        notes=[] if breathing is None else [inside_out_words(breathing)],
        head=HEADINGS,
        rows=scaled_rows(equilibria),
    ).html()


def _headline(equilibria: ScaledEquilibria) -> str:
    """How many there are, and how that is known."""
    if equilibria.breathing is None:
        return count_words(equilibria.rigid)
    known = f"{equilibria.rigid.guarantee.label}, complete"
    return f"Equilibria ({known}): {scaled_count_words(equilibria)}."


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


def scaled_rows(equilibria: ScaledEquilibria) -> list[tuple[str, ...]]:
    """A row for each, under HEADINGS."""
    return [
        (
            str(each.component.morse_index),
            KINDS[each.component.kind],
            number(each.scale),
            number(each.rmse),
            number(each.component.energy),
            f"{math.degrees(each.component.angle_to_optimum):.6g} deg",
            "optimal" if each.component.optimal else "",
        )
        for each in equilibria.components
    ]


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
