"""Many bodies on general springs, simulated side by side in the processor's lanes.

Each is the body that `certreg.simulate` moves, made of exact sums, with the step that it takes
there; only the runs are many at a time. A body at rest is in a valley of its energy: which one, and
whether the optimum, does not follow.

>>> import numpy as np
>>> rng = np.random.default_rng(0)
>>> source, normals = rng.normal(size=(2, 20, 3))
>>> targets = source + 0.01 * rng.normal(size=(10, 20, 3))
>>> ends = simulate_on_springs(bodies_on_springs(source, targets, normals=normals))
>>> bool(ends.at_rest.all()), ends.rotations.shape
(True, (10, 3, 3))
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.dynamics.body import steps_of
from certreg.dynamics.ends import ManyEnds, run_all
from certreg.dynamics.integrators import SimulationSettings
from certreg.dynamics.springs import body_on_springs
from certreg.equilibrium import many_springs
from certreg.errors import DegenerateProblemError
from certreg.native import QUATERNION_STATE, Batch, Ending, Integrator
from certreg.objective import Springs
from certreg.problem import DEFAULT_DAMPING, checked_damping, spring_moments
from certreg.results import Brief

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from certreg.dynamics.springs import SpringBody
    from certreg.native import Records

PORTION = 1024  # bodies, after which somebody is told: full lanes


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SpringBodies(Brief):
    """Bodies on general springs, to be simulated.

    bodies: what the dynamics knows of each. starts: (count,) records c, q = (w, x, y, z), v, omega,
    lengths over 2^length_exponent of the body, c from its origin.
    """

    bodies: tuple[SpringBody, ...]
    starts: Records


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SpringEnds(ManyEnds):
    """Where bodies on general springs ended, and how.

    status: (count,), 0 out of steps, 2 at rest, in whichever valley; steps, escapes: (count,)
    integers; times: (count,), of the springs. states: (count,) records as in `SpringBodies`.
    """

    bodies: SpringBodies

    @property
    def at_rest(self) -> NDArray[np.bool_]:
        """Whether each came to rest, (count,): at the optimum or at another equilibrium."""
        return self.status == Ending.AT_REST

    @property
    def translations(self) -> NDArray[np.float64]:
        """The translations at the ends, (count, 3), in the user's unit."""
        bodies = self.bodies.bodies
        exponents = np.array([body.length_exponent for body in bodies])[:, np.newaxis]
        origins = np.array([[float(c) for c in body.origin] for body in bodies])
        centres = np.array([[float(c) for c in body.centre] for body in bodies])
        moved = (self.rotations @ centres[..., np.newaxis])[..., 0]
        return origins + np.ldexp(self.states["c"], exponents) - moved


def bodies_on_springs(  # noqa: PLR0913 - each is one question, and has its usual answer
    sources: ArrayLike,
    targets: ArrayLike,
    *,
    normals: ArrayLike | None = None,
    directions: ArrayLike | None = None,
    covariances: ArrayLike | None = None,
    information: ArrayLike | None = None,
    factors: ArrayLike | None = None,
    sigma: ArrayLike | None = None,
    weights: ArrayLike | None = None,
    damping: float = DEFAULT_DAMPING,
) -> SpringBodies:
    """The bodies of many problems of general springs, each released at rest where its source is.

    Parameters
    ----------
    sources, targets
        (count, N, 3), or (N, 3) for the same in all.
    normals, directions, covariances, information, factors, sigma, weights
        As in `solve_many_springs`.
    damping
        mu > 0.

    Returns
    -------
    SpringBodies
        For `simulate_many`.

    Raises
    ------
    InvalidProblemError
        For others and what is not finite.
    DegenerateProblemError
        Where a source is collinear: its dynamics is undefined. Both name the instance.
    """
    damping = checked_damping(damping)
    given = many_springs(
        sources,
        targets,
        normals=normals,
        directions=directions,
        covariances=covariances,
        information=information,
        factors=factors,
        sigma=sigma,
        weights=weights,
    )
    bodies: list[SpringBody] = []
    for k in range(given.count):
        try:
            bodies.append(body_on_springs(Springs(spring_moments(given.problem(k))), damping))
        except DegenerateProblemError as error:
            message = f"instance {k}: {error}"
            raise DegenerateProblemError(
                message, instance=k, rank=error.rank, value=error.value, limit=error.limit
            ) from error
    starts = np.zeros(len(bodies), dtype=QUATERNION_STATE)
    for k, body in enumerate(bodies):
        starts[k] = body.start
    return SpringBodies(bodies=tuple(bodies), starts=starts)


def simulate_on_springs(
    bodies: SpringBodies,
    integrator: Integrator | str = Integrator.SPLITTING,
    *,
    settings: SimulationSettings | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> SpringEnds:
    """Every body simulated to its end, as `simulate_many` says. Raises ValueError for Euler."""
    integrator, settings = Integrator(integrator), settings or SimulationSettings()
    batch = Batch.of(
        integrator,
        bodies=np.array([body.record for body in bodies.bodies]),
        steps=steps_of(integrator, bodies.bodies, bodies.starts, settings),
        states=bodies.starts,
    )
    run_all(batch, settings, PORTION, progress)
    return SpringEnds.of(batch, bodies=bodies)
