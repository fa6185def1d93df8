"""How far a pose shifts the source from where an optimum puts it: a bound that is proved."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from spring_families import lidar, line, mixed, plane, statement

from certreg.certificate.bounds import (
    FARTHEST,
    NO_SHIFT,
    SHIFT_IS_FREE,
    ExactPose,
    pose_bounds,
    sin2_half_angle_between,
    spring_pose_bounds,
)
from certreg.certificate.isotropic import produce
from certreg.exact.dyadic import Dyadic
from certreg.geometry.so3 import quadratic_form, rotation_matrix, squared_norm
from certreg.objective.isotropic import Isotropic
from certreg.objective.springs import Springs
from certreg.problem.lifting import lift
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem

FAMILIES = {"plane": plane, "line": line, "mixed": mixed, "lidar": lidar}


@dataclass(frozen=True)
class Claims:
    gap: Dyadic = field(default_factory=lambda: Dyadic(mantissa=1, exponent=-40))
    sin2_half_angle: Any = None
    unique: bool | None = True


@dataclass(frozen=True)
class Body:
    """A growth form whose certified rotation is anywhere: only what is said of it counts."""

    quaternion: Any
    claims: Any = field(default_factory=Claims)
    gap: Fraction = Fraction(1, 2**40)
    growth: Fraction = Fraction(0)


@dataclass(frozen=True)
class Told:
    value: Fraction


def integers(q: Any) -> tuple[int, ...]:
    return tuple(lift(np.asarray(q, dtype=float)).integers)


def objective_of(family: str) -> Springs:
    made = FAMILIES[family](np.random.default_rng(3), 20, 0.1)
    return Springs.of(RegistrationProblem(**statement(made)))


def apart(objective: Springs, pose: ExactPose, q: tuple[int, ...]) -> float:
    """From where the pose puts the centre to where the best one at a rotation does, in doubles."""
    best = ExactPose(quaternion=q, translation=objective.best_translation(q))
    here, there = (one.moved(objective.centre) for one in (pose, best))
    return float(squared_norm([a - b for a, b in zip(here, there, strict=True)])) ** 0.5


@pytest.mark.parametrize("family", FAMILIES)
def test_whatever_rotation_within_the_angle_is_optimal_its_centre_is_within_the_bound(family: str):
    objective, rng = objective_of(family), np.random.default_rng(1)
    for size in (1e-3, 1e-1, 1.0):
        certified, other = rng.normal(size=(2, 4))
        u, q = integers(certified), integers(certified + size * other)
        told = Told(sin2_half_angle_between(u, q))
        pose = ExactPose.of_doubles(rng.normal(size=4), rng.normal(size=3))
        bound = spring_pose_bounds(objective, claiming(u, told), pose).shift_upper
        alone = spring_pose_bounds(objective, claiming(u, Told(Fraction(0))), pose).shift_upper

        assert bound is not None
        assert alone is not None
        assert apart(objective, pose, q) <= bound
        assert alone == pytest.approx(apart(objective, pose, u), rel=1e-14)
        near = ExactPose(quaternion=u, translation=objective.best_translation(u))
        close = spring_pose_bounds(objective, claiming(u, told), near).shift_upper
        assert close is not None
        assert 0.0 < apart(objective, near, q) <= close
        slopes = objective.image_slopes(objective.centre)
        square = 8 * sum(squared_norm(row) for row in slopes) * told.value
        assert square <= Fraction(close) ** 2 <= square * (1 + Fraction(1, 2**50))


def claiming(u: tuple[int, ...], told: Any) -> Any:
    return Body(u, Claims(sin2_half_angle=told))


def test_the_slopes_are_those_of_the_centre_under_the_best_translation():
    objective = objective_of("plane")
    slopes = objective.image_slopes(objective.centre)
    images, turns = [], []
    for q in ((1, 2, 3, 4), (3, -1, 0, 2)):
        pose = ExactPose(quaternion=q, translation=objective.best_translation(q))
        images.append(pose.moved(objective.centre))
        rows = rotation_matrix(q)
        turns.append([Fraction(rows[a][j], squared_norm(q)) for j in range(3) for a in range(3)])
    moved = [a - b for a, b in zip(*images, strict=True)]
    turned = [a - b for a, b in zip(*turns, strict=True)]

    assert [sum(m * r for m, r in zip(row, turned, strict=True)) for row in slopes] == moved
    assert squared_norm(turned) == FARTHEST * sin2_half_angle_between((1, 2, 3, 4), (3, -1, 0, 2))


def test_without_an_angle_or_with_a_free_shift_nothing_is_said_of_it():
    objective, u = objective_of("plane"), (1, 0, 0, 0)
    pose = ExactPose(quaternion=u, translation=(Fraction(0),) * 3)
    bounds = spring_pose_bounds(objective, claiming(u, None), pose)
    assert bounds.stated("shift_upper") == NO_SHIFT

    points = np.random.default_rng(0).integers(-5, 6, (8, 3)).astype(float)
    walls = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] * 4)
    free = Springs.of(RegistrationProblem(points, points, normals=walls))
    bounds = spring_pose_bounds(free, claiming(u, Told(Fraction(0))), pose)
    assert bounds.stated("shift_upper") == SHIFT_IS_FREE


def test_of_springs_alike_the_centre_goes_to_one_place_at_every_rotation():
    rng = np.random.default_rng(2)
    x, y = rng.normal(size=(2, 6, 3))
    plain = RegistrationProblem(x, y)
    general = RegistrationProblem(x, y, factors=np.tile([1.0, 0.0, 1.0, 0.0, 0.0, 1.0], (6, 1)))
    objective = Springs.of(general)
    pose = ExactPose.of_doubles(rng.normal(size=4), rng.normal(size=3))
    shift = spring_pose_bounds(objective, claiming((1, 0, 0, 0), None), pose).shift_upper
    isotropic = Isotropic(exact_moments(plain))
    certificate = produce(plain, isotropic)

    assert shift == pytest.approx(np.linalg.norm(moved(pose, x.mean(axis=0)) - y.mean(axis=0)))
    assert certificate is not None
    own = pose_bounds(isotropic, certificate.body, pose).shift_upper
    assert own == pytest.approx(shift, rel=1e-14)


def moved(pose: ExactPose, point: Any) -> Any:
    return np.array([float(e) for e in pose.moved([Fraction(e) for e in point.tolist()])])


def test_no_gap_is_larger_than_the_energy_itself():
    objective, u = objective_of("plane"), (1, 0, 0, 0)
    pose = ExactPose(quaternion=u, translation=objective.best_translation(u))
    energy = quadratic_form(objective.form(), [1, 1, 0, 0, 0, 1, 0, 0, 0, 1]) * objective.unit
    coarse: Any = Body(u, gap=2 * energy)
    fine: Any = Body(u, gap=energy / 2)

    assert spring_pose_bounds(objective, coarse, pose).greatest_gap == energy
    assert spring_pose_bounds(objective, fine, pose).greatest_gap == energy / 2
