"""Simulated registration: the damped body released from rest until it is certain where it ends.

Three integrators: explicit Euler with projection as in [Yang2020], the implicit midpoint rule whose
energy never rises, and a splitting that takes a few large steps. A small |s'| alone proves nothing:
near a saddle it is small, too, and where springs are weak, everywhere. So a run ends only when |s'|
is small *and* the state is in the certified basin (documented at `Basin`), from which the exact
flow can end nowhere but at the optimum, *and* so deep in it that the flow stays near. A stop at a
saddle is noticed from the curvature, perturbed along the direction of escape, and continued.

On general springs there are stable equilibria that are not the optimum, and with a free scale no
basin is certified. There a run ends when the body is slow, in a valley of the energy, and the
springs would take it no further than `rest_angle`. Where no spring resists a shift the body coasts
along it until damping has stopped it; where the scale falls to 0 the run stops before it.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from certreg._loading import late
from certreg.dynamics.body import AnyBody, Basin, basin_gaps
from certreg.dynamics.integrators import (
    DEFAULT_SETTINGS,
    SimulationSettings,
    integrate,
    spring_ratios,
    spring_ratios_of_one,
    step_parameters,
)
from certreg.dynamics.rigid import body_on_weights, core_of
from certreg.dynamics.trajectory import Course, Trajectory
from certreg.equilibrium.equilibrium_set import unit_entries
from certreg.equilibrium.stability import TRANSLATION_STIFFNESS
from certreg.errors import DegenerateProblemError
from certreg.exact.elimination import rank
from certreg.native.loops import (
    LARGEST_PERTURBATION,
    PERTURBATION_GROWTH,
    Batch,
    Ending,
    Integrator,
    Log,
)
from certreg.objective.structure import Structure

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.dynamics import valleys
    from certreg.native.layout import Records
    from certreg.objective.isotropic import Isotropic
    from certreg.objective.springs import Springs
else:
    valleys = late("certreg.dynamics.valleys")


Run = TypeVar("Run")

LOG_CAPACITY = 2048  # samples of a trajectory that are kept
SHORT_STEP = 0.1  # of the integrator's own: below, a run that did not end is told so
FAR_DAMPING = 4.0  # times the best one, or a fourth of it: as above
NO_SPRING = 1e-12  # of the stiffest: what rounding makes of none, a thousand times over
LARGE_TURN = 0.5  # radians of all perturbations, from which on a run is told of them
MODEST = 1e60  # norm of a state: no product of three of its numbers and those of a body overflows


def simulate(
    objective: Isotropic | Springs,
    damping: float,
    integrator: Integrator | None = None,
    *,
    start: NDArray[Any] | None = None,
    settings: SimulationSettings | None = None,
    kind: Callable[..., Run] = Trajectory,
) -> Run:
    """The trajectory of the body of a problem, by default released at rest where it was given.

    integrator: None for the body's own. start: a state of the body, see `certreg.dynamics.body`.
    kind: of trajectory, made of the fields of one.
    Raises DegenerateProblemError where the dynamics is undefined, too stiff for explicit Euler, or
    so little damped that the integrator gains energy without end; InvalidProblemError for an
    integrator that does not move such a body; ValueError for a start without a scale above 0.
    """
    settings, moving = settings or DEFAULT_SETTINGS, BODIES[objective.structure](objective, damping)
    integrator = integrator or moving.INTEGRATOR
    states = moving.stated(start, integrator)
    batch = Batch.single(
        integrator,
        bodies=moving.record[np.newaxis],
        basins=moving.basins,
        steps=moving.steps(integrator, states, settings),
        start=states,
    )
    log = Log.of_capacity(LOG_CAPACITY, moving.sample(integrator))
    integrate(batch, settings, log)
    if moving.basin is not None and (start is None or np.isfinite(start).all()):
        _require_no_gain(moving, batch)
    notes = () if moving.basin is None else tuple(_notes(moving.basin, batch, settings))
    return kind(
        integrator=integrator,
        status=moving.STATUS[batch.status.item(0)],
        step=batch.steps["h"].item(0),
        steps=batch.taken.item(0),
        escapes=batch.escapes.item(0),
        moving=moving,
        course=Course(
            samples=log.samples, last=batch.states, time=batch.times.item(0), notes=notes
        ),
    )


def _on_weights(objective: Isotropic, damping: float) -> AnyBody:
    if objective.scaling is not None:
        return valleys.breathing_body(objective.moments, damping)
    return body_on_weights(objective, damping)


# The body that moves down an objective, with what is certified of its optimum.
BODIES: Mapping[Structure, Callable[[Any, float], AnyBody]] = {
    Structure.LINEAR: _on_weights,
    # so that it is loaded when the first is asked for
    Structure.QUARTIC: lambda springs, damping: valleys.body_on_springs(springs, damping),  # noqa: PLW0108
}


def _require_no_gain(moving: AnyBody, batch: Batch) -> None:
    """Raises DegenerateProblemError where a step too long for its spin drove a body too far."""
    if math.hypot(*array("d", batch.states.tobytes())) < MODEST:
        return
    with np.errstate(over="ignore", invalid="ignore"):
        end = moving.energies(batch.states[0])
        if math.isfinite(moving.kinetic(end) + end["potential"]):
            return
    raise DegenerateProblemError(
        f"the {batch.integrator.value} integrator gained energy without end under the damping "
        f"{moving.damping:.3g}: take the midpoint integrator, whose energy never rises, or "
        "more damping",
        value=moving.damping,
    )


def optimal_damping(objective: Isotropic) -> float:
    """The damping mu* = 2 sqrt(min(2, g_min)) under which the slowest mode decays fastest.

    g: eigenvalues of the pencil (G, J) at the optimum; sqrt(8) without noise. Raises
    DegenerateProblemError where the dynamics is not defined or the optimum is not unique.
    Proof: derivations, optimal_damping.
    """
    if not (objective.classification.inertia_definite and objective.classification.unique):
        raise DegenerateProblemError(
            "the best damping needs a source that is not collinear and a unique optimum",
            rank=rank(objective.moments.source_scatter),
        )
    core = core_of(objective.moments)
    basin_gaps(objective, core.length_exponent)  # raises where doubles do not tell the optimum
    numbers = (unit_entries(objective.eigenvectors[0]), core.cross, core.inertia)
    q, cross, inertia = (array("d", part).tobytes() for part in numbers)
    return _of_springs(spring_ratios_of_one(q, cross, inertia)[0])


def _notes(basin: Basin, batch: Batch, settings: SimulationSettings) -> Iterator[str]:
    """What is to be known of a run beside how it ended."""
    escapes, status = batch.escapes.item(0), batch.status.item(0)
    if settings.step is not None and (step := float(batch.steps["h"][0])) < settings.step:
        yield (
            f"The step {settings.step:.6g} is longer than {batch.integrator.value} takes here: "
            f"{step:.6g} was taken."
        )
    turned = _turned(escapes, settings.first_perturbation) if escapes else 0.0
    if turned > LARGE_TURN:
        yield (
            f"{escapes} kicks turned the body by up to {math.ceil(math.degrees(turned))} degrees "
            "in all: where it was slow, they carried it, not the springs."
        )
    if status == Ending.OUT_OF_STEPS:
        yield _delay(basin, batch, settings)


def _turned(escapes: int, first: float) -> float:
    """By how many radians so many perturbations turned a body at most."""
    growth = PERTURBATION_GROWTH ** np.arange(min(escapes, 100.0))
    return float(np.minimum(first * growth, LARGEST_PERTURBATION).sum())


def _delay(basin: Basin, batch: Batch, settings: SimulationSettings) -> str:
    """What makes the steps too few."""
    step, damping = float(batch.steps["h"][0]), float(batch.bodies["damping"][0])
    if int(batch.taken[0]) < settings.max_steps:
        return "No step could be made from the last state."
    own = replace(settings, step=None)
    usual = float(step_parameters(batch.integrator, batch.bodies, batch.basins, own)["h"][0])
    if settings.step is not None and step < SHORT_STEP * usual:
        return f"The step {step:.3g} is short: {batch.integrator.value} itself takes {usual:.3g}."
    if basin.barrier > 0.0:
        best = _best_damping(batch.bodies, batch.basins)
        if best > 0.0 and not best / FAR_DAMPING <= damping <= best * FAR_DAMPING:
            far = f"The damping {damping:.3g} is far from the best one, {best:.3g}"
            return f"{far}: try --damping optimal."
    return (
        "The springs turn the body slowly: the ambiguity margin is small, or the clouds differ "
        "much in size, or are hardly correlated."
    )


def _best_damping(bodies: Records, basins: Records) -> float:
    """Of a body; 0 where rounding leaves it open whether the weakest spring is one."""
    least, *_, largest = spring_ratios(bodies, basins)[0].tolist()
    return _of_springs(least) if least > NO_SPRING * largest else 0.0


def _of_springs(least: float) -> float:
    """The best damping of a body with this least eigenvalue of the pencil (G, J)."""
    return 2.0 * math.sqrt(min(TRANSLATION_STIFFNESS, max(0.0, least)))
