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

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, Self, TypeVar

import numpy as np

from certreg.dynamics.basin import basins_of
from certreg.dynamics.body import SMALLEST_INERTIA, steps_of
from certreg.dynamics.integrators import SimulationSettings, integrate, step_parameters
from certreg.dynamics.springs import body_on_springs
from certreg.equilibrium.batch import clouds, stationary_poses
from certreg.equilibrium.spring_batch import many_springs
from certreg.errors import DegenerateProblemError
from certreg.geometry.so3 import rotation_matrices
from certreg.native.layout import BODY, MATRIX_STATE, QUATERNION_STATE, symmetric
from certreg.native.loops import Batch, Ending, Integrator
from certreg.objective.springs import Springs
from certreg.problem.motion import DEFAULT_DAMPING, checked_damping
from certreg.problem.stiffness import spring_moments
from certreg.results import Brief

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from certreg.dynamics.springs import SprungBody
    from certreg.native.layout import Records
    from certreg.native.stationary import StationaryPoses

DIAGONAL = [0, 3, 5]  # of an upper triangle
End_co = TypeVar("End_co", covariant=True)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ManyEnds(Brief):
    """Where many bodies ended, and how: what `Ends` and `SpringEnds` have in common.

    status: (count,), numbers of an `Ending`; steps, escapes: (count,) integers; times: (count,), of
    the springs. states: (count,) records with the parts c, R for Euler, else q, v and omega.
    """

    integrator: Integrator
    status: NDArray[np.int32]
    steps: NDArray[np.int64]
    escapes: NDArray[np.int64]
    times: NDArray[np.float64]
    states: Records

    @classmethod
    def of(cls, batch: Batch, **own: Any) -> Self:
        """The ends of a batch that has run. own: what a kind of ends has beside these."""
        return cls(
            integrator=batch.integrator,
            status=batch.status,
            steps=batch.taken,
            escapes=batch.escapes,
            times=batch.times,
            states=batch.states,
            **own,
        )

    @property
    def rotations(self) -> NDArray[np.float64]:
        """The rotations at the ends, (count, 3, 3), body to world: target from source."""
        if self.integrator is Integrator.EULER:
            return self.states["R"]
        return rotation_matrices(self.states["q"])


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

    PORTION: ClassVar[int] = (
        8192  # after which somebody is told: a tenth of a second, and full lanes
    )

    def batch(self, integrator: Integrator, settings: SimulationSettings) -> Batch:
        """What the loops run. Raises DegenerateProblemError of one too stiff for explicit Euler."""
        return Batch.of(
            integrator,
            bodies=self.records,
            basins=self.basins,
            steps=step_parameters(integrator, self.records, self.basins, settings),
            states=_stepped(self.starts, integrator),
        )

    def ends(self, batch: Batch) -> Ends:
        """Where they ended, after a run."""
        return Ends.of(batch)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SpringBodies(Brief):
    """Bodies on general springs, to be simulated.

    bodies: what the dynamics knows of each. starts: (count,) records c, q = (w, x, y, z), v, omega,
    lengths over 2^length_exponent of the body, c from its origin.
    """

    bodies: tuple[SprungBody, ...]
    starts: Records

    PORTION: ClassVar[int] = 1024  # after which progress is told: full lanes

    def batch(self, integrator: Integrator, settings: SimulationSettings) -> Batch:
        """What the loops run. Raises InvalidProblemError for explicit Euler."""
        return Batch.of(
            integrator,
            bodies=np.array([body.record for body in self.bodies]),
            steps=steps_of(integrator, self.bodies, self.starts, settings),
            states=self.starts,
        )

    def ends(self, batch: Batch) -> SpringEnds:
        """Where they ended, after a run."""
        return SpringEnds.of(batch, bodies=self)


class Runnable(Protocol[End_co]):
    """Bodies that can be simulated side by side."""

    PORTION: ClassVar[int]

    def batch(self, integrator: Integrator, settings: SimulationSettings) -> Batch:
        """What the loops run."""
        ...

    def ends(self, batch: Batch) -> End_co:
        """Where the bodies ended, after a run."""
        ...


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
    bodies: list[SprungBody] = []
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


def simulate_many(
    bodies: Runnable[End_co],
    integrator: Integrator | str = Integrator.SPLITTING,
    *,
    settings: SimulationSettings | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> End_co:
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
    integrator, settings = Integrator(integrator), settings or SimulationSettings()
    batch = bodies.batch(integrator, settings)
    count = len(batch.states)
    portion = count or 1 if progress is None else bodies.PORTION
    for start in range(0, count, portion):
        integrate(batch.part(slice(start, start + portion)), settings)
        if progress is not None:
            progress(min(start + portion, count), count)
    return bodies.ends(batch)


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
