"""Poses with ever more pairs within their bounds: a search that goes on only while it is asked.

It proposes and proves nothing: whoever can prove that no pose has more rows stops asking. It begins
with graduated non-convexity, whose rows are fitted anew as long as their number grows.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.relaxation.paired_rows import fitted, paired_rows, squared_ratios
from certreg.relaxation.truncated_squares import Candidate, candidate_of, truncated_fit

if TYPE_CHECKING:
    from collections.abc import Iterator

    import numpy as np
    from numpy.typing import NDArray

    from certreg.relaxation.paired_rows import PairedRows, Poses

MOST_REFITS = 20  # three are usual


def candidates(
    source: NDArray[np.float64],
    target: NDArray[np.float64],
    bounds: NDArray[np.float64],
    *,
    seed: int = 0,  # noqa: ARG001
    effort: float = 1.0,  # noqa: ARG001
    consistent: NDArray[np.bool_] | None = None,  # noqa: ARG001
) -> Iterator[Candidate]:
    """Poses of strictly growing numbers of inliers, each computed when it is asked for.

    source, target: (N, 3). bounds: (N,), positive. seed: of what is drawn; the same one gives the
    same poses. effort: in proportion to the work after which the search ends. consistent: (N, N),
    which two rows a pose may have within their bounds both; None: told by their lengths.
    """
    pairs = paired_rows(source, target, bounds)
    pose = grown(pairs, truncated_fit(pairs))
    yield candidate_of(pairs, pose, squared_ratios(pairs, pose))


def grown(pairs: PairedRows, pose: Poses) -> Poses:
    """The pose after its rows have been fitted anew as long as their number grows."""
    precisions = 1.0 / (pairs.bounds * pairs.bounds)
    within = squared_ratios(pairs, pose) <= 1.0
    for _ in range(MOST_REFITS):
        if not within.any():
            break
        refit = fitted(pairs, within * precisions)
        inside = squared_ratios(pairs, refit) <= 1.0
        if inside.sum() <= within.sum():
            break
        pose, within = refit, inside
    return pose
