"""Everything that the experiments observe, from one seed, and the clouds that are drawn.

These are the paper's construction, its symmetric clouds, and poses of a real cloud. Triangle
and square balance flipped, at every angle: the target is a regular polygon, and the source
the same polygon turned by theta and flipped over. Each spring turns the source one way or the
other; the turns cancel whatever theta is. Exactly: with cos and sin as quadratic forms in two
numbers, all sums are polynomials, and zero.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import library
from certreg.dynamics.rigid import rigid_body
from certreg.dynamics.states import state_at_rest
from certreg.geometry.so3 import rotation_matrix
from certreg.paper.experiments import (
    EquilibriumRun,
    SimulationRun,
    equilibrium_run,
    signs,
    simulation_run,
)
from certreg.paper.particles import RAW_UNIT, Particles, parts
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem
from certreg.problem.random_instances import (
    PAPER_DAMPING,
    PAPER_POINTS,
    PAPER_SIGMA,
    Instances,
    gaussian_instances,
)
from certreg.registration.enumeration import equilibria
from certreg.registration.examples import STORIES, stated

if TYPE_CHECKING:
    from numpy.typing import NDArray


HOUSE = (
    *((-1.0, -0.7, 0.0), (1.0, -0.7, 0.0), (1.0, 0.7, 0.0), (-1.0, 0.7, 0.0)),
    *((-1.0, -0.7, 1.0), (1.0, -0.7, 1.0), (1.0, 0.7, 1.0), (-1.0, 0.7, 1.0)),
    *((-1.0, 0.0, 1.7), (1.0, 0.0, 1.7)),
)
LINKS = (
    *((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)),
    *((0, 4), (1, 5), (2, 6), (3, 7), (4, 8), (7, 8), (5, 9), (6, 9), (8, 9)),
)
TURN = (math.cos(0.4), math.sin(0.4) * 0.36, math.sin(0.4) * 0.48, math.sin(0.4) * 0.8)
SHIFT = (2.9, -0.9, 0.5)
NOISE = 0.08  # large enough to be seen
COILS, ZIGZAG = 16, 0.05  # of a drawn spring: turns, and half its width in the unit of length
HEAD = STORIES[1]
LANDMARKS = {"nose": 2, "left ear": 0, "right ear": 1}  # rows Nz, LPA, RPA of both files
EQUILIBRIUM_RUNS = 50  # [Yang2020]
SIMULATION_RUNS = 100  # [Yang2020]
StageProgress = Callable[[str, int, int], None]  # a stage, how many of its parts are done, of all
STATES = 3  # random states per instance at which equations are compared


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Scene:
    """The body at the paper's start. Lengths in the unit of the clouds.

    source, target: (N, 3); links: pairs of points that the rigid body is drawn with.
    centres: (2, 3), of the source and the target.
    """

    source: NDArray[np.float64]
    target: NDArray[np.float64]
    links: tuple[tuple[int, int], ...]
    centres: NDArray[np.float64]


def scene() -> Scene:
    """A house whose source is turned, moved and disturbed: the same picture every time."""
    house = np.array(HOUSE)
    R = np.array(rotation_matrix(TURN))
    noise = NOISE * np.random.default_rng(0).standard_normal(house.shape)
    problem = RegistrationProblem(house @ R.T + SHIFT + noise, house)
    particles = Particles.of(problem)
    return Scene(
        source=particles.source,
        target=particles.target,
        links=LINKS,
        centres=np.array([particles.centre, np.zeros(3)]),
    )


def projected(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points (N, 3) as seen from the front right and above, without perspective, (N, 2)."""
    across, up = math.radians(-28.0), math.radians(20.0)
    x = math.cos(across) * points[:, 0] + math.sin(across) * points[:, 1]
    away = -math.sin(across) * points[:, 0] + math.cos(across) * points[:, 1]
    return np.column_stack([x, math.cos(up) * points[:, 2] + math.sin(up) * away])


def coil(start: NDArray[np.float64], end: NDArray[np.float64]) -> NDArray[np.float64]:
    """A spring from one point of the plane to another as a zigzag line, (k, 2)."""
    along = end - start
    across = np.array([-along[1], along[0]]) / (np.linalg.norm(along) or 1.0)
    places = np.concatenate([[0.0], np.linspace(0.15, 0.85, 2 * COILS + 1), [1.0]])
    sides = np.concatenate([[0.0, 0.0], np.resize([1.0, -1.0], 2 * COILS - 1), [0.0, 0.0]])
    return start + np.outer(places, along) + ZIGZAG * np.outer(sides, across)


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
    unstable: (L,), eigenvalues with positive real part.
    """

    polygon: Polygon
    angles: NDArray[np.float64]
    torques: NDArray[np.float64]
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
    angles = np.linspace(0.0, 2.0 * math.pi, steps + 1)
    states = [state_at_rest(turned_over(polygon, theta)) for theta in angles.tolist()]
    pulls = [
        torques(flipped(polygon, tuple(map(tuple, corners)), math.cos(t), math.sin(t)), corners)  # pyright: ignore[reportArgumentType]
        for t in angles.tolist()
    ]
    jacobians = [np.linalg.eigvals(moving.intrinsic_jacobian(state)) for state in states]
    return Turn(
        polygon=polygon,
        angles=angles,
        torques=2.0 * np.array(pulls),
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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Posed:
    """The source at one equilibrium, both clouds with the target's centre as the origin.

    points: (N, 3), moved; index: how many independent turns lower the energy; rmse: in mm; angle:
    degrees to the optimum.
    """

    points: NDArray[np.float64]
    index: int
    rmse: float
    angle: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Gallery:
    """The target, (N, 3) in mm about its centre, and the source at each equilibrium."""

    target: NDArray[np.float64]
    poses: tuple[Posed, ...]


def gallery() -> Gallery:
    """The packaged electrodes on two heads, at all of their equilibria."""
    problem = stated(HEAD)
    particles = Particles.of(problem)
    return Gallery(
        target=particles.target,
        poses=tuple(
            Posed(
                points=particles.arms @ each.rotation.T,
                index=each.morse_index,
                rmse=each.rmse or 0.0,
                angle=float(np.degrees(each.angle_to_optimum)),
            )
            for each in equilibria(problem).components
        ),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Setup:
    """What the instances are made of. N and mu are not stated in the paper.

    runs: of either experiment; None: as many as in the paper.
    """

    points: int = PAPER_POINTS
    noise: float = PAPER_SIGMA
    damping: float = PAPER_DAMPING
    seed: int = 0
    runs: int | None = None

    @property
    def equilibrium_runs(self) -> int:
        """Instances whose equilibria are found."""
        return EQUILIBRIUM_RUNS if self.runs is None else self.runs

    @property
    def simulation_runs(self) -> int:
        """Instances that are simulated."""
        return SIMULATION_RUNS if self.runs is None else self.runs

    def problem(self, instances: Instances, index: int) -> RegistrationProblem:
        """One of the instances made, in the paper's units."""
        return RegistrationProblem(
            instances.sources[index],
            instances.targets[index],
            sigma=self.noise if self.noise > 0.0 else None,
            damping=self.damping,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class FormulaComparison:
    """The largest relative differences over the states compared.

    objective: of V_p to the maximum-likelihood objective at t = c - R x_mean. rate: of F(s), from
    the derivation, to the Newton-Euler equations summed over the particles. dissipation: of dV/dt
    along F to -mu M |v|^2 - mu omega^T J omega.
    """

    objective: float
    rate: float
    dissipation: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Observations:
    """What was observed. balance_sums: of each polygon, polynomials that vanish if it balances."""

    setup: Setup
    comparisons: tuple[FormulaComparison, ...]
    equilibria: tuple[EquilibriumRun, ...]
    simulations: tuple[SimulationRun, ...]
    turns: tuple[Turn, ...]
    balance_sums: tuple[tuple[Any, ...], ...]
    scene: Scene
    gallery: Gallery


def observe(setup: Setup, progress: StageProgress) -> Observations:
    """Every experiment. Raises InvalidProblemError for a setup that makes no instances."""
    seeds = np.random.SeedSequence(setup.seed).spawn(3)
    finding, moving, comparing = map(np.random.default_rng, seeds)
    first = _made(setup, finding, setup.equilibrium_runs)
    second = _made(setup, moving, setup.simulation_runs)
    polygons = (TRIANGLE, SQUARE)

    def at(index: int) -> tuple[FormulaComparison, EquilibriumRun]:
        problem = setup.problem(first, index)
        return compare(problem, comparing, STATES), equilibrium_run(problem)

    def simulated(index: int) -> SimulationRun:
        return simulation_run(setup.problem(second, index), second.rotations[index])

    pairs = list(each_of(at, len(first.rotations), "equilibria", progress))
    return Observations(
        setup=setup,
        comparisons=tuple(comparison for comparison, _ in pairs),
        equilibria=tuple(run for _, run in pairs),
        simulations=tuple(each_of(simulated, len(second.rotations), "simulations", progress)),
        turns=tuple(turn(polygon, setup.damping) for polygon in polygons),
        balance_sums=tuple(exact_sums(polygon) for polygon in polygons),
        scene=scene(),
        gallery=gallery(),
    )


def _made(setup: Setup, rng: np.random.Generator, count: int) -> Instances:
    return gaussian_instances(rng, points=setup.points, sigma=setup.noise, count=count)


def each_of(
    observation: Callable[[int], Any], count: int, stage: str, progress: StageProgress
) -> Iterator[Any]:
    """What is observed at each of so many places, told of as a stage."""
    for index in range(count):
        progress(stage, index, count)
        yield observation(index)
    progress(stage, count, count)


def compare(
    problem: RegistrationProblem, rng: np.random.Generator, states: int
) -> FormulaComparison:
    """The comparison at random states whose R is a rotation."""
    moving = rigid_body(exact_moments(problem), problem.damping, length_exponent=RAW_UNIT)
    particles = Particles.of(problem)
    drawn = [_random_state(rng) for _ in range(states)]
    objectives = [_likelihood(particles, state) for state in drawn]
    potentials = [particles.mass * float(moving.energies(state)["potential"]) for state in drawn]
    printed, derived = [particles.rate(s) for s in drawn], [moving.rate(s) for s in drawn]
    claimed = [particles.dissipation(s) for s in drawn]
    computed = [particles.energy_rate(s) for s in drawn]
    return FormulaComparison(
        objective=_difference(potentials, objectives),
        rate=_difference(derived, printed),
        dissipation=_difference(computed, claimed),
    )


def _likelihood(particles: Particles, state: NDArray[np.float64]) -> float:
    """The sum of |y - R x - t|^2 / sigma^2 at the pose of a state."""
    c, R, _, _ = parts(state)
    t = c - R @ particles.centre
    residuals = particles.target - particles.source @ R.T - t
    return float(particles.masses @ (residuals**2).sum(axis=1))


def _difference(
    computed: list[float] | list[NDArray[np.float64]],
    claimed: list[float] | list[NDArray[np.float64]],
) -> float:
    pairs = zip(map(np.atleast_1d, computed), map(np.atleast_1d, claimed), strict=True)
    return max(float(np.linalg.norm(a - b) / np.linalg.norm(b)) for a, b in pairs)


def _random_state(rng: np.random.Generator) -> NDArray[np.float64]:
    q = rng.standard_normal(4)
    R = np.array(rotation_matrix((q / np.linalg.norm(q)).tolist()))
    c, v, omega = rng.standard_normal((3, 3))
    return np.concatenate([c, R.ravel(), v, omega])
