"""Certificates of kind "consensus": which pairs every motion that meets the most of them meets.

And of kind "consensus-similarity", of motions whose scale is free: the scales are cut into pieces,
each with its stages. The rules, and why they are sound, are in `certreg.verify`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar

from certreg.certificate.envelope import CertificateBody
from certreg.certificate.file_parts import REST, FilePart, FileRow
from certreg.exact.dyadic import Dyadic

INLIER, OUTLIER, UNDECIDED = "i", "o", "?"  # labels of a file, a letter a pair
NONE, SAME, OPEN = "-=?"  # of a piece: no motion meets so many; just the same pairs; not proved


@dataclass(frozen=True, slots=True, kw_only=True)
class Group(FileRow):
    """Rows that no motion meets together with what is struck: their weights, after its own."""

    rows: tuple[int, ...]
    weights: tuple[int, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Strike(FileRow):
    """A row that no motion meets that meets enough, and the groups that show it.

    struck: that row, or two that no such motion meets together.
    """

    PLACES: ClassVar = {"groups": REST}

    struck: int | tuple[int, int]
    groups: tuple[Group, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Stage(FileRow):
    """Rows struck because no motion that meets at least `least` pairs meets them.

    without: a pair that is left out, to see that the others alone are not enough; n: no one is.
    """

    least: int
    without: int
    strikes: tuple[Strike, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Witness(FilePart):
    """A motion in integers, the evidence that it meets so many pairs: no best pose.

    quaternion: of any length. shift: three integers and the exponent of their unit.
    """

    quaternion: tuple[int, int, int, int]
    shift: tuple[int, int, int, int]

    @property
    def scale(self) -> Fraction:
        """Of the motion."""
        return Fraction(1)


@dataclass(frozen=True, slots=True, kw_only=True)
class ScaledWitness(Witness):
    """A motion in integers whose scale is `factor`."""

    factor: Dyadic

    @property
    def scale(self) -> Fraction:
        """Of the motion."""
        return self.factor.value


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


RIGID = ScaleRange(Fraction(1), Fraction(1))


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
class Reach(FilePart):
    """sin^2(a/2) is less, a the angle from the pose in `fit` to any motion that meets the pairs.

    tau proves it.
    """

    sin2_half_angle: Dyadic
    tau: Dyadic


@dataclass(frozen=True, slots=True, kw_only=True)
class LabelledBody(CertificateBody):
    """What is proved of the pairs, and of the least squares over those that the witness meets.

    labels: of each pair "i", an inlier in every motion that meets as many as the witness, "o", an
        outlier in all of them, or "?", not proved.
    upper: no motion meets more pairs.
    fit: the certificate of the least-squares pose, as a file holds it; None where none was found.
    """

    COMPACT: ClassVar[bool] = True
    PLACES: ClassVar = {"labels": "claims.labels", "upper": "claims.upper", "reach": "reach?"}

    witness: Witness
    labels: str
    upper: int
    fit: dict[str, Any] | None
    reach: Reach | None = None

    @property
    def scales(self) -> tuple[Fraction, Fraction] | None:
        """Of all motions that meet these pairs; None where the scale is not free."""
        return None

    @property
    def met_elsewhere(self) -> bool:
        """Whether motions that meet these pairs may have a scale that is in no undecided range."""
        return False


@dataclass(frozen=True, slots=True, kw_only=True)
class ConsensusBody(LabelledBody):
    """Of rigid motions. springs: whether the fit is of general springs, which are in the data."""

    KIND: ClassVar[str] = "consensus"
    PLACES: ClassVar = {**LabelledBody.PLACES, "springs": "springs?"}

    stages: tuple[Stage, ...]
    springs: bool = False

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """The one scale, and its stages."""
        return (Piece(end=None, stages=self.stages),)

    @property
    def states(self) -> str:
        """Whether all motions with this scale that meet as many pairs meet the same."""
        return OPEN if UNDECIDED in self.labels else SAME


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
    def scales(self) -> tuple[Fraction, Fraction]:
        """Of all motions that meet these pairs."""
        return self.scale_lower.value, self.scale_upper.value

    @property
    def met_elsewhere(self) -> bool:
        """Whether motions that meet these pairs may have a scale that is in no undecided range."""
        low, high = self.scales
        inside = any(
            one.low <= low and (one.high is None or high <= one.high)
            for one in ranges(self.pieces, self.states, OPEN)
        )
        return not inside and SAME in self.states
