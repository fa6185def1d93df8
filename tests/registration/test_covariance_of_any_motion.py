"""One covariance for springs of every kind and every motion, beside one in eighty digits.

The reference shares no code with it: the sum over the points as the motion changes the pose, its
second derivatives by differences of steps so small that nothing of them is seen in a double.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations_with_replacement
from typing import Any

import mpmath
import numpy as np
import pytest
from strategies import random_rotation

from certreg.geometry.so3 import rotation_matrix, squared_norm
from certreg.objective.isotropic import Isotropic
from certreg.problem.problem import RegistrationProblem
from certreg.registration.certification import certify
from certreg.registration.covariance import pose_covariance

DIGITS, STEP = 80, mpmath.mpf(10) ** -25  # of which a difference of second order leaves thirty
SIDES = ((0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2))
MOTIONS = [
    {},
    {"rotation_only": True},
    {"scale": "asymmetric"},
    {"scale": "asymmetric", "rotation_only": True},
]


def clouds(seed: int, n: int = 7, offset: float = 3.0) -> Any:
    rng = np.random.default_rng(seed)
    source = rng.normal(size=(n, 3)) * [3.0, 1.0, 0.3] + offset
    target = source @ random_rotation(rng).T + 0.05 * rng.normal(size=(n, 3))
    return source, target, rng


def factors(kind: str, rng: Any, n: int = 7) -> Any:
    """L of W = L L^T, of one, two or three columns."""
    rows = rng.normal(size=(n, 6))
    columns = np.array([column for _, column in SIDES])
    rows[:, columns >= {"planes": 1, "lines": 2, "covariances": 3}[kind]] = 0.0
    return rows


def covariance_by_differences(problem: Any, lower: Any, place: Any) -> Any:
    """The inverse of half the second derivatives in (dt, phi) and a free scale."""
    q, shift, scale = place
    norm = squared_norm(q)
    turn = mpmath.matrix([[_real(Fraction(e, norm)) for e in row] for row in rotation_matrix(q)])
    shift, scale = mpmath.matrix([_real(entry) for entry in shift]), _real(scale)
    points = [
        (mpmath.matrix(x), mpmath.matrix(y), mpmath.matrix(rows))
        for x, y, rows in zip(problem.source.tolist(), problem.target.tolist(), lower, strict=True)
    ]

    def energy(move: list[Any]) -> Any:
        at, moved = shift + mpmath.matrix(move[:3]), turn * mpmath.expm(_cross(move[3:6]))
        pulled = (L.T * (y - (scale + move[6]) * (moved * x) - at) for x, y, L in points)
        return mpmath.fsum(entry**2 for column in pulled for entry in column)

    free = [k for k in range(7) if not (problem.rotation_only and k < 3)]
    free = free if problem.scaled else free[:-1]
    half = mpmath.matrix(len(free))
    for (i, a), (j, b) in combinations_with_replacement(enumerate(free), 2):
        total = mpmath.mpf(0)
        for u, v in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
            move = [mpmath.mpf(0)] * 7
            move[a] += u * STEP
            move[b] += v * STEP
            total += u * v * energy(move)
        half[i, j] = half[j, i] = total / (8 * STEP**2)
    inverse, found = half**-1, np.zeros((7, 7))
    for i, a in enumerate(free):
        for j, b in enumerate(free):
            found[a, b] = float(inverse[i, j])
    return found if problem.scaled else found[:6, :6]


def _real(value: Fraction) -> Any:
    return mpmath.mpf(value.numerator) / value.denominator


def _cross(v: list[Any]) -> Any:
    x, y, z = v
    return mpmath.matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def is_near(found: Any, right: Any) -> bool:
    return bool(np.abs(np.array(found) - right).max() <= 1e-12 * np.abs(right).max())


@pytest.mark.slow
@pytest.mark.parametrize("motion", MOTIONS, ids=lambda motion: "-".join(motion) or "pose")
def test_of_one_weight_per_pair_it_is_that_of_the_sum_over_the_points(motion: Any):
    source, target, rng = clouds(1)
    sigma = rng.uniform(0.01, 0.05, size=len(source))
    problem = RegistrationProblem(source, target, sigma=sigma, **motion)
    objective = Isotropic.of(problem)
    q = objective.optimum
    place = q, objective.best_translation(q), objective.best_scale(q)
    with mpmath.workdps(DIGITS):
        roots = map(mpmath.sqrt, problem.weights.tolist())
        right = covariance_by_differences(problem, [r * mpmath.eye(3) for r in roots], place)

    agrees(pose_covariance(problem, objective), right)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["planes", "lines", "covariances"])
def test_on_springs_it_is_that_of_the_sum_over_the_points(kind: str):
    source, target, rng = clouds(2)
    lower = factors(kind, rng)
    found: Any = certify(RegistrationProblem(source, target, factors=lower), simulation=False)
    q = found.solution.quaternion
    place = q, found.solution.objective.best_translation(q), Fraction(1)
    with mpmath.workdps(DIGITS):
        triangles = [mpmath.matrix(3, 3) for _ in lower]
        for triangle, entries in zip(triangles, lower.tolist(), strict=True):
            for side, entry in zip(SIDES, entries, strict=True):
                triangle[side] = entry
        right = covariance_by_differences(found.problem, triangles, place)

    estimated = found.covariance
    assert estimated.estimated
    agrees(estimated, right * estimated.variance_factor)


def agrees(found: Any, right: Any) -> None:
    told = [*found.translation_sigma, *found.rotation_sigma]
    levels, axes = np.linalg.eigh(right[3:6, 3:6])

    assert is_near(found.matrix, right)
    assert np.square(told) == pytest.approx(np.diag(right)[:6], rel=1e-13)
    assert found.loosest_sigma == pytest.approx(np.sqrt(levels[-1]), rel=1e-12)
    assert abs(found.loosest_axis @ axes[:, -1]) == pytest.approx(1.0, abs=1e-12)


def test_the_reference_sees_a_change_of_a_part_in_ten_to_the_twelfth():
    right, one = np.diag([4.0, 1.0]), np.eye(2)

    assert is_near(right + 3e-12 * one, right)
    assert not is_near(right + 5e-12 * one[::-1], right)
