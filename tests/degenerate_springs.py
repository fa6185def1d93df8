"""Springs of exact numbers whose critical lines meet, or are a continuum, by name."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from certreg.problem.problem import RegistrationProblem

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Points = NDArray[np.float64]

E1, E2, E3 = np.eye(3)
POINTS = np.array(
    [
        [3, 1, -2], [-1, 4, 2], [2, -3, 5], [-4, -2, 1], [1, 5, -3], [5, 2, 4], [-2, 3, -5],
        [4, -1, 3], [-3, -4, -2], [2, 2, 1], [-5, 1, 3], [1, -2, -4],
    ],
    dtype=float,
)  # fmt: skip
SPHERE = np.array([[1, 2, 2], [2, -1, 2], [-2, 2, 1], [2, 3, 6], [3, -6, 2], [-6, -2, 3],
    [1, -4, 8], [4, 8, -1], [-8, 1, 4], [2, -6, 9]], dtype=float)  # fmt: skip
CIRCLE = np.array([[3, 4], [-4, 3], [5, 12], [-12, 5], [8, -15], [15, 8], [7, 24], [-24, 7],
    [20, -21], [-21, -20]], dtype=float)  # fmt: skip


def planes(source: Points, target: Points, normals: Points) -> RegistrationProblem:
    """Point to plane; normals may have any length: integers are exact."""
    factors = np.zeros((len(source), 6))
    factors[:, [0, 1, 3]] = normals
    return RegistrationProblem(source, target, factors=factors)


def _moved(k: float) -> Points:
    """Targets off the source by small integers."""
    shift = np.arange(3 * len(POINTS)).reshape(-1, 3) * k % 5 - 2.0
    return POINTS + np.array(shift, dtype=np.float64)


def wall() -> RegistrationProblem:
    """One wall: all normals equal."""
    return planes(POINTS, _moved(3), np.tile(E3, (len(POINTS), 1)))


def two_walls() -> RegistrationProblem:
    """Normals along two axes."""
    return planes(POINTS, _moved(3), np.array([E1, E2] * 6))


def corner() -> RegistrationProblem:
    """Normals along three axes."""
    return planes(POINTS, _moved(3), np.array([E1, E2, E3] * 4))


def sphere() -> RegistrationProblem:
    """A sphere without noise: integer points p of rational length, normals along them."""
    lengths = np.linalg.norm(SPHERE, axis=1, keepdims=True)
    points = SPHERE * (1386.0 / lengths)  # 3, 7, 9, 11 divide it
    return planes(np.rint(points), np.rint(points), SPHERE)


def cylinder() -> RegistrationProblem:
    """A cylinder about the third axis without noise."""
    lengths = np.linalg.norm(CIRCLE, axis=1, keepdims=True)
    across = np.rint(CIRCLE * (25 * 13 * 17 * 29 / lengths))
    heights = 1000.0 * np.array([-4, 3, -2, 5, 1, 0, 2, -3, 4, -1])
    points = np.column_stack([across, heights])
    return planes(points, points, np.column_stack([CIRCLE, np.zeros(10)]))


def screw() -> RegistrationProblem:
    """A helicoid, all points at one distance r from its axis: the exact fits are a curve.

    At (x, y, z) the normal is (-y, x, -r): a turn by an angle a about the axis with a shift by
    sin(a) r along it costs nothing, whatever z is.
    """
    r = 25 * 13 * 17 * 29.0
    lengths = np.linalg.norm(CIRCLE, axis=1, keepdims=True)
    across = np.rint(CIRCLE * (r / lengths))
    heights = 1000.0 * np.array([-4, 3, -2, 5, 1, 0, 2, -3, 4, -1])
    normals = np.column_stack([-across[:, 1], across[:, 0], np.full(10, -r)])
    points = np.column_stack([across, heights])
    return planes(points, points, normals)


def logarithm() -> RegistrationProblem:
    """The surface z = k log r, with the axis as the third: the exact fits are a curve.

    At (x, y, z) the normal is (-k x, -k y, r^2). A turn by an angle a about the axis moves a point
    by k r^2 (1 - cos a) along it, and a shift by k (cos a - 1) along the axis takes that back, at
    all r at once and whatever z is.
    """
    k = 5.0
    squared = (POINTS[:, :2] ** 2).sum(axis=1)
    normals = np.column_stack([-k * POINTS[:, :2], squared])
    return planes(POINTS, POINTS, normals)


def collinear() -> RegistrationProblem:
    """Points on a line, isotropic springs."""
    source = np.outer([-3.0, -1.0, 0.0, 2.0, 4.0], [1.0, 2.0, 2.0])
    target = np.outer([-3.0, -1.0, 1.0, 2.0, 4.0], [2.0, 2.0, -1.0])
    return _shared(source, target, (1.0, 1.0, 1.0))


def isotropic() -> RegistrationProblem:
    """The same spring in every direction, stated as a matrix."""
    return _shared(POINTS, _moved(3), (1.0, 1.0, 1.0))


def shared_two() -> RegistrationProblem:
    """W = diag(1, 1, 4) for every pair, of a cloud with isotropic second moments."""
    return _shared(POINTS, _moved(3), (1.0, 1.0, 2.0))


def shared_three() -> RegistrationProblem:
    """W = diag(1, 4, 9) for every pair."""
    return _shared(POINTS, _moved(3), (1.0, 2.0, 3.0))


def five_planes() -> RegistrationProblem:
    """One condition too few: the exact fits are a curve."""
    normals = np.array([[1, 2, 3], [2, -1, 1], [-1, 1, 4], [3, 1, -2], [1, -3, 1]], dtype=float)
    return planes(POINTS[:5], _moved(3)[:5], normals)


def two_lines() -> RegistrationProblem:
    """Point to line, two pairs."""
    factors = np.array([[1, 0, 1, 0, 0, 0], [1, 0, 0, 0, 1, 0]], dtype=float)
    return RegistrationProblem(POINTS[:2], _moved(3)[:2], factors=factors)


def _shared(
    source: Points, target: Points, roots: tuple[float, float, float]
) -> RegistrationProblem:
    a, b, c = roots
    factors = np.tile([a, 0.0, b, 0.0, 0.0, c], (len(source), 1))
    return RegistrationProblem(source, target, factors=factors)


NAMED: dict[str, Callable[[], RegistrationProblem]] = {
    make.__name__.replace("_", " "): make
    for make in (
        wall, two_walls, corner, sphere, cylinder, screw, logarithm, collinear, isotropic,
        shared_two, shared_three, five_planes, two_lines,
    )
}  # fmt: skip
