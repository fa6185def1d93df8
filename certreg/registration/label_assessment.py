"""Judging labels of any other tool: can one motion meet the inliers, and are they the most."""

from __future__ import annotations

import enum
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from certreg.certificate.joint_feasibility import CommonMotion, common_motion
from certreg.certificate.producing_consensus import ConsensusProver, pose_of
from certreg.errors import InvalidProblemError
from certreg.native.bitset_graph import colours
from certreg.problem.bounds import checked_inliers
from certreg.problem.budget import checked_effort
from certreg.registration.consensus import proved_consensus
from certreg.registration.consensus_words import within_words
from certreg.registration.exit_codes import DONE, NOT_CERTIFIED, REFUSED
from certreg.registration.row_names import RowNames
from certreg.results import Presented

if TYPE_CHECKING:
    from certreg.certificate.producing_consensus import ProvedConsensus
    from certreg.geometry.pose import Pose
    from certreg.problem.problem import RegistrationProblem


NAMED_ROWS = 8  # of the refuted ones, in a sentence


class LabelsVerdict(enum.Enum):
    """What is proved of labels; the value is the word used in files."""

    CONSISTENT = "consistent"
    REFUTED = "refuted"
    UNDECIDED = "undecided"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class KeptPairs(Presented):
    """What is proved of pairs that were labelled as inliers.

    Attributes
    ----------
    problem
        As it was stated, with its bounds.
    rows
        Those labelled as inliers.
    motion
        A motion that meets all of them, or few of them that none meets.
    most
        The most pairs that were found to be met by one motion, and what is proved of them; None
        where none was found that meets three.
    names
        Of the rows.
    sets
        So many sets hold all rows, of which no motion meets two of the same set: no motion meets
        more pairs than that.
    """

    problem: RegistrationProblem
    rows: tuple[int, ...]
    motion: CommonMotion
    most: ProvedConsensus | None
    names: RowNames
    sets: int

    def __repr__(self) -> str:
        return f"<KeptPairs: {len(self.rows)} of {self.problem.n} pairs; {self.verdict.value}>"

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

    @property
    def headline(self) -> str:
        """The verdict, with what is proved."""
        kept, within = len(self.rows), within_words(self.problem)
        if self.verdict is LabelsVerdict.CONSISTENT:
            return (
                f"CONSISTENT: one rigid motion brings all {kept} labelled inliers {within}; "
                f"{self._compared()}"
            )
        if self.verdict is LabelsVerdict.UNDECIDED:
            return (
                f"UNDECIDED: no rigid motion was found that brings all {kept} labelled inliers "
                f"{within}, and no proof that there is none. {self._most()}"
            )
        few = self.motion.refuted
        named = self.names.words(few[:NAMED_ROWS], len(few))
        return (
            f"REFUTED: no rigid motion brings all {kept} labelled inliers {within}, not even "
            f"{named} (from 0) together. {self._most()}"
        )

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
        named = self.names.words(rows[:NAMED_ROWS], len(rows))
        return f" Every motion that brings {self.lower} within has {named} (from 0), too: proved."

    def _most(self) -> str:
        if self.lower == self.upper:
            return f"The most pairs that one motion brings within are {self.lower}, proved."
        if self.most is None:
            return "No motion was found that brings three pairs within."
        between = f"{self.lower} to {self.upper}"
        return f"The most pairs that one motion brings within are {between}, proved."

    @property
    def exit_code(self) -> int:
        """0: consistent; 1: refuted; 4: neither is proved."""
        codes = {LabelsVerdict.CONSISTENT: DONE, LabelsVerdict.REFUTED: REFUSED}
        return codes.get(self.verdict, NOT_CERTIFIED)


def judged_labels(
    problem: RegistrationProblem,
    labels: Any,
    *,
    effort: float = 1.0,
    about: dict[str, Any] | None = None,
) -> KeptPairs:
    """What is proved of the pairs that the labels call inliers.

    labels: (N,), 0 and 1, booleans, or "outlier" and "inlier". about: with labels of the rows.
    Raises InvalidProblemError for other labels.
    """
    if problem.scaled:
        raise InvalidProblemError(
            "labels are judged for a rigid motion alone: with --scale let certify prove labels "
            "(certreg certify SOURCE TARGET --scale NAME --max-residual X --out FOLDER), and "
            "compare yours with the column `proved` of FOLDER/fit.csv",
            array="scale",
            value=problem.scale.value,
        )
    rows = checked_inliers(labels, problem.n)
    prover = ConsensusProver(problem, effort=checked_effort(effort))
    motion, most = common_motion(prover, rows), proved_consensus(problem, prover, effort)
    if motion.witness is not None:
        own = prover.witnessed(motion.witness)
        if most is None or (own is not None and own.worth > most.worth):
            most = own
    return KeptPairs(
        problem=problem,
        rows=rows,
        motion=motion,
        most=most,
        names=RowNames.of(about or {}, problem.n),
        sets=colours((1 << problem.n) - 1, prover.graph.near.integers, problem.n),
    )
