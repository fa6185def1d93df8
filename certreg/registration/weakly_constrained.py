"""Shifts that general springs hardly resist: how little may change until one is free.

A shift by d, |d| = 1, is resisted by d^T S d, S = sum W: with W = L L^T it is sum |L^T d|^2. The
factors L - d d^T L leave it free, and are off by d d^T L, of the norm |L^T d|. So springs that are
changed by the share

    sqrt(d^T S d / tr S),    tr S = sum |L|^2,

of their size, both in root mean square, leave the shift along d free; and no smaller share does, as
|L - L'| >= |(L - L')^T d| = |L^T d| for all L' with L'^T d = 0. Target points that are off by e
each move the optimum along an eigenvector of S by e over that share, at most.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from certreg.exact.decimals import at_most
from certreg.exact.dyadic import root_above
from certreg.exact.eigenbasis import integer_eigenbasis
from certreg.geometry.so3 import quadratic_form, squared_norm
from certreg.registration.loose_turns import axes_words
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.objective.springs import Springs


# A share of the springs. Normals in six printed digits or in single precision are off by 1e-6 and
# 6e-8, those of measured surfaces by more; and 1e-6, squared, is what `LEAST_CURVATURE` calls
# rounding. Above it the covariance is told, and says how far the noise leaves a shift open.
HARDLY = Fraction(1, 10**6)
BITS = 128  # of the directions: what is said of one holds of it exactly, whatever its last bits


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class WeakShift(Brief):
    """A direction that hardly any spring resists. share: what changes until none does, rounded up.

    direction: (3,), a unit vector in the target's frame; two are orthogonal.
    """

    direction: NDArray[np.float64]
    share: float


def weak_shifts(objective: Springs) -> tuple[WeakShift, ...]:
    """The shifts of its motion that are resisted, and by no more than `HARDLY`; the weakest first.

    Proved of each that is returned; that there are no others is computed.
    """
    stiffness = objective.joint_form.stiffness
    total = sum(stiffness[k][k] for k in range(3))
    count = sum(map(any, objective.reduced.compliance))  # as many as its translation has pivots
    resisted = integer_eigenbasis(stiffness, BITS).vectors[:count]
    shares = [
        (Fraction(quadratic_form(stiffness, d), total * squared_norm(d)), d)
        for d in reversed(resisted)
    ]
    return tuple(
        WeakShift(direction=_unit(d), share=root_above(squared))
        for squared, d in shares
        if squared <= HARDLY**2
    )


def weak_shift_words(shifts: Sequence[WeakShift]) -> str:
    """That they are hardly resisted, and how little that rests on; empty where there are none."""
    if not shifts:
        return ""
    along = axes_words([one.direction for one in shifts])
    share = at_most(max(one.share for one in shifts), 2)
    return (
        f"a shift along {along} is resisted by next to nothing: springs changed by as "
        f"little as {share} of their size would leave it free"
    )


def _unit(vector: Sequence[int]) -> NDArray[np.float64]:
    """In doubles, its largest entry positive."""
    largest = max(vector, key=abs)
    entries = np.array([entry / largest for entry in vector])
    return entries / np.linalg.norm(entries)
