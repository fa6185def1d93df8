"""`certify`, whatever the problem asks for: one weight per pair, general springs, wrong pairs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, TypedDict, cast

from certreg._loading import late
from certreg.dynamics.integrators import SimulationSettings
from certreg.native.loops import Integrator
from certreg.problem import support
from certreg.problem.bounds import bounded
from certreg.registration.certification import CROSS_CHECK, PARTS, certified
from certreg.registration.parts import counted
from certreg.registration.robustness import ROBUSTNESS_ANGLE, checked_angle
from certreg.registration.stating import stated_problem_of
from certreg.results import MAX_ANGLE, MAX_GAP, Limits

if TYPE_CHECKING:
    from typing import Unpack

    from certreg.problem.problem import RegistrationProblem
    from certreg.problem.support import Loss
    from certreg.registration import (
        consensus,
        fit_of_pairs,
        scaled_consensus,
        spring_certification,
        truncated,
    )
    from certreg.registration.consensus import ConsensusRegistration
    from certreg.registration.fit_of_pairs import FitSettings
    from certreg.registration.parts import Progress
    from certreg.registration.result import Registration
    from certreg.registration.stating import ProblemOptions
    from certreg.registration.truncated import TruncatedRegistration
else:  # one of them at most is needed
    consensus = late("certreg.registration.consensus")
    fit_of_pairs = late("certreg.registration.fit_of_pairs")
    scaled_consensus = late("certreg.registration.scaled_consensus")
    spring_certification = late("certreg.registration.spring_certification")
    truncated = late("certreg.registration.truncated")


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
        `sigma`, `weights`, `damping`, `scale` and `rotation_only`, as for a problem, beside source
        and target; what is noted of the pairs goes to the logger.

    Returns
    -------
    Registration
        The pose, what is proved of it, all equilibria, and the certificate. Of general springs a
        `SpringRegistration`, which has the same but no equilibria and no simulation; its relaxation
        is a part of the search, and always taken. With `max_residual` a `ConsensusRegistration`,
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
    loss = support.Loss.of(objective, max_residual)
    stated, named = stated_problem_of(problem, target, statement, loss)
    limits = Limits(max_gap=max_gap, max_angle=max_angle)
    if max_residual is not None:
        asked: _Asked = {
            "effort": effort,
            "settings": fit_of_pairs.FitSettings(
                solver=relaxation if isinstance(relaxation, str) else None,
                integrator=_named_integrator(simulation, stated),
                simulation=simulation if isinstance(simulation, SimulationSettings) else None,
                robustness_angle=checked_angle(robustness_angle),
                limits=limits,
            ),
            "about": {**named, **(about or {})},
        }
        chosen = _with_wrong_pairs(stated, max_residual, loss, asked, progress)
        return cast("Registration", chosen)
    if stated.factors is not None:
        found = spring_certification.certified_springs(
            stated,
            solver=relaxation if isinstance(relaxation, str) else None,
            robustness_angle=checked_angle(robustness_angle),
            about={**named, **(about or {})},
            limits=limits,
            done=counted(progress, spring_certification.SPRING_PARTS),
        )
        return cast("Registration", found)
    return certified(
        stated,
        relaxation=relaxation,
        integrator=_integrator(simulation, stated) if simulation else None,
        settings=simulation if isinstance(simulation, SimulationSettings) else None,
        robustness_angle=checked_angle(robustness_angle),
        about={**named, **(about or {})},
        limits=limits,
        done=counted(progress, PARTS + bool(relaxation) + bool(simulation)),
    )


class _Asked(TypedDict):
    effort: float
    settings: FitSettings
    about: dict[str, Any]


def _with_wrong_pairs(
    stated: RegistrationProblem,
    max_residual: Any,
    loss: Loss,
    asked: _Asked,
    progress: Progress | None,
) -> ConsensusRegistration | TruncatedRegistration:
    problem = bounded(stated, max_residual, loss)
    if loss is support.Loss.TRUNCATED:
        done = counted(progress, truncated.TRUNCATED_PARTS)
        return truncated.certified_truncated(problem, done=done, **asked)
    ways = scaled_consensus.SCALED if problem.scaled else consensus.RIGID
    done = counted(progress, consensus.CONSENSUS_PARTS)
    return consensus.certified_consensus(problem, ways, done=done, **asked)


def _integrator(
    simulation: str | SimulationSettings | Literal[True], problem: RegistrationProblem
) -> str:
    usual = Integrator.MIDPOINT if problem.scaled else CROSS_CHECK
    return Integrator(simulation).value if isinstance(simulation, str) else usual.value


def _named_integrator(simulation: Any, problem: RegistrationProblem) -> str | None:
    """Of a simulation that is asked for by more than True."""
    return None if isinstance(simulation, bool) else _integrator(simulation, problem)
