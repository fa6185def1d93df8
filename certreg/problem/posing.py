"""The pose of two clouds in floating point by one call into C, where nothing stands against it.

What `moments_of_clouds` and Horn's closed form do in many steps, with the same bound on rounding. A
module of its own: whatever is unusual is left to those, which mend it or say what is wrong.
"""

from __future__ import annotations

import ctypes
import math
from dataclasses import dataclass
from functools import cache
from itertools import chain
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.geometry.pose import Pose
from certreg.native.library import library_if_any
from certreg.problem.floating_sums import CHUNK_POINTS, TAKEN, CloudPoints, columns_of
from certreg.problem.moments import (
    LARGEST_LEVER,
    LEAST_SUM,
    MOST_SUM,
    davenport_error,
    rounding_of,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

NUMBERS = 39  # CERTREG_POSE, as in native/pose.h, and its parts
QUATERNION, ROTATION, TRANSLATION = slice(4), slice(4, 13), slice(13, 16)
DECIDING, CROSS = slice(16, 24), slice(24, 33)
TURNED = 16  # numbers of a pose
SOURCE_MEAN, TARGET_MEAN = slice(33, 36), slice(36, 39)


_Numbers = ctypes.c_double * NUMBERS


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FloatingPose:
    """What is found, and what decides whether rounding leaves it in doubt.

    gap: between the two largest eigenvalues of the Davenport matrix; error: how far these may be
        off, the residual of eigenvectors that LAPACK did not find included.
    numbers: (39,), all that native/pose.h tells; a similarity takes more of them than a pose.
    """

    pose: Pose
    gap: float
    error: float
    numbers: NDArray[np.float64]

    @property
    def cross_covariance(self) -> NDArray[np.float64]:
        """(3, 3), sum w (y - mean)(x - mean)^T."""
        return self.numbers[CROSS].reshape(3, 3)

    @property
    def means(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(3,) each, weighted: of source and target."""
        return self.numbers[SOURCE_MEAN], self.numbers[TARGET_MEAN]

    @property
    def spreads(self) -> tuple[float, float]:
        """The sums of w |x - mean|^2 and w |y - mean|^2."""
        mass, here, scatter, there, spread = self.numbers[DECIDING].tolist()[:5]
        return scatter - here / mass, spread - there / mass


def floating_pose(
    source: NDArray[Any],
    target: NDArray[Any],
    weights: NDArray[Any] | None,
    *,
    about_origin: bool = False,
) -> FloatingPose | None:
    """The pose of clouds (N, 3), weights (N,), by one pass; None where more steps must decide.

    about_origin: a rotation alone; the origin takes the place of both means. The other steps are
    needed with: no compiled library, types that it does not read, many points, numbers
    that are not finite or whose squares leave the doubles, weights < 0, a mean far from that of a
    few points.
    """
    posed = _posed()
    known = source.dtype in TAKEN and target.dtype in TAKEN
    known = known and (weights is None or weights.dtype in TAKEN)
    if posed is None or not known or len(source) > CHUNK_POINTS:
        return None
    content: Any = _Numbers()  # of NumPy's buffers
    columns = (*columns_of(source), *columns_of(target), *columns_of(weights))
    points = CloudPoints(len(source), *columns)
    posed(ctypes.byref(points), ctypes.c_int(about_origin), ctypes.byref(content))
    numbers: NDArray[np.float64] = np.frombuffer(content)
    found: list[float] = numbers[DECIDING].tolist()
    mass, here, scatter, there, spread, gap, norm, residual = found
    if not (LEAST_SUM <= mass <= MOST_SUM and LEAST_SUM <= scatter <= MOST_SUM):
        return None
    if not LEAST_SUM <= spread <= MOST_SUM:
        return None
    lever, times = 1.0 + LARGEST_LEVER, LARGEST_LEVER * mass
    if not (lever * here <= times * scatter and lever * there <= times * spread):
        return None
    return FloatingPose(
        pose=Pose(
            rotation=numbers[ROTATION].reshape(3, 3),
            translation=numbers[TRANSLATION],
            quaternion_wxyz=numbers[QUATERNION],
        ),
        gap=gap,
        error=residual + davenport_error(rounding_of(math.sqrt(scatter * spread)), norm),
        numbers=numbers,
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PosedPairs:
    """Clouds (N, 3) of doubles whose best pose is asked for under one set of weights after another.

    points: as C reads them, in these clouds.
    """

    points: CloudPoints
    clouds: tuple[NDArray[np.float64], NDArray[np.float64]]

    @classmethod
    def of(cls, source: NDArray[np.float64], target: NDArray[np.float64]) -> PosedPairs | None:
        """None where there is no compiled library."""
        if _posed() is None:
            return None
        columns = chain.from_iterable(map(columns_of, (source, target, None)))
        return cls(points=CloudPoints(len(source), *columns), clouds=(source, target))

    def motion(
        self, weights: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
        """R (3, 3) and t (3,) of the least sum of w |y - R x - t|^2, weights (N,).

        None where they are not finite.
        """
        content: Any = _Numbers()
        points = self.points
        (
            points.weights_data,
            points.weights_row,
            points.weights_column,
            points.weights_single,
        ) = columns_of(weights)
        _posed()(ctypes.byref(points), ctypes.c_int(0), ctypes.byref(content))
        numbers: NDArray[np.float64] = np.frombuffer(content)
        rotation, translation = numbers[ROTATION].reshape(3, 3), numbers[TRANSLATION]
        return (rotation, translation) if math.isfinite(sum(content[:TURNED])) else None


@cache
def _posed() -> Any:
    """The function in C; None where there is no compiled library."""
    library = library_if_any()
    return None if library is None else library.handle.certreg_pose
