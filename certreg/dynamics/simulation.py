"""Simulated registration: the damped body released from rest until it is certain where it ends.

Three integrators: explicit Euler with projection as in [Yang2020], the implicit midpoint rule whose
energy never rises, and a splitting that takes a few large steps. A small |s'| alone proves nothing:
near a saddle it is small, too, and where springs are weak, everywhere. So a run ends only when |s'|
is small *and* the state is in the certified basin (documented at `Basin`), from which the exact
flow can end nowhere but at the optimum, *and* so deep in it that the flow stays near. A stop at a
saddle is noticed from the curvature, perturbed along the direction of escape, and continued.
"""

from __future__ import annotations

import math
from array import array
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from certreg.dynamics.basin import basin_gaps, certified_basin
from certreg.dynamics.body import body_of, centres_apart, core_of
from certreg.dynamics.integrators import (
    DEFAULT_SETTINGS,
    integrate,
    spring_ratios,
    step_parameters,
)
from certreg.dynamics.pencil import spring_ratios_of_one
from certreg.dynamics.trajectory import Course, SimulationStatus, Trajectory, with_matrices
from certreg.equilibrium import TRANSLATION_STIFFNESS, unit_double
from certreg.errors import DegenerateProblemError
from certreg.exact import rank
from certreg.geometry import quaternion_from_matrix
from certreg.native import (
    LARGEST_PERTURBATION,
    MATRIX_STATE,
    PERTURBATION_GROWTH,
    QUATERNION_STATE,
    Batch,
    Ending,
    Integrator,
    Log,
    named,
    plain,
    record_of,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    from certreg.dynamics.basin import Basin
    from certreg.dynamics.body import Body
    from certreg.dynamics.integrators import SimulationSettings
    from certreg.native import Records
    from certreg.objective import Isotropic
    from certreg.problem import ExactMoments

Run = TypeVar("Run")

LOG_CAPACITY = 2048  # samples of a trajectory that are kept
SHORT_STEP = 0.1  # of the integrator's own: below, a run that did not end is told so
FAR_DAMPING = 4.0  # times the best one, or a fourth of it: as above
NO_SPRING = 1e-12  # of the stiffest: what rounding makes of none, a thousand times over
LARGE_TURN = 0.5  # radians of all perturbations, from which on a run is told of them
MODEST = 1e60  # norm of a state: no product of three of its numbers and those of a body overflows
NO_TURN, NO_TURN_QUATERNION = np.eye(3).ravel().tolist(), (1.0, 0.0, 0.0, 0.0)


def simulate(
    objective: Isotropic,
    damping: float,
    integrator: Integrator = Integrator.EULER,
    *,
    start: NDArray[np.float64] | None = None,
    settings: SimulationSettings | None = None,
    kind: Callable[..., Run] = Trajectory,
) -> Run:
    """The trajectory of the body of a problem, by default released at rest where it was given.

    start: (18,), see `certreg.dynamics.body`, lengths over 2^length_exponent of the body. kind: of
    trajectory, made of the fields of one.
    Raises DegenerateProblemError where the dynamics is undefined, too stiff for explicit Euler, or
    so little damped that the integrator gains energy without end.
    """
    settings = settings or DEFAULT_SETTINGS
    require_dynamics(objective)
    moving = body_of(objective.moments, damping)
    basin = certified_basin(objective, moving.length_exponent)
    bodies, basins = moving.record[np.newaxis], basin.record[np.newaxis]
    batch = Batch.single(
        integrator,
        bodies=bodies,
        basins=basins,
        steps=step_parameters(integrator, bodies, basins, settings),
        start=(
            _released(objective.moments, moving, integrator)
            if start is None
            else _stepped(np.array(start, dtype=float), integrator)
        ),
    )
    log = Log.of_capacity(LOG_CAPACITY, integrator.sample)
    integrate(batch, settings, log)
    if (start is None or np.isfinite(start).all()) and _overflows(moving, batch):
        raise _gains_energy(moving, integrator)
    return kind(**_told(moving, basin, batch, log, settings))


def require_dynamics(objective: Isotropic) -> None:
    """Raises DegenerateProblemError where the source is collinear."""
    if not objective.classification.inertia_definite:
        message = "the source points are collinear: the rotational dynamics is not defined"
        raise DegenerateProblemError(message, rank=rank(objective.moments.source_scatter))


def _overflows(moving: Body, batch: Batch) -> bool:
    """Whether the energy of the last state of a body is beyond the doubles."""
    if math.hypot(*array("d", batch.states.tobytes())) < MODEST:
        return False
    with np.errstate(over="ignore", invalid="ignore"):
        end = moving.energies(plain(with_matrices(batch.states, batch.integrator))[0])
    return not math.isfinite(end.kinetic + end.potential)


def _gains_energy(moving: Body, integrator: Integrator) -> DegenerateProblemError:
    """A step too long for its spin drove a body beyond the doubles."""
    message = (
        f"the {integrator.value} integrator gained energy without end under the damping "
        f"{moving.damping:.3g}: take the midpoint integrator, whose energy never rises, or "
        "more damping"
    )
    return DegenerateProblemError(message, value=moving.damping)


def optimal_damping(objective: Isotropic) -> float:
    """The damping mu* = 2 sqrt(min(2, g_min)) under which the slowest mode decays fastest.

    g: eigenvalues of the pencil (G, J) at the optimum; sqrt(8) without noise. Raises
    DegenerateProblemError where the dynamics is not defined or the optimum is not unique.
    Proof: derivations, optimal_damping.
    """
    if not (objective.classification.inertia_definite and objective.classification.unique):
        message = "the best damping needs a source that is not collinear and a unique optimum"
        raise DegenerateProblemError(message, rank=rank(objective.moments.source_scatter))
    core = core_of(objective.moments)
    basin_gaps(objective, core.length_exponent)  # raises where doubles do not tell the optimum
    optimum = unit_double(objective.eigenvectors[0]).tolist()
    return _of_springs(spring_ratios_of_one(optimum, core.cross, core.inertia)[0])


def _released(moments: ExactMoments, moving: Body, integrator: Integrator) -> Records:
    """The start of [Yang2020] as the integrator keeps it, (1,): see `start_at_rest`."""
    turn = NO_TURN if integrator is Integrator.EULER else NO_TURN_QUATERNION
    numbers = [*centres_apart(moments, moving.length_exponent), *turn, *[0.0] * 6]
    return record_of(numbers, integrator.state, (1,))


def _stepped(state: NDArray[np.float64], integrator: Integrator) -> Records:
    """A state (18,) as the integrator keeps it, with a quaternion if it has one: (1,) record."""
    given = named(state, MATRIX_STATE)[np.newaxis]
    if integrator is Integrator.EULER:
        return given
    states = np.empty(1, dtype=QUATERNION_STATE)
    states["q"] = quaternion_from_matrix(given["R"][0])
    for part in ("c", "v", "omega"):
        states[part] = given[part]
    return states


_STATUSES = {
    Ending.OUT_OF_STEPS: SimulationStatus.OUT_OF_STEPS,
    Ending.CONVERGED: SimulationStatus.CONVERGED,
    Ending.AT_REST: SimulationStatus.AT_REST,
}


def _told(
    moving: Body, basin: Basin, batch: Batch, log: Log, settings: SimulationSettings
) -> dict[str, Any]:
    """What is told of a run, by the names of the fields of `Trajectory`."""
    return {
        "integrator": batch.integrator,
        "status": _STATUSES[Ending(batch.status.item(0))],
        "step": batch.steps["h"].item(0),
        "steps": batch.taken.item(0),
        "escapes": batch.escapes.item(0),
        "notes": tuple(_notes(basin, batch, settings)),
        "moving": moving,
        "basin": basin,
        "course": Course(samples=log.samples, last=batch.states, time=batch.times.item(0)),
    }


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
