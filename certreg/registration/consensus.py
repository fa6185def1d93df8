"""Registration with wrong pairs: the most pairs that one motion meets, and what is proved of them.

A candidate is found in doubles and its proof is tried; only where that leaves something open a
better candidate is sought: the proof is the stopping rule.
"""

from __future__ import annotations

import logging
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from certreg.certificate.checking import check_own_consensus, require_accepted
from certreg.certificate.producing_consensus import (
    ConsensusProver,
    ProvedConsensus,
    consensus_certificate,
    consensus_of,
    pose_of,
)
from certreg.errors import InvalidProblemError, UndecidedError
from certreg.exact.dyadic import double_above, double_below
from certreg.geometry.similarity import Similarity
from certreg.problem.arrays import apart
from certreg.problem.bounds import LEAST_PAIRS
from certreg.problem.budget import checked_effort
from certreg.problem.motion import Scale
from certreg.registration.consensus_words import PairLabels, headline, ranges_words, repeated_rows
from certreg.registration.exit_codes import (
    DONE,
    NOT_CERTIFIED,
    NOT_UNIQUE,
    code_of_registration,
    worst,
)
from certreg.registration.labelled import LabelledRegistration
from certreg.registration.no_consensus import nothing_met
from certreg.registration.pair_warnings import few_warning, poor_warning, wide_warning
from certreg.registration.pipeline import USUAL, Asked, Prover, Work
from certreg.registration.row_names import RowNames
from certreg.registration.squares import fitted
from certreg.relaxation.consensus_search import candidates

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from certreg.certificate.consensus import ConsensusBody, ConsensusSimilarityBody
    from certreg.certificate.envelope import Certificate
    from certreg.geometry.pose import Pose
    from certreg.problem.problem import RegistrationProblem
    from certreg.problem.support import Cell
    from certreg.registration.misfits import FitWarning
    from certreg.registration.result import Registration
    from certreg.results import Verdict


LOG = logging.getLogger(__name__)
SECOND_EFFORT = 0.3  # of the search among the other pairs: a hint, nothing of it is proved


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ConsensusRegistration(LabelledRegistration):
    """The pose of the pairs that are met, and what is proved of every pair.

    Attributes
    ----------
    problem
        As it was stated, with its bounds.
    found
        The witness, the rows that it meets and their labels.
    fit
        The least squares over these rows, a registration with its own proof. Its row k is
        `inliers[k]`, and is called so in words.
    certificate
        Of kind "consensus", of a free scale "consensus-similarity", the proof of the fit inside;
        the checker has accepted it.
    verdict
        The checker's.
    second
        How many of the other pairs another motion meets, as far as one was found; nothing of it is
        proved. None where fewer than three are left, or met.
    timings
        Seconds per phase.
    """

    problem: RegistrationProblem
    found: ProvedConsensus
    fit: Registration
    certificate: Certificate[ConsensusBody | ConsensusSimilarityBody]
    verdict: Verdict
    second: int | None
    timings: dict[str, float]

    def __repr__(self) -> str:
        met, n = len(self.found.met), self.problem.n
        word = "labels proved" if self.labels_unique else f"at most {self.upper} proved"
        return f"<{type(self).__name__}: {met} of {n} pairs within their bounds; {word}>"

    @property
    def pose(self) -> Pose | Similarity:
        """The least-squares pose of the pairs that are met, as the problem has a scale or not."""
        return self.fit.pose

    @property
    def witness(self) -> Pose | Similarity:
        """A motion that meets all of them, exactly before it is rounded to doubles."""
        rigid = pose_of(self.found.witness)
        if self.scale_interval is None:
            return rigid
        return Similarity(
            rotation=rigid.rotation,
            translation=rigid.translation,
            quaternion_wxyz=rigid.quaternion_wxyz,
            scale=float(self.found.witness.scale),
        )

    @property
    def scale_interval(self) -> tuple[float, float] | None:
        """Between which scales all motions are that meet these pairs, proved; rounded outwards.

        None where the scale is not free.
        """
        scales = self.certificate.body.scales
        return None if scales is None else (double_below(scales[0]), double_above(scales[1]))

    @property
    def undecided_scales(self) -> tuple[tuple[float, float], ...]:
        """With which scales motions may meet as many pairs, or more, but others than these.

        Rounded outwards; an end may be 0 or infinite. None of them where the scale is not free.
        """
        some = [] if self.scale_interval is None else self.found.open_scales
        return tuple(
            (double_below(one.low), math.inf if one.high is None else double_above(one.high))
            for one in some
        )

    @property
    def lower(self) -> int:
        """So many pairs one motion meets, proved."""
        return len(self.found.met)

    @property
    def upper(self) -> int:
        """No motion meets more, proved."""
        return self.found.upper

    @property
    def labels_unique(self) -> bool:
        """Whether it is proved that every motion that meets as many meets just these."""
        return self.found.decided

    @property
    def labels(self) -> tuple[str, ...]:
        """Of each pair: "inlier" or "outlier" in every motion that meets as many; "undecided"."""
        return self._counted.words

    @property
    def _counted(self) -> PairLabels:
        return PairLabels(self.found.labels)

    @property
    def met_rows(self) -> tuple[int, ...]:
        """Rows of the pairs that the witness meets."""
        return self.found.met

    @property
    def inliers(self) -> NDArray[np.intp]:
        """Rows of the pairs that the witness meets."""
        return np.array(self.found.met, dtype=np.intp)

    @property
    def residuals(self) -> NDArray[np.float64]:
        """(N,), how far each pair is off at `pose`, in the unit of length."""
        block = self.problem.points
        return apart(self.pose.apply(block.source), block.target)

    @property
    def broken(self) -> tuple[int, ...]:
        """Met rows that the least-squares pose leaves outside of their bounds."""
        off = self.residuals > self.problem.bounds
        return tuple(row for row in self.found.met if off[row])

    @property
    def headline(self) -> str:
        """What is proved, in words; where it is not proved of all scales, of which it is."""
        told = headline(self.problem, self.found, self.names, self.against)
        some = self.undecided_scales
        if not some:
            return told
        met, where = self.lower, ranges_words(some)
        others = f"{'any other ' * self.certificate.body.met_elsewhere}{met}"
        return (
            f"{told} With scales {where} it is not proved which {met} are met; with all others "
            f"no motion brings {others} within."
        )

    @property
    def good(self) -> bool:
        """Whether every label is proved, and nothing is to be said against pairs and pose."""
        return self.labels_unique and self.against is None

    @property
    def pair_warnings(self) -> tuple[FitWarning, ...]:
        """What the proof of the labels does not tell of the pairs."""
        again = len(repeated_rows(self.problem, range(self.problem.n)))
        met = self.lower - len(repeated_rows(self.problem, self.found.met))
        kind = "different pairs" if again else "pairs"
        few = few_warning(met, self.problem.n - again, kind)
        told = (few, wide_warning(self.problem), poor_warning(self.fit))
        return tuple(one for one in told if one is not None)

    @property
    def exit_code(self) -> int:
        """0: all labels proved; 3: the maximum, but not the labels; 4: less; or that of the fit."""
        own = NOT_UNIQUE if self.upper == self.lower else NOT_CERTIFIED
        return worst([DONE if self.labels_unique else own, code_of_registration(self.fit)])


@dataclass(frozen=True, slots=True, kw_only=True)
class Counted:
    """Pairs that one motion meets, with their least squares, and the proof of both."""

    problem: RegistrationProblem
    found: ProvedConsensus
    fit: Registration
    certificate: Certificate[Any]


class InlierProver(Prover[ProvedConsensus, Counted, ConsensusRegistration]):
    """Of the most pairs that one motion meets."""

    PARTS = 3  # consensus, fit, checker

    def accepts(self, cell: Cell) -> bool:
        """All that there are."""
        del cell
        return True

    def propose(self, problem: RegistrationProblem, asked: Asked, work: Work) -> ProvedConsensus:
        """The pairs that are met: each candidate is tried by its proof.

        Raises UndecidedError where no motion was found that meets three pairs.
        """
        prover = ConsensusProver(problem, effort=checked_effort(asked.effort))
        found = proved_consensus(problem, prover, asked.effort)
        work.lap("consensus")
        work.done("consensus")
        if found is None:
            raise UndecidedError(nothing_met(problem))
        return found

    def prove(
        self, problem: RegistrationProblem, proposal: ProvedConsensus, asked: Asked, work: Work
    ) -> Counted:
        """With the least squares, whose proof is inside.

        Raises InvalidProblemError where all pairs that were met have weight 0.
        """
        fit = _fit(problem, proposal, asked, RowNames.of(asked.about, problem.n))
        certificate = consensus_certificate(problem, proposal, fit.certificate, asked.about)
        work.lap("fit")
        work.done("fit")
        return Counted(problem=problem, found=proposal, fit=fit, certificate=certificate)

    def check(self, proved: Counted, work: Work) -> Verdict:
        """The checker's answer."""
        verdict = check_own_consensus(proved.certificate)
        require_accepted(verdict)
        work.lap("check")
        work.done("checker")
        return verdict

    def judge(
        self, proved: Counted, verdict: Verdict | None, asked: Asked, timings: dict[str, float]
    ) -> ConsensusRegistration:
        """With what another motion was seen to meet."""
        return ConsensusRegistration(
            problem=proved.problem,
            found=proved.found,
            fit=proved.fit,
            certificate=proved.certificate,
            verdict=cast("Verdict", verdict),  # there is a certificate
            second=_second(proved.problem, proved.found, asked.effort),
            timings=timings,
        )


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
    return ConsensusRegistration(
        problem=problem,
        found=found,
        fit=_fit(problem, found, USUAL, RowNames.of(certificate.about, problem.n)),
        certificate=certificate,
        verdict=verdict,
        second=_second(problem, found, 1.0),
        timings={},
    )


def proved_consensus(
    problem: RegistrationProblem, prover: ConsensusProver, effort: float
) -> ProvedConsensus | None:
    """Of all candidates the one of which most is proved."""
    block, rigid = problem.points, prover.pairs.rigid
    motions = candidates(
        block.source,
        block.target,
        problem.bounds,
        free_scale=not rigid,
        effort=effort,
        consistent=prover.graph.near if rigid else None,
    )
    best = most_proved(
        prover.prove(one.rotation, one.translation, one.scale, whole=False) for one in motions
    )
    if best is not None and not rigid:
        _require_spread(problem, best)
    return best if best is None or best.decided else prover.witnessed(best.witness)


def _require_spread(problem: RegistrationProblem, found: ProvedConsensus) -> None:
    """Refuses pairs that most motions meet and that have no best scale."""
    block, rows = problem.block(slice(None)), list(found.met)
    symmetric = problem.scale is Scale.SYMMETRIC
    clouds = {"source": block.source, **({"target": block.target} if symmetric else {})}
    weighty = [row for row in rows if block.weights[row] > 0.0] or rows
    for name, points in clouds.items():
        if (points[weighty] == points[weighty[0]]).all():
            raise InvalidProblemError(
                f"most pairs, {len(weighty)} that weigh, are met where all {name} points are one: "
                "they have no scale; leave pairs that repeat a point out",
                array=name,
                row=weighty[0],
            )


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
    met, factors = list(found.met), problem.factors
    own = problem.weights if factors is None else factors
    if not own[met].any():
        rows = RowNames(None).words(found.met[:3], len(found.met))
        one, array = ("weight", "weights") if factors is None else ("spring", "factors")
        raise InvalidProblemError(
            f"{one}s are 0 for all pairs that were met ({rows}): give one of them a {one}",
            array=array,
            value=0.0,
            row=found.met[0],
        )
    return fitted(problem.of_rows(met), met, names, asked)


def _second(problem: RegistrationProblem, found: ProvedConsensus, effort: float) -> int | None:
    """The most of the other pairs that a motion was seen to meet."""
    others = sorted(set(range(problem.n)) - set(found.met))
    if len(others) < LEAST_PAIRS:
        return None
    block = problem.points
    rest = block.source[others], block.target[others], problem.bounds[others]
    motions = candidates(*rest, free_scale=problem.scaled, effort=SECOND_EFFORT * effort)
    most = max((len(one.inliers) for one in motions), default=0)
    return most if most >= LEAST_PAIRS else None
