"""What is said of the least squares over the proved pairs, whether they weigh or have springs."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from certreg.objective.structure import Structure
from certreg.report.lines import explained_words, method_lines, verdict_words
from certreg.report.overview import Mark, Overview
from certreg.report.remedies import causes, remedies
from certreg.report.robustness import robustness_words
from certreg.report.similarity_overview import similarity_overview
from certreg.report.spring_overview import spring_overview
from certreg.report.spring_summary import (
    RMSE_WORDS,
    spring_remedies,
    spring_verdict_words,
    springs_words,
)
from certreg.report.spring_words import RESTS_ON

if TYPE_CHECKING:
    from certreg.registration.consensus import ConsensusRegistration
    from certreg.registration.result import Registration


DISTANCES = "of the least squares alone: a bound is on the distance of two points"


def on_springs(fit: Registration) -> bool:
    """Whether its pairs have general springs."""
    return fit.structure is Structure.QUARTIC


def fit_verdict(fit: Registration) -> list[str]:
    """Its headline, and what the springs leave undetermined."""
    if on_springs(fit):
        return spring_verdict_words(fit)
    return verdict_words(fit)[:1]


def fit_causes(fit: Registration) -> list[str]:
    """What is said against it, so that it is known what the remedies are for."""
    return [] if on_springs(fit) else causes(fit)


def fit_remedies(fit: Registration) -> list[str]:
    """What may help where something is said against it."""
    return spring_remedies(fit) if on_springs(fit) else remedies(fit)


def further_lines(fit: Registration) -> list[str]:
    """How far its points may be off, and what other methods say of it, where one was named."""
    lines: list[str] = []
    if fit.robustness is not None:
        lines.append(f"  robustness        of the least squares: {robustness_words(fit)}")
    return lines if on_springs(fit) else lines + method_lines(fit)


def fit_overview(fit: Registration) -> Overview:
    """The first screen of its page."""
    if on_springs(fit):
        return spring_overview(fit)
    return similarity_overview(fit) if fit.problem.scaled else Overview.of(fit)


def marked(overview: Overview, against: str | None) -> Overview:
    """The same, its fit marked with what the first line says against pairs and pose, if anything.

    A mark that is open already says what it is of itself.
    """
    if against is None or overview.mark.kind == "open":
        return overview
    return replace(overview, mark=Mark(kind="open", words=against.lower()))


def rmse_words(result: ConsensusRegistration) -> str:
    """What its RMSE is of."""
    fit, found = result.fit, result.lower
    if on_springs(fit):
        return f"of these {found}, {RMSE_WORDS}"
    return f"of these {found}; explained {explained_words(fit.fit)}"


def kinds_words(result: ConsensusRegistration) -> str | None:
    """What kind of springs the pairs have that are met, and what for; None where they weigh."""
    fit = result.fit
    return f"{springs_words(fit)}, {DISTANCES}" if on_springs(fit) else None


def fit_theorems(fit: Registration) -> tuple[str, ...]:
    """What its optimality rests on."""
    if not on_springs(fit):
        return ("optimality_certificate",)
    return () if fit.method is None else (*RESTS_ON[fit.method], "spring_translation")
