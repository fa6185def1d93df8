"""What the optimum of general springs is worth as a fit: statistics, nothing of it is proved."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from certreg.exact.dyadic import nearest_double
from certreg.registration.covariance import NO_FREEDOM
from certreg.registration.fit import NO_NOISE, ROUNDED, ZERO_MEDIAN, Fit, FitRow
from certreg.registration.misfits import ChiSquared, FitCode, FitWarning, chi2_remedy, chi2_words
from certreg.registration.outlying import LISTED, ROUNDING
from certreg.registration.tails import log_chi2_above
from certreg.results import OUT_OF_RANGE, Absent, present

if TYPE_CHECKING:
    from fractions import Fraction

    from certreg.problem.problem import RegistrationProblem
    from certreg.registration.row_names import RowNames
    from certreg.registration.spring_rows import ResidualSums

UNTESTED = Absent("scale and share of the spread are told of springs alike in every way alone")


def spring_fit(
    problem: RegistrationProblem,
    sums: ResidualSums,
    *,
    least: Fraction,
    determined: bool,
    names: RowNames,
) -> Fit:
    """Of the optimum of a problem; least: the objective there. determined: no turn is left open."""
    chi2 = _chi2(problem, least, determined=determined)
    ratio: float | Absent = ZERO_MEDIAN
    if rounded(problem, sums):
        ratio = ROUNDED
    elif sums.median and sums.worst:
        ratio = sums.worst[0].distance / sums.median
    text = chi2_words(present(chi2))
    warnings = ()
    if text is not None and not isinstance(chi2, Absent):
        warned = FitWarning(code=FitCode.CHI2, text=text, remedy=chi2_remedy(chi2))
        warnings = (warned,) * (ratio is not ROUNDED)
    return Fit(
        explained=None,
        best_scale=None,
        scale_p=None,
        largest_over_median_residual=present(ratio),
        worst=tuple(
            FitRow(row=one.row, label=names.label(one.row), residual=one.distance)
            for one in sums.worst[:LISTED]
        ),
        chi2=present(chi2),
        outlier_rows=(),
        warnings=warnings,
        untested=None,
        absent={
            **dict.fromkeys(("explained", "best_scale", "scale_p"), UNTESTED),
            **({"chi2": chi2} if isinstance(chi2, Absent) else {}),
            **({"largest_over_median_residual": ratio} if isinstance(ratio, Absent) else {}),
        },
    )


def rounded(problem: RegistrationProblem, sums: ResidualSums) -> bool:
    """Whether all pairs are off by no more than the rounding of the clouds' numbers."""
    largest = max(abs(float(array.min())) for array in (problem.source, problem.target))
    largest = max(largest, *(abs(float(array.max())) for array in (problem.source, problem.target)))
    worst = sums.worst[0].distance if sums.worst else 0.0
    return worst <= ROUNDING * largest


def _chi2(
    problem: RegistrationProblem, least: Fraction, *, determined: bool
) -> ChiSquared | Absent:
    """The test of a given noise; of a turn that is left open no parameter is counted."""
    if not problem.noise_given:
        return NO_NOISE
    value = nearest_double(least)
    degrees = problem.degrees_of_freedom if determined else problem.observations
    if degrees <= 0:
        return NO_FREEDOM
    if value is None:
        return OUT_OF_RANGE
    p = math.exp(log_chi2_above(value, degrees))
    return ChiSquared(value=value, dof=degrees, p=p, bound=not determined)
