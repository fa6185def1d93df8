"""What is added to a registration with wrong pairs where the scale is free; else nothing."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from certreg.registration import ScaledConsensusRegistration, ranges_words
from certreg.report.scale import BIAS

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from certreg.registration import ConsensusRegistration
    from certreg.report.encoding import Document


def scale_lines(result: ConsensusRegistration) -> Iterator[str]:
    """In the terminal."""
    if not isinstance(result, ScaledConsensusRegistration):
        return
    kind = result.problem.scale
    yield f"  scale             {result.pose.scale!r}  ({kind.value}; target over source)"
    yield f"                    {BIAS[kind]}"
    for words in scale_sentences(result):
        yield f"                    {words}"


def witness_scale_lines(result: ConsensusRegistration) -> Iterator[str]:
    """Beside its rotation and translation."""
    if isinstance(result, ScaledConsensusRegistration):
        yield f"    its scale       {result.witness.scale!r}"


def scale_sentences(result: ConsensusRegistration) -> Iterator[str]:
    """Between which scales all motions are that meet as many pairs, and what is left open."""
    if not isinstance(result, ScaledConsensusRegistration):
        return
    met, some = result.lower, result.undecided_scales
    where = ranges_words([result.scale_interval])
    yield f"Every motion that brings these {met} within has a scale {where}."
    if some:
        yield f"With scales {ranges_words(some)} it is not proved which {met} are met."


def scale_facts(result: ConsensusRegistration) -> Iterator[tuple[str, str]]:
    """On a card."""
    if isinstance(result, ScaledConsensusRegistration):
        yield "scale", repr(result.pose.scale)


def scale_fields(result: ConsensusRegistration) -> Document:
    """In JSON: ranges of scales, [low, high]; high is null where there is no end."""
    if not isinstance(result, ScaledConsensusRegistration):
        return {}
    return {
        "scale_interval": list(result.scale_interval),
        "undecided_scales": _ranges(result.undecided_scales),
    }


def _ranges(some: Sequence[tuple[float, float]]) -> list[list[float | None]]:
    return [[low, None if math.isinf(high) else high] for low, high in some]
