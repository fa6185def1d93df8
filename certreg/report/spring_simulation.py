"""A simulation on general springs in words, as JSON, as a card."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from certreg.registration.valley import at_end_words, moving_words
from certreg.report.cards import Card
from certreg.report.encoding import encoded
from certreg.report.lines import number, step_words
from certreg.results import present

if TYPE_CHECKING:
    from certreg.registration.valley import SimulatedSprings
    from certreg.report.encoding import Document

SIMULATION_SCHEMA = "certreg-simulation/1"


def spring_simulation_summary(run: SimulatedSprings) -> str:
    """The result of `simulate` on general springs, readable; energies in objective units."""
    initial, final = (present(energy) for energy in run.energies)
    return "\n".join(
        (
            moving_words(run),
            f"  integrator        {run.integrator.value}",
            f"  steps             {run.steps}, {step_words(run.step)}",
            f"  time              {run.time:.6g}  (unit of the springs)",
            f"  escapes           {run.escapes}  (kicked off a saddle)",
            f"  initial energy    {number(initial)}  (kinetic and potential)",
            f"  final energy      {number(final)}",
            f"  residual          {run.speed:.3g}  (norm of the 18 rates of change)",
            f"  end               {at_end_words(run)}",
            run.basin.words,
        )
    )


def spring_simulation_document(run: SimulatedSprings) -> Document:
    """As `certreg-simulation/1`."""
    initial, final = run.energies
    return encoded(
        {
            "schema": SIMULATION_SCHEMA,
            "integrator": run.integrator.value,
            "status": run.status.value,
            "step": run.step,
            "steps": run.steps,
            "converged": run.converged,
            "in_certified_basin": run.basin.proved,
            "basin": {"verdict": run.basin.ruling.value, "words": run.basin.words},
            "escapes": run.escapes,
            "residual": run.speed,
            "predicted_rate": run.stated("predicted_rate"),
            "decay_rate": run.stated("decay_rate"),
            "angle_to_pose_deg": math.degrees(run.angle_to_best),
            "energy": {"initial": initial, "final": final},
            "excess": run.excess,
        }
    )


def spring_trajectory_card(run: SimulatedSprings) -> str:
    """A simulation in a notebook."""
    return Card(
        headline=moving_words(run),
        notes=[*run.notes, run.basin.words],
        good=run.converged,
        facts=[
            ("integrator", run.integrator.value),
            ("steps", f"{run.steps:,}, {step_words(run.step)}"),
            ("time", f"{run.time:.6g}"),
            ("escapes", str(run.escapes)),
            ("end", at_end_words(run)),
        ],
    ).html()
