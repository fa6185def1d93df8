"""Registration with wrong pairs and a free scale: as with a rigid motion, by pieces of scale."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from certreg.certificate.producing_consensus import (
    ConsensusProver,
    ProvedConsensus,
    consensus_certificate,
    consensus_of,
    pose_of,
)
from certreg.errors import InvalidProblemError
from certreg.exact.decimals import at_least, at_most
from certreg.exact.dyadic import double_above, double_below
from certreg.geometry.similarity import Similarity
from certreg.problem.motion import Scale
from certreg.registration.consensus import (
    ConsensusRegistration,
    InlierProver,
    Ways,
    most_proved,
    restated,
)
from certreg.relaxation.consensus_search import candidates

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.certificate.consensus import ConsensusSimilarityBody
    from certreg.certificate.envelope import Certificate
    from certreg.problem.problem import RegistrationProblem
    from certreg.results import Verdict


DIGITS = 7  # of a scale, in words
NAMED_RANGES = 3  # of scales, in a sentence


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ScaledConsensusRegistration(ConsensusRegistration):
    """The same of motions y = s R x + t whose scale s is free.

    All attributes are those of `ConsensusRegistration`; the fit has a scale, asymmetric or
    symmetric as the problem says.
    """

    found: ProvedConsensus

    __repr__ = ConsensusRegistration.__repr__

    @property
    def pose(self) -> Similarity:
        """The least-squares pose, with its scale, of the pairs that are met."""
        pose = self.fit.pose
        assert isinstance(pose, Similarity)  # noqa: S101 - of a problem with a scale
        return pose

    @property
    def witness(self) -> Similarity:
        """A motion that meets all of them, exactly before it is rounded to doubles."""
        rigid = pose_of(self.found.witness)
        return Similarity(
            rotation=rigid.rotation,
            translation=rigid.translation,
            quaternion_wxyz=rigid.quaternion_wxyz,
            scale=float(self.found.witness.scale),
        )

    @property
    def headline(self) -> str:
        """What is proved, in words; where it is not proved of all scales, of which it is."""
        told = super(ScaledConsensusRegistration, self).headline
        some = self.undecided_scales
        if not some:
            return told
        body: Any = self.certificate.body
        met, where = self.lower, ranges_words(some)
        others = f"{'any other ' * body.met_elsewhere}{met}"
        return (
            f"{told} With scales {where} it is not proved which {met} are met; with all others "
            f"no motion brings {others} within."
        )

    @property
    def scale_interval(self) -> tuple[float, float]:
        """Between which scales all motions are that meet these pairs, proved; rounded outwards."""
        body: Any = self.certificate.body
        return double_below(body.scale_lower.value), double_above(body.scale_upper.value)

    @property
    def undecided_scales(self) -> tuple[tuple[float, float], ...]:
        """With which scales motions may meet as many pairs, or more, but others than these.

        Rounded outwards; an end may be 0 or infinite.
        """
        return tuple(
            (double_below(one.low), math.inf if one.high is None else double_above(one.high))
            for one in self.found.open_scales
        )


def ranges_words(some: Sequence[tuple[float, float]]) -> str:
    """For example: from 0.5 to 0.75 and from 2 on; rounded outwards."""
    told: list[str] = []
    for low, high in some:
        begin = f"from {at_least(low, DIGITS)}"
        end = "on" if math.isinf(high) else f"to {at_most(high, DIGITS)}"
        told.append(f"{begin} {end}")
    if len(told) > NAMED_RANGES:
        told = [*told[: NAMED_RANGES - 1], f"in {len(told) - NAMED_RANGES + 1} other ranges"]
    return " and ".join([", ".join(told[:-1]), told[-1]] if len(told) > 1 else told)


def _search(problem: RegistrationProblem, effort: float) -> ProvedConsensus | None:
    """Of all candidates the one of which most is proved."""
    block, prover = problem.points, ConsensusProver(problem, effort=effort)
    x, y = block.source, block.target
    best = most_proved(
        prover.prove(one.rotation, one.translation, one.scale, whole=False)
        for one in candidates(x, y, problem.bounds, free_scale=True, effort=effort)
    )
    if best is not None:
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
            message = (
                f"most pairs, {len(weighty)} that weigh, are met where all {name} points are one: "
                "they have no scale; leave pairs that repeat a point out"
            )
            raise InvalidProblemError(message, array=name, row=weighty[0])


def restated_scaled_consensus(
    problem: RegistrationProblem,
    certificate: Certificate[ConsensusSimilarityBody],
    verdict: Verdict,
) -> ConsensusRegistration:
    """As `restated_consensus`, of a free scale."""
    found = consensus_of(problem, certificate.body)
    return restated(problem, SCALED, found, certificate, verdict)


SCALED = Ways(
    motion="motion with a scale",
    free_scale=True,
    search=_search,
    certificate=consensus_certificate,
    candidates=partial(candidates, free_scale=True),
    result=ScaledConsensusRegistration,
)
PROVER = InlierProver(SCALED)
