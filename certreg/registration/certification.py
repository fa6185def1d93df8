"""`certify`, whatever the problem asks for: one weight per pair, general springs, wrong pairs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Unpack

from certreg._loading import found_late, late
from certreg.dynamics.integrators import SimulationSettings
from certreg.io.objects import ProblemOptions
from certreg.native.loops import Integrator
from certreg.objective.structure import Structure
from certreg.problem.attributes import require_known
from certreg.problem.support import Cell, Loss
from certreg.registration.pipeline import Asked, Work, accepting
from certreg.registration.problem_arguments import stated_problem_of
from certreg.registration.progress import counted
from certreg.registration.robustness import ROBUSTNESS_ANGLE, checked_angle
from certreg.registration.squares import SQUARES
from certreg.results import MAX_ANGLE, MAX_GAP, Limits

if TYPE_CHECKING:
    from certreg.problem import bounds
    from certreg.registration.pipeline import Prover, Provers
    from certreg.registration.progress import Progress
    from certreg.registration.result import Registration
else:
    # of whose names most calls need none
    bounds = late("certreg.problem.bounds")


PROVERS: Mapping[Structure | Loss, Provers] = {
    **SQUARES,
    Loss.CONSENSUS: (found_late("certreg.registration.consensus", "PROVER"),),
    Loss.TRUNCATED: (found_late("certreg.registration.truncated", "PROVER"),),
}


def certify(  # noqa: PLR0913 - each is one question, and has its usual answer
    problem: Any,
    target: Any = None,
    *,
    relaxation: bool | str = True,
    simulation: bool | str | SimulationSettings = True,
    about: dict[str, Any] | None = None,
    max_gap: float = MAX_GAP,
    max_angle: float = MAX_ANGLE,
    robustness_angle: float | None = ROBUSTNESS_ANGLE,
    max_residual: Any = None,
    objective: str | None = None,
    effort: float = 1.0,
    progress: Progress | None = None,
    **statement: Unpack[ProblemOptions],
) -> Registration:
    """Register, enumerate all equilibria, cross-check, certify, and run the checker.

    Which equilibria there are is decided here; their numbers, the covariance and the fit are
    computed when they are first asked for, of clouds that are mapped from a file at once.

    Parameters
    ----------
    problem, target
        A `RegistrationProblem`; or source and target, as `certreg.pair` takes them: files, arrays,
        data frames, paired by label where both have labels.
    relaxation
        Whether to take the relaxation, too; all else is the same. Instead of True, its solver by
        CVXPY's name for it.
    simulation
        Whether to simulate, too; instead of True, settings, or the name of the integrator. Where
        the problem names no damping, that of the fastest decay is taken.
    about
        What else the certificate is to hold, unproved, besides damping and integrator.
    max_gap, max_angle
        What must be proved of the pose to call it certified, see `Limits`.
    robustness_angle
        Degrees, at most 90: how far the points may be off with the optimum proved to stay within
        that angle; None to leave it out.
    max_residual
        Where pairs may be wrong: how far apart the two points of a right one are at most, one
        number or (N,), in the unit of length, whatever their springs. Then the most pairs that one
        motion brings within are sought, and what is proved of each; the pose is that of the least
        squares over these, to which damping and `robustness_angle` go. Relaxation and simulation
        are of these, too, and only taken where they are named: a solver, an integrator or settings.
    objective
        With `max_residual`: "consensus", the number of pairs within, or "truncated", the sum of
        min((residual / max_residual)^2, 1), of rotations alone; None is "consensus".
    effort
        A factor on the budgets of that search and its proof.
    progress
        Called with the number of parts that are done and that of all: exact sums, relaxation,
        simulation, certificate and checker; with `max_residual` consensus, fit and checker.
    **statement
        `sigma`, `weights`, `damping`, `scale`, `rotation_only`, and general springs (`normals`,
        `directions`, `covariances`, `information`, `factors`), as for a problem, beside source and
        target; what is noted of the pairs goes to the logger.

    Returns
    -------
    Registration
        The pose, what is proved of it, all equilibria, and the certificate. Of general springs it
        has no equilibria and no simulation; their relaxation is a part of the search, and always
        taken. With `max_residual` a `ConsensusRegistration`,
        or a `TruncatedRegistration`.

    Raises
    ------
    InvalidProblemError, InvalidFileError
        For what states no problem.
    ContradictionError, RefusedCertificateError
        Where certreg contradicts itself.
    OutOfRangeError
        Where no double can hold the pose.
    """
    require_known(statement, ProblemOptions, "certify")
    loss = Loss.of(objective, max_residual)
    stated, named = stated_problem_of(problem, target, statement, loss)
    bounded = max_residual is not None
    asked = Asked(
        relaxation=_by_name(relaxation) if bounded else relaxation,
        simulation=_simulated(_by_name(simulation) if bounded else simulation),
        settings=simulation if isinstance(simulation, SimulationSettings) else None,
        robustness_angle=checked_angle(robustness_angle),
        limits=Limits(max_gap=max_gap, max_angle=max_angle),
        effort=effort,
        about={**named, **(about or {})},
    )
    if bounded:
        stated = bounds.bounded(stated, max_residual, loss)
    prover = prover_of(stated.cell)
    done = counted(progress, prover.parts(asked))
    return prover.certified(stated, asked, Work(done))


def prover_of(cell: Cell) -> Prover[Any, Any, Any]:
    """What proves a declared problem: by its loss, of least squares by the structure."""
    return accepting(PROVERS.get(cell.loss) or PROVERS[Structure.of(cell)], cell)


def _by_name(asked: Any) -> Any:
    """What is asked for by more than True: by a name, or settings."""
    return False if isinstance(asked, bool) else asked


def _simulated(simulation: Any) -> bool | Integrator:
    """Whether to simulate; by which integrator, where one is named."""
    return Integrator(simulation) if isinstance(simulation, str) else bool(simulation)
