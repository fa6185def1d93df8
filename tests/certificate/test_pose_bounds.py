"""What is proved of a pose, on either side of every limit; bounds beside exact values."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from certreg.certificate.bounds import (
    ExactPose,
    PoseBounds,
    angle_from,
    flat_energy,
    pose_bounds,
    pose_energy,
    sin2_half_angle_between,
    spring_energy,
)
from certreg.certificate.isotropic import produce
from certreg.geometry.so3 import rotation_matrix, squared_norm
from certreg.objective.isotropic import Isotropic
from certreg.objective.springs import Springs
from certreg.problem.moments import exact_moments
from certreg.problem.motion import Scale
from certreg.problem.problem import RegistrationProblem
from certreg.results import Limits

LITTLE = Fraction(1, 10**30)  # far below the spacing of the doubles
LIMITS = Limits(max_gap=0.125, max_angle=0.5)
BOUNDS = PoseBounds(
    least_gap=Fraction(1, 10),
    greatest_gap=Fraction(3, 8),
    angle_upper=0.5,
    least_range_squared=Fraction(9),
    flat_energy=Fraction(7),
)


def test_bounds_meet_limits_up_to_equality():
    assert BOUNDS.meet(LIMITS, unique=True)
    assert not replace(BOUNDS, greatest_gap=Fraction(3, 8) + LITTLE).meet(LIMITS, unique=False)
    assert replace(BOUNDS, greatest_gap=Fraction(3, 8) - LITTLE).meet(LIMITS, unique=True)


def test_an_angle_is_asked_for_where_the_optimum_is_unique():
    wide, unknown = replace(BOUNDS, angle_upper=0.5000001), replace(BOUNDS, angle_upper=None)

    assert not wide.meet(LIMITS, unique=True)
    assert not unknown.meet(LIMITS, unique=True)
    assert wide.meet(LIMITS, unique=False)
    assert unknown.meet(LIMITS, unique=False)


def test_where_all_rotations_fit_equally_the_gap_is_held_against_the_spread():
    flat = replace(BOUNDS, least_range_squared=Fraction(0), angle_upper=None)

    assert replace(flat, greatest_gap=Fraction(7, 8)).meet(LIMITS, unique=True)
    assert not replace(flat, greatest_gap=Fraction(7, 8) + LITTLE).meet(LIMITS, unique=False)


def test_a_gap_of_the_whole_range_bounds_nothing():
    assert BOUNDS.covers_range(Fraction(3))
    assert not BOUNDS.covers_range(3 - LITTLE)
    assert not replace(BOUNDS, least_range_squared=Fraction(0)).covers_range(Fraction(3))


@pytest.mark.parametrize("gap", [Fraction(3, 8), Fraction(1, 10), Fraction(0.1), Fraction(2, 3)])
def test_doubles_enclose_the_gaps_and_the_share_is_above(gap: Fraction):
    for beside in (gap - LITTLE, gap, gap + LITTLE):
        bounds = replace(BOUNDS, least_gap=beside, greatest_gap=beside)

        assert bounds.gap_lower <= beside <= bounds.gap_upper
        assert math.nextafter(bounds.gap_lower, 1.0) >= bounds.gap_upper
        assert beside / 3 <= Fraction(bounds.share_upper or 0.0) <= beside / 3 + Fraction(2.0**-52)
    assert replace(BOUNDS, least_range_squared=Fraction(0), absent={}).least_range_squared == 0


def instance(kind: str = "generic", unit: float = 1.0) -> RegistrationProblem:
    rng = np.random.default_rng(5)
    source = rng.normal(size=(6, 3))
    target = source + 0.1 * rng.normal(size=(6, 3))
    if kind == "one target":
        target = np.tile(target[0], (6, 1))
    if kind == "points":
        source, target = (np.tile(a[0], (6, 1)) for a in (source, target))
    return RegistrationProblem(source, target, weights=unit * np.arange(1.0, 7.0))


def energy_of(problem: RegistrationProblem, pose: ExactPose) -> Any:
    """The sum of w |y - s R x - t|^2, from the points."""
    R, norm = rotation_matrix(pose.quaternion), squared_norm(pose.quaternion)
    total = Fraction(0)
    rows = zip(problem.source, problem.target, problem.weights, strict=True)
    for x, y, w in rows:
        for i in range(3):
            turned = sum(Fraction(R[i][j]) * Fraction(float(x[j])) for j in range(3)) / norm
            off = Fraction(float(y[i])) - pose.scale * turned - pose.translation[i]
            total += Fraction(float(w)) * off**2
    return total


POSE = ExactPose(quaternion=(9, 1, -2, 3), translation=(Fraction(1, 3), Fraction(-2), Fraction(5)))


def springs() -> tuple[RegistrationProblem, Springs]:
    x, y = instance().source, instance().target
    factors = np.tile(np.diag([1.0, 2.0, 3.0]), (6, 1, 1))
    problem = RegistrationProblem(x, y, factors=factors)
    return problem, Springs.of(problem)


def test_the_energy_of_general_springs_is_the_sum_of_their_squares():
    problem, objective = springs()
    R, norm = rotation_matrix(POSE.quaternion), squared_norm(POSE.quaternion)
    total = Fraction(0)
    for x, y in zip(problem.source.tolist(), problem.target.tolist(), strict=True):
        for i in range(3):
            turned = sum(Fraction(R[i][j]) * Fraction(x[j]) for j in range(3)) / norm
            total += ((i + 1) * (Fraction(y[i]) - turned - POSE.translation[i])) ** 2

    assert spring_energy(objective, POSE) == total


def test_the_least_gap_of_a_symmetric_scale_is_below_the_exact_one():
    made = instance()
    problem = RegistrationProblem(
        made.source, made.target, weights=made.weights, scale=Scale.SYMMETRIC
    )
    objective = Isotropic.of(problem)
    scaling = objective.scaling
    assert scaling is not None
    certificate = produce(problem, objective)
    assert certificate is not None
    bounds = pose_bounds(objective, certificate.body, POSE)
    above = pose_energy(objective, POSE) - objective.energy(certificate.body.quaternion)

    assert bounds.least_gap == above - scaling.slack < above
    assert bounds.greatest_gap == above + certificate.body.gap


def certified(
    kind: str = "generic", unit: float = 1.0
) -> tuple[RegistrationProblem, Isotropic, Any]:
    problem = instance(kind, unit)
    objective = Isotropic(exact_moments(problem))
    made = produce(problem, objective)
    assert made is not None
    return problem, objective, made.body


def test_the_gap_of_a_pose_is_its_energy_above_that_of_the_certificate():
    problem, objective, body = certified()
    bounds = pose_bounds(objective, body, POSE)
    best = ExactPose(
        quaternion=body.quaternion, translation=tuple(objective.best_translation(body.quaternion))
    )
    energy, least = energy_of(problem, POSE), energy_of(problem, best)

    assert pose_energy(objective, POSE) == energy
    assert bounds.least_gap == energy - least > 0
    assert bounds.greatest_gap == energy - least + body.gap
    optimal = pose_bounds(objective, body, best)
    assert (optimal.least_gap, optimal.greatest_gap) == (0, body.gap)
    below = pose_bounds(objective, body, best, energy=least - 2 * body.gap)
    assert (below.least_gap, below.greatest_gap) == (0, 0)


def test_where_no_rotation_is_better_the_gap_is_exact():
    _, objective, body = certified("one target")
    bounds = pose_bounds(objective, body, POSE)

    assert bounds.least_range_squared == 0
    assert bounds.least_gap == bounds.greatest_gap
    assert bounds.share_upper is None


@pytest.mark.parametrize("unit", [1.0, 0.25, 1024.0])
def test_the_shift_is_that_of_the_centroid_rounded_up(unit: float):
    """Whatever the unit of the weights is, which `moments.mass` leaves out."""
    problem, objective, body = certified(unit=unit)
    weights = [Fraction(float(w)) for w in problem.weights]
    x, y = (
        [
            sum(w * Fraction(float(v)) for w, v in zip(weights, column, strict=True)) / sum(weights)
            for column in cloud.T
        ]
        for cloud in (problem.source, problem.target)
    )
    moved: Any = POSE.moved
    squared = sum((a - b) ** 2 for a, b in zip(moved(x), y, strict=True))
    shift = pose_bounds(objective, body, POSE).shift_upper

    assert shift is not None
    assert squared <= Fraction(shift) ** 2 <= squared * (1 + Fraction(2.0**-51))


def test_two_clouds_that_are_a_point_each_are_measured_from_the_origin():
    problem = instance("points")
    x, y = problem.source[0], problem.target[0]
    centroids = [Fraction(float(v)) for v in (*x, *y)]

    assert flat_energy(exact_moments(problem)) == 21 * sum(c * c for c in centroids)
    moments = exact_moments(instance("one target"))
    assert flat_energy(moments) == moments.spread > 0


def test_a_pose_moves_points_by_its_scale_its_rotation_and_its_translation():
    pose = ExactPose(
        quaternion=(1, 1, 0, 0), translation=(Fraction(1, 3),) * 3, scale=Fraction(1, 7)
    )

    assert pose.moved((Fraction(1), Fraction(2), Fraction(3))) == (
        Fraction(1, 3) + Fraction(1, 7),
        Fraction(1, 3) - Fraction(3, 7),
        Fraction(1, 3) + Fraction(2, 7),
    )


def test_angles_add_up_and_end_at_half_a_turn():
    quarter = sin2_half_angle_between((1, 0, 0, 0), (1, 1, 0, 0))

    assert quarter == Fraction(1, 2)
    assert sin2_half_angle_between((2, 0, 0, 0), (0, 0, 3, 0)) == 1
    both = angle_from((1, 0, 0, 0), (1, 1, 0, 0), Fraction(1, 4))
    exact = math.pi / 2 + math.pi / 3
    assert exact < both < exact + 1e-11
    assert angle_from((1, 0, 0, 0), (1, 1, 0, 0), Fraction(1)) == math.pi
    assert angle_from((1, 0, 0, 0), (1, 0, 0, 0), Fraction(0)) == 5e-324


AXES = np.vstack([np.eye(3), -np.eye(3)])
LEAST_COST = Fraction(6 + 2 * (9 + 4 + 1) - 4 * (3 + 2 + 1))  # sum |x|^2 + |y|^2 - 2 l1, l1 = 12
NO_SHIFT = (Fraction(0),) * 3


@pytest.mark.parametrize("certified", [(1, 0, 0, 0), (50, 1, 0, 0), (40, 1, -2, 1)])
@pytest.mark.parametrize("judged", [(1, 0, 0, 0), (50, 1, 0, 0), (3, 1, 0, 1), (0, 0, 0, 1)])
@pytest.mark.parametrize("shift", [NO_SHIFT, (Fraction(1), Fraction(0), Fraction(-2))])
def test_a_pose_costs_between_its_bounds_and_up_to_the_upper_one(
    certified: tuple[int, ...], judged: tuple[int, ...], shift: tuple[Fraction, ...]
):
    objective = Isotropic.of(RegistrationProblem(AXES, AXES * [3.0, 2.0, 1.0]))
    gap = objective.energy(certified) - LEAST_COST  # all that it leaves open
    claims = SimpleNamespace(sin2_half_angle=None)
    body: Any = SimpleNamespace(quaternion=certified, gap=gap, claims=claims)
    found = pose_bounds(objective, body, ExactPose(quaternion=judged, translation=shift))
    cost = objective.energy(judged) + 6 * sum(t * t for t in shift) - LEAST_COST

    assert found.least_gap == max(0, cost - gap)
    assert found.greatest_gap == cost
