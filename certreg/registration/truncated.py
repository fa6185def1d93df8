"""Registration by truncated squares, of rotations alone: the least cost, and what is proved.

The search is in doubles, over all rotations; what it finds counts only as far as the checker, which
searches again in integers, accepts the certificate.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.certificate.truncated import truncated_certificate
from certreg.errors import UndecidedError
from certreg.exact.decimals import at_least, at_most
from certreg.exact.dyadic import double_above
from certreg.geometry.pose import Pose
from certreg.geometry.so3 import rotation_matrix
from certreg.problem.arrays import apart
from certreg.problem.effort import checked_effort
from certreg.problem.problem import RegistrationProblem
from certreg.registration.consensus_words import others_words
from certreg.registration.exit_codes import DONE, NOT_CERTIFIED, NOT_UNIQUE
from certreg.registration.labelled import LabelledRegistration
from certreg.registration.nothing_met import nothing_turned
from certreg.registration.pair_angles import angles_between
from certreg.registration.pair_warnings import poor_warning, wide_warning
from certreg.registration.pipeline import USUAL, Asked, Prover, Work
from certreg.registration.result import Registration
from certreg.registration.row_names import RowNames
from certreg.registration.squares import fitted
from certreg.relaxation.rotation_boxes import BoxSearch, search_boxes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.certificate.checking import CertificateVerdict
    from certreg.certificate.envelope import Certificate
    from certreg.certificate.truncated import TruncatedRotationBody
    from certreg.problem.support import Cell
    from certreg.registration.misfits import FitWarning
    from certreg.results import Verdict


WORDS = {1: "inlier", 0: "outlier", -1: "undecided"}
LETTERS = {"1": "inlier", "0": "outlier", "?": "undecided"}  # of a certificate
NAMED_ROWS = 5  # of the undecided ones, in a sentence
COST_DIGITS = 6  # of a cost in the first line


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TruncatedRegistration(LabelledRegistration):
    """The rotation of least truncated cost, and what is proved of it and of every pair.

    Attributes
    ----------
    problem
        As it was stated, with its bounds.
    cost
        Sum of min((residual / bound)^2, 1) at the rotation, rounded.
    labels
        Of each pair: "inlier", "outlier" (within, or beyond its bound at every optimum), or
        "undecided".
    rows
        Of the pairs within their bounds at the rotation.
    fit
        The least squares over the pairs within their bounds, weighed by 1 / bound^2: a registration
        with its own proof, whose rotation is that of the least cost.
    certificate
        Of kind "truncated-rotation"; None where the checker accepted none.
    verdict
        The checker's.
    timings
        Seconds per phase.
    """

    problem: RegistrationProblem
    cost: float
    labels: tuple[str, ...]
    rows: NDArray[np.intp]
    fit: Registration
    certificate: Certificate[TruncatedRotationBody] | None
    verdict: CertificateVerdict
    timings: dict[str, float]

    def __repr__(self) -> str:
        within = self.labels.count("inlier")
        return (
            f"<TruncatedRegistration: cost {self.cost:.6g}; {within} of {self.problem.n} inliers>"
        )

    @property
    def pose(self) -> Pose:
        """The rotation; its translation is 0."""
        pose = self.fit.pose
        assert isinstance(pose, Pose)  # noqa: S101 - the fit has no scale
        return pose

    @property
    def labels_unique(self) -> bool:
        """Whether it is proved of every pair on which side of its bound it is at every optimum."""
        return "undecided" not in self.labels

    @property
    def unique(self) -> bool:
        """Whether the optimum is proved to be one single rotation."""
        return self.certificate is not None and self.certificate.body.claims.unique

    @property
    def gap(self) -> float | None:
        """The cost exceeds the least one by less, proved; None where nothing is."""
        return None if self.certificate is None else double_above(self.certificate.body.gap)

    @property
    def residuals(self) -> NDArray[np.float64]:
        """(N,), how far each pair is off at `pose`, in the unit of length."""
        return apart(self.problem.source @ self.pose.rotation.T, self.problem.target)

    @property
    def angles(self) -> NDArray[np.float64]:
        """(N,), radians, between the two points of each pair at `pose`; NaN where one is 0."""
        return angles_between(self.problem.source @ self.pose.rotation.T, self.problem.target)

    @property
    def met_rows(self) -> list[int]:
        """`rows`, as integers."""
        return self.rows.tolist()

    @property
    def pair_warnings(self) -> tuple[FitWarning, ...]:
        """What the proof of the labels does not tell of the pairs."""
        told = (wide_warning(self.problem), poor_warning(self.fit))
        return tuple(one for one in told if one is not None)

    @property
    def good(self) -> bool:
        """Whether all is proved, and nothing is to be said against pairs and rotation."""
        return self.exit_code == DONE and self.against is None

    @property
    def certified(self) -> bool:
        """Whether all labels are proved, and a gap and, if it is unique, an angle in the limits."""
        worth, limits = self.verdict.worth, self.fit.limits
        if self.certificate is None or worth is None or not self.labels_unique:
            return False
        near = not self.unique or (worth.angle is not None and worth.angle <= limits.max_angle)
        return worth.share <= limits.max_gap and near

    @property
    def headline(self) -> str:
        """What is proved, in words."""
        out, within = self.labels.count("outlier"), self._within.capitalize()
        worth = self.verdict.worth
        if self.gap is None or worth is None:
            return f"NOT PROVED: a rotation of truncated cost {self.cost:.6g} was found."
        if not self.certified:
            rows = [row for row, word in enumerate(self.labels) if word == "undecided"]
            told = f" ({self.names.counted(rows[:NAMED_ROWS], len(rows))})" if rows else ""
            cost = at_most(worth.objective, COST_DIGITS)
            return (
                f"PARTLY PROVED: the truncated cost is at most {cost}, and less than "
                f"{at_most(self.gap, 2)} above the least. {within} at every optimum, {out} at "
                f"none; {len(rows)} undecided{told}."
            )
        others = f". {others_words(out)} at EVERY optimum." if out else ": no outliers."
        least = at_least(worth.minimum, COST_DIGITS)
        if self.unique:
            but = "" if self.against is None else f", BUT {self.against}"
            return (
                f"CERTIFIED{but}: no rotation has a smaller truncated cost than {least}, and "
                f"{self._within} there{others}"
            )
        return (
            f"CERTIFIED, NOT UNIQUE: no rotation has a smaller truncated cost than {least}; one "
            f"single rotation is not proved. {within} at every optimum{others}"
        )

    @property
    def _within(self) -> str:
        """How many pairs are proved to be within their bounds, in words."""
        n, within = self.problem.n, self.labels.count("inlier")
        if within == n:
            return f"all {n} pairs are within their bounds"
        verb = "is within its bound" if within == 1 else "are within their bounds"
        return f"{within} of the {n} pairs {verb}"

    @property
    def exit_code(self) -> int:
        """0: labels and one rotation proved; 3: the labels alone; 4: less."""
        return (DONE if self.unique else NOT_UNIQUE) if self.certified else NOT_CERTIFIED


class TruncatedProver(Prover[BoxSearch, TruncatedRegistration, TruncatedRegistration]):
    """Of the least truncated squares of rotations alone."""

    PARTS = 3  # search, certificate and checker, fit

    def accepts(self, cell: Cell) -> bool:
        """All that there are."""
        return cell.rotation_only

    def propose(self, problem: RegistrationProblem, asked: Asked, work: Work) -> BoxSearch:
        """The best of a search over all rotations."""
        effort = checked_effort(asked.effort)
        found = search_boxes(problem.source, problem.target, problem.bounds, effort=effort)
        work.lap("search")
        work.done("search")
        return found

    def prove(
        self, problem: RegistrationProblem, proposal: BoxSearch, asked: Asked, work: Work
    ) -> TruncatedRegistration:
        """The certificate that the checker accepts, if one is, and the least squares.

        Raises UndecidedError where no rotation was found that brings a pair within its bound.
        """
        certificate, verdict = truncated_certificate(
            problem, proposal.quaternion, proposal.labels, proposal.gap, about=asked.about
        )
        work.lap("certificate")
        work.done("certificate")
        fit = _fit(problem, proposal.within, asked, asked.about)
        work.lap("fit")
        work.done("fit")
        labels = proposal.labels.tolist() if certificate else [-1] * problem.n
        return TruncatedRegistration(
            problem=problem,
            cost=proposal.cost,
            labels=tuple(WORDS[label] for label in labels),
            rows=np.flatnonzero(proposal.within),
            fit=fit,
            certificate=certificate,
            verdict=verdict,
            timings=work.timings,
        )

    def check(self, proved: TruncatedRegistration, work: Work) -> CertificateVerdict:
        """The checker's answer, which chose what is claimed."""
        del work
        return proved.verdict

    def judge(
        self,
        proved: TruncatedRegistration,
        verdict: Verdict | None,
        asked: Asked,
        timings: dict[str, float],
    ) -> TruncatedRegistration:
        """As it was proved."""
        del verdict, asked, timings
        return proved


PROVER = TruncatedProver()


def restated_truncated(
    problem: RegistrationProblem,
    certificate: Certificate[TruncatedRotationBody],
    verdict: CertificateVerdict,
) -> TruncatedRegistration:
    """As a certificate says that the checker has accepted for the problem.

    The least squares over the pairs within their bounds at its rotation are computed anew. The cost
    is that of its rotation, which is no less than that of theirs.
    """
    body = certificate.body
    q = np.array([float(entry) for entry in body.quaternion])
    turned = problem.source @ np.array(rotation_matrix((q / np.linalg.norm(q)).tolist())).T
    squares = (((problem.target - turned) / problem.bounds[:, np.newaxis]) ** 2).sum(axis=1)
    within = squares <= 1.0
    if not within.any():
        raise UndecidedError(
            "the rotation of the certificate brings no pair within its bound: there is no pair to "
            "fit it to"
        )
    return TruncatedRegistration(
        problem=problem,
        cost=float(np.minimum(squares, 1.0).sum()),
        labels=tuple(LETTERS[letter] for letter in body.claims.labels),
        rows=np.flatnonzero(within),
        fit=_fit(problem, within, USUAL, certificate.about),
        certificate=certificate,
        verdict=verdict,
        timings={},
    )


def _fit(
    problem: RegistrationProblem,
    rows: NDArray[np.bool_],
    asked: Asked,
    about: dict[str, Any],
) -> Registration:
    """The least squares over some pairs; about: of all."""
    names = RowNames.of(about, problem.n)
    fit = fitted(_of_rows(problem, rows), np.flatnonzero(rows).tolist(), names, asked)
    assert isinstance(fit, Registration)  # noqa: S101 - of one weight per pair
    return fit


def _of_rows(problem: RegistrationProblem, rows: NDArray[np.bool_]) -> RegistrationProblem:
    """The least squares over some pairs; equal bounds weigh 1."""
    if not rows.any():
        raise UndecidedError(nothing_turned(problem))
    bounds = problem.bounds[rows]
    return RegistrationProblem(
        problem.source[rows],
        problem.target[rows],
        weights=(bounds.min() / bounds) ** 2,
        damping=problem.damping if problem.damping_given else None,
        rotation_only=True,
    )
