"""The exact classification: which of the eight kinds of equilibrium set a problem has.

R(q) is an equilibrium iff q is an eigenvector of the Davenport matrix K(C), so the equilibrium set
is the union of the projective spaces of the eigenspaces of K, and its shape is the list of
multiplicities. Those follow from the singular values d1 >= d2 >= |d3| of C, sign d3 = sign det C:

    l1 - l2 = 2 (d2 + d3),    l2 - l3 = 2 (d1 - d2),    l3 - l4 = 2 (d2 - d3),

and which of the three vanish is decided by the characteristic polynomial of C^T C and the sign of
det C, in integers, without computing a single root. The decision is scale-free.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from itertools import accumulate
from typing import TYPE_CHECKING, Any

from certreg.exact.elimination import is_positive_definite, rank
from certreg.results import ComponentKind

if TYPE_CHECKING:
    from certreg.geometry.so3 import T
    from certreg.problem.moments import ExactMoments

Pattern = tuple[int, ...]
PRIME = 2**30 - 35  # one digit of Python: what it does not divide is quickly seen not to be 0


class Ambiguity(Enum):
    """Why an optimum is not unique, in words for the user; in the order in which to look."""

    COINCIDENT_SOURCE = (
        "all source points with weight coincide: a single point does not tell a rotation"
    )
    COINCIDENT_TARGET = (
        "all target points with weight coincide: a single point does not tell a rotation"
    )
    COLLINEAR_SOURCE = (
        "the source points are collinear: turning the body about its own line changes nothing"
    )
    COLLINEAR_TARGET = (
        "the target points are collinear: turning the body about the target's line changes nothing"
    )
    UNCORRELATED = (
        "the correspondences cancel out (the cross-covariance is zero): every rotation fits equally"
    )
    RANK_ONE = (
        "the clouds correspond along one direction only (the cross-covariance has rank one), as if "
        "one of them were collinear: turning about that direction changes nothing"
    )
    MIRRORED = (
        "the target is, as far as the fit is concerned, a mirror image of the source "
        "(det C < 0) whose two weakest directions count exactly equally, so it is not decided "
        "which of them to give up"
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Classification:
    """The equilibrium set, exactly.

    pattern: multiplicities of the eigenvalues l1 > l2 > ... of K, one component of equilibria each.
    inertia_definite: J > 0, three source points (with weight) are not collinear: the rotational
        dynamics is defined.
    """

    pattern: Pattern
    inertia_definite: bool
    ambiguity: Ambiguity | None  # None iff the optimum is unique

    @property
    def unique(self) -> bool:
        """Whether the global optimum is one single pose."""
        return self.pattern[0] == 1

    @property
    def finite(self) -> bool:
        """Whether there are finitely many equilibria: exactly four, then."""
        return self.pattern == (1, 1, 1, 1)

    @property
    def spurious(self) -> int | None:
        """Number of equilibria that are not optimal; None means infinitely many."""
        others = self.pattern[1:]
        return len(others) if all(m == 1 for m in others) else None

    @property
    def indices(self) -> tuple[int, ...]:
        """Morse-Bott index of each component: the number of eigenvalues above its own."""
        return (0, *accumulate(self.pattern[:-1]))

    @property
    def kinds(self) -> tuple[ComponentKind, ...]:
        """What each component looks like."""
        return tuple(ComponentKind.of_multiplicity(m) for m in self.pattern)

    @property
    def unstable(self) -> tuple[int, ...] | None:
        """Unstable eigenvalues of the linearised dynamics at each component; None unless J > 0.

        With J > 0 and damping > 0 their number is the index, by Sylvester's law of inertia.
        """
        return self.indices if self.inertia_definite else None


def classify(moments: ExactMoments) -> Classification:
    """The classification of a problem, decided in integer arithmetic."""
    return with_pattern(moments, pattern_of(moments.cross))


def with_pattern(moments: ExactMoments, pattern: Pattern) -> Classification:
    """The classification of a problem whose pattern is known, by whichever method."""
    return Classification(
        pattern=pattern,
        # Four eigenvalues: of C at most one singular value is 0, so the points are on no line.
        inertia_definite=len(pattern) == 4 or is_positive_definite(moments.inertia),
        ambiguity=None if pattern[0] == 1 else _ambiguity(moments),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Invariants:
    """What decides the pattern: numbers that no rotation of either cloud changes.

    e1, e2: elementary symmetric functions of the eigenvalues d_i^2 of C^T C; det: det C, so that
        the third is e3 = det^2.
    """

    e1: Any
    e2: Any
    det: Any

    @property
    def discriminant(self) -> Any:
        """The discriminant of the characteristic polynomial of C^T C: prod (d_i^2 - d_j^2)^2."""
        e1, e2, e3 = self.e1, self.e2, self.det * self.det
        return e2 * e2 * (e1 * e1 - 4 * e2) - e3 * (4 * e1 * e1 * e1 - 18 * e1 * e2 + 27 * e3)

    @property
    def cubic_invariant(self) -> Any:
        """2 e1^3 - 9 e1 e2 + 27 e3, for a double d_i^2 = p and a single one r 2 (r - p)^3."""
        e1, e2, e3 = self.e1, self.e2, self.det * self.det
        return 2 * e1 * e1 * e1 - 9 * e1 * e2 + 27 * e3


def invariants(C: Sequence[Sequence[T]]) -> Invariants:
    """The invariants of a 3x3 matrix, polynomials in its entries: no root, no quotient."""
    (a, b, c), (d, e, f), (g, h, i) = C
    cofactors: Any = (
        (e * i - f * h, f * g - d * i, d * h - e * g),
        (c * h - b * i, a * i - c * g, b * g - a * h),
        (b * f - c * e, c * d - a * f, a * e - b * d),
    )
    return Invariants(
        e1=sum([entry * entry for row in C for entry in row]),
        e2=sum([entry * entry for row in cofactors for entry in row]),
        det=a * cofactors[0][0] + b * cofactors[0][1] + c * cofactors[0][2],
    )


def decide(found: Invariants) -> Pattern:
    """The pattern, from nothing but the signs of the invariants."""
    if found.discriminant != 0:
        return (1, 1, 1, 1)
    if found.e1 == 0:
        return (4,)
    if found.e2 == 0:
        return (2, 2)
    cubic_invariant = found.cubic_invariant
    if cubic_invariant == 0:
        return (1, 3) if found.det > 0 else (3, 1)
    if cubic_invariant < 0:
        return (1, 2, 1)
    return (1, 1, 2) if found.det > 0 else (2, 1, 1)


def pattern_of(C: Sequence[Sequence[int]]) -> Pattern:
    """Multiplicities of the eigenvalues of K(C), largest first, for an integer 3x3 matrix C.

    >>> (
    ...     pattern_of(((1, 0, 0), (0, 2, 0), (0, 0, 3))),
    ...     pattern_of(((1, 0, 0), (0, 1, 0), (0, 0, -1))),
    ... )
    ((1, 1, 1, 1), (3, 1))
    """
    small = invariants([[entry % PRIME for entry in row] for row in C])
    if small.discriminant % PRIME:  # so it is not 0
        return (1, 1, 1, 1)
    return decide(invariants(C))


def _ambiguity(moments: ExactMoments) -> Ambiguity:
    source, target = rank(moments.source_scatter), rank(moments.target_scatter)
    correlation = rank(moments.cross)
    reasons = (
        (source == 0, Ambiguity.COINCIDENT_SOURCE),
        (target == 0, Ambiguity.COINCIDENT_TARGET),
        (source == 1, Ambiguity.COLLINEAR_SOURCE),
        (target == 1, Ambiguity.COLLINEAR_TARGET),
        (correlation == 0, Ambiguity.UNCORRELATED),
        (correlation == 1, Ambiguity.RANK_ONE),
    )
    return next((reason for holds, reason in reasons if holds), Ambiguity.MIRRORED)
