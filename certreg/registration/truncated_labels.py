"""Judging labels of rotations: whether an optimum of truncated squares has just these within.

One 4x4 matrix disproves labels beside a good rotation, whether its optimality is proved or not;
that an optimum has them is proved only where the search over all rotations left no label open.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from certreg.certificate.truncated import disproves_labels
from certreg.problem.bounds import LEAST_DIRECTIONS, checked_inliers
from certreg.registration.consensus_words import within_words
from certreg.registration.exit_codes import DONE, NOT_CERTIFIED, REFUSED
from certreg.registration.kept_pairs import NAMED_ROWS, LabelsVerdict
from certreg.registration.pipeline import Asked, Work
from certreg.registration.truncated import PROVER
from certreg.results import Presented

if TYPE_CHECKING:
    from certreg.problem.problem import RegistrationProblem
    from certreg.registration.truncated import TruncatedRegistration


BITS = 60  # of the entries of a quaternion


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TruncatedLabels(Presented):
    """What is proved of pairs that were labelled as inliers, of truncated squares over rotations.

    Attributes
    ----------
    optimum
        The rotation of least truncated cost, as far as it was found, and what is proved of all
        pairs.
    rows
        Those labelled as inliers.
    disproved
        Whether no optimum has just these within their bounds, by one 4x4 matrix.
    """

    optimum: TruncatedRegistration
    rows: tuple[int, ...]
    disproved: bool

    @classmethod
    def of(cls, optimum: TruncatedRegistration, rows: tuple[int, ...]) -> TruncatedLabels:
        """What one matrix says of the rows, beside this rotation."""
        kept = set(rows)
        within = [row in kept for row in range(optimum.problem.n)]
        q = [round(entry * 2.0**BITS) for entry in optimum.pose.quaternion_wxyz.tolist()]
        disproved = disproves_labels(optimum.problem, within, q)
        return cls(optimum=optimum, rows=rows, disproved=disproved)

    def __repr__(self) -> str:
        n = self.optimum.problem.n
        return f"<TruncatedLabels: {len(self.rows)} of {n} pairs; {self.verdict.value}>"

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

    @property
    def headline(self) -> str:
        """The verdict, with what is proved."""
        kept, optimum = len(self.rows), self.optimum
        within = within_words(optimum.problem)
        if self.verdict is LabelsVerdict.CONSISTENT:
            return (
                f"CONSISTENT: at every optimum of the truncated cost these {kept} pairs are "
                f"{within}, and only these: proved."
            )
        if self.verdict is LabelsVerdict.UNDECIDED:
            return (
                f"UNDECIDED: it is not proved that an optimum of the truncated cost has just these "
                f"{kept} pairs {within}, nor that none has. {self._open()}"
            )
        matrix = ", by one 4x4 matrix" if self.disproved else ""
        return (
            f"REFUTED: no optimum of the truncated cost has just these {kept} pairs {within}"
            f"{matrix}. {self._others()}"
        )

    def _others(self) -> str:
        """What the proved labels are, where they differ."""
        rows = self.differing
        if not rows:
            return f"Which labels are wrong is not proved. {self._open()}"
        one = len(rows) == 1
        named = self.optimum.names.words(rows[:NAMED_ROWS], len(rows))
        word = "has the other label" if one else "have the other label"
        return f"At every optimum {named} (from 0) {word}: proved." + (
            "" if self.optimum.labels_unique else f" {self._open()}"
        )

    def _open(self) -> str:
        """Of which pairs nothing is proved."""
        labels = self.optimum.labels
        rows = [row for row, word in enumerate(labels) if word == "undecided"]
        named = self.optimum.names.counted(rows[:NAMED_ROWS], len(rows))
        verb = "is" if len(rows) == 1 else "are"
        return f"Of the {len(labels)} pairs {len(rows)} {verb} undecided ({named})."

    @property
    def exit_code(self) -> int:
        """0: consistent; 1: refuted; 4: neither is proved."""
        codes = {LabelsVerdict.CONSISTENT: DONE, LabelsVerdict.REFUTED: REFUSED}
        return codes.get(self.verdict, NOT_CERTIFIED)


def judged_truncated_labels(
    problem: RegistrationProblem,
    labels: Any,
    *,
    effort: float = 1.0,
    about: dict[str, Any] | None = None,
) -> TruncatedLabels:
    """What is proved of the pairs that the labels call inliers, at the optima of truncated squares.

    labels: (N,), 0 and 1, booleans, or "outlier" and "inlier". about: with labels of the rows.
    Raises InvalidProblemError for other labels, and where fewer than two are inliers;
    UndecidedError where no rotation was found that brings a pair within its bound.
    """
    rows = checked_inliers(labels, problem.n, LEAST_DIRECTIONS)
    asked = Asked(effort=effort, about=about or {})
    optimum = PROVER.certified(problem, asked, Work())
    return TruncatedLabels.of(optimum, rows)
