"""The engine without compiled code, for all bodies: what the loops in C are held against."""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from reference_stationary import stationary_poses

from certreg.native.engine import Evaluator, calls_of
from certreg.native.kernels import GENERATED
from certreg.native.layout import BODY, QUATERNION_STATE, named, plain
from certreg.native.loops import (
    LARGEST_PERTURBATION,
    LARGEST_TURN,
    PERTURBATION_GROWTH,
    STALLED_TORQUE,
    Ending,
    Kind,
)
from certreg.native.runs import FLAT, Array, BodyRun, turned_by

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.native.loops import Batch, Log, Rules
    from certreg.native.stationary import ManyClouds, StationaryPoses
    from certreg.native.tape import Tape

SPRING_SWEEPS = 16  # of six rows
NO_PULL = 1e-12  # of the largest curvature: less is rounding, and must not choose a side


def eigenbasis(matrix: Array, sweeps: int) -> tuple[Array, Array]:
    """Eigenvalues of a symmetric matrix and unit eigenvectors, columns.

    By Jacobi's rotations as in jacobi.h: another method could take the other side of a saddle.
    """
    n = len(matrix)
    a, v = matrix.copy(), np.eye(n)
    pairs = [(p, q) for p in range(n - 1) for q in range(p + 1, n)]
    for p, q in pairs * sweeps:
        if a[p, q] == 0.0:
            continue
        theta = float(a[q, q] - a[p, p]) / (2.0 * float(a[p, q]))
        t = (-1.0 if theta < 0.0 else 1.0) / (abs(theta) + math.sqrt(theta * theta + 1.0))
        cosine = 1.0 / math.sqrt(t * t + 1.0)
        turn = np.array([[cosine, t * cosine], [-t * cosine, cosine]])
        a[:, [p, q]] = a[:, [p, q]] @ turn
        a[[p, q]] = turn.T @ a[[p, q]]
        v[:, [p, q]] = v[:, [p, q]] @ turn
    return np.diag(a).copy(), v


class SpringRun(BodyRun):
    """One body on its way, on general springs."""

    names = steps_prefix = Kind.SPRINGS.value
    unknowns = ("v", "omega")

    def _moved(self, state: Array, middle: Array, change: Array, size: float) -> float | None:
        del state
        turn = float(middle[3:] @ middle[3:])
        if not np.isfinite(middle).all() or size * size * turn > LARGEST_TURN**2:
            return None
        moved = float(change[3:] @ change[3:])
        moved += float(change[:3] @ change[:3]) / (1.0 + float(middle[:3] @ middle[:3]))
        return size * size * moved

    def _looked_at(self, state: Array) -> tuple[Ending, Array]:
        """What a slow state may do, and the state, perturbed if it has to be."""
        hessian, force = self.machine.evaluate(f"{self.names}curvature", state, self.body)
        values, vectors = eigenbasis(hessian.reshape(6, 6), SPRING_SWEEPS)
        largest = float(np.abs(values).max())
        pulls = force @ vectors
        least = int(np.argmin(values))
        if values[least] < -FLAT * largest:
            if (np.abs(pulls) > STALLED_TORQUE * largest).any():
                return Ending.OUT_OF_STEPS, state
            return self._off(state, vectors[:, least], float(pulls[least]), NO_PULL * largest)
        firm = values > FLAT * largest
        distance = float(((pulls[firm] / values[firm]) ** 2).sum())
        resting = distance <= 4.0 * self.rules.rest_share
        return Ending.AT_REST if resting else Ending.OUT_OF_STEPS, state

    def _off(self, state: Array, along: Array, pull: float, none: float) -> tuple[Ending, Array]:
        """Off a saddle along the direction of lowest curvature, downhill."""
        side = pull if abs(pull) > none else float(along[np.argmax(np.abs(along))])
        amount = math.copysign(self.perturbation, side)
        self.perturbation = min(self.perturbation * PERTURBATION_GROWTH, LARGEST_PERTURBATION)
        moved = state.copy()
        named(moved, QUATERNION_STATE)["c"] += amount * along[:3]
        angle = float(np.linalg.norm(along[3:]))
        if angle > 0.0:
            sine = math.sin(amount * angle / 2.0) * along[3:] / angle
            cosine = math.cos(amount * angle / 2.0)
            moved = turned_by(moved, self.state, cosine, sine)
        return Ending.PERTURBED, moved


def of_arrays(tape: Tape, arguments: Sequence[Array]) -> tuple[Array, ...]:
    """The results for arguments (size, ...), as (size, ...) each."""
    several = np.shape(arguments[0])[1:]
    with np.errstate(all="ignore"):
        results = tape.run(arguments)
    return tuple(np.array([np.broadcast_to(x, several) for x in result]) for result in results)


class Reference(Evaluator):
    """The tapes of all generated functions, and a run on general springs."""

    def stationary_poses(self, clouds: ManyClouds) -> StationaryPoses:
        """What doubles say of the stationary poses of many problems."""
        return stationary_poses(clouds, self._hessians)

    def _hessians(self, quaternions: Array, cross: Array) -> Array:
        """The generated Hessian at unit quaternions (count, 4), of C (count, 9): (count, 3, 3)."""
        states = np.zeros(len(quaternions), dtype=QUATERNION_STATE)
        bodies = np.zeros(len(quaternions), dtype=BODY)
        states["q"], bodies["cross"] = quaternions, cross.reshape(-1, 3, 3)
        arguments = plain(states).T, plain(bodies).T
        hessians, _ = of_arrays(self.calls["certreg_quaternion_curvature"].tape, arguments)
        return hessians.T.reshape(-1, 3, 3)

    def run(self, batch: Batch, rules: Rules, log: Log | None = None) -> None:
        """Integrate every body of a batch, one after another."""
        if batch.kind is not Kind.SPRINGS:
            super().run(batch, rules, log)
            return
        for k in range(len(batch.bodies)):
            SpringRun(self, batch.part(slice(k, k + 1)), rules, log).to_the_end()


@cache
def reference() -> Reference:
    """The engine of this process."""
    kinds = ("", "breathing_", "spring_")
    return Reference(calls_of(*(GENERATED / f"{kind}dynamics.c" for kind in kinds)))
