"""How much work is to be done: one factor on all budgets, a number of threads."""

from __future__ import annotations

import math
import operator
from typing import Any

from certreg.errors import InvalidProblemError
from certreg.exact.decimals import as_given

MOST_EFFORT = 1e6


def checked_effort(effort: Any) -> float:
    """A factor on the budgets of searches and proofs.

    Parameters
    ----------
    effort
        A number above 0, at most a million.

    Returns
    -------
    float
        The same.

    Raises
    ------
    InvalidProblemError
        For others.
    """
    try:
        value = float(effort)
    except (TypeError, ValueError, OverflowError):
        value = math.nan
    if isinstance(effort, str) or not 0.0 < value <= MOST_EFFORT:
        raise InvalidProblemError(
            f"effort is {effort!r}: give a number above 0, at most {as_given(MOST_EFFORT)}",
            array="effort",
            value=effort,
            limit=MOST_EFFORT,
        )
    return value


def checked_threads(threads: Any) -> int:
    """A number of threads, 1 or more; raises InvalidProblemError for anything else."""
    try:
        count = operator.index(threads)
    except TypeError:
        count = 0
    if isinstance(threads, bool) or count < 1:
        raise InvalidProblemError(
            f"threads is {threads!r}: it must be a whole number, 1 or more",
            array="threads",
            value=threads,
            limit=1,
        )
    return count
