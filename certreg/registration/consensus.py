"""Registration with wrong pairs: the most pairs that one motion meets, and what is proved of them.

A candidate is found in doubles and its proof is tried; only where that leaves something open a
better candidate is sought: the proof is the stopping rule.
"""

from __future__ import annotations

import logging
from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.certificate.checking import check_own_consensus, require_accepted
from certreg.certificate.producing_consensus import (
    ConsensusProver,
    ProvedConsensus,
    consensus_certificate,
    consensus_of,
)
from certreg.errors import DegenerateProblemError, InvalidProblemError, UndecidedError
from certreg.problem.bounds import LEAST_PAIRS
from certreg.problem.budget import checked_effort
from certreg.registration.labelled import ConsensusRegistration
from certreg.registration.pair_words import motion_words
from certreg.registration.pipeline import USUAL, Asked, Prover, Work
from certreg.registration.row_names import RowNames
from certreg.registration.squares import fitted
from certreg.relaxation.proposals import candidates

if TYPE_CHECKING:
    from certreg.certificate.consensus import ConsensusBody, ConsensusSimilarityBody
    from certreg.certificate.envelope import Certificate
    from certreg.problem.problem import RegistrationProblem
    from certreg.registration.result import Registration
    from certreg.results import Verdict


LOG = logging.getLogger(__name__)
LABELS = {"i": "inlier", "o": "outlier", "?": "undecided"}  # of a certificate
SECOND_EFFORT = 0.3  # of the search among the other pairs: a hint, nothing of it is proved


class InlierProver(Prover[ProvedConsensus, ConsensusRegistration, ConsensusRegistration]):
    """Of the most pairs that one motion meets."""

    PARTS = 3  # consensus, fit, checker

    def propose(self, problem: RegistrationProblem, asked: Asked, work: Work) -> ProvedConsensus:
        """The pairs that are met: each candidate is tried by its proof.

        Raises UndecidedError where no motion was found that meets three pairs.
        """
        prover = ConsensusProver(problem, effort=checked_effort(asked.effort))
        found = proved_consensus(problem, prover, asked.effort)
        work.lap("consensus")
        work.done("consensus")
        if found is None:
            raise UndecidedError(_nothing_met(prover))
        return found

    def prove(
        self, problem: RegistrationProblem, proposal: ProvedConsensus, asked: Asked, work: Work
    ) -> ConsensusRegistration:
        """With the least squares, whose proof is inside.

        Raises InvalidProblemError where all pairs that were met have weight 0.
        """
        fit = _fit(problem, proposal, asked, RowNames.of(asked.about, problem.n))
        certificate = consensus_certificate(problem, proposal, fit.certificate, asked.about)
        work.lap("fit")
        work.done("fit")
        return _labelled(problem, proposal, fit, certificate)

    def check(self, proved: ConsensusRegistration, work: Work) -> Verdict:
        """The checker's answer."""
        verdict = check_own_consensus(proved.certificate)
        require_accepted(verdict)
        work.lap("check")
        work.done("checker")
        return verdict

    def judge(
        self,
        proved: ConsensusRegistration,
        verdict: Verdict | None,
        asked: Asked,
        timings: dict[str, float],
    ) -> ConsensusRegistration:
        """With what another motion was seen to meet."""
        second = _second(proved, asked.effort)
        return replace(proved, verdict=verdict, second=second, timings=timings)


PROVER = InlierProver()


def restated_consensus(
    problem: RegistrationProblem,
    certificate: Certificate[ConsensusBody | ConsensusSimilarityBody],
    verdict: Verdict,
) -> ConsensusRegistration:
    """As a certificate says that the checker has accepted for the problem.

    The least squares, and what another motion fits, are computed anew.
    """
    found = consensus_of(problem, certificate.body)
    fit = _fit(problem, found, USUAL, RowNames.of(certificate.about, problem.n))
    return PROVER.judge(_labelled(problem, found, fit, certificate), verdict, USUAL, {})


def _labelled(
    problem: RegistrationProblem,
    found: ProvedConsensus,
    fit: Registration,
    certificate: Certificate[Any],
) -> ConsensusRegistration:
    """What was proved, before anybody has checked it."""
    return ConsensusRegistration(
        problem=problem,
        labels=tuple(LABELS[letter] for letter in found.labels),
        inliers=np.array(found.met, dtype=np.intp),
        found=found,
        fit=fit,
        certificate=certificate,
        verdict=None,
        second=None,
        timings={},
    )


def _nothing_met(prover: ConsensusProver) -> str:
    """Why no motion was found that brings three pairs within, and what may help."""
    motion = motion_words(prover.problem).one
    if not prover.pairs.scattered():
        return (
            f"no {motion} was found that brings {LEAST_PAIRS} pairs within their bounds: all may "
            "be wrong; if right ones may be farther off, give wider bounds, else more --effort"
        )
    return (
        f"no {motion} brings {LEAST_PAIRS} pairs within their bounds: no three of them keep their "
        "distances from each other. All may be wrong; if one cloud is in another unit, give "
        "--scale asymmetric; if right pairs may be farther off, give wider bounds"
    )


def proved_consensus(
    problem: RegistrationProblem, prover: ConsensusProver, effort: float
) -> ProvedConsensus | None:
    """Of all candidates the one of which most is proved."""
    block, scaled = problem.points, problem.scaled
    motions = candidates(
        block.source,
        block.target,
        problem.bounds,
        free_scale=scaled,
        effort=effort,
        consistent=None if scaled else prover.graph.near,
    )
    best = most_proved(
        prover.prove(one.rotation, one.translation, one.scale, whole=False) for one in motions
    )
    return best if best is None or best.decided else prover.witnessed(best.witness)


def most_proved(tried: Iterable[ProvedConsensus | None]) -> ProvedConsensus | None:
    """Of all that is proved with candidates the most; none is tried once none can have more."""
    best = None
    for found in tried:
        if found is not None and (best is None or found.worth > best.worth):
            best = found
            LOG.info(
                "%d of %d pairs within their bounds, at most %d (proved); searching on ...",
                len(best.met),
                len(best.labels),
                best.upper,
            )
        if best is not None and best.upper == len(best.met):
            break
    return best


def _fit(
    problem: RegistrationProblem, found: ProvedConsensus, asked: Asked, names: RowNames
) -> Registration:
    """The least squares over the pairs that are met; its rows say which of all they are."""
    met = list(found.met)
    rows = RowNames(None).words(found.met[:3], len(met))
    try:
        return fitted(problem.of_rows(met), met, names, asked)
    except InvalidProblemError as error:  # none of them counts
        message = f"of the pairs that were met ({rows}) {error}; give one of them more than 0"
        raise InvalidProblemError(message, array=error.array, value=0.0, row=met[0]) from error
    except DegenerateProblemError as error:  # they have no scale
        message = f"of the pairs that were met ({rows}) {error}, or leave pairs that repeat a point"
        raise DegenerateProblemError(f"{message} out", rank=error.rank) from error


def _second(proved: ConsensusRegistration, effort: float) -> int | None:
    """The most of the other pairs that a motion was seen to meet."""
    problem, free = proved.problem, proved.scale_interval is not None
    others = sorted(set(range(problem.n)) - set(proved.found.met))
    if len(others) < LEAST_PAIRS:
        return None
    block = problem.points
    rest = block.source[others], block.target[others], problem.bounds[others]
    motions = candidates(*rest, free_scale=free, effort=SECOND_EFFORT * effort)
    most = max((len(one.inliers) for one in motions), default=0)
    return most if most >= LEAST_PAIRS else None
