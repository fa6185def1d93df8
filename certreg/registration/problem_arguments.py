"""The problem that was stated: a problem, or two clouds and what goes with them."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from certreg.errors import InvalidProblemError
from certreg.io.objects import ProblemOptions, stated_problem
from certreg.problem.attributes import SHAPES
from certreg.problem.motion import Scale, checked_rotation_only, checked_scale
from certreg.problem.problem import RegistrationProblem
from certreg.problem.support import Cell, Loss, Verb, require_supported

if TYPE_CHECKING:
    from typing_extensions import TypeIs


LOG = logging.getLogger(__name__)


def stated_problem_of(
    problem: Any, target: Any, statement: ProblemOptions, loss: Loss
) -> tuple[RegistrationProblem, dict[str, Any]]:
    """The problem, and what its certificate may say of the clouds that it was made of."""
    if is_problem(problem):
        if target is not None or statement:
            given = ", ".join(["target"] * (target is not None) + list(statement))
            raise InvalidProblemError(
                f"{given} beside a problem, which states it itself: give one of the two",
                array="target" if target is not None else "problem",
            )
        require_squares(problem)
        return problem, {}
    if target is None:
        raise InvalidProblemError(
            f"certify takes a RegistrationProblem, or source and target: a "
            f"{type(problem).__name__} alone is neither",
            array="target",
        )
    require_supported(_declared(statement, loss))
    return stated_in_clouds(problem, target, statement)


def is_problem(value: Any) -> TypeIs[RegistrationProblem]:
    """Whether it is a problem that is stated."""
    return isinstance(value, RegistrationProblem)


def require_problem(problem: Any, name: str) -> None:
    """Nothing for a problem; InvalidProblemError for what else the function of this name gets."""
    if not is_problem(problem):
        raise InvalidProblemError(
            f"{name} takes a RegistrationProblem, not {type(problem).__name__}: of two clouds "
            "RegistrationProblem(source, target) makes one",
            array="problem",
        )
    require_squares(problem)


def require_squares(problem: RegistrationProblem) -> None:
    """Nothing for least squares over all pairs; InvalidProblemError where they have bounds."""
    if problem.loss.kind is not Loss.SQUARES:
        raise InvalidProblemError(
            "the pairs of this problem have bounds: give the one that it was made of",
            array="problem",
        )


def require_method(method: Any, known: Sequence[str], cell: Cell) -> None:
    """Nothing for a method that lists the equilibria of such problems; else InvalidProblemError."""
    if method in set(Verb):
        require_supported(cell, Verb(method))
    if method not in known:
        raise InvalidProblemError(
            f"method is {method!r}: give {', '.join(map(repr, known))}",
            array="method",
            value=method,
        )


def _declared(statement: ProblemOptions, loss: Loss) -> Cell:
    """What the options declare, before any cloud is read."""
    springs = (statement.get(name) for name in SHAPES)
    return Cell(
        springs=any(given is not None for given in springs),
        scale=checked_scale(statement.get("scale", Scale.NONE)),
        rotation_only=checked_rotation_only(statement.get("rotation_only", False)),
        loss=loss,
    )


def stated_in_clouds(
    source: Any, target: Any, statement: ProblemOptions, *, depth: int = 4
) -> tuple[RegistrationProblem, dict[str, Any]]:
    """The same of two clouds, what is noted of them in the log; depth: as of `stated_problem`."""
    stated, pair = stated_problem(source, target, depth=depth, **statement)
    for note in pair.notes:
        LOG.warning("%s", note)
    return stated, pair.about
