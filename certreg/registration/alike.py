"""What is done for problems alone, or for springs alike in every way alone, and says so."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.errors import InvalidProblemError
from certreg.problem import RegistrationProblem

if TYPE_CHECKING:
    from typing import Any


def require_problem(problem: Any, name: str) -> None:
    """Nothing for a problem; InvalidProblemError for what else the function of this name gets."""
    if not isinstance(problem, RegistrationProblem):
        message = (
            f"{name} takes a RegistrationProblem, not {type(problem).__name__}: of two clouds "
            "RegistrationProblem(source, target) makes one"
        )
        raise InvalidProblemError(message, array="problem")


def require_alike(problem: RegistrationProblem, what: str) -> None:
    """Nothing for one weight per pair; InvalidProblemError for general springs."""
    if problem.factors is not None:
        message = (
            f"not for general springs: {what} for one weight per pair alone in this version; "
            "certify proves the optimum of general springs, too"
        )
        raise InvalidProblemError(message, array="factors")


def require_rigid(problem: RegistrationProblem, what: str) -> None:
    """Nothing for a scale of 1; InvalidProblemError where it is free."""
    if problem.scaled:
        message = f"not with a free scale: {what} for rigid motions alone: leave the scale out"
        raise InvalidProblemError(message, array="scale", value=problem.scale.value)
