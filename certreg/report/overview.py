"""The first screen of the page: which pose, how sure, how good the fit is, and what is proved."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from certreg.exact.decimals import as_given, at_least, at_most
from certreg.problem.motion import SCALE, TRANSLATION
from certreg.registration.fit import Fit, silent_tests
from certreg.registration.headlines import headline_of, headline_words, proved_degrees, share_words
from certreg.registration.misfits import FitCode
from certreg.report.fields import scale_interval
from certreg.report.lines import (
    explained_words,
    margin_words,
    number,
    percent_words,
    unit_words,
    warnings,
)
from certreg.report.parts import listed, sprung
from certreg.report.pose_facts import Fact, PoseFacts, pose_of
from certreg.report.remedies import why_warned
from certreg.report.robustness import meanwhile_words
from certreg.report.scale import BIAS, printed_interval, rests_of
from certreg.report.sentences import sentence
from certreg.report.springs import how_words, relaxation_words, springs_words
from certreg.report.uncertainty import chi2_words
from certreg.results import Absent, Optimality, present

if TYPE_CHECKING:
    from certreg.registration.result import Registration


TESTS = {
    FitCode.SCALE: "a wrong scale",
    FitCode.OUTLIER_ROWS: "outlying rows",
    FitCode.SHUFFLED: "shuffled rows",
    FitCode.MIRRORED: "a mirror image",
}
SCALED = ((SCALE, "with a free scale"),)
ALONE = ((TRANSLATION, "without a translation"),)
ABOVE = "The one above is not of the pairs' distances."
TESTED = "The test of the noise that was given raises no warning."
NOT_TESTED = "Not tested: without a noise that is given there is nothing to hold residuals against."


@dataclass(frozen=True, slots=True, kw_only=True)
class Mark:
    """A word in a colour. kind: good, open or plain, a class of the style."""

    kind: str
    words: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Overview:
    """What a reader asks for first. mark: whether the fit is warned of; tests: what was tested."""

    pose: PoseFacts
    fit: tuple[Fact, ...]
    mark: Mark
    tests: str
    proved: tuple[Fact, ...]

    @classmethod
    def of(cls, registration: Registration) -> Overview:
        """Of a registration with a certificate."""
        mark, tests = _judged(registration)
        return cls(
            pose=pose_of(registration),
            fit=tuple(_fit(registration)),
            mark=mark,
            tests=tests,
            proved=tuple(_proved(registration)),
        )


def _fit(registration: Registration) -> Iterator[Fact]:
    """How good the fit is, in numbers: the worst pair beside the median, chi-squared if tested."""
    fit, own = registration.fit, listed(registration)
    if springs := springs_words(registration):
        yield Fact(name="Springs", value=springs)
    yield Fact(name="RMSE", value=number(registration.rmse), words=_rmse_words(registration))
    if own is not None:
        yield _explained(fit)
    if (ratio := fit.largest_over_median_residual) is not None:
        median = "the median along the springs" if springs else "the median distance"
        yield Fact(name="Worst pair", value=f"{ratio:.3g} ×", words=median)
    if (chi2 := chi2_words(registration)) is not None:
        value, _, words = chi2.partition(" ")
        yield Fact(name="Chi-squared", value=value, words=words.replace("p = ", "p\u00a0=\u00a0"))


def _rmse_words(registration: Registration) -> str:
    """What the RMSE is of; and of which pose, where the printed one is not the optimum shown."""
    fit, own = registration.fit, listed(registration)
    if own is None:
        return f"along the springs, in the unit of the clouds{', at rounding' * fit.rounded}"
    unit = unit_words(fit, scaled=registration.problem.scale in BIAS)
    rounding = ", at rounding" if fit.rounded and registration.rmse != 0.0 else ""
    bounded = registration.status is Optimality.BOUNDED
    return f"in the {unit}{rounding}{', of the pose as printed' if bounded else ''}"


def _explained(fit: Fit) -> Fact:
    """How much of the target's spread; where a scale fits better, first what the pose does without.

    Of the spread the pose leaves (Sxx + Syy - 2 tr) / Syy, with Sxx / Syy = R^2 / s^2.
    """
    value, words = split(explained_words(fit))
    scale, share = fit.best_scale, fit.explained
    if FitCode.SCALE not in fit.codes or not scale or share is None:
        return Fact(name="Explained", value=value, words=f"{words}{why_warned(fit)}")
    alone = share * (2.0 - 1.0 / scale) / scale
    told = percent_words(alone) if alone > 0.0 else "nothing"
    return Fact(
        name="Explained",
        value=told,
        words=f"of the target's spread at this scale; {value} with the best one",
    )


def model_words(registration: Registration) -> str:
    """How the source may move otherwise than as a rigid body in space."""
    motion = registration.problem.motion
    return " and ".join([*motion.entries(SCALED), *motion.lacking(ALONE)])


def untested_words(registration: Registration) -> str:
    """Which tests of a fit are not made."""
    return (
        f"{model_words(registration)} no test is made for outlying rows, shuffled rows or a "
        "mirror image"
    )


def _judged(registration: Registration) -> tuple[Mark, str]:
    """Whether a fit is warned of, and by which tests; green only where nothing is, above it."""
    own = listed(registration)
    if own is None:
        return _judged_by_noise(registration)
    if own.problem.motion.options:
        return _judged_motion(own)
    fit = own.fit
    if fit.warnings:
        return warned(fit)
    tested = fit.stated("scale_p")
    if isinstance(tested, Absent):
        return Mark(kind="plain", words="not tested"), f"Not tested: {tested.reason}."
    quiet = _quiet_words(own)
    if warnings(own, headline_words(own)):
        return Mark(kind="open", words="see the warning above"), f"{quiet} {ABOVE}"
    return quiet_mark(good=headline_of(own).good), quiet


def _judged_by_noise(registration: Registration) -> tuple[Mark, str]:
    """Of general springs one test alone is made."""
    if registration.fit.warnings:
        return warned(registration.fit)
    if registration.fit.chi2 is None:
        return Mark(kind="plain", words="not tested"), NOT_TESTED
    if warnings(registration, headline_words(registration)):
        return Mark(kind="open", words="see the note above"), TESTED
    return quiet_mark(good=headline_of(registration).good), TESTED


def _judged_motion(registration: Registration) -> tuple[Mark, str]:
    """Of another motion than a rigid one a test alone is made, too; never green."""
    fit, untested = registration.fit, sentence(untested_words(registration))
    if fit.warnings:
        mark, words = warned(fit)
        return mark, f"{words} {untested}"
    tested = f"{TESTED} " if fit.chi2 is not None else ""
    if warnings(registration, headline_words(registration)):
        return Mark(kind="open", words="see the warning above"), f"{tested}{untested}"
    return Mark(kind="plain", words="no warning" if tested else "not tested"), f"{tested}{untested}"


def warned(fit: Fit) -> tuple[Mark, str]:
    """The mark and the words of a fit that is warned of."""
    count = len(fit.warnings)
    words = f"{count} warning{'s' * (count > 1)}, above"
    return Mark(kind="open", words=words), "Statistics: what is proved holds nevertheless."


def quiet_mark(*, good: bool) -> Mark:
    """Of a fit that no test warns of; green only where the headline is good."""
    return Mark(kind="good" if good else "plain", words="no warning")


def _quiet_words(registration: Registration) -> str:
    """Which tests raise no warning, and which of them could not."""
    silent = silent_tests(registration.problem, registration.solution.objective)
    *first, last = (words for code, words in TESTS.items() if code not in silent)
    quiet = f"The tests for {', '.join(first)} and {last} raise no warning."
    if not silent:
        return quiet
    those = "Those" if len(silent) > 1 else "That"
    return (
        f"{quiet} {those} for {' and '.join(TESTS[one] for one in silent)} can tell nothing here."
    )


def _proved(registration: Registration) -> Iterator[Fact]:
    """The gap and the angle; the scale; other equilibria; how far points may be off; a margin."""
    own, springs = listed(registration), sprung(registration)
    which = "the exact optimum" if registration.solution.unique_rotation else "every optimum"
    yield from bound_facts(registration, proved_degrees(registration), which)
    yield from _interval(registration)
    if how := how_words(registration):
        yield Fact(name="Proved by", value=how)
    if own is not None:
        yield _others(own)
    yield from robustness_facts(registration)
    if springs is not None:
        yield Fact(name="Relaxation", value="", words=relaxation_words(springs))
    if own is not None and own.problem.scale not in BIAS:
        value, words = split(margin_words(own.equilibria))
        yield Fact(name="Ambiguity margin", value=value, words=f"{words} (computed)")


def _interval(registration: Registration) -> Iterator[Fact]:
    """Between which numbers a free scale is."""
    if (bounds := present(scale_interval(registration))) is not None:
        low, high = printed_interval(bounds)
        words = f"at most {high}, of every optimum; both are rounded outwards"
        yield Fact(name="Scale", value=f"≥ {low}", words=words)


def _others(registration: Registration) -> Fact:
    """How many wrong poses there are at which the body can rest."""
    where = "where the springs balance and the fit is not the best"
    others, scaled = registration.equilibria.classification.spurious, rests_of(registration)
    if scaled is not None:
        others = scaled.spurious
        where = where if scaled.breathing is None else f"with a scale above 0, {where}"
    value = "infinitely many" if others is None else str(others)
    return Fact(name="Other poses at rest", value=value, words=where)


def bound_facts(registration: Registration, degrees: str | None, of: str) -> Iterator[Fact]:
    """The proved gap, and how far at most the rotation is from an optimum."""
    bounds = registration.bounds
    if bounds is not None:
        yield Fact(
            name="Gap",
            value=f"≤ {at_most(bounds.greatest_gap)}",
            words=f"of the objective above the global minimum: {share_words(bounds)}",
        )
    if degrees is not None:
        yield Fact(
            name="Rotation",
            value=f"within {degrees}°",
            words=f"of {of}; the noise of the data is not counted",
        )


def robustness_facts(registration: Registration) -> Iterator[Fact]:
    """The same as a fact of the first screen; none where nothing is proved."""
    found = registration.robustness
    if found is not None:
        yield Fact(
            name="Robustness",
            value=at_least(found.target),
            words=f"by less than this every target point may be off, and every optimum stays "
            f"within {as_given(found.angle)}° of the certified rotation; points of both clouds by "
            f"less than {at_least(found.both)} (sufficient, not sharp)"
            f"{meanwhile_words(found)}",
        )


def split(words: str) -> tuple[str, str]:
    """The figure that words begin with, and the rest.

    >>> split("12 % of the range: far")
    ('12 %', 'of the range: far')
    """
    value, _, rest = words.partition(": ")
    figure, percent, unit = value.partition(" % ")
    return f"{figure}{' %' if percent else ''}", f"{unit}{': ' if unit and rest else ''}{rest}"
