"""Which pairs somebody labelled as inliers."""

from __future__ import annotations

from typing import Any

import numpy as np

from certreg.errors import InvalidProblemError
from certreg.problem.bounds import LEAST_PAIRS

NAME = "labels"  # of the argument, as users know it
LEAST_DIRECTIONS = 2  # that one rotation may meet: a single one is met by infinitely many
INLIER_WORDS = {"1": True, "0": False, "inlier": True, "outlier": False}


def checked_inliers(labels: Any, n: int, least: int = LEAST_PAIRS) -> tuple[int, ...]:
    """The rows labelled as inliers, of n labels: booleans, 0 and 1, or the words.

    Raises InvalidProblemError for another number of labels, for others, and where fewer than the
    least number are inliers.
    """
    texts = np.asarray(labels)
    if texts.shape != (n,):
        message = f"{NAME} has shape {texts.shape}: give ({n},), one for each pair"
        raise InvalidProblemError(message, array=NAME, value=texts.shape, limit=(n,))
    rows: list[int] = []
    for row, value in enumerate(texts.tolist()):
        word = str(int(value)) if isinstance(value, bool) else str(value)
        if word not in INLIER_WORDS:
            message = f"{NAME}[{row}] is {value!r}: give 0 or 1, outlier or inlier"
            raise InvalidProblemError(message, array=NAME, row=row, value=value)
        if INLIER_WORDS[word]:
            rows.append(row)
    if len(rows) < least:
        two = least == LEAST_DIRECTIONS
        always = "a single pair of equal lengths" if two else "two of equal lengths"
        named = f"{len(rows)} inlier{'s' * (len(rows) != 1)}"
        message = f"{NAME} name {named}: give at least {least}, as {always} always fit{'s' * two}"
        raise InvalidProblemError(message, array=NAME, value=len(rows), limit=least)
    return tuple(rows)
