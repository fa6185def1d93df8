"""From a proved certificate to proved bounds on any other pose, exactly.

The certificate brackets the minimum: energy(q) - gap < minimum <= energy(q). So the energy of any
pose, computed exactly, has an exact lower and upper distance to the minimum; and its angle to an
optimum differs from its angle to the certified rotation by less than the certified angle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from certreg.dyadic import double_above, double_below, half_angle_bound
from certreg.energy import potential_energy, translation_energy
from certreg.problem import lift
from certreg.so3 import body_frame, squared_norm

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from certreg.certificate.types import Certificate
    from certreg.moments import ExactMoments


@dataclass(frozen=True, slots=True, kw_only=True)
class PoseBounds:
    """What is proved of one pose: doubles rounded outwards.

    gap_lower, gap_upper: bounds on objective - minimum.
    angle_upper: radians, to every optimum; None where the certificate bounds no angle.
    """

    gap_lower: float
    gap_upper: float
    angle_upper: float | None


def pose_bounds(
    moments: ExactMoments,
    certificate: Certificate,
    quaternion: NDArray[np.float64],
    translation: NDArray[np.float64],
) -> PoseBounds:
    """Bounds on the pose with exactly this quaternion (normalised) and translation.

    They hold if the checker accepts the certificate for the data of these moments.
    """
    q = lift(quaternion).integers
    above = pose_energy(moments, quaternion, translation)
    above -= potential_energy(moments, certificate.quaternion)
    return PoseBounds(
        gap_lower=double_below(max(Fraction(0), above)),
        gap_upper=double_above(max(Fraction(0), above + certificate.gap)),
        angle_upper=_angle_upper(certificate, q),
    )


def pose_energy(
    moments: ExactMoments, quaternion: NDArray[np.float64], translation: NDArray[np.float64]
) -> Fraction:
    """The objective sum w |y - R x - t|^2 at exactly this quaternion, normalised, and t."""
    q = lift(quaternion).integers
    shift = [Fraction(entry) for entry in translation.tolist()]
    return potential_energy(moments, q) + translation_energy(moments, q, shift)


def sin2_half_angle_between(p: Sequence[int], q: Sequence[int]) -> Fraction:
    """sin^2(theta/2) of the angle from R(p) to R(q), for integer quaternions, exactly."""
    across = [
        sum(a * b for a, b in zip(c, q, strict=True)) for c in zip(*body_frame(p), strict=True)
    ]
    return Fraction(squared_norm(across), squared_norm(p) * squared_norm(q))


def _angle_upper(certificate: Certificate, q: Sequence[int]) -> float | None:
    claimed = certificate.claims.sin2_half_angle
    if claimed is None:
        return None
    own = half_angle_bound(sin2_half_angle_between(certificate.quaternion, q))
    return min(math.pi, math.nextafter(own + half_angle_bound(claimed.value), math.inf))
