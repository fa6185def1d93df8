"""What is proved of pairs within bounds, in words that are no stronger."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from certreg.exact.decimals import as_given, at_least, at_most
from certreg.problem.bounds import narrow_cloud
from certreg.problem.motion import Scale

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.certificate.producing_consensus import ProvedConsensus
    from certreg.objective.classification import Ambiguity
    from certreg.problem.problem import RegistrationProblem
    from certreg.registration.row_names import RowNames


NAMED_ROWS = 5  # of the undecided ones, in a sentence
DIGITS = 7  # of a scale, in words
NAMED_RANGES = 3  # of scales, in a sentence
ON_LINE = 1e-9  # of the size of a cloud: nearer to a line its points are said to be on it


class MotionWords(NamedTuple):
    """What brings pairs within: one such motion, and none of them."""

    one: str
    none: str


SCALED = MotionWords("motion with a scale", "motion of any scale")
MOTIONS = {
    Scale.NONE: MotionWords("rigid motion", "rigid motion"),
    Scale.ASYMMETRIC: SCALED,
    Scale.SYMMETRIC: SCALED,
}


def motion_words(problem: RegistrationProblem) -> MotionWords:
    """How the source may move."""
    return MOTIONS[problem.scale]


def headline(
    problem: RegistrationProblem, found: ProvedConsensus, names: RowNames, against: str | None
) -> str:
    """The first line: CERTIFIED only where every label is proved.

    against: what is to be said against pairs and pose, as of `reason_against`.
    """
    n, met, labels = problem.n, len(found.met), found.labels
    within, motion = within_words(problem), motion_words(problem)
    but = "" if against is None else f", BUT {against}"
    if found.decided and met == n:
        return f"CERTIFIED{but}: one {motion.one} brings all {n} pairs {within}: no outliers."
    out, sure = labels.count("o"), labels.count("i")
    if found.decided:
        return (
            f"CERTIFIED{but}: no {motion.none} brings more than {met} of the {n} pairs {within}, "
            f"and only these {met}. {others_words(out)} in EVERY such motion."
        )
    rows = [row for row, letter in enumerate(labels) if letter == "?"]
    rest = f"{len(rows)} undecided ({named_rows(names, rows)})"
    kept = f", {_pairs(sure)} inliers" if sure > 1 else ", one pair an inlier" if sure else ""
    if found.upper == met:
        return (
            f"MAXIMUM PROVED, LABELS NOT: no {motion.none} brings more than {met} of the {n} pairs "
            f"{within}; which {met} is not proved. {_outliers(out)}{kept} in every motion that "
            f"brings {met}; {rest}."
        )
    if out:
        return (
            f"PARTLY PROVED: {met} of {n} pairs found {within}; proved: not more than "
            f"{found.upper}. {_outliers(out)}{kept} in every motion that reaches {met}; {rest}."
        )
    return (
        f"NOT PROVED: {met} of {n} pairs found {within}; proved: not more than {found.upper}. The "
        f"{bound_words(problem)} that none is proved an outlier."
    )


def repeated_rows(
    problem: RegistrationProblem, rows: Sequence[int] | NDArray[np.intp]
) -> list[int]:
    """Those of the rows whose two points are the two points of an earlier one of them."""
    own = np.asarray(rows, dtype=np.intp)
    both = np.hstack([problem.source[own], problem.target[own]])
    first = np.unique(both, axis=0, return_index=True)[1]
    return np.delete(own, first).tolist()


def repeated_words(rows: Sequence[int], names: RowNames) -> str:
    """What is made of pairs that are given more than once; rows: of `repeated_rows`."""
    which = named_rows(names, rows)
    same = (
        "has the points of an earlier one" if len(rows) == 1 else "have the points of earlier ones"
    )
    return (
        f"pairs are repeated ({which}, {same}), and count each time: among the pairs within, and "
        "as independent measurements in the least squares"
    )


def named_rows(names: RowNames, rows: Sequence[int]) -> str:
    """The first of some rows, counting from 0, and how many others there are."""
    return names.counted(rows[:NAMED_ROWS], len(rows))


def within_words(problem: RegistrationProblem) -> str:
    """Within the bound, or the bounds."""
    bounds = problem.bounds
    return f"within {as_given(bounds[0])}" if (bounds == bounds[0]).all() else "within their bounds"


def those_within(count: int, n: int) -> str:
    """How many of n pairs are proved to be within their bounds."""
    if count == n:
        return f"all {n} pairs are within their bounds"
    verb = "is within its bound" if count == 1 else "are within their bounds"
    return f"{count} of the {n} pairs {verb}"


def are_words(count: int, word: str) -> str:
    """For example: 6 are outliers.

    >>> are_words(1, "inlier")
    '1 is an inlier'
    """
    return f"{count} is an {word}" if count == 1 else f"{count} are {word}s"


def others_words(count: int) -> str:
    """That all other pairs, one at least, are outliers; where, is to follow."""
    return "The other pair is an outlier" if count == 1 else f"The other {count} are outliers"


def _outliers(count: int) -> str:
    return f"{_pairs(count)} {'is an outlier' if count == 1 else 'are outliers'}"


def _pairs(count: int) -> str:
    return f"{count} pair{'s' * (count != 1)}"


def bound_words(problem: RegistrationProblem) -> str:
    """How wide the bound is, and what of it; a consequence is to follow."""
    percent = 100.0 * bound_share(problem)
    return f"bound is {percent:.2g} % of the cloud's size: so many pairs agree by chance"


def bound_share(problem: RegistrationProblem) -> float:
    """The largest bound over the diameter of the cloud that it is held against.

    0 for a cloud of one point, which has no size; no pose of it is unique.
    """
    size, _ = narrow_cloud(problem)
    return float(problem.bounds.max()) / size if size else 0.0


def line_words(points: NDArray[np.float64], bounds: NDArray[np.float64]) -> str:
    """Why no angle is proved: mostly the pairs are too near to a line for their bounds."""
    sizes = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    width, widest = math.hypot(*sizes[1:]) / math.sqrt(len(points)), bounds.max()
    if width <= ON_LINE * sizes[0]:
        return "these pairs lie on a line, and turns about it are not ruled out"
    if width <= widest:
        return (
            f"these pairs lie {width:.2g} from a line (root mean square), beside bounds of "
            f"{as_given(widest)}: turns about it are not ruled out"
        )
    return "for bounds as wide as these no angle below 180 degrees is proved"


def open_words(ambiguity: Ambiguity | None, *, labels: bool) -> str:
    """Why no angle to the optima of a truncated cost is proved.

    ambiguity: of the pairs within. labels: whether all of them are proved.
    """
    if not labels:
        return "with labels undecided, another optimum may have other pairs within their bounds"
    if ambiguity is None:
        return "the pairs within their bounds hardly tell this rotation from another"
    return f"of the pairs within their bounds, {ambiguity.value}"


def ranges_words(some: Sequence[tuple[float, float]]) -> str:
    """For example: from 0.5 to 0.75 and from 2 on; rounded outwards."""
    told: list[str] = []
    for low, high in some:
        begin = f"from {at_least(low, DIGITS)}"
        end = "on" if math.isinf(high) else f"to {at_most(high, DIGITS)}"
        told.append(f"{begin} {end}")
    if len(told) > NAMED_RANGES:
        told = [*told[: NAMED_RANGES - 1], f"in {len(told) - NAMED_RANGES + 1} other ranges"]
    return " and ".join([", ".join(told[:-1]), told[-1]] if len(told) > 1 else told)
