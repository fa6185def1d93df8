"""Judging labels of any other tool: are they those of the most pairs, or of the least cost.

Of pairs that one motion shall meet: whether one meets the inliers, and whether they are the most.
Of truncated squares: whether an optimum has just these within. One 4x4 matrix disproves that beside
a good rotation, whether its optimality is proved or not; that an optimum has them is proved only
where the search over all rotations left no label open.
"""

from __future__ import annotations

import enum
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from certreg.certificate.joint_feasibility import CommonMotion, common_motion
from certreg.certificate.producing_consensus import ConsensusProver, ProvedConsensus, pose_of
from certreg.certificate.truncated import disproves_labels
from certreg.native.bitset_graph import colours
from certreg.problem.bounds import LEAST_DIRECTIONS, checked_inliers
from certreg.problem.budget import checked_effort
from certreg.problem.support import Loss, Verb, require_supported
from certreg.registration.consensus import proved_consensus
from certreg.registration.exit_codes import DONE, NOT_CERTIFIED, REFUSED
from certreg.registration.labelled import NO_COST, TruncatedRegistration
from certreg.registration.pair_words import within_words
from certreg.registration.pipeline import Asked, Work
from certreg.registration.row_names import RowNames
from certreg.registration.truncated import PROVER
from certreg.results import Absent, Presented

if TYPE_CHECKING:
    from certreg.geometry.pose import Pose
    from certreg.problem.problem import RegistrationProblem


NAMED_ROWS = 8  # of the refuted ones, in a sentence
BITS = 60  # of the entries of a quaternion


class LabelsVerdict(enum.Enum):
    """What is proved of labels; the value is the word used in files."""

    CONSISTENT = "consistent"
    REFUTED = "refuted"
    UNDECIDED = "undecided"


Said = Mapping[LabelsVerdict, Callable[[Any, int, str], str]]
CODES = {LabelsVerdict.CONSISTENT: DONE, LabelsVerdict.REFUTED: REFUSED}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LabelAssessment(Presented, ABC):
    """What is proved of pairs that were labelled as inliers.

    Attributes
    ----------
    problem
        As it was stated, with its bounds.
    rows
        Those labelled as inliers.
    names
        Of the rows.
    """

    problem: RegistrationProblem
    rows: tuple[int, ...]
    names: RowNames
    SAID: ClassVar[Said]  # behind the verdict, of how many inliers and within what

    def __repr__(self) -> str:
        counted = f"{len(self.rows)} of {self.problem.n} pairs"
        return f"<{type(self).__name__}: {counted}; {self.verdict.value}>"

    @property
    @abstractmethod
    def verdict(self) -> LabelsVerdict:
        """What is proved."""

    @property
    def headline(self) -> str:
        """The verdict, with what is proved."""
        said = self.SAID[self.verdict](self, len(self.rows), within_words(self.problem))
        return f"{self.verdict.name}: {said}"

    @property
    def exit_code(self) -> int:
        """0: consistent; 1: refuted; 4: neither is proved."""
        return CODES.get(self.verdict, NOT_CERTIFIED)

    def _named(self, rows: Sequence[int]) -> str:
        """The first of some rows, and how many others there are."""
        return self.names.words(rows[:NAMED_ROWS], len(rows))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class KeptPairs(LabelAssessment):
    """What is proved of labels with one motion, and with the most pairs that one meets.

    Attributes
    ----------
    motion
        A motion that meets all of them, or few of them that none meets.
    most
        The most pairs that were found to be met by one motion, and what is proved of them; None
        where none was found that meets three.
    sets
        So many sets hold all rows, of which no motion meets two of the same set: no motion meets
        more pairs than that.
    """

    motion: CommonMotion
    most: ProvedConsensus | None
    sets: int
    optimum: ClassVar[Absent] = NO_COST
    SAID: ClassVar[Said] = {
        LabelsVerdict.CONSISTENT: lambda self, kept, within: (
            f"one rigid motion brings all {kept} labelled inliers {within}; {self._compared()}"
        ),
        LabelsVerdict.UNDECIDED: lambda self, kept, within: (
            f"no rigid motion was found that brings all {kept} labelled inliers {within}, and no "
            f"proof that there is none. {self._most()}"
        ),
        LabelsVerdict.REFUTED: lambda self, kept, within: (
            f"no rigid motion brings all {kept} labelled inliers {within}, not even "
            f"{self._named(self.motion.refuted)} (from 0) together. {self._most()}"
        ),
    }
    __repr__ = LabelAssessment.__repr__

    @property
    def verdict(self) -> LabelsVerdict:
        """Whether one motion meets them."""
        if self.motion.refuted:
            return LabelsVerdict.REFUTED
        met = self.motion.witness is not None
        return LabelsVerdict.CONSISTENT if met else LabelsVerdict.UNDECIDED

    @property
    def witness(self) -> Pose | None:
        """A motion that meets all of them, exactly before it is rounded to doubles."""
        return None if self.motion.witness is None else pose_of(self.motion.witness)

    @property
    def lower(self) -> int:
        """So many pairs one motion meets, proved."""
        return 0 if self.most is None else len(self.most.met)

    @property
    def upper(self) -> int:
        """No motion meets more, proved."""
        searched = self.problem.n if self.most is None else self.most.upper
        return min(searched, self.sets, self.problem.n - bool(self.motion.refuted))

    @property
    def unique(self) -> bool:
        """Whether it is proved that just these are the inliers of every motion that meets most."""
        return self.most is not None and self.most.decided and self.most.met == self.rows

    def _compared(self) -> str:
        """How many they are, beside the most."""
        kept = len(self.rows)
        if self.unique:
            return f"no motion brings more than {kept}, and only these {kept}: proved."
        if self.upper == kept:
            return f"no motion brings more than {kept}, proved; another {kept} are not ruled out."
        if self.lower == self.upper:
            return f"the most is {self.lower}, proved; these are {kept}.{self._missing()}"
        return f"the most is {self.lower} to {self.upper}, proved; these are {kept}."

    def _missing(self) -> str:
        """Which rows are proved inliers and were not labelled so."""
        labels = "" if self.most is None else self.most.labels
        rows = [r for r, letter in enumerate(labels) if letter == "i" and r not in self.rows]
        if not rows:
            return ""
        has = f"has {self._named(rows)} (from 0), too: proved."
        return f" Every motion that brings {self.lower} within {has}"

    def _most(self) -> str:
        if self.lower == self.upper:
            return f"The most pairs that one motion brings within are {self.lower}, proved."
        if self.most is None:
            return "No motion was found that brings three pairs within."
        between = f"{self.lower} to {self.upper}"
        return f"The most pairs that one motion brings within are {between}, proved."


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TruncatedLabels(LabelAssessment):
    """What is proved of labels with the rotation of least truncated cost.

    Attributes
    ----------
    optimum
        The rotation of least truncated cost, as far as it was found, and what is proved of all
        pairs.
    disproved
        Whether no optimum has just these within their bounds, by one 4x4 matrix.
    """

    optimum: TruncatedRegistration
    disproved: bool
    SAID: ClassVar[Said] = {
        LabelsVerdict.CONSISTENT: lambda _, kept, within: (
            f"at every optimum of the truncated cost these {kept} pairs are {within}, and only "
            "these: proved."
        ),
        LabelsVerdict.UNDECIDED: lambda self, kept, within: (
            f"it is not proved that an optimum of the truncated cost has just these {kept} pairs "
            f"{within}, nor that none has. {self._open()}"
        ),
        LabelsVerdict.REFUTED: lambda self, kept, within: (
            f"no optimum of the truncated cost has just these {kept} pairs {within}"
            f"{', by one 4x4 matrix' * self.disproved}. {self._others()}"
        ),
    }
    __repr__ = LabelAssessment.__repr__

    @classmethod
    def of(cls, optimum: TruncatedRegistration, rows: tuple[int, ...]) -> TruncatedLabels:
        """What one matrix says of the rows, beside this rotation."""
        problem, kept = optimum.problem, set(rows)
        within = [row in kept for row in range(problem.n)]
        q = [round(entry * 2.0**BITS) for entry in optimum.pose.quaternion_wxyz.tolist()]
        disproved = disproves_labels(problem, within, q)
        names = optimum.names
        return cls(problem=problem, rows=rows, names=names, optimum=optimum, disproved=disproved)

    @property
    def differing(self) -> tuple[int, ...]:
        """Rows that are proved to have the other label at every optimum."""
        kept, labels = set(self.rows), self.optimum.labels
        wrong = ("outlier" if row in kept else "inlier" for row in range(len(labels)))
        return tuple(row for row, word in enumerate(wrong) if labels[row] == word)

    @property
    def verdict(self) -> LabelsVerdict:
        """Refuted: no optimum has these labels. Consistent: every optimum has just these."""
        if self.disproved or self.differing:
            return LabelsVerdict.REFUTED
        sure = self.optimum.labels_unique
        return LabelsVerdict.CONSISTENT if sure else LabelsVerdict.UNDECIDED

    def _others(self) -> str:
        """What the proved labels are, where they differ."""
        rows = self.differing
        if not rows:
            return f"Which labels are wrong is not proved. {self._open()}"
        word = "has the other label" if len(rows) == 1 else "have the other label"
        more = "" if self.optimum.labels_unique else f" {self._open()}"
        return f"At every optimum {self._named(rows)} (from 0) {word}: proved.{more}"

    def _open(self) -> str:
        """Of which pairs nothing is proved."""
        labels, rows = self.optimum.labels, self.optimum.undecided
        verb, named = (
            "is" if len(rows) == 1 else "are",
            self.names.counted(rows[:NAMED_ROWS], len(rows)),
        )
        return f"Of the {len(labels)} pairs {len(rows)} {verb} undecided ({named})."


def judged_labels(
    problem: RegistrationProblem,
    labels: Any,
    *,
    effort: float = 1.0,
    about: dict[str, Any] | None = None,
) -> LabelAssessment:
    """What is proved of the pairs that the labels call inliers, by the loss of the problem.

    labels: (N,), 0 and 1, booleans, or "outlier" and "inlier". about: with labels of the rows.
    Raises InvalidProblemError for other labels, and where too few are inliers; UndecidedError where
    no rotation was found that brings a pair within its bound.
    """
    return JUDGES[problem.loss.kind](problem, labels, Asked(effort=effort, about=about or {}))


def _kept_pairs(problem: RegistrationProblem, labels: Any, asked: Asked) -> KeptPairs:
    """Whether one motion meets the inliers, and how many the most are."""
    require_supported(problem.cell, Verb.LABELS)
    rows = checked_inliers(labels, problem.n)
    prover = ConsensusProver(problem, effort=checked_effort(asked.effort))
    motion, most = common_motion(prover, rows), proved_consensus(problem, prover, asked.effort)
    if motion.witness is not None:
        own = prover.witnessed(motion.witness)
        if most is None or (own is not None and own.worth > most.worth):
            most = own
    return KeptPairs(
        problem=problem,
        rows=rows,
        motion=motion,
        most=most,
        names=RowNames.of(asked.about, problem.n),
        sets=colours((1 << problem.n) - 1, prover.graph.near.integers, problem.n),
    )


def _of_the_optimum(problem: RegistrationProblem, labels: Any, asked: Asked) -> TruncatedLabels:
    """Whether an optimum of truncated squares has just the inliers within."""
    rows = checked_inliers(labels, problem.n, LEAST_DIRECTIONS)
    return TruncatedLabels.of(PROVER.certified(problem, asked, Work()), rows)


JUDGES = {Loss.CONSENSUS: _kept_pairs, Loss.TRUNCATED: _of_the_optimum}
