"""How far the integer quaternion of an eigenspace is from the exact one, proved in integers.

Between two eigenspaces of K a number m is chosen, and the eigenvalues above it are counted exactly,
by Descartes' rule on the characteristic polynomial of K - m I. Where one eigenvalue l lies between
two such numbers it is simple, and its index is the number above. Let v be the Rayleigh quotient of
a unit vector p = c u + s w, u the eigenvector, w a unit vector in the span of the three others,
whose eigenvalues are all at least g away from v. Then |K p - v p| >= |s| |K w - v w| >= |s| g, so

    sin^2(p, u) = s^2 <= |K p - v p|^2 / g^2,

and R(p) is within twice that angle of the exact rotation. Likewise an eigenvalue is no further from
v than |K p - v p|, and where that is less than g it is l. Source: [Davis1970].
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

from certreg.errors import UndecidedError
from certreg.exact.dyadic import rational_root_above
from certreg.exact.signs import signs_of_eigenvalues
from certreg.results import Brief, ComponentKind

if TYPE_CHECKING:
    from fractions import Fraction

    from certreg.exact.spaces import IntegerQuaternion
    from certreg.objective.isotropic import Isotropic


@dataclass(frozen=True, slots=True, kw_only=True)
class Eigenline(Brief):
    """An eigenspace of K, its place among them proved.

    quaternion: near it, in integers. index: number of eigenvalues above its own. sin2: of a point,
    at least sin^2 of the angle between `quaternion` and it, which is half the angle of rotation;
    None of a continuum. error: the eigenvalue is no further from that of `quaternion`.
    """

    quaternion: IntegerQuaternion
    kind: ComponentKind
    index: int
    sin2: Fraction | None
    error: Fraction


def eigenlines(objective: Isotropic) -> tuple[Eigenline, ...]:
    """All eigenspaces of K, largest eigenvalue first.

    Raises UndecidedError where 3,700 digits do not tell two eigenvalues apart.
    """
    resolution, shape = objective.eigenspaces, objective.classification
    values = [space.value for space in resolution.spaces]
    middles = [upper + lower for upper, lower in pairwise(values)]  # twice the numbers between
    for middle, above in zip(middles, shape.indices[1:], strict=True):
        if not _splits(objective, middle, above):
            raise UndecidedError(
                "two eigenvalues of the Davenport matrix are too close to be told apart",
                method="spectral",
            )
    half = objective.eigenvalue_unit / 2
    marks = [None, *[middle * half for middle in middles], None]
    parts = zip(resolution.quaternions, shape.pattern, shape.indices, pairwise(marks), strict=True)
    return tuple(_eigenline(objective, *part) for part in parts)


def energy_is_at_least(objective: Isotropic, bound: Fraction) -> bool:
    """Whether the least energy over all poses, s - 2 l1, is at least `bound`: exact, no root."""
    highest = (objective.moments.spread - bound) / (2 * objective.moments.cross_unit)
    up, shift = highest.denominator, highest.numerator
    return signs_of_eigenvalues(_shifted(objective, up, shift)).positive == 0


def _splits(objective: Isotropic, middle: int, above: int) -> bool:
    """Whether so many eigenvalues of K are above middle / 2, in fixed point, and none is there."""
    places = objective.shift - objective.eigenspaces.bits - 1
    up, down = max(places, 0), max(-places, 0)
    signs = signs_of_eigenvalues(_shifted(objective, 1 << down, middle << up))
    return signs.positive == above and not signs.zero


def _shifted(objective: Isotropic, times: int, shift: int) -> list[list[int]]:
    """The matrix times K - shift I."""
    return [
        [times * entry - (shift if i == j else 0) for j, entry in enumerate(row)]
        for i, row in enumerate(objective.davenport)
    ]


def _eigenline(
    objective: Isotropic,
    q: IntegerQuaternion,
    many: int,
    index: int,
    between: tuple[Fraction | None, Fraction | None],
) -> Eigenline:
    """The only eigenspace between two numbers, near a quaternion."""
    value, square = objective.alignment(q), objective.squared_residual(q)
    upper, lower = between
    gaps = [upper - value] if upper is not None else []
    gaps += [value - lower] if lower is not None else []
    error = rational_root_above(square)
    if any(gap <= error for gap in gaps):
        raise UndecidedError(
            "an eigenvector of the Davenport matrix was not found to the precision asked for",
            method="spectral",
        )
    return Eigenline(
        quaternion=q,
        kind=ComponentKind.of_multiplicity(many),
        index=index,
        sin2=square / min(gaps) ** 2 if many == 1 else None,
        error=error,
    )
