"""Certificates of kind "consensus-similarity": as "consensus", of motions whose scale is free.

The scales are cut into pieces, each with its stages. The rules, and why they are sound, are in
`certreg.verify`.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, ClassVar

from certreg.certificate.consensus import LabelledBody, Stage, Witness
from certreg.certificate.file_parts import FileRow
from certreg.exact.dyadic import Dyadic

if TYPE_CHECKING:
    from collections.abc import Sequence

NONE, SAME, OPEN = "-=?"  # of a piece: no motion meets so many; just the same pairs; not proved


@dataclass(frozen=True, slots=True, kw_only=True)
class ScaledWitness(Witness):
    """A motion in integers whose scale is `factor`."""

    factor: Dyadic


@dataclass(frozen=True, slots=True, kw_only=True)
class Piece(FileRow):
    """Scales up to `end` from the end of the piece before, the first from 0; None: all others."""

    end: Dyadic | None
    stages: tuple[Stage, ...]


@dataclass(frozen=True, slots=True)
class ScaleRange:
    """Scales from `low` on, to `high`; None: without an end."""

    low: Fraction
    high: Fraction | None


def ranges(pieces: Sequence[Piece], states: str, wanted: str) -> list[ScaleRange]:
    """Where the pieces have the wanted state; neighbours are joined. states: a letter a piece."""
    found: list[ScaleRange] = []
    begin = Fraction(0)
    for piece, state in zip(pieces, states, strict=True):
        end = None if piece.end is None else piece.end.value
        if state == wanted:
            joined = bool(found) and found[-1].high == begin
            found.append(ScaleRange(found.pop().low if joined else begin, end))
        begin = begin if end is None else end
    return found


@dataclass(frozen=True, slots=True, kw_only=True)
class ConsensusSimilarityBody(LabelledBody):
    """Of motions with a scale.

    states: of each piece "-", no motion with such a scale meets as many pairs as the witness; "=",
        those that do meet the same; "?", not proved.
    scale: of the fit, "asymmetric" or "symmetric".
    scale_lower, scale_upper: of all motions that meet the pairs that the witness meets.
    """

    KIND: ClassVar[str] = "consensus-similarity"
    PLACES: ClassVar = {
        **LabelledBody.PLACES,
        "states": "claims.states",
        "scale_lower": "claims.scale_lower",
        "scale_upper": "claims.scale_upper",
    }

    witness: ScaledWitness
    pieces: tuple[Piece, ...]
    states: str
    scale: str
    scale_lower: Dyadic
    scale_upper: Dyadic

    @property
    def met_elsewhere(self) -> bool:
        """Whether motions that meet these pairs may have a scale that is in no undecided range."""
        low, high = self.scale_lower.value, self.scale_upper.value
        inside = any(
            one.low <= low and (one.high is None or high <= one.high)
            for one in ranges(self.pieces, self.states, OPEN)
        )
        return not inside and SAME in self.states
