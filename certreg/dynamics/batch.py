"""Many registrations by simulation at once: bodies side by side in the processor's lanes.

For Monte-Carlo studies. All in floating point: nothing here is exact or certified, but an end that
is called converged is slow *and* in the basin from which the flow ends at the optimum, *and* within
a thousandth of a radian of it (as far as doubles can tell; `certreg.certify` proves it of one
problem).

>>> import numpy as np
>>> rng = np.random.default_rng(0)
>>> source = rng.normal(size=(20, 3))
>>> targets = source + 0.01 * rng.normal(size=(1000, 20, 3))
>>> ends = simulate_many(bodies_of(source, targets))
>>> bool(ends.converged.all()), ends.rotations.shape
(True, (1000, 3, 3))
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from certreg.dynamics.basin import basins_of
from certreg.dynamics.body import SMALLEST_INERTIA
from certreg.dynamics.ends import ManyEnds, run_all
from certreg.dynamics.integrators import SimulationSettings, step_parameters
from certreg.dynamics.spring_batch import SpringBodies, simulate_on_springs
from certreg.equilibrium import clouds, stationary_poses
from certreg.errors import DegenerateProblemError
from certreg.geometry import rotation_matrices
from certreg.native import (
    BODY,
    MATRIX_STATE,
    QUATERNION_STATE,
    Batch,
    Ending,
    Integrator,
    symmetric,
)
from certreg.problem import DEFAULT_DAMPING, checked_damping
from certreg.results import Brief

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from certreg.dynamics.spring_batch import SpringEnds
    from certreg.native import Records, StationaryPoses

DIAGONAL = [0, 3, 5]  # of an upper triangle
PORTION = 8192  # bodies, after which somebody is told: a tenth of a second, and full lanes


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Bodies(Brief):
    """Bodies to be simulated: what the dynamics knows of each, per unit of mass.

    Lengths are over 2^length_exponents, (count,). The others are (count,) records with these parts:
    records: cross, C row by row; inertia and inertia_inverse, upper triangles of J and of its
        inverse (11 12 13 22 23 33); spread of both clouds; damping.
    basins: quaternions, (4, 4), of the equilibria by descending eigenvalue of the Davenport matrix;
        gaps, (4,), of the eigenvalues to the largest.
    starts: c, the centres of mass apart; q = (w, x, y, z); v; omega.
    """

    records: Records
    basins: Records
    starts: Records
    length_exponents: NDArray[np.int64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ends(ManyEnds):
    """Where the bodies ended, and how.

    status: (count,), 0 out of steps, 1 converged, 2 at rest at one of several optima; steps,
    escapes: (count,) integers; times: (count,), of the springs. states: (count,) records with the
    parts c, R for Euler, else q, v and omega, lengths as in `Bodies`.
    """

    @property
    def converged(self) -> NDArray[np.bool_]:
        """Whether each came to rest at the optimum, or at one of the optima, (count,)."""
        return (self.status == Ending.CONVERGED) | (self.status == Ending.AT_REST)


def bodies_of(
    sources: ArrayLike,
    targets: ArrayLike,
    *,
    weights: ArrayLike | None = None,
    damping: float = DEFAULT_DAMPING,
) -> Bodies:
    """The bodies of many problems, each released at rest where its source is.

    Parameters
    ----------
    sources, targets
        (count, N, 3), or (N, 3) for the same in all.
    weights
        (count, N) or (N,), not negative.
    damping
        mu > 0.

    Returns
    -------
    Bodies
        For `simulate_many`.

    Raises
    ------
    InvalidProblemError
        For others and what is not finite.
    DegenerateProblemError
        Where a source is collinear: its dynamics is undefined, or where its springs are too weak
        for doubles.
    """
    damping = checked_damping(damping)
    poses = stationary_poses(clouds(sources, targets, weights))
    exponents = _length_exponents(poses)
    units = poses.exponents - exponents[:, np.newaxis]
    unit = np.ldexp(1.0, units.sum(axis=1))[:, np.newaxis]  # of C and K
    records = np.empty(len(unit), dtype=BODY)
    records["cross"] = (poses.cross * unit).reshape(-1, 3, 3)
    records["inertia"] = _inertias(poses, units)
    records["inertia_inverse"] = _inverses(records["inertia"])
    records["spread"], records["damping"] = _spreads(poses, units), damping
    starts = np.zeros(len(unit), dtype=QUATERNION_STATE)
    offsets = poses.means["source"] - poses.means["target"]
    starts["c"] = np.ldexp(offsets, -exponents[:, np.newaxis])
    starts["q"] = (1.0, 0.0, 0.0, 0.0)
    return Bodies(
        records=records,
        basins=basins_of(poses.vectors, poses.values, unit),
        starts=starts,
        length_exponents=exponents,
    )


@overload
def simulate_many(
    bodies: Bodies,
    integrator: Integrator | str = ...,
    *,
    settings: SimulationSettings | None = ...,
    progress: Callable[[int, int], object] | None = ...,
) -> Ends: ...


@overload
def simulate_many(
    bodies: SpringBodies,
    integrator: Integrator | str = ...,
    *,
    settings: SimulationSettings | None = ...,
    progress: Callable[[int, int], object] | None = ...,
) -> SpringEnds: ...


def simulate_many(
    bodies: Bodies | SpringBodies,
    integrator: Integrator | str = Integrator.SPLITTING,
    *,
    settings: SimulationSettings | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> Ends | SpringEnds:
    """Every body simulated to its end, on `settings.threads` threads.

    The interpreter's lock is free meanwhile.

    Parameters
    ----------
    bodies
        Of `bodies_of`, or of `bodies_on_springs`.
    integrator
        Also by name, as in `certreg.simulate`; on general springs midpoint or splitting.
    settings
        None: as `SimulationSettings()` has it.
    progress
        Called with the number of bodies that are done and that of all; the ends are the same.

    Returns
    -------
    Ends
        The last state of each, and how it came there; of bodies on general springs `SpringEnds`.

    Raises
    ------
    DegenerateProblemError
        Where a body is too stiff for explicit Euler.
    ValueError
        For explicit Euler on general springs.
    """
    if isinstance(bodies, SpringBodies):
        return simulate_on_springs(bodies, integrator, settings=settings, progress=progress)
    integrator, settings = Integrator(integrator), settings or SimulationSettings()
    batch = Batch.of(
        integrator,
        bodies=bodies.records,
        basins=bodies.basins,
        steps=step_parameters(integrator, bodies.records, bodies.basins, settings),
        states=_stepped(bodies.starts, integrator),
    )
    run_all(batch, settings, PORTION, progress)
    return Ends.of(batch)


def _length_exponents(poses: StationaryPoses) -> NDArray[np.int64]:
    """Of the power of two next to the root-mean-square radius of both clouds, (count,)."""
    largest = poses.exponents.max(axis=1)
    spread = _spreads(poses, poses.exponents - largest[:, np.newaxis])
    return largest + np.frexp(spread)[1].astype(np.int64) // 2


def _spreads(poses: StationaryPoses, units: NDArray[np.integer[Any]]) -> NDArray[np.float64]:
    """The mean squares of both clouds about their means, (count,), in units of 2^units each."""
    source = poses.scatter[:, DIAGONAL].sum(axis=1)
    of_source, of_target = units.T
    target = np.ldexp(poses.spreads["centred_target"], 2 * of_target)
    return np.ldexp(source, 2 * of_source) + target


def _inertias(poses: StationaryPoses, units: NDArray[np.integer[Any]]) -> NDArray[np.float64]:
    """The upper triangles of J, (count, 6), in units of 2^units each of the source."""
    a, b, c, d, e, f = np.ldexp(poses.scatter, 2 * units[:, :1]).T
    upper = np.column_stack([d + f, -b, -c, a + f, -e, a + d])
    thinnest, _, _ = np.linalg.eigvalsh(symmetric(upper)).T
    flat = ~(thinnest > SMALLEST_INERTIA)
    if flat.any():
        instance = int(np.argmax(flat))
        message = f"the source of instance {instance} is collinear, or nearly so"
        raise DegenerateProblemError(
            message, instance=instance, value=float(thinnest[instance]), limit=SMALLEST_INERTIA
        )
    return upper


def _inverses(upper: NDArray[np.float64]) -> NDArray[np.float64]:
    """The upper triangles of the inverses of symmetric matrices, (count, 6)."""
    inverse = np.asarray(np.linalg.inv(symmetric(upper)), dtype=np.float64)
    return inverse[(slice(None), *np.triu_indices(3))]


def _stepped(starts: Records, integrator: Integrator) -> Records:
    """The starts as the integrator keeps them: with a matrix if it has one."""
    if integrator is not Integrator.EULER:
        return starts
    states = np.empty(len(starts), dtype=MATRIX_STATE)
    states["R"] = rotation_matrices(starts["q"])
    for part in ("c", "v", "omega"):
        states[part] = starts[part]
    return states
