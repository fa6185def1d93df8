"""Producing a certificate of consensus from a motion that meets many pairs.

Stages, each a set of strikes: with K = the number of pairs met, what is left are the pairs that any
motion that meets K or more can meet. If these are just the met ones, all labels are proved and K is
the maximum. Else K + 1 is tried, and whether the others are enough without each met pair.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.certificate.consensus import (
    UNDECIDED,
    ConsensusBody,
    Reach,
    Stage,
    Witness,
)
from certreg.certificate.consistency import (
    QUATERNION_BITS,
    SHIFT_BITS,
    ExactRows,
    consistent_pairs,
)
from certreg.certificate.envelope import Certificate
from certreg.certificate.reach import ANGLE_BITS, turn_about
from certreg.certificate.refuting import PointRows
from certreg.certificate.staging import Part, Stager, settled
from certreg.certificate.thinning import Graph
from certreg.exact.dyadic import dyadic_above
from certreg.geometry.pose import Pose
from certreg.geometry.so3 import davenport_matrix, quaternion_from_matrix, rotation_matrix
from certreg.problem.bounds import LEAST_PAIRS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.certificate.isotropic import IsotropicBody
    from certreg.certificate.similarity import SimilarityBody
    from certreg.certificate.springs_cones import SpringsConesBody
    from certreg.certificate.springs_sos import SpringsSosBody
    from certreg.native.bit_rows import BitRows
    from certreg.problem.problem import RegistrationProblem

    FitBody = IsotropicBody | SpringsSosBody | SpringsConesBody


@dataclass(frozen=True, slots=True, eq=False)
class ProvedConsensus:
    """What is proved with one motion: witness, the rows that it meets, stages and what follows.

    labels: of each row "i", "o" or "?". upper: no motion meets more.
    """

    witness: Witness
    met: tuple[int, ...]
    stages: tuple[Stage, ...]
    labels: str
    upper: int

    @property
    def decided(self) -> bool:
        """Whether every label is proved."""
        return UNDECIDED not in self.labels

    @property
    def worth(self) -> tuple[int, int, int]:
        """To compare two: pairs met, then labels proved, then how low the bound is."""
        return len(self.met), len(self.labels) - self.labels.count(UNDECIDED), -self.upper


class ConsensusProver:
    """Proves as much as it can of one problem; the graph of consistent pairs is made once."""

    def __init__(self, problem: RegistrationProblem, *, effort: float = 1.0) -> None:
        self.problem = problem
        self._exact = ExactRows(problem)
        self._near = consistent_pairs(problem)
        self.graph = Graph(self._near, PointRows.of(problem), effort, rigid=True)

    @property
    def consistent(self) -> BitRows:
        """Which two pairs one motion may meet."""
        return self._near

    def prove(
        self, rotation: NDArray[np.float64], translation: NDArray[np.float64], *, whole: bool = True
    ) -> ProvedConsensus | None:
        """What is proved with this motion as witness; None where it meets too few pairs.

        whole: False: no more than whether all labels are, or that no motion meets more pairs.
        """
        return self.witnessed(witness_of(rotation, translation), whole=whole)

    def witnessed(self, witness: Witness, *, whole: bool = True) -> ProvedConsensus | None:
        """The same of a witness."""
        met = self._exact.met_by(witness)
        if len(met) < LEAST_PAIRS:
            return None
        part = Part.of(Stager(self.graph, met, whole))
        labels, upper = settled([part], whole=whole)
        return ProvedConsensus(witness, tuple(met), tuple(part.stages), labels, upper)


def witness_of(rotation: NDArray[np.float64], translation: NDArray[np.float64]) -> Witness:
    """A motion in integers, next to one in doubles."""
    w, x, y, z = np.rint(np.ldexp(quaternion_from_matrix(rotation), QUATERNION_BITS)).tolist()
    size = float(np.abs(translation).max())
    exponent = int(np.frexp(size)[1]) - SHIFT_BITS if size else 0
    a, b, c = (int(Fraction(k) / Fraction(2) ** exponent) for k in translation.tolist())
    return Witness(quaternion=(int(w), int(x), int(y), int(z)), shift=(a, b, c, exponent))


def consensus_of(problem: RegistrationProblem, body: ConsensusBody) -> ProvedConsensus:
    """What a certificate says that the checker has accepted for the problem."""
    met = tuple(ExactRows(problem).met_by(body.witness))
    return ProvedConsensus(body.witness, met, body.stages, body.labels, body.upper)


def pose_of(witness: Witness) -> Pose:
    """The motion in doubles, rounded."""
    q = np.array([float(k) for k in witness.quaternion])
    *shift, exponent = witness.shift
    matrix = np.eye(4)
    matrix[:3, :3] = rotation_matrix((q / np.linalg.norm(q)).tolist())
    matrix[:3, 3] = [math.ldexp(k, exponent) for k in shift]
    return Pose.from_matrix(matrix)


def consensus_certificate(
    problem: RegistrationProblem,
    found: ProvedConsensus,
    fit: Certificate[FitBody] | None,
    about: dict[str, Any] | None = None,
) -> Certificate[ConsensusBody]:
    """The certificate; fit: of the least squares over the rows that the witness meets."""
    body = ConsensusBody(
        witness=found.witness,
        labels=found.labels,
        upper=found.upper,
        stages=found.stages,
        fit=None if fit is None else unheld(fit),
        reach=None if fit is None else _reach(problem, found.met, fit.body.quaternion),
        springs=problem.factors is not None,
    )
    return Certificate(
        n=problem.n,
        digest=problem.digest(),
        inline=problem.data_bytes(),
        body=body,
        about=about or {},
    )


def unheld(fit: Certificate[FitBody] | Certificate[SimilarityBody]) -> dict[str, Any]:
    """The certificate as a file holds it, without its points: they are those of the outer one."""
    fields: dict[str, Any] = json.loads(fit.line())
    return {**fields, "problem": {"data": None, "digest": fit.digest, "n": fit.n}}


def _reach(
    problem: RegistrationProblem, met: tuple[int, ...], quaternion: tuple[int, ...]
) -> Reach | None:
    """How far motions that meet all these rows may turn from that of the fit; None if not bounded.

    They have 2 p^T K p >= c, c = S - B. The pose of general springs is no eigenvector of K:
    `turn_about` allows for that.
    """
    points = PointRows.of(problem)
    weights = problem.weights if problem.factors is None else np.ones(problem.n)
    x, y, w = centred(points.source, points.target, weights, met)
    spread = float((w * (x * x + y * y)).sum())
    c = spread - float((w[:, 0] * points.bounds[[*met]] ** 2).sum())
    K = np.array(davenport_matrix(((w * y).T @ x).tolist()))
    if problem.factors is None:
        return reach_of(K, c, spread, quaternion)
    u = np.array(quaternion, dtype=float)
    return turn_about(c / spread, 2.0 * K / spread, u / np.linalg.norm(u))


def centred(
    source: NDArray[np.float64],
    target: NDArray[np.float64],
    weights: NDArray[np.float64],
    met: tuple[int, ...],
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Rows of both clouds about their weighted means, (K, 3), and weights (K, 1), at most 1."""
    rows = list(met)
    w = (weights[rows] / weights[rows].max())[:, None]
    x, y = (p[rows] - p[rows[0]] for p in (source, target))
    x, y = (p - (w * p).sum(axis=0) / w.sum() for p in (x, y))
    return x, y, w


def reach_of(
    K: NDArray[np.float64], c: float, size: float, quaternion: tuple[int, ...]
) -> Reach | None:
    """How far motions with 2 p^T K p >= c may turn from the quaternion; None if not bounded.

    In the frame of the eigenvectors of K, l1 >= l2, u the first, c I - 2 K + t (u u^T - (1 - s) I)
    > 0 asks for t s > 2 l1 - c and t (1 - s) < c - 2 l2: there is such a t iff
    s > (2 l1 - c) / (2 l1 - 2 l2). t is tau size. Doubles: the checker decides.
    """
    u = np.array(quaternion, dtype=float)
    u /= np.linalg.norm(u)
    across = np.linalg.svd(u[None])[2][1:]
    first = float(2.0 * u @ K @ u)
    second = float(2.0 * np.linalg.eigvalsh(across @ K @ across.T)[-1])
    if not (first > c > second):
        return None
    s = (first - c) / (first - second) * (1.0 + 1e-6) + 1e-12
    if s >= 1.0:
        return None
    low, high = (first - c) / s, (c - second) / (1.0 - s)
    tau = (low + high) / 2.0 / size
    return Reach(
        sin2_half_angle=dyadic_above(Fraction(s), ANGLE_BITS),
        tau=dyadic_above(Fraction(tau), 53),
    )
