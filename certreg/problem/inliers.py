"""Which pairs somebody labelled as inliers."""

from __future__ import annotations

from typing import Any

import numpy as np

from certreg.errors import InvalidProblemError
from certreg.problem.consensus import LEAST_PAIRS

NAME = "labels"  # of the argument, as users know it
INLIER_WORDS = {"1": True, "0": False, "inlier": True, "outlier": False}


def checked_inliers(labels: Any, n: int) -> tuple[int, ...]:
    """The rows labelled as inliers, of n labels: booleans, 0 and 1, or the words.

    Raises InvalidProblemError for another number of labels, for others, and where fewer than three
    are inliers.
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
    if len(rows) < LEAST_PAIRS:
        message = (
            f"{NAME} name {len(rows)} inliers: give at least {LEAST_PAIRS}, as two "
            "of equal lengths always fit"
        )
        raise InvalidProblemError(message, array=NAME, value=len(rows), limit=LEAST_PAIRS)
    return tuple(rows)
