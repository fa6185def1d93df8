"""The first screen of the page of general springs: the pose, the fit, and what is proved."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.registration import (
    at_most,
    share_words,
    spring_degrees,
    spring_headline_of,
    spring_headline_words,
)
from certreg.report.overview import (
    BASIS,
    NO_PROOF,
    Fact,
    Mark,
    Overview,
    PoseFacts,
    aligned,
    axis_facts,
    robustness_facts,
    rotation_fact,
    translation_fact,
)
from certreg.report.spring_summary import HOW, relaxation_words, spring_warnings, springs_words
from certreg.report.summary import number
from certreg.report.uncertainty import (
    chi2_words,
    rotation_words,
    shift_words,
    two_digits,
    uncertainty_rows,
)
from certreg.report.words import motion_words

if TYPE_CHECKING:
    from collections.abc import Iterator

    from certreg.registration import SpringRegistration

WHOSE = "Rotation: about the source's axes. Centre: the source's mean, along its least sure axis."
TESTED = "The test of the noise that was given raises no warning."
NOT_TESTED = "Not tested: without a noise that is given there is nothing to hold residuals against."


def spring_overview(registration: SpringRegistration) -> Overview:
    """Of a registration with a certificate."""
    mark, tests = _judged(registration)
    return Overview(
        pose=_pose(registration),
        fit=tuple(_fit(registration)),
        mark=mark,
        tests=tests,
        proved=tuple(_proved(registration)),
    )


def _pose(registration: SpringRegistration) -> PoseFacts:
    pose, covariance = registration.pose, registration.covariance
    exact, sure = pose.T_target_source.tolist(), dict(uncertainty_rows(registration))
    told = covariance if BASIS in sure else None
    facts = [rotation_fact(pose, told), *axis_facts(pose)]
    if told is not None:
        facts.append(Fact(name="Rotation ±", value="", words=rotation_words(told, "")))
        facts.append(Fact(name="Centre ±", value="", words=two_digits([told.centre_sigma])))
    facts.append(translation_fact(pose, told))
    if told is not None:
        facts.append(Fact(name="Translation ±", value="", words=shift_words(told, "")))
    basis = f"± is {sure[BASIS]}. {WHOSE} {NO_PROOF}" if told is not None else ""
    return PoseFacts(
        rows=aligned(exact),
        facts=tuple(facts),
        uncertainty=basis or f"Uncertainty {sure['uncertainty']}.",
        matrix="\n".join(" ".join(map(repr, row)) for row in exact),
        quaternion=" ".join(map(repr, pose.quaternion_wxyz.tolist())),
        motion=motion_words(registration),
    )


def _fit(registration: SpringRegistration) -> Iterator[Fact]:
    fit = registration.fit
    yield Fact(name="Springs", value=springs_words(registration))
    rounding = ", at rounding" if fit.rounded else ""
    words = f"along the springs, in the unit of the clouds{rounding}"
    yield Fact(name="RMSE", value=number(registration.rmse), words=words)
    if fit.largest_over_median_residual is not None:
        ratio = f"{fit.largest_over_median_residual:.3g}"
        yield Fact(name="Worst pair", value=f"{ratio} ×", words="the median along the springs")
    chi2 = chi2_words(registration)
    if chi2 is not None:
        value, _, words = chi2.partition(" ")
        yield Fact(name="Chi-squared", value=value, words=words.replace("p = ", "p\u00a0=\u00a0"))


def _judged(registration: SpringRegistration) -> tuple[Mark, str]:
    """Whether a fit is warned of; of general springs one test alone is made."""
    count = len(registration.fit.warnings)
    if count:
        words = f"{count} warning{'s' * (count > 1)}, above"
        return Mark(kind="open", words=words), "Statistics: what is proved holds nevertheless."
    if registration.fit.chi2 is None:
        return Mark(kind="plain", words="not tested"), NOT_TESTED
    if spring_warnings(registration, spring_headline_words(registration)):
        return Mark(kind="open", words="see the note above"), TESTED
    good = spring_headline_of(registration).good
    return Mark(kind="good" if good else "plain", words="no warning"), TESTED


def _proved(registration: SpringRegistration) -> Iterator[Fact]:
    solution, bounds = registration.solution, registration.bounds
    if bounds is not None:
        yield Fact(
            name="Gap",
            value=f"≤ {at_most(bounds.greatest_gap)}",
            words=f"of the objective above the global minimum: {share_words(bounds)}",
        )
    degrees = spring_degrees(registration)
    if degrees is not None:
        which = "the exact optimum" if solution.unique_rotation else "every optimum"
        yield Fact(
            name="Rotation",
            value=f"within {degrees}°",
            words=f"of {which}; the noise of the data is not counted",
        )
    if solution.method is not None:
        yield Fact(name="Proved by", value=HOW[solution.method])
    yield from robustness_facts(registration)
    yield Fact(name="Relaxation", value="", words=relaxation_words(registration))
