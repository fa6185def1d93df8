"""From a proved certificate of general springs to proved bounds on any pose, exactly."""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from typing import TYPE_CHECKING, Protocol

from certreg.certificate.bounds import NO_ANGLE, NO_RANGE, ExactPose, PoseBounds, angle_from
from certreg.exact.dyadic import double_above, rational_root_above
from certreg.geometry.so3 import squared_norm
from certreg.results import Absent, present

if TYPE_CHECKING:
    from collections.abc import Iterator

    from certreg.certificate.springs_sos import SpringsClaims
    from certreg.objective.springs import Springs

NOT_CLAIMED = Absent("the certificate bounds no angle to the optima")
NO_SHIFT = Absent("the certificate bounds no angle to the optima, and so no shift")
SHIFT_IS_FREE = Absent("no spring resists some shift: optima are as far along it as one likes")
FARTHEST = 8  # norm(R - R')^2 = 8 sin^2(angle / 2), of rotations
CONSTANT = 6  # the dimension of the symmetries of an energy that all rotations have
FAR = (  # half turns, turns by 90 and 120 degrees: the 24 of a cube
    *((0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1), (1, 0, 0, 0)),
    *((1, s, 0, 0) for s in (1, -1)),
    *((1, 0, s, 0) for s in (1, -1)),
    *((1, 0, 0, s) for s in (1, -1)),
    *((1, r, s, t) for r, s, t in product((1, -1), repeat=3)),
    *((0, 1, s, 0) for s in (1, -1)),
    *((0, 1, 0, s) for s in (1, -1)),
    *((0, 0, 1, s) for s in (1, -1)),
)


class GrowthBody(Protocol):
    """What kinds of certificates of general springs have in common.

    f(q) >= f(quaternion) - gap + growth sin^2(angle / 2).
    """

    quaternion: tuple[int, int, int, int]
    claims: SpringsClaims

    @property
    def gap(self) -> Fraction:
        """The claimed bound on objective(R(q)) - minimum."""
        ...

    @property
    def growth(self) -> Fraction:
        """In units of the objective; 0 where nothing is proved of it."""
        ...


def spring_pose_bounds(objective: Springs, body: GrowthBody, pose: ExactPose) -> PoseBounds:
    """Bounds on a pose; they hold if the checker accepts the certificate for these data.

    The energy is a sum of squares, so no pose is farther above the minimum than its own energy:
    that is the better bound where the certificate's is coarse and the springs fit well.
    """
    q, least = pose.quaternion, objective.energy(body.quaternion)
    energy = objective.energy(q) + objective.translation_energy(q, pose.translation)
    span = least_range(objective, least)
    above = energy - least
    told = body.claims.sin2_half_angle
    shifted = _shift(objective, body, pose)
    return PoseBounds(
        least_gap=max(Fraction(0), above),
        greatest_gap=min(energy, max(Fraction(0), above + body.gap if span else above)),
        angle_upper=None if told is None else angle_from(body.quaternion, q, told.value),
        least_range_squared=span**2,
        shift_upper=present(shifted),
        flat_energy=least or objective.translation_energy(q, (Fraction(0),) * 3),
        absent={
            "angle_upper": NOT_CLAIMED if body.claims.unique is not False else NO_ANGLE,
            **({} if span else {"share_upper": NO_RANGE}),
            **({"shift_upper": shifted} if isinstance(shifted, Absent) else {}),
        },
    )


def _shift(objective: Springs, body: GrowthBody, pose: ExactPose) -> float | Absent:
    """How far the pose puts the source's centre from where any optimum puts it, rounded up.

    At a rotation R the best translation puts the centre at p(R) = M vec R + const. All optima are
    there, at rotations R with norm(R - C)^2 = 8 sin^2(angle / 2), C the certified one and the angle
    proved. So norm(p(R) - p(C)) <= norm(M) norm(R - C), in Frobenius norms; and from p(C) the image
    under the pose is as far as it is, exactly.
    """
    if objective.free_translations:
        return SHIFT_IS_FREE
    centre, told = objective.centre, body.claims.sin2_half_angle
    slopes = objective.image_slopes(centre)
    size = sum((entry * entry for row in slopes for entry in row), start=Fraction(0))
    if told is None and size:
        return NO_SHIFT
    best = objective.best_translation(body.quaternion)
    there = ExactPose(quaternion=body.quaternion, translation=best).moved(centre)
    apart = [a - b for a, b in zip(pose.moved(centre), there, strict=True)]
    about = FARTHEST * size * (told.value if told else 0)
    return double_above(rational_root_above(squared_norm(apart)) + rational_root_above(about))


def least_range(objective: Springs, least: Fraction) -> Fraction:
    """A lower bound of max f - min f over all rotations, 0 only where f is constant.

    least: f at some rotation. From it and the rotations of a cube; others where all are alike.
    """
    if len(objective.symmetry) == CONSTANT:
        return Fraction(0)
    found = max(objective.energy(q) for q in FAR) - least
    return found if found > 0 else next(_differences(objective, least))


def _differences(objective: Springs, least: Fraction) -> Iterator[Fraction]:
    """|f - least| at rotations of small integers: of a form of degree four one is not zero."""
    for q in product(range(-4, 5), repeat=4):
        if any(q) and (apart := abs(objective.energy(q) - least)):
            yield apart
