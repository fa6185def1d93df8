"""What a fit is worth: how much it explains, and whether the pairs are what they should be.

Sums come from the exact moments, rounded once; what no sum holds, from one look at the rows. The
warnings and their rates: `certreg.registration.misfits`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from certreg.exact.dyadic import nearest_double, power_of_two
from certreg.geometry.so3 import squared_norm
from certreg.problem.motion import TRANSLATION, Scale
from certreg.registration.covariance import NO_FREEDOM, PoseCovariance, Residual, worst_residuals
from certreg.registration.loose_turns import LOOSE_SIGMA, beyond_first_order
from certreg.registration.misfits import (
    LEVEL,
    MIRROR_EXPLAINED,
    MOST_LEFT,
    ROUNDING,
    ChiSquared,
    FitCode,
    FitSums,
    FitWarning,
    chi2_remedy,
    chi2_words,
    log_scale_p,
    misfits,
)
from certreg.registration.outlying import LISTED, RowFit, independent_rows, row_fit
from certreg.registration.row_names import RowNames
from certreg.registration.tail_probabilities import log_chi2_above, log_ratio_below
from certreg.results import OUT_OF_RANGE, Absent, Explained, present

if TYPE_CHECKING:
    from certreg.geometry.pose import Pose
    from certreg.geometry.similarity import Similarity
    from certreg.objective.isotropic import Isotropic
    from certreg.problem.problem import RegistrationProblem
    from certreg.registration.whitened_residuals import ResidualSums


COINCIDENT = Absent("all points with weight of a cloud coincide: there is nothing to explain")
NO_SOURCE = Absent("all source points with weight coincide: no scale changes anything")
TOO_FEW = Absent("fewer than three points carry the weight: no degree of freedom is left")
ZERO_MEDIAN = Absent("at least half of the residuals are zero")
ROUNDED = Absent("the residuals are at rounding: there is nothing to test")
NO_NOISE = Absent("no noise was given: the residuals are compared with nothing")
UNTESTED = Absent("with a free scale, or without a translation, no rows and no scale are tested")
OF_SPRINGS = Absent("scale and share of the spread are told of springs alike in every way alone")
NOT_LOOKED_FOR = (
    "not tested for wrong rows, another order of the rows, or a mirror image: only fits of scale 1 "
    "with a translation are"
)
NO_CHI2 = {  # by the scale
    Scale.SYMMETRIC: Absent(
        "the symmetric scale is not the one of the least squares, which are tested"
    )
}
SURE = ((TRANSLATION, TRANSLATION.count),)  # what counts whatever the turn and the scale take
UNNAMED = RowNames(None)
LEAST_ROWS = 3  # with 3 n - 6 > 0 degrees of freedom there are more


@dataclass(frozen=True, slots=True, kw_only=True)
class FitRow:
    """A correspondence: its row, counted from 0, its label if it has one, and |y - R x - t|."""

    row: int
    label: str | None
    residual: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Fit(Explained):
    """What a fit is worth; what is None has its reason in `absent`.

    explained: R^2 = (tr R^T C)^2 / (Sxx Syy), of the best scale; from 0 to 1.
    best_scale: s that minimises sum w |y - s R x - t|^2, target over source.
    scale_p: of a scale other than one, by Student's test with 3 n - 7 degrees of freedom; for n see
        `certreg.registration.misfits`.
    largest_over_median_residual: of the rows with weight; the median of a sample of 4,096 of them
        where there are more.
    worst: the largest residuals, at most ten, largest first.
    chi2: None without sigma.
    outlier_rows: those that a warning names, the worst first, at most ten.
    warnings: none for a good fit.
    untested: which tests there are not, of a free scale or without a translation; else None.
    """

    explained: float | None
    best_scale: float | None
    scale_p: float | None
    largest_over_median_residual: float | None
    worst: tuple[FitRow, ...]
    chi2: ChiSquared | None
    outlier_rows: tuple[int, ...]
    warnings: tuple[FitWarning, ...]
    untested: str | None

    @property
    def rounded(self) -> bool:
        """Whether the residuals are what rounding the points leaves: they measure no noise."""
        return self.stated("largest_over_median_residual") == ROUNDED

    @property
    def codes(self) -> tuple[FitCode, ...]:
        """Of the warnings."""
        return tuple(warning.code for warning in self.warnings)


def rows_tested(problem: RegistrationProblem) -> bool:
    """Whether there are tests for wrong rows: of a rigid motion alone."""
    return problem.motion.rigid


def fit_of(
    problem: RegistrationProblem,
    objective: Isotropic,
    pose: Pose | Similarity,
    covariance: PoseCovariance | Absent,
    *,
    names: RowNames = UNNAMED,
) -> Fit:
    """What the optimum of a problem is worth as a fit; names: of its rows.

    pose: the optimum in doubles, as it is reported. covariance: its own.
    """
    sums = FitSums(objective)
    chi2 = _chi2(problem, sums, covariance)
    values: dict[str, float | Absent] = {
        "explained": COINCIDENT if sums.explained is None else _double(sums.explained),
        "best_scale": NO_SOURCE if sums.scale is None else _double(sums.scale),
    }
    if not rows_tested(problem):  # only the size is, by a given sigma
        values["scale_p"] = UNTESTED
        values["largest_over_median_residual"] = ROUNDED if _at_rounding(sums) else UNTESTED
        worst = worst_residuals(problem, pose, LISTED)
        return _fit(values, chi2, worst, names, _of_size(chi2), untested=NOT_LOOKED_FOR)
    rows = row_fit(problem, objective, pose)
    ratio = OUT_OF_RANGE if rows is None else rows.largest_over_median or ZERO_MEDIAN
    values["scale_p"] = _scale_p(sums, rows)
    values["largest_over_median_residual"] = ROUNDED if sums.rounded else ratio
    if rows is None:
        return _fit(values, chi2, (), names, ())
    warnings = () if sums.rounded else misfits(sums, rows, present(chi2), names)
    outlying = any(one.code is FitCode.OUTLIER_ROWS for one in warnings)
    far = rows.far if outlying and not rows.tied else ()
    return _fit(values, chi2, rows.worst, names, warnings, outlier_rows=far)


def _fit(
    values: dict[str, float | Absent],
    chi2: ChiSquared | Absent,
    worst: Sequence[Residual],
    names: RowNames,
    warnings: tuple[FitWarning, ...],
    **others: Any,
) -> Fit:
    """A fit of its values, or of why there are none."""
    told: dict[str, Any] = {**values, "chi2": chi2}
    rest: dict[str, Any] = {"outlier_rows": (), "untested": None, **others}
    return Fit(
        **{name: present(value) for name, value in told.items()},
        worst=tuple(
            FitRow(row=one.row, label=names.label(one.row), residual=one.distance) for one in worst
        ),
        warnings=warnings,
        **rest,
        absent={name: value for name, value in told.items() if isinstance(value, Absent)},
    )


def _of_size(chi2: ChiSquared | Absent) -> tuple[FitWarning, ...]:
    """What the test of a given sigma warns of."""
    words = chi2_words(present(chi2))
    if words is None or isinstance(chi2, Absent):
        return ()
    return (FitWarning(code=FitCode.CHI2, text=words, remedy=chi2_remedy(chi2)),)


def spring_fit(
    problem: RegistrationProblem,
    sums: ResidualSums,
    *,
    least: Fraction,
    determined: bool,
    names: RowNames,
) -> Fit:
    """Of general springs; least: the objective at the optimum. determined: no turn is left open."""
    ratio: float | Absent = ZERO_MEDIAN
    if rounded(problem, sums):
        ratio = ROUNDED
    elif sums.median and sums.worst:
        ratio = sums.worst[0].distance / sums.median
    values: dict[str, float | Absent] = {
        **dict.fromkeys(("explained", "best_scale", "scale_p"), OF_SPRINGS),
        "largest_over_median_residual": ratio,
    }
    degrees = problem.degrees_of_freedom if determined else problem.observations
    chi2: ChiSquared | Absent = NO_NOISE
    if problem.noise_given:
        free = degrees > 0
        chi2 = _tested(least, degrees, bound=not determined) if free else NO_FREEDOM
    warnings = () if ratio is ROUNDED else _of_size(chi2)
    return _fit(values, chi2, sums.worst[:LISTED], names, warnings)


def rounded(problem: RegistrationProblem, sums: ResidualSums) -> bool:
    """Whether all pairs are off by no more than the rounding of the clouds' numbers."""
    clouds = problem.source, problem.target
    largest = max(abs(float(end)) for array in clouds for end in (array.min(), array.max()))
    worst = sums.worst[0].distance if sums.worst else 0.0
    return worst <= ROUNDING * largest


def _tested(least: Fraction, degrees: int, *, bound: bool) -> ChiSquared | Absent:
    """The test of a given noise, with degrees of freedom; bound: whether these may be fewer."""
    value = nearest_double(least)
    if value is None:
        return OUT_OF_RANGE
    p = math.exp(log_chi2_above(value, degrees))
    return ChiSquared(value=value, dof=degrees, p=p, bound=bound)


def _least(sums: FitSums) -> Fraction:
    """The least sum w |y - s R x - t|^2, over s too where it is free."""
    scaling, alignment = sums.objective.scaling, sums.alignment
    return sums.energy if scaling is None else scaling.energy(alignment)


def _at_rounding(sums: FitSums) -> bool:
    """Whether the residuals are at rounding, `FitSums.rounded` with the source at its scale."""
    objective = sums.objective
    moments, scale = objective.moments, objective.best_scale(objective.optimum)
    here, there = squared_norm(moments.source_sum), squared_norm(moments.target_sum)
    offset = scale**2 * here * power_of_two(2 * moments.source_exponent)
    offset += there * power_of_two(2 * moments.target_exponent)
    offset *= power_of_two(moments.weight_exponent) / moments.mass
    spread = sums.target + _scaled_source(sums)
    return _least(sums) <= Fraction(ROUNDING) ** 2 * spread + power_of_two(-102) * offset


def silent_tests(problem: RegistrationProblem, objective: Isotropic) -> tuple[FitCode, ...]:
    """The tests that could not warn here, of a fit whose scale is tested.

    Without one of three rows no degree of freedom is left; and where a rotation and a reflection
    fit about as well, as flat clouds, neither is told from the other.
    """
    sums, rows = FitSums(objective), independent_rows(problem)
    share = sums.mirrored_share
    left = float(min(share, 1 / share)) if share else 0.0
    best = max(sums.explained or 0, sums.mirrored_explained or 0)
    told = left <= MOST_LEFT and best >= MIRROR_EXPLAINED
    degrees = problem.motion.degrees(3 * rows)
    told = told and log_ratio_below(left, degrees) <= math.log(LEVEL)
    silent = {FitCode.OUTLIER_ROWS: rows <= LEAST_ROWS, FitCode.MIRRORED: not told}
    return tuple(code for code, is_silent in silent.items() if is_silent)


def _scale_p(sums: FitSums, rows: RowFit | None) -> float | Absent:
    if sums.source == 0:
        return NO_SOURCE
    if rows is None:
        return OUT_OF_RANGE
    log_p = log_scale_p(sums, rows)
    if log_p is not None:
        return math.exp(log_p)
    if sums.explained is None:
        return COINCIDENT
    return ROUNDED if sums.rounded else TOO_FEW


def _chi2(
    problem: RegistrationProblem,
    sums: FitSums,
    covariance: PoseCovariance | Absent,
) -> ChiSquared | Absent:
    """The test of a given sigma; of a turn that sigma leaves open, no parameter is counted.

    The least of E is at most E at the true rotation and scale with the best translation, which has
    3 n - 3 degrees of freedom, 3 n without a translation: with these p is a bound, whatever the
    turn and the scale take.
    """
    if not problem.noise_given:
        return NO_NOISE
    if (untested := NO_CHI2.get(problem.scale)) is not None:
        return untested
    least = _least(sums)
    if nearest_double(least) is None:
        return OUT_OF_RANGE
    if isinstance(covariance, Absent):  # of a line, which turns by 1 / (s sqrt(Sxx))
        across = _scaled_source(sums)
        loose = sums.free_turns == 1 and across * Fraction(LOOSE_SIGMA) ** 2 < 1
    else:
        loose = beyond_first_order(covariance) is not None
    motion = problem.motion
    found = sum(motion.entries(SURE)) if loose else motion.parameters - sums.free_turns
    dof = problem.observations - found
    return TOO_FEW if dof <= 0 else _tested(least, dof, bound=loose)


def _scaled_source(sums: FitSums) -> Fraction:
    """s^2 Sxx at the best scale."""
    objective = sums.objective
    return objective.best_scale(objective.optimum) ** 2 * sums.source


def _double(value: Fraction) -> float | Absent:
    nearest = nearest_double(value)
    return OUT_OF_RANGE if nearest is None else nearest
