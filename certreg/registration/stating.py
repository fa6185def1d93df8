"""The problem that was stated: a problem, or two clouds and what goes with them."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from certreg.errors import InvalidProblemError
from certreg.io import stated_problem
from certreg.problem import RegistrationProblem
from certreg.registration.closed_form import SpringArguments

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

LOG = logging.getLogger(__name__)
CONSENSUS, TRUNCATED = "consensus", "truncated"  # objectives, where pairs may be wrong


class ProblemOptions(SpringArguments, total=False):
    """What states a problem beside its clouds, as in `RegistrationProblem`."""

    sigma: ArrayLike | None
    weights: ArrayLike | None
    damping: float | None
    scale: str
    rotation_only: bool


def stated_problem_of(
    problem: Any, target: Any, statement: ProblemOptions
) -> tuple[RegistrationProblem, dict[str, Any]]:
    """The problem, and what its certificate may say of the clouds that it was made of."""
    if isinstance(problem, RegistrationProblem):
        if target is not None or statement:
            given = ", ".join(["target"] * (target is not None) + list(statement))
            message = f"{given} beside a problem, which states it itself: give one of the two"
            raise InvalidProblemError(message, array="target" if target is not None else "problem")
        return problem, {}
    if target is None:
        message = (
            f"certify takes a RegistrationProblem, or source and target: a "
            f"{type(problem).__name__} alone is neither"
        )
        raise InvalidProblemError(message, array="target")
    return stated_in_clouds(problem, target, statement)


def stated_in_clouds(
    source: Any, target: Any, statement: ProblemOptions, *, depth: int = 4
) -> tuple[RegistrationProblem, dict[str, Any]]:
    """The same of two clouds, what is noted of them in the log; depth: as of `stated_problem`."""
    stated, pair = stated_problem(source, target, depth=depth, **statement)
    for note in pair.notes:
        LOG.warning("%s", note)
    return stated, pair.about


def checked_objective(objective: Any, max_residual: Any) -> str | None:
    """Its name, None where none was given; raises InvalidProblemError for others."""
    if objective not in {None, CONSENSUS, TRUNCATED}:
        message = f"objective is {objective!r}: give '{CONSENSUS}' or '{TRUNCATED}'"
        raise InvalidProblemError(message, array="objective", value=objective)
    if objective is not None and max_residual is None:
        message = f"objective is {objective!r}: it goes with max_residual, give that, too"
        raise InvalidProblemError(message, array="max_residual", value=None)
    return objective
