"""The first screen of the page: which pose, how sure, how good the fit is, and what is proved."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from certreg.exact.decimals import as_given, at_least, at_most
from certreg.geometry.similarity import Similarity
from certreg.registration.fit import silent_tests
from certreg.registration.headlines import headline_of, headline_words, proved_degrees, share_words
from certreg.registration.misfits import FitCode
from certreg.report.lines import (
    explained_words,
    margin_words,
    number,
    percent_words,
    unit_words,
    warnings,
)
from certreg.report.pose_words import motion_words, turn_of
from certreg.report.remedies import why_warned
from certreg.report.robustness import meanwhile_words
from certreg.report.uncertainty import (
    centre_words,
    chi2_words,
    rotation_words,
    scale_words,
    shift_sigmas,
    shift_words,
    sigma_words,
    told_to,
    turn_sigmas,
    uncertainty_rows,
)
from certreg.results import Absent, Optimality

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from certreg.geometry.pose import Pose
    from certreg.registration.covariance import PoseCovariance
    from certreg.registration.fit import Fit
    from certreg.registration.result import Registration


WIDE = 1e9  # larger translations are written with an exponent
BASIS = "± is"  # the row that says where the deviations come from
WHOSE_TURN = "Rotation: about the source's axes."
WHOSE = f"{WHOSE_TURN} Centre: where the source's mean goes."
SAME = "not known, as that of the rotation"
NO_PROOF = "Statistics, not proved."
TESTS = {
    FitCode.SCALE: "a wrong scale",
    FitCode.OUTLIER_ROWS: "outlying rows",
    FitCode.SHUFFLED: "shuffled rows",
    FitCode.MIRRORED: "a mirror image",
}
ABOVE = "The one above is not of the pairs' distances."


@dataclass(frozen=True, slots=True, kw_only=True)
class Fact:
    """A figure with its name, and what it is a figure of."""

    name: str
    value: str
    words: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Mark:
    """A word in a colour. kind: good, open or plain, a class of the style."""

    kind: str
    words: str


@dataclass(frozen=True, slots=True, kw_only=True)
class PoseFacts:
    """A pose for readers. rows: the 4×4, rounded; matrix, quaternion, scale: all digits, to copy.

    scale: None where it is not free.

    uncertainty: how the deviations in `facts` are known, or why there are none.
    """

    rows: tuple[str, ...]
    facts: tuple[Fact, ...]
    uncertainty: str
    matrix: str
    quaternion: str
    scale: str | None
    motion: str


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
            pose=_pose(registration),
            fit=tuple(figures(registration)),
            mark=mark,
            tests=tests,
            proved=tuple(_proved(registration)),
        )


def _pose(registration: Registration) -> PoseFacts:
    return pose_facts(registration, place_facts(registration), basis_words(registration, WHOSE))


def basis_words(registration: Registration, whose: str) -> str:
    """What the deviations are of, or why there are none; whose: of which places they are."""
    sure = dict(uncertainty_rows(registration))
    if BASIS not in sure:
        return f"Uncertainty {sure['uncertainty']}."
    return f"± is {sure[BASIS]}. {whose} {NO_PROOF}"


def place_facts(registration: Registration) -> list[Fact]:
    """Rotation and translation, with what is known of their deviations; no proof."""
    pose, covariance = registration.pose, registration.solution.stated("covariance")
    if BASIS in dict(uncertainty_rows(registration)) and not isinstance(covariance, Absent):
        return _sure(registration, covariance)
    facts = [rotation_fact(pose, None), *axis_facts(pose)]
    if registration.problem.rotation_only:
        return facts
    return [*facts, translation_fact(pose, None)]


def pose_facts(registration: Registration, facts: Iterable[Fact], uncertainty: str) -> PoseFacts:
    """The pose with these facts beside its digits."""
    pose = registration.pose
    exact = pose.T_target_source.tolist()
    return PoseFacts(
        rows=aligned(exact, scaled=isinstance(pose, Similarity)),
        facts=tuple(facts),
        uncertainty=uncertainty,
        matrix="\n".join(" ".join(map(repr, row)) for row in exact),
        quaternion=" ".join(map(repr, pose.quaternion_wxyz.tolist())),
        scale=repr(pose.scale) if isinstance(pose, Similarity) else None,
        motion=motion_words(registration),
    )


def _sure(registration: Registration, covariance: PoseCovariance) -> list[Fact]:
    """Rotation, centre and translation, each with its deviation in the next line."""
    pose, shift = registration.pose, shift_words(covariance, "")
    turn = rotation_words(covariance, "")
    turned = [
        rotation_fact(pose, covariance),
        *axis_facts(pose),
        Fact(name="Rotation ±", value="", words=turn),
    ]
    if covariance.scale_sigma is not None:
        size = scale_words(pose, covariance.scale_sigma)
        turned.append(Fact(name="Scale ±", value="", words=size))
    if registration.problem.rotation_only:
        return turned
    centre = ", ".join(centre_words(registration, covariance))
    return [
        *turned,
        Fact(name="Centre", value=f"({centre})"),
        Fact(name="Centre ±", value="", words=sigma_words(covariance)),
        translation_fact(pose, covariance),
        Fact(name="Translation ±", value="", words=SAME if shift == turn else shift),
    ]


def aligned(matrix: list[list[float]], *, scaled: bool = False) -> tuple[str, ...]:
    """The rows in few digits, in columns. scaled: whether entries may be of any size."""
    told = ("{:.6g}" if scaled else "{:.6f}").format
    cells = [[*map(told, row[:3]), _short(row[3])] for row in matrix[:3]]
    cells.append(["0", "0", "0", "1"])
    widths = [max(len(row[k]) for row in cells) for k in range(4)]
    return tuple(
        "  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True))
        for row in cells
    )


def _short(value: float) -> str:
    """A length in so few characters that the matrix fits its place."""
    return f"{value:.9g}" if 1e-4 <= abs(value) < WIDE or not value else f"{value:.5e}"


def rotation_fact(pose: Pose | Similarity, covariance: PoseCovariance | None) -> Fact:
    """The angle that the pose turns by, as its deviation allows."""
    degrees, axis = turn_of(pose)
    told = covariance is not None and not isinstance(turn_sigmas(covariance), Absent)
    sigma = math.degrees(covariance.loosest_sigma) if covariance is not None and told else 0.0
    about = "" if axis is None else "about the axis"
    return Fact(name="Rotation", value=f"{told_to(degrees, sigma)}°", words=about)


def axis_facts(pose: Pose | Similarity) -> list[Fact]:
    """On a line of its own, which holds it; none where nothing is turned."""
    _, axis = turn_of(pose)
    if axis is None:
        return []
    return [Fact(name="Axis", value=f"({', '.join(f'{entry:.4f}' for entry in axis)})")]


def translation_fact(pose: Pose | Similarity, covariance: PoseCovariance | None) -> Fact:
    """The translation of the pose, as its deviation allows."""
    told = Absent("") if covariance is None else shift_sigmas(covariance)
    sigmas = [0.0] * 3 if isinstance(told, Absent) else told.tolist()
    shift = pose.translation.tolist()
    values = ", ".join(told_to(t, s) for t, s in zip(shift, sigmas, strict=True))
    return Fact(name="Translation", value=f"({values})")


def figures(registration: Registration) -> Iterator[Fact]:
    """How good the fit is, in numbers."""
    fit = registration.fit
    at_rounding = fit.rounded and registration.rmse != 0.0
    unit = "unit of the target" if registration.problem.scaled else unit_words(fit)
    yield Fact(
        name="RMSE",
        value=number(registration.rmse),
        words=f"in the {unit}{_whose(registration, at_rounding=at_rounding)}",
    )
    yield _explained(fit)
    yield from fit_facts(registration, "the median distance")


def fit_facts(registration: Registration, median: str) -> Iterator[Fact]:
    """The worst pair beside the median one, called so; chi-squared where a noise is known."""
    ratio = registration.fit.largest_over_median_residual
    if ratio is not None:
        yield Fact(name="Worst pair", value=f"{ratio:.3g} ×", words=median)
    chi2 = chi2_words(registration)
    if chi2 is not None:
        value, _, words = chi2.partition(" ")
        yield Fact(name="Chi-squared", value=value, words=words.replace("p = ", "p\u00a0=\u00a0"))


def _whose(registration: Registration, *, at_rounding: bool) -> str:
    """Of which pose the RMSE is, where the printed one is not the optimum that the scene shows."""
    rounding = ", at rounding" if at_rounding else ""
    bounded = registration.status is Optimality.BOUNDED
    return f"{rounding}{', of the pose as printed' if bounded else ''}"


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


def _judged(registration: Registration) -> tuple[Mark, str]:
    """Whether a fit is warned of, and by which tests; green only where nothing is, above it."""
    fit, headline = registration.fit, headline_words(registration)
    if fit.warnings:
        return warned(fit)
    tested = fit.stated("scale_p")
    if isinstance(tested, Absent):
        return Mark(kind="plain", words="not tested"), f"Not tested: {tested.reason}."
    quiet = _quiet_words(registration)
    if warnings(registration, headline):
        return Mark(kind="open", words="see the warning above"), f"{quiet} {ABOVE}"
    return quiet_mark(good=headline_of(registration).good), quiet


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
    equilibria = registration.equilibria
    yield from bound_facts(registration, proved_degrees(registration))
    others = equilibria.classification.spurious
    yield Fact(
        name="Other poses at rest",
        value="infinitely many" if others is None else str(others),
        words="where the springs balance and the fit is not the best",
    )
    yield from robustness_facts(registration)
    value, words = split(margin_words(equilibria))
    yield Fact(name="Ambiguity margin", value=value, words=f"{words} (computed)")


def bound_facts(
    registration: Registration, degrees: str | None, of: str = "the exact optimum"
) -> Iterator[Fact]:
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
            f"{meanwhile_words(registration, found)}",
        )


def split(words: str) -> tuple[str, str]:
    """The figure that words begin with, and the rest.

    >>> split("12 % of the range: far")
    ('12 %', 'of the range: far')
    """
    value, _, rest = words.partition(": ")
    figure, percent, unit = value.partition(" % ")
    return f"{figure}{' %' if percent else ''}", f"{unit}{': ' if unit and rest else ''}{rest}"
