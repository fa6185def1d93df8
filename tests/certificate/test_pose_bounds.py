"""Bounds on what a pose costs hold what it costs, whatever the certified rotation leaves open."""

from __future__ import annotations

from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from certreg.certificate import ExactPose, pose_bounds
from certreg.objective import Isotropic
from certreg.problem import RegistrationProblem

AXES = np.vstack([np.eye(3), -np.eye(3)])
LEAST = Fraction(6 + 2 * (9 + 4 + 1) - 4 * (3 + 2 + 1))  # sum |x|^2 + |y|^2 - 2 l1, l1 = 12
ZERO = (Fraction(0),) * 3


@pytest.mark.parametrize("certified", [(1, 0, 0, 0), (50, 1, 0, 0), (40, 1, -2, 1)])
@pytest.mark.parametrize("judged", [(1, 0, 0, 0), (50, 1, 0, 0), (3, 1, 0, 1), (0, 0, 0, 1)])
@pytest.mark.parametrize("shift", [ZERO, (Fraction(1), Fraction(0), Fraction(-2))])
def test_a_pose_costs_between_its_bounds_and_up_to_the_upper_one(
    certified: tuple[int, ...], judged: tuple[int, ...], shift: tuple[Fraction, ...]
):
    objective = Isotropic.of(RegistrationProblem(AXES, AXES * [3.0, 2.0, 1.0]))
    gap = objective.energy(certified) - LEAST  # all that it leaves open
    claims = SimpleNamespace(sin2_half_angle=None)
    body: Any = SimpleNamespace(quaternion=certified, gap=gap, claims=claims)
    found = pose_bounds(objective, body, ExactPose(quaternion=judged, translation=shift))
    cost = objective.energy(judged) + 6 * sum(t * t for t in shift) - LEAST

    assert found.least_gap == max(0, cost - gap)
    assert found.greatest_gap == cost
