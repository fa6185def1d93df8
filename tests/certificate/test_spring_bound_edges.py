"""Bounds on a pose of general springs, where what they are made of is chosen."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import product
from types import SimpleNamespace
from typing import Any

import numpy as np

from certreg.certificate.bounds import (
    CONSTANT,
    FAR,
    NO_ANGLE,
    NO_ANGLE_CLAIMED,
    ExactPose,
    _differences,
    least_range,
    spring_pose_bounds,
)
from certreg.objective.springs import Springs
from certreg.problem.problem import RegistrationProblem

Energy = Callable[[tuple[int, ...]], Fraction]


def objective_of(energy: Energy, symmetry: int = 0) -> Any:
    def of(q: tuple[int, ...]) -> Fraction:
        assert len(q) == 4
        return energy(q)

    return SimpleNamespace(energy=of, symmetry=(None,) * symmetry)


def test_the_range_is_that_from_the_best_to_the_worst_rotation_of_a_cube():
    energies: dict[Any, Fraction] = dict(zip(FAR, map(Fraction, range(3, 99)), strict=False))
    top = max(energies.values())

    assert least_range(objective_of(lambda q: energies[q]), Fraction(1)) == top - 1
    assert least_range(objective_of(lambda q: energies[q], CONSTANT), Fraction(1)) == 0
    assert least_range(objective_of(lambda q: energies[q], CONSTANT - 1), Fraction(1)) == top - 1
    half = objective_of(lambda q: energies[q] / (2 * top) + 1)
    assert least_range(half, Fraction(1)) == Fraction(1, 2)


def test_where_a_cube_shows_none_another_rotation_shows_a_range():
    for height in (Fraction(1, 3), Fraction(-1, 3)):
        other = objective_of(lambda q, height=height: 5 + height * (q[0] == -4))
        assert least_range(other, Fraction(5)) == Fraction(1, 3)
    lower = objective_of(lambda q: 3 - Fraction(q not in FAR, 7))
    assert least_range(lower, Fraction(3)) == Fraction(1, 7)
    near = objective_of(lambda q: Fraction(7, 2) if q in FAR else Fraction(9))
    assert least_range(near, Fraction(3)) == Fraction(1, 2)


def test_every_rotation_of_small_integers_is_asked():
    """Nine values of each entry: a form of degree four that is 0 at all of them is 0."""
    asked = list[tuple[int, ...]]()
    same = objective_of(lambda q: asked.append(q) or Fraction(5))

    assert list(_differences(same, Fraction(5))) == []
    grid = product(range(-4, 5), repeat=4)
    assert asked == [q for q in grid if any(q)]
    assert next(_differences(objective_of(lambda q: Fraction(4)), Fraction(5))) == 1


@dataclass(frozen=True)
class Claims:
    sin2_half_angle: Any = None
    unique: bool | None = True


@dataclass(frozen=True)
class Body:
    """A certificate of a rotation that need not be the best: only what is said of it counts."""

    quaternion: tuple[int, int, int, int]
    claims: Any = field(default_factory=Claims)
    gap: Fraction = Fraction(1, 8)
    growth: Fraction = Fraction(0)


def body(quaternion: tuple[int, int, int, int], gap: Fraction = Fraction(1, 8)) -> Any:
    return Body(quaternion, gap=gap)


def springs(*, exact: bool = False) -> Springs:
    rng = np.random.default_rng(4)
    x = rng.integers(-9, 9, size=(5, 3)) / 2.0
    y = x + np.array([1.0, 2.0, 3.0]) if exact else x + rng.integers(-2, 3, size=(5, 3)) / 8.0
    factors = np.tile(np.diag([1.0, 2.0, 3.0]), (5, 1, 1))
    return Springs.of(RegistrationProblem(x, y, factors=factors))


def at_best(objective: Springs, q: tuple[int, ...]) -> ExactPose:
    return ExactPose(quaternion=q, translation=objective.best_translation(q))


def test_no_pose_is_farther_above_the_minimum_than_its_own_energy_nor_below_it():
    objective, good, bad = springs(), (1, 0, 0, 0), (1, 1, 0, 0)
    low, high = objective.energy(good), objective.energy(bad)
    above = spring_pose_bounds(objective, body(good), at_best(objective, bad))
    below = spring_pose_bounds(objective, body(bad), at_best(objective, good))
    same = spring_pose_bounds(objective, body(good), at_best(objective, good))

    assert low < high
    assert (above.least_gap, above.greatest_gap) == (high - low, high - low + Fraction(1, 8))
    assert (below.least_gap, below.greatest_gap) == (0, 0)
    assert (same.least_gap, same.greatest_gap) == (0, min(low, Fraction(1, 8)))
    coarse = spring_pose_bounds(objective, body(good, gap=2 * high), at_best(objective, bad))
    assert coarse.greatest_gap == high
    assert above.least_range_squared == least_range(objective, low) ** 2
    assert above.flat_energy == low


def test_the_energy_is_that_of_the_translation_too():
    objective, q = springs(), (1, 0, 0, 0)
    best = objective.best_translation(q)
    pose = ExactPose(quaternion=q, translation=(best[0] + 1, *best[1:]))

    assert spring_pose_bounds(objective, body(q), pose).least_gap == 5


def test_where_every_rotation_costs_the_same_only_the_translation_costs():
    """No rotation is better than the certified one, whatever its gap says."""
    factors = np.tile(np.diag([1.0, 2.0, 3.0]), (4, 1, 1))
    problem = RegistrationProblem(
        np.zeros((4, 3)), np.diag([1.0, 2.0, 3.0, 4.0])[:, :3], factors=factors
    )
    objective, best = Springs.of(problem), (1, 2, 3, 4)
    t = objective.best_translation(best)
    pose = ExactPose(quaternion=(1, 0, 0, 0), translation=(t[0], t[1], t[2] + Fraction(1, 3)))
    bounds = spring_pose_bounds(objective, body(best), pose)

    assert objective.energy(best) > Fraction(1, 8)
    assert bounds.least_gap == bounds.greatest_gap == 4 * 9 * Fraction(1, 9)
    assert bounds.least_range_squared == 0


def test_clouds_that_fit_exactly_are_measured_from_the_origin():
    objective, q = springs(exact=True), (1, 0, 0, 0)
    bounds = spring_pose_bounds(objective, body(q), at_best(objective, q))

    assert objective.energy(q) == 0
    assert bounds.flat_energy == objective.translation_energy(q, (Fraction(0),) * 3)
    assert bounds.flat_energy == 5 * (1 + 4**2 + 9**2)


def test_an_optimum_is_said_not_to_be_unique_where_the_certificate_says_so_alone():
    objective, q = springs(), (1, 0, 0, 0)
    for unique in (True, None, False):
        of: Any = Body(q, Claims(unique=unique))
        bounds = spring_pose_bounds(objective, of, at_best(objective, q))

        assert bounds.angle_upper is None
        assert bounds.stated("angle_upper") == (NO_ANGLE if unique is False else NO_ANGLE_CLAIMED)
