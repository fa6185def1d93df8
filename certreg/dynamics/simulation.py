"""Simulated registration: the damped body released from rest until it is certain where it ends.

Three integrators: explicit Euler with projection as in [Yang2020], the implicit midpoint rule whose
energy never rises, and a splitting that takes a few large steps. A small |s'| alone proves nothing:
near a saddle it is small, too, and where springs are weak, everywhere. So a run ends only when |s'|
is small *and* the state is in the certified basin (documented at `Basin`), from which the exact
flow can end nowhere but at the optimum, *and* so deep in it that the flow stays near. A stop at a
saddle is noticed from the curvature, kicked along the direction of escape, and continued.
"""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from certreg.dynamics.body import AT_REST, SMALLEST_BARRIER, Body, body_of, start_at_rest
from certreg.dynamics.integrators import integrate, spring_ratios, step_parameters
from certreg.equilibrium import TRANSLATION_STIFFNESS, unit_double
from certreg.errors import DegenerateProblemError
from certreg.geometry import quaternion_from_matrix, rotation_matrix
from certreg.native import (
    ENERGIES,
    Batch,
    Ending,
    Integrator,
    Log,
)
from certreg.settings import SimulationSettings

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from certreg.equilibrium import Spectrum

RATE_WINDOW = (
    1e-3,
    1e-13,
)  # of the energy at the start (transients over), of the spread (rounding)
LEAST_SAMPLES = 4  # to fit a line through


class SimulationStatus(enum.Enum):
    """How a simulation ended; the value is the message shown to the user."""

    CONVERGED = "The body came to rest at the optimum, inside the certified basin."
    AT_REST = (
        "The body came to rest at one of the optima; where the optimum is not unique, no more."
    )
    OUT_OF_STEPS = (
        "The steps ran out before the body was at rest at the optimum. The certificate does not "
        "depend on it."
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Basin:
    """The certified basin of the optimum, as the simulation sees it (floating point proposes).

    E = omega^T J omega / 2 - 2 q^T K q never rises along the exact flow, and at every spurious
    equilibrium E >= -2 l2. So a state with l1 - q^T K q + omega^T J omega / 4 < l1 - l2 has less
    energy than all of them, and by LaSalle's theorem ends at the optimum. The left side is a sum of
    squares, (l1 - lk) (q . q_k)^2, and so has no cancellation. Over l1 - l2 it bounds sin^2 of half
    the angle to the optimum, now and ever after. Proof: derivations, certified_basin.

    quaternions: (4, 4), orthonormal rows, by descending eigenvalue.
    deficits: (4,), l1 - lk over the mass, lengths over the body's unit; exact zeros on the optima.
    """

    quaternions: NDArray[np.float64]
    deficits: NDArray[np.float64]

    @property
    def barrier(self) -> float:
        """The alignment l1 - l2 that separates the optimum from the rest: half of that in E."""
        return float(self.deficits[1])

    @property
    def parameters(self) -> NDArray[np.float64]:
        """The 20 numbers that the trajectory loops take."""
        return np.concatenate([self.quaternions.ravel(), self.deficits])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trajectory:
    """A simulated registration; logged at evenly spaced steps, the last one included.

    times (L,), in the time unit of the springs; states (L, 18) with lengths over
    2^length_exponent; potential and kinetic (L,), V_p / M and V_k / M over 4^length_exponent.
    quaternion: (4,), angular_velocity: (3,), of the last state: what the basin proof is about.
    step: the largest; steps: how many; escapes: how often the body was kicked off a saddle.
    speed: |s'| at the end, the residual of the equilibrium equations.
    notes: what else is to be known: a step that was not taken as given, kicks that did the work of
        the springs, and, where the steps ran out, what makes them too few.
    predicted_rate: of the slowest mode at the optimum, from the linearised dynamics; None where the
        optimum is not unique. decay_rate: as measured in the logged energies; None where too few
        samples lie between a thousandth of the energy at the start and its rounding.
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
    predicted_rate: float | None
    decay_rate: float | None
    notes: tuple[str, ...]

    @property
    def converged(self) -> bool:
        """Whether the body came to rest where it had to."""
        return self.status in {SimulationStatus.CONVERGED, SimulationStatus.AT_REST}


def simulate(
    found: Spectrum,
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
    if not found.classification.inertia_definite:
        message = "the source points are collinear: the rotational dynamics is not defined"
        raise DegenerateProblemError(message)
    moving = body_of(found.moments, damping)
    basin = certified_basin(found, moving.length_exponent)
    begin = start_at_rest(found.moments, moving.length_exponent) if start is None else start
    batch = Batch.of(
        integrator,
        bodies=moving.parameters[np.newaxis],
        basins=basin.parameters[np.newaxis],
        steps=step_parameters(
            integrator, moving.parameters[np.newaxis], basin.parameters[np.newaxis], settings
        ),
        states=_native(np.asarray(begin, dtype=float), integrator)[np.newaxis],
    )
    log = Log.of_capacity(settings.log_capacity, integrator)
    integrate(batch, settings, log)
    _require_finite(begin, moving, batch)
    return _trajectory(moving, basin, batch, log, settings)


def _require_finite(begin: NDArray[np.float64], moving: Body, batch: Batch) -> None:
    """DegenerateProblemError where a step too long for its spin drove a body beyond the doubles."""
    with np.errstate(over="ignore", invalid="ignore"):
        end = moving.energies(_paper_states(batch.states, batch.integrator)[0])
    if np.isfinite(begin).all() and not math.isfinite(end.kinetic + end.potential):
        message = (
            f"the {batch.integrator.value} integrator gained energy without end under the damping "
            f"{moving.damping:.3g}: take the midpoint integrator, whose energy never rises, or "
            "more damping"
        )
        raise DegenerateProblemError(message)


def optimal_damping(found: Spectrum) -> float:
    """The damping mu* = 2 sqrt(min(2, g_min)) under which the slowest mode decays fastest.

    g: eigenvalues of the pencil (G, J) at the optimum; sqrt(8) without noise. Raises
    DegenerateProblemError where the dynamics is not defined or the optimum is not unique.
    Proof: derivations, optimal_damping.
    """
    if not (found.classification.inertia_definite and found.classification.unique):
        message = "the best damping needs a source that is not collinear and a unique optimum"
        raise DegenerateProblemError(message)
    moving = body_of(found.moments, 1.0)
    basin = certified_basin(found, moving.length_exponent)
    return _best_damping(moving.parameters[np.newaxis], basin.parameters[np.newaxis])


def certified_basin(found: Spectrum, length_exponent: int) -> Basin:
    """The basin that belongs to a spectrum, in the body's unit of length.

    Raises DegenerateProblemError where doubles do not tell the optima from what is none.
    """
    values = found.basis.values
    scale = found.moments.total_weight * (4**length_exponent if length_exponent >= 0 else 1)
    deficits = [(values[0] - value) * found.unit / scale for value in values]
    if length_exponent < 0:
        deficits = [deficit * 4**-length_exponent for deficit in deficits]
    for k in range(found.classification.pattern[0]):
        deficits[k] *= 0
    rounded = np.array([float(deficit) for deficit in deficits])
    if (rounded[found.classification.pattern[0] :] < SMALLEST_BARRIER).any():
        message = (
            "not every pose is optimal, but by less than double precision can tell: the clouds "
            "differ so much in size, or are so nearly uncorrelated, that springs hardly turn the "
            "body; bring both clouds to one unit of length"
        )
        raise DegenerateProblemError(message)
    return Basin(
        quaternions=np.array([unit_double(v) for v in found.basis.vectors]), deficits=rounded
    )


def _native(state: NDArray[np.float64], integrator: Integrator) -> NDArray[np.float64]:
    """The 18 numbers of a state as the integrator keeps them: with a quaternion if it has one."""
    if integrator is Integrator.EULER:
        return state
    q = quaternion_from_matrix(state[3:12].reshape(3, 3))
    return np.concatenate([state[:3], q, state[12:]])


def _paper_states(states: NDArray[np.float64], integrator: Integrator) -> NDArray[np.float64]:
    """States (L, 18 or 13) with rotation matrices, (L, 18)."""
    if integrator is Integrator.EULER:
        return states
    rotations = rotation_matrix(list(states[:, 3:7].T))
    flat = np.array([entry for row in rotations for entry in row]).T
    return np.hstack([states[:, :3], flat, states[:, 7:]])


_STATUSES = {
    Ending.OUT_OF_STEPS: SimulationStatus.OUT_OF_STEPS,
    Ending.CONVERGED: SimulationStatus.CONVERGED,
    Ending.AT_REST: SimulationStatus.AT_REST,
}


def _trajectory(
    moving: Body, basin: Basin, batch: Batch, log: Log, settings: SimulationSettings
) -> Trajectory:
    integrator, size = batch.integrator, batch.integrator.state_size
    samples = log.samples
    times, states = samples[:, 0], _paper_states(samples[:, 1 : 1 + size], integrator)
    energies = dict(zip(ENERGIES, samples[:, 1 + size :].T, strict=True))
    kinetic, potential = energies["translation"] + energies["rotation"], energies["potential"]
    last = _paper_states(batch.states, integrator)[0]
    if times[-1] != batch.times[0] or (states[-1] != last).any():
        end = moving.energies(last)
        times, states = np.append(times, batch.times), np.vstack([states, last])
        kinetic, potential = np.append(kinetic, end.kinetic), np.append(potential, end.potential)
    unique = basin.barrier > 0.0
    return Trajectory(
        integrator=integrator,
        status=_STATUSES[Ending(int(batch.status[0]))],
        step=float(batch.steps[0, 0]),
        steps=int(batch.taken[0]),
        escapes=int(batch.escapes[0]),
        times=times,
        states=states,
        potential=potential,
        kinetic=kinetic,
        length_exponent=moving.length_exponent,
        quaternion=quaternion_from_matrix(last[3:12].reshape(3, 3)),
        angular_velocity=last[15:],
        speed=float(np.linalg.norm(moving.rate(last))),
        predicted_rate=_predicted_rate(moving, basin) if unique else None,
        decay_rate=_decay_rate(times, potential + kinetic, moving, basin) if unique else None,
        notes=tuple(_notes(basin, batch, settings)),
    )


def _notes(basin: Basin, batch: Batch, settings: SimulationSettings) -> Iterator[str]:
    """What is to be known of a run beside how it ended."""
    step, escapes = float(batch.steps[0, 0]), int(batch.escapes[0])
    if settings.step is not None and step < settings.step:
        yield (
            f"The step {settings.step:.6g} is longer than {batch.integrator.value} takes here: "
            f"{step:.6g} was taken."
        )
    kicks = settings.first_kick * settings.kick_growth ** np.arange(min(escapes, 100.0))
    turned = float(np.minimum(kicks, settings.largest_kick).sum())
    if turned > settings.many_kicks:
        yield (
            f"{escapes} kicks turned the body by up to {math.degrees(turned):.0f} degrees in all: "
            "where it was slow, they carried it, not the springs."
        )
    if batch.status[0] == Ending.OUT_OF_STEPS:
        yield _delay(basin, batch, settings)


def _delay(basin: Basin, batch: Batch, settings: SimulationSettings) -> str:
    """What makes the steps too few."""
    step, damping = float(batch.steps[0, 0]), float(batch.bodies[0, 22])
    if int(batch.taken[0]) < settings.max_steps:
        return "No step could be made from the last state."
    own = replace(settings, step=None)
    usual = float(step_parameters(batch.integrator, batch.bodies, batch.basins, own)[0, 0])
    if settings.step is not None and step < settings.short_step * usual:
        return f"The step {step:.3g} is short: {batch.integrator.value} itself takes {usual:.3g}."
    if basin.barrier > 0.0:
        best = _best_damping(batch.bodies, batch.basins)
        if not best / settings.far_damping <= damping <= best * settings.far_damping:
            far = f"The damping {damping:.3g} is far from the best one, {best:.3g}"
            return f"{far}: try --damping optimal."
    return (
        "The springs turn the body slowly: the ambiguity margin is small, or the clouds differ "
        "much in size, or are hardly correlated."
    )


def _best_damping(parameters: NDArray[np.float64], basins: NDArray[np.float64]) -> float:
    least = float(spring_ratios(parameters, basins)[0, 0])
    return 2.0 * math.sqrt(min(TRANSLATION_STIFFNESS, max(0.0, least)))


def _predicted_rate(moving: Body, basin: Basin) -> float:
    """The decay rate of the slowest mode of the linearised dynamics at the optimum."""
    optimum = _at_rest(basin.quaternions[0])
    return -float(np.linalg.eigvals(moving.intrinsic_jacobian(optimum)).real.max())


def _decay_rate(
    times: NDArray[np.float64], energy: NDArray[np.float64], moving: Body, basin: Basin
) -> float | None:
    """Half the slope of the logarithm of the energy above the optimum's: amplitudes decay so."""
    above = energy - moving.energies(_at_rest(basin.quaternions[0])).potential
    tail = (above < RATE_WINDOW[0] * above[0]) & (above > RATE_WINDOW[1] * moving.spread)
    if np.count_nonzero(tail) < LEAST_SAMPLES:
        return None
    slope = np.polyfit(times[tail], np.log(above[tail]), 1)[0]
    return -0.5 * float(slope)


def _at_rest(q: NDArray[np.float64]) -> NDArray[np.float64]:
    """The state (18,) at rest with the rotation of a unit quaternion, the centroids together."""
    return np.array([0.0, 0.0, 0.0, *np.ravel(rotation_matrix(q.tolist())), *AT_REST])
