"""What is said of the least squares over the proved pairs, whether they weigh or have springs."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from certreg.report.lines import RMSE_WORDS, explained_words, method_lines, verdict_words
from certreg.report.overview import Mark, Overview
from certreg.report.parts import sprung
from certreg.report.robustness import robustness_words
from certreg.report.springs import springs_words
from certreg.report.words import RESTS_ON

if TYPE_CHECKING:
    from certreg.registration.labelled import ConsensusRegistration
    from certreg.registration.result import Registration


DISTANCES = "of the least squares alone: a bound is on the distance of two points"


def fit_verdict(fit: Registration) -> list[str]:
    """Its headline, and what the springs leave undetermined."""
    said = verdict_words(fit)
    return said[:1] if sprung(fit) is None else said


def further_lines(fit: Registration) -> list[str]:
    """How far its points may be off, and what other methods say of it, where one was named."""
    lines: list[str] = []
    if fit.robustness is not None:
        lines.append(f"  robustness        of the least squares: {robustness_words(fit)}")
    return lines + method_lines(fit) if sprung(fit) is None else lines


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
    if sprung(fit) is not None:
        return f"of these {found}, {RMSE_WORDS}"
    return f"of these {found}; explained {explained_words(fit.fit)}"


def kinds_words(result: ConsensusRegistration) -> str | None:
    """What kind of springs the pairs have that are met, and what for; None where they weigh."""
    kinds = springs_words(result.fit)
    return f"{kinds}, {DISTANCES}" if kinds else None


def fit_theorems(fit: Registration) -> tuple[str, ...]:
    """What its optimality rests on."""
    springs = sprung(fit)
    if springs is None:
        return ("optimality_certificate",)
    return () if springs.method is None else (*RESTS_ON[springs.method], "spring_translation")
