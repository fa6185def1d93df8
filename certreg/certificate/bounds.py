"""From a proved certificate to proved bounds on any other pose, exactly.

The certificate brackets the minimum: energy(q) - gap < minimum <= energy(q). So the energy of any
pose, computed exactly, has an exact lower and upper distance to the minimum; and its angle to an
optimum differs from its angle to the certified rotation by less than the certified angle.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import TYPE_CHECKING

from certreg.exact.dyadic import (
    double_above,
    double_below,
    half_angle_bound,
    rational_root_above,
    root_above,
)
from certreg.geometry.so3 import body_frame, dot, rotation_matrix, squared_norm
from certreg.problem.lifting import lift
from certreg.results import Absent, Explained, Limits, present

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from certreg.certificate.pose_claims import PoseBody
    from certreg.objective.isotropic import Isotropic
    from certreg.objective.springs import Springs
    from certreg.problem.moments import ExactMoments


NO_ANGLE = Absent("the optimum is not unique: no angle to 'the' optimum exists")
NOT_CLAIMED = Absent("the certificate bounds no angle, though the optimum is unique")
NOTHING = Fraction(0)
NO_ANGLE_CLAIMED = Absent("the certificate bounds no angle to the optima")
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
NO_RANGE = Absent("every rotation fits equally: the range of energies is zero")


@dataclass(frozen=True, slots=True, kw_only=True)
class PoseBounds(Explained):
    """What is proved of one pose.

    least_gap, greatest_gap: exact bounds on objective - minimum, in objective units.
    angle_upper: radians, to every optimum; None where the certificate bounds no angle.
    least_range_squared: of a number that the range of energies over all rotations is not below.
    shift_upper: how far at most the pose puts the source's weighted centre from where an optimum
        puts it, in the clouds' unit, rounded up; None where nothing of it is proved.
    flat_energy: what the gap is held against where that range is zero: the clouds' spread, which is
        the least objective then. Two clouds that are a point each have none: there is no length but
        their distance from the origin, whose squares are weighted and summed instead.
    """

    least_gap: Fraction
    greatest_gap: Fraction
    angle_upper: float | None
    least_range_squared: Fraction
    shift_upper: float | None = None
    flat_energy: Fraction = Fraction(0)

    @property
    def share_upper(self) -> float | None:
        """`greatest_gap` over the range of energies, rounded up; None where that range is zero."""
        if not self.least_range_squared:
            return None
        return root_above(self.greatest_gap**2 / self.least_range_squared)

    def meet(self, limits: Limits, *, unique: bool) -> bool:
        """Whether the proved bounds are within limits; unique: whether an angle is asked for, too.

        Where the range is zero every rotation is optimal, and only the translation costs.
        """
        if not self.least_range_squared:
            return self.greatest_gap <= Fraction(limits.max_gap) * self.flat_energy
        if self.greatest_gap**2 > Fraction(limits.max_gap) ** 2 * self.least_range_squared:
            return False
        return not unique or (self.angle_upper is not None and self.angle_upper <= limits.max_angle)

    def covers_range(self, gap: Fraction) -> bool:
        """Whether a gap bounds nothing: it may reach over all energies there are.

        False where the range is zero: there is nothing to bound.
        """
        return bool(self.least_range_squared) and gap**2 >= self.least_range_squared

    @property
    def gap_lower(self) -> float:
        """`least_gap` as a double, rounded down."""
        return double_below(self.least_gap)

    @property
    def gap_upper(self) -> float:
        """`greatest_gap` as a double, rounded up; infinite beyond the doubles."""
        return double_above(self.greatest_gap)


@dataclass(frozen=True, slots=True, kw_only=True)
class ExactPose:
    """A rational pose: the rotation of an integer quaternion, normalised, translation and scale."""

    quaternion: tuple[int, ...]
    translation: tuple[Fraction, ...]
    scale: Fraction = Fraction(1)

    def moved(self, point: Sequence[Fraction]) -> tuple[Fraction, ...]:
        """The point s R x + t, exactly."""
        norm = squared_norm(self.quaternion)
        rows = zip(rotation_matrix(self.quaternion), self.translation, strict=True)
        return tuple(
            self.scale
            * sum((a * x for a, x in zip(row, point, strict=True)), start=Fraction(0))
            / norm
            + t
            for row, t in rows
        )

    @classmethod
    def of_doubles(
        cls,
        quaternion: NDArray[np.float64],
        translation: NDArray[np.float64],
        scale: float = 1.0,
    ) -> ExactPose:
        """The pose with exactly these doubles, the quaternion normalised."""
        return cls(
            quaternion=tuple(lift(quaternion).integers),
            translation=tuple(Fraction(entry) for entry in translation.tolist()),
            scale=Fraction(scale),
        )


def pose_bounds(
    objective: Isotropic,
    body: PoseBody,
    pose: ExactPose,
    *,
    shifted: Fraction | None = None,
    energy: Fraction | None = None,
) -> PoseBounds:
    """Bounds on a pose; they hold if the checker accepts the certificate for these data.

    shifted, energy: of the pose, `translation_energy` and `pose_energy`, where they are known.
    Every optimum takes the source's centroid to that of the target, whatever its rotation: so the
    shift is exact but for rounding. The energy of the symmetric scale is a root, bounded from
    below: see `Scaling.slack`.
    """
    if shifted is None:
        shifted = objective.translation_energy(pose.quaternion, pose.translation, pose.scale)
    energy = pose_energy(objective, pose, shifted) if energy is None else energy
    above, range_squared = energy - objective.energy(body.quaternion), objective.least_range_squared
    flat = not range_squared  # then the certified rotation has the minimum itself
    least = above if objective.scaling is None else above - objective.scaling.slack
    return PoseBounds(
        least_gap=max(NOTHING, least),
        greatest_gap=max(NOTHING, above if flat else above + body.gap),
        angle_upper=_angle_upper(body, pose.quaternion),
        least_range_squared=range_squared,
        shift_upper=root_above(shifted / objective.moments.total_weight),
        flat_energy=flat_energy(objective.moments),
        absent={
            "angle_upper": NOT_CLAIMED if objective.classification.unique else NO_ANGLE,
            **({"share_upper": NO_RANGE} if flat else {}),
        },
    )


def flat_energy(moments: ExactMoments) -> Fraction:
    """The energy that says which are small where all rotations fit equally; see `PoseBounds`."""
    if moments.spread:
        return moments.spread
    centroids = (*moments.source_centroid, *moments.target_centroid)
    return moments.total_weight * sum((c * c for c in centroids), start=Fraction(0))


def pose_energy(objective: Isotropic, pose: ExactPose, shifted: Fraction | None = None) -> Fraction:
    """The objective at exactly this pose: sum w |y - R x - t|^2, of a free scale its own.

    shifted: its `translation_energy`, where that is known.
    """
    q = pose.quaternion
    if shifted is None:
        shifted = objective.translation_energy(q, pose.translation, pose.scale)
    return objective.energy_at(q, shifted, pose.scale)


def sin2_half_angle_between(p: Sequence[int], q: Sequence[int]) -> Fraction:
    """sin^2(theta/2) of the angle from R(p) to R(q), for integer quaternions, exactly."""
    across = [dot(column, q) for column in zip(*body_frame(p), strict=True)]
    return Fraction(squared_norm(across), squared_norm(p) * squared_norm(q))


def _angle_upper(body: PoseBody, q: Sequence[int]) -> float | None:
    claimed = body.claims.sin2_half_angle
    return None if claimed is None else angle_from(body.quaternion, q, claimed.value)


def angle_from(certified: Sequence[int], q: Sequence[int], claimed: Fraction) -> float:
    """A bound in radians on the angle from R(q) to the optima; claimed: sin^2 of half of theirs."""
    own = half_angle_bound(sin2_half_angle_between(certified, q))
    return min(math.pi, math.nextafter(own + half_angle_bound(claimed), math.inf))


def spring_energy(objective: Springs, pose: ExactPose) -> Fraction:
    """The same of springs with matrices: sum (y - R x - t)^T W (y - R x - t)."""
    q = pose.quaternion
    return objective.energy(q) + objective.translation_energy(q, pose.translation)


def spring_pose_bounds(objective: Springs, body: PoseBody, pose: ExactPose) -> PoseBounds:
    """Bounds on a pose; they hold if the checker accepts the certificate for these data.

    The energy is a sum of squares, so no pose is farther above the minimum than its own energy:
    that is the better bound where the certificate's is coarse and the springs fit well.
    """
    q, least = pose.quaternion, objective.energy(body.quaternion)
    energy = spring_energy(objective, pose)
    span = least_range(objective, least)
    above = energy - least
    shifted = _shift(objective, body, pose)
    return PoseBounds(
        least_gap=max(Fraction(0), above),
        greatest_gap=min(energy, max(Fraction(0), above + body.gap if span else above)),
        angle_upper=_angle_upper(body, q),
        least_range_squared=span**2,
        shift_upper=present(shifted),
        flat_energy=least or objective.translation_energy(q, (Fraction(0),) * 3),
        absent={
            "angle_upper": NO_ANGLE_CLAIMED if body.claims.unique is not False else NO_ANGLE,
            **({} if span else {"share_upper": NO_RANGE}),
            **({"shift_upper": shifted} if isinstance(shifted, Absent) else {}),
        },
    )


def _shift(objective: Springs, body: PoseBody, pose: ExactPose) -> float | Absent:
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
