"""One body from its start to its end where no C does that: as loop.h, escape.c, midpoint.c.

Of a body whose scale is a state there is no loop in C: it takes some dozens of steps. General
springs are moved by C alone; the tests have a run of their own beside it.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from certreg.geometry.so3 import quaternion_from_matrix, rotation_matrix
from certreg.native.layout import (
    BREATHING_STATE,
    ENERGIES,
    MATRIX_STATE,
    QUATERNION_STATE,
    RecordType,
    named,
    plain,
)
from certreg.native.loops import (
    BASIN_SHARE,
    HALVINGS,
    LARGEST_PERTURBATION,
    LARGEST_TURN,
    NEWTON_STEPS,
    NEWTON_TOLERANCE,
    PERTURBATION_GROWTH,
    STALLED_TORQUE,
    Batch,
    Ending,
    Engine,
    Integrator,
    Kind,
    Log,
    Rules,
)

Array = Any  # NDArray[np.float64]
NO_TORQUE = 1e-12  # of the curvature: less is rounding, and must not choose a side
FLAT = 1e-9  # of the largest curvature: less is none
LEAST_SCALE = 1e-6  # of the start's: below, the scale is on its way to 0


class BodyRun:
    """One body on its way; its state, a step and so on as plain doubles, read through `named`."""

    names = "certreg_quaternion_"  # of the functions of a state
    steps_prefix = Kind.RIGID.value  # of those of a step
    unknowns = ("omega",)  # of a midpoint step: the middle velocities
    tolerance = NEWTON_TOLERANCE**2  # of what `_moved` says
    halvings = HALVINGS  # of a midpoint step
    stuck = Ending.OUT_OF_STEPS  # what it is where no step can be made

    def __init__(self, machine: Engine, batch: Batch, rules: Rules, log: Log | None) -> None:
        self.machine, self.batch, self.rules, self.log = machine, batch, rules, log
        self.integrator, self.state = batch.integrator, batch.states.dtype
        self.body, self.step = plain(batch.bodies)[0], plain(batch.steps)[0]
        self.size = float(batch.steps["h"][0])
        self.quaternions, self.gaps = batch.basins["quaternions"][0], batch.basins["gaps"][0]
        self.prefix = "certreg_" if self.integrator is Integrator.EULER else self.names
        self.perturbation = rules.first_perturbation

    def to_the_end(self) -> None:
        """Step until the state may stop, or the steps run out."""
        batch, rules = self.batch, self.rules
        state, time, taken, escapes = plain(batch.states)[0].copy(), 0.0, 0, 0
        while True:
            self._record(taken, time, state)
            following, speed = self._look_ahead(state)
            end = Ending.OUT_OF_STEPS
            if speed < rules.speed_tolerance**2:
                end, state = self._looked_at(state)
                escapes += end is Ending.PERTURBED
            ended = end in {Ending.CONVERGED, Ending.AT_REST}
            if ended or taken >= rules.max_steps or math.isnan(speed):
                break
            if end is Ending.PERTURBED or following is None:
                following, size = self._advanced(state)
            else:
                size = self.size
            if following is None:
                end = self.stuck
                break
            state, time, taken = following, time + size, taken + 1
        if self.integrator is not Integrator.MIDPOINT:
            time = taken * self.size
        batch.states[0] = named(state, self.state)
        batch.taken[0], batch.escapes[0], batch.times[0] = taken, escapes, time
        batch.status[0] = Ending.OUT_OF_STEPS if end is Ending.PERTURBED else end

    def _look_ahead(self, state: Array) -> tuple[Array | None, float]:
        """The next state where it comes with the speed, else None; |s'|^2 now."""
        if self.integrator is Integrator.MIDPOINT:
            name = f"{self.names}squared_speed"
            return None, float(self.machine.evaluate(name, state, self.body)[0][0])
        following, speed = self._explicit(state)
        return following, float(speed[0])

    def _explicit(self, state: Array) -> tuple[Array, Array]:
        name = f"{self.steps_prefix}{self.integrator.value}_step"
        following, speed = self.machine.evaluate(name, state, self.body, self.step)
        return following, speed

    def _advanced(self, state: Array) -> tuple[Array | None, float]:
        """The state after a step and the step's size; None where Newton never converges."""
        if self.integrator is not Integrator.MIDPOINT:
            return self._explicit(state)[0], self.size
        size = self.size
        for _ in range(self.halvings + 1):
            middle = self._middle(state, size)
            if middle is not None:
                arguments = (state, self.body, middle, np.array([size]))
                name = f"{self.steps_prefix}midpoint_step"
                (following,) = self.machine.evaluate(name, *arguments)
                q = named(following, self.state)["q"]
                q /= math.sqrt(float(q @ q))
                return following, size
            size /= 2.0
        return None, 0.0

    def _middle(self, state: Array, size: float) -> Array | None:
        """The middle velocities by Newton's method; None if it does not converge."""
        parts = named(state, self.state)
        middle, before = np.hstack([parts[name] for name in self.unknowns]), math.inf
        for _ in range(NEWTON_STEPS):
            residual, slope = self.machine.evaluate(
                f"{self.steps_prefix}midpoint_residual", state, self.body, middle, np.array([size])
            )
            try:
                change = np.linalg.solve(slope.reshape(len(middle), -1), residual)
            except np.linalg.LinAlgError:
                return None
            middle = middle - change
            moved = self._moved(state, middle, change, size)
            if moved is None:
                return None
            if moved <= self.tolerance and (moved >= before / 4.0 or moved == 0.0):
                return middle
            before = moved
        return None

    def _moved(self, state: Array, middle: Array, change: Array, size: float) -> float | None:
        """By how much Newton's method changed the turn, squared; None where it leads nowhere."""
        del state
        if not size * size * float(middle @ middle) <= LARGEST_TURN**2:  # NaN, too
            return None
        return size * size * float(change @ change)

    def _looked_at(self, state: Array) -> tuple[Ending, Array]:
        """What a slow state may do, and the state, perturbed if it has to be."""
        (energies,) = self.machine.evaluate(f"{self.prefix}energies", state, self.body)
        above = float(self.gaps @ (self.quaternions @ self._quaternion(state)) ** 2)
        above += float(named(energies, ENERGIES)["rotation"]) / 2.0
        worse = self.gaps[1:][self.gaps[1:] != 0.0]
        if len(worse) == 0:
            return Ending.AT_REST, state
        if not above < BASIN_SHARE * worse[0]:
            return self._perturbed(state)
        if not above < self.rules.rest_share * worse[0]:
            return Ending.OUT_OF_STEPS, state  # unless there are more
        return (Ending.CONVERGED if len(worse) == 3 else Ending.AT_REST), state

    def _perturbed(self, state: Array) -> tuple[Ending, Array]:
        hessian, torque = self.machine.evaluate(f"{self.prefix}curvature", state, self.body)
        values, vectors = np.linalg.eigh(hessian.reshape(3, 3))
        axis = vectors[:, 0]
        if values[0] >= 0.0:
            return Ending.OUT_OF_STEPS, state
        size = float(np.abs(hessian).max())
        if float(np.abs(torque).max()) > STALLED_TORQUE * size:
            return Ending.OUT_OF_STEPS, state
        along = float(axis @ torque)
        if abs(along) <= NO_TORQUE * size:
            along = float(axis[np.argmax(np.abs(axis))])
        half = math.copysign(self.perturbation / 2.0, along)
        self.perturbation = min(self.perturbation * PERTURBATION_GROWTH, LARGEST_PERTURBATION)
        turned = turned_by(state, self.state, math.cos(half), math.sin(half) * axis)
        return Ending.PERTURBED, turned

    def _quaternion(self, state: Array) -> Array:
        if self.integrator is Integrator.EULER:
            return quaternion_from_matrix(named(state, MATRIX_STATE)["R"])
        return named(state, QUATERNION_STATE)["q"]

    def _record(self, taken: int, time: float, state: Array) -> None:
        log = self.log
        if log is None or taken % log.stride:
            return
        if log.count == len(log.rows):
            kept = log.rows[::2].copy()
            log.rows[: len(kept)] = kept
            log.count, log.stride = len(kept), 2 * log.stride
            if taken % log.stride:
                return
        (energies,) = self.machine.evaluate(f"{self.prefix}energies", state, self.body)
        if self.integrator is not Integrator.MIDPOINT:
            time = taken * self.size
        log.rows[log.count] = np.concatenate([[time], state, energies])
        log.count += 1


class BreathingRun(BodyRun):
    """One body on its way, its scale a state; where that falls to 0 no step can be made."""

    names = steps_prefix = Kind.BREATHING.value
    unknowns = ("omega", "growth")
    tolerance = NEWTON_TOLERANCE
    halvings = 29  # a billionth of a step is short only on the way to the scale 0
    stuck = Ending.COLLAPSED

    def __init__(self, machine: Engine, batch: Batch, rules: Rules, log: Log | None) -> None:
        super().__init__(machine, batch, rules, log)
        self.least_scale = LEAST_SCALE * float(batch.states["scale"][0])
        self.rest_angle = 2.0 * math.asin(math.sqrt(rules.rest_share))

    def _moved(self, state: Array, middle: Array, change: Array, size: float) -> float | None:
        """By how much it changed turn and scale; None where that would fall to 0."""
        scale = float(named(state, self.state)["scale"]) + size * float(middle[3])
        turn = size * float(np.linalg.norm(middle[:3]))
        if not (turn <= LARGEST_TURN and scale > self.least_scale):  # NaN, too
            return None
        return size * float(np.linalg.norm(change[:3])) + size * abs(float(change[3])) / scale

    def _looked_at(self, state: Array) -> tuple[Ending, Array]:
        """What a slow state may do, and the state, perturbed if it has to be."""
        hessian, torque = self.machine.evaluate(f"{self.names}curvature", state, self.body)
        torque = float(named(state, BREATHING_STATE)["scale"]) * torque
        values, vectors = np.linalg.eigh(hessian.reshape(4, 4)[:3, :3])
        largest = float(np.abs(values).max())
        if float(np.abs(torque).max()) > STALLED_TORQUE * largest:
            return Ending.OUT_OF_STEPS, state
        if values[0] >= -FLAT * largest:
            firm = values > FLAT * largest
            off = np.linalg.norm((torque @ vectors)[firm] / values[firm])
            return (Ending.AT_REST if off <= self.rest_angle else Ending.OUT_OF_STEPS), state
        axis = vectors[:, 0] * math.copysign(1.0, float(vectors[:, 0] @ torque))
        half = self.perturbation / 2.0
        self.perturbation = min(self.perturbation * PERTURBATION_GROWTH, LARGEST_PERTURBATION)
        turned = turned_by(state, self.state, math.cos(half), math.sin(half) * axis)
        return Ending.PERTURBED, turned


RUNS = {Kind.RIGID: BodyRun, Kind.BREATHING: BreathingRun}  # general springs go by C alone


def run_in_python(machine: Engine, batch: Batch, rules: Rules, log: Log | None) -> None:
    """Integrate every body of a batch, one after another."""
    for k in range(len(batch.bodies)):
        RUNS[batch.kind](machine, batch.part(slice(k, k + 1)), rules, log).to_the_end()


def turned_by(state: Array, record: RecordType, cosine: float, sine: Array) -> Array:
    """The state with its body turned by the unit quaternion (cosine, sine), in the body frame."""
    turned = state.copy()
    parts = named(turned, record)
    if record == MATRIX_STATE:
        parts["R"] = parts["R"] @ np.array(rotation_matrix((cosine, *sine.tolist())))
        return turned
    w, *vector = parts["q"]
    v = np.array(vector)
    parts["q"] = [cosine * w - v @ sine, *(cosine * v + w * sine + np.cross(v, sine))]
    return turned
