"""Many registrations by simulation at once: instances side by side in the processor's lanes.

For Monte-Carlo studies. All in floating point: nothing here is exact or certified, but an end that
is called converged is slow *and* in the basin from which the flow ends at the optimum, *and* within
a thousandth of a radian of it (as far as doubles can tell; `certreg.certify` proves it of one
problem).

>>> import numpy as np
>>> rng = np.random.default_rng(0)
>>> source = rng.normal(size=(20, 3))
>>> targets = source + 0.01 * rng.normal(size=(1000, 20, 3))
>>> ends = simulate_many(ensemble(source, targets))
>>> bool(ends.converged.all()), ends.rotations.shape
(True, (1000, 3, 3))
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.dynamics.body import SMALLEST_BARRIER, SMALLEST_INERTIA
from certreg.dynamics.integrators import integrate, step_parameters
from certreg.equilibrium import clouds, rest_poses
from certreg.errors import DegenerateProblemError
from certreg.geometry import rotation_matrix
from certreg.native import Batch, Ending, Integrator
from certreg.problem import DEFAULT_DAMPING, checked_damping
from certreg.settings import SimulationSettings

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from certreg.native import RestPoses

TIE = 1e-13  # of l1 - l4: doubles do not tell such eigenvalues apart


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ensemble:
    """Bodies to be simulated: what the dynamics knows of each, per unit of mass.

    bodies: (count, 23) and basins: (count, 20), as `certreg.native.batch` describes them.
    starts: (count, 13), c, q = (w, x, y, z), v, omega. Lengths over 2^length_exponents (count,).
    """

    bodies: NDArray[np.float64]
    basins: NDArray[np.float64]
    starts: NDArray[np.float64]
    length_exponents: NDArray[np.int64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ends:
    """Where the bodies of an ensemble ended, and how.

    status: (count,), of `certreg.native.batch.Ending`; steps, escapes: (count,) integers; times:
    (count,), of the springs. states: (count, 18) for Euler, else (count, 13), as they were stepped.
    """

    integrator: Integrator
    status: NDArray[np.int32]
    steps: NDArray[np.int64]
    escapes: NDArray[np.int32]
    times: NDArray[np.float64]
    states: NDArray[np.float64]

    @property
    def converged(self) -> NDArray[np.bool_]:
        """Whether each came to rest at the optimum, or at one of the optima, (count,)."""
        return (self.status == Ending.CONVERGED) | (self.status == Ending.AT_REST)

    @property
    def rotations(self) -> NDArray[np.float64]:
        """The rotations at the ends, (count, 3, 3), body to world: target from source."""
        if self.integrator is Integrator.EULER:
            return self.states[:, 3:12].reshape(-1, 3, 3)
        return np.moveaxis(np.array(rotation_matrix(list(self.states[:, 3:7].T))), -1, 0)


def ensemble(
    sources: ArrayLike,
    targets: ArrayLike,
    *,
    weights: ArrayLike | None = None,
    damping: float = DEFAULT_DAMPING,
) -> Ensemble:
    """The bodies of many problems, each released at rest where its source is.

    sources, targets: (count, N, 3), or (N, 3) for the same in all; weights: (count, N) or (N,),
    not negative; damping: mu > 0. Raises InvalidProblemError for others and what is not finite,
    DegenerateProblemError where a source is collinear: its dynamics is undefined, or where its
    springs are too weak for doubles.
    """
    damping = checked_damping(damping)
    found = rest_poses(clouds(sources, targets, weights))
    exponents = _length_exponents(found)
    units = found.exponents - exponents[:, np.newaxis]
    unit = np.ldexp(1.0, units.sum(axis=1))[:, np.newaxis]  # of C and K
    offsets = found.means[:, :3] - found.means[:, 3:]
    count = len(offsets)
    return Ensemble(
        bodies=np.hstack(
            [found.cross * unit, _inertias(found, units), np.full((count, 1), damping)]
        ),
        basins=_basins(found.vectors, found.values, unit),
        starts=np.hstack(
            [
                np.ldexp(offsets, -exponents[:, np.newaxis]),
                np.tile([1.0] + [0.0] * 9, (count, 1)),
            ]
        ),
        length_exponents=exponents,
    )


def simulate_many(
    bodies: Ensemble,
    integrator: Integrator = Integrator.SPLITTING,
    *,
    settings: SimulationSettings | None = None,
) -> Ends:
    """Every body of an ensemble simulated to its end, on `settings.threads` threads.

    The interpreter's lock is free meanwhile. Raises DegenerateProblemError where a body is too
    stiff for explicit Euler.
    """
    settings = settings or SimulationSettings()
    batch = Batch.of(
        integrator,
        bodies=bodies.bodies,
        basins=bodies.basins,
        steps=step_parameters(integrator, bodies.bodies, bodies.basins, settings),
        states=_stepped(bodies.starts, integrator),
    )
    integrate(batch, settings)
    return Ends(
        integrator=integrator,
        status=batch.status,
        steps=batch.taken,
        escapes=batch.escapes,
        times=batch.times,
        states=batch.states,
    )


def _length_exponents(found: RestPoses) -> NDArray[np.int64]:
    """Of the power of two next to the root-mean-square radius of both clouds, (count,)."""
    largest = found.exponents.max(axis=1)
    spread = _spreads(found, found.exponents - largest[:, np.newaxis])
    return largest + np.frexp(spread)[1].astype(np.int64) // 2


def _spreads(found: RestPoses, units: NDArray[np.integer[Any]]) -> NDArray[np.float64]:
    """The mean squares of both clouds about their means, (count,), in units of 2^units each."""
    source = found.scatter[:, [0, 3, 5]].sum(axis=1)
    return np.ldexp(source, 2 * units[:, 0]) + np.ldexp(found.spreads[:, 2], 2 * units[:, 1])


def _inertias(found: RestPoses, units: NDArray[np.integer[Any]]) -> NDArray[np.float64]:
    """The upper triangles of J and of its inverse, and the spread, (count, 13)."""
    a, b, c, d, e, f = np.ldexp(found.scatter, 2 * units[:, :1]).T
    upper = np.column_stack([d + f, -b, -c, a + f, -e, a + d])
    inertia = upper[:, [0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(-1, 3, 3)
    flat = ~(np.linalg.eigvalsh(inertia)[:, 0] > SMALLEST_INERTIA)
    if flat.any():
        message = f"the source of instance {int(np.argmax(flat))} is collinear, or nearly so"
        raise DegenerateProblemError(message)
    inverse = np.asarray(np.linalg.inv(inertia), dtype=np.float64)
    return np.column_stack(
        [upper, inverse[(slice(None), *np.triu_indices(3))], _spreads(found, units)]
    )


def _basins(
    vectors: NDArray[np.float64], values: NDArray[np.float64], unit: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Eigenvectors and deficits of the Davenport matrices of C / M, (count, 20)."""
    differences = values[:, :1] - values
    differences[differences < TIE * differences[:, -1:]] = 0.0
    deficits = differences * unit
    lost = ((differences > 0.0) & (deficits < SMALLEST_BARRIER)).any(axis=1)
    if lost.any():
        where = f"the clouds of instance {int(np.argmax(lost))}"
        message = f"{where} differ too much in size for double precision: bring both to one unit"
        raise DegenerateProblemError(message)
    return np.hstack([vectors.reshape(-1, 16), deficits])


def _stepped(starts: NDArray[np.float64], integrator: Integrator) -> NDArray[np.float64]:
    """The starts as the integrator keeps them: with a matrix if it has one."""
    if integrator is not Integrator.EULER:
        return starts
    turned = np.moveaxis(np.array(rotation_matrix(list(starts[:, 3:7].T))), -1, 0).reshape(-1, 9)
    return np.hstack([starts[:, :3], turned, starts[:, 7:]])
