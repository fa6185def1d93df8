"""The loop of a simulation with a free scale: midpoint steps by Newton's method, and when it ends.

The steps are generated code (compiled where there is any); a run has some dozens of them.
"""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.dynamics.integrators import MIDPOINT_MOST, MIDPOINT_SHARE
from certreg.equilibrium import TRANSLATION_STIFFNESS
from certreg.native import (
    BREATHING_SAMPLE,
    BREATHING_STATE,
    LARGEST_PERTURBATION,
    PERTURBATION_GROWTH,
    current_engine,
    named,
    plain,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.dynamics.breathing import BreathingBody
    from certreg.dynamics.integrators import SimulationSettings
    from certreg.native import Records

NEWTON_STEPS, NEWTON_TOLERANCE, LARGEST_TURN = 20, 1e-12, 2.0  # as of the rigid body's loops
LEAST_STEP = 1e-9  # of the own one: steps that short are taken only on the way to s = 0
LEAST_SCALE = 1e-6  # of the start's: below, the scale is on its way to 0
FLAT = 1e-9  # of the largest curvature: less is none
STALLED = 0.05  # of the largest curvature: a torque above is no saddle, only slow
LOG_CAPACITY = 2048  # samples that are kept


class BreathingEnding(enum.Enum):
    """How a run ended."""

    AT_REST = enum.auto()
    COLLAPSED = enum.auto()
    OUT_OF_STEPS = enum.auto()


@dataclass(slots=True)
class BreathingRun:
    """One body on its way.

    size: of the largest step. rows: of the log, each BREATHING_SAMPLE, every `stride`-th step.
    """

    moving: BreathingBody
    settings: SimulationSettings
    state: NDArray[np.float64]
    size: float
    least_scale: float
    ending: BreathingEnding = BreathingEnding.OUT_OF_STEPS
    time: float = 0.0
    taken: int = 0
    escapes: int = 0
    stride: int = 1
    rows: list[Any] = field(default_factory=list[Any])

    @classmethod
    def of(
        cls, moving: BreathingBody, state: Records, settings: SimulationSettings
    ) -> BreathingRun:
        """At the start."""
        own = MIDPOINT_SHARE * math.sqrt(TRANSLATION_STIFFNESS / stiffest(moving))
        given = min(settings.step, MIDPOINT_MOST * own) if settings.step else own
        return cls(
            moving=moving,
            settings=settings,
            state=plain(state).copy(),
            size=given,
            least_scale=LEAST_SCALE * float(state["scale"]),
        )

    def to_the_end(self) -> BreathingRun:
        """Step until the body is at rest, its scale falls to 0, or the steps run out."""
        perturbation, tolerance = (
            self.settings.first_perturbation,
            self.settings.speed_tolerance,
        )
        self._record()
        while self.taken < self.settings.max_steps:
            slow = self.moving.squared_speed(self._record_of()) < tolerance**2
            if slow:
                left = self._escaped(perturbation)
                if left is None:
                    self.ending = BreathingEnding.AT_REST
                    break
                if left is not self.state:
                    self.state, self.escapes = left, self.escapes + 1
                    perturbation = min(perturbation * PERTURBATION_GROWTH, LARGEST_PERTURBATION)
            if not self._stepped():
                self.ending = BreathingEnding.COLLAPSED
                break
            self._record()
        self._record_last()
        return self

    def _record_of(self) -> Records:
        return named(self.state, BREATHING_STATE)

    def _stepped(self) -> bool:
        """Whether a step was made; a shorter one where Newton fails or the scale would be 0."""
        size = self.size
        while size > LEAST_STEP * self.size:
            following = self._after(size)
            if following is not None:
                self.state, self.time, self.taken = following, self.time + size, self.taken + 1
                return True
            size /= 2.0
        return False

    def _after(self, size: float) -> NDArray[np.float64] | None:
        """The state after a step; None where there is none with a scale above 0."""
        engine, step = current_engine(), np.array([size])
        state = self._record_of()
        middle: Any = np.array([*state["omega"], state["growth"]])
        before = math.inf
        for _ in range(NEWTON_STEPS):
            residual, slope = engine.evaluate(
                "certreg_breathing_midpoint_residual", self.state, self.moving.record, middle, step
            )
            try:
                change = np.linalg.solve(slope.reshape(4, 4), residual)
            except np.linalg.LinAlgError:
                return None
            middle = middle - change
            if not size * float(np.linalg.norm(middle[:3])) <= LARGEST_TURN:  # NaN, too
                return None
            scale = float(state["scale"]) + size * float(middle[3])
            if not scale > self.least_scale:
                return None
            moved = size * float(np.linalg.norm(change[:3])) + size * abs(change[3]) / scale
            if moved <= NEWTON_TOLERANCE and (moved >= before / 4.0 or not moved):
                return self._ended(middle, step)
            before = moved
        return None

    def _ended(self, middle: NDArray[np.float64], step: NDArray[np.float64]) -> Any:
        (following,) = current_engine().evaluate(
            "certreg_breathing_midpoint_step", self.state, self.moving.record, middle, step
        )
        q = named(following, BREATHING_STATE)["q"]
        q /= math.sqrt(float(q @ q))
        return following

    def _escaped(self, amount: float) -> NDArray[np.float64] | None:
        """The state, turned where it is at a saddle; None where it is at rest in a valley."""
        hessian, torque = current_engine().evaluate(
            "certreg_breathing_curvature", self.state, self.moving.record
        )
        torque = float(self._record_of()["scale"]) * torque
        values, vectors = np.linalg.eigh(hessian.reshape(4, 4)[:3, :3])
        largest = float(np.abs(values).max())
        if float(np.abs(torque).max()) > STALLED * largest:
            return self.state
        if values[0] >= -FLAT * largest:
            firm = values > FLAT * largest
            off = np.linalg.norm((torque @ vectors)[firm] / values[firm])
            return None if off <= self.settings.rest_angle else self.state
        axis = vectors[:, 0] * math.copysign(1.0, float(vectors[:, 0] @ torque))
        return self._turned(amount, axis)

    def _turned(self, amount: float, axis: NDArray[np.float64]) -> NDArray[np.float64]:
        moved = self.state.copy()
        q = named(moved, BREATHING_STATE)["q"]
        w, v, sine = float(q[0]), q[1:].copy(), math.sin(amount / 2.0) * axis
        cosine = math.cos(amount / 2.0)
        q[0], q[1:] = cosine * w - v @ sine, cosine * v + w * sine + np.cross(v, sine)
        return moved

    def _record(self) -> None:
        """Log a state; when the log is full, every second sample goes."""
        if self.taken % self.stride:
            return
        if len(self.rows) == LOG_CAPACITY:
            self.rows, self.stride = self.rows[::2], 2 * self.stride
            if self.taken % self.stride:
                return
        self._log()

    def _log(self) -> None:
        state = self._record_of()
        row = [self.time, *self.state, *self.moving.energies(state)]
        self.rows.append(named(row, BREATHING_SAMPLE))

    def _record_last(self) -> None:
        last = self.rows[-1]
        if last["time"] != self.time or (plain(last)[1:16] != self.state).any():
            self._log()


def stiffest(moving: BreathingBody) -> float:
    """The largest curvature of the energy beside the inertia, a proposal.

    Of the rotation at scale 1 it is at most 4 |C| over the least moment of inertia; translation and
    scale have 2.
    """
    least = float(np.linalg.eigvalsh(moving.inertia)[0])
    values = np.linalg.svd(moving.record["cross"])[1]
    return max(TRANSLATION_STIFFNESS, 2.0 * float(values[0] + values[1]) / least)
