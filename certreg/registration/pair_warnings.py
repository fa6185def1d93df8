"""What is to be said against pairs that may be wrong, beside what is proved of them.

A label says which pairs one motion brings within their bounds, not which are right: bounds that
are wide, pairs that are few, and a poor fit to those within are reasons to think that wrong ones
are among them. As with warnings of a fit nothing of this is proved; unlike these, whose rates are
measured, when to say it is a choice.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.problem.bounds import LEAST_PAIRS
from certreg.registration.consensus_words import against_pose, bound_share, bound_words
from certreg.registration.headlines import reason_of_fit
from certreg.registration.misfits import FitCode, FitWarning

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.problem.problem import RegistrationProblem
    from certreg.registration.result import Registration


WIDE = 0.25  # of a cloud's size: of directions a sixth or more are within it of any one
FEW = 6  # pairs, where FEW_OF times as many are given: sets of five of 100 agree by chance
FEW_OF = 10
LEAST_EXPLAINED = 0.5  # as for the warning of a poor fit
REASONS = {
    FitCode.FEW_PAIRS: "SO FEW PAIRS MAY AGREE BY CHANCE",
    FitCode.WIDE_BOUND: "THE BOUND IS WIDE",
}


def few_warning(met: int, n: int, pairs: str = "pairs") -> FitWarning | None:
    """That the pairs that are met may agree by chance, where they are few; None where not.

    Any three of equal lengths fit; of many pairs, all of them wrong, some four to six do.
    """
    if met > max(LEAST_PAIRS, min(FEW, n // FEW_OF)):
        return None
    return FitWarning(
        code=FitCode.FEW_PAIRS,
        text=f"so few {pairs}, {met} of {n}, may agree by chance, even where all pairs are wrong",
        remedy="give more pairs, or a smaller bound if right pairs keep it",
    )


def wide_warning(problem: RegistrationProblem) -> FitWarning | None:
    """Of a bound that tells few wrong pairs from right ones; None of others."""
    if bound_share(problem) < WIDE:
        return None
    return FitWarning(
        code=FitCode.WIDE_BOUND,
        text=f"the {bound_words(problem)} that an inlier may well be a wrong pair",
        remedy="give a smaller bound, if right pairs keep it",
    )


def poor_warning(fit: Registration) -> FitWarning | None:
    """Of a fit that explains little and that no test is for; None of others."""
    share = fit.fit.explained
    if fit.fit.untested is None or share is None or share >= LEAST_EXPLAINED:
        return None
    return FitWarning(
        code=FitCode.POOR_FIT,
        text=f"of the target's spread the fit explains {100.0 * share:.3g} %: wrong pairs may be "
        "among those within, or noise is large",
        remedy="check the pairs within, or give a smaller bound if right pairs keep it",
    )


def reason_against(fit: Registration, warnings: Sequence[FitWarning]) -> str | None:
    """What the first line says against pairs whose labels are proved, and their pose; or None.

    warnings: of the pairs, without those of the fit.
    """
    own = [REASONS.get(one.code, "THE FIT IS POOR") for one in warnings]
    return against_pose(fit) or next(iter(own), None) or reason_of_fit(fit.fit)
