"""What is to be said against pairs that may be wrong, beside what is proved of them.

A label says which pairs one motion brings within their bounds, not which are right: bounds that
are wide, pairs that are few, and a poor fit to those within are reasons to think that wrong ones
are among them. As with warnings of a fit nothing of this is proved; unlike these, whose rates are
measured, when to say it is a choice.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from certreg.problem.bounds import LEAST_PAIRS
from certreg.registration.headlines import (
    CERTIFIED,
    NEARLY_AMBIGUOUS,
    POOR_FIT,
    SCALE_FITS,
    headline_of_data,
)
from certreg.registration.misfits import FitCode, FitWarning
from certreg.registration.pair_words import bound_share, bound_words
from certreg.results import Optimality

if TYPE_CHECKING:
    from certreg.problem.problem import RegistrationProblem
    from certreg.registration.result import Registration


WIDE = 0.25  # of a cloud's size: of directions a sixth or more are within it of any one
FEW = 6  # pairs, where FEW_OF times as many are given: sets of five of 100 agree by chance
FEW_OF = 10
LEAST_EXPLAINED = 0.5  # as for the warning of a poor fit
AMBIGUOUS = "THE ROTATION IS NEARLY AMBIGUOUS"
OF_FIT = (CERTIFIED, POOR_FIT, SCALE_FITS)  # first lines that say no more than its fit
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


def warnings_of(
    few: FitWarning | None, problem: RegistrationProblem, fit: Registration
) -> tuple[FitWarning, ...]:
    """All that there is to be said; few: as of `few_warning`."""
    told = (few, wide_warning(problem), poor_warning(fit))
    return tuple(one for one in told if one is not None)


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
    if fit.status in {Optimality.BOUNDED, Optimality.NOT_CERTIFIED}:
        return "THE POSE IS NOT CERTIFIED"
    if not fit.unique:
        return "A SHIFT IS FREE" if fit.solution.unique_rotation else "THE POSE IS NOT UNIQUE"
    data = headline_of_data(fit)
    if warnings and data in OF_FIT:
        return REASONS.get(warnings[0].code, "THE FIT IS POOR")
    reason = data.stamp.partition(", BUT ")[2]
    return AMBIGUOUS if data is NEARLY_AMBIGUOUS else reason or None
