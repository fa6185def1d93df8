"""What is done for springs alike in every way alone, and says so."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.errors import InvalidProblemError

if TYPE_CHECKING:
    from certreg.problem import RegistrationProblem


def require_alike(problem: RegistrationProblem, what: str) -> None:
    """Nothing for one weight per pair; InvalidProblemError for general springs."""
    if problem.factors is not None:
        message = (
            f"{what} not for general springs in this version: certify proves their optimum; or "
            "leave the springs out, for one weight per pair"
        )
        raise InvalidProblemError(message, array="factors")
