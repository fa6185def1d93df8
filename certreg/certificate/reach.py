"""How far the motions that meet some pairs may turn from a rotation that is not the best of them.

Their quaternions have p^T A p >= c, |p| = 1. If c I - A + t (u u^T - (1 - s) I) > 0 for a t > 0,
then (u.p)^2 > 1 - s: sin^2(a/2) < s, a the angle from R(u). Across u, in the eigenvectors of A
there, with values k_i and A u = (f, v), that is t (1 - s) < c - k_i and, by Schur's complement,
h(t) = c - f + t s - sum v_i^2 / (c - k_i - t (1 - s)) > 0, which is concave in t.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from certreg.certificate.consensus import Reach
from certreg.exact.dyadic import dyadic_above

if TYPE_CHECKING:
    from numpy.typing import NDArray


ANGLE_BITS = 24  # of the bound on an angle
HALVINGS = 50  # of s, of t, of the slope of h
ROOM = 1e-3  # of s above the least: room for t, and for the rounding of eigenvectors


@dataclass(frozen=True, slots=True, eq=False)
class _Frame:
    """c - f, c - k_i and v_i, as above."""

    own: float
    across: NDArray[np.float64]
    leaks: NDArray[np.float64]

    def room(self, s: float, t: float) -> float:
        """h(t)."""
        return self.own + t * s - float((self.leaks**2 / (self.across - t * (1.0 - s))).sum())

    def best(self, s: float) -> float:
        """The t of the largest h: its slope falls."""
        low, high = 0.0, float(self.across.min()) / (1.0 - s)
        for _ in range(HALVINGS):
            t = (low + high) / 2.0
            falls = self.leaks**2 / (self.across - t * (1.0 - s)) ** 2
            low, high = (t, high) if s > (1.0 - s) * falls.sum() else (low, t)
        return low


def turn_about(c: float, A: NDArray[np.float64], u: NDArray[np.float64]) -> Reach | None:
    """The least s, nearly, and a t that shows it; None where no s below 1 is bounded.

    u: (4,), |u| = 1; A: (4, 4). Doubles: a proposal.
    """
    basis = np.linalg.svd(u[np.newaxis])[2][1:]
    values, vectors = np.linalg.eigh(basis @ A @ basis.T)
    frame = _Frame(c - float(u @ A @ u), c - values, vectors.T @ (basis @ A @ u))
    if frame.across.min() <= 0.0:
        return None
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        s = (low + high) / 2.0
        low, high = (low, s) if frame.room(s, frame.best(s)) > 0.0 else (s, high)
    s = high * (1.0 + ROOM) + 1e-12
    if s >= 1.0:
        return None
    least, most = 0.0, frame.best(s)
    for _ in range(HALVINGS):
        t = (least + most) / 2.0
        least, most = (least, t) if frame.room(s, t) > 0.0 else (t, most)
    return Reach(
        sin2_half_angle=dyadic_above(Fraction(s), ANGLE_BITS),
        tau=dyadic_above(Fraction((most + frame.best(s)) / 2.0), 53),
    )


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
