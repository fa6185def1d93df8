"""Exact clouds of rational points: moments, energies and rates as the paper writes them.

Sums over the points in fractions, term by term from the paper's equations and not through the
moments that the product uses, so that a counterexample speaks of the paper. Classification goes
through the shipped exact arithmetic: problem, moments, classification.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import gcd, lcm
from typing import Any

import numpy as np

from certreg.geometry.so3 import dot, rotation_matrix, squared_norm
from certreg.objective.classification import Classification, classify
from certreg.objective.springs import Springs
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem

Number = int | Fraction
Vector = tuple[Any, ...]
Rows = Sequence[Sequence[Any]]


@dataclass(frozen=True, slots=True, kw_only=True)
class ExactCloud:
    """Correspondences with rational coordinates (or integers) and positive rational masses."""

    source: tuple[Vector, ...]
    target: tuple[Vector, ...]
    masses: tuple[Number, ...] | None = None  # None: all 1

    def __post_init__(self) -> None:
        for entry in (*self.weights, *(e for x in (*self.source, *self.target) for e in x)):
            if not isinstance(entry, (int, Fraction)):
                raise TypeError(f"{entry!r} is no rational number")

    @property
    def weights(self) -> tuple[Number, ...]:
        """The masses, one per point."""
        return self.masses or (1,) * len(self.source)

    @property
    def mass(self) -> Fraction:
        """M."""
        return Fraction(sum(self.weights))

    @property
    def offset(self) -> Vector:
        """The c of the start: the source's mean less the target's."""
        return subtract(self._mean(self.source), self._mean(self.target))

    @property
    def centred_source(self) -> tuple[Vector, ...]:
        """The paper's x tilde."""
        return tuple(subtract(x, self._mean(self.source)) for x in self.source)

    @property
    def centred_target(self) -> tuple[Vector, ...]:
        """The target seen from its mean, the paper's y."""
        return tuple(subtract(y, self._mean(self.target)) for y in self.target)

    @property
    def inertia(self) -> Rows:
        """J = - sum m [x]x^2."""
        total = [[Fraction(0)] * 3 for _ in range(3)]
        for m, x in zip(self.weights, self.centred_source, strict=True):
            for i in range(3):
                for j in range(3):
                    total[i][j] += m * ((dot(x, x) if i == j else 0) - x[i] * x[j])
        return total

    @property
    def classification(self) -> Classification:
        """What the shipped exact classification says, of the cloud without denominators.

        It does not change when source, target or masses are multiplied by a positive number.
        """
        cleared = [_integers(points) for points in (self.source, self.target)]
        weights = _integers([self.weights])[0]
        problem = RegistrationProblem(*map(np.array, cleared), weights=np.array(weights))
        return classify(exact_moments(problem))

    def objective(self, R: Rows, c: Vector = (0, 0, 0)) -> Fraction:
        """V_p: the sum of m |y - R x - c|^2, for any matrix R."""
        pairs = zip(self.weights, self.centred_source, self.centred_target, strict=True)
        return sum(
            (m * squared_norm(subtract(subtract(y, apply(R, x)), c)) for m, x, y in pairs),
            start=Fraction(0),
        )

    def _mean(self, points: tuple[Vector, ...]) -> Vector:
        columns = zip(*points, strict=True)
        return tuple(Fraction(dot(self.weights, column)) / self.mass for column in columns)


@dataclass(frozen=True, slots=True, kw_only=True)
class ExactPlanes:
    """Points, the planes that hold them by a point and a normal each, in rational numbers."""

    source: tuple[Vector, ...]
    target: tuple[Vector, ...]
    normals: tuple[Vector, ...]

    def energy(self, R: Rows) -> Fraction:
        """The least sum of (n . (y - R x - t))^2 over t, by the normal equations of t.

        Raises ZeroDivisionError where a shift meets no resistance.
        """
        missed = self._missed(R, (0, 0, 0))
        stiffness = [[sum(n[i] * n[j] for n in self.normals) for j in range(3)] for i in range(3)]
        pull = tuple(
            sum(d * n[i] for d, n in zip(missed, self.normals, strict=True)) for i in range(3)
        )
        return Fraction(squared_norm(self._missed(R, solve(stiffness, pull))))

    def _missed(self, R: Rows, t: Vector) -> list[Any]:
        """The signed distances to the planes, with the normals as long as they are."""
        return [
            dot(n, subtract(subtract(y, apply(R, x)), t))
            for x, y, n in zip(self.source, self.target, self.normals, strict=True)
        ]

    @property
    def objective(self) -> Springs:
        """What the shipped exact objective is of them."""
        source, target, normals = (
            np.array(rows, float) for rows in (self.source, self.target, self.normals)
        )
        return Springs.of(RegistrationProblem(source, target, normals=normals))


@dataclass(frozen=True, slots=True, kw_only=True)
class ExactState:
    """The paper's state: c, any matrix R, v, omega; and the damping."""

    R: Rows
    c: Vector = (0, 0, 0)
    v: Vector = (0, 0, 0)
    omega: Vector = (0, 0, 0)
    damping: Number = 2


def force(cloud: ExactCloud, state: ExactState) -> Vector:
    """The total force of the paper: sum of k (y - R x - c) - mu m (R (omega x x) + v)."""
    total: Vector = (Fraction(0),) * 3
    for m, x, y in zip(cloud.weights, cloud.centred_source, cloud.centred_target, strict=True):
        pull = subtract(subtract(y, apply(state.R, x)), state.c)
        speed = add(apply(state.R, cross(state.omega, x)), state.v)
        total = add(total, subtract(scale(2 * m, pull), scale(state.damping * m, speed)))
    return total


def torque(cloud: ExactCloud, state: ExactState) -> Vector:
    """The total torque of the paper: sum of x times k (R^T (y - c) - x) - mu m omega x x."""
    total: Vector = (Fraction(0),) * 3
    for m, x, y in zip(cloud.weights, cloud.centred_source, cloud.centred_target, strict=True):
        pull = subtract(apply(transpose(state.R), subtract(y, state.c)), x)
        body = subtract(scale(2 * m, pull), scale(state.damping * m, cross(state.omega, x)))
        total = add(total, cross(x, body))
    return total


def accelerations(cloud: ExactCloud, state: ExactState) -> tuple[Vector, Vector]:
    """The paper's a and alpha: M a = f, J alpha = tau - omega x J omega."""
    gyroscopic = cross(state.omega, apply(cloud.inertia, state.omega))
    alpha = solve(cloud.inertia, subtract(torque(cloud, state), gyroscopic))
    return scale(1 / cloud.mass, force(cloud, state)), alpha


def energy(cloud: ExactCloud, state: ExactState) -> Fraction:
    """V = M |v|^2 / 2 + omega^T J omega / 2 + V_p."""
    spin = dot(state.omega, apply(cloud.inertia, state.omega))
    kinetic = (cloud.mass * squared_norm(state.v) + spin) / 2
    return kinetic + cloud.objective(state.R, state.c)


def energy_rate(cloud: ExactCloud, state: ExactState) -> Fraction:
    """dV/dt by the chain rule along the paper's dynamics, for any matrix R."""
    rate = dot(state.v, force(cloud, state)) + dot(state.omega, torque(cloud, state))
    for m, x, y in zip(cloud.weights, cloud.centred_source, cloud.centred_target, strict=True):
        gap = subtract(subtract(y, apply(state.R, x)), state.c)
        speed = add(apply(state.R, cross(state.omega, x)), state.v)
        rate -= 2 * m * dot(gap, speed)
    return Fraction(rate)


def euler_from(cloud: ExactCloud, state: ExactState, step: Fraction) -> ExactState:
    """One step of explicit Euler where omega = 0, so that R stays and no projection is needed."""
    if any(state.omega):
        raise ValueError("turning: the step would leave the rotations, and the fractions")
    a, alpha = accelerations(cloud, state)
    return ExactState(
        R=state.R,
        c=add(state.c, scale(step, state.v)),
        v=add(state.v, scale(step, a)),
        omega=scale(step, alpha),
        damping=state.damping,
    )


def rotation_of(q: Sequence[int]) -> Rows:
    """R(q) of an integer quaternion, in fractions."""
    norm = squared_norm(q)
    return [[Fraction(entry, norm) for entry in row] for row in rotation_matrix(q)]


def rank(rows: Rows) -> int:
    """The rank of a rational matrix, by elimination in fractions."""
    left = [[Fraction(entry) for entry in row] for row in rows]
    found = 0
    for column in range(len(rows[0])):
        pivot = next((row for row in left if row[column]), None)
        if pivot is None:
            continue
        left.remove(pivot)
        found += 1
        for row in left:
            factor = row[column] / pivot[column]
            if factor:
                row[:] = [a - factor * b for a, b in zip(row, pivot, strict=True)]
    return found


def solve(A: Rows, b: Vector) -> Vector:
    """The x with A x = b for a 3x3 matrix, by Cramer's rule; ZeroDivisionError if A is singular."""
    columns = transpose(A)
    whole = _determinant(columns)
    replaced = [[*columns[:k], b, *columns[k + 1 :]] for k in range(3)]
    return tuple(Fraction(_determinant(block)) / whole for block in replaced)


def add(a: Vector, b: Vector) -> Vector:
    """The sum a + b."""
    return tuple(x + y for x, y in zip(a, b, strict=True))


def subtract(a: Vector, b: Vector) -> Vector:
    """The difference a - b."""
    return tuple(x - y for x, y in zip(a, b, strict=True))


def scale(factor: Number, a: Vector) -> Vector:
    """The vector times a number."""
    return tuple(factor * x for x in a)


def cross(a: Vector, b: Vector) -> Vector:
    """The cross product of a and b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def apply(A: Rows, x: Vector) -> Vector:
    """The product A x."""
    return tuple(dot(row, x) for row in A)


def transpose(A: Rows) -> list[Vector]:
    """The columns as rows."""
    return list(zip(*A, strict=True))


def _determinant(A: Rows) -> Any:
    return dot(A[0], cross(tuple(A[1]), tuple(A[2])))


def _integers(rows: Rows) -> list[list[int]]:
    """The entries times their common denominator, as integers that doubles hold."""
    common = lcm(*(Fraction(entry).denominator for row in rows for entry in row))
    cleared = [[int(entry * common) for entry in row] for row in rows]
    if any(abs(entry) >> 53 for row in cleared for entry in row):
        raise ValueError("a coordinate that no double holds")
    return cleared


def rank_modulo(rows: Sequence[Sequence[int]], modulus: int) -> int:
    """As many rows as elimination finds pivots for that have an inverse modulo the modulus.

    For a prime that is the rank modulo it; for any number the rank over Q is at least as large.
    """
    left = [{k: e % modulus for k, e in enumerate(row) if e % modulus} for row in rows]
    found = 0
    while left:
        row = left.pop()
        column = next((k for k, e in row.items() if gcd(e, modulus) == 1), None)
        if column is None:
            continue
        found, inverse = found + 1, pow(row[column], -1, modulus)
        for other in left:
            factor = other.get(column, 0) * inverse % modulus
            for k, e in row.items() if factor else ():
                value = (other.get(k, 0) - factor * e) % modulus
                other.pop(k, None)
                if value:
                    other[k] = value
        left.sort(key=len, reverse=True)
    return found
