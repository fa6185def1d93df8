"""The dynamics of a free scale in words and as cards: equilibria with scales, and a motion."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from certreg.report.cards import Card
from certreg.report.encoding import encoded
from certreg.report.equilibria import (
    COUNTS,
    KINDS,
    count_words,
    kinds_words,
    margin_words,
    table_of,
)
from certreg.report.lines import away_words, number, step_words
from certreg.report.picture import energy_picture
from certreg.results import OUT_OF_RANGE, ComponentKind, present

if TYPE_CHECKING:
    from certreg.equilibrium.breathing import BreathingEquilibria
    from certreg.registration.breathing import ScaledEquilibria, SimulatedBreathing
    from certreg.report.encoding import Document


SIMULATION_SCHEMA = "certreg-simulation/1"
HEADINGS = ("index", "kind", "scale", "RMSE", "energy", "to optimum", "")
NO_BASIN = "no basin is certified of a body whose scale is free"
KEEPS = (
    "Proved: the exact motion never comes to the scale 0: the body begins with less energy than a "
    "source shrunk to a point has."
)
MAY_COLLAPSE = (
    "Not proved that the exact motion never comes to the scale 0: the body begins with at "
    "least the energy that a source shrunk to a point has."
)


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


def breathing_summary(run: SimulatedBreathing) -> str:
    """The result of `simulate` with a free scale, readable; energies in objective units."""
    initial, final = (present(energy) for energy in run.energies)
    unique = run.objective.classification.unique
    return "\n".join(
        (
            run.status.value,
            f"  integrator        {run.integrator.value}",
            f"  steps             {run.steps}, {step_words(run.step)}",
            f"  time              {run.times[-1]:.6g}  (unit of the springs)",
            f"  escapes           {run.escapes}  (kicked off a saddle)",
            f"  scale             {scale_course(run)}",
            f"  initial energy    {number(initial)}  (kinetic and potential)",
            f"  final energy      {number(final)}",
            f"  residual          {run.speed:.3g}  (norm of the 20 rates of change)",
            f"  end               {away_words(run.angle_to_optimum, unique=unique)}",
            keeps_words(run),
        )
    )


def keeps_words(run: SimulatedBreathing) -> str:
    """Whether it is proved that the scale stays above 0."""
    return KEEPS if run.never_collapses else MAY_COLLAPSE


def scale_course(run: SimulatedBreathing) -> str:
    """From which scale to which one a body came, and that of the optimum."""
    first, last = (f"{scale:.6g}" for scale in run.scales[[0, -1]].tolist())
    best = "beyond doubles" if run.best_scale is None else f"{run.best_scale:.6g}"
    return f"{last} at the end, from {first}; that of the optimum is {best}"


def breathing_fields(run: SimulatedBreathing) -> Document:
    """The `simulation` of a result."""
    initial, final = run.energies
    first, last = run.scales[[0, -1]].tolist()
    return {
        "integrator": run.integrator.value,
        "status": run.status.value,
        "step": run.step,
        "steps": run.steps,
        "converged": run.converged,
        "in_certified_basin": False,
        "basin": {"verdict": "inconclusive", "words": NO_BASIN},
        "escapes": run.escapes,
        "residual": run.speed,
        "predicted_rate": run.stated("predicted_rate"),
        "decay_rate": run.stated("decay_rate"),
        "angle_to_pose_deg": math.degrees(run.angle_to_optimum),
        "energy": {"initial": initial, "final": final},
        "scale": {
            "initial": first,
            "final": last,
            "optimum": OUT_OF_RANGE if run.best_scale is None else run.best_scale,
            "never_collapses": run.never_collapses,
        },
    }


def breathing_document(run: SimulatedBreathing) -> Document:
    """A simulation on its own, as `certreg-simulation/1`."""
    return encoded({"schema": SIMULATION_SCHEMA, **breathing_fields(run)})


def breathing_card(run: SimulatedBreathing) -> str:
    """A simulation in a notebook."""
    return Card(
        headline=run.status.value,
        notes=[keeps_words(run)],
        good=run.converged,
        facts=[
            ("steps", f"{run.steps:,}, {step_words(run.step)}"),
            ("time", f"{run.times[-1]:.6g}"),
            ("scale", scale_course(run)),
            ("escapes", str(run.escapes)),
        ],
        picture=energy_picture(run),
    ).html()
