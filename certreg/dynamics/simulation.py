"""Simulated registration: the damped body released from rest until it is certain where it ends.

Three integrators: explicit Euler with projection as in [Yang2020], the implicit midpoint rule whose
energy never rises, and a splitting that takes a few large steps. A small |s'| alone proves nothing:
near a saddle it is small, too, and where springs are weak, everywhere. So a run ends only when |s'|
is small *and* the state is in the certified basin (documented at `Basin`), from which the exact
flow can end nowhere but at the optimum, *and* so deep in it that the flow stays near. A stop at a
saddle is noticed from the curvature, perturbed along the direction of escape, and continued.
"""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.dynamics.basin import certified_basin
from certreg.dynamics.body import body_of, start_at_rest, state_at_rest
from certreg.dynamics.integrators import (
    SimulationSettings,
    integrate,
    spring_ratios,
    step_parameters,
)
from certreg.equilibrium import TRANSLATION_STIFFNESS
from certreg.errors import DegenerateProblemError
from certreg.exact import rank
from certreg.geometry import quaternion_from_matrix, rotation_matrices, rotation_matrix
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
)
from certreg.results import Absent, Explained

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from certreg.dynamics.basin import Basin
    from certreg.dynamics.body import Body
    from certreg.native import Records
    from certreg.objective import Isotropic

RATE_START = 1e-3  # of the energy at the start: transients are over
RATE_END = 1e-13  # of the spread: rounding
LEAST_SAMPLES = 4  # to fit a line through
LOG_CAPACITY = 2048  # samples of a trajectory that are kept
SHORT_STEP = 0.1  # of the integrator's own: below, a run that did not end is told so
FAR_DAMPING = 4.0  # times the best one, or a fourth of it: as above
LARGE_TURN = 0.5  # radians of all perturbations, from which on a run is told of them

RATES = ("predicted_rate", "decay_rate")
NO_RATE = Absent("the optimum is not unique: no rate belongs to it")
TOO_FEW_SAMPLES = Absent("too few logged samples lie between the start and rest")


class SimulationStatus(enum.Enum):
    """How a simulation ended; the value is the message shown to the user."""

    CONVERGED = (
        "The body is at rest (slower than the tolerance), its rotation with too little energy to "
        "leave the optimum."
    )
    AT_REST = (
        "The body is at rest (slower than the tolerance); where no optimum is unique, no more is "
        "asked."
    )
    OUT_OF_STEPS = (
        "The steps ran out before the body was at rest at the optimum. The certificate does not "
        "depend on it."
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class Trajectory(Explained):
    """A simulated registration; logged at evenly spaced steps, the last one included.

    The rates are computed when they are first asked for; why there is none is stated, and not in
    `absent`.

    Attributes
    ----------
    integrator, status
        Which, and how it ended.
    times
        (L,), in the time unit of the springs.
    states, length_exponent
        (L, 18) with lengths over 2^length_exponent.
    potential, kinetic
        (L,), V_p / M and V_k / M over 4^length_exponent.
    quaternion, angular_velocity
        (4,) and (3,), of the last state: what the basin proof is about.
    step, steps, escapes
        The largest; how many; how often the body was perturbed off a saddle.
    speed
        |s'| at the end, the residual of the equilibrium equations.
    notes
        What else is to be known: a step that was not taken as given, perturbations that did the
        work of the springs, and, where the steps ran out, what makes them too few.
    moving, basin
        The body, and what is certified of it.
    absent
        Why an attribute is None, by its name.
    """

    integrator: Integrator
    status: SimulationStatus
    step: float
    steps: int
    escapes: int
    times: NDArray[np.float64]
    states: NDArray[np.float64]
    potential: NDArray[np.float64]
    kinetic: NDArray[np.float64]
    length_exponent: int
    quaternion: NDArray[np.float64]
    angular_velocity: NDArray[np.float64]
    speed: float
    notes: tuple[str, ...]
    moving: Body
    basin: Basin

    def __repr__(self) -> str:
        how = f"{self.steps} steps of {self.integrator.value}"
        return f"<Trajectory: {self.status.name} after {how}>"

    @property
    def energy_left(self) -> float:
        """The share, at the end, of the energy above the optimum that the body began with.

        Near 0 where it came to the optimum; a body that is slow because of its damping, or not yet
        under way, has much of it left. 0 where it began with no more than rounding.
        """
        above = self.potential + self.kinetic
        above = above - self.moving.energies(_at_rest(self.basin.optimum)).potential
        if not above[0] > RATE_END * self.moving.spread:
            return 0.0
        return max(0.0, float(above[-1] / above[0]))

    @property
    def converged(self) -> bool:
        """Whether the body came to rest where it had to."""
        return self.status in {SimulationStatus.CONVERGED, SimulationStatus.AT_REST}

    @cached_property
    def predicted_rate(self) -> float | None:
        """Of the slowest mode at the optimum, by the linearised dynamics; None if not unique."""
        return _predicted_rate(self.moving, self.basin) if self._unique else None

    @cached_property
    def decay_rate(self) -> float | None:
        """As measured in the logged energies; None where the optimum is not unique.

        Or where too few samples lie between a thousandth of the energy at the start and rounding.
        """
        if not self._unique:
            return None
        energy = self.potential + self.kinetic
        return _decay_rate(self.times, energy, self.moving, self.basin)

    @property
    def _unique(self) -> bool:
        return self.basin.barrier > 0.0

    def stated(self, name: str) -> Any:
        """The attribute of that name, or the Absent that stands for it.

        Parameters
        ----------
        name
            Of an attribute that may be None.

        Returns
        -------
        Any
            Its value; where that is None, the reason.
        """
        if name in RATES and getattr(self, name) is None:
            return TOO_FEW_SAMPLES if self._unique else NO_RATE
        return Explained.stated(self, name)


def simulate(
    objective: Isotropic,
    damping: float,
    integrator: Integrator = Integrator.EULER,
    *,
    start: NDArray[np.float64] | None = None,
    settings: SimulationSettings | None = None,
) -> Trajectory:
    """The trajectory of the body of a problem, by default released at rest where it was given.

    start: (18,), see `certreg.dynamics.body`, lengths over 2^length_exponent of the body.
    Raises DegenerateProblemError where the dynamics is undefined, too stiff for explicit Euler, or
    so little damped that the integrator gains energy without end.
    """
    settings = settings or SimulationSettings()
    if not objective.classification.inertia_definite:
        message = "the source points are collinear: the rotational dynamics is not defined"
        raise DegenerateProblemError(message, rank=rank(objective.moments.source_scatter))
    moving = body_of(objective.moments, damping)
    basin = certified_basin(objective, moving.length_exponent)
    begin = start_at_rest(objective.moments, moving.length_exponent) if start is None else start
    bodies, basins = moving.record[np.newaxis], basin.record[np.newaxis]
    batch = Batch.of(
        integrator,
        bodies=bodies,
        basins=basins,
        steps=step_parameters(integrator, bodies, basins, settings),
        states=_stepped(np.asarray(begin, dtype=float), integrator),
    )
    log = Log.of_capacity(LOG_CAPACITY, integrator)
    integrate(batch, settings, log)
    with np.errstate(over="ignore", invalid="ignore"):
        last = _paper_states(batch.states, batch.integrator)
        end = moving.energies(plain(last)[0])
    if np.isfinite(begin).all() and not math.isfinite(end.kinetic + end.potential):
        raise _gains_energy(moving, batch.integrator)
    return _trajectory(moving, basin, batch, log, settings, last)


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
    moving = body_of(objective.moments, 1.0)
    basin = certified_basin(objective, moving.length_exponent)
    return _best_damping(moving.record[np.newaxis], basin.record[np.newaxis])


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


def _paper_states(states: Records, integrator: Integrator) -> Records:
    """States (L,) with rotation matrices."""
    if integrator is Integrator.EULER:
        return states
    turned = np.empty(len(states), dtype=MATRIX_STATE)
    turned["R"] = rotation_matrices(states["q"])
    for part in ("c", "v", "omega"):
        turned[part] = states[part]
    return turned


_STATUSES = {
    Ending.OUT_OF_STEPS: SimulationStatus.OUT_OF_STEPS,
    Ending.CONVERGED: SimulationStatus.CONVERGED,
    Ending.AT_REST: SimulationStatus.AT_REST,
}


def _trajectory(
    moving: Body, basin: Basin, batch: Batch, log: Log, settings: SimulationSettings, last: Records
) -> Trajectory:
    """What is told of a run; last: its last state, with a rotation matrix."""
    samples = log.samples
    times, logged = samples["time"], _paper_states(samples["state"], batch.integrator)
    energies = samples["energies"]
    kinetic, potential = energies["translation"] + energies["rotation"], energies["potential"]
    if times[-1] != batch.times[0] or (plain(logged)[-1] != plain(last)[0]).any():
        end = moving.energies(plain(last)[0])
        times, logged = np.append(times, batch.times), np.append(logged, last)
        kinetic, potential = np.append(kinetic, end.kinetic), np.append(potential, end.potential)
    return Trajectory(
        integrator=batch.integrator,
        status=_STATUSES[Ending(int(batch.status[0]))],
        step=float(batch.steps["h"][0]),
        steps=int(batch.taken[0]),
        escapes=int(batch.escapes[0]),
        times=times,
        states=plain(logged),
        potential=potential,
        kinetic=kinetic,
        length_exponent=moving.length_exponent,
        quaternion=quaternion_from_matrix(last["R"][0]),
        angular_velocity=last["omega"][0],
        speed=float(np.linalg.norm(moving.rate(plain(last)[0]))),
        notes=tuple(_notes(basin, batch, settings)),
        moving=moving,
        basin=basin,
    )


def _notes(basin: Basin, batch: Batch, settings: SimulationSettings) -> Iterator[str]:
    """What is to be known of a run beside how it ended."""
    step, escapes = float(batch.steps["h"][0]), int(batch.escapes[0])
    if settings.step is not None and step < settings.step:
        yield (
            f"The step {settings.step:.6g} is longer than {batch.integrator.value} takes here: "
            f"{step:.6g} was taken."
        )
    growth = PERTURBATION_GROWTH ** np.arange(min(escapes, 100.0))
    turns = np.minimum(settings.first_perturbation * growth, LARGEST_PERTURBATION)
    turned = float(turns.sum())
    if turned > LARGE_TURN:
        yield (
            f"{escapes} kicks turned the body by up to {math.degrees(turned):.0f} degrees in all: "
            "where it was slow, they carried it, not the springs."
        )
    if batch.status[0] == Ending.OUT_OF_STEPS:
        yield _delay(basin, batch, settings)


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
    least = float(spring_ratios(bodies, basins).min())
    return 2.0 * math.sqrt(min(TRANSLATION_STIFFNESS, max(0.0, least)))


def _predicted_rate(moving: Body, basin: Basin) -> float:
    """The decay rate of the slowest mode of the linearised dynamics at the optimum."""
    optimum = _at_rest(basin.optimum)
    return -float(np.linalg.eigvals(moving.intrinsic_jacobian(optimum)).real.max())


def _decay_rate(
    times: NDArray[np.float64], energy: NDArray[np.float64], moving: Body, basin: Basin
) -> float | None:
    """Half the slope of the logarithm of the energy above the optimum's: amplitudes decay so."""
    above = energy - moving.energies(_at_rest(basin.optimum)).potential
    tail = (above < RATE_START * above[0]) & (above > RATE_END * moving.spread)
    if np.count_nonzero(tail) < LEAST_SAMPLES:
        return None
    slope = np.polyfit(times[tail], np.log(above[tail]), 1)[0]
    return -0.5 * float(slope)


def _at_rest(q: NDArray[np.float64]) -> NDArray[np.float64]:
    """The state (18,) at rest with the rotation of a unit quaternion, the centroids together."""
    return state_at_rest(np.array(rotation_matrix(q.tolist())))
