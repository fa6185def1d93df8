"""How sure a pose is, in words: what +/- is of, where it comes from, and where there is none.

Statistics, to first order in the noise: nothing of it is proved. The law: `covariance` of the
derivations.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from certreg.exact.decimals import as_given, at_most
from certreg.exact.dyadic import nearest_or_zero, nearest_root, sigma_of_weight
from certreg.problem.motion import ROTATION, SCALE, TRANSLATION, Unknown
from certreg.registration.covariance import NO_RESIDUALS, PoseCovariance
from certreg.registration.loose_turns import axis_words, beyond_first_order
from certreg.registration.misfits import FitCode
from certreg.results import Absent

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.geometry.pose import Pose
    from certreg.geometry.similarity import Similarity
    from certreg.registration.fit import Fit
    from certreg.registration.result import Registration


T = TypeVar("T")
Row = Callable[[Any, PoseCovariance], str]  # of a registration and its covariance
FINE = math.radians(0.01)  # below it arc seconds: 36 of them
FIRST_ORDER = 0.2  # radians, 11 degrees: turns scatter 2 % more there, 4 to 8 % at 0.3, measured;
# and of a translation's deviation: a second order of that share adds 2 % to it, too
SURE_SIGMA = 1e-6  # of chi-squared: so seldom is it so small, as large ones are warned of
MOST_DECIMALS, PLAIN_BELOW = 12, 1e15  # of a number without an exponent
MOST_DIGITS = 16  # and more: all that the double has
OF_TURN = "a small turn about the source's axes"
OF_ORIGIN = "of the source's origin, along the target's axes"
SWUNG = Absent("the turn swings the source's origin too far for a first order")
WARNED = "the fit may hold more than noise (see the warning), and ± would be of noise alone"
TOO_LARGE = "the residuals are larger than sigma says (see the warning), and ± would be of sigma"


def uncertainty_rows(registration: Registration) -> list[tuple[str, str]]:
    """Names and words: the centre, rotation, translation, what ± is, and the test of a given sigma.

    Of a free scale its own; of a problem without a translation neither it nor the centre.

    The centre first: its deviation is that of the points, while the translation is where the
    source's origin goes, which in map coordinates lies far from them. Where there is no uncertainty
    to tell: one row that says why.
    """
    covariance, chi2 = told_covariance(registration), chi2_words(registration)
    tested = [] if chi2 is None else [("chi-squared", chi2)]
    if isinstance(covariance, Absent):
        return [("uncertainty", known(covariance, str)), *tested]
    rows = registration.problem.motion.entries(ROWS)
    return [
        *((f"{name} ±", words(registration, covariance)) for name, words in rows),
        ("± is", _basis_words(registration, covariance)),
        *tested,
    ]


def known(value: T | Absent, words: Callable[[T], str]) -> str:
    """A value in words, or why it is not known."""
    return f"not known: {value.reason}" if isinstance(value, Absent) else words(value)


def _centre_row(registration: Registration, covariance: PoseCovariance) -> str:
    """How sure the place of the source's centre is; on springs not alike along every axis."""
    if registration.problem.springs is not None:
        sigma = _two_digits(covariance.stated("centre_sigma"))
        return f"{sigma} along the axis that is least sure  (the source's mean)"
    centre = " ".join(centre_words(registration, covariance))
    return f"{sigma_words(covariance)}  (the centre of the source lands at {centre})"


ROWS: tuple[tuple[Unknown, tuple[str, Row]], ...] = (  # by what is found
    (TRANSLATION, ("centre", _centre_row)),
    (SCALE, ("scale", lambda of, sure: scale_words(of.pose, sure.stated("scale_sigma")))),
    (ROTATION, ("rotation", lambda _, sure: rotation_words(sure, f"  ({OF_TURN})"))),
    (TRANSLATION, ("translation", lambda _, sure: shift_words(sure, f"  ({OF_ORIGIN})"))),
)


def scale_words(pose: Pose | Similarity, sigma: float) -> str:
    """The deviation of a scale, and its share of the scale."""
    share = f"  ({_two_digits(100.0 * sigma / pose.scale)} % of it)" if pose.scale else ""
    return f"{_two_digits(sigma)}{share}"


def sigma_words(covariance: PoseCovariance) -> str:
    """The deviation of the centre."""
    return f"{_two_digits(covariance.stated('centre_sigma'))} along every axis"


def centre_words(registration: Registration, covariance: PoseCovariance) -> list[str]:
    """Where the weighted mean of the source goes, that of the target, as its deviation allows."""
    centre = map(nearest_or_zero, registration.solution.moments.target_centroid)
    return [told_to(entry, covariance.stated("centre_sigma")) for entry in centre]


def told_to(value: float, sigma: float) -> str:
    """A value with the decimals that its standard deviation leaves.

    >>> told_to(999.80268, 0.1934), told_to(-1e-9, 0.02), told_to(1234.5, 0.0)
    ('999.80', '0.000', '1234.5')
    >>> told_to(-999999999999.648, 0.0022), told_to(1.03599e150, 2.2e147), told_to(1e-300, 2e-302)
    ('-999999999999.648', '1.0360e+150', '1.000e-300')
    """
    if not 0.0 < sigma < math.inf:
        return f"{value:.6g}"
    decimals = 1 - math.floor(math.log10(sigma))
    digits = decimals + 1 + (math.floor(math.log10(abs(value))) if value else 0)
    if value and digits >= MOST_DIGITS:
        return repr(value)
    if decimals < 0 and digits < 1:
        return f"{value:.1g}"  # no value is rounded to zero but behind the point
    if abs(value) < PLAIN_BELOW and decimals <= MOST_DECIMALS:
        decimals = max(0, decimals)
        return f"{round(value, decimals) + 0.0:.{decimals}f}"
    return f"{value:.{max(0, digits - 1)}e}" if value else "0"


def covariance_of(registration: Registration) -> PoseCovariance | Absent:
    """The covariance where there is noise to tell it from."""
    covariance = registration.stated("covariance")
    if isinstance(covariance, Absent):
        return covariance
    return NO_RESIDUALS if covariance.estimated and registration.fit.rounded else covariance


def told_covariance(registration: Registration) -> PoseCovariance | Absent:
    """The covariance that ± is of, or why none is told."""
    doubt = more_than_noise(registration.fit)
    covariance = covariance_of(registration)
    return covariance if doubt is None or isinstance(covariance, Absent) else Absent(doubt)


def more_than_noise(fit: Fit) -> str | None:
    """Why ± would say too little of a pose whose fit is warned of; None where it is not."""
    if not fit.warnings:
        return None
    return TOO_LARGE if fit.codes == (FitCode.CHI2,) else WARNED


def rotation_words(covariance: PoseCovariance, axes: str) -> str:
    """Three standard deviations of a small turn, its axes, and a word where it is not small."""
    sigma = turn_sigmas(covariance)
    if isinstance(sigma, Absent):
        return known(sigma, str)
    fine = float(sigma.max()) < FINE
    unit, factor = ("arc seconds", 3600.0) if fine else ("degrees", 1.0)
    told = f"{two_digits(np.degrees(sigma) * factor)} {unit}{axes}"
    if covariance.loosest_sigma < FIRST_ORDER:
        return told
    about = axis_words(covariance.loosest_axis)
    return f"{told}; a rough figure: a turn so large, about {about}, is beyond a first order"


def shift_words(covariance: PoseCovariance, whose: str) -> str:
    """Three standard deviations of the translation, or why there are none."""
    return known(shift_sigmas(covariance), lambda sigma: f"{two_digits(sigma)}{whose}")


def turn_sigmas(covariance: PoseCovariance) -> NDArray[np.float64] | Absent:
    """The deviations of the turn, as far as a first order says anything of it."""
    doubt = beyond_first_order(covariance)
    return covariance.rotation_sigma if doubt is None else doubt


def shift_sigmas(covariance: PoseCovariance) -> NDArray[np.float64] | Absent:
    """Those of the translation, as far: a large turn swings the origin about the centre."""
    turned = turn_sigmas(covariance)
    if isinstance(turned, Absent):
        return turned
    return covariance.translation_sigma if covariance.second_order < FIRST_ORDER else SWUNG


def chi2_words(registration: Registration) -> str | None:
    """The sum of squared residuals over sigma, and how likely so large a one is; None without."""
    chi2 = registration.fit.chi2
    if chi2 is None:
        return None
    judged = ""
    if FitCode.CHI2 in registration.fit.codes:
        judged = ": the residuals are larger than sigma says"
    elif chi2.p > 1 - SURE_SIGMA and not chi2.bound:
        judged = ": the residuals are smaller than sigma says"
    if chi2.bound:
        return (
            f"{chi2.value:.4g} with {chi2.dof} degrees of freedom at most (sigma leaves a turn "
            f"open), p at most {at_most(chi2.p, 2) if chi2.p else '1e-300'}{judged}"
        )
    p = f"= {chi2.p:.2g}" if chi2.p else "< 1e-300"
    return f"{chi2.value:.4g} with {chi2.dof} degrees of freedom, p {p}{judged}"


def two_digits(values: NDArray[np.float64] | list[float]) -> str:
    """Numbers in two significant digits, blanks between them, few with exponents."""
    return " ".join(map(_two_digits, values))


def _two_digits(value: float) -> str:
    if not 1e-4 <= value < 1e6:
        return f"{value:.1e}" if value else "0"
    return f"{value:.{max(0, 1 - math.floor(math.log10(value)))}f}"


def _basis_words(registration: Registration, covariance: PoseCovariance) -> str:
    """What one standard deviation is of: the sigma that is given, or what the residuals say."""
    told = "one standard deviation, to first order, "
    problem = registration.problem
    springs = problem.springs is not None
    if not covariance.estimated and springs:
        return f"{told}of independent errors as large along the springs as these say"
    if not covariance.estimated:
        return f"{told}of independent errors of the sigma given{_given_words(registration)}"
    degrees = covariance.degrees_of_freedom
    percent = 100.0 / math.sqrt(2.0 * degrees)
    sure = f"± {percent:{'.0f' if percent >= 1.0 else '.1g'}} %, {degrees} degrees of freedom"
    if springs:
        factor = _two_digits(math.sqrt(covariance.variance_factor or 0.0))
        assumed = "if errors are independent, Gaussian, as large along the springs as these say"
        return f"{told}from the residuals: {factor} times the unit of the springs {sure}, {assumed}"
    sigma = _two_digits(_sigma_of(registration, covariance))
    mean = "" if problem.equally_weighted else " at the mean weight"
    size = "of one size" if problem.equally_weighted else "as large as the weights say"
    assumed = f"if errors are independent, Gaussian, {size}"
    return f"{told}from the residuals: sigma {sigma}{mean} {sure}, {assumed}"


def _sigma_of(registration: Registration, covariance: PoseCovariance) -> float:
    """The standard deviation of a coordinate at the mean weight."""
    objective, points = registration.solution.objective, registration.problem.observations // 3
    variance = objective.energy(objective.optimum) / covariance.degrees_of_freedom
    return nearest_root(variance * points / objective.moments.total_weight) or 0.0


def _given_words(registration: Registration) -> str:
    """The value of the sigma that was given, from its weight; empty where there are several."""
    problem = registration.problem
    if not problem.equally_weighted:
        return ""
    weight = float(problem.weights[0])
    return f": {as_given(sigma_of_weight(weight) or weight**-0.5)}"
