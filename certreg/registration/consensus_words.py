"""What is proved of pairs within bounds, in words that are no stronger."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.exact.decimals import as_given, at_least, at_most
from certreg.problem.arrays import diameter
from certreg.registration.headlines import is_loose
from certreg.results import Optimality

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.certificate.producing_consensus import ProvedConsensus
    from certreg.problem.problem import RegistrationProblem
    from certreg.registration.quartic import QuarticSolution
    from certreg.registration.result import Registration
    from certreg.registration.row_names import RowNames


WORDS = {"i": "inlier", "o": "outlier", "?": "undecided"}
NAMED_ROWS = 5  # of the undecided ones, in a sentence
DIGITS = 7  # of a scale, in words
NAMED_RANGES = 3  # of scales, in a sentence


@dataclass(frozen=True, slots=True)
class PairLabels:
    """A letter for each pair, as a certificate holds them."""

    letters: str

    @property
    def words(self) -> tuple[str, ...]:
        """Of each pair."""
        return tuple(WORDS[letter] for letter in self.letters)

    @property
    def undecided(self) -> list[int]:
        """The rows of which nothing is proved."""
        return [row for row, letter in enumerate(self.letters) if letter == "?"]

    def count(self, word: str) -> int:
        """How many have it."""
        return self.words.count(word)


def headline(
    problem: RegistrationProblem, found: ProvedConsensus, names: RowNames, against: str | None
) -> str:
    """The first line: CERTIFIED only where every label is proved.

    against: what is to be said against pairs and pose, as of `reason_against`.
    """
    n, met, labels = problem.n, len(found.met), PairLabels(found.labels)
    within, motion = within_words(problem), motion_words(problem)
    but = "" if against is None else f", BUT {against}"
    if found.decided and met == n:
        one = "motion with a scale" if problem.scaled else "rigid motion"
        return f"CERTIFIED{but}: one {one} brings all {n} pairs {within}: no outliers."
    out = labels.count("outlier")
    if found.decided:
        return (
            f"CERTIFIED{but}: no {motion} brings more than {met} of the {n} pairs {within}, and "
            f"only these {met}. {others_words(out)} in EVERY such motion."
        )
    open_rows = labels.undecided
    rest = f"{len(open_rows)} undecided ({names.counted(open_rows[:NAMED_ROWS], len(open_rows))})"
    sure = labels.count("inlier")
    kept = f", {_pairs(sure)} inliers" if sure > 1 else ", one pair an inlier" if sure else ""
    if found.upper == met:
        return (
            f"MAXIMUM PROVED, LABELS NOT: no {motion} brings more than {met} of the {n} pairs "
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


def against_pose(fit: Registration) -> str | None:
    """Why not to rely on the pose of pairs though their labels are proved; None where one may."""
    if fit.status in {Optimality.BOUNDED, Optimality.NOT_CERTIFIED}:
        return "THE POSE IS NOT CERTIFIED"
    if fit.problem.factors is not None:
        return _against_sprung(fit)
    equilibria = fit.equilibria
    if not equilibria.classification.unique:
        return "THE POSE IS NOT UNIQUE"
    if equilibria.nearly_ambiguous:
        return "THE ROTATION IS NEARLY AMBIGUOUS"
    return _against_turn(fit)


def _against_sprung(fit: Registration[QuarticSolution]) -> str | None:
    if fit.unique is False:
        return "A SHIFT IS FREE" if fit.solution.unique_rotation else "THE POSE IS NOT UNIQUE"
    return "A SHIFT IS HARDLY RESISTED" if fit.solution.weak_shifts else _against_turn(fit)


def _against_turn(fit: Registration) -> str | None:
    return "THE ROTATION IS HARDLY DETERMINED" if is_loose(fit) else None


def repeated_rows(problem: RegistrationProblem, rows: Sequence[int]) -> list[int]:
    """Those of the rows whose two points are the two points of an earlier one of them."""
    own = np.asarray(rows, dtype=np.intp)
    both = np.hstack([problem.source[own], problem.target[own]])
    first = np.unique(both, axis=0, return_index=True)[1]
    return np.delete(own, first).tolist()


def repeated_words(rows: Sequence[int], names: RowNames) -> str:
    """What is made of pairs that are given more than once; rows: of `repeated_rows`."""
    which = names.counted(rows[:NAMED_ROWS], len(rows))
    same = (
        "has the points of an earlier one" if len(rows) == 1 else "have the points of earlier ones"
    )
    return (
        f"pairs are repeated ({which}, {same}), and count each time: among the pairs within, and "
        "as independent measurements in the least squares"
    )


def motion_words(problem: RegistrationProblem) -> str:
    """What brings no more pairs within."""
    return "motion of any scale" if problem.scaled else "rigid motion"


def within_words(problem: RegistrationProblem) -> str:
    """Within the bound, or the bounds."""
    bounds = problem.bounds
    return f"within {as_given(bounds[0])}" if (bounds == bounds[0]).all() else "within their bounds"


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
    """The largest bound over the smaller cloud's box; over the target's where the scale is free.

    0 for a cloud of one point, which has no size; no pose of it is unique.
    """
    size = diameter(problem.target)
    if not problem.scaled:
        size = min(size, diameter(problem.source))
    return float(problem.bounds.max()) / size if size else 0.0


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
