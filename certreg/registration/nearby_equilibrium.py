"""The equilibrium of general springs at a rotation, and whether it is as good as the optimum.

Where a motion stopped, or a pose was printed, the energy is above that of the equilibrium there. So
Newton's steps are taken first, and then energies compared, exactly. What the steps leave of a slope
s, beside a least curvature c, is an energy of about s^2 / c. Where that is more than the difference
nothing is decided.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.certificate.bounds import sin2_half_angle_between
from certreg.exact.dyadic import half_angle_bound
from certreg.registration.curvature import slope_and_curvature
from certreg.relaxation.refining import refined

if TYPE_CHECKING:
    from fractions import Fraction

    from certreg.objective.normalisation import LevelledExactly
    from certreg.objective.springs import Springs

# Of the oscillation. Doubles hold the data to 1e-16 of them: what is closer is a tie but for their
# rounding, as the seven zeros of Choi and Lam's form are.
TIE = 1e-12


@dataclass(frozen=True, slots=True, kw_only=True)
class NearbyEquilibrium:
    """What Newton's steps led to from a rotation.

    index: directions in which the energy falls. angle: radians, from the rotation. slope, excess,
    left: over the energy's oscillation: what is left of the slope; the energy above that of the
    best rotation, exactly, rounded; what the slope that is left may still take from it.
    """

    index: int
    angle: float
    slope: float
    excess: float
    left: float

    @property
    def ties(self) -> bool:
        """Whether it is as good as the best rotation, but for the rounding of the data."""
        return self.excess <= TIE

    @property
    def is_worse(self) -> bool:
        """Whether the best rotation is better, whatever the slope that is left."""
        return self.excess - self.left > TIE


def equilibrium_near(
    objective: Springs, levelled: LevelledExactly, q: Sequence[int], least: Fraction
) -> NearbyEquilibrium:
    """What Newton's steps lead to from a rotation; the slope tells whether it is an equilibrium.

    least: the energy of the best rotation. The energy is not constant.
    """
    largest = max(map(abs, q))
    start = np.array([entry / largest for entry in q])
    u = refined(levelled, (start / np.linalg.norm(start)).tolist())
    slope, curvature = slope_and_curvature(objective, u)
    levels, steepness = np.linalg.eigvalsh(curvature), float(np.abs(slope).max())
    softest = float(np.abs(levels).min())
    left = float(slope @ slope) / softest if softest else float("inf")
    return NearbyEquilibrium(
        index=int((levels < 0.0).sum()),
        angle=float(half_angle_bound(sin2_half_angle_between(u, tuple(q)))),
        slope=steepness,
        excess=float((objective.energy(u) - least) / objective.oscillation),
        left=left if steepness else 0.0,
    )
