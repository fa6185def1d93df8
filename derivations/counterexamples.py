"""Exact counterexamples to claims of the paper that are false, or true under a condition only.

Each is a few rational points and a computation on them in integers and fractions, with the values
that it must give: a change of the points that matters is refused.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

import sympy

from certreg.geometry.so3 import dot, squared_norm
from certreg.results import Verdict

from .algebra import facts
from .linearisation import ambient_jacobian
from .motion import DAMPING, Body, State
from .rationals import (
    ExactCloud,
    ExactState,
    Rows,
    Vector,
    accelerations,
    apply,
    energy,
    energy_rate,
    euler_from,
    force,
    rank,
    rotation_of,
    scale,
    subtract,
    torque,
)

IDENTITY: Rows = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
STEP = Fraction(1, 100)  # the paper's time step, in seconds
STOP = Fraction(1, 10**4)  # the paper stops where the norm of the rates is below


@dataclass(frozen=True, slots=True, kw_only=True)
class Counterexample:
    """Clouds, what is computed of them exactly, and the values that refute the claim."""

    words: str
    clouds: tuple[Any, ...]  # ExactCloud, or ExactPlanes
    found: Callable[..., Sequence[Any]]
    expected: tuple[Any, ...]

    def recheck(self) -> Verdict:
        """PROVED if the computation gives the values told, REFUTED otherwise."""
        try:
            found = self.found(*self.clouds)
        except (ArithmeticError, ValueError) as error:
            found = [f"{type(error).__name__}: {error}", *self.expected[1:]]
        return facts(self.words, found, self.expected).verdict


def mirrored(points: tuple[Vector, ...]) -> tuple[Vector, ...]:
    """The points through the origin."""
    return tuple(scale(-1, point) for point in points)


def turned(points: tuple[Vector, ...], q: Sequence[int]) -> tuple[Vector, ...]:
    """The points turned by R(q)."""
    return tuple(apply(rotation_of(q), point) for point in points)


def box(a: int, b: int, c: int) -> tuple[Vector, ...]:
    """The eight corners (+-a, +-b, +-c)."""
    return tuple((x, y, z) for x in (a, -a) for y in (b, -b) for z in (c, -c))


OCTAHEDRON = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
ELLIPSOID = ((1, 0, 0), (-1, 0, 0), (0, 2, 0), (0, -2, 0), (0, 0, 3), (0, 0, -3))
TETRAHEDRON = ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))
ELONGATED = ((1, 1, 2), (1, -1, -2), (-1, 1, -2), (-1, -1, 2))
RECTANGLE = ((2, 1, 0), (2, -1, 0), (-2, -1, 0), (-2, 1, 0))
SQUARE = ((1, 1, 0), (1, -1, 0), (-1, -1, 0), (-1, 1, 0))
TWO_TETRAHEDRA = tuple(scale(10, x) for x in TETRAHEDRON) + tuple(
    scale(30, x) for x in turned(TETRAHEDRON, (1, 2, 3, 4))
)


def _off_the_rotations(cloud: ExactCloud) -> list[Any]:
    """dV/dt at a shear for R, the paper's formula for it, and which sign the former has."""
    state = ExactState(R=((1, 1, 0), (0, 1, 0), (0, 0, 1)), omega=(0, 0, Fraction(-1, 10)))
    rate = energy_rate(cloud, state)
    told = -state.damping * dot(state.omega, apply(cloud.inertia, state.omega))
    return [rate, told, rate > 0]


def _flat(cloud: ExactCloud) -> list[Any]:
    """The energy far out in the space of matrices, at R + k e1 e3^T, is that at R."""
    solid = cloud.classification.inertia_definite
    far = ((1, 0, 10**9), (0, 1, 0), (0, 0, 1))
    moved = [subtract(apply(far, x), x) for x in cloud.centred_source]
    return [solid, any(map(any, moved)), cloud.objective(far) - cloud.objective(IDENTITY)]


def _two_optima(cloud: ExactCloud) -> list[Any]:
    """J > 0, uniqueness, and V_p at the half turns about the first two axes."""
    shape = cloud.classification
    energies = [cloud.objective(rotation_of(q)) for q in ((0, 1, 0, 0), (0, 0, 1, 0))]
    return [shape.inertia_definite, shape.unique, *energies, cloud.objective(IDENTITY)]


def _spurious(*clouds: ExactCloud) -> list[Any]:
    """The number of spurious equilibria, None for infinitely many, with J > 0."""
    shapes = [cloud.classification for cloud in clouds]
    return [all(s.inertia_definite for s in shapes), *(s.spurious for s in shapes)]


def _symmetric(*clouds: ExactCloud) -> list[Any]:
    """For each: how many permutations keep all distances, and the spurious equilibria."""
    counts = [n for c in clouds for n in (symmetries(c), c.classification.spurious)]
    return [all(c.classification.inertia_definite for c in clouds), *counts]


def symmetries(cloud: ExactCloud) -> int:
    """The number of permutations of the source points that an isometry effects, weights kept.

    An isometry keeps the mean, so points go to points at the same distance from it.
    """
    points = cloud.centred_source
    marks = [(squared_norm(x), m) for x, m in zip(points, cloud.weights, strict=True)]
    partial: list[tuple[int, ...]] = [()]  # images of the first points
    for i in range(len(points)):
        candidates = [j for j in range(len(points)) if marks[j] == marks[i]]
        partial = [
            (*image, j)
            for image in partial
            for j in candidates
            if j not in image and _keeps(points, i, (*image, j))
        ]
    return len(partial)


def _keeps(points: tuple[Vector, ...], last: int, image: tuple[int, ...]) -> bool:
    """Whether a map of the first points keeps the distances to the last of them."""
    return all(
        squared_norm(subtract(points[last], points[i]))
        == squared_norm(subtract(points[image[last]], points[image[i]]))
        for i in range(last)
    )


def _pulled_back(cloud: ExactCloud) -> list[Any]:
    """At R = I, turned out of the plane from the rest at R_e: the torque; V_p there, at R_e, best.

    R_e = R(100, 0, -1, 0), from which the turn to R = I is one about the second axis, forwards.
    """
    resting, start = rotation_of((100, 0, -1, 0)), ExactState(R=IDENTITY)
    moved = [subtract(x, apply(resting, x)) for x in cloud.centred_source]
    energies = [cloud.objective(R) for R in (IDENTITY, resting, rotation_of((0, 100, 0, 1)))]
    balanced = not any(torque(cloud, ExactState(R=resting)))
    return [balanced, all(step[2] for step in moved), *torque(cloud, start), *energies]


def _zero_eigenvalues(cloud: ExactCloud) -> list[Any]:
    """At R = I, v = omega = 0: force, torque, uniqueness, rank of the ambient 18x18 Jacobian."""
    state = ExactState(R=IDENTITY)
    inertia = sympy.Matrix(cloud.inertia) / cloud.mass
    pairs = zip(cloud.weights, cloud.centred_target, cloud.centred_source, strict=True)
    C = [[Fraction(0)] * 3 for _ in range(3)]
    for m, y, x in pairs:
        C = [[C[i][j] + m * y[i] * x[j] / cloud.mass for j in range(3)] for i in range(3)]
    zero = sympy.zeros(3, 1)
    body = Body(cross=sympy.Matrix(C), inertia=inertia, inertia_inverse=inertia.inv())
    at_rest = State(c=zero, R=sympy.eye(3), v=zero, omega=zero)
    jacobian = ambient_jacobian(at_rest, body).subs(DAMPING, 2).tolist()
    rows = [[Fraction(int(e.p), int(e.q)) for e in row] for row in jacobian]
    resting = not any((*force(cloud, state), *torque(cloud, state)))
    shape = cloud.classification
    return [resting, cloud.objective(IDENTITY), shape.unique, len(rows), rank(rows)]


def _first_step(cloud: ExactCloud) -> list[Any]:
    """What the first explicit step from rest does to V, and h^2/2 (M |a|^2 + alpha^T J alpha)."""
    start = ExactState(R=IDENTITY, c=cloud.offset)
    a, alpha = accelerations(cloud, start)
    rise = energy(cloud, euler_from(cloud, start, STEP)) - energy(cloud, start)
    told = STEP**2 / 2 * (cloud.mass * squared_norm(a) + dot(alpha, apply(cloud.inertia, alpha)))
    return [rise, rise == told, rise > 0]


def _resting(cloud: ExactCloud) -> list[Any]:
    """The paper's start, R = I at rest: force, torque, V_p; and V_p half a turn away."""
    start = ExactState(R=IDENTITY, c=cloud.offset)
    energies = [cloud.objective(IDENTITY), cloud.objective(rotation_of((0, 1, 0, 0)))]
    return [*force(cloud, start), *torque(cloud, start), *energies]


def _spiral(cloud: ExactCloud) -> list[Any]:
    """By what |v|^2 + mu c.v + 2 |c|^2, positive, is multiplied in each of three Euler steps."""
    state = ExactState(R=IDENTITY, c=cloud.offset, damping=Fraction(1, 200))
    sizes = [_size(state)]
    for _ in range(3):
        state = euler_from(cloud, state, STEP)
        sizes.append(_size(state))
    ratios = [after / before for before, after in pairwise(sizes)]
    return [state.damping**2 < 8, sizes[0], *ratios]


def _size(state: ExactState) -> Fraction:
    form = squared_norm(state.v) + state.damping * dot(state.c, state.v)
    return Fraction(form + 2 * squared_norm(state.c))


def _stopped(cloud: ExactCloud) -> list[Any]:
    """At the paper's start: the rates' squared norm against the stop, V_p here and at the best."""
    start = ExactState(R=IDENTITY, c=cloud.offset)
    a, alpha = accelerations(cloud, start)
    rates = squared_norm(a) + squared_norm(alpha)
    best = cloud.objective(rotation_of((1, 2**20, 0, 0)))
    return [0 < rates < STOP**2, best, cloud.objective(IDENTITY) > 103, cloud.classification.unique]


def _still(points: tuple[Vector, ...]) -> ExactCloud:
    return ExactCloud(source=points, target=points)


OFF_THE_ROTATIONS = Counterexample(
    words="the octahedron (±1,0,0), (0,±2,0), (0,0,±3) onto itself, R the shear that adds y to x, "
    "ω = (0, 0, −1/10), μ = 2: the energy rises at the rate 1, the formula says −1/5",
    clouds=(_still(ELLIPSOID),),
    found=_off_the_rotations,
    expected=(Fraction(1), Fraction(-1, 5), True),
)
FLAT = Counterexample(
    words="the rectangle (±2, ±1, 0): R + k e₁e₃ᵀ has the same energy for every k, as it moves no "
    "point of the plane",
    clouds=(_still(RECTANGLE),),
    found=_flat,
    expected=(True, False, 0),
)
TWO_OPTIMA = Counterexample(
    words="the regular tetrahedron onto its mirror image −x: J ≻ 0, but the half turns about the "
    "coordinate axes (and a whole projective plane of rotations) have the least energy, 16; the "
    "identity has 48",
    clouds=(ExactCloud(source=TETRAHEDRON, target=mirrored(TETRAHEDRON)),),
    found=_two_optima,
    expected=(True, False, 16, 16, 48),
)
FEWER_THAN_THREE = Counterexample(
    words="the regular tetrahedron onto its mirror image: exactly 1 spurious; the tetrahedron "
    "(±1,±1,±2) onto its mirror image: exactly 2; the regular octahedron whose opposite corners "
    "share a target: none",
    clouds=(
        ExactCloud(source=TETRAHEDRON, target=mirrored(TETRAHEDRON)),
        ExactCloud(source=ELONGATED, target=mirrored(ELONGATED)),
        ExactCloud(source=OCTAHEDRON, target=tuple(ELLIPSOID[k - k % 2] for k in range(6))),
    ),
    found=_spurious,
    expected=(True, 1, 2, 0),
)
SYMMETRIC_BUT_FINITE = Counterexample(
    words="the rectangle (±2, ±1, 0) onto itself, 4 symmetries: exactly 3 spurious; the square "
    "onto a rectangle, 8 symmetries: 3; the box (±1, ±1, ±2) onto its mirror image, 16 symmetries: "
    "2",
    clouds=(
        _still(RECTANGLE),
        ExactCloud(source=SQUARE, target=RECTANGLE),
        ExactCloud(source=box(1, 1, 2), target=mirrored(box(1, 1, 2))),
    ),
    found=_symmetric,
    expected=(True, 4, 3, 8, 3, 16, 2),
)
INFINITE_WITHOUT_SYMMETRY = Counterexample(
    words="two regular tetrahedra about one centre, of different size and turned by the quaternion "
    "(1, 2, 3, 4) against each other: no permutation but the identity keeps the distances, and the "
    "spurious equilibria are infinitely many, as S₂ is a multiple of I",
    clouds=(_still(TWO_TETRAHEDRA),),
    found=_symmetric,
    expected=(True, 1, None),
)
PULLED_BACK = Counterexample(
    words="the square (±1, ±1, 0), flipped over: at rest with the energy 16. Turned out of the "
    "plane by 1.1 degrees, about the axis in the plane across that of the flip, every corner "
    "leaves the plane, the energy is 160032/10001, more than 16, and the torque, −1600/10001 about "
    "that axis and nothing else, turns the body back",
    clouds=(ExactCloud(source=SQUARE, target=turned(SQUARE, (0, 100, 0, 1))),),
    found=_pulled_back,
    expected=(True, True, 0, Fraction(-1600, 10001), 0, Fraction(160032, 10001), 16, 0),
)
SIX_ZEROS = Counterexample(
    words="the octahedron (±1,0,0), (0,±2,0), (0,0,±3) onto itself: at the optimum, the only one, "
    "the ambient 18×18 Jacobian has rank 12",
    clouds=(_still(ELLIPSOID),),
    found=_zero_eigenvalues,
    expected=(True, 0, True, 18, 12),
)
FIRST_STEP = Counterexample(
    words="the octahedron (±1,0,0), (0,±2,0), (0,0,±3) onto a copy turned by the quaternion "
    "(1, 2, 3, 4) and moved by (1, 0, 0): the first step of 0.01 from rest raises V",
    clouds=(
        ExactCloud(
            source=ELLIPSOID,
            target=tuple((a + 1, b, c) for a, b, c in turned(ELLIPSOID, (1, 2, 3, 4))),
        ),
    ),
    found=_first_step,
    expected=(Fraction(107141, 36562500), True, True),
)
STARTED_AT_A_SADDLE = Counterexample(
    words="the octahedron (±1,0,0), (0,±2,0), (0,0,±3) onto its half turn about the x-axis: at the "
    "paper's start, R = I at rest, force and torque vanish, so the body never moves; its energy is "
    "104, that of the optimum 0",
    clouds=(ExactCloud(source=ELLIPSOID, target=turned(ELLIPSOID, (0, 1, 0, 0))),),
    found=_resting,
    expected=(0, 0, 0, 0, 0, 0, 104, 0),
)
DIVERGING = Counterexample(
    words="the octahedron onto itself, moved by (1, 0, 0), at μ = 0.005 and the paper's step 0.01: "
    "|v|² + μ c·v + 2|c|² is multiplied by 20003/20000 in every step, so the centre spirals "
    "outwards for ever",
    clouds=(ExactCloud(source=ELLIPSOID, target=tuple((a + 1, b, c) for a, b, c in ELLIPSOID)),),
    found=_spiral,
    expected=(True, 2, *[Fraction(20003, 20000)] * 3),
)
STOPPED_AT_ONCE = Counterexample(
    words="the octahedron onto a copy turned by the quaternion (1, 2²⁰, 0, 0), half a turn but for "
    "0.00011 degrees: at the paper's start the rates have a norm below 1e-4, so the simulation "
    "stops where it is, with an energy above 103 where the only optimum has 0; so it does from all "
    "states nearby",
    clouds=(ExactCloud(source=ELLIPSOID, target=turned(ELLIPSOID, (1, 2**20, 0, 0))),),
    found=_stopped,
    expected=(True, 0, True, True),
)
