"""Certificates of kind "consensus": which pairs every motion that meets the most of them meets.

The rules, and why they are sound, are in `certreg.verify`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from certreg.exact import Dyadic
from certreg.results import Brief

INLIER, OUTLIER, UNDECIDED = "i", "o", "?"  # labels of a file, a letter a pair


@dataclass(frozen=True, slots=True, kw_only=True)
class Group(Brief):
    """Rows that no motion meets together with what is struck: their weights, after its own."""

    rows: tuple[int, ...]
    weights: tuple[int, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Strike(Brief):
    """A row that no motion meets that meets enough, and the groups that show it.

    other: None, or a second row that no such motion meets together with the first.
    """

    row: int
    other: int | None = None
    groups: tuple[Group, ...] = ()

    def to_fields(self) -> list[Any]:
        """As a file holds it."""
        head = self.row if self.other is None else [self.row, self.other]
        return [head, *[[[*g.rows], [*g.weights]] for g in self.groups]]

    @classmethod
    def from_fields(cls, fields: list[Any]) -> Strike:
        """The inverse of `to_fields`."""
        head, *groups = fields
        pair = [head] if isinstance(head, int) else [*head]
        return cls(
            row=pair[0],
            other=pair[1] if len(pair) > 1 else None,
            groups=tuple(Group(rows=(*T,), weights=(*L,)) for T, L in groups),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Stage(Brief):
    """Rows struck because no motion that meets at least `least` pairs meets them.

    without: a pair that is left out, to see that the others alone are not enough; None: all pairs.
    """

    least: int
    without: int | None
    strikes: tuple[Strike, ...]

    def to_fields(self, n: int) -> list[Any]:
        """As a file holds it; n: of pairs."""
        steps = [strike.to_fields() for strike in self.strikes]
        return [self.least, n if self.without is None else self.without, steps]

    @classmethod
    def from_fields(cls, fields: list[Any], n: int) -> Stage:
        """The inverse of `to_fields`."""
        least, without, steps = fields
        return cls(
            least=least,
            without=None if without == n else without,
            strikes=tuple(Strike.from_fields(step) for step in steps),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Witness(Brief):
    """A motion in integers, the evidence that it meets so many pairs: no best pose.

    quaternion: of any length. shift: three integers and the exponent of their unit.
    """

    quaternion: tuple[int, int, int, int]
    shift: tuple[int, int, int, int]


@dataclass(frozen=True, slots=True, kw_only=True)
class Reach(Brief):
    """sin^2(a/2) is less, a the angle from the pose in `fit` to any motion that meets the pairs.

    tau proves it.
    """

    sin2_half_angle: Dyadic
    tau: Dyadic

    def to_fields(self) -> dict[str, Any]:
        """The object `reach` of the file."""
        return {"sin2_half_angle": self.sin2_half_angle.pair, "tau": self.tau.pair}

    @classmethod
    def from_fields(cls, fields: dict[str, Any] | None) -> Reach | None:
        """The inverse of `to_fields`; None of none."""
        if fields is None:
            return None
        return cls(
            sin2_half_angle=Dyadic.of_pair(fields["sin2_half_angle"]),
            tau=Dyadic.of_pair(fields["tau"]),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class ConsensusBody(Brief):
    """What is proved of the pairs, and of the least squares over those that the witness meets.

    labels: of each pair "i", an inlier in every motion that meets as many as the witness, "o", an
        outlier in all of them, or "?", not proved.
    upper: no motion meets more pairs.
    fit: the certificate of the least-squares pose, as a file holds it; None where none was found.
    springs: whether that is of general springs, which are in the data.
    """

    KIND: ClassVar[str] = "consensus"
    COMPACT: ClassVar[bool] = True  # thousands of small integers: no line for each

    witness: Witness
    labels: str
    upper: int
    stages: tuple[Stage, ...]
    fit: dict[str, Any] | None
    reach: Reach | None = None
    springs: bool = False

    def to_fields(self) -> dict[str, Any]:
        """The part of the file that is of this kind alone."""
        n = len(self.labels)
        return {
            "claims": {"labels": self.labels, "upper": self.upper},
            "fit": self.fit,
            "stages": [stage.to_fields(n) for stage in self.stages],
            "witness": {
                "quaternion": list(self.witness.quaternion),
                "shift": list(self.witness.shift),
            },
            **({} if self.reach is None else {"reach": self.reach.to_fields()}),
            **({"springs": True} if self.springs else {}),
        }

    @classmethod
    def from_fields(cls, fields: dict[str, Any]) -> ConsensusBody:
        """The inverse of `to_fields`, of a file that the checker has found well-formed.

        Raises ValueError or TypeError where stages are not lists of integers.
        """
        witness, labels = fields["witness"], fields["claims"]["labels"]
        return cls(
            witness=Witness(quaternion=tuple(witness["quaternion"]), shift=tuple(witness["shift"])),
            labels=labels,
            upper=fields["claims"]["upper"],
            stages=tuple(Stage.from_fields(stage, len(labels)) for stage in fields["stages"]),
            fit=fields["fit"],
            reach=Reach.from_fields(fields.get("reach")),
            springs=bool(fields.get("springs")),
        )
