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

On general springs each is the body that `certreg.simulate` moves, made of exact sums, with the step
that it takes there. A body at rest is in a valley of its energy: which one does not follow.

>>> normals = rng.normal(size=(20, 3))
>>> ends = simulate_many(bodies_on_springs(source, targets[:10], normals=normals))
>>> bool(ends.at_rest.all()), ends.rotations.shape
(True, (10, 3, 3))
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.dynamics.body import SMALLEST_INERTIA, basins_of, steps_of
from certreg.dynamics.integrators import SimulationSettings, integrate, step_parameters
from certreg.dynamics.states import with_matrices
from certreg.dynamics.valleys import SprungBody, body_on_springs
from certreg.equilibrium.batch import clouds, stationary_poses
from certreg.equilibrium.line_batch import many_springs
from certreg.errors import DegenerateProblemError
from certreg.native.layout import BASIN, BODY, QUATERNION_STATE, Records, symmetric
from certreg.native.loops import Batch, Ending, Integrator
from certreg.objective.springs import Springs
from certreg.problem.motion import DEFAULT_DAMPING, checked_damping
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from certreg.native.stationary import StationaryPoses


DIAGONAL = [0, 3, 5]  # of an upper triangle
PORTION, SPRUNG_PORTION = 8192, 1024  # bodies after which progress is told: full lanes


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ends(Brief):
    """Where many bodies ended, and how.

    status: (count,), numbers of an `Ending`: 0 out of steps, 1 converged, 2 at rest; steps,
    escapes: (count,) integers; times: (count,), of the springs. states: (count,) records with the
    parts c, R for Euler, else q, v and omega, lengths as in `Bodies`.
    """

    bodies: Bodies
    integrator: Integrator
    status: NDArray[np.int32]
    steps: NDArray[np.int64]
    escapes: NDArray[np.int64]
    times: NDArray[np.float64]
    states: Records

    @property
    def at_rest(self) -> NDArray[np.bool_]:
        """Whether each came to rest, (count,): at the optimum or at another equilibrium."""
        return (self.status == Ending.CONVERGED) | (self.status == Ending.AT_REST)

    @property
    def converged(self) -> NDArray[np.bool_]:
        """Whether each came to rest at the optimum, or at one of the optima, (count,).

        On general springs, where no basin tells, none is said to.
        """
        return self.at_rest & (not self.bodies.sprung)

    @property
    def rotations(self) -> NDArray[np.float64]:
        """The rotations at the ends, (count, 3, 3), body to world: target from source."""
        return with_matrices(self.states)["R"]

    @property
    def translations(self) -> NDArray[np.float64]:
        """The translations at the ends, (count, 3), in the user's unit."""
        bodies = self.bodies
        moved = (self.rotations @ bodies.centres[..., np.newaxis])[..., 0]
        exponents = bodies.length_exponents[:, np.newaxis]
        return bodies.origins + np.ldexp(self.states["c"], exponents) - moved


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Bodies(Brief):
    """Bodies to be simulated: what the dynamics knows of each, per unit of mass.

    Lengths are over 2^length_exponents, (count,). The next are (count,) records with these parts:
    records: cross, C row by row; inertia and inertia_inverse, upper triangles of J and of its
        inverse (11 12 13 22 23 33); spread of both clouds; damping. On general springs their sums.
    basins: quaternions, (4, 4), of the equilibria by descending eigenvalue of the Davenport matrix;
        gaps, (4,), of the eigenvalues to the largest. On general springs nothing.
    starts: c, the centre of mass from the origin; q = (w, x, y, z); v; omega.
    centres, origins: (count, 3), of the source's mass, and where c is 0, in the user's unit.
    sprung: on general springs each of the bodies; else none.
    """

    records: Records
    basins: Records
    starts: Records
    length_exponents: NDArray[np.int64]
    centres: NDArray[np.float64]
    origins: NDArray[np.float64]
    sprung: tuple[SprungBody, ...] = ()

    def batch(self, integrator: Integrator, settings: SimulationSettings) -> Batch:
        """What the loops run.

        Raises DegenerateProblemError of one too stiff for explicit Euler, InvalidProblemError for
        that on general springs.
        """
        steps = (
            steps_of(integrator, self.sprung, self.starts, settings)
            if self.sprung
            else step_parameters(integrator, self.records, self.basins, settings)
        )
        euler = integrator is Integrator.EULER
        return Batch.of(
            integrator,
            bodies=self.records,
            basins=None if self.sprung else self.basins,
            steps=steps,
            states=with_matrices(self.starts) if euler else self.starts,
        )


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
        centres=poses.means["source"],
        origins=poses.means["target"],
    )


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
) -> Bodies:
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
    Bodies
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
    bodies: list[SprungBody] = []
    for k in range(given.count):
        try:
            bodies.append(body_on_springs(Springs.of(given.problem(k)), damping))
        except DegenerateProblemError as error:
            raise DegenerateProblemError(
                f"instance {k}: {error}",
                instance=k,
                rank=error.rank,
                value=error.value,
                limit=error.limit,
            ) from error
    starts = np.array([body.start for body in bodies])
    return Bodies(
        records=np.array([body.record for body in bodies]),
        basins=np.zeros(len(bodies), dtype=BASIN),
        starts=starts,
        length_exponents=np.array([body.length_exponent for body in bodies]),
        centres=np.array([[float(c) for c in body.centre] for body in bodies]),
        origins=np.array([[float(c) for c in body.origin] for body in bodies]),
        sprung=tuple(bodies),
    )


def simulate_many(
    bodies: Bodies,
    integrator: Integrator | str = Integrator.SPLITTING,
    *,
    settings: SimulationSettings | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> Ends:
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
        The last state of each, and how it came there.

    Raises
    ------
    DegenerateProblemError
        Where a body is too stiff for explicit Euler.
    ValueError
        For explicit Euler on general springs.
    """
    integrator, settings = Integrator(integrator), settings or SimulationSettings()
    batch = bodies.batch(integrator, settings)
    count = len(batch.states)
    portion = count or 1
    if progress is not None:
        portion = SPRUNG_PORTION if bodies.sprung else PORTION
    for start in range(0, count, portion):
        integrate(batch.part(slice(start, start + portion)), settings)
        if progress is not None:
            progress(min(start + portion, count), count)
    return Ends(
        bodies=bodies,
        integrator=integrator,
        status=batch.status,
        steps=batch.taken,
        escapes=batch.escapes,
        times=batch.times,
        states=batch.states,
    )


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
        raise DegenerateProblemError(
            f"the source of instance {instance} is collinear, or nearly so",
            instance=instance,
            value=float(thinnest[instance]),
            limit=SMALLEST_INERTIA,
        )
    return upper


def _inverses(upper: NDArray[np.float64]) -> NDArray[np.float64]:
    """The upper triangles of the inverses of symmetric matrices, (count, 6)."""
    inverse = np.asarray(np.linalg.inv(symmetric(upper)), dtype=np.float64)
    return inverse[(slice(None), *np.triu_indices(3))]
