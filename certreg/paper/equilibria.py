"""The paper's first experiment: all equilibria of random instances, and their eigenvalues.

The paper solves the torque quadratics in Matlab; here they are eliminated exactly (the Groebner
method), which knows nothing of eigenvectors. Eigenvalues are those of the Jacobians, computed in
double precision and counted; nothing is taken from the theorems that they are held against.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from certreg.dynamics.rigid import rigid_body
from certreg.equilibrium.equilibrium_set import rotation_double, unit_double
from certreg.equilibrium.methods import FINDERS
from certreg.geometry.so3 import rotation_matrix
from certreg.objective.isotropic import Isotropic
from certreg.paper.particles import RAW_UNIT, Particles, at_rest
from certreg.problem.moments import exact_moments
from certreg.registration.closed_form import horn

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.dynamics.rigid import RigidBody
    from certreg.problem.problem import RegistrationProblem


ZERO_EIGENVALUE = 1e-9  # of the largest: a computed zero is below, a true one far above


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Signs:
    """How many eigenvalues lie right of the imaginary axis, at zero, and left of it."""

    right: int
    zero: int
    left: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StationaryPose:
    """One equilibrium. Angles in degrees, to the closed-form optimum.

    quaternion: (4,); rotation: (3, 3). balance: what the paper's equation leaves, relative.
    intrinsic: (12,) and ambient: (18,), complex: eigenvalues of the Jacobians in the 12 dimensions
    of the motion and in the 18 numbers of the paper. angle: from the quaternions, half_turn_error:
    180 less that, without cancellation. arccos_angle: by the paper's formula.
    """

    quaternion: NDArray[np.float64]
    rotation: NDArray[np.float64]
    balance: float
    intrinsic: NDArray[np.complex128]
    ambient: NDArray[np.complex128]
    angle: float
    half_turn_error: float
    arccos_angle: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EquilibriumRun:
    """All equilibria of one instance, the lowest energy first; None for infinitely many.

    unique: whether the optimum is, decided exactly. pair_errors: for every two equilibria 180 less
    their angle, degrees. least_inertia: the least eigenvalue of J over the largest.
    """

    count: int | None
    unique: bool
    poses: tuple[StationaryPose, ...]
    pair_errors: tuple[float, ...]
    least_inertia: float


def equilibrium_run(problem: RegistrationProblem) -> EquilibriumRun:
    """The experiment on one instance.

    Where the equilibria form a continuum, `poses` has one member of each component.
    Raises DegenerateProblemError where the source is collinear.
    """
    moments = exact_moments(problem)
    moving = rigid_body(moments, problem.damping, length_exponent=RAW_UNIT)
    particles = Particles.of(problem)
    objective = Isotropic(moments)
    critical = FINDERS[objective.structure]["groebner"].method(objective)
    shape = objective.classified(critical.pattern)
    best = horn(moving.cross_covariance)
    poses = tuple(
        _stationary_pose(part.quaternion, moving, particles, best) for part in critical.components
    )
    inertia = np.linalg.eigvalsh(moving.inertia)
    return EquilibriumRun(
        count=len(poses) if shape.finite else None,
        unique=shape.unique,
        poses=poses,
        pair_errors=tuple(
            half_turn_error(a.quaternion, b.quaternion) for a, b in combinations(poses, 2)
        ),
        least_inertia=float(inertia[0] / inertia[-1]),
    )


def sides(eigenvalues: NDArray[np.complex128]) -> NDArray[np.int64]:
    """1 for each eigenvalue right of the imaginary axis, -1 left, 0 for what rounding made of 0."""
    zero = np.abs(eigenvalues) <= ZERO_EIGENVALUE * np.abs(eigenvalues).max()
    return np.where(zero, 0, np.sign(eigenvalues.real)).astype(np.int64)


def signs(eigenvalues: NDArray[np.complex128]) -> Signs:
    """The eigenvalues counted by their real parts."""
    each = sides(eigenvalues).tolist()
    return Signs(right=each.count(1), zero=each.count(0), left=each.count(-1))


def unstable_counts(run: EquilibriumRun) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """How many eigenvalues of each equilibrium are unstable: of the 12, and of the 18."""
    intrinsic = tuple(signs(pose.intrinsic).right for pose in run.poses)
    return intrinsic, tuple(signs(pose.ambient).right for pose in run.poses)


def angle(p: NDArray[np.float64], q: NDArray[np.float64]) -> float:
    """The angle in degrees between R(p) and R(q) of unit quaternions, accurate at 0 and at 180."""
    return math.degrees(2.0 * math.atan2(_across(p, q), abs(float(p @ q))))


def half_turn_error(p: NDArray[np.float64], q: NDArray[np.float64]) -> float:
    """180 less the angle in degrees between R(p) and R(q), to full precision near zero."""
    return math.degrees(2.0 * math.atan2(abs(float(p @ q)), _across(p, q)))


def arccos_angle(R: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """The paper's |arccos((tr(R^T R') - 1) / 2)| in degrees.

    Rounding can put the argument outside [-1, 1], where Matlab's arccos, as this one, is complex;
    the absolute value hides that. Near 0 and 180 degrees only half of the digits are right.
    """
    argument = (np.trace(R.T @ other) - 1.0) / 2.0
    return math.degrees(abs(np.arccos(complex(argument))))


def _across(p: NDArray[np.float64], q: NDArray[np.float64]) -> float:
    """The norm of the part of q that is orthogonal to p."""
    return float(np.linalg.norm(np.outer(p, q) - np.outer(q, p)) / math.sqrt(2.0))


def _stationary_pose(
    integers: tuple[int, int, int, int],
    moving: RigidBody,
    particles: Particles,
    best: NDArray[np.float64],
) -> StationaryPose:
    quaternion, rotation = unit_double(integers), rotation_double(integers)
    state = at_rest(rotation)
    return StationaryPose(
        quaternion=quaternion,
        rotation=rotation,
        balance=particles.balance(rotation),
        intrinsic=np.linalg.eigvals(moving.intrinsic_jacobian(state)).astype(np.complex128),
        ambient=np.linalg.eigvals(moving.ambient_jacobian(state)).astype(np.complex128),
        angle=angle(quaternion, best),
        half_turn_error=half_turn_error(quaternion, best),
        arccos_angle=arccos_angle(rotation, np.array(rotation_matrix(best.tolist()))),
    )
