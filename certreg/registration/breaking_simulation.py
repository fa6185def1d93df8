"""A simulated motion on springs that break, and what is proved of the springs that hold last."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from certreg.dynamics.breaking import SHRINKING, BreakingRun, BreakingStatus, run_breaking
from certreg.equilibrium.breaking import Labels, SpringSet
from certreg.errors import InvalidProblemError
from certreg.native.loops import Integrator
from certreg.problem.bounds import bounded
from certreg.problem.problem import RegistrationProblem
from certreg.problem.support import Loss
from certreg.registration.breaking import equilibrium_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from certreg.dynamics.integrators import SimulationSettings
    from certreg.registration.breaking import BreakingEquilibrium


LARGEST_SHRINKING = 1e6  # more breaks almost all springs at once


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
        message = f"shrinking is {shrinking!r}: give a number above 1, up to 1e6; 1.4 is usual"
        raise InvalidProblemError(message, array="shrinking", value=shrinking, limit=1.0)
    run = run_breaking(problem, Integrator(integrator), shrinking=shrinking, settings=settings)
    return SimulatedBreaking(**vars(run), end=_end(run))


def _end(run: BreakingRun) -> BreakingEquilibrium | None:
    """The equilibrium of least energy on the springs that hold at the end."""
    if run.status is not BreakingStatus.SETTLED:
        return None
    springs = SpringSet(run.problem, run.unbroken)
    poses = (pose for pose in springs.rest_poses() if pose.index == 0)
    return next((equilibrium_of(pose, springs) for pose in poses), None)
