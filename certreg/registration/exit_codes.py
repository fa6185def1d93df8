"""Exit codes: the contract that scripts rely on."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from certreg.errors import ContradictionError, RefusedCertificateError, UndecidedError
from certreg.results import Optimality

DONE, REFUSED, MISUSED, NOT_UNIQUE, NOT_CERTIFIED = 0, 1, 2, 3, 4
DIGITS = 6  # of an RMSE, in words
DEFECT = 70  # of certreg's own, with a traceback; sysexits.h calls it so
INTERRUPTED = 130  # as shells have it: 128 and the number of the signal, 2
PRECEDENCE = (MISUSED, REFUSED, NOT_CERTIFIED, NOT_UNIQUE, DONE)


def worst(codes: Iterable[int]) -> int:
    """The code of a run whose parts end with these: the first of 2, 1, 4, 3, 0.

    >>> worst([0, 3, 4])
    4
    """
    return min(codes, key=PRECEDENCE.index, default=DONE)


def code_of_error(error: Exception) -> int:
    """1 where certreg contradicts itself, 4 where it could not decide, else 2."""
    if isinstance(error, ContradictionError | RefusedCertificateError):
        return REFUSED
    return NOT_CERTIFIED if isinstance(error, UndecidedError) else MISUSED


@dataclass(frozen=True, slots=True, kw_only=True)
class FitDemands:
    """What is asked of a fit, beside the proof: no warning, an RMSE of at most so much."""

    require_fit: bool = False
    max_rmse: float | None = None

    def unmet(self, rmse: float | None, *, warned: bool) -> list[str]:
        """In words, what a fit with or without warnings does not meet."""
        words: list[str] = []
        if self.require_fit and warned:
            words.append("the fit has warnings")
        if self.max_rmse is not None and (rmse is None or rmse > self.max_rmse):
            size = "beyond doubles" if rmse is None else _told_above(rmse, self.max_rmse)
            words.append(f"the RMSE is {size}, more than {self.max_rmse!r}")
        return words


def _told_above(value: float, limit: float) -> str:
    """A value above a limit in six digits, or in more where these are not above it."""
    told = (f"{value:.{digits}g}" for digits in range(DIGITS, 17))
    return next((words for words in told if float(words) > limit), f"{value!r}")


def code_of_demands(code: int, unmet: Sequence[str]) -> int:
    """The code of a run, and 4 where something asked of its fit is not met."""
    return worst([code, NOT_CERTIFIED]) if unmet else code


def code_of_status(status: Optimality) -> int:
    """What `certify` ends with for what is proved of a pose."""
    if status is Optimality.CERTIFIED:
        return DONE
    return NOT_UNIQUE if status is Optimality.CERTIFIED_NOT_UNIQUE else NOT_CERTIFIED


def code_of_list(*, unique: bool | None) -> int:
    """Of a list of equilibria. unique: whether one is optimal; None where that is not proved."""
    if unique is None:
        return NOT_CERTIFIED
    return DONE if unique else NOT_UNIQUE
