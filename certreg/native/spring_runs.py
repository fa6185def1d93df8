"""One body on general springs where nothing is compiled: as spring_escape.c, spring_midpoint.c."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.native.layout import QUATERNION_STATE, SPRING_SAMPLE, named
from certreg.native.loops import (
    LARGEST_PERTURBATION,
    PERTURBATION_GROWTH,
    STALLED_TORQUE,
    Ending,
    Integrator,
)
from certreg.native.runs import BodyRun, eigenbasis, turned_by

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
    unknowns = ("v", "omega")

    def _sample(self) -> RecordType:
        return SPRING_SAMPLE

    def _looked_at(self, state: Array) -> tuple[Ending, Array]:
        """What a slow state may do, and the state, perturbed if it has to be."""
        hessian, force = self.machine.evaluate("certreg_spring_curvature", state, self.body)
        values, vectors = eigenbasis(hessian.reshape(6, 6), SWEEPS)
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
