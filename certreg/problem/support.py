"""What is supported: one table of terms, motion, loss and verb, with a sentence for each refusal.

Every refusal of a combination comes from here, and ends with its remedies. A remedy is named only
where it is supported itself.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from itertools import combinations
from typing import Any, NamedTuple

from certreg.errors import InvalidProblemError
from certreg.problem.motion import Scale


class Loss(StrEnum):
    """What is minimised, or counted, over the pairs; the value is the word used in commands."""

    SQUARES = "squares"  # sum w |r|^2
    CONSENSUS = "consensus"  # how many pairs are within their bounds
    TRUNCATED = "truncated"  # sum min(|r|^2 / bound^2, 1)
    BREAKING = "breaking"  # sum w min(|r|^2, bound^2), of `breaking_equilibria` and its simulation

    @classmethod
    def of(cls, objective: Any, max_residual: Any) -> Loss:
        """The loss that a user names, None for the usual one.

        Raises InvalidProblemError for other names, and for a name without a bound.
        """
        if objective not in {None, *BOUNDED}:
            raise InvalidProblemError(
                f"objective is {objective!r}: give {' or '.join(map(repr, map(str, BOUNDED)))}",
                array="objective",
                value=objective,
            )
        if max_residual is not None:
            return cls(objective or cls.CONSENSUS)
        if objective is not None:
            raise InvalidProblemError(
                f"objective is {objective!r}: it goes with max_residual, give that, too",
                array="max_residual",
                value=None,
            )
        return cls.SQUARES


BOUNDED = (Loss.CONSENSUS, Loss.TRUNCATED)  # what users name beside bounds


class Verb(StrEnum):
    """What is asked about a problem: equilibria by a method, a simulation by an integrator."""

    CERTIFY = "certify"  # `register` and `assess` go as it does
    LABELS = "labels"  # judged by `assess`
    SPECTRAL = "spectral"
    GROEBNER = "groebner"
    HOMOTOPY = "homotopy"
    ALL_METHODS = "all"
    MIDPOINT = "midpoint"
    SPLITTING = "splitting"
    EULER = "euler"
    DAMPING = "optimal damping"


class Cell(NamedTuple):  # made, and looked up, faster than a dataclass: `register` needs one
    """What a user declares of a problem. springs: whether normals, directions or matrices."""

    springs: bool = False
    scale: Scale = Scale.NONE
    rotation_only: bool = False
    loss: Loss = Loss.SQUARES

    @property
    def scaled(self) -> bool:
        """Whether the scale is free."""
        return self.scale.free


@dataclass(frozen=True, slots=True, kw_only=True)
class Remedy:
    """What a user may do instead, in words, and the cell and the verb that this makes."""

    words: str
    cell: Cell
    verb: Verb


@dataclass(frozen=True, slots=True, kw_only=True)
class Refusal:
    """Why a cell is not supported, the argument that an error names, and what helps."""

    reason: str
    argument: str
    remedies: tuple[Remedy, ...]

    @property
    def sentence(self) -> str:
        """One sentence for the user."""
        return f"{self.reason}: {', or '.join(remedy.words for remedy in self.remedies)}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Rule:
    """A part of the table that is not supported.

    verbs: those that it is about; empty: all, as it refuses the problem, whatever is asked then.
    leave: fields of a cell, of which those that are given may be left out together. others: further
    remedies: words, changes of the cell, the verb.
    """

    applies: Callable[[Cell], bool]
    reason: str
    verbs: frozenset[Verb] = frozenset()
    leave: tuple[str, ...] = ()
    others: tuple[tuple[str, dict[str, Any], Verb | None], ...] = ()

    def refused(self, cell: Cell, verb: Verb) -> Refusal:
        """The refusal of a cell to which this applies."""
        asked = verb if self.verbs else Verb.CERTIFY
        candidates = (*self._leaving(cell, asked), *self._others(cell, asked))
        return Refusal(
            reason=self.reason,
            argument=next((ARGUMENTS[name] for name in self._given(cell)), "problem"),
            remedies=tuple(one for one in candidates if supported(one.cell, one.verb)),
        )

    def _given(self, cell: Cell) -> list[str]:
        return [name for name in self.leave if getattr(cell, name) != getattr(NEUTRAL, name)]

    def _leaving(self, cell: Cell, verb: Verb) -> Iterator[Remedy]:
        """The least that may be left out: what is said first need not go with what is not."""
        given = self._given(cell)
        for count in range(1, len(given) + 1):
            remedies = [_without(cell, names, verb) for names in combinations(given, count)]
            if any(supported(one.cell, one.verb) for one in remedies):
                yield from remedies
                return

    def _others(self, cell: Cell, verb: Verb) -> Iterator[Remedy]:
        for words, changes, other in self.others:
            yield Remedy(words=words, cell=cell._replace(**changes), verb=other or verb)


def supported(cell: Cell, verb: Verb = Verb.CERTIFY) -> bool:
    """Whether a cell of the table is supported."""
    return _first_rule(cell, verb) is None


@cache  # of some hundred cells
def refusal(cell: Cell, verb: Verb = Verb.CERTIFY) -> Refusal | None:
    """Why a cell of the table is not supported; None where it is.

    >>> refusal(Cell(springs=True, scale=Scale.SYMMETRIC)).sentence.rpartition(": ")[2]
    'leave out --scale (scale=)'
    """
    rule = _first_rule(cell, verb)
    return None if rule is None else rule.refused(cell, verb)


def _first_rule(cell: Cell, verb: Verb) -> Rule | None:
    about = (rule for rule in TABLE if not rule.verbs or verb in rule.verbs)
    return next((rule for rule in about if rule.applies(cell)), None)


def require_supported(cell: Cell, verb: Verb = Verb.CERTIFY) -> None:
    """Raises InvalidProblemError, with the remedies, for a cell that is not supported."""
    refused = refusal(cell, verb)
    if refused is not None:
        raise InvalidProblemError(refused.sentence, array=refused.argument)


def _without(cell: Cell, names: tuple[str, ...], verb: Verb) -> Remedy:
    changes: dict[str, Any] = {name: _left_out(cell, name) for name in names}
    words = "leave out " + " and ".join(OPTIONS[name] for name in names)
    return Remedy(words=words, cell=cell._replace(**changes), verb=verb)


def _left_out(cell: Cell, name: str) -> object:
    """The field without its option: bounds of truncated squares then count pairs."""
    counts = name == "loss" and cell.loss is Loss.TRUNCATED
    return Loss.CONSENSUS if counts else getattr(NEUTRAL, name)


NEUTRAL = Cell()
PREFIXES = {  # of the bytes that state a problem: no digest stands for two of them
    NEUTRAL: b"certreg-problem/1\0",
    Cell(rotation_only=True): b"certreg-rotation/1\0",
    Cell(scale=Scale.ASYMMETRIC): b"certreg-similarity/1\0",
    Cell(scale=Scale.ASYMMETRIC, rotation_only=True): b"certreg-similarity-rotation/1\0",
    Cell(scale=Scale.SYMMETRIC): b"certreg-similarity-symmetric/1\0",
    Cell(scale=Scale.SYMMETRIC, rotation_only=True): b"certreg-similarity-symmetric-rotation/1\0",
    Cell(springs=True): b"certreg-springs/1\0",
    Cell(springs=True, rotation_only=True): b"certreg-springs-rotation/1\0",
    Cell(loss=Loss.CONSENSUS): b"certreg-consensus/1\0",
    Cell(loss=Loss.CONSENSUS, springs=True): b"certreg-consensus-springs/1\0",
    Cell(loss=Loss.CONSENSUS, scale=Scale.ASYMMETRIC): b"certreg-consensus-similarity/1\0",
    Cell(loss=Loss.CONSENSUS, scale=Scale.SYMMETRIC): b"certreg-consensus-similarity-symmetric/1\0",
    Cell(loss=Loss.TRUNCATED, rotation_only=True): b"certreg-truncated-rotation/1\0",
    Cell(loss=Loss.BREAKING): b"certreg-breaking/1\0",  # of no certificate
}
OPTIONS = {  # by the field of a cell: what a user typed for it, in commands and in Python
    "springs": "normals, directions and matrices",
    "scale": "--scale (scale=)",
    "rotation_only": "--rotation-only (rotation_only=)",
    "loss": "--objective (objective=)",
}
ARGUMENTS = {  # by the field of a cell: the argument that an error names
    "springs": "factors",
    "scale": "scale",
    "rotation_only": "rotation_only",
    "loss": "objective",
}
LABELS_OF_CERTIFY = (
    "with --scale let certify prove labels (certreg certify SOURCE TARGET --scale NAME "
    "--max-residual X --out FOLDER), and compare yours with the column `proved` of FOLDER/fit.csv"
)
SIMULATED = frozenset({Verb.MIDPOINT, Verb.SPLITTING, Verb.EULER})
TABLE = (
    Rule(
        applies=lambda cell: cell.springs and cell.scale is Scale.SYMMETRIC,
        reason="the symmetric scale is defined for one weight per pair",
        leave=("scale", "rotation_only", "loss"),
    ),
    Rule(
        applies=lambda cell: cell.springs and cell.scaled,
        reason="normals, directions and matrices go with scale 1, not yet with a free scale",
        leave=("scale", "rotation_only", "loss"),
    ),
    Rule(
        applies=lambda cell: cell.springs and cell.loss is Loss.TRUNCATED,
        reason="truncated squares go with one weight per pair",
        leave=("rotation_only", "loss"),
    ),
    Rule(
        applies=lambda cell: cell.loss is Loss.CONSENSUS and cell.rotation_only,
        reason="inliers are counted for motions with a translation",
        leave=("rotation_only",),
        others=(
            ("add --objective truncated (objective='truncated')", {"loss": Loss.TRUNCATED}, None),
        ),
    ),
    Rule(
        applies=lambda cell: cell.loss is Loss.TRUNCATED and not cell.rotation_only,
        reason="truncated squares go without a translation for now",
        leave=("loss",),
        others=(("give --rotation-only (rotation_only=True)", {"rotation_only": True}, None),),
    ),
    Rule(
        applies=lambda cell: cell.loss is Loss.TRUNCATED and cell.scaled,
        reason="truncated squares go without a free scale",
        leave=("scale",),
    ),
    Rule(
        verbs=frozenset({Verb.LABELS}),
        applies=lambda cell: cell.loss is Loss.CONSENSUS and cell.scaled,
        reason="labels are judged for a rigid motion alone",
        others=((LABELS_OF_CERTIFY, {}, Verb.CERTIFY),),
    ),
    Rule(
        verbs=SIMULATED,
        applies=lambda cell: cell.scale is Scale.SYMMETRIC,
        reason="the symmetric scale minimises the energy over the scale, which no springs have",
        leave=("scale",),
        others=(("take the asymmetric one", {"scale": Scale.ASYMMETRIC}, Verb.MIDPOINT),),
    ),
    Rule(
        verbs=SIMULATED - {Verb.MIDPOINT},
        applies=lambda cell: cell.scaled,
        reason="a body with a free scale is simulated by the midpoint rule alone, whose energy "
        "never rises",
        others=(("leave out --integrator, or take 'midpoint'", {}, Verb.MIDPOINT),),
    ),
    Rule(
        verbs=frozenset({Verb.EULER}),
        applies=lambda cell: cell.springs,
        reason="'euler' is for one weight per pair alone",
        others=(
            ("take 'midpoint', whose energy never rises", {}, Verb.MIDPOINT),
            ("'splitting'", {}, Verb.SPLITTING),
        ),
    ),
    Rule(
        verbs=frozenset({Verb.GROEBNER, Verb.HOMOTOPY, Verb.ALL_METHODS}),
        applies=lambda cell: cell.scaled,
        reason="with a free scale the equilibria are counted by eigenspaces alone",
        others=(("take 'spectral'", {}, Verb.SPECTRAL),),
    ),
    Rule(
        verbs=frozenset({Verb.SPECTRAL}),
        applies=lambda cell: cell.springs,
        reason="normals, directions and matrices have no eigenspaces",
        others=(("take 'homotopy' or 'all'", {}, Verb.HOMOTOPY),),
    ),
    Rule(
        verbs=frozenset({Verb.DAMPING}),
        applies=lambda cell: cell.springs or cell.scaled,
        reason="an optimal damping is computed for one weight per pair and scale 1 alone",
        others=(("give a number, or leave it out", {}, Verb.CERTIFY),),
    ),
    Rule(
        applies=lambda cell: (
            cell.loss is Loss.BREAKING and (cell.springs or cell.scaled or cell.rotation_only)
        ),
        reason="springs that break have one weight each and move a rigid body",
        leave=("springs", "scale", "rotation_only"),
    ),
)
