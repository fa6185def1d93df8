"""Bounds on a pose of general springs, where what they are made of is chosen."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import numpy as np

from certreg.certificate import ExactPose, spring_pose_bounds
from certreg.certificate.spring_bounds import CONSTANT, FAR, _differences, least_range
from certreg.objective import Springs
from certreg.problem import RegistrationProblem, spring_moments

Energy = Callable[[tuple[int, ...]], Fraction]


def objective_of(energy: Energy, symmetry: int = 0) -> Any:
    def of(q: tuple[int, ...]) -> Fraction:
        assert len(q) == 4
        return energy(q)

    return SimpleNamespace(energy=of, symmetry=(None,) * symmetry)


def test_the_range_is_that_from_the_best_to_the_worst_rotation_of_a_cube():
    energies = dict(zip(FAR, map(Fraction, range(3, 99)), strict=False))
    top = max(energies.values())

    assert least_range(objective_of(lambda q: energies[q]), Fraction(1)) == top - 1
    assert least_range(objective_of(lambda q: energies[q], CONSTANT), Fraction(1)) == 0
    assert least_range(objective_of(lambda q: energies[q], CONSTANT - 1), Fraction(1)) == top - 1
    half = objective_of(lambda q: energies[q] / (2 * top) + 1)
    assert least_range(half, Fraction(1)) == Fraction(1, 2)


def test_where_a_cube_shows_none_another_rotation_shows_a_range():
    def at(peak: tuple[int, ...], height: Fraction) -> Any:
        return objective_of(lambda q: 5 + height * (q == peak))

    for height in (Fraction(1, 3), Fraction(-1, 3)):
        for peak in ((4, 4, 4, 4), (-4, -4, -4, -4), (1, 0, 0, 2)):
            assert least_range(at(peak, height), Fraction(5)) == Fraction(1, 3)
            assert list(_differences(at(peak, height), Fraction(5))) == [Fraction(1, 3)]
        for peak in ((0, 0, 0, 0), (5, 5, 5, 5), (-5, 0, 0, 1)):
            assert list(_differences(at(peak, height), Fraction(5))) == []
    below = objective_of(lambda q: Fraction(3) if q in FAR else 5 + Fraction(1, 7))
    assert least_range(below, Fraction(3)) > 0


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


def springs(*, exact: bool = False, points: bool = False) -> Springs:
    rng = np.random.default_rng(4)
    x = rng.integers(-9, 9, size=(5, 3)) / 2.0
    x = np.tile(x[:1], (5, 1)) if points else x
    y = x if exact else x + rng.integers(-2, 3, size=(5, 3)) / 8.0
    factors = np.tile(np.diag([1.0, 2.0, 3.0]), (5, 1, 1))
    return Springs(spring_moments(RegistrationProblem(x, y, factors=factors)))


def at_best(objective: Springs, q: tuple[int, ...]) -> ExactPose:
    return ExactPose(quaternion=q, translation=objective.best_translation(q))


def test_no_pose_is_farther_above_the_minimum_than_its_own_energy_nor_below_it():
    objective, good, bad = springs(), (1, 0, 0, 0), (1, 1, 0, 0)
    low, high = objective.energy(good), objective.energy(bad)
    above = spring_pose_bounds(objective, Body(good), at_best(objective, bad))
    below = spring_pose_bounds(objective, Body(bad), at_best(objective, good))
    same = spring_pose_bounds(objective, Body(good), at_best(objective, good))

    assert low < high
    assert (above.least_gap, above.greatest_gap) == (high - low, high - low + Fraction(1, 8))
    assert (below.least_gap, below.greatest_gap) == (0, 0)
    assert (same.least_gap, same.greatest_gap) == (0, min(low, Fraction(1, 8)))
    coarse = spring_pose_bounds(objective, Body(good, gap=2 * high), at_best(objective, bad))
    assert coarse.greatest_gap == high
    assert above.least_range_squared == least_range(objective, low) ** 2
    assert above.flat_energy == low


def test_the_energy_is_that_of_the_translation_too():
    objective, q = springs(), (1, 0, 0, 0)
    best = objective.best_translation(q)
    pose = ExactPose(quaternion=q, translation=(best[0] + 1, *best[1:]))

    assert spring_pose_bounds(objective, Body(q), pose).least_gap == 5


def test_clouds_that_fit_exactly_are_measured_from_the_origin():
    objective, q = springs(exact=True), (1, 0, 0, 0)
    bounds = spring_pose_bounds(objective, Body(q), at_best(objective, q))

    assert objective.energy(q) == 0
    assert bounds.flat_energy == objective.translation_energy(q, (Fraction(0),) * 3)
    moved = springs(points=True)
    flat = spring_pose_bounds(moved, Body(q), at_best(moved, (1, 1, 0, 0)))
    assert flat.least_gap >= 0
