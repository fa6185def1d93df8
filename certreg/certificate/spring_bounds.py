"""From a proved certificate of general springs to proved bounds on any pose, exactly."""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from typing import TYPE_CHECKING, Protocol

from certreg.certificate.bounds import NO_ANGLE, NO_RANGE, ExactPose, PoseBounds, angle_from
from certreg.results import Absent

if TYPE_CHECKING:
    from collections.abc import Iterator

    from certreg.certificate.springs_sos import SpringsClaims
    from certreg.objective import Springs

NOT_CLAIMED = Absent("the certificate bounds no angle to the optima")
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
    """Bounds on a pose; they hold if the checker accepts the certificate for these data."""
    q, least = pose.quaternion, objective.energy(body.quaternion)
    energy = objective.energy(q) + objective.translation_energy(q, pose.translation)
    span = least_range(objective, least)
    above = energy - least
    told = body.claims.sin2_half_angle
    return PoseBounds(
        least_gap=max(Fraction(0), above),
        greatest_gap=max(Fraction(0), above + body.gap if span else above),
        angle_upper=None if told is None else angle_from(body.quaternion, q, told.value),
        least_range_squared=span**2,
        flat_energy=least or objective.translation_energy(q, (Fraction(0),) * 3),
        absent={
            "angle_upper": NOT_CLAIMED if body.claims.unique is not False else NO_ANGLE,
            **({} if span else {"share_upper": NO_RANGE}),
        },
    )


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
