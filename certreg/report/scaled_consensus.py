"""What is added to a registration with wrong pairs where the scale is free; else nothing."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from certreg.registration.pair_words import ranges_words
from certreg.report.scale import BIAS

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from certreg.registration.labelled import ConsensusRegistration
    from certreg.report.encoding import Document


def scale_lines(result: ConsensusRegistration) -> Iterator[str]:
    """In the terminal."""
    if result.scale_interval is None:
        return
    kind = result.problem.scale
    yield f"  scale             {_scale(result.pose)}  ({kind.value}; target over source)"
    yield f"                    {BIAS[kind]}"
    for words in scale_sentences(result):
        yield f"                    {words}"


def witness_scale_lines(result: ConsensusRegistration) -> Iterator[str]:
    """Beside its rotation and translation."""
    if result.scale_interval is not None:
        yield f"    its scale       {_scale(result.witness)}"


def scale_sentences(result: ConsensusRegistration) -> Iterator[str]:
    """Between which scales all motions are that meet as many pairs, and what is left open."""
    interval, met, some = result.scale_interval, result.lower, result.undecided_scales
    if interval is None:
        return
    where = ranges_words([interval])
    yield f"Every motion that brings these {met} within has a scale {where}."
    if some:
        yield f"With scales {ranges_words(some)} it is not proved which {met} are met."


def scale_facts(result: ConsensusRegistration) -> Iterator[tuple[str, str]]:
    """On a card."""
    if result.scale_interval is not None:
        yield "scale", _scale(result.pose)


def scale_fields(result: ConsensusRegistration) -> Document:
    """In JSON: ranges of scales, [low, high]; high is null where there is no end."""
    interval = result.scale_interval
    if interval is None:
        return {}
    return {
        "scale_interval": list(interval),
        "undecided_scales": _ranges(result.undecided_scales),
    }


def _scale(motion: Any) -> str:
    """Of a motion that has one."""
    return repr(motion.scale)


def _ranges(some: Sequence[tuple[float, float]]) -> list[list[float | None]]:
    return [[low, None if math.isinf(high) else high] for low, high in some]
