"""Certificates of kind "consensus-similarity": as "consensus", of motions whose scale is free.

The scales are cut into pieces, each with its stages. The rules, and why they are sound, are in
`certreg.verify`.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, ClassVar

from certreg.certificate.consensus import Reach, Stage, Witness
from certreg.exact import Dyadic
from certreg.results import Brief

if TYPE_CHECKING:
    from collections.abc import Sequence

NONE, SAME, OPEN = "-=?"  # of a piece: no motion meets so many; just the same pairs; not proved


@dataclass(frozen=True, slots=True, kw_only=True)
class ScaledWitness(Witness):
    """A motion in integers whose scale is `factor`."""

    factor: Dyadic


@dataclass(frozen=True, slots=True, kw_only=True)
class Piece(Brief):
    """Scales up to `end` from the end of the piece before, the first from 0; None: all others.

    state: "-", no motion with such a scale meets as many pairs as the witness; "=", those that do
    meet the same; "?", not proved.
    """

    end: Dyadic | None
    stages: tuple[Stage, ...]
    state: str


@dataclass(frozen=True, slots=True)
class ScaleRange:
    """Scales from `low` on, to `high`; None: without an end."""

    low: Fraction
    high: Fraction | None


def ranges(pieces: Sequence[Piece], states: str) -> list[ScaleRange]:
    """Where the pieces have one of these states; neighbours are joined."""
    found: list[ScaleRange] = []
    begin = Fraction(0)
    for piece in pieces:
        end = None if piece.end is None else piece.end.value
        if piece.state in states:
            joined = bool(found) and found[-1].high == begin
            found.append(ScaleRange(found.pop().low if joined else begin, end))
        begin = begin if end is None else end
    return found


@dataclass(frozen=True, slots=True, kw_only=True)
class ConsensusSimilarityBody(Brief):
    """What is proved of the pairs, and of the least squares over those that the witness meets.

    labels, upper, fit, reach: as in `ConsensusBody`. scale: of the fit, "asymmetric" or
    "symmetric". scale_lower, scale_upper: of all motions that meet the pairs that the witness
    meets.
    """

    KIND: ClassVar[str] = "consensus-similarity"
    COMPACT: ClassVar[bool] = True

    witness: ScaledWitness
    labels: str
    upper: int
    pieces: tuple[Piece, ...]
    scale: str
    scale_lower: Dyadic
    scale_upper: Dyadic
    fit: dict[str, Any] | None
    reach: Reach | None = None

    @property
    def met_elsewhere(self) -> bool:
        """Whether motions that meet these pairs may have a scale that is in no undecided range."""
        low, high = self.scale_lower.value, self.scale_upper.value
        inside = any(
            one.low <= low and (one.high is None or high <= one.high)
            for one in ranges(self.pieces, OPEN)
        )
        return not inside and any(piece.state == SAME for piece in self.pieces)

    def to_fields(self) -> dict[str, Any]:
        """The part of the file that is of this kind alone."""
        n = len(self.labels)
        return {
            "claims": {
                "labels": self.labels,
                "scale_lower": self.scale_lower.pair,
                "scale_upper": self.scale_upper.pair,
                "states": "".join(piece.state for piece in self.pieces),
                "upper": self.upper,
            },
            "fit": self.fit,
            "pieces": [
                [
                    None if piece.end is None else piece.end.pair,
                    [stage.to_fields(n) for stage in piece.stages],
                ]
                for piece in self.pieces
            ],
            "scale": self.scale,
            "witness": {
                "factor": self.witness.factor.pair,
                "quaternion": list(self.witness.quaternion),
                "shift": list(self.witness.shift),
            },
            **({} if self.reach is None else {"reach": self.reach.to_fields()}),
        }

    @classmethod
    def from_fields(cls, fields: dict[str, Any]) -> ConsensusSimilarityBody:
        """The inverse of `to_fields`, of a file that the checker has found well-formed.

        Raises ValueError or TypeError where pieces are not lists of an end and stages.
        """
        witness, claims = fields["witness"], fields["claims"]
        labels, pieces, states = claims["labels"], fields["pieces"], claims["states"]
        return cls(
            witness=ScaledWitness(
                quaternion=tuple(witness["quaternion"]),
                shift=tuple(witness["shift"]),
                factor=Dyadic.of_pair(witness["factor"]),
            ),
            labels=labels,
            upper=claims["upper"],
            pieces=tuple(
                Piece(
                    end=None if end is None else Dyadic.of_pair(end),
                    stages=tuple(Stage.from_fields(stage, len(labels)) for stage in stages),
                    state=state,
                )
                for (end, stages), state in zip(pieces, states, strict=True)
            ),
            scale=fields["scale"],
            scale_lower=Dyadic.of_pair(claims["scale_lower"]),
            scale_upper=Dyadic.of_pair(claims["scale_upper"]),
            fit=fields["fit"],
            reach=Reach.from_fields(fields.get("reach")),
        )
