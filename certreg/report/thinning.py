"""Simulated motions thinned for display: the registration itself, and an escape from each saddle.

Poses and energies are sent to the page, never points. A module beside the viewer,
which alone uses it: numbers and no markup.
"""

from __future__ import annotations

import base64
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.dynamics.integrators import SimulationSettings
from certreg.dynamics.simulation import simulate
from certreg.dynamics.states import state_at_rest
from certreg.errors import DegenerateProblemError
from certreg.geometry.so3 import quaternions_from_matrices, rotation_matrix
from certreg.native.layout import MATRIX_STATE, named

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.dynamics.trajectory import Trajectory
    from certreg.registration.linear import LinearSolution


FRAMES = 240  # of a motion; the page interpolates between them
VISIBLE_ENERGY = 1e-8  # of what a run loses: 1e-4 of the first displacement
PUSH = 0.02  # radians off a saddle: hardly seen, and soon on its way
UNSPENT = 0.01  # of its energy above the optimum: a tenth of the way, still to go
ESCAPE_STEPS = 20_000  # of explicit Euler; some five hundred are usual


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Run:
    """A motion of the body, released at rest.

    start: the component that it was pushed off; None: released where the source was given.
    times (F,), in the time unit of the springs; quaternions (F, 4); offsets (F, 3), of the source's
    centroid from the target's, over 2^length_exponent; potential, kinetic (F,), per unit of mass,
    over 4^length_exponent. last: when the simulation ended, seen or not; end: its last quaternion.
    converged: whether it was slow enough to be at rest; left: the share of its energy above the
    optimum that it then still had; escapes: how often it was kicked off a saddle.
    """

    start: int | None
    times: NDArray[np.float64]
    quaternions: NDArray[np.float64]
    offsets: NDArray[np.float64]
    potential: NDArray[np.float64]
    kinetic: NDArray[np.float64]
    length_exponent: int
    last: float
    end: NDArray[np.float64]
    converged: bool
    left: float
    escapes: int

    @property
    def fields(self) -> dict[str, Any]:
        """What the page reads: each array as base64 of little-endian floats of 32 bits."""
        arrays = ("times", "quaternions", "offsets", "potential", "kinetic")
        return {
            "start": self.start,
            "length_exponent": self.length_exponent,
            "last": self.last,
            **{name: _packed(getattr(self, name)) for name in arrays},
        }


def thinned(trajectory: Trajectory, start: int | None = None) -> Run:
    """The part of a trajectory in which something is seen to move, in evenly spaced frames."""
    times, energy = trajectory.times, trajectory.potential + trajectory.kinetic
    above = energy - energy[-1]
    moving = np.flatnonzero(above > VISIBLE_ENERGY * above[0])
    end = min(len(times) - 1, int(moving[-1]) + 1 if len(moving) else len(times) - 1)
    wanted: NDArray[np.float64] = np.arange(FRAMES) / (FRAMES - 1)
    wanted = times[0] + wanted * (times[end] - times[0])
    rows = np.unique(np.searchsorted(times, wanted).clip(0, end))
    states = named(trajectory.states[rows], MATRIX_STATE)
    return Run(
        start=start,
        times=times[rows],
        quaternions=quaternions_from_matrices(states["R"]),
        offsets=states["c"],
        potential=trajectory.potential[rows],
        kinetic=trajectory.kinetic[rows],
        length_exponent=trajectory.length_exponent,
        last=float(times[-1]),
        end=trajectory.quaternion,
        converged=trajectory.converged,
        left=trajectory.energy_left or 0.0,
        escapes=trajectory.escapes,
    )


def shown_motion(solution: LinearSolution, trajectory: Trajectory) -> Run:
    """The motion of a registration as it is shown.

    A cross-check in a few large steps is shown as explicit Euler's small ones, where these end at
    rest, too: the same body, released at the same place under the same damping.
    """
    if len(trajectory.times) >= FRAMES:
        return thinned(trajectory)
    limits = SimulationSettings(max_steps=ESCAPE_STEPS)
    try:
        fine = simulate(solution.objective, solution.problem.damping, settings=limits)
    except DegenerateProblemError:
        return thinned(trajectory)
    return thinned(fine if fine.converged else trajectory)


def simulated_escapes(solution: LinearSolution, damping: float) -> list[Run]:
    """From each component that is not optimal, a run that begins a small turn off it.

    The turn is about the axis along which the energy falls fastest. Empty where the dynamics is not
    defined, or too stiff to be simulated.
    """
    components = solution.equilibria.components
    try:
        return [
            _escape(solution, damping, index, witness)
            for index, component in enumerate(components)
            if (witness := component.witness) is not None
        ]
    except DegenerateProblemError:
        return []


def _escape(solution: LinearSolution, damping: float, index: int, axis: NDArray[np.float64]) -> Run:
    component, half = solution.equilibria.components[index], PUSH / 2.0
    turn = np.array([np.cos(half), *(np.sin(half) * axis)])
    pushed = component.rotation @ np.array(rotation_matrix(turn.tolist()))
    start, limits = state_at_rest(pushed), SimulationSettings(max_steps=ESCAPE_STEPS)
    return thinned(simulate(solution.objective, damping, start=start, settings=limits), index)


def left_words(left: float) -> str:
    """What a body that is slow has still to lose; left: its share, as in `Run`.

    >>> left_words(0.25)
    'with 25 % of its energy above the optimum left'
    """
    percent = "over 99.9" if left > 0.999 else f"{100.0 * left:.3g}"
    return f"with {percent} % of its energy above the optimum left"


def unspent_words(trajectory: Trajectory) -> str | None:
    """That a body is slow before it has come down to the optimum; None where it has, or is not."""
    left = trajectory.energy_left
    if left is None or not trajectory.converged or left <= UNSPENT:
        return None
    return f"slower than the tolerance, {left_words(left)}"


def kicked_words(escapes: int) -> str:
    """That a body did not find its way alone."""
    if not escapes:
        return ""
    return f" (kicked off a saddle {'once' if escapes == 1 else f'{escapes} times'})"


def _packed(values: NDArray[np.float64]) -> str:
    limit = float(np.finfo(np.float32).max)
    floats = np.ascontiguousarray(values.clip(-limit, limit), dtype="<f4")
    return base64.b64encode(floats.tobytes()).decode("ascii")
