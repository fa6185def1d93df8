"""The paper's symmetric clouds: triangle and square that balance flipped, at every angle.

The target is a regular polygon, and the source the same polygon turned by theta and flipped over.
Each spring turns the source one way or the other; the turns cancel whatever theta is. Exactly:
with cos and sin as quadratic forms in two numbers, all sums are polynomials, and zero.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import library
from certreg.dynamics.rigid import rigid_body
from certreg.paper.equilibria import signs
from certreg.paper.particles import Particles, at_rest
from certreg.paper.scheme import RAW_UNIT
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem

if TYPE_CHECKING:
    from numpy.typing import NDArray

Plane = tuple[Any, Any]  # a point of the plane, or a row of a 2x2 matrix; any ring


@dataclass(frozen=True, slots=True, kw_only=True)
class Polygon:
    """A regular polygon: corner k is (a + b sqrt 3) / 2 in each coordinate, from integers (a, b).

    flip: the reflection of the plane that turning over the polygon is, seen from above.
    """

    name: str
    corners: tuple[tuple[tuple[int, int], tuple[int, int]], ...]
    flip: tuple[tuple[int, int], tuple[int, int]]

    def points(self, root: Any) -> tuple[Plane, ...]:
        """Twice the corners, `root` being the square root of 3 in the ring of the caller."""
        return tuple((a + b * root, c + d * root) for (a, b), (c, d) in self.corners)


TRIANGLE = Polygon(
    name="triangle",
    corners=(((2, 0), (0, 0)), ((-1, 0), (0, 1)), ((-1, 0), (0, -1))),
    flip=((1, 0), (0, -1)),  # over the line through the first corner
)
SQUARE = Polygon(
    name="square",
    corners=(((2, 0), (0, 0)), ((0, 0), (2, 0)), ((-2, 0), (0, 0)), ((0, 0), (-2, 0))),
    flip=((0, 1), (1, 0)),  # over the line through the middles of two sides
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Turn:
    """A polygon flipped and turned by every theta, springs of stiffness 2, circumradius 1.

    angles: (L,), radians. torques: (L, corners), of each spring about the centre. sides: (L, ...)
    energies: (L,), V_p. unstable: (L,), eigenvalues with positive real part.
    """

    polygon: Polygon
    angles: NDArray[np.float64]
    torques: NDArray[np.float64]
    energies: NDArray[np.float64]
    unstable: NDArray[np.int64]


def flipped(polygon: Polygon, points: tuple[Plane, ...], cos: Any, sin: Any) -> tuple[Plane, ...]:
    """The points flipped, then turned by the angle of (cos, sin)."""
    (a, b), (c, d) = polygon.flip
    over = [(a * x + b * y, c * x + d * y) for x, y in points]
    return tuple((cos * x - sin * y, sin * x + cos * y) for x, y in over)


def torques(source: tuple[Plane, ...], target: tuple[Plane, ...]) -> list[Any]:
    """Of each unit spring about the origin: x cross y, counter-clockwise positive."""
    return [x[0] * y[1] - x[1] * y[0] for x, y in zip(source, target, strict=True)]


def exact_sums(polygon: Polygon) -> tuple[Any, ...]:
    """What force, torque and energy depend on, at every theta: SymPy polynomials in u and v.

    cos = (u^2 - v^2) / (u^2 + v^2) and sin = 2 u v / (u^2 + v^2) reach every angle; multiplied by
    the denominator these are the two sums of the turned corners, the sum of the torques, and the
    sum of the products x . y, on which V_p depends. An equilibrium for every theta: all zero.
    """
    sympy = library("sympy", "the counterexample of the polygons")
    u, v = sympy.symbols("u v", real=True)
    target = polygon.points(sympy.sqrt(3))
    source = flipped(polygon, target, u**2 - v**2, 2 * u * v)
    along = [x[0] * y[0] + x[1] * y[1] for x, y in zip(source, target, strict=True)]
    columns = zip(*source, strict=True)
    sums = (*map(sum, columns), sum(torques(source, target)), sum(along))
    return tuple(sympy.expand(each) for each in sums)


def turn(polygon: Polygon, damping: float, steps: int = 360) -> Turn:
    """The polygon at evenly spaced angles from 0 to a whole turn, in double precision."""
    corners = np.array(polygon.points(math.sqrt(3.0))) / 2.0
    cloud = np.column_stack([corners, np.zeros(len(corners))])
    problem = RegistrationProblem(cloud, cloud, damping=damping)
    moving = rigid_body(exact_moments(problem), damping, length_exponent=RAW_UNIT)
    particles = Particles.of(problem)
    angles = np.linspace(0.0, 2.0 * math.pi, steps + 1)
    states = [at_rest(turned_over(polygon, theta)) for theta in angles.tolist()]
    pulls = [
        torques(flipped(polygon, tuple(map(tuple, corners)), math.cos(t), math.sin(t)), corners)  # pyright: ignore[reportArgumentType]
        for t in angles.tolist()
    ]
    jacobians = [np.linalg.eigvals(moving.intrinsic_jacobian(state)) for state in states]
    return Turn(
        polygon=polygon,
        angles=angles,
        torques=2.0 * np.array(pulls),
        energies=np.array([particles.potential(state) for state in states]),
        unstable=np.array([signs(values.astype(np.complex128)).right for values in jacobians]),
    )


def turned_over(polygon: Polygon, theta: float) -> NDArray[np.float64]:
    """The rotation (3, 3) that flips the plane over and turns it by theta: always a half turn."""
    (a, b), (c, d) = polygon.flip
    cos, sin = math.cos(theta), math.sin(theta)
    return np.array(
        [
            [cos * a - sin * c, cos * b - sin * d, 0.0],
            [sin * a + cos * c, sin * b + cos * d, 0.0],
            [0.0, 0.0, -1.0],
        ]
    )
