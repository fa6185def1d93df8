"""Registration by truncated squares, of rotations alone: the least cost, and what is proved.

The search is in doubles, over all rotations; what it finds counts only as far as the checker, which
searches again in integers, accepts the certificate.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.certificate.truncated import TruncatedRotationBody, truncated_certificate
from certreg.errors import UndecidedError
from certreg.exact.decimals import at_least
from certreg.geometry.so3 import rotation_matrix
from certreg.problem.arrays import lengths
from certreg.problem.budget import checked_effort
from certreg.problem.problem import RegistrationProblem
from certreg.registration.labelled import TruncatedRegistration
from certreg.registration.pipeline import USUAL, Asked, Prover, Work
from certreg.registration.row_names import RowNames
from certreg.registration.squares import fitted
from certreg.relaxation.rotation_boxes import BoxSearch, search_boxes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.certificate.checking import CertificateVerdict
    from certreg.certificate.envelope import Certificate
    from certreg.registration.result import Registration
    from certreg.results import Verdict


WORDS = {1: "inlier", 0: "outlier", -1: "undecided"}
LETTERS = {"1": "inlier", "0": "outlier", "?": "undecided"}  # of a certificate
ROUNDING = 2.0**-48  # of the sum of two lengths: their difference errs by less


class TruncatedProver(Prover[BoxSearch, TruncatedRegistration, TruncatedRegistration]):
    """Of the least truncated squares of rotations alone."""

    PARTS = 3  # search, certificate and checker, fit

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
            inliers=np.flatnonzero(proposal.within),
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
        inliers=np.flatnonzero(within),
        fit=_fit(problem, within, USUAL, certificate.about),
        certificate=certificate,
        verdict=verdict,
        timings={},
    )


def _fit(
    problem: RegistrationProblem, within: NDArray[np.bool_], asked: Asked, about: dict[str, Any]
) -> Registration:
    """The least squares over the pairs within; equal bounds weigh 1. about: of all."""
    if not within.any():
        raise UndecidedError(nothing_turned(problem))
    bounds = problem.bounds[within]
    stated = RegistrationProblem(
        problem.source[within],
        problem.target[within],
        weights=(bounds.min() / bounds) ** 2,
        damping=problem.damping if problem.damping_given else None,
        rotation_only=True,
    )
    names = RowNames.of(about, problem.n)
    return fitted(stated, np.flatnonzero(within).tolist(), names, asked)


def nothing_turned(problem: RegistrationProblem) -> str:
    """Why no rotation was found that brings a pair within its bound, and what may help."""
    sizes = [lengths(points) for points in (problem.source, problem.target)]
    apart = np.abs(sizes[0] - sizes[1])
    apart -= ROUNDING * sizes[0] + ROUNDING * sizes[1]
    if (apart <= problem.bounds).any():
        return (
            "no rotation was found that brings a pair within its bound: give more --effort, or "
            "wider bounds if right pairs may be farther off"
        )
    return (
        "no rotation brings a pair within its bound: the two points of each are at distances from "
        f"the origin that differ by {at_least(float(apart.min()))} or more. If a translation "
        "is to be found, leave out --rotation-only and --objective truncated; if the clouds differ "
        "in scale, bring them to one unit; if right pairs may be that far off, give wider bounds"
    )
