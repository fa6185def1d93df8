"""Whether one rigid motion meets all of some pairs: a motion that does, or pairs that forbid it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.certificate.consistency import witness_of
from certreg.exact.elimination import is_positive_definite
from certreg.geometry.so3 import davenport_matrix, rotation_matrix, squared_norm
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.certificate.consensus import Witness
    from certreg.certificate.producing_consensus import ConsensusProver
    from certreg.problem.problem import RegistrationProblem


ROUNDS = 200  # of reweighting: the largest residual falls slowly near the least


@dataclass(frozen=True, slots=True, kw_only=True)
class CommonMotion(Brief):
    """What is proved of some rows; both are empty where neither was found.

    witness: a motion that meets all of them.
    refuted: few of them, which no motion meets together; two by their lengths, more by weights.
    """

    witness: Witness | None = None
    refuted: tuple[int, ...] = ()


def common_motion(prover: ConsensusProver, rows: Sequence[int]) -> CommonMotion:
    """What is proved of the rows; doubles propose, integers decide."""
    apart = np.argwhere(~prover.graph.near.table[np.ix_(rows, rows)])
    for i, j in apart.tolist():
        if i < j:
            return CommonMotion(refuted=(rows[i], rows[j]))
    witness = witness_of(*_least_largest(prover.problem, rows))
    if set(rows) <= set(prover.pairs.met_by(witness)):
        return CommonMotion(witness=witness)
    first, *others = rows
    group = prover.graph.points.refutation(first, others)
    if group is None:
        return CommonMotion()
    few = (first, *group.rows)
    if not is_refuted([prover.pairs.exact.rows[row] for row in few], group.weights):
        return CommonMotion()
    return CommonMotion(refuted=tuple(sorted(few)))


def is_refuted(rows: Sequence[Sequence[int]], weights: Sequence[int]) -> bool:
    """Whether no motion meets all rows, each x, y and bound: S - 2 l1 > sum l b^2, all times sum l.

    S are the centred squares of both clouds, l1 is the largest eigenvalue of Davenport's matrix.
    """
    total = sum(weights)
    pairs = list(zip(weights, rows, strict=True))
    means = [sum(w * row[k] for w, row in pairs) for k in range(6)]
    spread = total * sum(w * squared_norm(row[:6]) for w, row in pairs) - squared_norm(means)
    room = spread - total * sum(w * row[6] ** 2 for w, row in pairs)
    cross = [
        [
            total * sum(w * row[3 + i] * row[j] for w, row in pairs) - means[3 + i] * means[j]
            for j in range(3)
        ]
        for i in range(3)
    ]
    K = davenport_matrix(cross)
    return is_positive_definite(
        [[room * (i == j) - 2 * K[i][j] for j in range(4)] for i in range(4)]
    )


def _least_largest(
    problem: RegistrationProblem, rows: Sequence[int]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A motion whose largest residual over its bound is near the least, by Lawson's method."""
    block, chosen = problem.points, list(rows)
    unit = np.ldexp(1.0, int(np.frexp(problem.bounds[chosen].max())[1]))  # no square is 0 of it
    x, y = block.source[chosen] / unit, block.target[chosen] / unit
    squares = (problem.bounds[chosen] / unit) ** 2
    origins = x[0], y[0]
    x, y = x - origins[0], y - origins[1]
    shares, least = np.ones(len(chosen)), np.inf
    best = np.eye(3), y[0]
    for _ in range(ROUNDS):
        turn, shift = _fitted(x, y, shares / squares)
        ratios = ((y - x @ turn.T - shift) ** 2).sum(axis=1) / squares
        if ratios.max() < least:
            least, best = float(ratios.max()), (turn, shift)
        shares = shares * np.sqrt(ratios)
        if not shares.any():  # all rows that count fit exactly
            break
        shares /= shares.max()
    turn, shift = best
    return turn, (shift + origins[1] - turn @ origins[0]) * unit


def _fitted(
    x: NDArray[np.float64], y: NDArray[np.float64], weights: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The motion of least squares."""
    w = weights / weights.sum()
    a, b = w @ x, w @ y
    cross = (w[:, None] * (y - b)).T @ (x - a)
    _, vectors = np.linalg.eigh(np.array(davenport_matrix(cross.tolist())))
    R = np.array(rotation_matrix(vectors[:, 3].tolist()))
    return R, b - R @ a
