"""Certificates of kind "consensus": which pairs every motion that meets the most of them meets.

The rules, and why they are sound, are in `certreg.verify`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from certreg.certificate.file_parts import REST, FilePart, FileRow
from certreg.exact.dyadic import Dyadic

INLIER, OUTLIER, UNDECIDED = "i", "o", "?"  # labels of a file, a letter a pair


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


@dataclass(frozen=True, slots=True, kw_only=True)
class Reach(FilePart):
    """sin^2(a/2) is less, a the angle from the pose in `fit` to any motion that meets the pairs.

    tau proves it.
    """

    sin2_half_angle: Dyadic
    tau: Dyadic


@dataclass(frozen=True, slots=True, kw_only=True)
class LabelledBody(FilePart):
    """What is proved of the pairs, and of the least squares over those that the witness meets.

    labels: of each pair "i", an inlier in every motion that meets as many as the witness, "o", an
        outlier in all of them, or "?", not proved.
    upper: no motion meets more pairs.
    fit: the certificate of the least-squares pose, as a file holds it; None where none was found.
    """

    COMPACT: ClassVar[bool] = True  # thousands of small integers: no line for each
    PLACES: ClassVar = {"labels": "claims.labels", "upper": "claims.upper", "reach": "reach?"}

    witness: Witness
    labels: str
    upper: int
    fit: dict[str, Any] | None
    reach: Reach | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ConsensusBody(LabelledBody):
    """Of rigid motions. springs: whether the fit is of general springs, which are in the data."""

    KIND: ClassVar[str] = "consensus"
    PLACES: ClassVar = {**LabelledBody.PLACES, "springs": "springs?"}

    stages: tuple[Stage, ...]
    springs: bool = False
