"""Many registrations by simulation at once: instances side by side in the processor's lanes.

For Monte-Carlo studies. All in floating point: nothing here is exact or certified, but an end that
is called converged is slow *and* in the basin from which the flow ends at the optimum (as far as
doubles can tell; `certreg.certify` proves it of one problem).

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

from certreg.dynamics import SMALLEST_INERTIA
from certreg.errors import DegenerateProblemError, InvalidProblemError
from certreg.integration import integrate, step_parameters
from certreg.native.batch import Batch, Ending, Integrator
from certreg.settings import DEFAULT_DAMPING, SimulationSettings
from certreg.so3 import davenport_matrix, rotation_matrix

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

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
    positive. Raises InvalidProblemError for other shapes and what is not finite,
    DegenerateProblemError where a source is collinear: its dynamics is undefined.
    """
    x, y = _clouds(sources, "sources"), _clouds(targets, "targets")
    if x.shape[1] != y.shape[1]:
        message = f"sources have {x.shape[1]} points and targets {y.shape[1]}: they correspond"
        raise InvalidProblemError(message)
    w = np.ones(x.shape[1]) if weights is None else np.asarray(weights, dtype=float)
    w = (w / w.sum(axis=-1, keepdims=True)).reshape(-1, x.shape[1], 1)
    x_mean, y_mean = (w * x).sum(axis=1, keepdims=True), (w * y).sum(axis=1, keepdims=True)
    arm, goal = x - x_mean, y - y_mean
    cross = (w * goal).mT @ arm
    scatter = (w * arm).mT @ arm
    spread = np.trace(scatter, axis1=1, axis2=2) + (w * goal * goal).sum(axis=(1, 2))
    exponents = np.frexp(spread)[1].astype(np.int64) // 2
    unit = np.ldexp(1.0, -2 * exponents)
    count = len(unit)
    offsets = (x_mean - y_mean)[:, 0] * np.ldexp(1.0, -exponents)[:, np.newaxis]
    return Ensemble(
        bodies=_bodies(cross, scatter, spread, unit, damping),
        basins=_basins(cross * unit[:, np.newaxis, np.newaxis]),
        starts=np.hstack([offsets, np.tile([1.0] + [0.0] * 9, (count, 1))]),
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


def _clouds(given: ArrayLike, name: str) -> NDArray[np.float64]:
    array = np.asarray(given, dtype=float)
    array = array[np.newaxis] if array.ndim == 2 else array
    if array.ndim != 3 or array.shape[2] != 3 or not np.isfinite(array).all():
        message = f"{name} have the shape {array.shape}: give finite numbers, (count, N, 3)"
        raise InvalidProblemError(message)
    return array


def _bodies(
    cross: NDArray[np.float64],
    scatter: NDArray[np.float64],
    spread: NDArray[np.float64],
    unit: NDArray[np.float64],
    damping: float,
) -> NDArray[np.float64]:
    count, scale = len(unit), unit[:, np.newaxis, np.newaxis]
    traces = np.trace(scatter, axis1=1, axis2=2)[:, np.newaxis, np.newaxis]
    inertia = (traces * np.eye(3) - scatter) * scale
    flat = ~(np.linalg.eigvalsh(inertia)[:, 0] > SMALLEST_INERTIA)
    if flat.any():
        message = f"the source of instance {int(np.argmax(flat))} is collinear, or nearly so"
        raise DegenerateProblemError(message)
    upper = (slice(None), *np.triu_indices(3))
    inverse = np.asarray(np.linalg.inv(inertia), dtype=np.float64)
    rest = np.column_stack([spread * unit, np.full(count, damping)])
    return np.hstack([(cross * scale).reshape(count, 9), inertia[upper], inverse[upper], rest])


def _basins(cross: NDArray[np.float64]) -> NDArray[np.float64]:
    """Eigenvectors and deficits of the Davenport matrices of C / M, (count, 20)."""
    entries: Any = np.moveaxis(cross, 0, -1)  # arrays for numbers: only + and - are used
    davenport = np.moveaxis(np.array(davenport_matrix(entries)), -1, 0)
    values, vectors = np.linalg.eigh(davenport)
    deficits = (values[:, -1:] - values)[:, ::-1]
    deficits[deficits < TIE * deficits[:, -1:]] = 0.0
    return np.hstack([vectors[:, :, ::-1].mT.reshape(-1, 16), deficits])


def _stepped(starts: NDArray[np.float64], integrator: Integrator) -> NDArray[np.float64]:
    """The starts as the integrator keeps them: with a matrix if it has one."""
    if integrator is not Integrator.EULER:
        return starts
    turned = np.moveaxis(np.array(rotation_matrix(list(starts[:, 3:7].T))), -1, 0).reshape(-1, 9)
    return np.hstack([starts[:, :3], turned, starts[:, 7:]])
