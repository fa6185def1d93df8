"""Whether the noise rules out the next equilibrium, where little separates it from the optimum.

If the next pose were right, E1, its objective, would be noise alone: sigma^2 times a chi-squared
variable of 3 n - 6 degrees of freedom; and E0, the least, is that of a wrong pose, which is no
smaller in distribution than noise alone. So E0 <= b E1 has at most the probability of one such
variable being at most b times another, whatever links the two. Where sigma is given, E1 - E0 in
units of sigma^2 is twice the log-likelihood ratio; a fit worse than sigma says has a larger unit.
All of this is of right pairs: where the fit warns of anything but a small sigma, nothing is ruled
out. Statistics, as of the fit: nothing of it is proved.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from certreg.equilibrium.equilibrium_set import EquilibriumSet, equilibrium_set
from certreg.registration.fit import rows_tested
from certreg.registration.misfits import LEVEL, FitCode, FitSums
from certreg.registration.outlying import independent_rows
from certreg.registration.tail_probabilities import log_ratio_below

if TYPE_CHECKING:
    from certreg.equilibrium.critical_set import CriticalSet
    from certreg.objective.isotropic import Isotropic
    from certreg.problem.problem import RegistrationProblem
    from certreg.registration.fit import Fit

DISTINGUISHABLE = 25  # twice the log-likelihood ratio of five standard deviations
NEARLY_AMBIGUOUS = (
    "A very different pose costs little more beside the range of energies: do not rely on the "
    "rotation."
)
PAIRS_IN_DOUBT = "The poor fit may have turned the answer over: do not rely on the rotation."


def equilibria_at(
    critical: CriticalSet,
    objective: Isotropic,
    problem: RegistrationProblem,
    fit: Callable[[], Fit],
) -> EquilibriumSet:
    """The equilibria at the critical rotations; where the margin is small, what the noise says.

    fit: gives that of the optimum; asked only where the noise of right pairs decides.
    """
    found = equilibrium_set(critical, objective, problem.damping)
    if not (found.narrow and rows_tested(problem)) or not _rules_out_next(problem, objective):
        return found
    doubted = any(code is not FitCode.CHI2 for code in fit().codes)
    return replace(found, next_ruled_out=not doubted, pairs_in_doubt=doubted)


def ambiguous_words(equilibria: EquilibriumSet) -> str | None:
    """Why not to rely on the rotation of a nearly ambiguous optimum; None of any other."""
    if not equilibria.nearly_ambiguous:
        return None
    return PAIRS_IN_DOUBT if equilibria.pairs_in_doubt else NEARLY_AMBIGUOUS


def narrow_words(equilibria: EquilibriumSet) -> str | None:
    """What a small margin means though the noise does not turn the answer over; None if it may."""
    if not equilibria.narrow or equilibria.nearly_ambiguous:
        return None
    best, following = equilibria.components[:2]
    away = math.degrees(following.angle_to_optimum)
    fits = ""
    if None not in (best.rmse, following.rmse):
        fits = f" (RMSE {following.rmse:.3g} instead of {best.rmse:.3g})"
    return (
        f"the margin is small: the next equilibrium, {away:.4g} degrees away, costs only "
        f"{100 * equilibria.margin.relative:.3g} % of the range of energies{fits}; noise of "
        "the size of sigma, or of the residuals where none is given, does not turn the answer "
        "over; a few wrong pairs may"
    )


def _rules_out_next(problem: RegistrationProblem, objective: Isotropic) -> bool:
    """Whether the noise of right pairs rules out that the second best equilibrium is right.

    The noise is the given sigma, or what the residuals are; False means not ruled out.
    """
    sums, degrees = FitSums(objective), problem.motion.degrees(3 * independent_rows(problem))
    least, more = sums.energy, 2 * objective.eigenvalue_difference(0, 1)
    if degrees <= 0 or least + more <= sums.rounding:
        return False
    if problem.noise_given:
        return more >= DISTINGUISHABLE * max(1, least / round(degrees))
    return log_ratio_below(float(least / (least + more)), degrees) <= math.log(LEVEL)
