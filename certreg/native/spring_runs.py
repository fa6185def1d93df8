"""One body on general springs where nothing is compiled: as spring_escape.c, spring_midpoint.c."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.native.layout import QUATERNION_STATE, SPRING_SAMPLE, named
from certreg.native.loops import (
    LARGEST_PERTURBATION,
    LARGEST_TURN,
    NEWTON_STEPS,
    NEWTON_TOLERANCE,
    PERTURBATION_GROWTH,
    STALLED_TORQUE,
    Ending,
    Integrator,
)
from certreg.native.runs import BodyRun, turned_by

if TYPE_CHECKING:
    from certreg.native.layout import RecordType

Array = Any  # NDArray[np.float64]
FLAT = 1e-9  # of the largest curvature: less is none, as along a shift that no spring resists
NO_PULL = 1e-12  # of the largest curvature: less is rounding, and must not choose a side
SWEEPS = 16


class SpringRun(BodyRun):
    """One body on its way, on general springs."""

    names = "certreg_spring_"
    steps_prefix = "certreg_spring_"

    def _sample(self) -> RecordType:
        return SPRING_SAMPLE

    def _middle(self, state: Array, size: float) -> Array | None:
        """The middle velocities by Newton's method; None if it does not converge."""
        parts = named(state, QUATERNION_STATE)
        middle, before = np.concatenate([parts["v"], parts["omega"]]), math.inf
        for _ in range(NEWTON_STEPS):
            residual, slope = self.machine.evaluate(
                "certreg_spring_midpoint_residual", state, self.body, middle, np.array([size])
            )
            try:
                change = np.linalg.solve(slope.reshape(6, 6), residual)
            except np.linalg.LinAlgError:
                return None
            middle = middle - change
            turn = float(middle[3:] @ middle[3:])
            if not np.isfinite(middle).all() or size * size * turn > LARGEST_TURN**2:
                return None
            moved = float(change[3:] @ change[3:])
            moved += float(change[:3] @ change[:3]) / (1.0 + float(middle[:3] @ middle[:3]))
            small = size * size * moved <= NEWTON_TOLERANCE**2
            if small and (moved >= before / 4.0 or moved == 0.0):
                return middle
            before = moved
        return None

    def _looked_at(self, state: Array) -> tuple[Ending, Array]:
        """What a slow state may do, and the state, perturbed if it has to be."""
        hessian, force = self.machine.evaluate("certreg_spring_curvature", state, self.body)
        values, vectors = eigenbasis(hessian.reshape(6, 6))
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
            moved = turned_by(moved, Integrator.MIDPOINT, cosine, sine)
        return Ending.PERTURBED, moved


def eigenbasis(matrix: Array) -> tuple[Array, Array]:
    """Eigenvalues of a symmetric (6, 6) matrix and unit eigenvectors, columns.

    By Jacobi's rotations as in spring_escape.c: another method could take the other side of a
    saddle.
    """
    a, v = matrix.copy(), np.eye(6)
    pairs = [(p, q) for p in range(5) for q in range(p + 1, 6)]
    for p, q in pairs * SWEEPS:
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
