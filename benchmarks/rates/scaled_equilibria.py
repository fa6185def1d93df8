"""The breathing body's equilibria, counted and indexed exactly, beside its linearised motion.

    make rates NAME=scaled_equilibria ARGS="[INSTANCES]"

Random problems of many shapes: generic, noisy up to no resemblance, mirrored, planar, weighted, of
scales over four decades. The number of equilibria with s > 0 is proved from the signs of the
characteristic polynomial; beside it stand the eigenvalues of K in doubles. At each equilibrium, the
inside-out ones too, the motion is linearised (14 x 14, generated): as many eigenvalues with a
positive real part as the index, and no force.
"""

from __future__ import annotations

import sys
from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial.transform import Rotation

from certreg.dynamics.states import state_of
from certreg.dynamics.valleys import breathing_body
from certreg.equilibrium.breathing import BreathingEquilibrium, breathing_equilibria
from certreg.equilibrium.equilibrium_set import unit_double
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem

if TYPE_CHECKING:
    from certreg.dynamics.valleys import BreathingBody

INSTANCES = 5_000
AT_REST = 1e-9  # |s'| at an equilibrium, in units near the clouds' sizes


@dataclass(slots=True)
class Tally:
    """How many instances have so many equilibria with s > 0; what came out otherwise."""

    counts: Counter[int] = field(default_factory=Counter[int])
    equilibria: int = 0
    miscounted: int = 0
    misindexed: int = 0
    moving: int = 0


def random_problem(seed: int) -> RegistrationProblem:
    """One of the instances."""
    rng = np.random.default_rng([21, seed])
    n = int(rng.integers(4, 30))
    x = rng.normal(size=(n, 3)) * np.exp(rng.uniform(0.0, 1.0) * rng.normal(size=3))
    if seed % 5 == 1:
        x[:, 2] = 0.0
    turned = Rotation.from_quat(rng.normal(size=4)).apply(x)
    if seed % 5 == 2:
        turned = turned * [1.0, 1.0, -1.0]
    noise = 3.0 * rng.uniform(0.0, 1.0) ** 2 * float(np.abs(x).mean())
    scale = 10.0 ** rng.uniform(-2.0, 2.0)
    y = scale * (turned + noise * rng.normal(size=(n, 3))) + rng.normal(size=3)
    weights = 10.0 ** rng.uniform(-2.0, 2.0, size=n) if seed % 5 == 3 else np.ones(n)
    return RegistrationProblem(x, y, weights=weights)


def counted(instances: int) -> Tally:
    """Over that many instances."""
    tally = Tally()
    for seed in range(instances):
        objective = Isotropic(exact_moments(random_problem(seed)))
        found = breathing_equilibria(objective)
        values = np.linalg.eigvalsh(np.array(objective.davenport, dtype=float))
        tally.miscounted += int((values > 0.0).sum()) != found.count
        tally.counts[found.signs.positive] += 1
        moving = breathing_body(objective.moments, 1.3)
        for each in (*found.upright, *found.inside_out):
            _look_at(moving, objective, each, tally)
    return tally


def _look_at(
    moving: BreathingBody, objective: Isotropic, found: BreathingEquilibrium, tally: Tally
) -> None:
    scale = (found.scale or 0.0) / moving.unit_of_scale
    state = state_of(unit_double(objective.quaternions[found.component]), scale=scale)
    unstable = int((np.linalg.eigvals(moving.jacobian(state)).real > 0.0).sum())
    tally.equilibria += 1
    tally.misindexed += unstable != found.morse_index
    # the acceleration of the rotation is the torque over s^2 J
    stiffness = np.linalg.cond(moving.inertia) / min(1.0, abs(scale))
    tally.moving += moving.squared_speed(state) > (AT_REST * stiffness) ** 2


def main() -> int:
    """Count, print, and whether all is well."""
    instances = int(sys.argv[1]) if sys.argv[1:] else INSTANCES
    found = counted(instances)
    by_count = ", ".join(f"{found.counts[k]} with {k}" for k in sorted(found.counts))
    sys.stdout.write(
        f"{instances} problems with a free scale: {by_count}; {found.miscounted} miscounted. "
        f"{found.equilibria} equilibria, inside out too: {found.misindexed} with another number of "
        f"unstable eigenvalues than the proved index, {found.moving} not at rest\n"
    )
    wrong = found.miscounted + found.misindexed + found.moving
    return 1 if wrong or set(found.counts) != {1, 2, 3} else 0


if __name__ == "__main__":
    sys.exit(main())
