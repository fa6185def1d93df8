"""A body on springs that break, whose bounds are drawn in until they are those that were given.

At first the bounds are so wide that all springs hold, then they shrink by a factor at a time, as
those of graduated non-convexity do [Yang2020GNC]; widths at which no spring breaks are left out. At
each the body moves on the springs that hold until it rests; then springs beyond their bounds break,
broken ones within them mend, and it moves on, until none breaks or mends. Neither raises the energy
V = sum of min(w r^2, w b^2): at rest the springs that hold have the least energy there is of these,
and a spring that breaks or mends takes the smaller of two energies. So no set of springs comes back
at the same bounds.

Springs break and mend only while the body is at rest: its motion in between is that of `simulate`,
the mass being that of the springs that hold. Floating point: what it ends in is a proposal.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.dynamics.rigid import core_of, require_dynamics
from certreg.dynamics.simulation import simulate
from certreg.dynamics.states import state_at_rest
from certreg.errors import DegenerateProblemError
from certreg.native.layout import MATRIX_STATE, named
from certreg.objective.isotropic import Isotropic
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.dynamics.integrators import SimulationSettings
    from certreg.native.loops import Integrator
    from certreg.problem.problem import RegistrationProblem


SHRINKING = 1.4  # of the bounds at a time, as [Yang2020GNC] has it
LEAST_BOUND = 1e-100  # of the clouds' size: far below what doubles tell of a residual
MOST_ROUNDS = 50  # of motions at the same bounds; three are usual


class BreakingStatus(enum.Enum):
    """How a simulation with springs that break ended; the value is the message for users."""

    SETTLED = "The springs that hold at the end are just those within their bounds."
    UNSETTLED = "Springs still broke or mended at the same bounds when the rounds ran out."
    LOOSE = "So many springs broke that those that hold are on one line: no motion is defined."
    OUT_OF_STEPS = "The steps ran out before the body was at rest."


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BreakingStage(Brief):
    """The body at rest with bounds of one width.

    width: the bounds over those that were given, 1 at the end. held: (N,), which springs hold.
    energy: V at these bounds, in objective units, infinite beyond the doubles; given_energy: with
    the bounds that were given.
    rounds: of motion, 0 where no spring broke or mended. steps, time: of all rounds so far.
    """

    width: float
    held: NDArray[np.bool_]
    energy: float
    given_energy: float
    rounds: int
    steps: int
    time: float

    @property
    def count(self) -> int:
        """How many springs hold."""
        return int(self.held.sum())


@dataclass(frozen=True, kw_only=True, eq=False)
class BreakingRun(Brief):
    """A simulation with springs that break, stage by stage.

    Attributes
    ----------
    problem
        The springs and their bounds.
    integrator, status
        Which, and how it ended.
    stages
        With ever narrower bounds: their width, which springs hold, energy and time.
    rotation, translation
        (3, 3) and (3,), of the end, in the unit of the clouds: y = R x + t.
    """

    problem: RegistrationProblem
    integrator: Integrator
    status: BreakingStatus
    stages: tuple[BreakingStage, ...]
    rotation: NDArray[np.float64]
    translation: NDArray[np.float64]

    @property
    def unbroken(self) -> tuple[int, ...]:
        """The rows whose springs hold at the end, ascending."""
        return tuple(self.stages[-1].held.nonzero()[0].tolist())


def run_breaking(
    problem: RegistrationProblem,
    integrator: Integrator,
    *,
    shrinking: float = SHRINKING,
    settings: SimulationSettings | None = None,
) -> BreakingRun:
    """The run of a body released at rest where it was given, with bounds that hold all springs.

    shrinking: > 1, by which the bounds are divided from one stage to the next.
    Raises DegenerateProblemError where the source is collinear, or the motion cannot be simulated:
    too stiff, or bounds below 1e-100 of the clouds' size.
    """
    annealed = _Annealed(problem, integrator, settings)
    stages, status = list[BreakingStage](), BreakingStatus.SETTLED
    width = max(1.0, float(annealed.ratios().max()))
    while True:
        status, stage = annealed.stage(width)
        stages.append(stage)
        if width == 1.0 or status is not BreakingStatus.SETTLED:
            break
        longest = float(annealed.ratios()[stage.held].max())
        width /= shrinking
        while width > max(1.0, longest):  # none breaks, and none mends
            width /= shrinking
        width = max(1.0, width)
    return BreakingRun(
        problem=problem,
        integrator=integrator,
        status=status,
        stages=tuple(stages),
        rotation=annealed.rotation,
        translation=annealed.given_translation,
    )


class _Annealed:
    """The body as it goes: its pose about the means of both clouds, and what it took."""

    def __init__(
        self,
        problem: RegistrationProblem,
        integrator: Integrator,
        settings: SimulationSettings | None,
    ) -> None:
        block = problem.block(slice(None))
        self._problem, self._integrator, self._settings = problem, integrator, settings
        self._centres = block.source.mean(axis=0), block.target.mean(axis=0)
        apart = self._centres[0] - self._centres[1]
        lengths = (block.source, block.target, problem.bounds, apart)
        self._exponent = int(np.frexp(max(float(np.abs(part).max()) for part in lengths))[1])
        self._source = self._in_units(block.source - self._centres[0])
        self._target = self._in_units(block.target - self._centres[1])
        self._bounds, self._weights = self._in_units(problem.bounds), block.weights
        least = float(self._bounds.min())
        if least < LEAST_BOUND:
            raise DegenerateProblemError(
                "a bound is so small beside the clouds that the motion cannot be simulated",
                value=least,
                limit=LEAST_BOUND,
            )
        self.rotation, self._shift = np.eye(3), self._in_units(apart)
        self._held, self._steps, self._time = np.zeros(problem.n, dtype=np.bool_), 0, 0.0

    @property
    def given_translation(self) -> NDArray[np.float64]:
        """The translation in the frame of the clouds as they were given."""
        here, there = self._centres
        return np.ldexp(self._shift, self._exponent) + there - self.rotation @ here

    def _in_units(self, lengths: NDArray[np.float64]) -> NDArray[np.float64]:
        """Over 2^exponent, so that no square overflows, and none that matters vanishes."""
        return np.ldexp(lengths, -self._exponent)

    def ratios(self) -> NDArray[np.float64]:
        """(N,): residuals over the bounds that were given."""
        return self._residuals() / self._bounds

    def _residuals(self) -> NDArray[np.float64]:
        ends = self._target - self._source @ self.rotation.T - self._shift
        return np.linalg.norm(ends, axis=1)

    def stage(self, width: float) -> tuple[BreakingStatus, BreakingStage]:
        """The body moves at bounds of this width until no spring breaks or mends."""
        status, rounds = BreakingStatus.UNSETTLED, 0
        while True:
            held = self.ratios() <= width
            if (held == self._held).all():
                status = BreakingStatus.SETTLED
                break
            if rounds == MOST_ROUNDS:
                break
            self._held, rounds = held, rounds + 1
            stopped = self._move(held)
            if stopped is not None:
                status = stopped
                break
        return status, self._recorded(width, rounds)

    def _move(self, held: NDArray[np.bool_]) -> BreakingStatus | None:
        """The body moves on some springs until it rests; why it cannot go on, if so."""
        rows = np.flatnonzero(held)
        if not len(rows):
            return BreakingStatus.LOOSE
        objective = Isotropic.of(self._problem.of_rows(rows.tolist()))
        if held.all():
            require_dynamics(objective)
        if not objective.classification.inertia_definite:
            return BreakingStatus.LOOSE
        weights = self._weights[rows] / self._weights[rows].sum()
        here, there = weights @ self._source[rows], weights @ self._target[rows]
        places = core_of(objective.moments).length_exponent - self._exponent
        apart = np.ldexp(self.rotation @ here + self._shift - there, -places)
        run = simulate(
            objective,
            self._problem.damping,
            self._integrator,
            start=state_at_rest(self.rotation, apart),
            settings=self._settings,
        )
        end = named(run.states[-1], MATRIX_STATE)
        self.rotation = np.array(end["R"])
        self._shift = there + np.ldexp(end["c"], places) - self.rotation @ here
        self._steps += run.steps
        self._time += float(run.times[-1])
        return None if run.converged else BreakingStatus.OUT_OF_STEPS

    def _recorded(self, width: float, rounds: int) -> BreakingStage:
        residuals, energies = self._residuals(), list[float]()
        with np.errstate(over="ignore"):
            for most in (width * self._bounds, self._bounds):
                energy = self._weights @ np.minimum(residuals, most) ** 2
                energies.append(float(np.ldexp(energy, 2 * self._exponent)))
        return BreakingStage(
            width=width,
            held=self._held.copy(),
            energy=energies[0],
            given_energy=energies[1],
            rounds=rounds,
            steps=self._steps,
            time=self._time,
        )
