"""The breathing body: the registration dynamics with the size s of the body as a state.

A point stands at s R x + c; springs, masses and damping are those of `certreg.dynamics.body`:

    c' = v,    R' = R [omega],    s' = p,    v' = -2 c - mu v,
    s J omega' = 2 vee(R^T C - C^T R) - s omega x J omega - (mu s + 2 p) J omega,
    Sxx p' = s omega^T J omega - 2 s Sxx + 2 tr(R^T C) - mu Sxx p.

Source and target have units of length of their own, powers of two near their radii, so that s is
near 1 where the fit is good, whatever units the clouds are in. At s = 0 the inertia s^2 J is gone
and the motion not defined: a run that gets there stops. A state with s > 0 and less energy than
Syy never does (derivations, breathing_confined). Nothing is evaluated here: the functions are
generated (certreg/native/generated).
"""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from certreg._loading import cached_property
from certreg.dynamics.body import exponent_of, require_thick
from certreg.dynamics.integrators import (
    MIDPOINT_MOST,
    MIDPOINT_SHARE,
    SimulationSettings,
    integrate,
)
from certreg.equilibrium import TRANSLATION_STIFFNESS, source_size
from certreg.errors import DegenerateProblemError
from certreg.exact import power_of_two, rank
from certreg.geometry import rotation_matrices
from certreg.native import (
    BASIN,
    BODY,
    BREATHING_SAMPLE,
    BREATHING_STATE,
    Batch,
    Ending,
    Integrator,
    Log,
    current_engine,
    named,
    plain,
    record_of,
    symmetric,
)
from certreg.problem import trace
from certreg.results import Brief

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from certreg.native import Records
    from certreg.objective import Isotropic
    from certreg.problem import ExactMoments

LOG_CAPACITY = 2048  # samples that are kept
MOST_BITS_APART = 256  # sizes, scale 1 in units: 3 of its powers, 2^768, and 2^53 are doubles
UPPER = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))


class BreathingStatus(enum.Enum):
    """How a simulation with a free scale ended; the value is the message shown to the user."""

    AT_REST = (
        "The body is at rest: slower than the tolerance, where the energy falls in no direction."
    )
    COLLAPSED = (
        "The scale falls to 0, where the inertia vanishes and the motion is not defined: stopped "
        "before it. Begin with less energy, nearer to the target in size and rotation."
    )
    OUT_OF_STEPS = "The steps ran out before the body was at rest."


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BreathingBody(Brief):
    """What the dynamics knows of a problem whose scale is free, per unit of mass.

    record: () of BODY, lengths of the source over 2^source_exponent, of the target over
    2^target_exponent. apart: (3,), the source's centre of mass where it was given less the
    target's, over 2^target_exponent. mass: M, exact.
    """

    record: Records
    source_exponent: int
    target_exponent: int
    apart: tuple[float, ...]
    mass: Fraction

    @property
    def unit_of_scale(self) -> float:
        """What a scale of 1 in these units is for the user: 2^(target_exponent - source)."""
        return math.ldexp(1.0, self.target_exponent - self.source_exponent)

    @property
    def start(self) -> Records:
        """The state () at rest where the source was given, at its own size: scale 1."""
        return breathing_state((1.0, 0.0, 0.0, 0.0), 1.0 / self.unit_of_scale, self.apart)

    @property
    def inertia(self) -> NDArray[np.float64]:
        """J / M, (3, 3)."""
        return symmetric(self.record["inertia"])

    @property
    def size(self) -> float:
        """Sxx / M."""
        return float(np.trace(self.inertia)) / 2.0

    def rate(self, state: NDArray[np.float64]) -> NDArray[np.float64]:
        """The rates s' = F(s), (20,), at c, R row by row, s, v, omega, s'."""
        return self._evaluated("certreg_breathing_rate", state)[0]

    def energies(self, state: Records) -> NDArray[np.float64]:
        """Kinetic energy of translation, rotation and scale, V_p, over M; tr(R^T C) over M."""
        return self._evaluated("certreg_breathing_energies", state)[0]

    def jacobian(self, state: Records) -> NDArray[np.float64]:
        """The linearised dynamics in (c, phi, s, v, omega, s'), (14, 14)."""
        return self._evaluated("certreg_breathing_jacobian", state)[0].reshape(14, 14)

    def hessian(self, state: Records) -> NDArray[np.float64]:
        """The Hessian (4, 4) of V_p / M along q exp(phi / 2), s."""
        return self._evaluated("certreg_breathing_curvature", state)[0].reshape(4, 4)

    def squared_speed(self, state: Records) -> float:
        """|s'|^2, of 20 numbers: nine of them those of R."""
        return float(self._evaluated("certreg_breathing_squared_speed", state)[0][0])

    def _evaluated(
        self, name: str, state: Records | NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], ...]:
        return current_engine().evaluate(name, state, self.record)


def breathing_state(
    q: Sequence[float] | NDArray[np.float64], scale: float, c: Sequence[float] = (0.0, 0.0, 0.0)
) -> Records:
    """The state () at rest with a quaternion, a scale and a c."""
    state = np.zeros((), dtype=BREATHING_STATE)
    state["q"], state["scale"], state["c"] = q, scale, c
    return state


def breathing_body(moments: ExactMoments, damping: float) -> BreathingBody:
    """The body of a problem whose source is not collinear, and not too unlike its target in size.

    Raises DegenerateProblemError for another one.
    """
    if rank(moments.source_scatter) < 2:
        message = "the source points are collinear: the rotational dynamics is not defined"
        raise DegenerateProblemError(message, rank=rank(moments.source_scatter))
    own, other = _units(moments)
    if abs(own - other) > MOST_BITS_APART:
        message = (
            "source and target differ too much in size for a simulation in double precision: "
            "change the unit of length of one cloud"
        )
        raise DegenerateProblemError(message, value=abs(own - other), limit=MOST_BITS_APART)
    record = _record(moments, damping, own, other)
    apart = (
        float((x - y) / power_of_two(other))
        for x, y in zip(moments.source_centroid, moments.target_centroid, strict=True)
    )
    return BreathingBody(
        record=record,
        source_exponent=own,
        target_exponent=other,
        apart=tuple(apart),
        mass=moments.total_weight,
    )


def _units(moments: ExactMoments) -> tuple[int, int]:
    """Of lengths of source and target: the exponents of powers of two near their radii."""
    own, other = (
        exponent_of(trace(scatter) or 1, moments.mass**2, 2 * exponent) // 2
        for scatter, exponent in (
            (moments.source_scatter, moments.source_exponent),
            (moments.target_scatter, moments.target_exponent),
        )
    )
    return own, other


def _record(moments: ExactMoments, damping: float, own: int, other: int) -> Records:
    """The record of the body in these units; raises where no double matrix is the inverse of J."""
    square = moments.mass**2
    a, b = moments.source_exponent - own, moments.target_exponent - other
    inertia = [_over(moments.inertia[i][j], 2 * a, square) for i, j in UPPER]
    require_thick(inertia)
    inverse = np.linalg.inv(symmetric(np.array(inertia)))
    spread = Fraction(trace(moments.source_scatter)) * power_of_two(2 * a)
    spread += Fraction(trace(moments.target_scatter)) * power_of_two(2 * b)
    numbers = [
        *(_over(entry, a + b, square) for row in moments.cross for entry in row),
        *inertia,
        *(float(inverse[i, j]) for i, j in UPPER),
        float(spread / square),
        damping,
    ]
    return named(numbers, BODY)


def _over(entry: int, places: int, square: int) -> float:
    return float(Fraction(entry, square) * power_of_two(places))


@dataclass(frozen=True, kw_only=True, eq=False)
class BreathingTrajectory(Brief):
    """A simulation with a free scale, by the midpoint rule; logged at evenly spaced steps.

    samples: (L,) records BREATHING_SAMPLE, the last state at `time` included; lengths and scales in
    the units of `moving`. step: the largest; escapes: how often the body was perturbed off a
    saddle.
    """

    status: BreathingStatus
    step: float
    steps: int
    escapes: int
    moving: BreathingBody
    samples: Records

    def __repr__(self) -> str:
        return f"<BreathingTrajectory: {self.status.name} after {self.steps} steps of midpoint>"

    @property
    def at_rest(self) -> bool:
        """Whether the body came to rest."""
        return self.status is BreathingStatus.AT_REST

    @property
    def converged(self) -> bool:
        """The same: with a scale above 0 the energy falls in some direction at all but optima."""
        return self.at_rest

    @property
    def integrator(self) -> Integrator:
        """The one there is."""
        return Integrator.MIDPOINT

    @property
    def length_exponent(self) -> int:
        """The unit of length of target, places and energies is 2^length_exponent."""
        return self.moving.target_exponent

    @property
    def last(self) -> Records:
        """The last state, () of BREATHING_STATE."""
        return self.samples["state"][-1]

    @property
    def quaternion(self) -> NDArray[np.float64]:
        """(4,), of the last state."""
        return self.last["q"]

    @property
    def times(self) -> NDArray[np.float64]:
        """(L,), in the time unit of the springs."""
        return self.samples["time"]

    @cached_property
    def states(self) -> NDArray[np.float64]:
        """(L, 18), c, R row by row, v, omega, with lengths over 2^length_exponent."""
        states = self.samples["state"]
        turns = rotation_matrices(states["q"]).reshape(-1, 9)
        return np.hstack([states["c"], turns, states["v"], states["omega"]])

    @property
    def scales(self) -> NDArray[np.float64]:
        """(L,), the scale, target's unit over source's."""
        return self.samples["state"]["scale"] * self.moving.unit_of_scale

    @property
    def potential(self) -> NDArray[np.float64]:
        """(L,), V_p / M over 4^target_exponent of `moving`."""
        return self.samples["energies"]["potential"]

    @property
    def kinetic(self) -> NDArray[np.float64]:
        """(L,), V_k / M over 4^target_exponent of `moving`."""
        energies = self.samples["energies"]
        return energies["translation"] + energies["rotation"] + energies["scale"]

    @cached_property
    def speed(self) -> float:
        """|s'| at the end, the residual of the equilibrium equations."""
        return math.sqrt(self.moving.squared_speed(self.last))


def never_collapses(objective: Isotropic) -> bool:
    """Whether the exact motion from where the source was given, at rest at scale 1, keeps s > 0.

    Proved, in rationals: it begins with less energy than Syy (derivations, breathing_confined).
    False means not proved, not disproved. Raises as `source_size`.
    """
    still = (1, 0, 0, 0)
    shifted = objective.translation_energy(still, (Fraction(0),) * 3)
    released = objective.energy_at(still, shifted, Fraction(1))
    return released < objective.moments.spread - source_size(objective)


def simulate_breathing(
    objective: Isotropic,
    damping: float,
    *,
    start: Records | None = None,
    settings: SimulationSettings | None = None,
) -> BreathingTrajectory:
    """The motion of a body with a free scale, released at rest where it was given at scale 1.

    start: another state, () of BREATHING_STATE, in the units of `BreathingBody`. Raises
    DegenerateProblemError where the dynamics is undefined, ValueError for a start without s > 0.
    """
    moving = breathing_body(objective.moments, damping)
    state = moving.start if start is None else start
    if not float(state["scale"]) > 0.0:
        raise ValueError(f"the start has the scale {float(state['scale'])!r}: give one above 0")
    settings = settings or SimulationSettings()
    batch = Batch.single(
        Integrator.MIDPOINT,
        bodies=moving.record[np.newaxis],
        basins=np.empty(1, dtype=BASIN),
        steps=_step(moving, settings),
        start=state[np.newaxis].copy(),
    )
    log = Log.of_capacity(LOG_CAPACITY, BREATHING_SAMPLE)
    integrate(batch, settings, log)
    return BreathingTrajectory(
        status=BreathingStatus[Ending(batch.status.item(0)).name],
        step=float(batch.steps["h"][0]),
        steps=int(batch.taken[0]),
        escapes=int(batch.escapes[0]),
        moving=moving,
        samples=_with_the_last(batch, log, moving),
    )


def _step(moving: BreathingBody, settings: SimulationSettings) -> Records:
    """The step (1,), its own or the user's where that gains something."""
    own = MIDPOINT_SHARE * math.sqrt(TRANSLATION_STIFFNESS / stiffest(moving))
    given = min(settings.step, MIDPOINT_MOST * own) if settings.step else own
    return record_of([given], Integrator.MIDPOINT.step, (1,))


def _with_the_last(batch: Batch, log: Log, moving: BreathingBody) -> Records:
    samples, last = log.samples, batch.states
    if samples["time"][-1] == batch.times[0] and samples["state"][-1] == last[0]:
        return samples
    end = [*batch.times, *plain(last)[0], *moving.energies(last[0])]
    return np.append(samples, named([end], BREATHING_SAMPLE))


def stiffest(moving: BreathingBody) -> float:
    """The largest curvature of the energy beside the inertia, a proposal.

    Of the rotation at scale 1 it is at most 4 |C| over the least moment of inertia; translation and
    scale have 2.
    """
    least = float(np.linalg.eigvalsh(moving.inertia)[0])
    values = np.linalg.svd(moving.record["cross"])[1]
    return max(TRANSLATION_STIFFNESS, 2.0 * float(values[0] + values[1]) / least)
