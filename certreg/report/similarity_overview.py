"""The first screen of the page of a free scale, or without a translation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.exact.decimals import at_least, at_most
from certreg.geometry.similarity import Similarity
from certreg.registration.breathing import scaled_equilibria
from certreg.registration.headlines import headline_words, proved_degrees
from certreg.registration.scaled_poses import unit_of
from certreg.report.fields import scale_interval
from certreg.report.lines import margin_words, warnings
from certreg.report.overview import (
    WHOSE,
    WHOSE_TURN,
    Fact,
    Mark,
    Overview,
    basis_words,
    bound_facts,
    figures,
    place_facts,
    pose_facts,
    robustness_facts,
    split,
    warned,
)
from certreg.report.scaled_summary import BIAS, SCALE_ZERO
from certreg.report.words import sentence
from certreg.results import Absent

if TYPE_CHECKING:
    from collections.abc import Iterator

    from certreg.registration.result import Registration
    from certreg.report.overview import PoseFacts


ALL_DIGITS = 17  # of a double
TESTED = "The test of the noise that was given raises no warning. "


def similarity_overview(registration: Registration) -> Overview:
    """Of a registration with a certificate."""
    mark, tests = _judged(registration)
    return Overview(
        pose=_pose(registration),
        fit=tuple(figures(registration)),
        mark=mark,
        tests=tests,
        proved=tuple(_proved(registration)),
    )


def model_words(registration: Registration) -> str:
    """How the source may move otherwise than as a rigid body in space."""
    problem = registration.problem
    scaled = ["with a free scale"] * problem.scaled
    return " and ".join([*scaled, *["without a translation"] * problem.rotation_only])


def untested_words(registration: Registration) -> str:
    """Which tests of a fit are not made."""
    return (
        f"{model_words(registration)} no test is made for outlying rows, shuffled rows or a "
        "mirror image"
    )


def _pose(registration: Registration) -> PoseFacts:
    problem = registration.problem
    facts = [*_scale_facts(registration), *place_facts(registration)]
    whose = WHOSE_TURN if problem.rotation_only else WHOSE
    told = [basis_words(registration, whose)]
    if problem.scaled:
        told.append(f"Of the scale: {BIAS[problem.scale]}.")
    return pose_facts(registration, facts, " ".join(told))


def _scale_facts(registration: Registration) -> Iterator[Fact]:
    pose, unit = registration.pose, unit_of(registration)
    if not isinstance(pose, Similarity):
        return
    kind = f"{registration.problem.scale.value}: target over source"
    yield Fact(name="Scale", value=f"{pose.scale:.9g}", words=kind)
    if pose.scale == 0.0:
        yield Fact(name="", value="", words=SCALE_ZERO)
    if unit is not None:
        yield Fact(name="Unit", value="", words=unit)


def _judged(registration: Registration) -> tuple[Mark, str]:
    """Whether a fit is warned of; one test alone is made, of a noise that is given."""
    fit, untested = registration.fit, sentence(untested_words(registration))
    if fit.warnings:
        mark, words = warned(fit)
        return mark, f"{words} {untested}"
    tested = TESTED if fit.chi2 is not None else ""
    if warnings(registration, headline_words(registration)):
        return Mark(kind="open", words="see the warning above"), f"{tested}{untested}"
    return Mark(kind="plain", words="no warning" if tested else "not tested"), f"{tested}{untested}"


def _proved(registration: Registration) -> Iterator[Fact]:
    yield from bound_facts(registration, proved_degrees(registration))
    yield from _interval(registration)
    yield _others(registration)
    yield from robustness_facts(registration)
    if not registration.problem.scaled:
        value, words = split(margin_words(registration.equilibria))
        yield Fact(name="Ambiguity margin", value=value, words=f"{words} (computed)")


def _interval(registration: Registration) -> Iterator[Fact]:
    if not registration.problem.scaled:
        return
    bounds = scale_interval(registration)
    if not isinstance(bounds, Absent):
        low, high = printed_interval(bounds)
        words = f"at most {high}, of every optimum; both are rounded outwards"
        yield Fact(name="Scale", value=f"≥ {low}", words=words)


def printed_interval(bounds: tuple[float, float]) -> tuple[str, str]:
    """Two proved numbers in words, rounded outwards: all digits of a double may not be enough."""
    low, high = bounds
    return at_least(low, ALL_DIGITS), at_most(high, ALL_DIGITS)


def _others(registration: Registration) -> Fact:
    """How many wrong poses there are at which the body can rest."""
    equilibria, where = registration.equilibria, "where the springs balance and the fit is not best"
    others = equilibria.classification.spurious
    if registration.problem.scaled:
        scaled = scaled_equilibria(registration.solution.objective, equilibria)
        others = scaled.spurious
        if scaled.breathing is not None:
            where = f"with a scale above 0, {where}"
    value = "infinitely many" if others is None else str(others)
    return Fact(name="Other poses at rest", value=value, words=where)
