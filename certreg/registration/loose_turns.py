"""Turns about an axis that the noise leaves open: from what deviation on, and an axis in words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from certreg.results import Absent

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from certreg.registration.covariance import PoseCovariance

# About an axis a turn by a costs 4 sin^2(a/2) / sigma^2 in units of the noise, 4 / sigma^2 at most:
LOOSE_SIGMA = 0.4  # radians, as 4 / 0.4^2 = 25, the square of five standard deviations


class TooLarge(Absent):
    """What a first order would have to say of a large turn."""


TURNED_FAR = TooLarge("the pose is turned too far from the optimum for a first order")


def beyond_first_order(covariance: PoseCovariance) -> TooLarge | None:
    """Why no deviation of a turn is told, to first order, where one is that large."""
    if covariance.loosest_sigma <= LOOSE_SIGMA:
        return None
    about = axis_words(covariance.loosest_axis)
    return TooLarge(f"the turn about {about} is hardly determined, far beyond a first order")


def axis_words(axis: NDArray[np.float64]) -> str:
    """A unit vector in three digits.

    >>> import numpy as np
    >>> axis_words(np.array([1.0, -1e-7, 0.0]))
    '(1, 0, 0)'
    """
    return f"({', '.join(f'{entry + 0.0:.3g}' for entry in axis.round(3))})"


def axes_words(axes: Sequence[NDArray[np.float64]]) -> str:
    """Directions as unit vectors in three digits; of two any mix is meant."""
    named = [axis_words(axis) for axis in axes]
    return named[0] if len(named) == 1 else f"{', '.join(named)} or any mix of them"
