"""Producing a certificate of consensus where the scale is free: by pieces of scale.

Each piece is thinned for as many pairs as the witness meets. Where more are left than these, or
others, it is cut in two, until it is so narrow that motions with its scales differ by a small part
of a bound.
"""

from __future__ import annotations

import heapq
import logging
import math
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.certificate.envelope import Certificate
from certreg.certificate.producing_consensus import (
    ANGLE_BITS,
    ProvedConsensus,
    centred,
    reach_of,
    unheld,
    witness_of,
)
from certreg.certificate.scaled_consensus import (
    OPEN,
    ConsensusSimilarityBody,
    Piece,
    ScaledWitness,
    ScaleRange,
    ranges,
)
from certreg.certificate.scaled_pairs import ScaledPairs
from certreg.certificate.staging import MOST, Part, Stager, length_of, settled
from certreg.certificate.thinning import Graph
from certreg.errors import UndecidedError
from certreg.exact.dyadic import Dyadic, dyadic_above, dyadic_below
from certreg.geometry.so3 import davenport_matrix
from certreg.native.bit_rows import mask_of, rows_of
from certreg.problem.bounds import LEAST_PAIRS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.certificate.consensus import Reach
    from certreg.certificate.similarity import SimilarityBody
    from certreg.native.bit_rows import Neighbours
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
END_BITS = 4  # more than it takes to tell the ends of a piece apart


@dataclass(frozen=True, slots=True, eq=False)
class ScaledConsensus(ProvedConsensus):
    """What is proved with one motion whose scale is free; stages are those of the pieces."""

    witness: ScaledWitness
    pieces: tuple[Piece, ...]
    states: str

    @property
    def open_scales(self) -> list[ScaleRange]:
        """With which it is not proved that those that meet as many pairs meet the same."""
        return ranges(self.pieces, self.states, OPEN)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Piece(Part):
    """Motions with these scales."""

    scales: ScaleRange


class ScaledProver:
    """Proves as much as it can of one problem whose scale is free."""

    def __init__(self, problem: RegistrationProblem, *, effort: float = 1.0) -> None:
        self.problem = problem
        self.pairs = ScaledPairs(problem)
        self._effort = effort
        most = MOST_BITS // problem.n**2
        self._most = max(2, min(round(MOST_PIECES * effort), most))

    def prove(
        self,
        scale: float,
        rotation: NDArray[np.float64],
        translation: NDArray[np.float64],
        *,
        whole: bool = True,
    ) -> ScaledConsensus | None:
        """What is proved with this motion as witness; None where it meets too few pairs.

        whole: False: no more than whether all labels are, or that no motion meets more pairs.
        """
        rigid, factor = witness_of(rotation, translation), dyadic_below(Fraction(scale), 53)
        witness = ScaledWitness(quaternion=rigid.quaternion, shift=rigid.shift, factor=factor)
        return self.witnessed(witness, whole=whole) if scale > 0.0 else None

    def witnessed(self, witness: ScaledWitness, *, whole: bool = True) -> ScaledConsensus | None:
        """The same of a witness."""
        met = self.pairs.met_by(witness)
        if len(met) < LEAST_PAIRS:
            return None
        parts = self._parts(met, witness.factor.value, MOST_OPEN if whole else FEW_OPEN)
        labels, upper = settled(parts, whole=whole, progress=partial(LOG.info, OPEN_TOLD))
        ends = [part.scales.high for part in parts]
        pieces = tuple(
            Piece(end=None if end is None else _dyadic(end), stages=tuple(part.stages))
            for end, part in zip(ends, parts, strict=True)
        )
        states = "".join(part.state for part in parts)
        return ScaledConsensus(witness, tuple(met), (), labels, upper, pieces, states)

    def _parts(self, met: list[int], scale: Fraction, most_open: int) -> list[_Piece]:
        """Of all scales, in order: the widest of those that are open is cut, again and again.

        Until so many are open at once that cutting will not end, or the certificate is full.
        """
        near = dyadic_below(scale, END_BITS).value
        ends = [near / 2, near * 2]
        found: list[_Piece] = []
        queue: list[tuple[float, Fraction, _Piece]] = []

        def add(part: _Piece) -> None:
            width = self._width(part.scales) if part.state == OPEN else 0.0
            if width > 0.0:
                heapq.heappush(queue, (-width, part.scales.low, part))
            else:
                found.append(part)

        for low, high in zip([Fraction(0), *ends], [*ends, None], strict=True):
            add(self._thinned(ScaleRange(low, high), met))
        held = sum(part.length for part in found) + sum(part.length for _, _, part in queue)
        most_open = max(1, round(most_open * self._effort))
        while queue and len(queue) <= most_open and len(found) + len(queue) < self._most:
            part = heapq.heappop(queue)[2]
            middle, ends = _middle(part.scales), part.scales
            halves = [
                self._thinned(ScaleRange(*range_), met)
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
            return bool((self.pairs.least[self.pairs.least > 0.0] <= high).any())
        finite = self.pairs.most[np.isfinite(self.pairs.most)]
        return bool((finite >= low).any())

    def _thinned(self, scales: ScaleRange, met: list[int]) -> _Piece:
        graph = Graph(self.pairs.near(scales), self.pairs.points(scales), self._effort)
        return _Piece.of(Stager(graph, met, most=MOST), _clique(graph.near, met), scales=scales)


def _clique(near: Neighbours, met: list[int]) -> int:
    """Of the rows a set that agree with each other, the one with most neighbours first."""
    left, clique = mask_of(met), 0
    while left:
        row = max(rows_of(left), key=lambda i: (near[i] & left).bit_count())
        clique |= 1 << row
        left &= near[row]
    return clique


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


def _dyadic(value: Fraction) -> Dyadic:
    """A number whose denominator is a power of two."""
    return Dyadic(mantissa=value.numerator, exponent=1 - value.denominator.bit_length())


def scaled_consensus_of(
    problem: RegistrationProblem, body: ConsensusSimilarityBody
) -> ScaledConsensus:
    """What a certificate says that the checker has accepted for the problem."""
    met = tuple(ScaledPairs(problem).met_by(body.witness))
    claims = (body.labels, body.upper, body.pieces, body.states)
    return ScaledConsensus(body.witness, met, (), *claims)


def scaled_consensus_certificate(
    problem: RegistrationProblem,
    found: ScaledConsensus,
    fit: Certificate[SimilarityBody] | None,
    about: dict[str, Any] | None = None,
) -> Certificate[ConsensusSimilarityBody]:
    """The certificate; fit: of the least squares over the rows that the witness meets.

    Raises UndecidedError where it would be too long.
    """
    if sum(length_of(piece.stages) for piece in found.pieces) > MOST:
        message = (
            f"the proof of {problem.n} pairs with a free scale is longer than a certificate may "
            "be: give fewer of them, the surest ones"
        )
        raise UndecidedError(message)
    low, high, reach = _bounded(problem, found, fit)
    body = ConsensusSimilarityBody(
        witness=found.witness,
        labels=found.labels,
        upper=found.upper,
        pieces=found.pieces,
        states=found.states,
        scale=problem.scale.value,
        scale_lower=low,
        scale_upper=high,
        fit=None if fit is None else unheld(fit),
        reach=reach,
    )
    return Certificate(
        n=problem.n,
        digest=problem.digest(),
        inline=problem.data_bytes(),
        body=body,
        about=about or {},
    )


def _bounded(
    problem: RegistrationProblem, found: ScaledConsensus, fit: Certificate[SimilarityBody] | None
) -> tuple[Dyadic, Dyadic, Reach | None]:
    """Between which scales, and how far from the fit, all motions are that meet the met rows.

    With X, Y, l as in `scaled_refuting` and c = Y - B, B = sum w b^2, they have s^2 X + c <= 2 s l:
    s is between the roots. Where c > 0, they have 2 p^T K p >= 2 sqrt(c X). Doubles, rounded
    outwards: the checker decides.
    """
    pairs = ScaledPairs(problem)
    x, y, w = centred(pairs.source, pairs.target, problem.weights, found.met)
    X, Y = (float((w * p * p).sum()) for p in (x, y))
    c = Y - float((w[:, 0] * pairs.bounds[[*found.met]] ** 2).sum())
    K = np.array(davenport_matrix(((w * y).T @ x).tolist()))
    level = float(np.linalg.eigvalsh(K)[-1])
    middle, half = level / X, math.sqrt(max(level * level - c * X, 0.0)) / X
    low, high = (middle - half) * (1.0 - OUTWARDS), (middle + half) * (1.0 + OUTWARDS)
    reach = None
    if c > 0.0 and fit is not None:
        reach = reach_of(K, 2.0 * math.sqrt(c * X), math.sqrt(X * Y), fit.body.quaternion)
    lower = dyadic_below(Fraction(low) if c > 0.0 and low > 0.0 else Fraction(0), ANGLE_BITS)
    upper = dyadic_above(Fraction(high), ANGLE_BITS)
    return lower.scaled(pairs.exponent), upper.scaled(pairs.exponent), reach
