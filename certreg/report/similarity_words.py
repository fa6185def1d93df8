"""What the page of a free scale, or without a translation, says in sentences; not claimed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.registration.breathing import SimulatedBreathing, scaled_equilibria
from certreg.report.breathing import KEEPS, inside_out_words, scaled_count_words
from certreg.report.fields import scale_interval
from certreg.report.lines import margin_words
from certreg.report.scaled_summary import BIAS
from certreg.report.similarity_overview import printed_interval, untested_words
from certreg.report.words import (
    NOT_CLAIMED,
    MethodAngles,
    Sentence,
    begun,
    methods_sentence,
    motion_sentences,
    optimality_sentence,
    rest_sentence,
    robustness_sentences,
    sentence,
    uniqueness_sentences,
)
from certreg.results import Absent, Guarantee

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Any

    from certreg.registration.result import Registration


COUNTED = ("breathing_equilibria", "descartes")
SAME_SIZE = "The symmetric scale is the same whatever the rotation, also at these poses."
ROUNDED = "Poses, scales, energies and RMSE are rounded to doubles from at least 57 digits."


def similarity_sentences(registration: Registration, body: Any) -> list[Sentence]:
    """What the page says is known; the checker has accepted what the certificate claims."""
    angles = MethodAngles.of(registration.solution.agreement)
    radius = ["eigenvector_radius", *["scale_radius"] * registration.problem.scaled]
    return [
        *optimality_sentence(registration),
        *uniqueness_sentences(registration),
        *_scale(registration),
        *_rests(registration, body),
        *robustness_sentences(registration, *radius),
        Sentence(words=ROUNDED, guarantee=Guarantee.NUMERICAL),
        methods_sentence(registration, angles),
        *_margin(registration),
    ]


def not_claimed_of(registration: Registration) -> tuple[str, ...]:
    """What the page does not say, with what noise does to a free scale."""
    *before, last = NOT_CLAIMED
    problem, own = registration.problem, [f"that all rows belong: {untested_words(registration)};"]
    if problem.scaled:
        own.append(f"that noise leaves the scale alone: {BIAS[problem.scale]};")
    return (*before, *own, last)


def _scale(registration: Registration) -> Iterator[Sentence]:
    if not registration.problem.scaled:
        return
    bounds = scale_interval(registration)
    if isinstance(bounds, Absent):
        return
    low, high = printed_interval(bounds)
    words = (
        f"The scale of every optimum is at least {low} and at most {high}; the certificate has "
        "both in more digits."
    )
    theorems = ("optimality_certificate", "scale_elimination")
    yield Sentence(words=words, guarantee=Guarantee.EXACT, theorems=theorems)


def _rests(registration: Registration, body: Any) -> Iterator[Sentence]:
    """Where the body can rest, and whether its motion keeps its size above 0."""
    if not registration.problem.scaled:
        yield from motion_sentences(registration, body)
        return
    found = scaled_equilibria(registration.solution.objective, registration.equilibria)
    exact = Guarantee.EXACT
    if found.breathing is None:
        yield rest_sentence(registration)
        yield Sentence(words=SAME_SIZE, guarantee=exact, theorems=("scale_elimination",))
        return
    indices = ", ".join(str(each.component.morse_index) for each in found.components)
    index = "index" if len(found.components) == 1 else "indices"
    listed = f", of {index} {indices}" if found.components else ""
    words = (
        f"Poses at which a body can rest whose size is free: {scaled_count_words(found)}{listed}. "
        "The list is complete."
    )
    yield Sentence(words=words, guarantee=found.rigid.guarantee, theorems=COUNTED)
    words = inside_out_words(found.breathing)
    yield Sentence(words=words, guarantee=exact, theorems=COUNTED)
    trajectory = registration.solution.trajectory
    if isinstance(trajectory, SimulatedBreathing) and trajectory.never_collapses:
        words = sentence(KEEPS.removeprefix("Proved: "))
        yield Sentence(words=begun(words), guarantee=exact, theorems=("breathing_confined",))


def _margin(registration: Registration) -> Iterator[Sentence]:
    if not registration.problem.scaled:
        yield Sentence(
            words=f"The ambiguity margin is {margin_words(registration.equilibria)}.",
            guarantee=Guarantee.NUMERICAL,
            theorems=("classification",),
        )
