"""A simulated motion in words, as JSON, as a card: one text, with what each body adds to it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from certreg.native.loops import Kind
from certreg.registration.simulation import (
    SimulatedBreathing,
    SimulatedMotion,
    SimulatedRegistration,
    proved_end,
)
from certreg.report.cards import Card
from certreg.report.encoding import Document, encoded
from certreg.report.lines import away_words, number, rate_words, step_words
from certreg.report.picture import energy_picture
from certreg.report.thinning import unspent_words
from certreg.results import OUT_OF_RANGE, Absent, Brief, mapped, present

if TYPE_CHECKING:
    from certreg.registration.result import Registration
    from certreg.registration.valley import SimulatedSprings


SIMULATION_SCHEMA = "certreg-simulation/1"
NO_BASIN = "no basin is certified of a body whose scale is free"
KEEPS = (
    "Proved: the exact motion never comes to the scale 0: the body begins with less energy than a "
    "source shrunk to a point has."
)
MAY_COLLAPSE = (
    "Not proved that the exact motion never comes to the scale 0: the body begins with at "
    "least the energy that a source shrunk to a point has."
)


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionTold(Brief):
    """A motion, and what is said of it that depends on the body.

    angle: radians, from the last rotation to the best. proved: whether the exact motion from the
    last state is proved to end there. last: the sentence that ends the text. ends: rows on its end.
    state: rows on what else moves. rates: of change, how many there are. fields: of the document.
    """

    run: SimulatedMotion
    angle: float
    proved: bool
    last: str
    ends: Sequence[tuple[str, str]]
    state: Sequence[tuple[str, str]] = ()
    rates: int = 18
    fields: Document = field(default_factory=dict[str, Any])

    @property
    def rows(self) -> list[tuple[str, str]]:
        """What is told of it, each with its name; energies in objective units."""
        run, (initial, final) = self.run, map(present, self.run.energies)
        return [
            ("integrator", run.integrator.value),
            ("steps", f"{run.steps}, {step_words(run.step)}"),
            ("time", f"{run.time:.6g}  (unit of the springs)"),
            ("escapes", f"{run.escapes}  (kicked off a saddle)"),
            *self.state,
            ("initial energy", f"{number(initial)}  (kinetic and potential)"),
            ("final energy", number(final)),
            ("residual", f"{run.speed:.3g}  (norm of the {self.rates} rates of change)"),
            *self.ends,
        ]

    def words(self) -> str:
        """The result of `simulate`, readable."""
        rows = (f"  {name:<18}{words}" for name, words in self.rows)
        return "\n".join((self.run.outcome, *rows, self.last))

    def simulation(self) -> Document:
        """The `simulation` of a result."""
        run, (initial, final) = self.run, self.run.energies
        return {
            "integrator": run.integrator.value,
            "status": run.status.value,
            "step": run.step,
            "steps": run.steps,
            "converged": run.converged,
            "in_certified_basin": self.proved,
            "escapes": run.escapes,
            "residual": run.speed,
            "predicted_rate": run.stated("predicted_rate"),
            "decay_rate": run.stated("decay_rate"),
            "angle_to_pose_deg": math.degrees(self.angle),
            "energy": {"initial": initial, "final": final},
            **self.fields,
        }

    def document(self) -> Document:
        """A simulation on its own, as `certreg-simulation/1`."""
        return encoded({"schema": SIMULATION_SCHEMA, **self.simulation()})

    def card(self) -> str:
        """A simulation in a notebook, with its energy."""
        return Card(
            headline=self.run.outcome,
            notes=[*self.run.notes, self.last],
            good=self.run.converged,
            facts=self.rows,
            picture=energy_picture(self.run),
        ).html()


def ended(end: SimulatedRegistration) -> MotionTold:
    """Of a rigid body on springs alike in every way: what is proved of its end."""
    run, unspent = end.trajectory, unspent_words(end.trajectory)
    away = away_words(end.angle_to_optimum, unique=end.unique)
    proved, which = "Proved:", "the" if end.unique else "an"
    if not end.in_certified_basin:
        proved = "Not proved that"
    return MotionTold(
        run=run,
        angle=end.angle_to_optimum,
        proved=end.in_certified_basin,
        last=f"{proved} from its last state the exact motion ends at {which} optimum.",
        ends=[
            ("decay rate", rate_words(run)),
            ("end", away if unspent is None else f"its rotation {away}"),
            *([] if unspent is None else [("not there yet", unspent)]),
        ],
    )


def _breathing(run: SimulatedBreathing) -> MotionTold:
    """With a free scale: from which one it came to which, and whether it stays above 0."""
    first, last = run.scales[[0, -1]].tolist()
    best = "beyond doubles" if run.best_scale is None else f"{run.best_scale:.6g}"
    course = f"{last:.6g} at the end, from {first:.6g}; that of the optimum is {best}"
    unique = run.objective.classification.unique
    return MotionTold(
        run=run,
        angle=run.angle_to_optimum,
        proved=False,
        last=KEEPS if run.never_collapses else MAY_COLLAPSE,
        ends=[("end", away_words(run.angle_to_optimum, unique=unique))],
        state=[("scale", course)],
        rates=20,
        fields={
            "basin": {"verdict": "inconclusive", "words": NO_BASIN},
            "scale": {
                "initial": first,
                "final": last,
                "optimum": OUT_OF_RANGE if run.best_scale is None else run.best_scale,
                "never_collapses": run.never_collapses,
            },
        },
    )


def _on_springs(run: SimulatedSprings) -> MotionTold:
    """On general springs: which valley of the energy it ended in."""
    return MotionTold(
        run=run,
        angle=run.angle_to_best,
        proved=run.basin.proved,
        last=run.basin.words,
        ends=[("end", run.end_words)],
        fields={
            "basin": {"verdict": run.basin.ruling.value, "words": run.basin.words},
            "excess": run.excess,
        },
    )


Proof = Callable[[Any], SimulatedRegistration]  # of the end of a rigid motion
TOLD: Mapping[Kind, Callable[[Any, Proof], MotionTold]] = {  # by the kind of the body
    Kind.RIGID: lambda run, proof: ended(proof(run)),
    Kind.BREATHING: lambda run, _: _breathing(run),
    Kind.SPRINGS: lambda run, _: _on_springs(run),
}


def told_motion(run: SimulatedMotion, proof: Proof = proved_end) -> MotionTold:
    """What is said of a simulated motion; of a rigid one its end is proved, if it can be."""
    return TOLD[run.moving.KIND](run, proof)


def motion_beside(registration: Registration) -> MotionTold | Absent:
    """The motion of a registration, whose certificate says what is proved of its end."""
    solution = registration.solution
    run, certificate = solution.trajectory, solution.certificate
    if isinstance(run, Absent):
        return run

    def proved(run: SimulatedMotion) -> SimulatedRegistration:
        return SimulatedRegistration(
            trajectory=run,
            angle_to_optimum=solution.agreement.simulation or 0.0,
            in_certified_basin=certificate is not None and bool(certificate.body.claims.basin),
            unique=registration.equilibria.classification.unique,
        )

    return told_motion(run, proved)


def simulation_fields(registration: Registration) -> Document | Absent:
    """The `simulation` of a result."""
    return mapped(motion_beside(registration), MotionTold.simulation)
