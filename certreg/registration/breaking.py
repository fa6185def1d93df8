"""Springs that break: all equilibria, each with just the springs that hold there; and a motion."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.dynamics.breaking import SHRINKING, BreakingRun, BreakingStatus, run_breaking
from certreg.equilibrium.breaking import LEAST_SPRINGS, Labels, RestPose, SpringSet, label_sets
from certreg.errors import DegenerateProblemError, InvalidProblemError
from certreg.exact.dyadic import nearest_double, power_of_two
from certreg.native.loops import Integrator
from certreg.problem.bounds import bounded
from certreg.problem.lifting import exact_springs
from certreg.problem.problem import RegistrationProblem
from certreg.problem.support import Loss
from certreg.registration.closed_form import register
from certreg.registration.optimum import pose_at
from certreg.relaxation.proposals import candidates
from certreg.results import OUT_OF_RANGE, Brief, ComponentKind, Explained

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from certreg.dynamics.integrators import SimulationSettings
    from certreg.geometry.pose import Pose
    from certreg.geometry.similarity import Similarity


FEW = 12  # springs, of which all sets are looked at: at most 4,000, ten seconds
MOST_MOVES = 50  # of the body until no spring breaks or mends: three are usual
MOST_SETS = 4096  # that are looked at, two milliseconds each
LARGEST_SHRINKING = 1e6  # more breaks almost all springs at once


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BreakingEquilibrium(Explained):
    """A rest pose of the body on springs that break.

    Attributes
    ----------
    unbroken
        The rows whose springs hold, ascending; all others are broken.
    pose
        Of a continuum its member with the least rotation.
    kind
        A point, or a continuum of rotations.
    energy
        The sum of w r^2 of the springs that hold and of w b^2 of the others; None where no double
        holds it.
    morse_index
        The number of independent directions in which the energy falls, exact.
    labels
        Whether it is proved which springs hold.
    doubtful
        The rows of which it is not.
    """

    unbroken: tuple[int, ...]
    pose: Pose | Similarity
    kind: ComponentKind
    energy: float | None
    morse_index: int
    labels: Labels
    doubtful: tuple[int, ...]

    @property
    def stable(self) -> bool:
        """Whether it is proved to be a strict local minimum of the energy."""
        proved = self.labels is Labels.PROVED
        return proved and self.morse_index == 0 and self.kind is ComponentKind.POINT


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BreakingEquilibria(Brief):
    """All equilibria with at least so many unbroken springs.

    Attributes
    ----------
    least
        Equilibria with fewer unbroken springs are not listed.
    sets
        How many sets of springs were looked at that may hold together.
    equilibria
        By ascending energy. Each has just the labels that it shows, and no spring on its bound.
    doubtful
        Rest poses on some springs of which that is not decided, or on a tie, by ascending energy.
    optimum_listed
        Whether it is proved that no pose has less energy than all that are listed as equilibria.
    """

    problem: RegistrationProblem
    least: int
    sets: int
    equilibria: tuple[BreakingEquilibrium, ...]
    doubtful: tuple[BreakingEquilibrium, ...]
    optimum_listed: bool

    @property
    def stable(self) -> tuple[BreakingEquilibrium, ...]:
        """Those that are strict local minima of the energy."""
        return tuple(each for each in self.equilibria if each.stable)

    @property
    def complete(self) -> bool:
        """Whether no rest pose is left undecided; those on a tie are decided, they are none."""
        return all(each.labels is Labels.TIED for each in self.doubtful)

    def __repr__(self) -> str:
        left = "" if self.complete else f", {len(self.doubtful)} doubtful"
        return (
            f"<BreakingEquilibria: {len(self.equilibria)} with {self.least} or more of "
            f"{self.problem.n} springs, {len(self.stable)} stable{left}>"
        )


def breaking_equilibria(
    source: Any,
    target: Any,
    *,
    max_residual: ArrayLike,
    weights: ArrayLike | None = None,
    least: int | None = None,
    most_sets: int = MOST_SETS,
) -> BreakingEquilibria:
    """All equilibria of the body whose springs break where they are longer than a bound.

    The energy is the sum of the least of w r^2 and w b^2, r the residual of a pair and b its bound:
    truncated least squares. Wherever no residual equals its bound, the springs that hold are some
    set S, and the equilibria are those of S alone, at most four or a continuum, which have just the
    labels S. So the list is made set by set, and it is complete: (1) two springs that hold together
    have lengths |x_j - x_i| and |y_j - y_i| that differ by less than the sum of their bounds, so S
    is a clique of such pairs; (2) where the least energy of some springs alone is not below that
    of breaking them, they never hold together, nor does a larger set; (3) of each set that is left
    the rest poses are the eigenspaces of its Davenport matrix, all of them, and (4) each label is
    decided in integers, for the exact rotation, or the pose is called doubtful. No minimum of the
    energy is missed at a residual that equals its bound: none is there (claim
    `springs_that_break`).

    Parameters
    ----------
    source, target
        (N, 3), as for `RegistrationProblem`, in one unit of length.
    max_residual
        The bounds b, one for all or (N,), > 0, in that unit.
    weights
        (N,), or one for all, > 0; None: 1.
    least
        How many springs hold at each equilibrium that is listed, 3 or more. None: 3 for up to 12
        pairs; for more as many as hold at rest, from the best pose that a search finds, which is no
        bound on what there is: ask for fewer to see more.
    most_sets
        How many sets of springs may be looked at, about two milliseconds each.

    Returns
    -------
    BreakingEquilibria
        With energies, indices, stability, and what is not decided.

    Raises
    ------
    InvalidProblemError
        For points, weights or bounds that state no problem, and other numbers `least`.
    UndecidedError
        Where there are more sets than `most_sets`, or 3,700 digits do not tell two energies apart.
    OutOfRangeError
        Where no double can hold a translation.

    Examples
    --------
    >>> source = [[0, 0, 0], [3, 0, 0], [0, 3, 0], [0, 0, 3], [20, 0, 0], [20, 3, 0], [20, 0, 3]]
    >>> target = [[0, 0, 0], [3, 0, 0], [0, 3, 0], [0, 0, 3], [24, 0, 0], [24, 3, 0], [24, 0, 3]]
    >>> for each in breaking_equilibria(source, target, max_residual=1.0).stable:
    ...     print(each.unbroken, each.energy)
    (0, 1, 2, 3) 3.0
    (4, 5, 6) 4.0
    """
    stated = RegistrationProblem(source, target, weights=weights)
    problem = bounded(stated, max_residual, Loss.BREAKING)
    fewest = _fewest(problem, least)
    count = 0
    found: list[tuple[RestPose, SpringSet]] = []
    for of in label_sets(problem, fewest, most_sets):
        count += 1
        found += [(pose, of) for pose in of.rest_poses()]
    found.sort(key=lambda pair: (pair[0].energy, pair[0].unbroken, pair[0].index))
    proved = [pair for pair in found if pair[0].labels is Labels.PROVED]
    doubtful = [pair for pair in found if pair[0].labels is not Labels.PROVED]
    return BreakingEquilibria(
        problem=problem,
        least=fewest,
        sets=count,
        equilibria=tuple(equilibrium_of(*pair) for pair in proved),
        doubtful=tuple(equilibrium_of(*pair) for pair in doubtful),
        optimum_listed=_optimum_listed(
            problem, fewest, [pose for pose, _ in proved], [pose for pose, _ in doubtful]
        ),
    )


def equilibrium_of(pose: RestPose, of: SpringSet) -> BreakingEquilibrium:
    """A rest pose on a set of springs, rounded for users."""
    return BreakingEquilibrium(
        unbroken=pose.unbroken,
        pose=pose_at(of.objective, pose.quaternion),
        kind=pose.kind,
        energy=nearest_double(pose.energy),
        morse_index=pose.index,
        labels=pose.labels,
        doubtful=pose.doubtful,
        absent={"energy": OUT_OF_RANGE},
    )


def _fewest(problem: RegistrationProblem, least: int | None) -> int:
    """How many springs hold at what is listed."""
    if least is not None:
        if not LEAST_SPRINGS <= least <= problem.n:
            raise InvalidProblemError(
                f"least is {least}: give a number of springs from {LEAST_SPRINGS} to {problem.n}; "
                "fewer hold the body in no pose, it turns about their line",
                array="least",
                value=least,
                limit=problem.n,
            )
        return least
    if problem.n <= FEW:
        return LEAST_SPRINGS
    block = problem.points
    found = [*candidates(block.source, block.target, problem.bounds)]
    return max(LEAST_SPRINGS, _held_at_rest(problem, found[-1].inliers.tolist()) if found else 0)


def _held_at_rest(problem: RegistrationProblem, held: list[int]) -> int:
    """How many springs hold after those of a pose have moved the body, and broken or mended.

    The energy falls all the while. 0 where they leave the rotation open. Floating point: it says
    how long a list is asked for, not what is in it.
    """
    for _ in range(MOST_MOVES):
        moved = problem.of_rows(held) if len(held) >= LEAST_SPRINGS else None
        if moved is None:
            return 0
        try:
            pose = register(moved.source, moved.target, weights=moved.weights)
        except DegenerateProblemError:
            return 0
        with np.errstate(over="ignore"):
            off = (problem.target - pose.apply(problem.source)).T / problem.bounds
            within = np.flatnonzero((off * off).sum(axis=0) < 1.0).tolist()
        if within == held:
            break
        held = within
    return len(held)


def _optimum_listed(
    problem: RegistrationProblem, least: int, proved: list[RestPose], doubtful: list[RestPose]
) -> bool:
    """Whether the least energy of all poses is that of an equilibrium that is listed.

    It is taken at a local minimum, so off all ties. Where fewer than `least` springs hold, the
    others have at least the energy of as many that break most easily. False: not proved.
    """
    open_minima = [pose for pose in doubtful if pose.index == 0 and pose.labels is not Labels.TIED]
    if open_minima or not proved:
        return False
    rows = exact_springs(problem)
    broken = sorted(rows.broken(i) for i in range(problem.n))[: problem.n - least + 1]
    elsewhere = sum(broken, Fraction(0)) * power_of_two(rows.exponent)
    return proved[0].energy <= elsewhere


@dataclass(frozen=True, kw_only=True, eq=False)
class SimulatedBreaking(BreakingRun):
    """A simulation with springs that break, and what is proved of its end.

    Attributes
    ----------
    end
        The stable equilibrium on the springs that hold at the end, its labels proved or not; None
        where there is none: the run ended in another way, or its labels are proved to be others.
    """

    end: BreakingEquilibrium | None

    @property
    def self_consistent(self) -> bool:
        """Whether it is proved that the springs that hold are just those of an equilibrium."""
        return self.end is not None and self.end.labels is Labels.PROVED

    @property
    def ending(self) -> str:
        """What it ended in, in a sentence."""
        count, n = self.stages[-1].count, self.problem.n
        if self.status is not BreakingStatus.SETTLED:
            return f"{self.status.value} {count} of {n} springs held then."
        if self.self_consistent:
            broken = f"the other {n - count} are broken" if n > count else "none is broken"
            return (
                f"Ended at a self-consistent set of {count} springs, proved: the body rests on "
                f"just these, {broken}."
            )
        return (
            f"Ended on {count} of {n} springs; not proved that just these hold at rest: a residual "
            "is on its bound, or nearly so, or the rest poses form a continuum."
        )

    def __repr__(self) -> str:
        last = self.stages[-1]
        return (
            f"<SimulatedBreaking: {self.status.name} on {last.count} of {self.problem.n} "
            f"springs after {last.steps} steps>"
        )


def simulate_breaking(  # noqa: PLR0913 - the data of a problem, then how it is run
    source: Any,
    target: Any,
    *,
    max_residual: ArrayLike,
    weights: ArrayLike | None = None,
    damping: float | None = None,
    integrator: str = Integrator.MIDPOINT.value,
    shrinking: float = SHRINKING,
    settings: SimulationSettings | None = None,
) -> SimulatedBreaking:
    """The motion of a body whose springs break where they are longer than a bound.

    Released at rest where the source was given, with bounds so wide that all springs hold. At each
    width the body moves on the springs that hold until it rests; then those beyond their bounds
    break, broken ones within mend, and it moves on, until none does. Then the bounds shrink, down
    to those that are given, as in graduated non-convexity. Nothing is drawn at random. It ends in
    a stable equilibrium, which need not be the best one: see `breaking_equilibria`.

    Parameters
    ----------
    source, target
        (N, 3), as for `RegistrationProblem`, in one unit of length.
    max_residual
        The bounds, one for all or (N,), > 0, in that unit.
    weights
        (N,), or one for all, > 0; None: 1.
    damping
        Viscous, per mass; None: sqrt(8).
    integrator
        "midpoint", "splitting" or "euler", as in `simulate`.
    shrinking
        By which the bounds are divided from one stage to the next, more than 1.
    settings
        Of each motion.

    Returns
    -------
    SimulatedBreaking
        Its stages, its end, and whether it is proved that just these springs hold there.

    Raises
    ------
    InvalidProblemError
        For points, weights or bounds that state no problem, and other numbers `shrinking`.
    ValueError
        For other integrators.
    DegenerateProblemError
        Where the source is collinear, the motion too stiff, or a bound below 1e-100 of the clouds'
        size.
    OutOfRangeError
        Where no double can hold a translation.

    Examples
    --------
    >>> source = [[0, 0, 0], [3, 0, 0], [0, 3, 0], [0, 0, 3], [20, 0, 0], [20, 3, 0], [20, 0, 3]]
    >>> target = [[0, 0, 0], [3, 0, 0], [0, 3, 0], [0, 0, 3], [24, 0, 0], [24, 3, 0], [24, 0, 3]]
    >>> simulate_breaking(source, target, max_residual=1.0).unbroken
    (0, 1, 2, 3)
    """
    stated = RegistrationProblem(source, target, weights=weights, damping=damping)
    problem = bounded(stated, max_residual, Loss.BREAKING)
    if not 1.0 < shrinking <= LARGEST_SHRINKING:
        raise InvalidProblemError(
            f"shrinking is {shrinking!r}: give a number above 1, up to 1e6; 1.4 is usual",
            array="shrinking",
            value=shrinking,
            limit=1.0,
        )
    run = run_breaking(problem, Integrator(integrator), shrinking=shrinking, settings=settings)
    return SimulatedBreaking(**vars(run), end=_end(run))


def _end(run: BreakingRun) -> BreakingEquilibrium | None:
    """The equilibrium of least energy on the springs that hold at the end."""
    if run.status is not BreakingStatus.SETTLED:
        return None
    springs = SpringSet(run.problem, run.unbroken)
    poses = (pose for pose in springs.rest_poses() if pose.index == 0)
    return next((equilibrium_of(pose, springs) for pose in poses), None)
