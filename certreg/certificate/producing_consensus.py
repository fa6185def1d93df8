"""Producing a certificate of consensus from a motion that meets many pairs.

Stages, each a set of strikes: with K = the number of pairs met, what is left are the pairs that any
motion that meets K or more can meet. If these are just the met ones, all labels are proved and K is
the maximum. Else K + 1 is tried, and whether the others are enough without each met pair.

All this is done for each piece of scale. A rigid motion has one scale. Where it is free, a piece
that leaves more pairs than these, or others, is cut in two, until it is so narrow that motions with
its scales differ by a small part of a bound.
"""

from __future__ import annotations

import heapq
import json
import logging
import math
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from certreg._loading import cached_property
from certreg.certificate.angle_bound import ANGLE_BITS, reach_of, turn_about
from certreg.certificate.consensus import (
    OPEN,
    RIGID,
    UNDECIDED,
    ConsensusBody,
    ConsensusSimilarityBody,
    Piece,
    Reach,
    ScaledWitness,
    ScaleRange,
    Witness,
    ranges,
)
from certreg.certificate.consistency import END_BITS, ConsistentPairs
from certreg.certificate.edge_elimination import MOST_TURNED
from certreg.certificate.envelope import Certificate, enclosed
from certreg.certificate.proof_stages import MOST, Part, Stager, length_of, settled
from certreg.certificate.vertex_elimination import Graph
from certreg.errors import UndecidedError
from certreg.exact.dyadic import Dyadic, dyadic_above, dyadic_below
from certreg.geometry.pose import Pose
from certreg.geometry.so3 import davenport_matrix, rotation_matrix
from certreg.native.bitset_graph import BitRows, mask_of
from certreg.native.cliques import greedy_clique
from certreg.problem.bounds import LEAST_PAIRS
from certreg.problem.support import PREFIXES
from certreg.verify import CONSENSUS, SPRUNG, ConsensusSimilarityStatement

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.certificate.pose_claims import PoseBody
    from certreg.problem.problem import RegistrationProblem


LOG = logging.getLogger(__name__)
OPEN_TOLD = "ranges of scales left open are looked at one by one ..."
TOLD = "%d ranges of scales, %d of them still open; proving on ..."
MOST_PIECES = 400  # that are kept, at effort 1
# At effort 1, at once: where labels are proved, two or three; where pairs agree by chance, they are
# ever more, and cutting on tells nothing of labels. Few while another witness may replace this one.
MOST_OPEN, FEW_OPEN = 16, 4
MOST_BITS = 1 << 30  # of the graphs of all pieces, as in the checker
NARROW = 1.0 / 16.0  # of the least bound: what the ends of a piece that is not cut differ by
OUTWARDS = 1e-6  # of a bound on scales: doubles err by far less


@dataclass(frozen=True, slots=True, eq=False)
class ProvedConsensus:
    """What is proved with one motion: witness, the rows that it meets, and what follows.

    labels: of each row "i", "o" or "?". upper: no motion meets more. pieces: of scale, with their
    stages; states: of each piece.
    """

    witness: Witness
    met: tuple[int, ...]
    labels: str
    upper: int
    pieces: tuple[Piece, ...]
    states: str

    @property
    def decided(self) -> bool:
        """Whether every label is proved."""
        return UNDECIDED not in self.labels

    @property
    def worth(self) -> tuple[int, int, int]:
        """To compare two: pairs met, then labels proved, then how low the bound is."""
        return len(self.met), len(self.labels) - self.labels.count(UNDECIDED), -self.upper

    @property
    def open_scales(self) -> list[ScaleRange]:
        """With which it is not proved that those that meet as many pairs meet the same."""
        return ranges(self.pieces, self.states, OPEN)


class ConsensusProver:
    """Proves as much as it can of one problem; what holds for all motions is found once."""

    def __init__(self, problem: RegistrationProblem, *, effort: float = 1.0) -> None:
        self.problem = problem
        self.pairs = ConsistentPairs.of(problem)
        self._effort = effort
        most = MOST_BITS // problem.n**2
        self._most = max(2, min(round(MOST_PIECES * effort), most))

    def prove(
        self,
        rotation: NDArray[np.float64],
        translation: NDArray[np.float64],
        scale: float = 1.0,
        *,
        whole: bool = True,
    ) -> ProvedConsensus | None:
        """What is proved with this motion as witness; None where it meets too few pairs.

        whole: False: no more than whether all labels are, or that no motion meets more pairs.
        """
        witness = self.pairs.witness(rotation, translation, scale)
        return self.witnessed(witness, whole=whole) if scale > 0.0 else None

    def witnessed(self, witness: Witness, *, whole: bool = True) -> ProvedConsensus | None:
        """The same of a witness."""
        met = self.pairs.met_by(witness)
        if len(met) < LEAST_PAIRS:
            return None
        parts = self._parts(met, witness.scale, whole=whole)
        progress = partial(LOG.info, OPEN_TOLD) if len(parts) > 1 else tuple
        labels, upper = settled(parts, whole=whole, progress=progress)
        pieces = tuple(Piece(end=_end(part.scales), stages=tuple(part.stages)) for part in parts)
        states = "".join(part.state for part in parts)
        return ProvedConsensus(witness, tuple(met), labels, upper, pieces, states)

    def _parts(self, met: list[int], scale: Fraction, *, whole: bool) -> list[Part]:
        """Of all scales, in order: the widest of those that are open is cut, again and again.

        Until so many are open at once that cutting will not end, or the certificate is full.
        """
        found: list[Part] = []
        queue: list[tuple[float, Fraction, Part]] = []

        def add(part: Part) -> None:
            width = self._width(part.scales) if part.state == OPEN else 0.0
            if width > 0.0:
                heapq.heappush(queue, (-width, part.scales.low, part))
            else:
                found.append(part)

        for scales in self.pairs.ranges(scale):
            add(self._thinned(scales, met, whole=whole))
        held = sum(part.length for part in found) + sum(part.length for _, _, part in queue)
        most_open = max(1, round((MOST_OPEN if whole else FEW_OPEN) * self._effort))
        while queue and len(queue) <= most_open and len(found) + len(queue) < self._most:
            part = heapq.heappop(queue)[2]
            middle, ends = _middle(part.scales), part.scales
            halves = [
                self._thinned(ScaleRange(*range_), met, whole=whole)
                for range_ in ((ends.low, middle), (middle, ends.high))
            ]
            held += sum(half.length for half in halves) - part.length
            if held > MOST * 3 // 4:  # the rest is for what follows from the first stages
                found.append(part)
                break
            for half in halves:
                add(half)
            LOG.info(TOLD, len(found) + len(queue), len(queue))
        found += [part for _, _, part in queue]
        return sorted(found, key=lambda part: part.scales.low)

    def _width(self, scales: ScaleRange) -> float:
        """What the ends differ by, in shares of the scale; 0 where it is not worth cutting."""
        low, high = self.pairs.in_units(scales.low), self.pairs.in_units(scales.high)
        if low <= 0.0 or not np.isfinite(high):
            return 1e300 if self._reaches(low, high) else 0.0
        size = float(np.linalg.norm(np.ptp(self.pairs.source, axis=0)))
        small = (high - low) * size <= NARROW * float(self.pairs.bounds.min())
        return 0.0 if small else high / low - 1.0

    def _reaches(self, low: float, high: float) -> bool:
        """Whether some pair tells scales of an end piece apart."""
        if low <= 0.0:
            return bool((self.pairs.scales.least[self.pairs.scales.least > 0.0] <= high).any())
        finite = self.pairs.scales.most[np.isfinite(self.pairs.scales.most)]
        return bool((finite >= low).any())

    def _thinned(self, scales: ScaleRange, met: list[int], *, whole: bool) -> Part:
        rigid = scales is RIGID
        graph = self.graph if rigid else self._graph(scales)
        stager = Stager(graph, met, whole or not rigid, MOST)
        return Part.of(stager, _clique(graph.near, met), scales)

    @cached_property
    def graph(self) -> Graph:
        """Of rigid motions."""
        return self._graph(RIGID)

    def _graph(self, scales: ScaleRange) -> Graph:
        near, points = self.pairs.near(scales), self.pairs.points(scales)
        return Graph(near, points, self._effort, turned=MOST_TURNED * (scales is RIGID))


def _clique(near: BitRows, met: list[int]) -> int:
    """Of the rows a set that agree with each other, the one with most neighbours first."""
    within = mask_of(met)
    first = max(met, key=lambda row: (near[row] & within).bit_count())
    return mask_of(greedy_clique(near, within, first).tolist())


def _middle(scales: ScaleRange) -> Fraction:
    """Between the ends, in few bits: next to their geometric mean; of an end piece beyond it."""
    low, high = scales.low, scales.high
    if high is None:
        return low * 4
    if not low:
        return high / 4
    ratio = float(high / low)
    bits = END_BITS + max(0, -int(np.frexp(ratio - 1.0)[1]))
    middle = dyadic_below(low * Fraction(ratio**0.5), bits).value
    return middle if low < middle < high else (low + high) / 2


def _end(scales: ScaleRange) -> Dyadic | None:
    """The end of a piece, over a power of two; None: it has none, or is one scale."""
    end = None if scales is RIGID else scales.high
    if end is None:
        return None
    return Dyadic(mantissa=end.numerator, exponent=1 - end.denominator.bit_length())


def consensus_of(
    problem: RegistrationProblem, body: ConsensusBody | ConsensusSimilarityBody
) -> ProvedConsensus:
    """What a certificate says that the checker has accepted for the problem."""
    met = tuple(ConsistentPairs.of(problem).met_by(body.witness))
    return ProvedConsensus(body.witness, met, body.labels, body.upper, body.pieces, body.states)


def pose_of(witness: Witness) -> Pose:
    """The motion in doubles, rounded, but for its scale."""
    q = np.array([float(k) for k in witness.quaternion])
    *shift, exponent = witness.shift
    matrix = np.eye(4)
    matrix[:3, :3] = rotation_matrix((q / np.linalg.norm(q)).tolist())
    matrix[:3, 3] = [math.ldexp(k, exponent) for k in shift]
    return Pose.from_matrix(matrix)


def consensus_certificate(
    problem: RegistrationProblem,
    found: ProvedConsensus,
    fit: Certificate[PoseBody] | None,
    about: dict[str, Any] | None = None,
) -> Certificate[ConsensusBody | ConsensusSimilarityBody]:
    """The certificate; fit: of the least squares over the rows that the witness meets.

    Raises UndecidedError where it would be too long.
    """
    return enclosed(problem, BODY_OF[PREFIXES[problem.cell]](problem, found, fit), about)


def _weighed_body(
    problem: RegistrationProblem, found: ProvedConsensus, fit: Certificate[PoseBody] | None
) -> ConsensusBody:
    """How far motions that meet all these rows may turn from the fit: they have 2 p^T K p >= c.

    c = S - B, B = sum w b^2.
    """
    rows = MetRows.of(problem, found.met, problem.weights)
    c, spread = rows.spread - rows.room, rows.spread
    reach = fit and reach_of(rows.davenport, c, spread, fit.body.quaternion)
    return _rigid_body(found, fit, reach, springs=False)


def _sprung_body(
    problem: RegistrationProblem, found: ProvedConsensus, fit: Certificate[PoseBody] | None
) -> ConsensusBody:
    """The same of general springs: their pose is no eigenvector of K, as `turn_about` allows."""
    rows, reach = MetRows.of(problem, found.met, np.ones(problem.n)), None
    if fit is not None:
        u = np.array(fit.body.quaternion, dtype=float)
        c, A = rows.spread - rows.room, 2.0 * rows.davenport / rows.spread
        reach = turn_about(c / rows.spread, A, u / np.linalg.norm(u))
    return _rigid_body(found, fit, reach, springs=True)


def _rigid_body(
    found: ProvedConsensus,
    fit: Certificate[PoseBody] | None,
    reach: Reach | None,
    *,
    springs: bool,
) -> ConsensusBody:
    return ConsensusBody(
        witness=found.witness,
        labels=found.labels,
        upper=found.upper,
        stages=found.pieces[0].stages,
        fit=None if fit is None else unheld(fit),
        reach=reach,
        springs=springs,
    )


def _similarity_body(
    problem: RegistrationProblem, found: ProvedConsensus, fit: Certificate[PoseBody] | None
) -> ConsensusSimilarityBody:
    """Between which scales, and how far from the fit, all motions are that meet the met rows.

    With X, Y, l as in `refuting` and c = Y - B, they have s^2 X + c <= 2 s l: s is between the
    roots. Where c > 0, they have 2 p^T K p >= 2 sqrt(c X). Doubles, rounded outwards: the checker
    decides.
    """
    if sum(length_of(piece.stages) for piece in found.pieces) > MOST:
        raise UndecidedError(
            f"the proof of {problem.n} pairs with a free scale is longer than a certificate may "
            "be: give fewer of them, the surest ones"
        )
    rows = MetRows.of(problem, found.met, problem.weights)
    X, Y = (float((rows.weights * p * p).sum()) for p in (rows.source, rows.target))
    c, K = Y - rows.room, rows.davenport
    level = float(np.linalg.eigvalsh(K)[-1])
    middle, half = level / X, math.sqrt(max(level * level - c * X, 0.0)) / X
    low, high = (middle - half) * (1.0 - OUTWARDS), (middle + half) * (1.0 + OUTWARDS)
    reach = None
    if c > 0.0 and fit is not None:
        reach = reach_of(K, 2.0 * math.sqrt(c * X), math.sqrt(X * Y), fit.body.quaternion)
    lower = dyadic_below(Fraction(low) if c > 0.0 and low > 0.0 else Fraction(0), ANGLE_BITS)
    return ConsensusSimilarityBody(
        witness=cast("ScaledWitness", found.witness),
        labels=found.labels,
        upper=found.upper,
        pieces=found.pieces,
        states=found.states,
        scale=problem.scale.value,
        scale_lower=lower.shifted(rows.exponent),
        scale_upper=dyadic_above(Fraction(high), ANGLE_BITS).shifted(rows.exponent),
        fit=None if fit is None else unheld(fit),
        reach=reach,
    )


BODY_OF = {  # by the prefix of the data
    CONSENSUS: _weighed_body,
    SPRUNG: _sprung_body,
    **dict.fromkeys(ConsensusSimilarityStatement.prefixes.values(), _similarity_body),
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MetRows:
    """Rows of both clouds about their weighted means, (K, 3), and weights (K, 1), at most 1.

    davenport: Davenport's matrix. spread: the weighted squares of both clouds. room: those of the
    bounds. exponent: of `ConsistentPairs`.
    """

    source: NDArray[np.float64]
    target: NDArray[np.float64]
    weights: NDArray[np.float64]
    davenport: NDArray[np.float64]
    spread: float
    room: float
    exponent: int

    @classmethod
    def of(
        cls,
        problem: RegistrationProblem,
        met: tuple[int, ...],
        weights: NDArray[np.float64],
    ) -> MetRows:
        """Of the rows that are met."""
        pairs, rows = ConsistentPairs.of(problem), list(met)
        w = (weights[rows] / weights[rows].max())[:, None]
        x, y = (p[rows] - p[rows[0]] for p in (pairs.source, pairs.target))
        x, y = (p - (w * p).sum(axis=0) / w.sum() for p in (x, y))
        return cls(
            source=x,
            target=y,
            weights=w,
            davenport=np.array(davenport_matrix(((w * y).T @ x).tolist())),
            spread=float((w * (x * x + y * y)).sum()),
            room=float((w[:, 0] * pairs.bounds[rows] ** 2).sum()),
            exponent=pairs.exponent,
        )


def unheld(fit: Certificate[PoseBody]) -> dict[str, Any]:
    """The certificate as a file holds it, without its points: they are those of the outer one."""
    fields: dict[str, Any] = json.loads(fit.line())
    return {**fields, "problem": {"data": None, "digest": fit.digest, "n": fit.n}}
