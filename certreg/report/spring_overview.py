"""The first screen of the page of general springs: the pose, the fit, and what is proved."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.registration.headlines import headline_of, headline_words, proved_degrees
from certreg.report.lines import number
from certreg.report.overview import (
    BASIS,
    WHOSE_TURN,
    Fact,
    Mark,
    Overview,
    PoseFacts,
    axis_facts,
    basis_words,
    bound_facts,
    fit_facts,
    pose_facts,
    quiet_mark,
    robustness_facts,
    rotation_fact,
    translation_fact,
    warned,
)
from certreg.report.spring_summary import (
    how_words,
    relaxation_words,
    spring_warnings,
    springs_words,
)
from certreg.report.uncertainty import rotation_words, shift_words, two_digits, uncertainty_rows

if TYPE_CHECKING:
    from collections.abc import Iterator

    from certreg.registration.quartic import QuarticSolution
    from certreg.registration.result import Registration


CENTRE = " Centre: the source's mean, along its least sure axis."
TESTED = "The test of the noise that was given raises no warning."
NOT_TESTED = "Not tested: without a noise that is given there is nothing to hold residuals against."


def spring_overview(registration: Registration[QuarticSolution]) -> Overview:
    """Of a registration with a certificate."""
    mark, tests = _judged(registration)
    return Overview(
        pose=_pose(registration),
        fit=tuple(_fit(registration)),
        mark=mark,
        tests=tests,
        proved=tuple(_proved(registration)),
    )


def _pose(registration: Registration[QuarticSolution]) -> PoseFacts:
    pose, covariance = registration.pose, registration.covariance
    sure = dict(uncertainty_rows(registration))
    told = covariance if BASIS in sure else None
    moves = registration.problem.motion.translations > 0
    facts = [rotation_fact(pose, told), *axis_facts(pose)]
    if told is not None:
        facts.append(Fact(name="Rotation ±", value="", words=rotation_words(told, "")))
    if told is not None and moves:
        facts.append(Fact(name="Centre ±", value="", words=two_digits([told.centre_sigma])))
    if moves:
        facts.append(translation_fact(pose, told))
    if told is not None and moves:
        facts.append(Fact(name="Translation ±", value="", words=shift_words(told, "")))
    return pose_facts(registration, facts, basis_words(registration, WHOSE_TURN + CENTRE * moves))


def _fit(registration: Registration[QuarticSolution]) -> Iterator[Fact]:
    fit = registration.fit
    yield Fact(name="Springs", value=springs_words(registration))
    rounding = ", at rounding" if fit.rounded else ""
    words = f"along the springs, in the unit of the clouds{rounding}"
    yield Fact(name="RMSE", value=number(registration.rmse), words=words)
    yield from fit_facts(registration, "the median along the springs")


def _judged(registration: Registration[QuarticSolution]) -> tuple[Mark, str]:
    """Whether a fit is warned of; of general springs one test alone is made."""
    if registration.fit.warnings:
        return warned(registration.fit)
    if registration.fit.chi2 is None:
        return Mark(kind="plain", words="not tested"), NOT_TESTED
    if spring_warnings(registration, headline_words(registration)):
        return Mark(kind="open", words="see the note above"), TESTED
    return quiet_mark(good=headline_of(registration).good), TESTED


def _proved(registration: Registration[QuarticSolution]) -> Iterator[Fact]:
    solution = registration.solution
    which = "the exact optimum" if solution.unique_rotation else "every optimum"
    yield from bound_facts(registration, proved_degrees(registration), which)
    if how := how_words(registration):
        yield Fact(name="Proved by", value=how)
    yield from robustness_facts(registration)
    yield Fact(name="Relaxation", value="", words=relaxation_words(registration))
