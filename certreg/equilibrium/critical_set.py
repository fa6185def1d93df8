"""What every search for equilibria returns, whatever it searches with: a critical set.

By the spectral theorem that of one weight per pair is the eigenspaces of the Davenport matrix.
Exact where it decides (how many components, of which kind, which index), and precise where it
proposes: the eigenspaces are refined in integer arithmetic until eigenvalues that are exactly
distinct are well apart in them, however close they are.
"""

from __future__ import annotations

import enum
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from certreg.results import Brief, Guarantee

if TYPE_CHECKING:
    from fractions import Fraction

    from certreg.exact.spaces import IntegerQuaternion, Resolution
    from certreg.objective.isotropic import Isotropic


class Completeness(enum.Enum):
    """The theorem by which a list has every critical rotation; the value is its statement."""

    SPECTRAL = (
        "The critical quaternions are the eigenvectors of a symmetric matrix, and these are its "
        "eigenspaces."
    )
    ELIMINATION = (
        "The quotient ring, or the Hilbert function, of the critical equations has no room for "
        "further solutions."
    )
    COUNT = "There are at most as many solutions as disjoint boxes with one root each."
    LINES = (
        "There are at most 40 critical lines, complex ones included, by two ranks, and 40 are "
        "apart: each real one in a box of its own, and pairs that are conjugates of one another."
    )
    CONSTANT = "The energy is the same at every rotation."


@dataclass(frozen=True, slots=True, kw_only=True)
class Critical(Brief):
    """A critical rotation of an objective, or a continuum of them.

    quaternion: of the rotation, in integers of any common length; in a continuum, of the member
        nearest to the identity, else to a half turn.
    span: unit quaternions in fixed point, orthogonal where there are several: the rotations of
        their combinations are the component. One for a point.
    value: of the objective, in its own unit, to the precision of the set.
    index: the number of independent directions in which the objective falls; None: not decided.
    guarantee: of the span, up to its precision, and of the index.
    """

    quaternion: IntegerQuaternion
    span: tuple[tuple[int, ...], ...]
    value: Fraction
    index: int | None
    guarantee: Guarantee


@dataclass(frozen=True, slots=True, kw_only=True)
class CriticalSet(Brief):
    """Critical rotations by ascending value, found by one method.

    bits: fractional bits of every span.
    completeness: why these are all; None where that is not proved, and then `doubt` says in words
        what may be missing.
    """

    method: str
    components: tuple[Critical, ...]
    bits: int
    completeness: Completeness | None
    doubt: str | None = None

    def __post_init__(self) -> None:
        """Raises ValueError unless there is either a proof or a doubt."""
        if (self.completeness is None) == (self.doubt is None):
            raise ValueError("a list is proved to be complete, or it says what may be missing")

    @property
    def guarantee(self) -> Guarantee:
        """That of the least sure component."""
        return min(part.guarantee for part in self.components)

    @property
    def complete(self) -> bool:
        """Whether these are proved to be all critical rotations."""
        return self.completeness is not None

    @property
    def pattern(self) -> tuple[int, ...]:
        """Dimensions of the spans, by ascending value: 1 for a point."""
        return tuple(len(part.span) for part in self.components)

    @property
    def indices(self) -> tuple[int | None, ...]:
        """The index of each component, None where it is not decided."""
        return tuple(part.index for part in self.components)


def spaces_as_components(
    resolution: Resolution,
    value_of: Callable[[int, int], Fraction],
    indices: Sequence[int | None],
    guarantee: Guarantee,
) -> tuple[Critical, ...]:
    """Linear spaces of quaternions as critical components.

    value_of: the objective at a value of theirs, in fixed point with so many bits.
    """
    parts = zip(resolution.quaternions, resolution.spaces, indices, strict=True)
    return tuple(
        Critical(
            quaternion=q,
            span=space.vectors,
            value=value_of(space.value, resolution.bits),
            index=index,
            guarantee=guarantee,
        )
        for q, space, index in parts
    )


SPECTRAL = "spectral"


def by_eigenspaces(objective: Isotropic) -> CriticalSet:
    """The eigenspaces of K; kinds and indices by the exact classification."""
    return CriticalSet(
        method=SPECTRAL,
        components=spaces_as_components(
            objective.eigenspaces,
            objective.energy_of_eigenvalue,
            objective.classification.indices,
            Guarantee.EXACT,
        ),
        bits=objective.eigenspaces.bits,
        completeness=Completeness.SPECTRAL,
    )
